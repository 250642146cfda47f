//! Ways to decide tentative collisions in colour.

use woodcock_core::ray::Ray;
use woodcock_core::real::Real;
use woodcock_core::spectral::hero::Hero;
use woodcock_core::spectral::history_aware::HistoryAware;
use woodcock_core::spectral::weighted::Weighted;
use woodcock_core::spectral::{
    self, Decision, SpectralFlight, SpectralMedium, Spectrum, Tentative,
};
use woodcock_core::stream::Stream;

/// What a way to decide is asked.
pub trait Way {
    /// The mean of the weights is one and none exceeds N, on every path.
    const BOUNDED: bool;
    /// A path begins with a draw of its own, where there are several wavelengths.
    const LEADS: bool;
    /// No path yet in any lane.
    fn decision<R: Real, const N: usize>() -> impl Decision<R, N> + Clone;
    /// A flight.
    fn sample<R: Real, const N: usize, M: SpectralMedium<R, N>>(
        medium: &M,
        ray: &Ray<R>,
        t_max: R,
        rng: &mut impl Stream<R>,
        active: R::Mask,
    ) -> SpectralFlight<R, N>;
    /// Probability of some null collisions followed by a real one, or by none, where the most opaque wavelength's
    /// extinction is everywhere the given share of the bound.
    ///
    /// * `colour`: extinction relative to the most opaque wavelength.
    fn probability<const N: usize>(
        colour: [f64; N],
        share: f64,
        nulls: i32,
        then_real: bool,
    ) -> f64;
}

/// What a wavelength's own delta tracking gives [`Way::probability`].
pub fn own_probability(colour: f64, share: f64, nulls: i32, then_real: bool) -> f64 {
    let real = colour * share;
    (1.0 - real).powi(nulls) * if then_real { real } else { 1.0 }
}

/// The mixture of all wavelengths' own.
fn mixture<const N: usize>(colour: [f64; N], share: f64, nulls: i32, then_real: bool) -> f64 {
    let own = colour.map(|c| own_probability(c, share, nulls, then_real));
    own.iter().sum::<f64>() / N as f64
}

/// The mean extinction of the wavelengths, whatever happened before, as a share of the bound.
fn mean_extinction<R: Real, const N: usize>(event: &Tentative<R, N>, _: Spectrum<R, N>) -> R {
    event.sigma_t * event.colour.sum() / (event.majorant * R::splat(N as f32))
}

macro_rules! row {
    ($name:ident, bounded $bounded:literal, leads $leads:literal, $decision:expr, $sample:expr, $probability:expr) => {
        #[doc = concat!("`spectral/", stringify!($name), ".rs`.")]
        pub mod $name {
            use super::*;
            /// Its row.
            #[derive(Clone, Copy, Debug)]
            pub struct Row;
            impl Way for Row {
                const BOUNDED: bool = $bounded;
                const LEADS: bool = $leads;
                fn decision<R: Real, const N: usize>() -> impl Decision<R, N> + Clone {
                    $decision
                }
                fn sample<R: Real, const N: usize, M: SpectralMedium<R, N>>(
                    medium: &M,
                    ray: &Ray<R>,
                    t_max: R,
                    rng: &mut impl Stream<R>,
                    active: R::Mask,
                ) -> SpectralFlight<R, N> {
                    $sample(medium, ray, t_max, rng, active)
                }
                fn probability<const N: usize>(
                    colour: [f64; N],
                    share: f64,
                    nulls: i32,
                    then_real: bool,
                ) -> f64 {
                    $probability(colour, share, nulls, then_real)
                }
            }
        }
    };
}
row!(
    weighted,
    bounded false,
    leads false,
    Weighted::new(mean_extinction::<R, N>),
    |medium, ray, t_max, rng, active| {
        spectral::weighted::sample(medium, ray, t_max, mean_extinction::<R, N>, rng, active)
    },
    |colour: [f64; N], share, nulls, then_real| {
        let mean = colour.iter().sum::<f64>() / N as f64;
        own_probability(mean, share, nulls, then_real)
    }
);
row!(
    history_aware,
    bounded true,
    leads false,
    HistoryAware::idle(),
    spectral::history_aware::sample,
    mixture
);
row!(
    hero,
    bounded true,
    leads true,
    Hero::idle(),
    spectral::hero::sample,
    mixture
);
