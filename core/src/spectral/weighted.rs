//! Decisions of any probability, made good by weights.
//!
//! All wavelengths share the tentative points of one process of rate σ̄; one decision, of a probability
//! P that the caller chooses, serves them all:
//!
//! ```text
//! real, with probability P:      w_λ ← w_λ σ_λ / (σ̄ P)
//! null, with probability 1 − P:  w_λ ← w_λ (σ̄ − σ_λ) / (σ̄ (1 − P))
//! ```
//!
//! P cancels from the expectation, and what stays is the wavelength's own delta tracking: E w_λ over
//! flights that leave is e^−τ_λ, over those that collide before s it is 1 − e^−τ_λ(s). So P may be
//! anything, also a function of the history, as long as it is not 0 where some w_λ σ_λ ≠ 0, nor 1
//! where some w_λ (σ̄ − σ_λ) ≠ 0. The extinction enters linearly, so that an unbiased estimate of it
//! serves. σ̄ need not bound anything: where it does not, weights change sign and the mean stays.
//!
//! *Variance.* P decides it. To follow one wavelength, P = σ_h/σ̄, lets the weights of all others
//! grow without a bound. In an endless homogeneous medium the flights so weighted have
//!
//! ```text
//! E w_λ² = σ_λ² (σ̄ − σ_h) / (σ_h (σ̄ (2σ_λ − σ_h) − σ_λ²))  →  σ_λ² / (σ_h (2σ_λ − σ_h))  as σ̄ → ∞,
//! ```
//!
//! a geometric series over the null collisions that diverges from σ_h = 2σ_λ on, if not before.
//! [`history_aware`](super::history_aware) is the P that bounds them, [`hero`](super::hero) the mixture
//! that does. Sources: [Kutz 2017], the event probabilities of spectral tracking; [Miller 2019].

use crate::ray::Ray;
use crate::real::Real;
use crate::spectral::{Branches, happens, settle};
use crate::spectral::{Decision, SpectralFlight, SpectralMedium, Spectrum, Tentative, flight};
use crate::stream::Stream;

/// Whether active lanes collide, and their new weights. One draw.
///
/// * `probability`: P, per lane, in [0, 1]; what it must not be is said above. An outcome of
///   probability 0 is never chosen. Below 2⁻²⁴ the 32 bits of the draw begin to show: the mean of a
///   real collision is wrong by a share of up to 2⁻³²/P.
/// * `weight`: per wavelength and lane.
#[inline(always)]
pub fn decide<R: Real, const N: usize>(
    event: &Tentative<R, N>,
    probability: R,
    weight: Spectrum<R, N>,
    rng: &mut impl Stream<R>,
    active: R::Mask,
) -> (R::Mask, Spectrum<R, N>) {
    let one = R::one();
    let real = happens(probability, one, rng, active);
    let Branches { real: r, null: n } = event.branches(weight);
    let if_real = r * (event.sigma_t / (event.majorant * probability));
    let if_null = n * (one / (event.majorant * (one - probability)));
    (real, settle(real, if_real, if_null, weight, active))
}

/// Decides by a probability that is a function of the event and the weights so far.
#[derive(Clone, Copy, Debug)]
pub struct Weighted<R, F, const N: usize> {
    weight: Spectrum<R, N>,
    probability: F,
}

impl<R: Real, F, const N: usize> Weighted<R, F, N> {
    /// * `probability`: P, under the rules of [`decide`].
    #[inline(always)]
    pub fn new(probability: F) -> Self
    where
        F: Fn(&Tentative<R, N>, Spectrum<R, N>) -> R,
    {
        Self {
            weight: Spectrum::uniform(0.0),
            probability,
        }
    }
}

impl<R, F, const N: usize> Decision<R, N> for Weighted<R, F, N>
where
    R: Real,
    F: Fn(&Tentative<R, N>, Spectrum<R, N>) -> R,
{
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
        let probability = (self.probability)(event, self.weight);
        let (real, weight) = decide(event, probability, self.weight, rng, active);
        self.weight = weight;
        real
    }
    #[inline(always)]
    fn weight(&self) -> Spectrum<R, N> {
        self.weight
    }
}

/// Samples one flight on `[0, t_max)` of each active lane's ray, decided by `probability`.
///
/// * `ray`: per lane, world space; its part `[0, t_max)` must lie in the medium's domain.
/// * `t_max`: per lane \[length\].
/// * `probability`: P, under the rules of [`decide`].
///
/// Draws an exponential and the medium's own draws per tentative collision, and one uniform number to
/// decide it.
#[inline]
pub fn sample<R: Real, const N: usize, M: SpectralMedium<R, N>>(
    medium: &M,
    ray: &Ray<R>,
    t_max: R,
    probability: impl Fn(&Tentative<R, N>, Spectrum<R, N>) -> R,
    rng: &mut impl Stream<R>,
    active: R::Mask,
) -> SpectralFlight<R, N> {
    flight::sample(medium, Weighted::new(probability), ray, t_max, rng, active)
}
