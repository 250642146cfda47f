//! Free flights: every row of the registry against the exact law of the distance to the next collision.
//!
//! P(collision before t) = 1 − e^−τ(t), on closed-form fields, on grids with majorant blocks, and where the answer
//! needs no statistics; at all widths. The checks must reject every planted mistake.

use woodcock_core::for_each_free_flight;
use woodcock_core::free_flight::Flight;
use woodcock_core::medium::{Affine, Homogeneous, IDENTITY};
use woodcock_core::ray::Ray;
use woodcock_core::real::{Mask, Real};
use woodcock_core::stream::KeyedStream;
use woodcock_tests::depth::Depth;
use woodcock_tests::each_width;
use woodcock_tests::fixtures;
use woodcock_tests::grids::{Chord, TestGrid, chord, map_point, map_vector};
use woodcock_tests::rows::Serves;
use woodcock_tests::rows::free_flight as rows;
use woodcock_tests::rows::free_flight::Sampler;
use woodcock_tests::stats::{
    KolmogorovSmirnov, Verdict, assert_verdict, judge_proportion, samples, seed,
};
use woodcock_tests::widths::{collect, everyone, no_one, ray, width};

/// A sampler as a number: the distance, infinite where the flight left.
fn distance<R: Real>(flight: Flight<R>, t_max: R) -> R {
    let beyond = t_max.lt(flight.t);
    assert!(!beyond.any(), "a flight of {:?} beyond {t_max:?}", flight.t);
    R::select(flight.collided, flight.t, R::splat(f32::INFINITY))
}

/// What 2¹⁶ flights can see of a distance between laws.
const SHARP: f64 = 0.012;
/// What 2¹³ flights can.
const COARSE: f64 = 0.03;

/// The two questions to a set of flights: is the law of the distance right, and the share that leaves?
///
/// * `resolution`: the distance between laws that must be seen.
fn judge(
    flights: Vec<f64>,
    t_max: f64,
    resolution: f64,
    cdf: impl Fn(f64) -> f64,
) -> (Verdict, Verdict) {
    let n = flights.len() as u64;
    let mut inside: Vec<f64> = flights.into_iter().filter(|t| t.is_finite()).collect();
    let hits = inside.len() as u64;
    // A collision may be rounded up to the very end of its ray, but not beyond: `distance` saw to that.
    for t in &mut inside {
        *t = t.min(t_max.next_down());
    }
    let share = cdf(t_max);
    let law = KolmogorovSmirnov::censored(&mut inside, n - hits, t_max, cdf).verdict(resolution);
    let sees = if share > 1e-9 && share < 1.0 - 1e-9 {
        judge_proportion(hits, n, share, 0.2)
    } else {
        Verdict::Agrees
    };
    (law, sees)
}

const PATHS: usize = 1 << 16;

fn fog<T: Sampler>() {
    let t_max = 2.5;
    for sigma_t in [0.02, 0.4, 3.0] {
        let medium = Homogeneous::new(sigma_t).expect("a valid extinction");
        each_width!(R, S => {
            let along: Ray<R> = ray([0.0; 3], [0.0, 0.0, 1.0]);
            let flights = collect::<R, S>(seed(11), 0, samples(1 << 18), |rng| {
                let end = R::splat(t_max);
                distance(T::in_fog(&medium, &along, end, rng, everyone::<R>()), end)
            });
            let cdf = |t: f64| -(-f64::from(sigma_t) * t).exp_m1();
            let (law, share) = judge(flights, f64::from(t_max), SHARP, cdf);
            let name = format!("fog {sigma_t} {}", width::<R>());
            assert_verdict(&name, law);
            assert_verdict(&name, share);
        });
    }
}

