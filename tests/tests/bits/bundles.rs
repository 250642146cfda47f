//! Bundles of rays: every schedule and every length gives each ray what scalar code gives it.

use woodcock_core::free_flight::decomposition::{self, Decomposition};
use woodcock_core::free_flight::weighted::{self, Weighted};
use woodcock_core::free_flight::{Flight, analytic, delta};
use woodcock_core::medium::{
    ClosedForm, Controlled, Exponential, Homogeneous, IDENTITY, Interpolated, Linear, Overlap,
    Procedural, Within,
};
use woodcock_core::ray::Ray;
use woodcock_core::stream::{Key, PathStream};
use woodcock_core::transmittance;
use woodcock_core::transmittance::delta::Delta;
use woodcock_core::transmittance::ratio::Ratio;
use woodcock_core::transmittance::residual_ratio::{self, Mean, Minimum, ResidualRatio};
use woodcock_core::vec3::Vec3;
use woodcock_packet::both::Wide;
use woodcock_packet::bundle::{
    Bundle, BundleRay, Schedule, analytic_flights, free_flights, run, transmittances,
};
use woodcock_tests::grids::{TestGrid, unit};
use woodcock_tests::stats::independent::SplitMix;
use woodcock_tests::voxels::TestVoxels;
use woodcock_tests::widths::per_lane;

/// Bundles around multiples of the number of lanes, and none at all.
const LENGTHS: [usize; 8] = [0, 1, 7, 8, 9, 255, 256, 1000];

/// Rays within the box [0, size]: long and short ones, and some of no length.
fn rays(count: usize, size: [f64; 3]) -> Vec<BundleRay> {
    let mut rng = SplitMix::new(91);
    (0..count)
        .map(|i| {
            let origin: [f64; 3] = size.map(|s| s * rng.uniform());
            let direction = unit([rng.normal(), rng.normal(), rng.normal()]);
            let exit = (0..3)
                .map(|a| {
                    (if direction[a] > 0.0 {
                        size[a] - origin[a]
                    } else {
                        -origin[a]
                    }) / direction[a]
                })
                .fold(f64::INFINITY, f64::min);
            let share = [1.0, 0.3, 0.0, 1.0, 1.0][i % 5];
            BundleRay {
                origin: origin.map(|v| v as f32),
                direction: direction.map(|v| v as f32),
                t_max: (exit * share) as f32,
                key: Key {
                    seed: 92,
                    pixel: i as u32,
                    sample: 3,
                },
            }
        })
        .collect()
}

fn scalar(ray: &BundleRay) -> (Ray<f32>, PathStream) {
    let [[ox, oy, oz], [dx, dy, dz]] = [ray.origin, ray.direction];
    let along = Ray {
        origin: Vec3::new(ox, oy, oz),
        direction: Vec3::new(dx, dy, dz),
    };
    (along, PathStream::new(ray.key))
}

fn distance(flight: Flight<f32>) -> f32 {
    if flight.collided {
        flight.t
    } else {
        f32::INFINITY
    }
}

#[track_caller]
fn same(name: &str, wide: &[f32], one: impl Fn(usize) -> f32) {
    for (i, w) in wide.iter().enumerate() {
        let o = one(i);
        assert_eq!(
            w.to_bits(),
            o.to_bits(),
            "{name}, ray {i} of {}: {w:e} and {o:e}",
            wide.len()
        );
    }
}

