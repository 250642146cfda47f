//! The grammar: what follows each directive, and what it does to the state.

use std::sync::Arc;

use glam::DMat4;

use super::super::{Place, SceneError};
use super::lexer::{Kind, Token};
use super::param::{Param, read_list};
use super::params::Params;
use super::reader::{Reader, Saved};
use super::state::{MediumName, State};
use super::suggest::nearest;

/// Every directive of the language, for "did you mean".
const DIRECTIVES: [&str; 40] = [
    "Accelerator",
    "ActiveTransform",
    "AreaLightSource",
    "Attribute",
    "AttributeBegin",
    "AttributeEnd",
    "Camera",
    "ColorSpace",
    "ConcatTransform",
    "CoordSysTransform",
    "CoordinateSystem",
    "Film",
    "Identity",
    "Import",
    "Include",
    "Integrator",
    "LightSource",
    "LookAt",
    "MakeNamedMaterial",
    "MakeNamedMedium",
    "Material",
    "MediumInterface",
    "NamedMaterial",
    "ObjectBegin",
    "ObjectEnd",
    "ObjectInstance",
    "Option",
    "PixelFilter",
    "ReverseOrientation",
    "Rotate",
    "Sampler",
    "Scale",
    "Shape",
    "Texture",
    "Transform",
    "TransformBegin",
    "TransformEnd",
    "TransformTimes",
    "Translate",
    "WorldBegin",
];

/// Most states saved at once; each takes a few hundred bytes at worst.
const DEEPEST: usize = 1 << 20;
/// Most parameters that `Attribute` holds ready for one target.
const MOST: usize = 64;

/// A directive being read: its file in the stack, and its place.
#[derive(Clone, Debug)]
pub(super) struct At {
    pub(super) file: usize,
    pub(super) place: Place,
}

