//! Delta tracking as an estimate of transmittance: one if the flight leaves, else zero.
//!
//! ```text
//! T = P(no event of the thinned process on [0, t_max))
//! ```
//!
//! Unbiased for σ̄ ≥ σ_t. Variance T (1 − T), whatever the bound; it stops at the first real
//! collision, so its cost does not grow with the optical depth. Source: [Woodcock 1965].

use crate::free_flight::delta::is_real;
use crate::medium::Medium;
use crate::ray::Ray;
use crate::real::Real;
use crate::stream::Stream;
use crate::transmittance::Rule;

/// A real collision ends the estimate at zero.
#[derive(Clone, Copy, Debug, Default)]
pub struct Delta;

impl Rule for Delta {
    #[inline(always)]
    fn collide<R: Real, M: Medium<R>>(
        weight: R,
        sigma_t: R,
        majorant: R,
        rng: &mut impl Stream<R>,
        active: R::Mask,
    ) -> R {
        let real = is_real::<R, M>(sigma_t, majorant, rng, active);
        R::select(real, R::zero(), weight)
    }
}

/// One sample, 0 or 1, of the transmittance of `[0, t_max)` of each active lane's ray.
#[inline]
pub fn estimate<R: Real, M: Medium<R>>(
    medium: &M,
    ray: &Ray<R>,
    t_max: R,
    rng: &mut impl Stream<R>,
    active: R::Mask,
) -> R {
    super::estimate::<R, M, Delta>(medium, ray, t_max, rng, active)
}
