//! `LightSource` "point", "spot" and "goniometric": light from one place.

use std::f64::consts::PI;

use glam::{DAffine3, DMat3, DVec3};

use super::super::light::{GoniometricLight, Light, PointLight, SpotLight};
use super::super::{Place, SceneError};
use super::directive::At;
use super::lights::{emitted, positive};
use super::params::Params;
use super::reader::Reader;
use super::state::affine;

impl Reader<'_> {
    pub(super) fn point_light(&mut self, at: &At, params: &Params) -> Result<(), SceneError> {
        let level = positive(params, "power")?.map_or(1.0, |power| power / (4.0 * PI));
        let intensity = emitted(params, "I", level, &mut self.diagnostics)?;
        let from = params.point("from")?.unwrap_or(DVec3::ZERO);
        params.finish(&mut self.diagnostics)?;
        let light_to_world = self.light_to_world(at)?;
        self.world.lights.push(Light::Point(PointLight {
            position: position(&light_to_world, from, &at.place)?,
            intensity,
            place: at.place.clone(),
        }));
        Ok(())
    }

    pub(super) fn spot_light(&mut self, at: &At, params: &Params) -> Result<(), SceneError> {
        let width = params
            .float("coneangle", "above 0 and at most 180 degrees", |v| {
                v > 0.0 && v <= 180.0
            })?
            .unwrap_or(30.0);
        let falloff = params
            .float("conedeltaangle", "from 0 to the cone's angle", |v| {
                (0.0..=width).contains(&v)
            })?
            .unwrap_or(5.0_f64.min(width));
        let cos_total_width = cosine(width);
        let cos_falloff_start = cosine(width - falloff).max(cos_total_width);
        // The smoothstep has a mean of one half over the cosines between.
        let solid_angle =
            2.0 * PI * ((1.0 - cos_falloff_start) + 0.5 * (cos_falloff_start - cos_total_width));
        let power = positive(params, "power")?;
        let level = power.map_or(1.0, |power| power / solid_angle);
        let intensity = emitted(params, "I", level, &mut self.diagnostics)?;
        let from = params.point("from")?.unwrap_or(DVec3::ZERO);
        let to = params.point("to")?.unwrap_or(DVec3::Z);
        params.finish(&mut self.diagnostics)?;
        let light_to_world = self.light_to_world(at)?;
        let axis = (to - from)
            .try_normalize()
            .and_then(|w| light_to_world.transform_vector3(w).try_normalize());
        let Some(axis) = axis else {
            let message = "\"from\" and \"to\" of a spotlight must differ";
            return Err(SceneError::at(params.place(), message));
        };
        self.world.lights.push(Light::Spot(SpotLight {
            position: position(&light_to_world, from, &at.place)?,
            axis,
            cos_falloff_start,
            cos_total_width,
            intensity,
            place: at.place.clone(),
        }));
        Ok(())
    }

    pub(super) fn goniometric_light(&mut self, at: &At, params: &Params) -> Result<(), SceneError> {
        let filename = self.existing_file(params, "filename", "this goniometric light")?;
        let power = positive(params, "power")?;
        let intensity = emitted(params, "I", 1.0, &mut self.diagnostics)?;
        params.finish(&mut self.diagnostics)?;
        // pbrt's pictures have y upwards, its octahedron z.
        let swap = DMat3::from_cols(DVec3::X, DVec3::Z, DVec3::Y);
        let light_to_world = self.light_to_world(at)? * DAffine3::from_mat3(swap);
        position(&light_to_world, DVec3::ZERO, &at.place)?;
        self.world.lights.push(Light::Goniometric(GoniometricLight {
            filename,
            light_to_world,
            intensity,
            power,
            place: at.place.clone(),
        }));
        Ok(())
    }

    fn light_to_world(&mut self, at: &At) -> Result<DAffine3, SceneError> {
        self.not_moving(&at.place)?;
        let [light_to_world, _] = affine(&self.state.transforms[0], &at.place)?;
        Ok(light_to_world)
    }
}

/// Exact where the angle \[degrees\] is a quarter turn.
fn cosine(degrees: f64) -> f64 {
    if degrees == 90.0 {
        0.0
    } else {
        libm::cos(degrees.to_radians())
    }
}

fn position(to_world: &DAffine3, from: DVec3, place: &Place) -> Result<DVec3, SceneError> {
    let position = to_world.transform_point3(from);
    if position.as_vec3().is_finite() {
        return Ok(position);
    }
    let message = "the position of this light is not finite in the world";
    Err(SceneError::at(place, message))
}
