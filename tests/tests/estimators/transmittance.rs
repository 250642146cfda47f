//! Transmittance: every row of the registry unbiased on every field, with the variance and the cost it states.
//!
//! Means, second moments and look-ups against tables; what is exact is compared exactly; weights must be
//! independent. The checks must reject every planted mistake.

use std::cell::Cell;
use woodcock_core::for_each_transmittance;
use woodcock_core::medium::{Homogeneous, IDENTITY, Procedural};
use woodcock_core::ray::Ray;
use woodcock_core::real::Real;
use woodcock_core::stream::{KeyedStream, PathStream};
use woodcock_tests::depth::Depth;
use woodcock_tests::each_width;
use woodcock_tests::fixtures::{self, Fixture};
use woodcock_tests::grids::{TestGrid, chord};
use woodcock_tests::rows::Serves;
use woodcock_tests::rows::transmittance as rows;
use woodcock_tests::rows::transmittance::{Estimator, Known};
use woodcock_tests::stats::{Sample, assert_agrees, samples, seed};
use woodcock_tests::widths::{collect, everyone, no_one, per_lane, ray, sample, width};

/// The relative standard error that each mean must reach.
const RESOLUTION: f64 = 0.005;

/// Samples for a relative variance of one weight: a little more than the resolution asks for.
fn enough(relative_variance: f64) -> usize {
    let n = 1.3 * relative_variance / (RESOLUTION * RESOLUTION);
    samples((n as usize).max(1 << 12))
}

/// The relative variance of a few weights; doubled where there is no largest, as so few may have missed it.
fn pilot<T: Estimator>(weights: &Sample) -> f64 {
    let m = weights.moments();
    let spare = if T::RANGE.1.is_finite() { 1.0 } else { 2.0 };
    spare * m.variance() / (m.mean() * m.mean())
}

/// How many weights of a pilot run.
const PILOT: usize = 1 << 11;

/// What another width than `f32` adds is another width: a fourth of the weights, half the sharpness.
fn at_width<R: Real>(n: usize) -> (usize, f64) {
    match width::<R>() {
        "f32" => (n, RESOLUTION),
        _ => ((n / 4).max(1 << 12), 2.0 * RESOLUTION),
    }
}

/// A field's ray, or the first quarters of it where the whole would need too many samples.
struct Stretch {
    known: Known,
    majorant: f32,
}

impl Stretch {
    fn medium<F>(&self, sigma_t: F) -> Procedural<F> {
        let Known { minimum, mean, .. } = self.known;
        Procedural::new(sigma_t, self.majorant).with_control(minimum as f32, mean as f32)
    }
}

fn stretch<T: Estimator>(fixture: &Fixture, loose: f32) -> Stretch {
    let majorant = (fixture.majorant as f32).next_up() * loose;
    let of = |t_max: f64| {
        let t_max = f64::from(t_max as f32);
        let depth = Depth::new(t_max, 300, &fixture.breaks(), fixture.along());
        Known {
            optical_depth: depth.total(),
            squared_integral: depth.squared_integral(),
            mean_free_flight: depth.mean_free_flight(),
            t_max,
            majorant: f64::from(majorant),
            minimum: f64::from(fixture.minimum() as f32),
            mean: f64::from(fixture.mean() as f32),
        }
    };
    let affordable = |known: &Known| relative_variance::<T>(known) < 4.0;
    let mut shares = [1.0, 0.75, 0.5].into_iter();
    let known = shares.find_map(|share| Some(of(fixture.ray.t_max * share)).filter(affordable));
    let known = known.unwrap_or_else(|| of(fixture.ray.t_max * 0.25));
    Stretch { known, majorant }
}

fn relative_variance<T: Estimator>(known: &Known) -> f64 {
    T::expected_moment(known) * (2.0 * known.optical_depth).exp() - 1.0
}

fn through<T: Estimator, R: Real, S: KeyedStream<R>>(
    fixture: &Fixture,
    stretch: &Stretch,
    pixel: u32,
    n: usize,
) -> Sample {
    let medium = stretch.medium(per_lane::<R>(fixture.sigma_t()));
    let along: Ray<R> = ray(fixture.ray.origin, fixture.ray.dir);
    let end = R::splat(stretch.known.t_max as f32);
    sample::<R, S>(seed(21), pixel, n, |rng| {
        T::in_any(&medium, &along, end, rng, everyone::<R>())
    })
}

/// Samples for a field's mean: as theory says, or else a pilot run.
fn enough_for<T: Estimator>(fixture: &Fixture, stretch: &Stretch, pixel: u32) -> usize {
    match T::second_moment(&stretch.known) {
        Some(_) => enough(relative_variance::<T>(&stretch.known)),
        None => {
            let few = through::<T, f32, PathStream>(fixture, stretch, 1000 + pixel, PILOT);
            enough(pilot::<T>(&few))
        }
    }
}

