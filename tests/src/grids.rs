//! Small grids of samples with a double-precision oracle: their trilinear interpolant and its optical depth.
//!
//! The oracle shares nothing with the walk under test: it knows no blocks and no bounds, works in `f64`, and cuts
//! a ray where it crosses planes of samples, between which the interpolant is a cubic.

use crate::depth::Depth;
use crate::stats::independent::SplitMix;
use woodcock_core::majorant::{MajorantGrid, fill_majorants, majorant_count};
use woodcock_core::medium::{Affine, Grid};

/// Samples and the bounds that core computes for them.
#[derive(Clone, Debug)]
pub struct TestGrid {
    /// Samples along x, y, z.
    pub dims: [u32; 3],
    /// Values, x fastest.
    pub samples: Vec<f32>,
    /// What [`fill_majorants`] makes of them.
    pub majorants: Vec<f32>,
}

impl TestGrid {
    /// From a function of the indices.
    ///
    /// # Panics
    /// Where core refuses the samples.
    pub fn new(dims: [u32; 3], mut value: impl FnMut([u32; 3]) -> f32) -> Self {
        let [nx, ny, nz] = dims;
        let mut samples = Vec::new();
        for z in 0..nz {
            for y in 0..ny {
                for x in 0..nx {
                    samples.push(value([x, y, z]));
                }
            }
        }
        let count = majorant_count(dims).expect("a small grid has few blocks");
        let mut majorants = vec![f32::NAN; count];
        fill_majorants(&samples, dims, &mut majorants).expect("valid samples have bounds");
        Self {
            dims,
            samples,
            majorants,
        }
    }

    /// Uniform samples in [0, 1), of which the given share is zero.
    pub fn random(dims: [u32; 3], seed: u64, empty: f64) -> Self {
        let mut rng = SplitMix::new(seed);
        Self::new(dims, |_| {
            if rng.uniform() < empty {
                0.0
            } else {
                rng.uniform() as f32
            }
        })
    }

    /// One sample of one, all else zero.
    pub fn spike(dims: [u32; 3], at: [u32; 3]) -> Self {
        Self::new(dims, |i| f32::from(u8::from(i == at)))
    }

    /// A ball of random samples in the middle of nothing: most blocks are empty.
    pub fn cloud(dims: [u32; 3], seed: u64) -> Self {
        let mut rng = SplitMix::new(seed);
        Self::new(dims, |i| {
            let squared: f64 = (0..3)
                .map(|a| {
                    let half = 0.5 * f64::from(dims[a] - 1);
                    ((f64::from(i[a]) - half) / (0.6 * half)).powi(2)
                })
                .sum();
            let value = rng.uniform() * (1.0 - squared).max(0.0);
            value as f32
        })
    }

    /// Samples and bounds, checked against each other.
    ///
    /// # Panics
    /// Where core doubts its own bounds.
    pub fn bounds(&self) -> MajorantGrid<'_> {
        MajorantGrid::new(&self.samples, self.dims, &self.majorants)
            .expect("computed bounds cover their samples")
    }

    /// The medium.
    ///
    /// # Panics
    /// For a map or a scale that core refuses.
    pub fn medium(&self, world_to_grid: Affine, scale: f32) -> Grid<'_> {
        Grid::new(self.bounds(), world_to_grid, scale).expect("finite map and scale")
    }

    /// The sample at indices within the grid.
    pub fn sample(&self, [x, y, z]: [usize; 3]) -> f64 {
        let [nx, ny, _] = self.dims.map(|n| n as usize);
        f64::from(self.samples[x + nx * (y + ny * z)])
    }

    /// The interpolant at a place in grid space, clamped into the domain.
    pub fn at(&self, place: [f64; 3]) -> f64 {
        let low: [f64; 3] = std::array::from_fn(|a| {
            let last = f64::from(self.dims[a] - 1);
            place[a].clamp(0.0, last).floor().min(last - 1.0)
        });
        let share: [f64; 3] = std::array::from_fn(|a| (place[a] - low[a]).clamp(0.0, 1.0));
        (0..8)
            .map(|corner| {
                let bit = [corner & 1, corner >> 1 & 1, corner >> 2];
                let weight: f64 = (0..3)
                    .map(|a| {
                        if bit[a] == 1 {
                            share[a]
                        } else {
                            1.0 - share[a]
                        }
                    })
                    .product();
                let at = std::array::from_fn(|a| low[a] as usize + bit[a]);
                weight * self.sample(at)
            })
            .sum()
    }

    /// Optical depth along a ray in grid space, `scale` [1/length] for a sample of one.
    pub fn depth(
        &self,
        origin: [f64; 3],
        direction: [f64; 3],
        t_max: f64,
        scale: f64,
    ) -> Depth<'_> {
        let mut breaks = Vec::new();
        for a in 0..3 {
            if direction[a] != 0.0 {
                let planes = 0..self.dims[a];
                breaks.extend(planes.map(|i| (f64::from(i) - origin[a]) / direction[a]));
            }
        }
        Depth::new(t_max, 1, &breaks, move |t| {
            scale * self.at(std::array::from_fn(|a| origin[a] + t * direction[a]))
        })
    }
}

