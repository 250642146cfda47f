//! Chromatic media: every way to decide gives each wavelength its own law, within the bounds that it states.
//!
//! Modules hold the laws on fields and grids, the weights by enumeration, their bounds and second moments, the grey
//! case, lanes, and the planted mistakes. All for 1, 3, 4 and 8 wavelengths, by the registry.

use woodcock_core::for_each_spectral;
use woodcock_core::ray::Ray;
use woodcock_core::real::Real;
use woodcock_core::spectral::{SpectralFlight, SpectralMedium};
use woodcock_core::stream::{Key, KeyedStream};
use woodcock_tests::rows::spectral::Way;
use woodcock_tests::stats::{Moments, assert_mean_agrees};
use woodcock_tests::widths::everyone;

mod bounds;
mod grey;
mod lanes;
mod laws;
pub(crate) mod mutants;
mod weights;

/// Colours from opaque to clear; N wavelengths take the first N.
const COLOURS: [f32; 8] = [1.0, 0.01, 0.6, 0.0, 0.9, 0.3, 0.8, 0.1];

fn colours<const N: usize>() -> [f32; N] {
    std::array::from_fn(|i| COLOURS[i])
}

/// One lane of a flight.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Flown<const N: usize> {
    /// Distance to the collision, infinite without one.
    t: f64,
    weight: [f64; N],
}

impl<const N: usize> Flown<N> {
    fn of<R: Real>(flight: &SpectralFlight<R, N>, lane: usize) -> Self {
        use woodcock_core::real::Mask;
        let collided = flight.flight.collided.lane(lane);
        Self {
            t: if collided {
                f64::from(flight.flight.t.lane(lane))
            } else {
                f64::INFINITY
            },
            weight: flight.weight.lane(lane).map(f64::from),
        }
    }

    fn left(&self) -> bool {
        self.t.is_infinite()
    }

    /// The promise of the bounded ways, up to rounding: mean one, none negative, none above N.
    fn assert_bounded(&self, name: &dyn std::fmt::Display) {
        let count = N as f64;
        let sum: f64 = self.weight.iter().sum();
        assert!((sum / count - 1.0).abs() < 3e-5, "{name}: {self:?}");
        for w in self.weight {
            assert!(
                (0.0..=count * (1.0 + 3e-5)).contains(&w),
                "{name}: {self:?}"
            );
        }
    }
}

/// Puts the streams of paths `first`, `first` + 1, … at their beginning, one a lane.
fn set_keys<R: Real, S: KeyedStream<R>>(rng: &mut S, seed: u64, pixel: u32, first: usize) {
    for lane in 0..R::LANES {
        let sample = (first + lane) as u32;
        rng.set_key(
            lane,
            Key {
                seed,
                pixel,
                sample,
            },
        );
    }
}

/// `n` flights from the beginning of `along` to `t_max`.
fn fly<T: Way, R: Real, S: KeyedStream<R>, M: SpectralMedium<R, N>, const N: usize>(
    medium: &M,
    along: &Ray<R>,
    t_max: f64,
    (seed, pixel): (u64, u32),
    n: usize,
    mut each: impl FnMut(Flown<N>),
) {
    let mut rng = S::idle();
    let end = R::splat(t_max as f32);
    for first in (0..n).step_by(R::LANES) {
        set_keys(&mut rng, seed, pixel, first);
        let flight = T::sample(medium, along, end, &mut rng, everyone::<R>());
        for lane in 0..R::LANES {
            each(Flown::of(&flight, lane));
        }
    }
}

/// A mean of zero is met exactly, by weights that are all zero; any other within the resolution.
#[track_caller]
fn assert_mean(name: &str, m: &Moments, truth: f64, resolution: f64) {
    if truth == 0.0 {
        let range = (m.min(), m.max());
        assert_eq!(range, (0.0, 0.0), "{name}: weights where nothing is");
    } else {
        assert_mean_agrees(name, m, truth, resolution);
    }
}

/// Moments of each wavelength's weight, counted where `counts` holds.
fn moments<const N: usize>(flown: &[Flown<N>], counts: impl Fn(f64) -> bool) -> [Moments; N] {
    let mut moments = [Moments::new(); N];
    for path in flown {
        for (m, w) in moments.iter_mut().zip(path.weight) {
            m.push(if counts(path.t) { w } else { 0.0 });
        }
    }
    moments
}

/// Each test of `$suite`, for every number of wavelengths.
macro_rules! numbers {
    ($suite:ident, $($test:ident),+) => {
        $(
            mod $test {
                use super::Row;
                #[test]
                fn of_1() {
                    super::super::$suite::$test::<Row, 1>();
                }
                #[test]
                fn of_3() {
                    super::super::$suite::$test::<Row, 3>();
                }
                #[test]
                fn of_4() {
                    super::super::$suite::$test::<Row, 4>();
                }
                #[test]
                fn of_8() {
                    super::super::$suite::$test::<Row, 8>();
                }
            }
        )+
    };
}

macro_rules! row {
    ($name:ident) => {
        mod $name {
            use woodcock_tests::rows::spectral::$name::Row;
            numbers!(
                laws,
                fields_have_each_wavelengths_law,
                a_grid_has_each_wavelengths_law
            );
            numbers!(laws, flights_go_on_with_their_history);
            numbers!(weights, outcomes_weigh_what_they_must);
            numbers!(bounds, extremes_are_exact, long_paths_stay_finite);
            numbers!(bounds, second_moments_are_those_of_theory);
            numbers!(grey, equal_wavelengths_are_delta_tracking);
            numbers!(lanes, lanes_have_the_bits_of_scalars);
        }
    };
}
for_each_spectral!(row);