fn fields<T: Estimator>() {
    if T::SERVES != Serves::Any {
        return;
    }
    for (pixel, fixture) in (0..).zip(fixtures::all()) {
        let stretch = stretch::<T>(&fixture, 1.0);
        let truth = (-stretch.known.optical_depth).exp();
        let n = enough_for::<T>(&fixture, &stretch, pixel);
        each_width!(R, S => {
            // Lanes repeat what f32 drew, as `lanes.rs` shows bit by bit: one ray of a field will do.
            if width::<R>() == "f32" || pixel % 4 == pixel / 4 % 4 {
                let name = format!("{} {}", fixture.name, width::<R>());
                let (n, resolution) = at_width::<R>(n);
                let weights = through::<T, R, S>(&fixture, &stretch, pixel, n);
                assert_agrees(&name, &weights, truth, resolution);
                let m = weights.moments();
                let (least, most) = T::RANGE;
                assert!(least <= m.min() && m.max() <= most, "{name}: {m:?}");
            }
        });
    }
}

/// Under a bound a quarter too large second moment and look-ups are those of theory, where it says them.
fn variance_and_cost<T: Estimator>() {
    if T::SERVES != Serves::Any {
        return;
    }
    for (pixel, fixture) in (100..).zip(fixtures::all()).step_by(2) {
        let stretch = stretch::<T>(&fixture, 1.25);
        let Some(second) = T::second_moment(&stretch.known) else {
            return;
        };
        let lookups = Cell::new(0);
        let field = fixture.sigma_t();
        let counted = |x: f64, y: f64, z: f64| {
            lookups.set(lookups.get() + 1);
            field(x, y, z)
        };
        let medium = stretch.medium(per_lane::<f32>(counted));
        let along: Ray<f32> = ray(fixture.ray.origin, fixture.ray.dir);
        let draw = |pixel: u32, n: usize, costs: &mut Sample| {
            let weights = collect::<f32, PathStream>(seed(22), pixel, n, |rng| {
                lookups.set(0);
                let weight = T::in_any(&medium, &along, stretch.known.t_max as f32, rng, true);
                costs.push(lookups.get() as f64);
                weight
            });
            weights.into_iter().map(|w| w * w).collect::<Sample>()
        };
        // Squares have rarer and larger values than what they are squares of: a longer pilot, and six times its word.
        const MOMENT: f64 = 0.03;
        let few = draw(1000 + pixel, 4 * PILOT, &mut Sample::new());
        let m = few.moments();
        let relative = 6.0 * m.variance() / m.mean().powi(2);
        let n = samples((1.3 * relative / MOMENT.powi(2)) as usize).max(1 << 14);
        let mut costs = Sample::new();
        let squares = draw(pixel, n, &mut costs);
        let name = |what: &str| format!("{what} of {}", fixture.name);
        assert_agrees(&name("second moment"), &squares, second, MOMENT);
        if let Some(lookups) = T::lookups(&stretch.known) {
            assert_agrees(&name("look-ups"), &costs, lookups, 0.02);
        }
    }
}

fn fog<T: Estimator>() {
    for (sigma_t, t_max) in [(0.02_f32, 2.5_f32), (0.4, 2.5), (1.5, 0.8)] {
        let medium = Homogeneous::new(sigma_t).expect("a valid extinction");
        let truth = (-f64::from(sigma_t) * f64::from(t_max)).exp();
        each_width!(R, S => {
            let along: Ray<R> = ray([0.0; 3], [0.0, 1.0, 0.0]);
            let n = enough(if T::EXACT_WHERE_TIGHT { 0.0 } else { 2.5 });
            let weights = sample::<R, S>(seed(23), 0, n, |rng| {
                T::in_fog(&medium, &along, R::splat(t_max), rng, everyone::<R>())
            });
            let name = format!("fog {sigma_t} {}", width::<R>());
            assert_agrees(&name, &weights, truth, RESOLUTION);
        });
    }
}

