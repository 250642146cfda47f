//! Blocks of cells and the samples that their cells touch.

use crate::majorant::{BLOCK, MajorantError};

/// Blocks of an edge along each axis of a grid of `dims` samples, without the rim.
///
/// * `edge`: in voxel cells, not zero.
#[inline]
pub const fn block_counts(dims: [u32; 3], edge: u32) -> [u32; 3] {
    let [x, y, z] = dims;
    [blocks(x, edge), blocks(y, edge), blocks(z, edge)]
}

/// Blocks along an axis of `samples` samples, without the rim.
#[inline]
pub(crate) const fn blocks(samples: u32, edge: u32) -> u32 {
    // No grid has blocks of nothing; total, as walks begin with it.
    let edge = if edge == 0 { 1 } else { edge };
    samples.saturating_sub(1).div_ceil(edge)
}

/// Entries along each axis of a table over so many blocks, rim included.
pub(super) fn table_size(blocks: [u32; 3]) -> Result<[u32; 3], MajorantError> {
    if blocks.iter().all(|n| *n < 1 << 23) {
        Ok(blocks.map(|n| n + 2))
    } else {
        Err(MajorantError::Dimensions(blocks))
    }
}

/// How many bounds a grid of these dimensions needs: the length of what
/// [`fill_majorants`](crate::majorant::fill_majorants) fills.
///
/// `None` where the number does not fit.
pub const fn majorant_count(dims: [u32; 3]) -> Option<usize> {
    majorant_count_of(dims, BLOCK)
}

/// As [`majorant_count`], for blocks of another edge.
pub const fn majorant_count_of(dims: [u32; 3], edge: u32) -> Option<usize> {
    let [x, y, z] = block_counts(dims, edge);
    let (x, y, z) = (x as u64 + 2, y as u64 + 2, z as u64 + 2);
    match (x * y).checked_mul(z) {
        Some(count) if count <= i32::MAX as u64 => Some(count as usize),
        _ => None,
    }
}

pub(super) fn check_dims(samples: &[f32], dims: [u32; 3]) -> Result<(), MajorantError> {
    let count = dims
        .iter()
        .try_fold(1_u64, |n, &d| n.checked_mul(u64::from(d)))
        .filter(|&n| n <= i32::MAX as u64 && dims.iter().all(|&d| (2..=1 << 23).contains(&d)))
        .ok_or(MajorantError::Dimensions(dims))?;
    if samples.len() as u64 != count {
        return Err(MajorantError::Length {
            expected: count as usize,
            found: samples.len(),
        });
    }
    Ok(())
}

/// Checks the length of a table that has one entry for each block, rim included.
pub(super) fn check_table(table: &[f32], dims: [u32; 3], edge: u32) -> Result<(), MajorantError> {
    let expected = majorant_count_of(dims, edge).ok_or(MajorantError::Dimensions(dims))?;
    if table.len() == expected {
        Ok(())
    } else {
        Err(MajorantError::Length {
            expected,
            found: table.len(),
        })
    }
}

/// Visits every entry of a table over blocks, in its order: the block without the rim, none in the rim.
pub(crate) fn for_each_entry<E>(
    blocks: [u32; 3],
    mut visit: impl FnMut(usize, Option<[u32; 3]>) -> Result<(), E>,
) -> Result<(), E> {
    let [nx, ny, nz] = blocks;
    let mut index = 0;
    for z in 0..=nz + 1 {
        for y in 0..=ny + 1 {
            for x in 0..=nx + 1 {
                let block = [x.wrapping_sub(1), y.wrapping_sub(1), z.wrapping_sub(1)];
                let inner = block[0] < nx && block[1] < ny && block[2] < nz;
                visit(index, inner.then_some(block))?;
                index += 1;
            }
        }
    }
    Ok(())
}

/// The samples of a block's footprint, row by row, each with the indices of its first.
#[inline]
pub(super) fn rows(
    samples: &[f32],
    dims: [u32; 3],
    edge: u32,
    block: [u32; 3],
) -> impl Iterator<Item = ([u32; 3], &[f32])> {
    let [nx, ny, _] = dims.map(|n| n as usize);
    let first = block.map(|b| b * edge);
    let last = [0, 1, 2].map(|a| (first[a] + edge).min(dims[a] - 1));
    (first[2]..=last[2]).flat_map(move |z| {
        (first[1]..=last[1]).map(move |y| {
            let row = (z as usize * ny + y as usize) * nx;
            let range = row + first[0] as usize..=row + last[0] as usize;
            ([first[0], y, z], samples.get(range).unwrap_or_default())
        })
    })
}

/// The first sample of a block's footprint for which `wrong` holds.
pub(super) fn find(
    samples: &[f32],
    dims: [u32; 3],
    edge: u32,
    block: [u32; 3],
    wrong: impl Fn(f32) -> bool,
) -> Option<([u32; 3], f32)> {
    rows(samples, dims, edge, block).find_map(|([x, y, z], row)| {
        let mut values = (x..).zip(row);
        values.find_map(|(x, &value)| wrong(value).then_some(([x, y, z], value)))
    })
}
