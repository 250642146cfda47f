//! `LightSource` and `AreaLightSource`.

use std::f64::consts::PI;

use glam::DVec3;

use super::super::light::{ConstantLight, DistantLight, Light};
use super::super::{Place, SceneError};
use super::diagnostics::Diagnostics;
use super::directive::At;
use super::param::Type;
use super::params::Params;
use super::reader::Reader;
use super::state::affine;
use super::suggest::nearest;

const NAMES: [&str; 7] = [
    "distant",
    "goniometric",
    "infinite",
    "point",
    "projection",
    "spot",
    "diffuse",
];

impl Reader<'_> {
    pub(super) fn light_source(&mut self, at: &At) -> Result<(), SceneError> {
        self.world_only(at, "LightSource")?;
        let inherited = self.state.inherited.light.clone();
        let (ty, place, params) = self.typed(at, "LightSource", inherited)?;
        match ty.as_str() {
            "distant" => self.distant(at, &params),
            "infinite" => self.infinite(at, &params),
            other => {
                let known = NAMES.contains(&other) && other != "diffuse";
                let what = if known {
                    "is not yet supported"
                } else {
                    "is unknown"
                };
                let error = SceneError::at(&place, format!("light source \"{other}\" {what}"));
                let near = nearest(other, ["distant", "infinite"]).filter(|_| !known);
                self.diagnostics.refuse(match near {
                    Some(near) => error.help(format!("did you mean \"{near}\"?")),
                    None => error.help("supported are distant, and infinite without an image"),
                })
            }
        }
    }

    fn distant(&mut self, at: &At, params: &Params) -> Result<(), SceneError> {
        let illuminance = illuminance(params)?.unwrap_or(1.0);
        let irradiance = emitted(params, illuminance, &mut self.diagnostics)?;
        let from = params.point("from")?.unwrap_or(DVec3::ZERO);
        let to = params.point("to")?.unwrap_or(DVec3::Z);
        params.finish(&mut self.diagnostics)?;
        self.not_moving(&at.place)?;
        let [light_to_world, _] = affine(&self.state.transforms[0], &at.place)?;
        let direction = (from - to)
            .try_normalize()
            .and_then(|w| light_to_world.transform_vector3(w).try_normalize());
        let Some(direction_to_light) = direction else {
            let message = "\"from\" and \"to\" of a distant light must differ";
            return Err(SceneError::at(params.place(), message));
        };
        self.world.lights.push(Light::Distant(DistantLight {
            direction_to_light,
            irradiance,
            place: at.place.clone(),
        }));
        Ok(())
    }

    fn infinite(&mut self, at: &At, params: &Params) -> Result<(), SceneError> {
        let instead = "supported is constant radiance: \"rgb L\" [ r g b ]";
        if let Some(param) = params.find("filename", &[Type::String])? {
            let message = "image environment maps are not yet supported";
            self.diagnostics
                .refuse(SceneError::at(&param.declared, message).help(instead))?;
            return Ok(());
        }
        params.unsupported("portal", instead, &mut self.diagnostics)?;
        // pbrt means the illuminance below one half of a uniform sky: pi times its luminance.
        let level = illuminance(params)?.map_or(1.0, |lux| lux / PI);
        let radiance = emitted(params, level, &mut self.diagnostics)?;
        params.finish(&mut self.diagnostics)?;
        self.world.lights.push(Light::Constant(ConstantLight {
            radiance,
            place: at.place.clone(),
        }));
        Ok(())
    }

    pub(super) fn area_light_source(&mut self, at: &At) -> Result<(), SceneError> {
        self.world_only(at, "AreaLightSource")?;
        let inherited = self.state.inherited.light.clone();
        let (ty, place, _) = self.typed(at, "AreaLightSource", inherited)?;
        let what = if ty == "diffuse" {
            "is not yet supported"
        } else {
            "is unknown"
        };
        self.diagnostics.refuse(
            SceneError::at(&place, format!("area light \"{ty}\" {what}"))
                .help("supported are LightSource distant and infinite"),
        )
    }
}

/// Given and positive; pbrt takes anything else as not given.
fn illuminance(params: &Params) -> Result<Option<f64>, SceneError> {
    let lux = params.float("illuminance", "a number", |_| true)?;
    Ok(lux.filter(|lux| *lux > 0.0))
}

/// `L` times `scale` times `level`; white by default.
fn emitted(
    params: &Params,
    level: f64,
    diagnostics: &mut Diagnostics,
) -> Result<[f64; 3], SceneError> {
    let colour = params.emission("L", diagnostics)?.unwrap_or([1.0; 3]);
    let scale = params
        .float("scale", "0 or more", |v| v >= 0.0)?
        .unwrap_or(1.0);
    let emitted = colour.map(|c| c * scale * level);
    // Rendering is in f32.
    if emitted.iter().all(|c| (*c as f32).is_finite()) {
        return Ok(emitted);
    }
    let place: &Place = params.place();
    Err(SceneError::at(
        place,
        format!("this light is too bright: {emitted:?}"),
    ))
}
