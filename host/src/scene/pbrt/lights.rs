//! `LightSource`: lights from far away; and what all lights have in common.

use std::f64::consts::PI;

use glam::DVec3;

use super::super::SceneError;
use super::super::light::{ConstantLight, DistantLight, ImageLight, Light};
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
            "point" => self.point_light(at, &params),
            "spot" => self.spot_light(at, &params),
            "goniometric" => self.goniometric_light(at, &params),
            other => {
                let known = NAMES.contains(&other) && other != "diffuse";
                let what = if known {
                    "is not yet supported"
                } else {
                    "is unknown"
                };
                let error = SceneError::at(&place, format!("light source \"{other}\" {what}"));
                let near = nearest(other, NAMES).filter(|_| !known);
                self.diagnostics.refuse(match near {
                    Some("diffuse") => error.help("AreaLightSource is what shapes shine by"),
                    Some(near) => error.help(format!("did you mean \"{near}\"?")),
                    None => {
                        error.help("supported are distant, infinite, point, spot and goniometric")
                    }
                })
            }
        }
    }

    fn distant(&mut self, at: &At, params: &Params) -> Result<(), SceneError> {
        let illuminance = positive(params, "illuminance")?.unwrap_or(1.0);
        let irradiance = emitted(params, "L", illuminance, &mut self.diagnostics)?;
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
        let instead = "let the whole picture shine";
        params.unsupported("portal", instead, &mut self.diagnostics)?;
        if params.find("filename", &[Type::String])?.is_some() {
            return self.sky(at, params);
        }
        // pbrt means the illuminance below one half of a uniform sky: pi times its luminance.
        let level = positive(params, "illuminance")?.map_or(1.0, |lux| lux / PI);
        let radiance = emitted(params, "L", level, &mut self.diagnostics)?;
        params.finish(&mut self.diagnostics)?;
        self.world.lights.push(Light::Constant(ConstantLight {
            radiance,
            place: at.place.clone(),
        }));
        Ok(())
    }

    /// An infinite light with a picture.
    fn sky(&mut self, at: &At, params: &Params) -> Result<(), SceneError> {
        let types = [Type::Rgb, Type::Spectrum, Type::Blackbody];
        if let Some(param) = params.find("L", &types)? {
            let message = "an infinite light has either \"L\" or \"filename\"";
            return Err(SceneError::at(&param.declared, message));
        }
        let filename = self.existing_file(params, "filename", "this light")?;
        let illuminance = positive(params, "illuminance")?;
        let scale = scale(params)?;
        params.finish(&mut self.diagnostics)?;
        self.not_moving(&at.place)?;
        let [light_to_world, _] = affine(&self.state.transforms[0], &at.place)?;
        self.world.lights.push(Light::Image(ImageLight {
            filename,
            scale,
            illuminance,
            light_to_world,
            place: at.place.clone(),
        }));
        Ok(())
    }
}

/// A level that pbrt takes as not given unless it is positive.
pub(super) fn positive(params: &Params, name: &'static str) -> Result<Option<f64>, SceneError> {
    let level = params.float(name, "a number", |_| true)?;
    Ok(level.filter(|level| *level > 0.0))
}

/// The factor that every light has.
pub(super) fn scale(params: &Params) -> Result<f64, SceneError> {
    let scale = params.float("scale", "0 or more", |v| v >= 0.0)?;
    Ok(scale.unwrap_or(1.0))
}

/// The colour of `name` times `scale` times `level`; white by default.
pub(super) fn emitted(
    params: &Params,
    name: &'static str,
    level: f64,
    diagnostics: &mut Diagnostics,
) -> Result<[f64; 3], SceneError> {
    let colour = params.emission(name, diagnostics)?.unwrap_or([1.0; 3]);
    let scale = scale(params)?;
    let emitted = colour.map(|c| c * scale * level);
    // Rendering is in f32.
    if emitted.iter().all(|c| (*c as f32).is_finite()) {
        return Ok(emitted);
    }
    let message = format!("this light is too bright: {emitted:?}");
    Err(SceneError::at(params.place(), message))
}
