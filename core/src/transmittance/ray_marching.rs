//! Ray marching. **BIASED**, for comparison only.
//!
//! ```text
//! T ≈ exp(−(L/n) Σᵢ σ_t((i + ξ) L/n)),   one jitter ξ for all steps
//! ```
//!
//! The sum estimates the optical depth without bias, but its exponential overestimates the transmittance:
//! E\[e^−X\] > e^−E\[X\] (Jensen), by the factor e^(Var X / 2) to lowest order. No number of averaged
//! samples removes that; only more steps do. It is what unbiased estimators set out to replace, and what
//! [`power_series`](super::power_series) repairs. No registry row, and nothing in this project uses it
//! but tests and benches.

use crate::medium::Medium;
use crate::ray::Ray;
use crate::real::Real;
use crate::stream::Stream;
use crate::transmittance::power_series::comb_in_distance;

/// One BIASED sample of the transmittance of `[0, t_max)` of each active lane's ray, from `steps` look-ups.
#[inline]
pub fn estimate<R: Real, M: Medium<R>>(
    medium: &M,
    ray: &Ray<R>,
    t_max: R,
    steps: u32,
    rng: &mut impl Stream<R>,
    active: R::Mask,
) -> R {
    let points = R::splat(steps.max(1) as f32);
    (-comb_in_distance(medium, ray, t_max, points, rng, active)).exp()
}
