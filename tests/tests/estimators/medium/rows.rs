//! The cases of each row: media with their oracles, and rays through them.

use super::{AXES, Question, Row, cells};
use woodcock_core::medium::{
    Affine, Exponential, Homogeneous, IDENTITY, Interpolated, Linear, Overlap, Placed, Procedural,
    Within,
};
use woodcock_core::real::Real;
use woodcock_tests::fixtures;
use woodcock_tests::grids::{Chord, TestGrid, chord, map_point, unit};
use woodcock_tests::voxels::TestVoxels;
use woodcock_tests::widths::per_lane;

pub(super) struct Fog;
impl Row for Fog {
    fn put<R: Real>(question: &mut impl Question<R>) {
        for sigma_t in [0.0, 0.7, 1e6] {
            let medium = Homogeneous::new(sigma_t).expect("a valid extinction");
            for direction in AXES {
                let chord = chord([9, 9, 9], [4.0, 3.0, 2.0], direction);
                let name = format!("fog {sigma_t}");
                question.ask(&name, &medium, &|_| f64::from(sigma_t), &chord);
            }
        }
    }
}

/// Turned by 30 degrees about z, stretched unevenly, sheared and moved.
pub(super) const PLACED: Affine = [
    [6.928_203, 4.0, 0.5, 3.0],
    [-5.0, 8.660_254, 0.0, 6.0],
    [0.25, 0.0, 12.0, 4.0],
];

pub(super) struct OnGrid;
impl Row for OnGrid {
    fn put<R: Real>(question: &mut impl Question<R>) {
        for (dims, empty) in [([17, 18, 19], 0.5), ([2, 2, 2], 0.0), ([41, 9, 33], 0.9)] {
            let grid = TestGrid::random(dims, 81, empty);
            let medium = grid.medium(IDENTITY, 2.5);
            let middle = dims.map(|n| 0.5 * f64::from(n - 1));
            for direction in AXES {
                let name = format!("grid of {dims:?}");
                let chord = chord(dims, middle, direction);
                question.ask(&name, &medium, &|p| 2.5 * grid.at(p), &chord);
            }
        }
        // From near the grid's origin to where the walk must stop inside it, in world space.
        let grid = TestGrid::random([17, 25, 33], 82, 0.3);
        let medium = grid.medium(PLACED, 4.0);
        for direction in [[0.3, 0.4, 0.8], [0.0, 1.0, 0.0], [-0.5, 0.2, 0.1]] {
            let chord = Chord {
                origin: [0.25, 0.5, 0.25],
                direction: unit(direction).map(|d| f64::from(d as f32)),
                t_max: 0.5,
            };
            let sigma_t = |p| 4.0 * grid.at(map_point(&PLACED, p));
            question.ask("placed grid", &medium, &sigma_t, &chord);
        }
    }
}

pub(super) struct InFull;
impl Row for InFull {
    fn put<R: Real>(question: &mut impl Question<R>) {
        let grid = TestGrid::random([17, 18, 19], 64, 0.5);
        let medium = Interpolated(grid.medium(IDENTITY, 2.5));
        for direction in AXES {
            let chord = chord(grid.dims, [8.2, 8.1, 9.3], direction);
            question.ask("grid in full", &medium, &|p| 2.5 * grid.at(p), &chord);
        }
    }
}

pub(super) struct Formula;
impl Row for Formula {
    fn put<R: Real>(question: &mut impl Question<R>) {
        for fixture in fixtures::all().iter().step_by(4) {
            let field = fixture.sigma_t();
            let bound = (fixture.majorant as f32).next_up();
            let medium = Procedural::new(per_lane::<R>(fixture.sigma_t()), bound)
                .with_control(fixture.minimum() as f32, fixture.mean() as f32);
            let chord = Chord {
                origin: fixture.ray.origin.map(|v| f64::from(v as f32)),
                direction: fixture.ray.dir.map(|v| f64::from(v as f32)),
                t_max: f64::from(fixture.ray.t_max as f32),
            };
            question.ask(&fixture.name, &medium, &|p| field(p[0], p[1], p[2]), &chord);
        }
    }
}

