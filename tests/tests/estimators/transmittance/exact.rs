//! Closed forms and sums over cells: no variance, and the error that their documentation states.

use woodcock_core::medium::{Homogeneous, IDENTITY};
use woodcock_core::ray::Ray;
use woodcock_core::real::Real;
use woodcock_core::transmittance::regular;
use woodcock_tests::each_width;
use woodcock_tests::stats::Moments;
use woodcock_tests::voxels::TestVoxels;
use woodcock_tests::widths::{everyone, ray, width};

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

/// Over a thousand cells the distances to their faces are rounded a thousand times, half a unit of the last place each.
#[test]
fn long_sums_over_cells_are_exact() {
    let dims = [700, 500, 3];
    let cells = TestVoxels::random(dims, 42, 0.2);
    let (mut worst, t_max) = (0.0_f64, 800.0);
    for tilt in 0..20 {
        let tilt = f64::from(tilt) * 0.005;
        let direction = woodcock_tests::grids::unit([0.8 + tilt, 0.6 - tilt, 0.003]);
        let direction = direction.map(|d| f64::from(d as f32));
        let origin = [0.5, 1.25, 0.125];
        let once = cells.depth(origin, direction, t_max, 1.0).total();
        for depth in [0.01, 1.0, 8.0] {
            let scale = (depth / once) as f32;
            let exact = once * f64::from(scale);
            let medium = cells.medium(IDENTITY, scale);
            each_width!(R, S => {
                let _: Option<S> = None;
                let along: Ray<R> = ray(origin, direction);
                let weight = regular::estimate(&medium, &along, R::splat(t_max as f32), everyone::<R>());
                let off = f64::from(weight.lane(0)) / (-exact).exp() - 1.0;
                let of_depth = if width::<R>() == "f64" { 1e-12 } else { 3e-6 };
                assert!(
                    off.abs() <= 1.5e-7 + of_depth * exact,
                    "{} at {depth}: off by {off:e}",
                    width::<R>()
                );
                worst = worst.max(off.abs() / exact.max(1.0));
            });
        }
    }
    println!("worst relative error over max(1, depth): {worst:.1e}");
    assert!(worst > 1e-7, "{worst:e}: the bound could be sharper");
}
