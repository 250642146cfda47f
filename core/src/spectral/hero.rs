//! Spectral multiple importance sampling: one wavelength leads, all are weighted.
//!
//! The hero h is one of N wavelengths, uniformly, once per path; delta tracking by σ_h under the bound
//! that all share makes the path. Each wavelength keeps how likely it would have made the same path, and
//! the balance heuristic over the N heroes weights it:
//!
//! ```text
//! real: r_λ ← r_λ σ_λ/σ_h,   null: r_λ ← r_λ (σ̄ − σ_λ)/(σ̄ − σ_h),   w_λ = r_λ / mean(r)
//! ```
//!
//! *Bound.* w_λ ≤ N, since r_λ ≤ Σr; and mean(w) = 1, on every path. Following one hero without
//! weighting by the mixture has no bound ([`weighted`](super::weighted)).
//!
//! *Without overflow.* A ratio r_λ runs over every limit, or to zero, within some dozens of
//! collisions. But w depends on ratios alone, and a factor common to all wavelengths cancels, σ_h
//! among them; so w itself is the state,
//!
//! ```text
//! real: x_λ = w_λ σ_λ,   null: x_λ = w_λ (σ̄ − σ_λ),   w_λ ← N x_λ / Σx,
//! ```
//!
//! and nothing is ever divided by σ_h or σ̄ − σ_h: the outcome that these exclude is never chosen. A
//! wavelength fades to zero only where the path is 10³⁸ times less likely with it than with another;
//! the hero does so with probability 10⁻³⁸. Should all fade at once, weights are zero, not NaN.
//!
//! The flights have the law of [`history_aware`](super::history_aware), weights included. What else befalls
//! a path, an albedo say, multiplies its contribution apart from w. Sources: [Wilkie 2014], the hero and
//! the balance heuristic over the wavelengths that might have led; [Miller 2019], both for paths with null
//! collisions.

use crate::ray::Ray;
use crate::real::{Real, Word};
use crate::spectral::{Branches, happens, settle};
use crate::spectral::{Decision, SpectralFlight, SpectralMedium, Spectrum, Tentative, flight};
use crate::stream::Stream;

/// A path in each lane: its hero, and the ratios of all wavelengths, whose mean is kept at one.
#[derive(Clone, Copy, Debug)]
pub struct Hero<R: Real, const N: usize> {
    hero: R::Word,
    weight: Spectrum<R, N>,
}

impl<R: Real, const N: usize> Hero<R, N> {
    /// No path yet in any lane.
    #[inline(always)]
    pub fn idle() -> Self {
        Self {
            hero: R::Word::splat(0),
            weight: Spectrum::uniform(0.0),
        }
    }

    /// The number of the wavelength that leads, per lane.
    #[inline(always)]
    pub fn hero(&self) -> R::Word {
        self.hero
    }
}

impl<R: Real, const N: usize> Decision<R, N> for Hero<R, N> {
    /// One draw, for the hero; none where there is no choice.
    #[inline(always)]
    fn begin(&mut self, rng: &mut impl Stream<R>, active: R::Mask) {
        if N > 1 {
            // Below N also after rounding: N (1 − 2⁻²⁴) lies nearer to the number below N than to N.
            let hero = (rng.uniform(active) * R::splat(N as f32)).to_word();
            self.hero = R::Word::select(active, hero, self.hero);
        }
        self.weight = Spectrum::select(active, Spectrum::uniform(1.0), self.weight);
    }
    #[inline(always)]
    fn decide(
        &mut self,
        event: &Tentative<R, N>,
        rng: &mut impl Stream<R>,
        active: R::Mask,
    ) -> R::Mask {
        let sigma_hero = event.sigma_t * event.colour.at(self.hero);
        let real = happens(sigma_hero, event.majorant, rng, active);
        let Branches { real: r, null: n } = event.branches(self.weight);
        let normalised = |x: Spectrum<R, N>| {
            let sum = x.sum();
            let scale = R::splat(N as f32) / sum;
            x * scale.or_zero(R::zero().lt(sum))
        };
        let (if_real, if_null) = (normalised(r), normalised(n));
        self.weight = settle(real, if_real, if_null, self.weight, active);
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
/// Draws a uniform number for the hero, an exponential and the medium's own draws per tentative
/// collision, and one uniform number to decide it.
#[inline]
pub fn sample<R: Real, const N: usize, M: SpectralMedium<R, N>>(
    medium: &M,
    ray: &Ray<R>,
    t_max: R,
    rng: &mut impl Stream<R>,
    active: R::Mask,
) -> SpectralFlight<R, N> {
    flight::sample(medium, Hero::idle(), ray, t_max, rng, active)
}
