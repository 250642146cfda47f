//! Transmittance of a piecewise constant medium, exactly: T = exp(−Σ σ_t Δ) over the cells of the ray.
//!
//! No variance, no draws; every cell is visited.

use crate::majorant::majorant_depth;
use crate::medium::PiecewiseConstant;
use crate::ray::Ray;
use crate::real::Real;

/// The transmittance of `[0, t_max)` of each active lane's ray; one elsewhere.
///
/// Relative error: that of `exp`, and of the optical depth 1e-7 in a few cells, 3e-6 in a thousand, as the
/// distance to each face is rounded.
#[inline]
pub fn estimate<R: Real, M: PiecewiseConstant<R>>(
    medium: &M,
    ray: &Ray<R>,
    t_max: R,
    active: R::Mask,
) -> R {
    const { assert!(M::TIGHT, "a piecewise constant medium is its own bound") }
    (-majorant_depth(medium, ray, t_max, active)).exp()
}