/// A ray through a grid, in world space, and where it lies in grid space; all in `f64` of `f32` numbers.
#[derive(Clone, Copy, Debug)]
pub struct Chord {
    /// Where it enters the domain, world space.
    pub origin: [f64; 3],
    /// Unit direction, world space.
    pub direction: [f64; 3],
    /// How far it goes within the domain \[length\].
    pub t_max: f64,
}

/// A direction of unit length.
pub fn unit(direction: [f64; 3]) -> [f64; 3] {
    let length = direction.iter().map(|v| v * v).sum::<f64>().sqrt();
    direction.map(|v| v / length)
}

/// Applies an affine map to a point, in `f64`.
pub fn map_point(rows: &Affine, p: [f64; 3]) -> [f64; 3] {
    rows.map(|r| {
        let r = r.map(f64::from);
        r[0] * p[0] + r[1] * p[1] + r[2] * p[2] + r[3]
    })
}

/// Applies the linear part of an affine map to a vector, in `f64`.
pub fn map_vector(rows: &Affine, v: [f64; 3]) -> [f64; 3] {
    rows.map(|r| {
        let r = r.map(f64::from);
        r[0] * v[0] + r[1] * v[1] + r[2] * v[2]
    })
}

/// A ray from a face of the box [0, n − 1] through an inner point, in grid space: from where it enters to where
/// it leaves, drawn in a bit on either side so that rounding keeps it inside.
pub fn chord(dims: [u32; 3], through: [f64; 3], direction: [f64; 3]) -> Chord {
    let direction = unit(direction);
    let (mut t0, mut t1) = (f64::NEG_INFINITY, f64::INFINITY);
    for a in 0..3 {
        if direction[a] != 0.0 {
            let near = -through[a] / direction[a];
            let far = (f64::from(dims[a] - 1) - through[a]) / direction[a];
            t0 = t0.max(near.min(far));
            t1 = t1.min(near.max(far));
        }
    }
    let slack = 1e-6 * (t1 - t0);
    let origin =
        std::array::from_fn(|a| f64::from((through[a] + (t0 + slack) * direction[a]) as f32));
    Chord {
        origin,
        direction: direction.map(|d| f64::from(d as f32)),
        t_max: f64::from((t1 - t0 - 2.0 * slack) as f32),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_linear_grid_has_the_depth_of_a_ramp() {
        let grid = TestGrid::new([9, 3, 3], |[x, _, _]| x as f32);
        let depth = grid.depth([0.0, 0.7, 1.1], [1.0, 0.0, 0.0], 8.0, 0.5);
        for t in [0.3, 1.0, 4.7, 8.0] {
            assert!((depth.at(t) - 0.25 * t * t).abs() < 1e-13);
        }
        assert!((depth.squared_integral() - 0.25 * 512.0 / 3.0).abs() < 1e-11);
    }

    #[test]
    fn a_product_of_coordinates_is_interpolated_exactly() {
        let grid = TestGrid::new([4, 5, 6], |[x, y, z]| (x * y * z) as f32);
        for p in [[0.5, 3.25, 4.9], [3.0, 4.0, 5.0], [0.0, 2.0, 1.5]] {
            assert!((grid.at(p) - p[0] * p[1] * p[2]).abs() < 1e-12);
        }
    }
}
