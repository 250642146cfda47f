//! The constant environment: the same radiance from everywhere, sampled uniformly.

use crate::phase::{INV_4PI, isotropic};
use crate::real::Real;
use crate::vec3::Vec3;

/// Density over the sphere of [`sample`] [1/sr].
pub const PDF: f32 = INV_4PI;

/// A uniform direction at two uniform numbers in [0, 1).
#[inline(always)]
pub fn sample<R: Real>(u: R, turn: R) -> Vec3<R> {
    let z = isotropic::sample(u);
    let radius = (R::one() - z * z).max(R::zero()).sqrt();
    let (sin, cos) = turn.sin_cos_turn();
    Vec3::new(radius * cos, radius * sin, z)
}
