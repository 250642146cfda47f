//! Slabs whose matter lies unevenly: the same numbers, by delta tracking.

use super::{GS, TAUS, UNIT, compare, comparisons};
use crate::random_walk::Ledger;
use woodcock_core::ray::{FAR, Ray};
use woodcock_tests::grids::TestGrid;
use woodcock_tests::walker::{Body, Flights, Tracked, UnderBound};

/// Extinctions of a slab of thickness 1 whose optical thickness is `tau`, under loose bounds.
pub(super) fn profiles(tau: f64) -> [(&'static str, Box<dyn Flights>); 4] {
    let ramp = move |_, _, z: f64| 2.0 * tau * z;
    let haze = move |_, _, z: f64| 3.0 * tau * (-3.0 * z).exp() / -(-3.0_f64).exp_m1();
    let stripes = move |_, _, z: f64| {
        let odd = (8.0 * z).floor().rem_euclid(2.0) == 1.0;
        tau * if odd { 1.9 } else { 0.1 }
    };
    let gap = move |_, _, z: f64| {
        if (0.3..0.7).contains(&z) {
            0.0
        } else {
            tau / 0.6
        }
    };
    [
        ("ramp", Box::new(ramp.under(3.0 * tau))),
        ("haze", Box::new(haze.under(3.2 * tau))),
        ("stripes", Box::new(stripes.under(2.0 * tau))),
        ("gap", Box::new(gap.under(2.5 * tau))),
    ]
}

/// Where the matter lies in a slab does not matter, nor by how much a bound exceeds it.
#[test]
fn profiles_of_equal_thickness_are_equal() {
    let mut ledger = Ledger::new("slab_matched");
    let mut expected = 0;
    for (i, tau) in TAUS.into_iter().enumerate() {
        let profiles = profiles(tau);
        for (j, g) in GS.into_iter().enumerate() {
            for k in 0..2 {
                let (name, flights) = &profiles[(i + j + 2 * k) % 4];
                let medium = (UNIT, flights.as_ref(), *name);
                compare(&mut ledger, medium, tau, g, (i + 3 * k) % 4, 2);
                expected += comparisons(tau);
            }
        }
    }
    ledger.finish(expected);
}

/// The slab as far as the grid reaches to its sides: a thousand thicknesses, more than any particle goes.
#[derive(Clone, Copy, Debug)]
struct Wide;

impl Wide {
    const HALF: f32 = 1000.0;
}

impl Body for Wide {
    fn exit(&self, ray: &Ray<f32>) -> f32 {
        let side = |at: f32, slope: f32| {
            if slope == 0.0 {
                FAR
            } else {
                (Self::HALF.copysign(slope) - at) / slope
            }
        };
        let (o, d) = (ray.origin, ray.direction);
        UNIT.exit(ray).min(side(o.x, d.x)).min(side(o.y, d.y))
    }
}

/// The same for a grid with five blocks one below the other, two of them empty, which bounds of blocks skip.
#[test]
fn grids_of_equal_thickness_are_equal() {
    let mut ledger = Ledger::new("slab_matched");
    let mut expected = 0;
    let density = |z: u32| match z {
        9..=16 | 26..=32 => 0.0,
        _ => 0.2 + 0.1 * f64::from(z * 7 % 16),
    };
    // Linear between samples.
    let mean = (0..32)
        .map(|z| 0.5 * (density(z) + density(z + 1)))
        .sum::<f64>()
        / 32.0;
    let grid = TestGrid::new([3, 3, 33], |[_, _, z]| density(z) as f32);
    let across = [1.0 / Wide::HALF, 1.0];
    let to_grid = [
        [across[0], 0.0, 0.0, across[1]],
        [0.0, across[0], 0.0, across[1]],
        [0.0, 0.0, 32.0, 0.0],
    ];
    for (i, tau) in TAUS.into_iter().enumerate() {
        let scale = tau / mean;
        let flights = Tracked::new(grid.medium(to_grid, scale as f32), 1.7 * scale);
        for (j, g) in GS.into_iter().enumerate() {
            let medium = (Wide, &flights as &dyn Flights, "grid");
            compare(&mut ledger, medium, tau, g, (i + j + 1) % 4, 2);
            expected += comparisons(tau);
        }
    }
    ledger.finish(expected);
}