/// σ₀ and gradient of ramps; the last two are zero somewhere on their way.
pub(super) const RAMPS: [(f32, [f32; 3]); 5] = [
    (2.0, [0.0; 3]),
    (0.5, [0.3, 0.0, 0.1]),
    (3.0, [-0.1, 0.05, -0.2]),
    (0.4, [-0.1, -0.1, -0.1]),
    (-1.0, [0.2, 0.3, 0.01]),
];

pub(super) struct Ramp;
impl Row for Ramp {
    fn put<R: Real>(question: &mut impl Question<R>) {
        for (offset, gradient) in RAMPS {
            let medium = Linear::new(offset, gradient).expect("a finite ramp");
            let at = |p: [f64; 3]| {
                let slope: f64 = (0..3).map(|a| f64::from(gradient[a]) * p[a]).sum();
                (f64::from(offset) + slope).max(0.0)
            };
            for direction in AXES {
                let chord = chord([9, 9, 9], [4.0, 3.0, 2.0], direction);
                question.ask(&format!("ramp {offset} {gradient:?}"), &medium, &at, &chord);
            }
        }
    }
}

pub(super) struct Atmosphere;
impl Row for Atmosphere {
    fn put<R: Real>(question: &mut impl Question<R>) {
        for (sigma_0, falloff) in [
            (2.0, [0.0; 3]),
            (0.0, [0.0, 0.0, 1.0]),
            (0.5, [0.3, 0.0, -0.1]),
            (3.0, [0.0, 0.0, 2.0]),
            (4.0, [1e-6, -1e-7, 0.0]),
        ] {
            let medium = Exponential::new(sigma_0, falloff).expect("a valid atmosphere");
            let at = |p: [f64; 3]| {
                let heights: f64 = (0..3).map(|a| f64::from(falloff[a]) * p[a]).sum();
                f64::from(sigma_0) * (-heights).exp()
            };
            for direction in AXES {
                let chord = chord([9, 9, 9], [4.0, 3.0, 2.0], direction);
                question.ask(&format!("air {sigma_0} {falloff:?}"), &medium, &at, &chord);
            }
        }
    }
}

pub(super) struct OfVoxels;
impl Row for OfVoxels {
    fn put<R: Real>(question: &mut impl Question<R>) {
        for dims in [[8, 8, 8], [1, 1, 1], [13, 2, 5]] {
            let blocks = TestVoxels::random(dims, 61, 0.3);
            let medium = blocks.medium(IDENTITY, 3.0);
            let middle = dims.map(|n| 0.4143 * f64::from(n));
            for direction in AXES {
                let chord = chord(dims.map(|n| n + 1), middle, direction);
                question.ask("cells", &medium, &|p| 3.0 * blocks.at(p), &chord);
            }
        }
    }
}

pub(super) struct Sum;
impl Row for Sum {
    fn put<R: Real>(question: &mut impl Question<R>) {
        let grid = TestGrid::random([17, 18, 19], 62, 0.4);
        let fog = Homogeneous::new(0.25).expect("a valid extinction");
        let ramp = Linear::new(0.5, [0.1, 0.0, 0.05]).expect("a finite ramp");
        let medium = Overlap(Overlap(fog, grid.medium(IDENTITY, 2.0)), ramp);
        let at = |p: [f64; 3]| 0.25 + 2.0 * grid.at(p) + 0.5 + 0.1 * p[0] + 0.05 * p[2];
        for direction in AXES {
            let chord = chord(grid.dims, [8.0, 7.5, 9.0], direction);
            question.ask("fog, grid and ramp", &medium, &at, &chord);
        }
    }
}

pub(super) struct Moved;
impl Row for Moved {
    fn put<R: Real>(question: &mut impl Question<R>) {
        for (offset, gradient) in RAMPS {
            let ramp = Linear::new(offset, gradient).expect("a finite ramp");
            let medium = Placed::new(ramp, PLACED).expect("a finite map");
            let at = |p: [f64; 3]| {
                let q = map_point(&PLACED, p);
                let slope: f64 = (0..3).map(|a| f64::from(gradient[a]) * q[a]).sum();
                (f64::from(offset) + slope).max(0.0)
            };
            for direction in AXES {
                let chord = chord([9, 9, 9], [4.0, 3.0, 2.0], direction);
                question.ask("placed ramp", &medium, &at, &chord);
            }
        }
    }
}