/// Nothing collides in vacuum, on rays of any length; inactive lanes neither fly nor draw.
fn vacuum<T: Sampler>() {
    let medium = Homogeneous::new(0.0).expect("vacuum is a medium");
    each_width!(R, S => {
        let along: Ray<R> = ray([0.0; 3], [1.0, 0.0, 0.0]);
        for t_max in [0.0, 1e-30, 1.0, 1e30] {
            let end = R::splat(t_max);
            let flights = collect::<R, S>(1, 0, 1000, |rng| {
                let flight = T::in_fog(&medium, &along, end, rng, everyone::<R>());
                assert!(flight.t.eq(end).all(), "vacuum ends at {:?}", flight.t);
                distance(flight, end)
            });
            assert!(flights.iter().all(|t| t.is_infinite()));
        }
        let endless = R::splat(f32::INFINITY);
        let mut rng = <S as KeyedStream<R>>::idle();
        let flight = T::in_fog(&medium, &along, endless, &mut rng, everyone::<R>());
        assert!(!flight.collided.any());
        // An opaque wall ends every flight of positive length, none of length zero.
        let wall = Homogeneous::new(1e20).expect("a valid extinction");
        let flight = T::in_fog(&wall, &along, R::one(), &mut rng, everyone::<R>());
        assert!(flight.collided.all());
        let flight = T::in_fog(&wall, &along, R::zero(), &mut rng, everyone::<R>());
        assert!(!flight.collided.any());
        let flight = T::in_fog(&wall, &along, R::one(), &mut rng, no_one::<R>());
        assert!(!flight.collided.any());
    });
}

/// Flights through one closed-form field.
fn through<T: Sampler, R: Real, S: KeyedStream<R>>(
    fixture: &fixtures::Fixture,
    pixel: u32,
    n: usize,
    loose: f32,
) -> Vec<f64> {
    let medium = fixture.medium::<R>(loose);
    let along: Ray<R> = ray(fixture.ray.origin, fixture.ray.dir);
    let end = R::splat(fixture.ray.t_max as f32);
    collect::<R, S>(seed(12), pixel, samples(n), |rng| {
        distance(T::in_any(&medium, &along, end, rng, everyone::<R>()), end)
    })
}

fn fields<T: Sampler>() {
    if T::SERVES != Serves::Any {
        return;
    }
    for (pixel, fixture) in (0..).zip(fixtures::all()) {
        let t_max = f64::from(fixture.ray.t_max as f32);
        let depth = Depth::new(t_max, 300, &fixture.breaks(), fixture.along());
        let verdicts = |name: String, flights: Vec<f64>, resolution| {
            let (law, share) = judge(flights, t_max, resolution, |t| depth.collided(t));
            assert_verdict(&name, law);
            assert_verdict(&name, share);
        };
        // Every other bound is looser than it need be, which costs null collisions and changes nothing.
        let loose = if pixel % 2 == 0 { 1.0 } else { 3.0 };
        each_width!(R, S => {
            let name = format!("{} {}, bound times {loose}", fixture.name, width::<R>());
            // Lanes repeat what f32 drew, as `lanes.rs` shows bit by bit: one ray of a field will do, and few flights.
            if width::<R>() == "f32" {
                verdicts(name, through::<T, R, S>(&fixture, pixel, PATHS, loose), SHARP);
            } else if pixel % 4 == pixel / 4 % 4 {
                verdicts(name, through::<T, R, S>(&fixture, pixel, PATHS / 8, loose), COARSE);
            }
        });
    }
}

/// Rotated by 30 degrees about z, stretched by 8, 10 and 16, and moved.
const PLACED: Affine = [
    [6.928_203, 4.0, 0.0, 3.0],
    [-5.0, 8.660_254, 0.0, 5.0],
    [0.0, 0.0, 16.0, 1.0],
];

/// Rays that a walk over blocks may trip over, in grid space.
fn awkward(dims: [u32; 3]) -> Vec<(&'static str, Chord)> {
    let middle = dims.map(|n| 0.5 * f64::from(n - 1));
    let [mx, my, mz] = middle;
    vec![
        ("diagonal", chord(dims, middle, [1.0, 1.0, 1.0])),
        (
            "against the diagonal",
            chord(dims, middle, [-1.0, -1.0, -1.0]),
        ),
        ("along x", chord(dims, [mx, 3.3, 5.7], [1.0, 0.0, 0.0])),
        (
            "along -y on a plane of samples",
            chord(dims, [2.0, my, 7.0], [0.0, -1.0, 0.0]),
        ),
        (
            "along z in a face of blocks",
            chord(dims, [8.0, 8.0, mz], [0.0, 0.0, 1.0]),
        ),
        (
            "in a face of blocks, askew",
            chord(dims, [8.0, my, mz], [0.0, 1.0, -0.6]),
        ),
        (
            "along an outer face",
            chord(dims, [0.0, my, mz], [0.0, 0.3, 1.0]),
        ),
        (
            "tiny components",
            chord(dims, [mx, my, mz + 0.2], [1e-7, -1.0, -1e-30]),
        ),
        ("skew", chord(dims, [4.1, 9.9, 3.2], [0.8, -0.3, 0.5])),
    ]
}

