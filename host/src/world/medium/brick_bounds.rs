//! What is known of the blocks of a grid in bricks: computed in small boxes, and only where there are bricks.

use woodcock_core::majorant::{EDGES, MajorantError, block_counts, fill_control_slab, fill_slab};
use woodcock_core::path::BRICK;

use super::bounds::{Bounds, empty_table};
use super::bricks::BrickTables;

/// The bounds of a grid in bricks: those of the same samples in one table, bit for bit.
///
/// # Errors
/// As [`Bounds::new`].
pub(super) fn bounds(bricks: &BrickTables, depth: f64) -> Result<Bounds, MajorantError> {
    let (dims, edge) = (bricks.dims(), EDGES[0]);
    let mut finest = empty_table(dims, edge)?;
    let blocks = block_counts(dims, edge);
    // Two layers of blocks, which are one of bricks, at a time; the rim is of zeros.
    let [across, slab] = [
        blocks[0] as usize + 2,
        (blocks[0] as usize + 2) * (blocks[1] as usize + 2),
    ];
    let (_, inner) = finest.split_at_mut(slab);
    let layers = blocks[2].div_ceil(2) as usize;
    let layer = |(at, entries): (usize, &mut [f32])| {
        let mut samples = Vec::new();
        let mut local = Vec::new();
        for y in 0..blocks[1].div_ceil(2) {
            for x in 0..blocks[0].div_ceil(2) {
                let brick = [x, y, at as u32];
                let first = brick.map(|b| b * 2 * edge);
                let size: [u32; 3] =
                    std::array::from_fn(|a| (2 * edge + 1).min(dims[a] - first[a]));
                if !bricks.samples_of(first, size, &mut samples) {
                    continue;
                }
                let [bx, by, bz] = block_counts(size, edge).map(|n| n as usize);
                for z in 0..bz {
                    local.clear();
                    local.resize((bx + 2) * (by + 2), 0.0);
                    fill_slab(&samples, size, edge, z + 1, &mut local)
                        .map_err(|e| placed(e, first))?;
                    for row in 0..by {
                        let to =
                            z * slab + (2 * y as usize + row + 1) * across + 2 * x as usize + 1;
                        let from = (row + 1) * (bx + 2) + 1;
                        let found = local.get(from..from + bx).unwrap_or_default();
                        if let Some(entries) = entries.get_mut(to..to + bx) {
                            entries.copy_from_slice(found);
                        }
                    }
                }
            }
        }
        Ok(())
    };
    #[cfg(feature = "rayon")]
    {
        use rayon::prelude::*;
        let pieces = inner.par_chunks_mut(2 * slab).take(layers).enumerate();
        pieces.map(layer).collect::<Result<(), _>>()?;
    }
    #[cfg(not(feature = "rayon"))]
    for piece in inner.chunks_mut(2 * slab).take(layers).enumerate() {
        layer(piece)?;
    }
    Bounds::of_finest(finest, dims, depth)
}

/// An error among samples of a box, told of the grid.
fn placed(error: MajorantError, first: [u32; 3]) -> MajorantError {
    match error {
        MajorantError::Sample { at, value } => MajorantError::Sample {
            at: std::array::from_fn(|a| at[a] + first[a]),
            value,
        },
        other => other,
    }
}

/// Minorants and means of blocks of an edge, those of the same samples in one table, bit for bit.
///
/// # Errors
/// As [`Bounds::new`].
pub(super) fn controls(bricks: &BrickTables, edge: u32) -> Result<[Vec<f32>; 2], MajorantError> {
    let dims = bricks.dims();
    let (mut minorants, mut means) = (empty_table(dims, edge)?, empty_table(dims, edge)?);
    let blocks = block_counts(dims, edge);
    let across = blocks[0] as usize + 2;
    // Row by row of blocks: large ones are few.
    let row = |(row, (minorants, means)): (usize, (&mut [f32], &mut [f32]))| {
        let rows = blocks[1] + 2;
        let [y, z] = [row as u32 % rows, row as u32 / rows].map(|i| i.wrapping_sub(1));
        if y >= blocks[1] || z >= blocks[2] {
            return Ok(());
        }
        let mut samples = Vec::new();
        for x in 0..blocks[0] {
            let first = [x, y, z].map(|b| b * edge);
            let size: [u32; 3] = std::array::from_fn(|a| (edge + 1).min(dims[a] - first[a]));
            if !bricks.samples_of(first, size, &mut samples) {
                continue;
            }
            let [mut smallest, mut mean] = [[0.0; 9]; 2];
            fill_control_slab(&samples, size, edge, 1, [&mut smallest, &mut mean])
                .map_err(|e| placed(e, first))?;
            let at = x as usize + 1;
            if let (Some(entry), Some(other)) = (minorants.get_mut(at), means.get_mut(at)) {
                (*entry, *other) = (smallest[4], mean[4]);
            }
        }
        Ok(())
    };
    #[cfg(feature = "rayon")]
    {
        use rayon::prelude::*;
        let rows = minorants.par_chunks_exact_mut(across);
        let rows = rows.zip(means.par_chunks_exact_mut(across)).enumerate();
        rows.map(row).collect::<Result<(), _>>()?;
    }
    #[cfg(not(feature = "rayon"))]
    {
        let rows = minorants.chunks_exact_mut(across);
        for piece in rows.zip(means.chunks_exact_mut(across)).enumerate() {
            row(piece)?;
        }
    }
    Ok([minorants, means])
}

impl BrickTables {
    /// The samples of a box, x fastest; nothing where all of its bricks are empty.
    ///
    /// * `first`: its first sample. `size`: samples along x, y, z, within the grid. `found`: overwritten.
    ///
    /// Returns whether a brick of it holds matter.
    pub(super) fn samples_of(&self, first: [u32; 3], size: [u32; 3], found: &mut Vec<f32>) -> bool {
        let bricks: [_; 3] = std::array::from_fn(|a| {
            let last = first[a] + size[a].saturating_sub(1);
            first[a] / BRICK..=last / BRICK
        });
        let [xs, ys, zs] = bricks;
        let mut rows = zs.clone().flat_map(|z| ys.clone().map(move |y| (y, z)));
        let matter = rows.any(|(y, z)| xs.clone().any(|x| self.place([x, y, z]) != 0));
        found.clear();
        if !matter {
            return false;
        }
        for z in first[2]..first[2] + size[2] {
            for y in first[1]..first[1] + size[1] {
                let (mut x, end) = (first[0], first[0] + size[0]);
                while x < end {
                    let next = ((x / BRICK + 1) * BRICK).min(end);
                    let from = self.index([x, y, z]) as usize;
                    self.append_to(found, from..from + (next - x) as usize);
                    x = next;
                }
            }
        }
        true
    }
}
