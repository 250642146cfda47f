//! Chromatic media: N wavelengths along one path.
//!
//! Where extinction differs between wavelengths, a free flight cannot follow the law of all of them. Here
//! they share the tentative points of one process of rate σ̄ ≥ max σ_λ and one decision at each, and a
//! weight per wavelength makes good what the decision did not heed. Each file of the registry
//! [`for_each_spectral`](crate::for_each_spectral) has one way to decide:
//!
//! | file | P(real) | weights |
//! |---|---|---|
//! | [`weighted`] | the caller's | without a bound |
//! | [`history_aware`] | Σ wσ / (σ̄ Σw) | at most N times their mean, which stays one |
//! | [`hero`] | σ_h/σ̄ of one wavelength | the same, of the same law |
//!
//! [`history_aware`] is the one to use; a renderer's throughput may serve as its weights. All rest on one
//! formula, [`Tentative::branches`], and serve any [`SpectralMedium`]. Shadow rays need no decision:
//! [`transmittance`] multiplies each wavelength's own factors.
//!
//! *Grey extinction needs none of this.* Where all σ_λ are equal, every weight is one and every
//! P is σ/σ̄: [`free_flight::delta`](crate::free_flight::delta) and
//! [`transmittance::ratio`](crate::transmittance::ratio) give the same with one scalar and without a
//! spectrum, also under a coloured albedo, which multiplies at scatterings only.

mod flight;
pub mod hero;
pub mod history_aware;
mod medium;
mod spectrum;
mod tentative;
pub mod transmittance;
pub mod weighted;

pub use flight::{Flights, SpectralFlight, sample};
pub use medium::{ColourError, Coloured, ColouredBy, Followed, SpectralMedium};
pub use spectrum::Spectrum;
pub use tentative::{Branches, Tentative};

use tentative::{happens, settle};

use crate::real::Real;
use crate::stream::Stream;

/// Calls `$row!(name)` for each file of this folder that holds a way to decide tentative collisions.
#[macro_export]
macro_rules! for_each_spectral {
    ($row:ident) => {
        $row!(weighted);
        $row!(history_aware);
        $row!(hero);
    };
}

/// A way to decide the tentative collisions of paths, one per lane, and the weights that it leaves.
pub trait Decision<R: Real, const N: usize> {
    /// Begins paths in the active lanes, with a weight of one at every wavelength.
    fn begin(&mut self, rng: &mut impl Stream<R>, active: R::Mask);
    /// Which of the active lanes collide; their weights follow, the other lanes' stay.
    fn decide(
        &mut self,
        event: &Tentative<R, N>,
        rng: &mut impl Stream<R>,
        active: R::Mask,
    ) -> R::Mask;
    /// What each wavelength's contribution is multiplied with, after all decisions so far.
    fn weight(&self) -> Spectrum<R, N>;
}