fn grids<T: Sampler>() {
    if T::SERVES != Serves::Any {
        return;
    }
    let dims = [21, 18, 17];
    let grids = [
        ("random", TestGrid::random(dims, 31, 0.0)),
        ("with holes", TestGrid::random(dims, 32, 0.7)),
        ("cloud in empty blocks", TestGrid::cloud([41, 26, 25], 33)),
    ];
    for (kind, grid) in &grids {
        for (pixel, (path, chord)) in (0..).zip(awkward(grid.dims)) {
            let scale = 4.0 / chord.t_max as f32;
            let depth = grid.depth(chord.origin, chord.direction, chord.t_max, f64::from(scale));
            let medium = grid.medium(IDENTITY, scale);
            each_width!(R, S => {
                let along: Ray<R> = ray(chord.origin, chord.direction);
                let end = R::splat(chord.t_max as f32);
                let sharp = width::<R>() == "f32";
                let (n, resolution) = if sharp { (PATHS, SHARP) } else { (PATHS / 8, COARSE) };
                let flights = collect::<R, S>(seed(13), pixel, samples(n), |rng| {
                    distance(T::in_any(&medium, &along, end, rng, everyone::<R>()), end)
                });
                let (law, share) = judge(flights, chord.t_max, resolution, |t| depth.collided(t));
                let name = format!("{kind}, {path}, {}", width::<R>());
                assert_verdict(&name, law);
                assert_verdict(&name, share);
            });
        }
    }
}

/// A grid turned, stretched and moved: t stays a length of the world.
fn placed<T: Sampler>() {
    if T::SERVES != Serves::Any {
        return;
    }
    let grid = TestGrid::random([17, 25, 33], 34, 0.3);
    let direction = [0.26, 0.31, 0.91];
    let direction = woodcock_tests::grids::unit(direction).map(|d| f64::from(d as f32));
    let origin = [0.1_f32, 0.05, 0.02].map(f64::from);
    let (from, to) = (map_point(&PLACED, origin), map_vector(&PLACED, direction));
    // As far as the ray stays inside.
    let t_max = (0..3)
        .map(|a| {
            (if to[a] > 0.0 {
                f64::from(grid.dims[a] - 1) - from[a]
            } else {
                -from[a]
            }) / to[a]
        })
        .fold(f64::INFINITY, f64::min);
    let t_max = f64::from((t_max * (1.0 - 1e-6)) as f32);
    let scale = 3.0 / t_max as f32;
    let depth = grid.depth(from, to, t_max, f64::from(scale));
    let medium = grid.medium(PLACED, scale);
    each_width!(R, S => {
        let along: Ray<R> = ray(origin, direction);
        let end = R::splat(t_max as f32);
        let flights = collect::<R, S>(seed(14), 0, samples(1 << 18), |rng| {
            distance(T::in_any(&medium, &along, end, rng, everyone::<R>()), end)
        });
        let (law, share) = judge(flights, t_max, SHARP, |t| depth.collided(t));
        assert_verdict(width::<R>(), law);
        assert_verdict(width::<R>(), share);
    });
}

mod closed_form;
mod failing_bounds;
mod mutants;
mod voxels;

macro_rules! row {
    ($name:ident) => {
        mod $name {
            use super::rows::$name::Row;
            #[test]
            fn fog_follows_the_exponential_law() {
                super::fog::<Row>();
            }
            #[test]
            fn vacuum_and_walls_are_exact() {
                super::vacuum::<Row>();
            }
            #[test]
            fn every_field_gives_its_law() {
                super::fields::<Row>();
            }
            #[test]
            fn grids_give_their_law_on_awkward_rays() {
                super::grids::<Row>();
            }
            #[test]
            fn voxels_give_their_law_on_awkward_rays() {
                super::voxels::law::<Row>();
            }
            #[test]
            fn a_placed_grid_keeps_lengths_of_the_world() {
                super::placed::<Row>();
            }
        }
    };
}
for_each_free_flight!(row);
