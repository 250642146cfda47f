//! The grey case: where wavelengths do not differ, all of this is delta tracking with a weight of one.

use super::{Flown, set_keys};
use woodcock_core::free_flight::delta;
use woodcock_core::medium::{IDENTITY, Medium, Procedural};
use woodcock_core::ray::Ray;
use woodcock_core::real::Real;
use woodcock_core::spectral::{Coloured, transmittance};
use woodcock_core::stream::{KeyedStream, PathStream};
use woodcock_core::transmittance::ratio;
use woodcock_tests::each_width;
use woodcock_tests::grids::TestGrid;
use woodcock_tests::rows::spectral::Way;
use woodcock_tests::widths::{everyone, per_lane, ray, width};

/// Paths compared with those of delta tracking.
const PATHS: usize = 4096;

/// The same random numbers give the same distances, bit by bit, and every weight is one up to rounding.
pub(super) fn equal_wavelengths_are_delta_tracking<T: Way, const N: usize>() {
    fn same<T: Way, R: Real, S: KeyedStream<R>, M: Medium<R> + Copy, const N: usize>(
        grey: M,
        along: &Ray<R>,
        t_max: f32,
    ) {
        let medium = Coloured::new(grey, [1.0; N]).expect("valid colours");
        let (mut rng, end) = (S::idle(), R::splat(t_max));
        let mut collided = 0;
        for first in (0..PATHS).step_by(R::LANES) {
            set_keys(&mut rng, 413, 0, first);
            let found = T::sample(&medium, along, end, &mut rng, everyone::<R>());
            set_keys(&mut rng, 413, 0, first);
            if T::LEADS && N > 1 {
                // The draw that chooses among equals.
                rng.uniform(everyone::<R>());
            }
            let expected = delta::sample(&grey, along, end, &mut rng, everyone::<R>());
            for lane in 0..R::LANES {
                let at = |t: R| t.lane(lane).to_bits();
                let path = Flown::of(&found, lane);
                assert_eq!(at(found.flight.t), at(expected.t), "{N} {}", width::<R>());
                let weight = found.weight.lane(lane);
                let equal = weight.iter().all(|w| w.to_bits() == weight[0].to_bits());
                assert!(equal && (weight[0] - 1.0).abs() < 1e-5, "{weight:?}");
                collided += usize::from(!path.left());
            }
        }
        assert!(
            (PATHS / 4..PATHS).contains(&collided),
            "{collided} collisions"
        );
    }
    let grid = TestGrid::cloud([33, 26, 25], 414);
    let cloud = grid.medium(IDENTITY, 0.5);
    let wave = |x: f64, _: f64, _: f64| 2.0 + (3.0 * x).sin();
    each_width!(R, S => {
        let along: Ray<R> = ray([0.0, 12.0, 13.0], [1.0, 0.0, 0.0]);
        let field = per_lane::<R>(wave);
        same::<T, R, S, _, N>(Procedural::new(&field, 3.5), &along, 1.0);
        same::<T, R, S, _, N>(cloud, &along, 31.9);
    });
}

/// Ratio tracking of equal wavelengths has the bits of ratio tracking.
#[test]
fn equal_transmittances_are_ratio_tracking() {
    let ramp = per_lane::<f32>(|x, _, _| 2.0 * x);
    let grey = Procedural::new(&ramp, 2.5);
    let medium = Coloured::new(grey, [1.0; 4]).expect("valid colours");
    let along = ray([0.0; 3], [1.0, 0.0, 0.0]);
    for path in 0..PATHS {
        let mut rng = <PathStream as KeyedStream<f32>>::idle();
        set_keys::<f32, _>(&mut rng, 415, 0, path);
        let mut again = rng.clone();
        let weights = transmittance::estimate(&medium, &along, 1.0, &mut rng, true);
        let expected = ratio::estimate(&grey, &along, 1.0, &mut again, true);
        assert_eq!(weights.0.map(f32::to_bits), [expected.to_bits(); 4]);
    }
}
