//! Lights made ready: which light to ask at a place, in which direction it lies, and where its light begins.
//!
//! Radiances are linear Rec. 709, times the film's factor on every pixel.

use glam::DVec3;

use crate::ray::Anchor;
use crate::scene::{Files, Scene, SceneError};
use crate::surface::{Hit, Surfaces};
use crate::volume::Limits;

/// A sphere around everything that light can meet, for light from far away.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// Its centre.
    pub centre: DVec3,
    /// Its radius \[length\], positive and finite.
    pub radius: f64,
}

/// A light seen from a place.
#[derive(Clone, Copy, Debug)]
pub struct LightSample {
    /// Index of the light.
    pub light: u32,
    /// Where the light is; `None` is infinitely far.
    pub anchor: Option<Anchor>,
    /// Unit direction to it.
    pub direction: DVec3,
    /// Radiance by colour that arrives if nothing is in between; for points and directions the irradiance on
    /// a surface that faces them.
    pub radiance: [f64; 3],
    /// Density per solid angle of the direction, *without* the choice of the light; one for points and directions [1/sr].
    pub pdf: f64,
    /// Probability of the choice of this light.
    pub choice: f64,
    /// A point or a direction: nothing but this sampling finds it.
    pub delta: bool,
}

/// Light that sets out.
#[derive(Clone, Copy, Debug)]
pub struct Departure {
    /// Index of the light.
    pub light: u32,
    /// Where it begins: on the light; for light from far away on a disk outside of the [`Bounds`].
    pub anchor: Anchor,
    /// Unit direction of travel.
    pub direction: DVec3,
    /// Radiance by colour (intensity for points, irradiance for directions), not divided by any density.
    pub radiance: [f64; 3],
    /// Density of the place: per area; one for points; for light from far away, per area of the disk across.
    pub pdf_position: f64,
    /// Density of the direction per solid angle; one for light in one direction [1/sr].
    pub pdf_direction: f64,
    /// Probability of the choice of this light.
    pub choice: f64,
    /// |cos| between the direction and the light's normal; one for lights without a surface.
    pub cosine: f64,
}

/// All lights of a scene but emissive media.
#[derive(Debug, Default)]
pub struct Lights {}

impl Lights {
    /// Reads pictures, and builds what choices are made by. Lights number: those of the scene first, in file order,
    /// then the emitters of `surfaces`.
    ///
    /// * `origin`: the place of the world that becomes the origin of rendering.
    ///
    /// # Errors
    /// Files that cannot be read, values out of range, at the light's place.
    pub fn new(
        _scene: &Scene,
        _surfaces: &Surfaces,
        _bounds: Bounds,
        _origin: DVec3,
        _files: &dyn Files,
        _limits: &Limits,
    ) -> Result<Self, SceneError> {
        Ok(Self {})
    }

    /// Whether no light can be sampled.
    pub fn is_empty(&self) -> bool {
        true
    }

    /// Index of the first emitter's light.
    pub fn first_emitter(&self) -> u32 {
        0
    }

    /// Chooses a light by `u[0]` and a direction to it by the rest. The choice depends on the place (and, on
    /// surfaces, the shading normal; zero in space).
    pub fn sample(
        &self,
        _surfaces: &Surfaces,
        _from: DVec3,
        _normal: DVec3,
        _u: [f64; 3],
    ) -> Option<LightSample> {
        None
    }

    /// Probability with which [`sample`](Self::sample) chooses a light at a place.
    pub fn choice(&self, _light: u32, _from: DVec3, _normal: DVec3) -> f64 {
        0.0
    }

    /// Density, choice included, with which [`sample`](Self::sample) at `from` finds an emitter where it was hit [1/sr].
    pub fn hit_pdf(&self, _surfaces: &Surfaces, _from: DVec3, _normal: DVec3, _hit: &Hit) -> f64 {
        0.0
    }

    /// Radiance that arrives from far away in a direction: of all lights that fill it (not those in one direction only).
    pub fn escape_radiance(&self, _direction: DVec3) -> [f64; 3] {
        [0.0; 3]
    }

    /// For every light that contributes to [`escape_radiance`](Self::escape_radiance): its index, radiance and
    /// density without the choice [1/sr].
    pub fn escapes(
        &self,
        _direction: DVec3,
    ) -> impl Iterator<Item = (u32, [f64; 3], f64)> + use<'_> {
        std::iter::empty()
    }

    /// Chooses a light by its power, a place and a direction for light to set out: for paths from lights.
    pub fn emit(&self, _surfaces: &Surfaces, _u: [f64; 5]) -> Option<Departure> {
        None
    }

    /// Probability with which [`emit`](Self::emit) chooses a light.
    pub fn emission_choice(&self, _light: u32) -> f64 {
        0.0
    }

    /// Densities of the place and of the direction with which [`emit`](Self::emit) sends light of this light from
    /// `anchor` (anywhere for light from far away) in a direction of travel; without the choice.
    pub fn emission_pdf(
        &self,
        _surfaces: &Surfaces,
        _light: u32,
        _anchor: &Anchor,
        _direction: DVec3,
    ) -> (f64, f64) {
        (0.0, 0.0)
    }
}
