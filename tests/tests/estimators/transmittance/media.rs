//! Media in voxels and media that overlap: every row that serves them.

use super::{PILOT, at_width, enough, pilot};
use woodcock_core::medium::{
    Controlled, Homogeneous, IDENTITY, Linear, Overlap, PiecewiseConstant, Within,
};
use woodcock_core::ray::Ray;
use woodcock_core::real::Real;
use woodcock_core::stream::{PathStream, Stream};
use woodcock_tests::depth::Depth;
use woodcock_tests::each_width;
use woodcock_tests::grids::{TestGrid, unit};
use woodcock_tests::rows::Serves;
use woodcock_tests::rows::transmittance::Estimator;
use woodcock_tests::stats::{Sample, assert_agrees, seed};
use woodcock_tests::voxels;
use woodcock_tests::widths::{everyone, ray, sample, width};

fn in_pieces<T: Estimator, R: Real, M: PiecewiseConstant<R> + Controlled<R>>(
    medium: &M,
    ray: &Ray<R>,
    t_max: R,
    rng: &mut impl Stream<R>,
) -> R {
    let all = everyone::<R>();
    match T::SERVES {
        Serves::PiecewiseConstant => T::in_cells(medium, ray, t_max, rng, all),
        _ => T::in_any(medium, ray, t_max, rng, all),
    }
}

/// What a row that is exact under tight bounds is off by, relative to a depth.
fn assert_exact(name: &str, weights: &Sample, depth: f64) {
    let (least, most) = (weights.moments().min(), weights.moments().max());
    let truth = (-depth).exp();
    let off = (least / truth - 1.0).abs().max((most / truth - 1.0).abs());
    let allowed = 1e-6 * (1.0 + depth);
    assert!(
        off <= allowed,
        "{name}: {least} to {most} for {truth}, off by {off:e}"
    );
}

pub(super) fn voxels<T: Estimator>() {
    if T::SERVES == Serves::ClosedForm {
        return;
    }
    for (pixel, (name, voxels, chord, scale)) in (0..).zip(voxels::cases()) {
        let once = f64::from(scale);
        let depth = voxels
            .depth(chord.origin, chord.direction, chord.t_max, once)
            .total();
        let medium = voxels.medium(IDENTITY, scale);
        let along: Ray<f32> = ray(chord.origin, chord.direction);
        let few = sample::<f32, PathStream>(seed(31), 1000 + pixel, PILOT, |rng| {
            in_pieces::<T, f32, _>(&medium, &along, chord.t_max as f32, rng)
        });
        each_width!(R, S => {
            let name = format!("{name}, {}", width::<R>());
            let along: Ray<R> = ray(chord.origin, chord.direction);
            let end = R::splat(chord.t_max as f32);
            let (n, resolution) = at_width::<R>(enough(pilot::<T>(&few)));
            let weights = sample::<R, S>(seed(31), pixel, n, |rng| {
                in_pieces::<T, R, _>(&medium, &along, end, rng)
            });
            if T::EXACT_IN_PIECES {
                assert_exact(&name, &weights, depth);
            } else {
                assert_agrees(&name, &weights, (-depth).exp(), resolution);
            }
        });
    }
}

/// Optical depths of what overlaps add; a medium in a box that a ray misses is not there.
pub(super) fn overlaps<T: Estimator>() {
    if T::SERVES == Serves::ClosedForm {
        return;
    }
    let fog = |sigma_t: f32| Homogeneous::new(sigma_t).expect("a valid extinction");
    // The second fog ends at a box, from 0.75 to 2.25 of the ray.
    let boxed = Within::aligned(fog(0.6), [0.75, -1.0, -1.0], [2.25, 1.0, 1.0]).expect("a box");
    let medium = Overlap(fog(0.25), boxed);
    let depth = 0.25 * 3.0 + f64::from(0.6_f32) * 1.5;
    each_width!(R, S => {
        let name = format!("fogs, {}", width::<R>());
        let along: Ray<R> = ray([0.0; 3], [1.0, 0.0, 0.0]);
        let (n, resolution) = at_width::<R>(enough(if T::EXACT_IN_PIECES { 0.0 } else { depth.exp_m1() }));
        let weights = sample::<R, S>(seed(32), 0, n, |rng| {
            in_pieces::<T, R, _>(&medium, &along, R::splat(3.0), rng)
        });
        if T::EXACT_IN_PIECES {
            assert_exact(&name, &weights, depth);
        } else {
            assert_agrees(&name, &weights, (-depth).exp(), resolution);
        }
        let past: Ray<R> = ray([0.0, 1.5, 0.0], [1.0, 0.0, 0.0]);
        let ones = sample::<R, S>(seed(32), 1, 100, |rng| {
            in_pieces::<T, R, _>(&boxed, &past, R::splat(3.0), rng)
        });
        assert_eq!((ones.moments().min(), ones.moments().max()), (1.0, 1.0));
    });
    if T::SERVES == Serves::Any {
        ramp_and_grid::<T>();
    }
}

/// A ramp everywhere and a grid in its box, on a ray that begins and ends outside the box.
fn ramp_and_grid<T: Estimator>() {
    let grid = TestGrid::random([17, 18, 19], 45, 0.3);
    let scale = 0.0625;
    let ramp = Linear::new(0.01, [0.0, 0.0025, 0.0]).expect("a finite ramp");
    let medium = Overlap(ramp, Within::domain(grid.medium(IDENTITY, scale)));
    let direction = unit([0.3, 0.8, 0.2]).map(|d| f64::from(d as f32));
    let origin = [2.5, -3.0, 6.25];
    let t_max = 28.0;
    let place = |t: f64| -> [f64; 3] { std::array::from_fn(|a| origin[a] + t * direction[a]) };
    let sigma_t = |t: f64| {
        let p = place(t);
        let last = grid.dims.map(|n| f64::from(n - 1));
        let inside = (0..3).all(|a| (0.0..=last[a]).contains(&p[a]));
        let of_grid = if inside { grid.at(p) } else { 0.0 };
        (f64::from(0.01_f32) + f64::from(0.0025_f32) * p[1]).max(0.0) + f64::from(scale) * of_grid
    };
    let planes = (0..3)
        .flat_map(|a| (0..grid.dims[a]).map(move |i| (f64::from(i) - origin[a]) / direction[a]));
    let depth = Depth::new(t_max, 1, &planes.collect::<Vec<f64>>(), sigma_t).total();
    let estimate = |rng: &mut PathStream| {
        let along: Ray<f32> = ray(origin, direction);
        T::in_any(&medium, &along, t_max as f32, rng, true)
    };
    let few = sample::<f32, PathStream>(seed(33), 1000, PILOT, estimate);
    each_width!(R, S => {
        let along: Ray<R> = ray(origin, direction);
        let (n, resolution) = at_width::<R>(enough(pilot::<T>(&few)));
        let weights = sample::<R, S>(seed(33), 0, n, |rng| {
            T::in_any(&medium, &along, R::splat(t_max as f32), rng, everyone::<R>())
        });
        let name = format!("ramp and grid, {}", width::<R>());
        assert_agrees(&name, &weights, (-depth).exp(), resolution);
    });
}
