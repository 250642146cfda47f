//! How large the blocks of a grid should be.
//!
//! Small blocks bound closely and large ones are few. Under light from all sides, in a medium that absorbs little,
//! rays are everywhere alike (the radiance of a furnace). So a number of rays from places and in directions drawn evenly
//! walk through each candidate, and what they meet is counted:
//!
//! ```text
//! crossings = ends of segments per length,   collisions = ∫σ̄ dt per length: tentative ones
//! ```
//!
//! What one of each costs was found from times of rendering once and for all; no machine is timed, and every machine
//! chooses alike. Finer levels come from the samples, coarser ones from the level below: the footprint of a block is the
//! union of those of its eight parts.

use crate::majorant::footprint::{block_counts, for_each_entry, table_size};
use crate::majorant::{GridLayout, GridWalk, MajorantError};
use crate::ray::{Ray, clip_to_box};
use crate::stream::{Key, PathStream, Stream};
use crate::vec3::Vec3;

/// Rays that are counted.
const RAYS: u32 = 2048;

/// The work of a ray in a majorant grid per length of a voxel's edge, on average over the grid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WalkCost {
    /// Segments that end.
    pub crossings: f64,
    /// Tentative collisions.
    pub collisions: f64,
}

impl WalkCost {
    /// What a tentative collision costs where the end of a segment costs one. Fitted to packets in blocks of 4 to 64, between what
    /// whole paths ask for (about 1: they scatter near the surface of thick clouds, not everywhere alike) and what free flights
    /// do (2 to 4). Choices come within 5 % of the best edge for both.
    pub const COLLISION: f64 = 1.6;

    /// The whole, the end of a segment costing one.
    pub fn total(&self) -> f64 {
        self.crossings + Self::COLLISION * self.collisions
    }
}

/// The work that a table of bounds makes.
///
/// * `majorants`: with their [leaps](crate::majorant::fill_leaps), rim included, of a grid of `dims` samples in blocks
///   of `edge` cells.
/// * `depth`: of a sample of one: extinction times the length of a voxel's edge.
///
/// # Errors
/// A table of another length.
pub fn walk_cost(
    majorants: &[f32],
    dims: [u32; 3],
    edge: u32,
    depth: f64,
) -> Result<WalkCost, MajorantError> {
    check_length(majorants.len(), block_counts(dims, edge))?;
    let layout = GridLayout::<f32>::of_dims(dims, edge, 1.0);
    let (mut crossings, mut bounds, mut length) = (0.0, 0.0, 0.0);
    for number in 0..RAYS {
        let ray = everywhere(number, layout.last);
        let end = clip_to_box(ray.origin, ray.direction, layout.last).t1;
        let mut walk = GridWalk::idle();
        walk.begin(&layout, &ray, majorants, true);
        let mut t = 0.0_f32;
        loop {
            let segment = walk.segment();
            let exit = segment.t_exit.min(end).max(t);
            bounds += f64::from(segment.majorant * (exit - t));
            t = exit;
            // Written so that NaN ends it.
            if !(t < end) {
                break;
            }
            crossings += 1.0;
            walk.next_segment(majorants, true);
        }
        length += f64::from(t);
    }
    Ok(WalkCost {
        crossings: crossings / length,
        collisions: depth * bounds / length,
    })
}

/// A ray from a place in the box [0, last] in a direction, both drawn evenly.
fn everywhere(number: u32, last: Vec3<f32>) -> Ray<f32> {
    let mut stream = PathStream::new(Key {
        seed: 0,
        pixel: number,
        sample: 0,
    });
    let mut uniform = || Stream::<f32>::uniform(&mut stream, true);
    let origin = Vec3::new(uniform(), uniform(), uniform()).times(last);
    let axis = Vec3::new(0.0, 0.0, 1.0);
    Ray {
        origin,
        direction: axis.deflected(2.0 * uniform() - 1.0, uniform()),
    }
}

/// The bounds of blocks with twice the edge.
///
/// * `fine`: bounds without leaps, rim included, of `blocks` along x, y, z. `coarse`: of half as many, rounded up,
///   overwritten.
///
/// # Errors
/// Tables of other lengths.
pub fn coarsen(fine: &[f32], blocks: [u32; 3], coarse: &mut [f32]) -> Result<(), MajorantError> {
    check_length(fine.len(), blocks)?;
    let halved = blocks.map(|n| n.div_ceil(2));
    check_length(coarse.len(), halved)?;
    let size = table_size(blocks)?.map(|n| n as usize);
    for_each_entry(halved, |index, block| {
        let mut largest = 0.0_f32;
        if let Some(block) = block {
            for corner in 0..8_usize {
                let at = [0, 1, 2].map(|a| 2 * block[a] as usize + (corner >> a & 1) + 1);
                let entry = fine.get((at[2] * size[1] + at[1]) * size[0] + at[0]);
                largest = largest.max(entry.copied().unwrap_or(0.0));
            }
        }
        if let Some(entry) = coarse.get_mut(index) {
            *entry = largest;
        }
        Ok(())
    })
}

fn check_length(found: usize, blocks: [u32; 3]) -> Result<(), MajorantError> {
    let expected = table_size(blocks)?.iter().map(|n| *n as usize).product();
    if found == expected {
        Ok(())
    } else {
        Err(MajorantError::Length { expected, found })
    }
}