impl Reader<'_> {
    /// Reads one directive that begins with `token`.
    pub(super) fn directive(&mut self, file: usize, token: &Token) -> Result<(), SceneError> {
        let place = self.lexer(file).place(token);
        let name = self.lexer(file).shown(token);
        if token.kind != Kind::Word {
            let message = format!("expected a directive, found {name}");
            return Err(SceneError::at(&place, message));
        }
        let at = At { file, place };
        match name.as_str() {
            "AttributeBegin" => self.attribute_begin(&at, false),
            "AttributeEnd" => self.attribute_end(&at),
            "TransformBegin" | "TransformEnd" => {
                let attribute = name.replace("Transform", "Attribute");
                let message = format!("{name} is deprecated; read as {attribute}, as pbrt-v4 does");
                self.diagnostics.warn(SceneError::at(&at.place, message));
                match name.as_str() {
                    "TransformBegin" => self.attribute_begin(&at, false),
                    _ => self.attribute_end(&at),
                }
            }
            "Attribute" => self.attribute(&at),
            "WorldBegin" => self.world_begin(&at),
            "ReverseOrientation" => {
                self.world_only(&at, &name)?;
                let state = self.state_mut();
                state.reverse_orientation = !state.reverse_orientation;
                Ok(())
            }
            "MediumInterface" => self.medium_interface(&at),
            "Include" | "Import" => self.other_file(&at, &name),
            "Identity" | "Translate" | "Scale" | "Rotate" | "LookAt" | "Transform"
            | "ConcatTransform" => self.transformation(&at, &name),
            "CoordinateSystem" | "CoordSysTransform" => self.coordinate_system(&at, &name),
            "ActiveTransform" => self.active_transform(&at),
            "TransformTimes" => {
                self.options_only(&at, &name)?;
                self.numbers::<2>(&at).map(|_| ())
            }
            "ColorSpace" => self.color_space(&at),
            "Option" => self.option(&at),
            "Camera" | "Film" | "Sampler" | "PixelFilter" | "Integrator" | "Accelerator" => {
                self.options_only(&at, &name)?;
                let params = self.typed(&at, &name, Arc::default())?;
                self.rendering_option(&at, &name, params)
            }
            "MakeNamedMedium" => self.make_named_medium(&at),
            "LightSource" => self.light_source(&at),
            "AreaLightSource" => self.area_light_source(&at),
            "Shape" => self.shape(&at),
            "Material" => self.material(&at),
            "MakeNamedMaterial" => self.make_named_material(&at),
            "NamedMaterial" => self.named_material(&at),
            "Texture" => self.texture(&at),
            "ObjectBegin" => self.object_begin(&at),
            "ObjectEnd" => self.object_end(&at),
            "ObjectInstance" => self.object_instance(&at),
            _ => self.unknown(&at, &name),
        }
    }

    fn unknown(&mut self, at: &At, name: &str) -> Result<(), SceneError> {
        let error = SceneError::at(&at.place, format!("unknown directive {name}"));
        let error = match name {
            "WorldEnd" => error.help("pbrt-v4 has no WorldEnd; remove it"),
            "TransformedShape" | "Volume" => error,
            _ => match nearest(name, DIRECTIVES) {
                Some(near) => error.help(format!("did you mean {near}?")),
                None => error,
            },
        };
        self.diagnostics.refuse(error)?;
        // Lenient: whatever is not a word belongs to it.
        while let Some(token) = self.lexer(at.file).peek()? {
            let known = token.kind == Kind::Word
                && self.lexer(at.file).bytes(&token)[0].is_ascii_alphabetic();
            if known {
                break;
            }
            self.lexer(at.file).next()?;
        }
        Ok(())
    }

    /// The state, copied first if a saved one shares it.
    pub(super) fn state_mut(&mut self) -> &mut State {
        Arc::make_mut(&mut self.state)
    }

    pub(super) fn world_only(&self, at: &At, name: &str) -> Result<(), SceneError> {
        if self.in_world {
            return Ok(());
        }
        let message = format!("{name} must come after WorldBegin");
        Err(SceneError::at(&at.place, message))
    }

    fn options_only(&self, at: &At, name: &str) -> Result<(), SceneError> {
        if !self.in_world {
            return Ok(());
        }
        let message = format!("{name} must come before WorldBegin");
        Err(SceneError::at(&at.place, message))
    }

    /// A string that must follow, with its place.
    pub(super) fn string(&mut self, at: &At, what: &str) -> Result<(String, Place), SceneError> {
        let lexer = self.lexer(at.file);
        match lexer.next()? {
            Some(token) if token.kind == Kind::String => {
                Ok((lexer.text(&token)?, lexer.place(&token)))
            }
            Some(token) => {
                let message = format!("expected {what} in quotes, found {}", lexer.shown(&token));
                Err(SceneError::at(&lexer.place(&token), message))
            }
            None => {
                let message = format!("the file ends where {what} in quotes should be");
                Err(SceneError::at(&lexer.end(), message))
            }
        }
    }

    /// Parameters of a directive, with those of `Attribute` behind them.
    pub(super) fn params(
        &mut self,
        at: &At,
        owner: String,
        inherited: Arc<Vec<Arc<Param>>>,
    ) -> Result<Params, SceneError> {
        let (lexer, diagnostics) = self.lexer_and_diagnostics(at.file);
        let given = read_list(lexer, diagnostics)?;
        Ok(Params::new(owner, at.place.clone(), given, inherited))
    }

    /// A type in quotes, then parameters.
    pub(super) fn typed(
        &mut self,
        at: &At,
        name: &str,
        inherited: Arc<Vec<Arc<Param>>>,
    ) -> Result<(String, Place, Params), SceneError> {
        let (ty, place) = self.string(at, "a type")?;
        let params = self.params(at, format!("{name} \"{ty}\""), inherited)?;
        Ok((ty, place, params))
    }

    /// Exactly `N` numbers.
    pub(super) fn numbers<const N: usize>(&mut self, at: &At) -> Result<[f64; N], SceneError> {
        let lexer = self.lexer(at.file);
        let mut numbers = [0.0; N];
        for (i, number) in numbers.iter_mut().enumerate() {
            *number = match lexer.next()? {
                Some(token) => lexer.number(&token).map_err(|error| {
                    error.note(&at.place, format!("this takes {N} numbers; {i} were read"))
                })?,
                None => {
                    let message = format!("the file ends after {i} of {N} numbers");
                    return Err(SceneError::at(&at.place, message));
                }
            };
        }
        Ok(numbers)
    }

    pub(super) fn bracket(&mut self, at: &At, kind: Kind) -> Result<(), SceneError> {
        let lexer = self.lexer(at.file);
        let bracket = if kind == Kind::Open { "[" } else { "]" };
        match lexer.next()? {
            Some(token) if token.kind == kind => Ok(()),
            Some(token) => {
                let message = format!("expected {bracket}, found {}", lexer.shown(&token));
                Err(SceneError::at(&lexer.place(&token), message))
            }
            None => {
                let message = format!("the file ends where {bracket} should be");
                Err(SceneError::at(&lexer.end(), message))
            }
        }
    }

    fn color_space(&mut self, at: &At) -> Result<(), SceneError> {
        let (name, place) = self.string(at, "a colour space")?;
        if name == "srgb" {
            return Ok(());
        }
        let known = ["aces2065-1", "dci-p3", "rec2020"].contains(&name.as_str());
        let what = if known {
            "is not yet supported"
        } else {
            "is unknown"
        };
        let error = SceneError::at(&place, format!("colour space \"{name}\" {what}"));
        self.diagnostics.refuse(error.help("supported is \"srgb\""))
    }

    fn medium_interface(&mut self, at: &At) -> Result<(), SceneError> {
        let named = |(name, place): (String, Place)| -> MediumName {
            (!name.is_empty()).then(|| Arc::new((name, place)))
        };
        let inside = named(self.string(at, "a medium's name")?);
        let second = self.lexer(at.file).peek()?;
        let outside = match second {
            Some(token) if token.kind == Kind::String => named(self.string(at, "a medium's name")?),
            _ => inside.clone(),
        };
        let state = self.state_mut();
        state.inside = inside;
        state.outside = outside;
        Ok(())
    }

    fn other_file(&mut self, at: &At, name: &str) -> Result<(), SceneError> {
        let (file, place) = self.string(at, "a file name")?;
        let import = name == "Import";
        if import {
            self.world_only(at, name)?;
        }
        self.include(&file, &place, import)
    }

    fn world_begin(&mut self, at: &At) -> Result<(), SceneError> {
        self.options_only(at, "WorldBegin")?;
        self.in_world = true;
        let state = self.state_mut();
        state.transforms = [DMat4::IDENTITY; 2];
        state.active = [true; 2];
        let transforms = state.transforms;
        self.coordinate_systems
            .insert("world".to_owned(), transforms);
        Ok(())
    }

    pub(super) fn attribute_begin(&mut self, at: &At, object: bool) -> Result<(), SceneError> {
        self.world_only(
            at,
            if object {
                "ObjectBegin"
            } else {
                "AttributeBegin"
            },
        )?;
        if self.saved.len() == DEEPEST {
            return Err(SceneError::at(&at.place, "blocks are nested too deep"));
        }
        self.objects += usize::from(object);
        self.saved.push(Saved {
            state: Arc::clone(&self.state),
            place: at.place.clone(),
            object,
        });
        Ok(())
    }

    fn attribute_end(&mut self, at: &At) -> Result<(), SceneError> {
        self.world_only(at, "AttributeEnd")?;
        self.restore(at, false)
    }

    pub(super) fn restore(&mut self, at: &At, object: bool) -> Result<(), SceneError> {
        let name = if object { "Object" } else { "Attribute" };
        if self.saved.len() <= self.protected() {
            let message = format!("{name}End without {name}Begin");
            return Err(SceneError::at(&at.place, message));
        }
        let Some(saved) = self.saved.pop() else {
            return Ok(());
        };
        if saved.object != object {
            let message = format!("{name}End does not match the block that is open");
            return Err(SceneError::at(&at.place, message).note(&saved.place, "opened here"));
        }
        self.objects -= usize::from(object);
        self.state = saved.state;
        Ok(())
    }

    fn attribute(&mut self, at: &At) -> Result<(), SceneError> {
        let (target, place) = self.string(at, "a target")?;
        let (lexer, diagnostics) = self.lexer_and_diagnostics(at.file);
        let given = read_list(lexer, diagnostics)?;
        let inherited = &mut self.state_mut().inherited;
        let list = match target.as_str() {
            "shape" => &mut inherited.shape,
            "light" => &mut inherited.light,
            "material" => &mut inherited.material,
            "medium" => &mut inherited.medium,
            "texture" => &mut inherited.texture,
            _ => {
                let targets = ["shape", "light", "material", "medium", "texture"];
                let error = SceneError::at(&place, format!("unknown target \"{target}\""))
                    .help(format!("the targets are {}", targets.join(", ")));
                return self.diagnostics.refuse(error);
            }
        };
        if list.len() + given.len() > MOST {
            let message = format!("more than {MOST} attributes of one target");
            return Err(SceneError::at(&at.place, message));
        }
        Arc::make_mut(list).extend(given.into_iter().map(Arc::new));
        Ok(())
    }
}
