//! Decisions by the mean extinction of what is left of each wavelength.
//!
//! ```text
//! P = Σ w_λ σ_λ / (σ̄ Σ w_λ),   real: w_λ ← w_λ σ_λ/(σ̄ P),   null: w_λ ← w_λ (σ̄ − σ_λ)/(σ̄ (1 − P))
//! ```
//!
//! *Bound.* Either outcome keeps the sum of the weights: Σ w_λ σ_λ/(σ̄ P) = Σ w_λ, and likewise
//! for null collisions. No weight is negative where σ̄ ≥ max σ_λ, so each stays below N times their
//! mean, on every path, whatever the ratios of the extinctions and however long the path.
//!
//! *The same law as a hero's.* For weights that begin equal, w_λ/Σw is what is known, after a history,
//! of which wavelength it was drawn by if that had been one of N at random (Bayes). P is then the mean
//! of the hero's σ_h/σ̄ over what is known of it, and [`hero`](super::hero) gives the same paths with the
//! same weights and frequencies, one random number a path dearer. But here the weights may carry what else
//! befell the path, an albedo say, and P follows.
//!
//! *Rounding.* Σw drifts by some 2⁻²³ an event, and by 2⁻²³/(1 − P) at a null collision of probability
//! 1 − P. Where σ̄ does not bound, weights turn negative and the promise is void: that is counted as
//! a violated majorant, never clamped.
//!
//! Sources: [Kutz 2017], history-aware probabilities; [Miller 2019].

use crate::ray::Ray;
use crate::real::Real;
use crate::spectral::{Branches, happens, settle};
use crate::spectral::{Decision, SpectralFlight, SpectralMedium, Spectrum, Tentative, flight};
use crate::stream::Stream;

/// Whether active lanes collide, and their new weights. One draw.
///
/// * `weight`: per wavelength and lane, not negative, not all zero.
#[inline(always)]
pub fn decide<R: Real, const N: usize>(
    event: &Tentative<R, N>,
    weight: Spectrum<R, N>,
    rng: &mut impl Stream<R>,
    active: R::Mask,
) -> (R::Mask, Spectrum<R, N>) {
    let Branches { real: r, null: n } = event.branches(weight);
    let total = weight.sum();
    let all = event.majorant * total;
    let coloured = r.sum();
    let colliding = event.sigma_t * coloured;
    let real = happens(colliding, all, rng, active);
    // The weights of `weighted`, by 1/(σ̄ P) = Σw / Σwσ and 1/(σ̄ (1 − P)) = Σw / (σ̄ Σw − Σwσ).
    let if_real = r * (total / coloured);
    let if_null = n * (total / (all - colliding));
    (real, settle(real, if_real, if_null, weight, active))
}

/// The weights of a path in each lane; their sum stays N.
#[derive(Clone, Copy, Debug)]
pub struct HistoryAware<R, const N: usize> {
    weight: Spectrum<R, N>,
}

impl<R: Real, const N: usize> HistoryAware<R, N> {
    /// No path yet in any lane.
    #[inline(always)]
    pub fn idle() -> Self {
        Self {
            weight: Spectrum::uniform(0.0),
        }
    }
}

impl<R: Real, const N: usize> Decision<R, N> for HistoryAware<R, N> {
    #[inline(always)]
    fn begin(&mut self, _: &mut impl Stream<R>, active: R::Mask) {
        self.weight = Spectrum::select(active, Spectrum::uniform(1.0), self.weight);
    }
    #[inline(always)]
    fn decide(
        &mut self,
        event: &Tentative<R, N>,
        rng: &mut impl Stream<R>,
        active: R::Mask,
    ) -> R::Mask {
        let (real, weight) = decide(event, self.weight, rng, active);
        self.weight = weight;
        real
    }
    #[inline(always)]
    fn weight(&self) -> Spectrum<R, N> {
        self.weight
    }
}

/// Samples one flight on `[0, t_max)` of each active lane's ray.
///
/// * `ray`: per lane, world space; its part `[0, t_max)` must lie in the medium's domain.
/// * `t_max`: per lane \[length\].
///
/// Draws an exponential and the medium's own draws per tentative collision, and one uniform number to
/// decide it.
#[inline]
pub fn sample<R: Real, const N: usize, M: SpectralMedium<R, N>>(
    medium: &M,
    ray: &Ray<R>,
    t_max: R,
    rng: &mut impl Stream<R>,
    active: R::Mask,
) -> SpectralFlight<R, N> {
    flight::sample(medium, HistoryAware::idle(), ray, t_max, rng, active)
}
