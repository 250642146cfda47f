//! Small grids of voxels with a double-precision oracle: constant extinction in each, and its optical depth.

use crate::depth::Depth;
use crate::fixtures;
use crate::grids::{Chord, chord};
use crate::refs::transmittance::{Field, Grid};
use crate::stats::independent::SplitMix;
use woodcock_core::medium::{Affine, Voxels, fill_voxels, voxel_count};

/// Voxels in the table that core makes of them.
#[derive(Clone, Debug)]
pub struct TestVoxels {
    /// Voxels along x, y, z.
    pub dims: [u32; 3],
    table: Vec<f32>,
}

impl TestVoxels {
    /// From a function of the indices.
    ///
    /// # Panics
    /// Where core refuses the voxels.
    pub fn new(dims: [u32; 3], mut value: impl FnMut([u32; 3]) -> f32) -> Self {
        let [nx, ny, nz] = dims;
        let mut values = Vec::new();
        for z in 0..nz {
            for y in 0..ny {
                for x in 0..nx {
                    values.push(value([x, y, z]));
                }
            }
        }
        let mut table = vec![f32::NAN; voxel_count(dims).expect("few voxels")];
        fill_voxels(&values, dims, &mut table).expect("lengths that fit");
        Self { dims, table }
    }

    /// Uniform values in [0, 1), of which the given share is zero.
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

    /// The voxels of a reference table.
    pub fn of(grid: &Grid) -> Self {
        Self::new([5; 3], |i| {
            let [x, y, z] = i.map(|i| i as usize);
            grid[x][y][z] as f32
        })
    }

    /// The medium.
    ///
    /// # Panics
    /// For a map or a scale that core refuses.
    pub fn medium(&self, world_to_grid: Affine, scale: f32) -> Voxels<'_> {
        Voxels::new(&self.table, self.dims, world_to_grid, scale).expect("valid voxels")
    }

    /// The value of the voxel that a place of the domain lies in.
    pub fn at(&self, place: [f64; 3]) -> f64 {
        let [x, y, z]: [usize; 3] = std::array::from_fn(|a| {
            let last = f64::from(self.dims[a] - 1);
            place[a].floor().clamp(0.0, last) as usize + 1
        });
        let [nx, ny, _] = self.dims.map(|n| n as usize + 2);
        f64::from(self.table[x + nx * (y + ny * z)])
    }

    /// Optical depth along a ray in the space of voxels, `scale` [1/length] for a value of one.
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
                let faces = 0..=self.dims[a];
                breaks.extend(faces.map(|i| (f64::from(i) - origin[a]) / direction[a]));
            }
        }
        Depth::new(t_max, 1, &breaks, move |t| {
            scale * self.at(std::array::from_fn(|a| origin[a] + t * direction[a]))
        })
    }
}

/// Voxels, rays through them, and the extinction of a value of one on each ray: those of the reference table, and
/// random ones with rays along faces and edges.
///
/// # Panics
/// When the table is damaged.
pub fn cases() -> Vec<(String, TestVoxels, Chord, f32)> {
    let mut cases = Vec::new();
    for fixture in fixtures::of_field("nearest_grid") {
        let Field::NearestGrid { scale, grid } = &fixture.field else {
            panic!("{} is no grid of voxels", fixture.name)
        };
        let chord = Chord {
            origin: fixture.ray.origin.map(|v| f64::from(v as f32)),
            direction: fixture.ray.dir.map(|v| f64::from(v as f32)),
            t_max: f64::from(fixture.ray.t_max as f32),
        };
        cases.push((
            fixture.name.clone(),
            TestVoxels::of(grid),
            chord,
            *scale as f32,
        ));
    }
    let dims = [13, 9, 11];
    let inside = |origin, direction, t_max| Chord {
        origin,
        direction,
        t_max,
    };
    // `chord` is of samples, one more than voxels.
    let corners = dims.map(|n| n + 1);
    let diagonal = |d| chord(corners, [6.5, 4.5, 5.5], d);
    let rays = [
        ("diagonal", diagonal([1.0, 1.0, 1.0])),
        ("against the diagonal", diagonal([-1.0, -1.0, -1.0])),
        (
            "along a face",
            inside([0.5, 4.0, 5.5], [1.0, 0.0, 0.0], 12.0),
        ),
        (
            "backwards along an edge",
            inside([7.0, 8.75, 3.0], [0.0, -1.0, 0.0], 8.5),
        ),
        (
            "askew in a face",
            inside([3.0, 0.25, 10.5], [0.0, 0.6, -0.8], 13.0),
        ),
        ("tiny components", diagonal([1e-7, 1.0, -1e-30])),
        ("skew", chord(corners, [4.1, 6.9, 3.2], [0.8, -0.3, 0.5])),
    ];
    let random = TestVoxels::random(dims, 41, 0.3);
    for (name, chord) in rays {
        let scale = 4.0 / chord.t_max as f32;
        cases.push((name.to_owned(), random.clone(), chord, scale));
    }
    cases
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_row_of_voxels_adds_up() {
        let voxels = TestVoxels::new([4, 1, 1], |[x, _, _]| (x + 1) as f32);
        let depth = voxels.depth([0.5, 0.5, 0.5], [1.0, 0.0, 0.0], 3.5, 2.0);
        for (t, exact) in [(0.25, 0.5), (0.5, 1.0), (1.5, 5.0), (3.5, 19.0)] {
            assert!((depth.at(t) - exact).abs() < 1e-12, "{t}");
        }
        let back = voxels.depth([4.0, 0.5, 0.5], [-1.0, 0.0, 0.0], 4.0, 1.0);
        assert!((back.at(1.5) - 5.5).abs() < 1e-12);
    }
}
