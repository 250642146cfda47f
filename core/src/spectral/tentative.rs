//! A tentative collision, and what of each wavelength goes into either outcome.

use crate::real::Real;
use crate::spectral::Spectrum;
use crate::stream::Stream;

/// A tentative collision whose extinction differs between wavelengths: σ_λ = `sigma_t` · `colour`.
#[derive(Clone, Copy, Debug)]
pub struct Tentative<R, const N: usize> {
    /// Extinction of the most opaque wavelength, or an unbiased estimate of it; per lane [1/length].
    pub sigma_t: R,
    /// Rate σ̄ of the process that led here, per lane [1/length], positive.
    pub majorant: R,
    /// Extinction relative to `sigma_t`, in [0, 1].
    pub colour: Spectrum<R, N>,
}

/// What of each wavelength's weight goes into either outcome, before the outcome's probability divides
/// it.
#[derive(Clone, Copy, Debug)]
pub struct Branches<R, const N: usize> {
    /// w_λ σ_λ / σ_t: a real collision.
    pub real: Spectrum<R, N>,
    /// w_λ (σ̄ − σ_λ) [1/length]: a null collision. Negative where σ_λ exceeds the bound.
    pub null: Spectrum<R, N>,
}

impl<R: Real, const N: usize> Tentative<R, N> {
    /// Both branches of a weight. The real one leaves σ_t out, which then cancels from ratios of it.
    #[inline(always)]
    pub fn branches(&self, weight: Spectrum<R, N>) -> Branches<R, N> {
        let real = weight.times(self.colour);
        Branches {
            real,
            null: weight.zip(real, |w, c| self.majorant * w - self.sigma_t * c),
        }
    }
}

/// Active lanes in which an event of probability `part`/`whole` happens. One draw.
///
/// Compares ξ · whole < part, ξ in [0, 1): never where `part` is zero, always where it is `whole` and
/// that a normal number. ξ has 32 bits, so a probability below 2⁻³² is taken for 2⁻³².
#[inline(always)]
pub(super) fn happens<R: Real>(
    part: R,
    whole: R,
    rng: &mut impl Stream<R>,
    active: R::Mask,
) -> R::Mask {
    (rng.uniform_fine(active) * whole).lt(part) & active
}

/// The new weights: of the outcome in active lanes, the old ones elsewhere.
#[inline(always)]
pub(super) fn settle<R: Real, const N: usize>(
    real: R::Mask,
    if_real: Spectrum<R, N>,
    if_null: Spectrum<R, N>,
    weight: Spectrum<R, N>,
    active: R::Mask,
) -> Spectrum<R, N> {
    let new = Spectrum::select(real, if_real, if_null);
    Spectrum::select(active, new, weight)
}