/// Every length and both schedules; `one` and `eight` are the same medium for each width.
fn medium<A: Controlled<f32>, B: Controlled<Wide>>(name: &str, one: &A, eight: &B, size: [f64; 3]) {
    for count in LENGTHS {
        let rays = rays(count, size);
        let bundle: Bundle = rays.iter().collect();
        assert_eq!((bundle.len(), bundle.is_empty()), (count, count == 0));
        let mut tentative = Vec::new();
        for schedule in [Schedule::Refill, Schedule::LockStep] {
            let name = format!("{name}, {schedule:?}");
            // Places that nothing lands in stay as they were.
            let mut out = vec![f32::NAN; count + 3];
            let usage = free_flights(eight, &bundle, schedule, &mut out);
            tentative.push(usage.tentative_collisions);
            assert!((0.0..=1.0).contains(&usage.lane_utilisation()), "{usage:?}");
            assert!(out[count..].iter().all(|x| x.is_nan()));
            same(&name, &out[..count], |i| {
                let (along, mut rng) = scalar(&rays[i]);
                distance(delta::sample(one, &along, rays[i].t_max, &mut rng, true))
            });
            let mut first = vec![f32::NAN; count / 2];
            free_flights(eight, &bundle, schedule, &mut first);
            same(&name, &first, |i| out[i]);

            transmittances::<Delta, _>(eight, &bundle, schedule, &mut out);
            same(&name, &out[..count], |i| {
                let (along, mut rng) = scalar(&rays[i]);
                transmittance::delta::estimate(one, &along, rays[i].t_max, &mut rng, true)
            });
            transmittances::<Ratio, _>(eight, &bundle, schedule, &mut out);
            same(&name, &out[..count], |i| {
                let (along, mut rng) = scalar(&rays[i]);
                transmittance::ratio::estimate(one, &along, rays[i].t_max, &mut rng, true)
            });
        }
        assert_eq!(
            tentative[0], tentative[1],
            "{name}: the same events under either schedule"
        );
    }
}

/// Every other process that a bundle can run. Bundles know neither media nor processes: a few media stand for all, for each
/// pair of the two takes seconds to compile.
fn processes<A: Controlled<f32>, B: Controlled<Wide>>(
    name: &str,
    one: &A,
    eight: &B,
    size: [f64; 3],
) {
    let rays = rays(1000, size);
    let bundle: Bundle = rays.iter().collect();
    let mut out = vec![f32::NAN; rays.len()];
    macro_rules! check {
        ($process:expr, |$along:ident, $t_max:ident, $rng:ident| $scalar:expr) => {
            for schedule in [Schedule::Refill, Schedule::LockStep] {
                run(eight, &mut $process, &bundle, schedule, &mut out);
                let name = format!("{name}, {}, {schedule:?}", stringify!($process));
                same(&name, &out, |i| {
                    let ($along, mut stream) = scalar(&rays[i]);
                    let ($t_max, $rng) = (rays[i].t_max, &mut stream);
                    $scalar
                });
            }
        };
    }
    check!(Decomposition::idle(eight), |along, t_max, rng| distance(
        decomposition::sample(one, &along, t_max, rng, true)
    ));
    check!(Weighted::idle(eight), |along, t_max, rng| distance(
        weighted::sample(one, &along, t_max, rng, true).flight
    ));
    check!(
        ResidualRatio::<Wide, B::Walk, Mean>::idle(eight),
        |along, t_max, rng| residual_ratio::estimate::<Mean, _, _>(one, &along, t_max, rng, true)
    );
    check!(
        ResidualRatio::<Wide, B::Walk, Minimum>::idle(eight),
        |along, t_max, rng| residual_ratio::estimate::<Minimum, _, _>(
            one, &along, t_max, rng, true
        )
    );
}

#[test]
fn homogeneous_bundles() {
    for sigma_t in [0.0, 0.3, 25.0] {
        let fog = Homogeneous::new(sigma_t).expect("a valid extinction");
        medium("fog", &fog, &fog, [2.0, 3.0, 4.0]);
        processes("fog", &fog, &fog, [2.0, 3.0, 4.0]);
    }
}

#[test]
fn procedural_bundles() {
    let field = |x: f64, y: f64, z: f64| 2.5 + (3.0 * x).sin() + (2.0 * y * z).cos();
    let one = Procedural::new(per_lane::<f32>(field), 4.6).with_control(0.5, 2.5);
    let eight = Procedural::new(per_lane::<Wide>(field), 4.6).with_control(0.5, 2.5);
    medium("formula", &one, &eight, [2.0, 1.5, 3.0]);
}

