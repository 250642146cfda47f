//! Ratio tracking of all wavelengths together.
//!
//! ```text
//! T_λ = E[ ∏ᵢ (1 − σ_λ(tᵢ) / σ̄) ],  tᵢ the events of one Poisson process of rate σ̄ on [0, t_max)
//! ```
//!
//! The wavelengths share tentative points and look-ups; each has its own factor, and no decision is
//! taken, so that none needs the weights of another. Unbiased for any σ̄ > 0. Weights lie in [0, 1] where
//! σ̄ ≥ σ_λ. Relative variance exp(∫σ_λ²/σ̄) − 1 of each wavelength, and a covariance between two of T_λ T_μ
//! (exp(∫σ_λ σ_μ/σ̄) − 1), positive: less noise in their hues than independent estimates would leave.
//! Mean cost: ∫σ̄ dt look-ups, less what weights of zero save. Sources:
//! [Novák, Selle, Jarosz 2014], [Kutz 2017].

use crate::majorant::{Process, Stages};
use crate::ray::Ray;
use crate::real::{Mask, Real};
use crate::spectral::{SpectralMedium, Spectrum, flight};
use crate::stream::Stream;
use crate::transmittance::Rule;
use crate::transmittance::ratio::Ratio;

/// Estimates under way, one per lane. As a result: the mean weight of the wavelengths; each one's
/// comes with [`weight`](Self::weight).
#[derive(Clone, Debug)]
pub struct Estimates<R: Real, W, const N: usize> {
    stages: Stages<R, W>,
    weight: Spectrum<R, N>,
}

impl<R: Real, W: Clone, const N: usize> Estimates<R, W, N> {
    /// No estimate yet in any lane.
    #[inline(always)]
    pub fn idle<M: SpectralMedium<R, N, Walk = W>>(medium: &M) -> Self {
        const { assert!(!M::TIGHT, "coloured media have null collisions") };
        Self {
            stages: Stages::idle(medium),
            weight: Spectrum::uniform(0.0),
        }
    }

    /// The estimates so far, by wavelength; final for lanes in neither stage.
    #[inline(always)]
    pub fn weight(&self) -> Spectrum<R, N> {
        self.weight
    }
}

impl<R: Real, M: SpectralMedium<R, N>, const N: usize> Process<R, M> for Estimates<R, M::Walk, N> {
    #[inline(always)]
    fn stages(&mut self) -> &mut Stages<R, M::Walk> {
        &mut self.stages
    }
    #[inline(always)]
    fn begin(
        &mut self,
        medium: &M,
        ray: &Ray<R>,
        t_max: R,
        rng: &mut impl Stream<R>,
        active: R::Mask,
    ) {
        self.stages.begin(medium, ray, t_max, rng, active);
        self.weight = Spectrum::select(active, Spectrum::uniform(1.0), self.weight);
    }
    #[inline(always)]
    fn collide(&mut self, medium: &M, rng: &mut impl Stream<R>) {
        let lanes = self.stages.tentative();
        let event = flight::tentative(&self.stages, medium, rng);
        for (weight, colour) in self.weight.0.iter_mut().zip(event.colour.0) {
            let sigma = event.sigma_t * colour;
            *weight = Ratio::collide::<R, M>(*weight, sigma, event.majorant, rng, lanes);
        }
        // Weights of zero complete their estimate.
        let onward = lanes.and_not(self.weight.is_zero());
        self.stages.resolve::<M>(rng, onward);
    }
    #[inline(always)]
    fn result(&self) -> R {
        self.weight.sum() * R::splat(1.0 / N as f32)
    }
}

/// One sample of each wavelength's transmittance of `[0, t_max)` of each active lane's ray; average many.
///
/// * `ray`: per lane, world space; its part `[0, t_max)` must lie in the medium's domain.
/// * `t_max`: per lane \[length\].
///
/// Inactive lanes get zero. Draws an exponential and the medium's own draws per tentative collision.
#[inline]
pub fn estimate<R: Real, const N: usize, M: SpectralMedium<R, N>>(
    medium: &M,
    ray: &Ray<R>,
    t_max: R,
    rng: &mut impl Stream<R>,
    active: R::Mask,
) -> Spectrum<R, N> {
    let mut state = Estimates::<R, M::Walk, N>::idle(medium);
    Process::<R, M>::begin(&mut state, medium, ray, t_max, rng, active);
    state.run(medium, rng);
    state.weight()
}
