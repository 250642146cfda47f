//! Majorant grid: a certified bound for each block of voxel cells, 8³ or another number of them.
//!
//! The medium between samples is their trilinear interpolant, which is bounded by the samples
//! around it. So the bound of a block is the largest of the 9³ samples that its cells touch: the
//! block's footprint, not only its own samples. It is raised by 2⁻²⁰ of itself, more than interpolation
//! in `f32` can overshoot (`rounding.rs` says by how much). A rim of empty blocks surrounds the grid,
//! where a walk may end up by rounding at the very edge.

use core::fmt;

use crate::majorant::footprint::{
    block_counts, check_dims, check_table, find, for_each_entry, rows,
};
use crate::majorant::{leaps, rounding};
use crate::real::Real;

/// Edge of a majorant block, in voxel cells, where none is chosen.
pub const BLOCK: u32 = 8;

/// Edges that blocks can have, in voxel cells.
pub const EDGES: [u32; 5] = [4, 8, 16, 32, 64];

/// What can be wrong with a grid of samples.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum MajorantError {
    /// An axis has fewer than two samples, or the grid more than 2³¹.
    Dimensions([u32; 3]),
    /// A slice has another length than the dimensions ask for.
    Length {
        /// The length it needs.
        expected: usize,
        /// The length it has.
        found: usize,
    },
    /// A sample is negative, NaN, or beyond 3.4e38.
    Sample {
        /// Its indices along x, y and z.
        at: [u32; 3],
        /// Its value.
        value: f32,
    },
    /// A bound is infinite, or what is interpolated from a sample of its footprint can exceed it.
    Bound {
        /// The sample's indices along x, y and z.
        at: [u32; 3],
    },
    /// A minorant is negative, or what is interpolated from a sample of its footprint can fall below it.
    Minorant {
        /// The sample's indices along x, y and z.
        at: [u32; 3],
    },
    /// A mean lies outside its block's bounds.
    Mean {
        /// The block's indices along x, y and z, without the rim.
        block: [u32; 3],
    },
    /// An entry of the rim is not zero.
    Rim {
        /// Its place in its table.
        index: usize,
    },
    /// An edge that blocks cannot have.
    Edge(u32),
    /// An entry below zero is no leap, or leaps over matter.
    Leap {
        /// Its place in its table.
        index: usize,
    },
}

impl fmt::Display for MajorantError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Dimensions([x, y, z]) => write!(
                f,
                "a grid of {x} x {y} x {z} samples: each axis needs at least two, all together at most 2^31"
            ),
            Self::Length { expected, found } => {
                write!(f, "a slice of {found} values where {expected} are needed")
            }
            Self::Sample {
                at: [x, y, z],
                value,
            } => write!(
                f,
                "the sample at ({x}, {y}, {z}) is {value}: extinction is from 0 to 3.4e38"
            ),
            Self::Bound { at: [x, y, z] } => write!(
                f,
                "the majorant around the sample at ({x}, {y}, {z}) does not bound what is interpolated from it"
            ),
            Self::Minorant { at: [x, y, z] } => write!(
                f,
                "the minorant around the sample at ({x}, {y}, {z}) does not bound what is interpolated from it"
            ),
            Self::Mean { block: [x, y, z] } => write!(
                f,
                "the mean of the block ({x}, {y}, {z}) lies outside the block's bounds"
            ),
            Self::Rim { index } => write!(f, "entry {index} lies in the rim and is not zero"),
            Self::Edge(edge) => write!(f, "blocks of {edge} cells: an edge is one of {EDGES:?}"),
            Self::Leap { index } => {
                write!(
                    f,
                    "entry {index} is below zero and not a leap over empty blocks"
                )
            }
        }
    }
}

impl core::error::Error for MajorantError {}

/// Borrowed bounds of a borrowed grid of samples, proved against each other on construction.
///
/// Samples lie at the integers, x fastest; the domain is [0, n − 1] along each axis.
#[derive(Clone, Copy, Debug)]
pub struct MajorantGrid<'a> {
    pub(crate) samples: &'a [f32],
    pub(crate) majorants: &'a [f32],
    pub(crate) dims: [u32; 3],
    pub(crate) edge: u32,
}

/// Nothing is in the rim.
pub(super) fn check_rim(index: usize, entry: f32) -> Result<(), MajorantError> {
    if entry == 0.0 {
        Ok(())
    } else {
        Err(MajorantError::Rim { index })
    }
}

/// A sample that extinction can have.
pub(super) fn is_valid(sample: f32) -> bool {
    (0.0..=rounding::LARGEST).contains(&sample)
}

/// The first sample of a footprint that extinction cannot have.
pub(super) fn invalid_sample(
    samples: &[f32],
    dims: [u32; 3],
    edge: u32,
    block: [u32; 3],
) -> MajorantError {
    let invalid = find(samples, dims, edge, block, |sample| !is_valid(sample));
    let (at, value) = invalid.unwrap_or((block.map(|b| b * edge), f32::NAN));
    MajorantError::Sample { at, value }
}

/// Computes the bounds of a grid of samples.
///
/// * `samples`: from 0 to 3.4e38, x fastest. `dims`: samples along x, y, z, at least two each.
/// * `majorants`: [`majorant_count`](crate::majorant::majorant_count) values, overwritten.
///
/// # Errors
/// Wrong dimensions or lengths, or a sample that no extinction can have.
pub fn fill_majorants(
    samples: &[f32],
    dims: [u32; 3],
    majorants: &mut [f32],
) -> Result<(), MajorantError> {
    check_dims(samples, dims)?;
    check_table(majorants, dims, BLOCK)?;
    let [x, y, _] = block_counts(dims, BLOCK).map(|n| n as usize + 2);
    for (slab, entries) in majorants.chunks_exact_mut(x * y).enumerate() {
        fill_slab(samples, dims, BLOCK, slab, entries)?;
    }
    Ok(())
}

