//! Surfaces made ready to be met by rays: nearest hits, occlusion, and the sampling of those that shine.

use glam::{DVec2, DVec3};

use crate::ray::{Anchor, Ray};
use crate::scene::{MaterialId, Scene, SceneError};

/// Where a ray meets a surface.
#[derive(Clone, Copy, Debug)]
pub struct Hit {
    /// Distance along the ray.
    pub t: f64,
    /// The place, its unit geometric normal (oriented as the scene says: outside of dielectrics, the
    /// shining side of lights) and its error bound.
    pub anchor: Anchor,
    /// Unit shading normal, on the side of the geometric one.
    pub shading_normal: DVec3,
    /// ∂p/∂u made orthogonal to the shading normal, unit: the axis of anisotropic roughness.
    pub tangent: DVec3,
    /// Texture coordinates.
    pub uv: DVec2,
    /// What it is made of; `None` lets light pass.
    pub material: Option<MaterialId>,
    /// Which emitter shines here, if one does.
    pub emitter: Option<u32>,
}

/// A point on an emitter, chosen as light for some place.
#[derive(Clone, Copy, Debug)]
pub struct EmitterPoint {
    /// The place and its normal (oriented as in [`Hit`]).
    pub anchor: Anchor,
    /// Density of the choice per solid angle at the reference [1/sr], or per area [1/length²]; see the method.
    pub pdf: f64,
}

/// All surfaces of a scene that have matter or light.
#[derive(Debug, Default)]
pub struct Surfaces {}

impl Surfaces {
    /// Sorts a scene's surfaces and instances for traversal.
    ///
    /// * `origin`: the place of the world that becomes the origin of rendering.
    ///
    /// # Errors
    /// What is too large for memory.
    pub fn new(_scene: &Scene, _origin: DVec3) -> Result<Self, SceneError> {
        Ok(Self {})
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        true
    }

    /// The corners of a box around all; `None` if there is none.
    pub fn bounds(&self) -> Option<[DVec3; 2]> {
        None
    }

    /// The nearest surface at 0 < t < `t_max`.
    pub fn intersect(&self, _ray: &Ray, _t_max: f64) -> Option<Hit> {
        None
    }

    /// Whether any surface that has a material lies at 0 < t < `t_max`.
    pub fn occluded(&self, _ray: &Ray, _t_max: f64) -> bool {
        false
    }

    /// How many pieces of surface shine: each triangle, patch, disk or sphere of an area light is one.
    pub fn emitters(&self) -> u32 {
        0
    }

    /// Radiance that an emitter sends to the side of its normal, and whether the back shines too.
    pub fn emission(&self, _emitter: u32) -> ([f64; 3], bool) {
        ([0.0; 3], false)
    }

    /// An emitter's area \[length²\].
    pub fn area(&self, _emitter: u32) -> f64 {
        0.0
    }

    /// The corners of a box around an emitter, and the unit vector and cosine of a cone around its normals.
    pub fn emitter_bounds(&self, _emitter: u32) -> ([DVec3; 2], DVec3, f64) {
        ([DVec3::ZERO; 2], DVec3::Z, -1.0)
    }

    /// A point on an emitter as seen from `reference`, by solid angle where that can be done; the density is per
    /// solid angle.
    pub fn sample_emitter(
        &self,
        _emitter: u32,
        _reference: DVec3,
        _u: [f64; 2],
    ) -> Option<EmitterPoint> {
        None
    }

    /// The density per solid angle with which [`sample_emitter`](Self::sample_emitter) finds a point of the emitter.
    pub fn emitter_pdf(&self, _emitter: u32, _reference: DVec3, _point: &Anchor) -> f64 {
        0.0
    }

    /// A point spread evenly over an emitter; the density is per area.
    pub fn sample_emitter_area(&self, _emitter: u32, _u: [f64; 2]) -> EmitterPoint {
        EmitterPoint {
            anchor: Anchor::in_space(DVec3::ZERO),
            pdf: 0.0,
        }
    }

    /// The density per area of [`sample_emitter_area`](Self::sample_emitter_area) at a point.
    pub fn emitter_area_pdf(&self, _emitter: u32, _point: &Anchor) -> f64 {
        0.0
    }
}