#[test]
fn grid_bundles() {
    let grids = [
        ("cloud", TestGrid::cloud([33, 26, 25], 93)),
        ("small", TestGrid::random([2, 3, 9], 94, 0.0)),
        ("empty", TestGrid::random([17, 17, 17], 95, 1.0)),
        ("holes", TestGrid::random([40, 24, 17], 96, 0.6)),
    ];
    for (name, grid) in &grids {
        let size = grid.dims.map(|n| f64::from(n - 1));
        for scale in [0.05, 2.0] {
            let on_grid = grid.medium(IDENTITY, scale);
            medium(name, &on_grid, &on_grid, size);
            processes(name, &on_grid, &on_grid, size);
        }
    }
}

#[test]
fn bundles_through_voxels_ramps_and_overlaps() {
    let voxels = TestVoxels::random([13, 9, 11], 97, 0.3);
    let in_voxels = voxels.medium(IDENTITY, 0.5);
    medium("voxels", &in_voxels, &in_voxels, [13.0, 9.0, 11.0]);
    for (offset, gradient) in [
        (0.0, [0.5, 0.25, 0.0]),
        (2.0, [-0.5, 0.0, -0.125]),
        (-1.0, [0.0, 0.5, 0.5]),
    ] {
        let ramp = Linear::new(offset, gradient).expect("a finite ramp");
        medium("ramp", &ramp, &ramp, [4.0, 4.0, 4.0]);
        let grid = TestGrid::random([9, 10, 17], 98, 0.4);
        let both = Overlap(Within::domain(grid.medium(IDENTITY, 0.5)), ramp);
        medium("grid in its box and ramp", &both, &both, [12.0, 7.0, 20.0]);
        processes("grid in its box and ramp", &both, &both, [12.0, 7.0, 20.0]);
    }
    let air = Exponential::new(0.5, [0.0, -0.25, 0.5]).expect("a valid atmosphere");
    medium("atmosphere", &air, &air, [4.0, 4.0, 4.0]);
    let grid = TestGrid::random([17, 18, 19], 99, 0.4);
    let in_full = Interpolated(grid.medium(IDENTITY, 0.5));
    medium("grid in full", &in_full, &in_full, [16.0, 17.0, 18.0]);
}

/// Closed forms are the same eight at a time.
fn closed_form(medium: &(impl ClosedForm<f32> + ClosedForm<Wide>)) {
    for count in LENGTHS {
        let rays = rays(count, [2.0; 3]);
        let bundle: Bundle = rays.iter().collect();
        for places in [count, count / 2, count + 5] {
            let mut out = vec![f32::NAN; places];
            let usage = analytic_flights(medium, &bundle, &mut out);
            let landed = count.min(places);
            assert_eq!(usage.tentative_collisions, landed as u64);
            assert!(out[landed..].iter().all(|x| x.is_nan()));
            same("closed form", &out[..landed], |i| {
                let (along, mut rng) = scalar(&rays[i]);
                let flight = analytic::sample(medium, &along, rays[i].t_max, &mut rng, true);
                distance(flight)
            });
        }
    }
}

#[test]
fn closed_form_bundles() {
    for sigma_t in [0.0, 0.7, 100.0] {
        closed_form(&Homogeneous::new(sigma_t).expect("a valid extinction"));
    }
    closed_form(&Exponential::new(1.5, [0.5, 0.0, -0.25]).expect("a valid atmosphere"));
    for offset in [-0.5, 0.0, 1.0] {
        closed_form(&Linear::new(offset, [0.75, -0.5, 0.25]).expect("a finite ramp"));
    }
}

/// Refilling keeps lanes busy where waiting for the slowest does not. Up to four lanes wait for one another, which is cheaper than
/// to begin rays one by one.
#[test]
fn refilled_lanes_are_busier() {
    let grid = TestGrid::cloud([33, 26, 25], 93);
    let medium = grid.medium(IDENTITY, 2.0);
    let rays = rays(4096, [32.0, 25.0, 24.0]);
    let bundle: Bundle = rays.iter().collect();
    let mut out = vec![0.0; rays.len()];
    let mut busy = |schedule| free_flights(&medium, &bundle, schedule, &mut out).lane_utilisation();
    let (refill, lock_step) = (busy(Schedule::Refill), busy(Schedule::LockStep));
    assert!(
        refill > 0.85 && refill > lock_step + 0.5,
        "{refill} and {lock_step}"
    );
}
