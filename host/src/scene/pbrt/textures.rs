//! `Texture`: colours over a surface, and numbers that are the same everywhere.

use std::collections::HashMap;
use std::path::PathBuf;

use super::super::{Encoding, Filter, ImageMap, Place, SceneError, Texture, Wrap};
use super::directive::At;
use super::materials::COLOURS;
use super::param::{Param, Text, Type, Values};
use super::params::Params;
use super::reader::Reader;
use super::suggest::{nearest, undefined};

const SUPPORTED: &str = "supported are constant, scale and, for spectra, imagemap";
const TEXTURES: [&str; 13] = [
    "bilerp",
    "checkerboard",
    "constant",
    "directionmix",
    "dots",
    "fbm",
    "imagemap",
    "marble",
    "mix",
    "ptex",
    "scale",
    "windy",
    "wrinkled",
];
/// Most parts of a texture: each that scales another twice would double it.
const MOST: usize = 64;
/// What a part takes, about \[bytes\].
const PART: u64 = 512;

/// Textures by name; `None` for those that were refused, leniently.
#[derive(Debug, Default)]
pub(super) struct Textures {
    colours: HashMap<String, (Option<Texture>, Place)>,
    numbers: HashMap<String, (Option<f64>, Place)>,
}

impl Reader<'_> {
    pub(super) fn texture(&mut self, at: &At) -> Result<(), SceneError> {
        self.world_only(at, "Texture")?;
        let (name, place) = self.string(at, "a texture's name")?;
        let (class, class_place) = self.string(at, "float or spectrum")?;
        let inherited = self.state.inherited.texture.clone();
        let (ty, ty_place, params) = self.typed(at, "Texture", inherited)?;
        let textures = &self.world.textures;
        let older = match class.as_str() {
            "float" => textures.numbers.get(&name).map(|(_, place)| place),
            "spectrum" => textures.colours.get(&name).map(|(_, place)| place),
            _ => {
                let message = format!("texture type \"{class}\" is unknown");
                let error = SceneError::at(&class_place, message);
                return self
                    .diagnostics
                    .refuse(error.help("it is \"float\" or \"spectrum\""));
            }
        };
        if let Some(older) = older {
            let message = format!("{class} texture \"{name}\" is defined twice");
            return Err(SceneError::at(&place, message).note(older, "first here"));
        }
        let known = match (ty.as_str(), class.as_str()) {
            ("constant" | "scale", _) | ("imagemap", "spectrum") => true,
            (other, _) => {
                self.refuse_texture(other, &class, &ty_place)?;
                false
            }
        };
        if class == "float" {
            let number = known.then(|| self.number_texture(&ty, &params));
            let made = (number.transpose()?, place);
            self.world.textures.numbers.insert(name, made);
        } else {
            let colour = match ty.as_str() {
                "constant" => Some(self.constant(&params)?),
                "scale" => Some(self.scaled(&params)?),
                _ if known => Some(self.image_map(&params)?),
                _ => None,
            };
            self.world.textures.colours.insert(name, (colour, place));
        }
        if known {
            params.finish(&mut self.diagnostics)?;
        }
        Ok(())
    }

    fn refuse_texture(&mut self, ty: &str, class: &str, place: &Place) -> Result<(), SceneError> {
        let known = TEXTURES.contains(&ty);
        let what = if known {
            "is not yet supported"
        } else {
            "is unknown"
        };
        let error = SceneError::at(place, format!("{class} texture \"{ty}\" {what}"));
        let near = nearest(ty, TEXTURES).filter(|_| !known);
        self.diagnostics.refuse(match near {
            Some(near) => error.help(format!("did you mean \"{near}\"?")),
            None => error.help(SUPPORTED),
        })
    }

    /// A float texture: a number, for all that is supported is the same everywhere.
    fn number_texture(&mut self, ty: &str, params: &Params) -> Result<f64, SceneError> {
        if ty == "constant" {
            return Ok(self.number(params, "value")?.unwrap_or(1.0));
        }
        let texture = self.number(params, "tex")?.unwrap_or(1.0);
        Ok(texture * self.number(params, "scale")?.unwrap_or(1.0))
    }

    fn constant(&mut self, params: &Params) -> Result<Texture, SceneError> {
        let value = self.colour_texture(params, "value")?;
        Ok(value.unwrap_or(Texture::Constant([1.0; 3])))
    }

    /// pbrt's product of `tex` and `scale`; here `scale` may have colour, too.
    fn scaled(&mut self, params: &Params) -> Result<Texture, SceneError> {
        let texture = self.colour_texture(params, "tex")?;
        let types = [Type::Float, Type::Rgb, Type::Spectrum, Type::Texture];
        let scale = match params.find("scale", &types)? {
            Some(param) if param.ty == Type::Float => {
                let scale = params.float("scale", "0 or more", |v| v >= 0.0)?;
                scale.map(|scale| Texture::Constant([scale; 3]))
            }
            Some(param) if self.names_a_number(param) => {
                let scale = self.number(params, "scale")?;
                if scale.is_some_and(|scale| scale < 0.0) {
                    let message = "a factor on colours must not be negative";
                    return Err(SceneError::at(&param.valued, message));
                }
                scale.map(|scale| Texture::Constant([scale; 3]))
            }
            _ => self.colour_texture(params, "scale")?,
        };
        let one = Texture::Constant([1.0; 3]);
        let product = match (texture.unwrap_or(one.clone()), scale.unwrap_or(one)) {
            (Texture::Constant(a), Texture::Constant(b)) => {
                Texture::Constant([a[0] * b[0], a[1] * b[1], a[2] * b[2]])
            }
            (a, b) => Texture::Scale(Box::new(a), Box::new(b)),
        };
        if let Texture::Constant(rgb) = &product
            && !rgb.iter().all(|c| (*c as f32).is_finite())
        {
            let message = format!("the product of textures is too large: {rgb:?}");
            return Err(SceneError::at(params.place(), message));
        }
        if parts(&product) > MOST {
            let message = format!("more than {MOST} textures in one");
            return Err(SceneError::at(params.place(), message));
        }
        Ok(product)
    }

    fn image_map(&mut self, params: &Params) -> Result<Texture, SceneError> {
        let filename = self.existing_file(params, "filename", "this imagemap")?;
        let mapping = params.string("mapping")?.cloned();
        if let Some(mapping) = mapping.filter(|text| text.text != "uv") {
            let known = ["spherical", "cylindrical", "planar"].contains(&mapping.text.as_str());
            let what = if known {
                "is not yet supported"
            } else {
                "is unknown"
            };
            let message = format!("mapping \"{}\" {what}", mapping.text);
            let error = SceneError::at(&mapping.place, message).help("supported is \"uv\"");
            self.diagnostics.refuse(error)?;
            for name in ["v1", "v2"] {
                params.ignore(name, &[Type::Vector3])?;
            }
        }
        let filter = self.filter(params)?;
        let wrap = self.wrap(params)?;
        let encoding = self.encoding(params)?;
        let number = |name, default| -> Result<f64, SceneError> {
            let value = params.float(name, "a number", |_| true)?;
            Ok(value.unwrap_or(default))
        };
        let mapping = [
            number("uscale", 1.0)?,
            number("vscale", 1.0)?,
            number("udelta", 0.0)?,
            number("vdelta", 0.0)?,
        ];
        let scale = params
            .float("scale", "0 or more", |v| v >= 0.0)?
            .unwrap_or(1.0);
        let invert = params.boolean("invert")?.unwrap_or(false);
        params.ignore("maxanisotropy", &[Type::Float])?;
        Ok(Texture::Image(ImageMap {
            filename,
            filter,
            wrap,
            encoding,
            scale,
            invert,
            mapping,
            place: params.place().clone(),
        }))
    }

    fn filter(&mut self, params: &Params) -> Result<Filter, SceneError> {
        let Some(text) = params.string("filter")? else {
            return Ok(Filter::Bilinear);
        };
        match text.text.as_str() {
            "point" => return Ok(Filter::Point),
            "bilinear" => {}
            "trilinear" | "ewa" | "EWA" => {
                let message = format!("filter \"{}\" is read as \"bilinear\"", text.text);
                let help = "many samples per pixel do what it is for";
                self.diagnostics
                    .warn(SceneError::at(&text.place, message).help(help));
            }
            _ => {
                let names = ["point", "bilinear", "trilinear", "ewa"];
                self.known("filter", &text.text, &text.place, &names)?;
            }
        }
        Ok(Filter::Bilinear)
    }

    fn wrap(&mut self, params: &Params) -> Result<Wrap, SceneError> {
        let Some(text) = params.string("wrap")? else {
            return Ok(Wrap::Repeat);
        };
        Ok(match text.text.as_str() {
            "black" => Wrap::Black,
            "clamp" => Wrap::Clamp,
            other => {
                self.known("wrap", other, &text.place, &["repeat", "black", "clamp"])?;
                Wrap::Repeat
            }
        })
    }

    fn encoding(&mut self, params: &Params) -> Result<Option<Encoding>, SceneError> {
        let Some(text) = params.string("encoding")? else {
            return Ok(None);
        };
        if let Some(power) = text.text.strip_prefix("gamma ") {
            let power = power.trim().parse().ok();
            let Some(power) = power.filter(|p: &f64| *p > 0.0 && p.is_finite()) else {
                let message = format!("encoding \"{}\" has no positive number", text.text);
                return Err(SceneError::at(&text.place, message).help("for example \"gamma 2.2\""));
            };
            return Ok(Some(Encoding::Gamma(power)));
        }
        Ok(match text.text.as_str() {
            "sRGB" => Some(Encoding::Srgb),
            "linear" => Some(Encoding::Linear),
            other => {
                let names = ["sRGB", "linear", "gamma 2.2"];
                self.known("encoding", other, &text.place, &names)?;
                None
            }
        })
    }

    /// A colour, or the texture of a name.
    pub(super) fn colour_texture(
        &mut self,
        params: &Params,
        name: &'static str,
    ) -> Result<Option<Texture>, SceneError> {
        let Some(param) = params.find(name, &COLOURS)? else {
            return Ok(None);
        };
        if param.ty != Type::Texture {
            let rgb = params.coefficient(name, &mut self.diagnostics)?;
            return Ok(rgb.map(Texture::Constant));
        }
        let text = one_name(param)?;
        let found = match self.world.textures.colours.get(&text.text) {
            Some((texture, _)) => texture.clone(),
            None => {
                let names = self.world.textures.colours.keys().map(String::as_str);
                let error = undefined("spectrum texture", &text.text, &text.place, names);
                self.diagnostics
                    .refuse(error.help("textures are defined before they are used"))?;
                None
            }
        };
        if let Some(texture) = &found {
            self.charge(PART * parts(texture) as u64, &text.place)?;
        }
        Ok(found)
    }

    /// The number that a float texture is.
    pub(super) fn float_texture(&mut self, name: &Text) -> Result<Option<f64>, SceneError> {
        if let Some((number, _)) = self.world.textures.numbers.get(&name.text) {
            return Ok(*number);
        }
        let names = self.world.textures.numbers.keys().map(String::as_str);
        let error = undefined("float texture", &name.text, &name.place, names);
        self.diagnostics
            .refuse(error.help("textures are defined before they are used"))?;
        Ok(None)
    }

    fn names_a_number(&self, param: &Param) -> bool {
        let numbers = &self.world.textures.numbers;
        matches!(&param.values, Values::Strings(names) if param.ty == Type::Texture
            && names.iter().all(|name| numbers.contains_key(&name.text)))
    }

    /// A file that a parameter names and that is there.
    pub(super) fn existing_file(
        &mut self,
        params: &Params,
        name: &'static str,
        what: &str,
    ) -> Result<PathBuf, SceneError> {
        let Some(filename) = params.string(name)? else {
            let message = format!("{what} has no \"string {name}\"");
            return Err(SceneError::at(params.place(), message));
        };
        let path = self.resolve(&filename.text);
        if self.files.exists(&path) {
            return Ok(path);
        }
        let message = format!("there is no file {}", path.display());
        Err(SceneError::at(&filename.place, message)
            .help("paths are relative to the directory of the main scene file"))
    }
}

fn one_name(param: &Param) -> Result<&Text, SceneError> {
    match &param.values {
        Values::Strings(names) if names.len() == 1 => Ok(&names[0]),
        _ => {
            let message = format!("\"{}\" takes one texture", param.name);
            Err(SceneError::at(&param.valued, message))
        }
    }
}

/// How many textures there are in one.
fn parts(texture: &Texture) -> usize {
    match texture {
        Texture::Constant(_) | Texture::Image(_) => 1,
        Texture::Scale(a, b) => 1 + parts(a) + parts(b),
    }
}
