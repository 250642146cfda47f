//! The bounds of a grid: blocks of the size that the cost model likes best, with leaps over what is empty.

use woodcock_core::majorant::{
    EDGES, MajorantError, WalkCost, block_counts, coarsen, fill_control_slab, fill_leaps,
    fill_slab, majorant_count_of, walk_cost,
};

/// Bounds on a grid's samples.
#[derive(Clone, Debug)]
pub(super) struct Bounds {
    /// Edge of a block \[voxels\].
    pub(super) edge: u32,
    /// One for each block, with a rim and with leaps.
    pub(super) majorants: Vec<f32>,
}

/// Bounds in blocks of one edge.
struct Level {
    edge: u32,
    majorants: Vec<f32>,
    cost: WalkCost,
}

impl Bounds {
    /// The bounds of a grid of samples, in blocks of the edge that makes the least work; on all threads.
    ///
    /// * `depth`: extinction of a sample of one times the edge of a voxel.
    ///
    /// # Errors
    /// A sample that no extinction can have, or too many.
    pub(super) fn new(samples: &[f32], dims: [u32; 3], depth: f64) -> Result<Self, MajorantError> {
        let finest = finest(samples, dims)?;
        Self::of_finest(finest, dims, depth)
    }

    /// As [`new`](Self::new), from the bounds of the smallest blocks.
    pub(super) fn of_finest(
        finest: Vec<f32>,
        dims: [u32; 3],
        depth: f64,
    ) -> Result<Self, MajorantError> {
        let mut tables = vec![finest];
        for pair in EDGES.windows(2) {
            let (Some(fine), &[edge, double]) = (tables.last(), pair) else {
                break;
            };
            let blocks = block_counts(dims, edge);
            if blocks == [1; 3] {
                break;
            }
            let mut coarse = empty_table(dims, double)?;
            coarsen(fine, blocks, &mut coarse)?;
            tables.push(coarse);
        }
        let levels = zip_all(tables, |level, mut majorants| {
            let edge = EDGES[level];
            let blocks = block_counts(dims, edge);
            fill_leaps(&mut majorants, blocks)?;
            let cost = walk_cost(&majorants, dims, edge, depth)?;
            Ok(Level {
                edge,
                majorants,
                cost,
            })
        })?;
        let cheapest = levels
            .into_iter()
            .min_by(|a, b| a.cost.total().total_cmp(&b.cost.total()));
        let Level {
            edge, majorants, ..
        } = cheapest.ok_or(MajorantError::Dimensions(dims))?;
        Ok(Self { edge, majorants })
    }
}

/// A table of zeros for blocks of an edge.
pub(super) fn empty_table(dims: [u32; 3], edge: u32) -> Result<Vec<f32>, MajorantError> {
    let count = majorant_count_of(dims, edge).ok_or(MajorantError::Dimensions(dims))?;
    Ok(vec![0.0; count])
}

/// The bounds of the smallest blocks, slab by slab.
fn finest(samples: &[f32], dims: [u32; 3]) -> Result<Vec<f32>, MajorantError> {
    let edge = EDGES[0];
    let mut majorants = empty_table(dims, edge)?;
    let [x, y, _] = block_counts(dims, edge).map(|n| n as usize + 2);
    let fill = |(slab, entries): (usize, &mut [f32])| fill_slab(samples, dims, edge, slab, entries);
    #[cfg(feature = "rayon")]
    {
        use rayon::prelude::*;
        let slabs = majorants.par_chunks_exact_mut(x * y).enumerate();
        slabs.map(fill).collect::<Result<(), _>>()?;
    }
    #[cfg(not(feature = "rayon"))]
    for slab in majorants.chunks_exact_mut(x * y).enumerate() {
        fill(slab)?;
    }
    Ok(majorants)
}

/// Minorants and means of blocks of an edge, slab by slab on all threads.
///
/// # Errors
/// A sample that no extinction can have.
pub(super) fn controls(
    samples: &[f32],
    dims: [u32; 3],
    edge: u32,
) -> Result<[Vec<f32>; 2], MajorantError> {
    let (mut minorants, mut means) = (empty_table(dims, edge)?, empty_table(dims, edge)?);
    let [x, y, _] = block_counts(dims, edge).map(|n| n as usize + 2);
    let fill = |(slab, (minorants, means)): (usize, (&mut [f32], &mut [f32]))| {
        fill_control_slab(samples, dims, edge, slab, [minorants, means])
    };
    #[cfg(feature = "rayon")]
    {
        use rayon::prelude::*;
        let slabs = minorants.par_chunks_exact_mut(x * y);
        let slabs = slabs.zip(means.par_chunks_exact_mut(x * y)).enumerate();
        slabs.map(fill).collect::<Result<(), _>>()?;
    }
    #[cfg(not(feature = "rayon"))]
    {
        let slabs = minorants.chunks_exact_mut(x * y);
        for slab in slabs.zip(means.chunks_exact_mut(x * y)).enumerate() {
            fill(slab)?;
        }
    }
    Ok([minorants, means])
}

/// What a function makes of each table and its number, in their order.
fn zip_all<T: Send>(
    tables: Vec<Vec<f32>>,
    make: impl Fn(usize, Vec<f32>) -> Result<T, MajorantError> + Send + Sync,
) -> Result<Vec<T>, MajorantError> {
    #[cfg(feature = "rayon")]
    {
        use rayon::prelude::*;
        let tables = tables.into_par_iter().enumerate();
        tables.map(|(level, table)| make(level, table)).collect()
    }
    #[cfg(not(feature = "rayon"))]
    {
        let tables = tables.into_iter().enumerate();
        tables.map(|(level, table)| make(level, table)).collect()
    }
}
