//! How surfaces reflect and transmit light.
//!
//! Directions are unit vectors away from the surface. A side is *outside* where its cosine with the normal is
//! positive.

use glam::DVec3;

use crate::scene::{Files, Material, SceneError};
use crate::surface::Hit;
use crate::volume::Limits;

/// What is carried along a path. They differ at refraction, where radiance is squeezed into a smaller cone: by the
/// square of the index ([Veach 1997], chapter 5).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Transport {
    /// Paths from the camera.
    Radiance,
    /// Paths from lights.
    Importance,
}

/// A direction chosen at a surface.
#[derive(Clone, Copy, Debug)]
pub struct BsdfSample {
    /// Unit direction away from the surface.
    pub direction: DVec3,
    /// The BSDF times |cos θ| over the density of the choice, by colour.
    pub weight: [f64; 3],
    /// Density of the choice per solid angle [1/sr]; for specular scattering the probability of its kind.
    pub pdf: f64,
    /// A direction that no other strategy finds.
    pub specular: bool,
}

/// The materials of a scene, with their pictures.
#[derive(Debug, Default)]
pub struct Materials {}

impl Materials {
    /// Reads the pictures that materials ask for.
    ///
    /// # Errors
    /// Files that cannot be read, at the texture's place.
    pub fn new(
        _materials: &[Material],
        _files: &dyn Files,
        _limits: &Limits,
    ) -> Result<Self, SceneError> {
        Ok(Self {})
    }

    /// The BSDF at a hit.
    pub fn at(&self, _hit: &Hit) -> Bsdf {
        Bsdf {}
    }
}

/// How a surface scatters at one place.
#[derive(Clone, Copy, Debug)]
pub struct Bsdf {}

impl Bsdf {
    /// Whether every direction it can choose is one that no other strategy finds.
    pub fn is_specular(&self) -> bool {
        true
    }

    /// The BSDF times |cos θ| of `to`, by colour [1/sr]; zero for specular parts. `from` is where the path came from
    /// (away from the surface), `to` where it goes.
    pub fn eval(&self, _from: DVec3, _to: DVec3, _transport: Transport) -> [f64; 3] {
        [0.0; 3]
    }

    /// The density with which [`sample`](Self::sample) chooses `to` [1/sr]; zero for specular parts.
    pub fn pdf(&self, _from: DVec3, _to: DVec3, _transport: Transport) -> f64 {
        0.0
    }

    /// Chooses a direction; `None` where the light is absorbed.
    pub fn sample(&self, _from: DVec3, _u: [f64; 3], _transport: Transport) -> Option<BsdfSample> {
        None
    }

    /// Bound on the part of light that goes on, by colour, for roulette.
    pub fn albedo(&self) -> [f64; 3] {
        [0.0; 3]
    }
}
