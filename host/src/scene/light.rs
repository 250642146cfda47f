//! Lights far away: a direction, or the whole sky.

use glam::DVec3;

use super::Place;

/// A source of light.
#[derive(Clone, Debug)]
pub enum Light {
    /// All light from one direction, like the sun seen from here.
    Distant(DistantLight),
    /// The same radiance from every direction.
    Constant(ConstantLight),
}

/// Light from one direction.
#[derive(Clone, Debug)]
pub struct DistantLight {
    /// Unit vector in the world, from the scene towards the light.
    pub direction_to_light: DVec3,
    /// Irradiance on a plane that faces the light, per channel \[W/m²\], not negative. It is what pbrt
    /// calls `L` times `scale`.
    pub irradiance: [f64; 3],
    /// Where it is described.
    pub place: Place,
}

/// An infinitely large sphere of constant radiance.
#[derive(Clone, Debug)]
pub struct ConstantLight {
    /// Radiance per channel \[W/(m² sr)\], not negative.
    pub radiance: [f64; 3],
    /// Where it is described.
    pub place: Place,
}
