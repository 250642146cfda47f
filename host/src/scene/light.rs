//! Lights that are not surfaces: far away, or points.

use std::path::PathBuf;

use glam::{DAffine3, DVec3};

use super::Place;

/// A source of light.
#[derive(Clone, Debug)]
pub enum Light {
    /// All light from one direction, like the sun seen from here.
    Distant(DistantLight),
    /// The same radiance from every direction.
    Constant(ConstantLight),
    /// A picture of the radiance from every direction.
    Image(ImageLight),
    /// A point that shines alike in all directions.
    Point(PointLight),
    /// A point that shines into a cone.
    Spot(SpotLight),
    /// A point that shines as a picture says.
    Goniometric(GoniometricLight),
}

impl Light {
    /// Where it is described.
    pub fn place(&self) -> &Place {
        match self {
            Self::Distant(light) => &light.place,
            Self::Constant(light) => &light.place,
            Self::Image(light) => &light.place,
            Self::Point(light) => &light.place,
            Self::Spot(light) => &light.place,
            Self::Goniometric(light) => &light.place,
        }
    }
}

impl Light {
    /// Where it is described, to be changed.
    pub(super) fn place_mut(&mut self) -> &mut Place {
        match self {
            Self::Distant(light) => &mut light.place,
            Self::Constant(light) => &mut light.place,
            Self::Image(light) => &mut light.place,
            Self::Point(light) => &mut light.place,
            Self::Spot(light) => &mut light.place,
            Self::Goniometric(light) => &mut light.place,
        }
    }
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

/// An infinitely large sphere with a picture on it. A picture twice as wide as high is a map of latitude (its rows,
/// +z on top) and longitude (its columns, from +x over +y); a square one is pbrt-v4's equal-area octahedron.
#[derive(Clone, Debug)]
pub struct ImageLight {
    /// The file (.exr or .png), resolved against the scene's directory; it existed when the scene was read.
    pub filename: PathBuf,
    /// Factor on every pixel, unless `illuminance` decides.
    pub scale: f64,
    /// Illuminance on a horizontal plane (normal +z of the light's space) that the picture is scaled to give.
    pub illuminance: Option<f64>,
    /// From the light's space to the world; its rotation is what counts.
    pub light_to_world: DAffine3,
    /// Where it is described.
    pub place: Place,
}

/// A point that shines alike in all directions.
#[derive(Clone, Debug)]
pub struct PointLight {
    /// Where it is.
    pub position: DVec3,
    /// Radiant intensity per channel \[W/sr\], not negative.
    pub intensity: [f64; 3],
    /// Where it is described.
    pub place: Place,
}

/// A point that shines into a cone: full intensity up to `cos_falloff_start`, none from `cos_total_width` on,
/// pbrt's smoothstep of the cosine between.
#[derive(Clone, Debug)]
pub struct SpotLight {
    /// Where it is.
    pub position: DVec3,
    /// Unit axis of the cone, away from the light.
    pub axis: DVec3,
    /// Cosine of the angle up to which it shines fully.
    pub cos_falloff_start: f64,
    /// Cosine of the angle from which it is dark; at most `cos_falloff_start`.
    pub cos_total_width: f64,
    /// Radiant intensity along the axis, per channel \[W/sr\], not negative.
    pub intensity: [f64; 3],
    /// Where it is described.
    pub place: Place,
}

/// A point whose intensity a picture scales: a square one, pbrt-v4's equal-area octahedron.
#[derive(Clone, Debug)]
pub struct GoniometricLight {
    /// The file, resolved against the scene's directory; it existed when the scene was read.
    pub filename: PathBuf,
    /// From the picture's space to the world: its translation is the place, the rest turns the picture. pbrt's
    /// exchange of y and z is worked in, so that it mirrors.
    pub light_to_world: DAffine3,
    /// Radiant intensity where the picture is one, per channel \[W/sr\], not negative. (pbrt's `power`
    /// needs the picture; then this is its share per unit of power and `power` is given.)
    pub intensity: [f64; 3],
    /// Total power that the light is scaled to \[W\].
    pub power: Option<f64>,
    /// Where it is described.
    pub place: Place,
}
