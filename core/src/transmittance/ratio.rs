//! Ratio tracking: transmittance as a product of null-collision probabilities.
//!
//! ```text
//! T = E[ ∏ᵢ (1 − σ_t(tᵢ) / σ̄) ],  tᵢ the events of a Poisson process of rate σ̄ on [0, t_max)
//! ```
//!
//! Unbiased for any σ̄ > 0. Weights lie in [0, 1] where σ̄ ≥ σ_t; elsewhere they change sign, which
//! keeps the mean and can explode the variance. Relative variance exp(∫σ_t²/σ̄) − 1; mean cost ∫σ̄ dt
//! look-ups, less what weights of exactly zero save. Source: [Novák, Selle, Jarosz 2014].

use crate::medium::Medium;
use crate::ray::Ray;
use crate::real::Real;
use crate::stream::Stream;
use crate::transmittance::Rule;

/// Every tentative collision multiplies the weight with its probability of being null.
#[derive(Clone, Copy, Debug, Default)]
pub struct Ratio;

impl Rule for Ratio {
    #[inline(always)]
    fn collide<R: Real, M: Medium<R>>(
        weight: R,
        sigma_t: R,
        majorant: R,
        _: &mut impl Stream<R>,
        active: R::Mask,
    ) -> R {
        R::select(active, weight * (R::one() - sigma_t / majorant), weight)
    }
}

/// One sample of the transmittance of `[0, t_max)` of each active lane's ray; average many.
///
/// Draws an exponential and the medium's own draws per tentative collision.
#[inline]
pub fn estimate<R: Real, M: Medium<R>>(
    medium: &M,
    ray: &Ray<R>,
    t_max: R,
    rng: &mut impl Stream<R>,
    active: R::Mask,
) -> R {
    super::estimate::<R, M, Ratio>(medium, ray, t_max, rng, active)
}
