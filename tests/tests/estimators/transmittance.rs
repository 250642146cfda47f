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
use woodcock_tests::mutants::{Profile, WEIGHTS};
use woodcock_tests::rows::Serves;
use woodcock_tests::rows::transmittance as rows;
use woodcock_tests::rows::transmittance::{Estimator, Known};
use woodcock_tests::stats::independent::SplitMix;
use woodcock_tests::stats::{
    Moments, Mutants, Sample, assert_agrees, assert_verdict, judge, samples, seed,
};
use woodcock_tests::widths::{collect, everyone, no_one, per_lane, ray, sample, width};

/// The relative standard error that each mean must reach.
const RESOLUTION: f64 = 0.005;

/// Samples for a relative variance of one weight: a little more than the resolution asks for.
fn enough(relative_variance: f64) -> usize {
    let n = 1.3 * relative_variance / (RESOLUTION * RESOLUTION);
    samples((n as usize).max(1 << 14))
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
    let quarters = [1.0, 0.75, 0.5].map(|share| of(fixture.ray.t_max * share));
    let known = quarters.into_iter().find(affordable);
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
    lookups: &Cell<u64>,
) -> Sample {
    let field = fixture.sigma_t();
    let counted = |x: f64, y: f64, z: f64| {
        lookups.set(lookups.get() + 1);
        field(x, y, z)
    };
    let medium = stretch.medium(per_lane::<R>(counted));
    let along: Ray<R> = ray(fixture.ray.origin, fixture.ray.dir);
    let end = R::splat(stretch.known.t_max as f32);
    sample::<R, S>(seed(21), pixel, n, |rng| {
        T::in_any(&medium, &along, end, rng, everyone::<R>())
    })
}

fn fields<T: Estimator>() {
    if T::SERVES != Serves::Any {
        return;
    }
    for (pixel, fixture) in (0..).zip(fixtures::all()) {
        let stretch = stretch::<T>(&fixture, 1.0);
        let truth = (-stretch.known.optical_depth).exp();
        let n = enough(relative_variance::<T>(&stretch.known));
        let nobody = Cell::new(0);
        each_width!(R, S => {
            let name = format!("{} {}", fixture.name, width::<R>());
            // Lanes repeat what f32 drew, as `lanes.rs` shows bit by bit: half the sharpness will do.
            let (n, resolution) = if R::LANES > 1 { (n / 4, 2.0 * RESOLUTION) } else { (n, RESOLUTION) };
            let weights = through::<T, R, S>(&fixture, &stretch, pixel, n, &nobody);
            assert_agrees(&name, &weights, truth, resolution);
            let m = weights.moments();
            let (least, most) = T::RANGE;
            assert!(least <= m.min() && m.max() <= most, "{name}: {m:?}");
        });
    }
}

