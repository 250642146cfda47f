//! What paths fly through: a ball, or a grid of which one sample stands for a place.

use wide::{f32x8, i32x8};
use woodcock_host::scene::blackbody_peak_one;

use super::{Stream, V, dot};
use crate::yardstick::Cells;

/// Kelvins between entries of the table of black bodies.
const STEP: f32 = 0.5;

/// What paths fly through.
pub(super) trait Medium {
    /// Distance to the matter's hull, and whether it is met.
    fn enter(&self, origin: V, direction: V) -> (f32x8, f32x8);
    fn inside(&self, p: V) -> f32x8;
    /// Whether a tentative collision is real.
    fn real(&self, p: V, inside: f32x8, rng: &mut Stream) -> f32x8;
    /// Light sent out at a place.
    fn glow(&self, p: [f32; 3]) -> [f32; 3];
}

pub(super) struct Ball(pub(super) f32);

impl Medium for Ball {
    fn enter(&self, origin: V, direction: V) -> (f32x8, f32x8) {
        let b = -dot(origin, direction);
        let root = b * b - (dot(origin, origin) - self.0 * self.0);
        (b - root.max(f32x8::ZERO).sqrt(), f32x8::ZERO.simd_lt(root))
    }
    fn inside(&self, p: V) -> f32x8 {
        dot(p, p).simd_lt(f32x8::splat(self.0 * self.0))
    }
    fn real(&self, _: V, inside: f32x8, _: &mut Stream) -> f32x8 {
        inside
    }
    fn glow(&self, _: [f32; 3]) -> [f32; 3] {
        [0.0; 3]
    }
}

#[derive(Debug)]
pub(super) struct Grid<'a> {
    cells: &'a Cells,
    /// Over the largest density.
    density: Vec<f32>,
    far: [f32; 3],
    cells_per_length: f32,
    black_bodies: Vec<[f32; 3]>,
}

impl<'a> Grid<'a> {
    pub(super) fn new(cells: &'a Cells, largest: f32, glow: f32) -> Self {
        let hottest = cells.kelvin.iter().copied().fold(0.0, f32::max);
        let colour =
            |i| blackbody_peak_one(f64::from(i as f32 * STEP)).map(|c| c.max(0.0) as f32 * glow);
        let entries = if hottest > 0.0 {
            (hottest / STEP) as usize + 2
        } else {
            0
        };
        Self {
            cells,
            density: cells.density.iter().map(|d| d / largest).collect(),
            far: cells.corner().map(|c| -c),
            cells_per_length: cells.dims.into_iter().max().unwrap_or(1) as f32,
            black_bodies: (0..entries).map(colour).collect(),
        }
    }
}

impl Medium for Grid<'_> {
    fn enter(&self, origin: V, direction: V) -> (f32x8, f32x8) {
        let (mut near, mut far) = (f32x8::ZERO, f32x8::splat(f32::MAX));
        for a in 0..3 {
            let inverse = f32x8::ONE / direction[a];
            let (s, t) = (
                (-f32x8::splat(self.far[a]) - origin[a]) * inverse,
                (f32x8::splat(self.far[a]) - origin[a]) * inverse,
            );
            near = near.fast_max(s.fast_min(t));
            far = far.fast_min(s.fast_max(t));
        }
        (near, near.simd_lt(far))
    }
    fn inside(&self, p: V) -> f32x8 {
        let [x, y, z] = [0, 1, 2].map(|a| p[a].abs().simd_lt(f32x8::splat(self.far[a])));
        x & y & z
    }
    fn real(&self, p: V, inside: f32x8, rng: &mut Stream) -> f32x8 {
        let [i, j, k] = [0, 1, 2].map(|a| {
            let at = (p[a] + f32x8::splat(self.far[a])) * f32x8::splat(self.cells_per_length) - 0.5;
            let index = (at + rng.next()).floor(); // the upper neighbour with the weight that it has
            let last = f32x8::splat((self.cells.dims[a] - 1) as f32);
            index.fast_max(f32x8::ZERO).fast_min(last).fast_trunc_int()
        });
        let [nx, ny, _] = self.cells.dims.map(|n| i32x8::splat(n as i32));
        let place = ((k * ny + j) * nx + i).to_array();
        let density = f32x8::new(place.map(|i| self.density[i as usize]));
        rng.next().simd_lt(density) & inside
    }
    fn glow(&self, p: [f32; 3]) -> [f32; 3] {
        let dims = self.cells.dims;
        let at: [f32; 3] = std::array::from_fn(|a| {
            let at = (p[a] + self.far[a]) * self.cells_per_length - 0.5;
            at.clamp(0.0, (dims[a] - 1) as f32)
        });
        let cell: [usize; 3] = std::array::from_fn(|a| (at[a] as usize).min(dims[a] - 2));
        let first = (cell[2] * dims[1] + cell[1]) * dims[0] + cell[0];
        let mut kelvin = 0.0;
        for corner in 0..8_usize {
            let up = [corner & 1, corner >> 1 & 1, corner >> 2];
            let offset = (up[2] * dims[1] + up[1]) * dims[0] + up[0];
            let weight = |a: usize| {
                let w = at[a] - cell[a] as f32;
                if up[a] == 1 { w } else { 1.0 - w }
            };
            kelvin += weight(0) * weight(1) * weight(2) * self.cells.kelvin[first + offset];
        }
        self.black_bodies[(kelvin / STEP + 0.5) as usize]
    }
}
