//! Voxels that shine, for sampling places that send out light.

use glam::{DAffine3, DVec3};
use woodcock_core::path::RecordKind;

use super::{Medium, Tables};

/// The cube of side one around a sample in grid space, clipped to where the medium is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EmissiveVoxel {
    /// Index of the sample in its grid.
    pub index: u32,
    /// About the mean over the box of the source σ_a · L_e \[W/(m³ sr)\]; some colour is positive wherever
    /// any place of the box shines.
    pub source: [f64; 3],
    /// Corners of the box in grid space.
    pub low: DVec3,
    /// The other corner.
    pub high: DVec3,
}

/// Where a mean misses all light of a voxel it is taken for this much of what the voxel may send out.
const TRACE: f64 = 1.0 / 1024.0;

impl Medium {
    /// From grid space to the rendered world; `None` for a homogeneous medium.
    pub fn grid_to_world(&self) -> Option<DAffine3> {
        self.world_to_grid().map(|map| map.inverse())
    }

    /// The voxels of a grid that shine, in the order of its samples; none for media without samples.
    ///
    /// Their boxes tile the part of space where the medium is. Means are taken by the midpoint rule in each eighth of
    /// a voxel, exact where only the density varies: good enough to choose voxels by, for chances that are only
    /// compared with themselves.
    pub fn emissive_voxels(&self, tables: &Tables) -> Vec<EmissiveVoxel> {
        let mut found = Vec::new();
        let RecordKind::Grid { dims, samples, .. } = self.record.kind else {
            return found;
        };
        let (Some(emission), Some(support), Some(to_world)) =
            (self.emission(), &self.support, self.grid_to_world())
        else {
            return found;
        };
        if !self.has_samples() {
            return found;
        }
        // The support is a box of grid space too: its own space differs by a translation.
        let near = self.world_to_grid().map_or(DVec3::ZERO, |map| {
            map.transform_point3(support.to_local.inverse().translation)
        });
        let far = near + support.size;
        let [nx, ny, nz] = dims;
        let at = |[x, y, z]: [u32; 3]| ((z * ny + y) * nx + x) as usize;
        let first = samples as usize;
        let around = |i: u32, n: u32| i.saturating_sub(1)..=(i + 1).min(n - 1);
        let row = |[x, y, z]: [u32; 3]| {
            let ends = around(x, nx);
            first + at([*ends.start(), y, z])..=first + at([*ends.end(), y, z])
        };
        let rows = |[x, y, z]: [u32; 3]| {
            around(z, nz).flat_map(move |z| around(y, ny).map(move |y| row([x, y, z])))
        };
        let has_matter = |voxel: [u32; 3]| {
            rows(voxel).any(|row| {
                let row = tables.samples.get(row).unwrap_or_default();
                row.iter().any(|v| *v > 0.0)
            })
        };
        // The largest absorption of the samples that the box is interpolated from.
        let absorption = |voxel: [u32; 3]| {
            rows(voxel).flatten().fold([0.0_f64; 3], |largest, tap| {
                let sample = self.at_sample(tables, tap as u32).sigma_a;
                std::array::from_fn(|c| largest[c].max(sample[c]))
            })
        };
        for z in 0..nz {
            for y in 0..ny {
                for x in 0..nx {
                    if !has_matter([x, y, z]) {
                        continue;
                    }
                    let centre = DVec3::new(f64::from(x), f64::from(y), f64::from(z));
                    let low = (centre - 0.5).max(near);
                    let high = (centre + 0.5).min(far);
                    if !low.cmplt(high).all() {
                        continue;
                    }
                    let source = self.mean_source(tables, &to_world, [low, centre, high]);
                    let source = if source.iter().any(|s| *s > 0.0) {
                        source
                    } else {
                        let corner = |i: usize| {
                            let pick = |bit: usize| i >> bit & 1 == 1;
                            let p = DVec3::select(
                                glam::BVec3::new(pick(0), pick(1), pick(2)),
                                high,
                                low,
                            );
                            to_world.transform_point3(p)
                        };
                        let trace = emission.trace(&std::array::from_fn(corner));
                        let sigma_a = absorption([x, y, z]);
                        std::array::from_fn(|c| trace[c] * sigma_a[c] * TRACE)
                    };
                    if source.iter().any(|s| *s > 0.0) {
                        found.push(EmissiveVoxel {
                            index: at([x, y, z]) as u32,
                            source,
                            low,
                            high,
                        });
                    }
                }
            }
        }
        found
    }

    /// The mean source of a box that a sample divides.
    fn mean_source(
        &self,
        tables: &Tables,
        to_world: &DAffine3,
        [low, centre, high]: [DVec3; 3],
    ) -> [f64; 3] {
        let mut sum = [0.0; 3];
        let volume = (high - low).element_product();
        for i in 0..8_u32 {
            let upper = |bit: u32| i >> bit & 1 == 1;
            let mask = glam::BVec3::new(upper(0), upper(1), upper(2));
            let from = DVec3::select(mask, centre.max(low), low);
            let to = DVec3::select(mask, high, centre.min(high));
            if !from.cmplt(to).all() {
                continue;
            }
            let share = (to - from).element_product() / volume;
            let middle = to_world.transform_point3((from + to) * 0.5);
            let local = self.local(tables, None, middle);
            for (sum, source) in sum.iter_mut().zip(local.emission) {
                *sum += share * source;
            }
        }
        sum
    }
}