/// Vacuum gives one exactly, under any bound; a tight bound gives zero or one and nothing else.
fn exact<T: Estimator>() {
    let vacuum = Homogeneous::new(0.0).expect("vacuum is a medium");
    let fog = Homogeneous::new(0.8).expect("a valid extinction");
    each_width!(R, S => {
        let along: Ray<R> = ray([0.0; 3], [1.0, 0.0, 0.0]);
        for t_max in [0.0_f32, 1e-30, 1.0, 1e30] {
            let ones = sample::<R, S>(1, 0, 1000, |rng| {
                T::in_fog(&vacuum, &along, R::splat(t_max), rng, everyone::<R>())
            });
            assert_eq!((ones.moments().min(), ones.moments().max()), (1.0, 1.0));
        }
        let none = sample::<R, S>(1, 1, 1000, |rng| {
            T::in_fog(&fog, &along, R::zero(), rng, everyone::<R>())
        });
        assert_eq!((none.moments().min(), none.moments().max()), (1.0, 1.0));
        let tight = sample::<R, S>(1, 2, 4096, |rng| {
            T::in_fog(&fog, &along, R::one(), rng, everyone::<R>())
        });
        let (least, most) = (tight.moments().min(), tight.moments().max());
        let passes = (-f64::from(0.8_f32)).exp();
        if T::EXACT_WHERE_TIGHT {
            let off = (least / passes - 1.0).abs().max((most / passes - 1.0).abs());
            assert!(off < 3e-7, "{least} to {most} for {passes}");
        } else {
            assert_eq!((least, most), (0.0, 1.0));
        }
        if T::SERVES == Serves::Any {
            // Vacuum that its bound does not know of.
            let unknown = Procedural::new(per_lane::<R>(|_, _, _| 0.0), 50.0);
            let ones = sample::<R, S>(1, 3, 1000, |rng| {
                T::in_any(&unknown, &along, R::one(), rng, everyone::<R>())
            });
            let (least, most) = (ones.moments().min(), ones.moments().max());
            assert!(least > 1.0 - 2e-7 && most < 1.0 + 2e-7, "{least} to {most}");
            // Lanes that never began keep their weight and draw nothing.
            let mut rng = <S as KeyedStream<R>>::idle();
            let before = format!("{rng:?}");
            let weight = T::in_any(&unknown, &along, R::one(), &mut rng, no_one::<R>());
            assert!(woodcock_core::real::Mask::all(weight.eq(R::zero())));
            assert_eq!(before, format!("{rng:?}"));
        }
    });
}

fn grids<T: Estimator>() {
    if T::SERVES != Serves::Any {
        return;
    }
    let cloud = TestGrid::cloud([33, 26, 25], 43);
    let random = TestGrid::random([18, 17, 19], 44, 0.4);
    for (kind, grid) in [("cloud", &cloud), ("random", &random)] {
        let middle = grid.dims.map(|n| 0.5 * f64::from(n - 1));
        let rays = [
            ("diagonal", middle, [1.0, 1.0, -1.0]),
            (
                "along a face of blocks",
                [16.0, middle[1], 8.0],
                [0.0, -1.0, 0.0],
            ),
            ("skew", [12.3, 11.1, 10.4], [0.3, 0.8, 0.2]),
        ];
        for (pixel, (path, through, direction)) in (0..).zip(rays) {
            let chord = chord(grid.dims, through, direction);
            let once = grid.depth(chord.origin, chord.direction, chord.t_max, 1.0);
            let scale = (1.0 / once.total()) as f32;
            let medium = grid.medium(IDENTITY, scale);
            let truth = (-f64::from(scale) * once.total()).exp();
            let along: Ray<f32> = ray(chord.origin, chord.direction);
            let few = sample::<f32, PathStream>(seed(24), 1000 + pixel, PILOT, |rng| {
                T::in_any(&medium, &along, chord.t_max as f32, rng, true)
            });
            each_width!(R, S => {
                let along: Ray<R> = ray(chord.origin, chord.direction);
                let end = R::splat(chord.t_max as f32);
                let (n, resolution) = at_width::<R>(enough(pilot::<T>(&few)));
                let weights = sample::<R, S>(seed(24), pixel, n, |rng| {
                    T::in_any(&medium, &along, end, rng, everyone::<R>())
                });
                let name = format!("{kind}, {path}, {}", width::<R>());
                assert_agrees(&name, &weights, truth, resolution);
            });
        }
    }
}

mod biased;
mod exact;
mod media;
mod mutants;
mod orders;
mod shadows;

macro_rules! row {
    ($name:ident) => {
        row!(
            $name,
            every_field_has_its_mean = fields,
            variance_and_cost_are_those_of_theory = variance_and_cost,
        );
    };
    ($name:ident, $($test:ident = $body:ident,)*) => {
        mod $name {
            use super::rows::$name::Row;
            $(
                #[test]
                fn $test() {
                    super::$body::<Row>();
                }
            )*
            #[test]
            fn fog_has_its_mean() {
                super::fog::<Row>();
            }
            #[test]
            fn vacuum_and_tight_bounds_are_exact() {
                super::exact::<Row>();
            }
            #[test]
            fn grids_have_their_mean() {
                super::grids::<Row>();
            }
            #[test]
            fn voxels_have_their_mean() {
                super::media::voxels::<Row>();
            }
            #[test]
            fn overlaps_multiply() {
                super::media::overlaps::<Row>();
            }
        }
    };
}
for_each_transmittance!(row);
// Variants that share a file with a row. In one segment either spacing of the power series is the other.
row!(residual_ratio_minimum);
row!(power_series_depth,);