/// Computes one slab of a table of bounds, so that slabs may be computed side by side.
///
/// * `samples`, `dims`: as for [`fill_majorants`]. `edge`: of the blocks, one of [`EDGES`].
/// * `slab`: which, along z, the first and the last one being the rim.
/// * `entries`: (x + 2)(y + 2) of them for x × y blocks, overwritten.
///
/// # Errors
/// As [`fill_majorants`], and an edge that blocks cannot have.
pub fn fill_slab(
    samples: &[f32],
    dims: [u32; 3],
    edge: u32,
    slab: usize,
    entries: &mut [f32],
) -> Result<(), MajorantError> {
    check_dims(samples, dims)?;
    check_edge(edge)?;
    let [nx, ny, nz] = block_counts(dims, edge);
    let [across, down] = [nx, ny].map(|n| n as usize + 2);
    if entries.len() != across * down {
        return Err(MajorantError::Length {
            expected: across * down,
            found: entries.len(),
        });
    }
    let z = (slab as u32).wrapping_sub(1);
    for (y, row) in entries.chunks_exact_mut(across).enumerate() {
        let y = (y as u32).wrapping_sub(1);
        for (x, entry) in row.iter_mut().enumerate() {
            let block = [(x as u32).wrapping_sub(1), y, z];
            let inner = block[0] < nx && y < ny && z < nz;
            *entry = if inner {
                rounding::majorant(largest(samples, dims, edge, block)?)
            } else {
                0.0
            };
        }
    }
    Ok(())
}

/// An edge that blocks can have.
pub(super) fn check_edge(edge: u32) -> Result<(), MajorantError> {
    if EDGES.contains(&edge) {
        Ok(())
    } else {
        Err(MajorantError::Edge(edge))
    }
}

/// The largest sample of a footprint, all of which are looked at.
fn largest(
    samples: &[f32],
    dims: [u32; 3],
    edge: u32,
    block: [u32; 3],
) -> Result<f32, MajorantError> {
    let (mut largest, mut valid) = (0.0_f32, true);
    rows(samples, dims, edge, block).for_each(|(_, row)| {
        for &sample in row {
            valid &= is_valid(sample);
            largest = largest.max(sample);
        }
    });
    if valid {
        return Ok(largest);
    }
    Err(invalid_sample(samples, dims, edge, block))
}

impl<'a> MajorantGrid<'a> {
    /// Proves that no look-up within a block exceeds its bound, one tap or interpolated, rounding
    /// included, and keeps samples and bounds.
    ///
    /// A bound must exceed the largest sample of its footprint by the factor 1 + 2⁻²¹ and three of the
    /// smallest floats, as interpolation by single precision can; those of [`fill_majorants`] do. Bounds
    /// of the rim are zero. [Leaps](crate::majorant::fill_leaps) stand for bounds of zero and are proved, too.
    ///
    /// # Errors
    /// As [`fill_majorants`], and a sample whose bound fails, or a leap over matter.
    pub fn new(
        samples: &'a [f32],
        dims: [u32; 3],
        majorants: &'a [f32],
    ) -> Result<Self, MajorantError> {
        Self::with_edge(samples, dims, BLOCK, majorants)
    }

    /// As [`new`](Self::new), for blocks of another edge, one of [`EDGES`].
    ///
    /// # Errors
    /// As [`new`](Self::new), and an edge that blocks cannot have.
    pub fn with_edge(
        samples: &'a [f32],
        dims: [u32; 3],
        edge: u32,
        majorants: &'a [f32],
    ) -> Result<Self, MajorantError> {
        check_dims(samples, dims)?;
        check_edge(edge)?;
        check_table(majorants, dims, edge)?;
        for_each_entry(block_counts(dims, edge), |index, block| {
            let bound = majorants.get(index).copied().unwrap_or(f32::NAN);
            let covers = |sample| {
                bound.is_finite() && rounding::highest(sample) <= f64::from(bound.max(0.0))
            };
            let Some(block) = block else {
                return check_rim(index, if bound < 0.0 { 0.0 } else { bound });
            };
            if covers(largest(samples, dims, edge, block)?) {
                return Ok(());
            }
            let above = find(samples, dims, edge, block, |sample| !covers(sample));
            let (at, _) = above.unwrap_or((block.map(|b| b * edge), f32::NAN));
            Err(MajorantError::Bound { at })
        })?;
        leaps::prove(majorants, block_counts(dims, edge))?;
        Ok(Self {
            samples,
            majorants,
            dims,
            edge,
        })
    }

    /// Samples, and bounds, from one row and from one slice to the next, for grids of `dims` samples and blocks of
    /// `edge` cells.
    #[inline]
    pub(crate) fn strides(dims: [u32; 3], edge: u32) -> [[u32; 2]; 2] {
        let [nx, ny, _] = dims;
        let [bx, by, _] = block_counts(dims, edge).map(|n| n + 2);
        [[nx, nx.wrapping_mul(ny)], [bx, bx.wrapping_mul(by)]]
    }

    /// Samples along x, y and z.
    pub fn dims(&self) -> [u32; 3] {
        self.dims
    }

    /// Edge of a block, in voxel cells.
    pub fn edge(&self) -> u32 {
        self.edge
    }

    /// The far corner of the domain, in grid units; the near one is the origin.
    #[inline]
    pub fn size<R: Real>(&self) -> crate::vec3::Vec3<R> {
        let last = |n: u32| (n - 1) as f32;
        crate::vec3::Vec3::splat(self.dims.map(last))
    }
}