/// Under a bound a quarter too large: the mean stays, second moment and look-ups are those of theory.
fn variance_and_cost<T: Estimator>() {
    if T::SERVES != Serves::Any {
        return;
    }
    for (pixel, fixture) in (100..).zip(fixtures::all()) {
        let stretch = stretch::<T>(&fixture, 1.25);
        let truth = (-stretch.known.optical_depth).exp();
        let n = enough(relative_variance::<T>(&stretch.known));
        let lookups = Cell::new(0);
        let field = fixture.sigma_t();
        let counted = |x: f64, y: f64, z: f64| {
            lookups.set(lookups.get() + 1);
            field(x, y, z)
        };
        let medium = stretch.medium(per_lane::<f32>(counted));
        let along: Ray<f32> = ray(fixture.ray.origin, fixture.ray.dir);
        let mut costs = Sample::new();
        let drawn = collect::<f32, PathStream>(seed(22), pixel, n, |rng| {
            lookups.set(0);
            let weight = T::in_any(&medium, &along, stretch.known.t_max as f32, rng, true);
            costs.push(lookups.get() as f64);
            weight
        });
        let weights: Sample = drawn.iter().copied().collect();
        let squares: Sample = drawn.iter().map(|w| w * w).collect();
        let name = |what: &str| format!("{what} of {}", fixture.name);
        assert_agrees(&name("mean"), &weights, truth, RESOLUTION);
        if let Some(second) = T::second_moment(&stretch.known) {
            assert_agrees(&name("second moment"), &squares, second, 0.03);
        }
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
            let weights = sample::<R, S>(seed(23), 0, enough(2.5), |rng| {
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
            each_width!(R, S => {
                let along: Ray<R> = ray(chord.origin, chord.direction);
                let end = R::splat(chord.t_max as f32);
                let weights = sample::<R, S>(seed(24), pixel, enough(1.8), |rng| {
                    T::in_any(&medium, &along, end, rng, everyone::<R>())
                });
                let name = format!("{kind}, {path}, {}", width::<R>());
                assert_agrees(&name, &weights, truth, RESOLUTION);
            });
        }
    }
}

/// A ramp of optical depth one and fog of two: the checks on the real estimators and on the planted mistakes.
#[test]
fn mutants_die() {
    let names = WEIGHTS.map(|(name, _)| name);
    let mut suite = Mutants::new("transmittance", &names);
    let n = samples(1 << 20);
    // The ramp, the same under a loose bound, where null collisions abound, and fog at its bound.
    let ramp = |t: f64| 2.0 * t;
    let fog = |_: f64| 2.0;
    type Numbers<'a> = (&'a dyn Fn(f64) -> f64, f64, f64);
    let profiles: [Numbers<'_>; 3] = [(&ramp, 2.0, 1.0), (&ramp, 8.0, 1.0), (&fog, 2.0, 2.0)];
    for (pixel, (sigma_t, majorant, depth)) in (0..).zip(profiles) {
        let truth = (-depth).exp();
        let medium = Procedural::new(per_lane::<f32>(|x, _, _| sigma_t(x)), majorant as f32);
        let along = ray([0.0; 3], [1.0, 0.0, 0.0]);
        let real = [
            sample::<f32, PathStream>(seed(25), pixel, n, |rng| {
                rows::delta::Row::in_any(&medium, &along, 1.0, rng, true)
            }),
            sample::<f32, PathStream>(seed(26), pixel, n, |rng| {
                rows::ratio::Row::in_any(&medium, &along, 1.0, rng, true)
            }),
        ];
        for weights in &real {
            suite.check("mean", judge(weights.moments(), truth, 0.003));
        }
        let profile = Profile {
            sigma_t,
            majorant,
            t_max: 1.0,
        };
        for (name, mutant) in WEIGHTS {
            let mut rng = SplitMix::new(seed(27));
            let weights: Sample = (0..n).map(|_| mutant(&profile, &mut rng)).collect();
            suite.trial("mean", name, judge(weights.moments(), truth, 0.003));
        }
    }
    suite.finish();
}

/// Streams that repeat in fours leave the mean alone; the block variance sees them.
#[test]
fn repeated_streams_are_seen() {
    let medium = Procedural::new(per_lane::<f32>(|x, _, _| 2.0 * x), 2.0);
    let along = ray([0.0; 3], [1.0, 0.0, 0.0]);
    let mut rng = <PathStream as KeyedStream<f32>>::idle();
    let weights = Sample::collect(samples(1 << 20), |i| {
        let key = woodcock_core::stream::Key {
            seed: seed(28),
            pixel: 0,
            sample: (i / 4) as u32,
        };
        KeyedStream::<f32>::set_key(&mut rng, 0, key);
        f64::from(rows::ratio::Row::in_any(
            &medium, &along, 1.0, &mut rng, true,
        ))
    });
    woodcock_tests::stats::must_kill("repeats in fours", weights.judge_blocks());
}

/// Ratio tracking keeps its mean where the bound fails to bound, as it promises; delta tracking does not.
#[test]
fn only_ratio_tracking_survives_a_bound_that_is_none() {
    let medium = Procedural::new(per_lane::<f32>(|x, _, _| 2.0 * x), 1.6);
    let along = ray([0.0; 3], [1.0, 0.0, 0.0]);
    let truth = (-1.0_f64).exp();
    let run = |estimate: &dyn Fn(&mut PathStream) -> f32| {
        let weights = sample::<f32, PathStream>(seed(29), 0, samples(1 << 20), estimate);
        judge(weights.moments(), truth, 0.003)
    };
    assert_verdict(
        "ratio",
        run(&|rng| rows::ratio::Row::in_any(&medium, &along, 1.0, rng, true)),
    );
    let delta = run(&|rng| rows::delta::Row::in_any(&medium, &along, 1.0, rng, true));
    woodcock_tests::stats::must_kill("delta", delta);
}

/// The closed form has no variance and the error its documentation states, over thirty decades of depth.
#[test]
fn the_closed_form_is_exact_to_rounding() {
    let mut tested = Moments::new();
    for exponent in -90..7 {
        for mantissa in [1.0_f32, 1.171, 1.618, 1.9999] {
            let sigma_t = mantissa * 2.0_f32.powi(exponent);
            let fog = Homogeneous::new(sigma_t).expect("a valid extinction");
            let along = ray([0.0; 3], [0.0, 0.0, 1.0]);
            let weight = woodcock_core::transmittance::analytic::estimate(&fog, &along, 0.7_f32);
            let depth = f64::from(sigma_t) * f64::from(0.7_f32);
            let exact = (-depth).exp();
            if exact < f64::from(f32::MIN_POSITIVE) {
                continue;
            }
            let allowed = 1.2e-7 + 6e-8 * depth;
            assert!(
                (f64::from(weight) / exact - 1.0).abs() <= allowed,
                "depth {depth:e}: {weight:e} for {exact:e}"
            );
            tested.push(f64::from(weight));
        }
    }
    assert!(tested.count() > 380, "{}", tested.count());
}

mod shadows;

macro_rules! row {
    ($name:ident) => {
        mod $name {
            use super::rows::$name::Row;
            #[test]
            fn fog_has_its_mean() {
                super::fog::<Row>();
            }
            #[test]
            fn vacuum_and_tight_bounds_are_exact() {
                super::exact::<Row>();
            }
            #[test]
            fn every_field_has_its_mean() {
                super::fields::<Row>();
            }
            #[test]
            fn variance_and_cost_are_those_of_theory() {
                super::variance_and_cost::<Row>();
            }
            #[test]
            fn grids_have_their_mean() {
                super::grids::<Row>();
            }
        }
    };
}
for_each_transmittance!(row);
// Variants that share a file with a row.
row!(power_series_depth);
row!(residual_ratio_minimum);
