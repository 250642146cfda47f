//! `Material`, `MakeNamedMaterial`, `NamedMaterial`: what surfaces are made of.

use std::sync::Arc;

use super::super::surface::{self, MaterialId, MaterialKind};
use super::super::{Place, SceneError, Texture};
use super::directive::At;
use super::param::{Type, Values};
use super::params::Params;
use super::reader::Reader;
use super::spectra::{self, Optical};
use super::state::Material;
use super::suggest::nearest;

const SUPPORTED: &str =
    "supported are diffuse, dielectric, thindielectric, conductor and interface";
const MATERIALS: [&str; 13] = [
    "coatedconductor",
    "coateddiffuse",
    "conductor",
    "debug",
    "dielectric",
    "diffuse",
    "diffusetransmission",
    "hair",
    "interface",
    "measured",
    "mix",
    "subsurface",
    "thindielectric",
];

impl Reader<'_> {
    pub(super) fn material(&mut self, at: &At) -> Result<(), SceneError> {
        self.world_only(at, "Material")?;
        let inherited = self.state.inherited.material.clone();
        let (ty, place, params) = self.typed(at, "Material", inherited)?;
        self.state_mut().material = self.material_of(&ty, &place, &params)?;
        Ok(())
    }

    pub(super) fn make_named_material(&mut self, at: &At) -> Result<(), SceneError> {
        self.world_only(at, "MakeNamedMaterial")?;
        let (name, place) = self.string(at, "a material's name")?;
        let inherited = self.state.inherited.material.clone();
        let params = self.params(at, format!("material \"{name}\""), inherited)?;
        if let Some((_, older)) = self.world.material_names.get(&name) {
            let message = format!("material \"{name}\" is defined twice");
            return Err(SceneError::at(&place, message).note(older, "first here"));
        }
        let Some(ty) = params.string("type")?.cloned() else {
            let message = format!("material \"{name}\" has no \"string type\"");
            return Err(SceneError::at(&place, message));
        };
        let material = self.material_of(&ty.text, &ty.place, &params)?;
        self.world.material_names.insert(name, (material, place));
        Ok(())
    }

    pub(super) fn named_material(&mut self, at: &At) -> Result<(), SceneError> {
        self.world_only(at, "NamedMaterial")?;
        let named = self.string(at, "a material's name")?;
        self.state_mut().material = Material::Named(Arc::new(named));
        Ok(())
    }

    fn material_of(
        &mut self,
        ty: &str,
        place: &Place,
        params: &Params,
    ) -> Result<Material, SceneError> {
        let kind = match ty {
            // The other two are what pbrt-v3 called it.
            "interface" | "" | "none" => None,
            "diffuse" => Some(self.diffuse(params)?),
            "dielectric" => Some(MaterialKind::Dielectric {
                eta: self.refractive_index(params)?,
                alpha: self.roughness(params)?,
            }),
            "thindielectric" => Some(MaterialKind::ThinDielectric {
                eta: self.refractive_index(params)?,
            }),
            "conductor" => Some(self.conductor(params)?),
            other => {
                let known = MATERIALS.contains(&other);
                let what = if known {
                    "is not yet supported"
                } else {
                    "is unknown"
                };
                let error = SceneError::at(place, format!("material \"{other}\" {what}"));
                let near = nearest(other, MATERIALS).filter(|_| !known);
                self.diagnostics.refuse(match near {
                    Some(near) => error.help(format!("did you mean \"{near}\"?")),
                    None => error.help(SUPPORTED),
                })?;
                return Ok(Material::Unsupported);
            }
        };
        let bumps = [
            ("displacement", "surfaces have no bumps"),
            ("normalmap", "surfaces have no bumps"),
        ];
        for (name, instead) in bumps.into_iter().filter(|_| kind.is_some()) {
            params.unsupported(name, instead, &mut self.diagnostics)?;
        }
        params.finish(&mut self.diagnostics)?;
        let Some(kind) = kind else {
            return Ok(Material::Interface);
        };
        self.world.materials.push(surface::Material {
            kind,
            place: params.place().clone(),
        });
        Ok(Material::Made(MaterialId(self.world.materials.len() - 1)))
    }

    fn diffuse(&mut self, params: &Params) -> Result<MaterialKind, SceneError> {
        let reflectance = self.colour_texture(params, "reflectance")?;
        let reflectance = reflectance.unwrap_or(Texture::Constant([0.5; 3]));
        if let Some(param) = params.find("reflectance", &COLOURS)?
            && let Texture::Constant(rgb) = reflectance
        {
            not_above_one("reflectance", rgb, &param.valued)?;
        }
        Ok(MaterialKind::Diffuse { reflectance })
    }

    /// `eta` of a transparent matter: 1.5 by default, as in pbrt.
    fn refractive_index(&mut self, params: &Params) -> Result<f64, SceneError> {
        let Some(param) = params.find("eta", &[Type::Float, Type::Spectrum, Type::Texture])? else {
            return Ok(1.5);
        };
        let eta = if param.ty == Type::Spectrum {
            spectra::glass(param, &mut self.diagnostics)?
        } else {
            self.number(params, "eta")?.unwrap_or(1.5)
        };
        if eta > 0.0 {
            return Ok(eta);
        }
        let message = format!("a refractive index must be positive, found {eta}");
        Err(SceneError::at(&param.nth(0), message))
    }

    /// `eta` and `k`, copper by default; or `reflectance`, which pbrt turns into an index of one and the
    /// extinction that reflects as much head-on: `k = 2 √r / √(1 − r)`.
    fn conductor(&mut self, params: &Params) -> Result<MaterialKind, SceneError> {
        let alpha = self.roughness(params)?;
        if let Some(param) = params.find("reflectance", &COLOURS)? {
            for name in ["eta", "k"] {
                let types = [Type::Rgb, Type::Spectrum, Type::Texture];
                if let Some(other) = params.find(name, &types)? {
                    let message = format!("give either \"reflectance\" or \"{name}\"");
                    return Err(SceneError::at(&other.declared, message)
                        .note(&param.declared, "the reflectance"));
                }
            }
            let texture = self.colour_texture(params, "reflectance")?;
            let reflectance = match texture {
                Some(Texture::Constant(rgb)) => rgb,
                _ => {
                    let instead = "the reflectance of a conductor must be constant";
                    self.diagnostics.refuse(params.not_yet(param, instead))?;
                    [0.5; 3]
                }
            };
            not_above_one("reflectance", reflectance, &param.valued)?;
            // Total reflection would need an infinite extinction; pbrt stops there, too.
            let k = reflectance.map(|r| {
                let r = r.min(0.9999);
                2.0 * r.sqrt() / (1.0 - r).sqrt()
            });
            return Ok(MaterialKind::Conductor {
                eta: [1.0; 3],
                k,
                alpha,
            });
        }
        let mut optical = |name, which| -> Result<[f64; 3], SceneError> {
            if let Some(param) = params.find(name, &[Type::Rgb, Type::Spectrum, Type::Texture])?
                && param.ty == Type::Texture
            {
                let instead = "the indices of a conductor must be constant";
                self.diagnostics.refuse(params.not_yet(param, instead))?;
                return Ok(spectra::COPPER.project(which));
            }
            spectra::metal(params, name, which, &mut self.diagnostics)
        };
        Ok(MaterialKind::Conductor {
            eta: optical("eta", Optical::Eta)?,
            k: optical("k", Optical::K)?,
            alpha,
        })
    }

    /// Widths of the GGX distribution from `roughness` or one of each direction.
    fn roughness(&mut self, params: &Params) -> Result<[f64; 2], SceneError> {
        let both = self.number(params, "roughness")?.unwrap_or(0.0);
        let u = self.number(params, "uroughness")?.unwrap_or(both);
        let v = self.number(params, "vroughness")?.unwrap_or(both);
        let remap = params.boolean("remaproughness")?.unwrap_or(true);
        for (name, value) in [("roughness", both), ("uroughness", u), ("vroughness", v)] {
            if !(value >= 0.0 && (value as f32).is_finite()) {
                let types = [Type::Float, Type::Texture];
                let param = params.find(name, &types)?;
                let place = param.map_or(params.place(), |p| &p.valued);
                let message = format!("\"{name}\" must be 0 or more, found {value}");
                return Err(SceneError::at(place, message));
            }
        }
        Ok([u, v].map(|roughness| if remap { roughness.sqrt() } else { roughness }))
    }

    /// A number, or a texture that is one.
    pub(super) fn number(
        &mut self,
        params: &Params,
        name: &'static str,
    ) -> Result<Option<f64>, SceneError> {
        let types = [Type::Float, Type::Texture];
        match params.find(name, &types)? {
            Some(param) if param.ty == Type::Texture => {
                let Values::Strings(names) = &param.values else {
                    return Ok(None);
                };
                let [name] = names.as_slice() else {
                    let message = format!("\"{}\" takes one texture", param.name);
                    return Err(SceneError::at(&param.valued, message));
                };
                self.float_texture(name)
            }
            _ => params.float(name, "a number", |_| true),
        }
    }
}

/// What a colour may be given as.
pub(super) const COLOURS: [Type; 3] = [Type::Rgb, Type::Spectrum, Type::Texture];

fn not_above_one(name: &str, rgb: [f64; 3], place: &Place) -> Result<(), SceneError> {
    match rgb.iter().find(|c| **c > 1.0) {
        Some(c) => {
            let message = format!("\"{name}\" must not exceed 1, found {c}");
            Err(SceneError::at(place, message).help("more light would leave than came"))
        }
        None => Ok(()),
    }
}