pub(super) struct Boxed;
impl Row for Boxed {
    fn put<R: Real>(question: &mut impl Question<R>) {
        let grid = TestGrid::random([9, 10, 17], 63, 0.2);
        let map = [
            [1.0, 0.0, 0.0, -3.0],
            [0.0, 1.0, 0.0, -2.5],
            [0.0, 0.0, 1.0, -4.0],
        ];
        let medium = Within::domain(grid.medium(map, 1.5));
        let at = |p: [f64; 3]| {
            let q = [p[0] - 3.0, p[1] - 2.5, p[2] - 4.0];
            let inside = (0..3).all(|a| q[a] >= 0.0 && q[a] <= f64::from(grid.dims[a] - 1));
            if inside { 1.5 * grid.at(q) } else { 0.0 }
        };
        // Through the box, and past it.
        for (through, direction) in [
            ([8.0, 6.0, 11.0], [0.6, 0.48, 0.64]),
            ([8.0, 6.0, 11.0], [-1.0, 1e-7, 1.0]),
            ([8.0, 6.0, 11.0], [0.0, -1.0, 0.0]),
            ([1.0, 1.0, 11.0], [0.0, 0.0, 1.0]),
        ] {
            let chord = chord([18, 18, 26], through, direction);
            question.ask("grid in its box", &medium, &at, &chord);
        }
        let fog = Homogeneous::new(2.0).expect("a valid extinction");
        let medium = Within::aligned(fog, [1.0, 2.0, 3.0], [4.0, 5.0, 9.5]).expect("a box");
        let at = |p: [f64; 3]| {
            let low = [1.0, 2.0, 3.0];
            let high = [4.0, 5.0, 9.5];
            let inside = (0..3).all(|a| p[a] >= low[a] && p[a] <= high[a]);
            if inside { 2.0 } else { 0.0 }
        };
        let chord = chord([10, 10, 10], [2.0, 3.0, 4.0], [0.5, 0.3, 0.8]);
        question.ask("fog in a box", &medium, &at, &chord);
        // Far away, where a distance is rounded by more than the pieces of the ramp resolve.
        for (offset, slope) in [(3715.3, -3.7), (-3699.6, 3.7)] {
            let ramp = Linear::new(offset, [slope, 0.0, 0.0]).expect("a finite ramp");
            let medium =
                Within::aligned(ramp, [1000.0, 0.0, 0.0], [1004.0, 9.0, 9.0]).expect("a box");
            let at = |p: [f64; 3]| {
                let inside = (1000.0..=1004.0).contains(&p[0]);
                if inside {
                    f64::from(offset) + f64::from(slope) * p[0]
                } else {
                    0.0
                }
            };
            let chord = Chord {
                origin: [0.0, 4.0, 4.0],
                direction: [1.0, 0.0, 0.0],
                t_max: 1008.0,
            };
            question.ask("ramp in a far box", &medium, &at, &chord);
        }
        for k in [1.3_f32, -1.3] {
            // e^−kx, of order one in the box.
            let air = Exponential::new((k * 0.01).exp(), [k, 0.0, 0.0]).expect("an atmosphere");
            let shift = [
                [1.0, 0.0, 0.0, -1000.0],
                [0.0, 1.0, 0.0, 0.0],
                [0.0, 0.0, 1.0, 0.0],
            ];
            let air = Placed::new(air, shift).expect("a finite map");
            let medium =
                Within::aligned(air, [1000.0, 0.0, 0.0], [1004.0, 9.0, 9.0]).expect("a box");
            let at = |p: [f64; 3]| {
                let inside = (1000.0..=1004.0).contains(&p[0]);
                let height = f64::from(k) * (p[0] - 1000.01);
                if inside { (-height).exp() } else { 0.0 }
            };
            let chord = Chord {
                origin: [0.0, 4.0, 4.0],
                direction: [1.0, 0.0, 0.0],
                t_max: 1008.0,
            };
            question.ask("air in a far box", &medium, &at, &chord);
        }
    }
}

// The suite's name for each row of the registry.
pub(super) type exponential = Atmosphere;
pub(super) type interpolated = InFull;
pub(super) type linear = Ramp;
pub(super) type voxels = OfVoxels;
pub(super) type overlap = Sum;
pub(super) type placed = Moved;
pub(super) type within = Boxed;
pub(super) type homogeneous = Fog;
pub(super) type grid = OnGrid;
pub(super) type procedural = Formula;
pub(super) type procedural_grid = cells::InCells;
