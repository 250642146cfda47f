//! How large the blocks of a grid should be.
//!
//! Small blocks bound closely and large ones are few. Under light from all sides, in a medium that absorbs little,
//! rays are everywhere alike (the radiance of a furnace), so per length of ray
//!
//! ```text
//! crossings = mean over the volume of  3/2 / (k · edge)      faces of blocks, or of cubes of k blocks that a leap crosses
//! collisions = mean over the volume of  σ̄                    tentative ones
//! ```
//!
//! as a plane of the lattice is met 1/2 times a length that is as long as its distance, whatever the direction, by the
//! mean of |cos|. What one of each costs was counted in instructions; no machine is timed. Finer levels come from the
//! samples, coarser ones from the level below: the footprint of a block is the union of those of its eight parts.

use crate::majorant::MajorantError;
use crate::majorant::footprint::{block_counts, for_each_entry, table_size};
use crate::majorant::leaps::mean_inverse_reach;

/// The work of a ray in a majorant grid per length of a voxel's edge, on average over the grid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WalkCost {
    /// Segments that end.
    pub crossings: f64,
    /// Tentative collisions.
    pub collisions: f64,
}

impl WalkCost {
    /// What a tentative collision costs where the end of a segment costs one: a packet's instructions to decide and to draw
    /// anew over those of an advance.
    pub const COLLISION: f64 = 1.1;

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
    let blocks = block_counts(dims, edge);
    check_length(majorants.len(), blocks)?;
    let (mut crossings, mut bounds, mut whole) = (0.0, 0.0, 0.0);
    for_each_entry(blocks, |index, block| {
        if let Some(block) = block {
            let entry = majorants.get(index).copied().unwrap_or(0.0);
            // The last block of an axis may reach beyond the grid.
            let cells = |a: usize| edge.min(dims[a] - 1 - block[a] * edge);
            let volume = [0, 1, 2].map(cells).map(f64::from).iter().product::<f64>();
            whole += volume;
            bounds += volume * f64::from(entry.max(0.0));
            crossings += volume * mean_inverse_reach(entry);
        }
        Ok(())
    })?;
    Ok(WalkCost {
        crossings: 1.5 / f64::from(edge) * crossings / whole,
        collisions: depth * bounds / whole,
    })
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
