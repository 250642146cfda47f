//! Majorant grid: a certified bound for each block of 8³ voxel cells.
//!
//! The medium between samples is their trilinear interpolant, which is bounded by the samples
//! around it. So the bound of a block is the largest of the 9³ samples that its cells touch: the
//! block's footprint, not only its own samples. It is rounded up by 2⁻²⁰, more than interpolation
//! in `f32` can overshoot. A rim of empty blocks surrounds the grid, where a walk may end up by
//! rounding at the very edge.

use core::fmt;

use crate::real::Real;

/// Edge of a majorant block, in voxel cells.
pub const BLOCK: u32 = 8;

/// Blocks along an axis of `samples` samples, without the rim.
#[inline]
pub(crate) const fn blocks(samples: u32) -> u32 {
    samples.saturating_sub(1).div_ceil(BLOCK)
}

/// How many bounds a grid of these dimensions needs: the length of [`fill_majorants`]' output.
///
/// `None` where the number does not fit.
pub const fn majorant_count(dims: [u32; 3]) -> Option<usize> {
    let x = blocks(dims[0]) as u64 + 2;
    let y = blocks(dims[1]) as u64 + 2;
    let z = blocks(dims[2]) as u64 + 2;
    match (x * y).checked_mul(z) {
        Some(count) if count <= i32::MAX as u64 => Some(count as usize),
        _ => None,
    }
}

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
    /// A sample is negative, infinite or NaN.
    Sample {
        /// Its indices along x, y and z.
        at: [u32; 3],
        /// Its value.
        value: f32,
    },
    /// A bound is smaller than a sample in its footprint.
    Bound {
        /// The sample's indices along x, y and z.
        at: [u32; 3],
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
                "the sample at ({x}, {y}, {z}) is {value}: extinction is finite and not negative"
            ),
            Self::Bound { at: [x, y, z] } => write!(
                f,
                "the majorant around the sample at ({x}, {y}, {z}) is smaller than that sample"
            ),
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
}

fn check_dims(samples: &[f32], dims: [u32; 3]) -> Result<(), MajorantError> {
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

/// The range of blocks, rim included, whose footprint has sample `i` of an axis of `samples` samples.
#[inline]
fn owners(i: u32, samples: u32) -> core::ops::RangeInclusive<usize> {
    let last = (i / BLOCK).min(blocks(samples) - 1);
    let first = if i > 0 && i.is_multiple_of(BLOCK) {
        i / BLOCK - 1
    } else {
        last
    };
    first as usize + 1..=last as usize + 1
}

/// Visits each sample with the indices of all bounds that must cover it.
fn for_each_owner(
    samples: &[f32],
    dims: [u32; 3],
    mut visit: impl FnMut([u32; 3], f32, usize) -> Result<(), MajorantError>,
) -> Result<(), MajorantError> {
    let [nx, ny, _] = dims;
    let (bx, by) = (blocks(nx) as usize + 2, blocks(ny) as usize + 2);
    for (row, values) in samples.chunks_exact(nx as usize).enumerate() {
        let (y, z) = (
            (row as u64 % u64::from(ny)) as u32,
            (row as u64 / u64::from(ny)) as u32,
        );
        for (x, &value) in values.iter().enumerate() {
            let x = x as u32;
            for oz in owners(z, dims[2]) {
                for oy in owners(y, ny) {
                    for ox in owners(x, nx) {
                        visit([x, y, z], value, (oz * by + oy) * bx + ox)?;
                    }
                }
            }
        }
    }
    Ok(())
}

/// Computes the bounds of a grid of samples.
///
/// * `samples`: finite and not negative, x fastest. `dims`: samples along x, y, z, at least two each.
/// * `majorants`: [`majorant_count`] values, overwritten.
///
/// # Errors
/// Wrong dimensions or lengths, or the first sample that no extinction can have.
pub fn fill_majorants(
    samples: &[f32],
    dims: [u32; 3],
    majorants: &mut [f32],
) -> Result<(), MajorantError> {
    check_dims(samples, dims)?;
    let expected = majorant_count(dims).ok_or(MajorantError::Dimensions(dims))?;
    if majorants.len() != expected {
        return Err(MajorantError::Length {
            expected,
            found: majorants.len(),
        });
    }
    majorants.fill(0.0);
    for_each_owner(samples, dims, |at, value, owner| {
        if !(value >= 0.0 && value.is_finite()) {
            return Err(MajorantError::Sample { at, value });
        }
        if let Some(bound) = majorants.get_mut(owner) {
            *bound = bound.max(value);
        }
        Ok(())
    })?;
    for bound in majorants {
        *bound = (*bound * (1.0 + 1.0 / 1_048_576.0)).min(f32::MAX);
    }
    Ok(())
}

impl<'a> MajorantGrid<'a> {
    /// Proves that every bound covers every sample of its footprint, and keeps both.
    ///
    /// # Errors
    /// As [`fill_majorants`], and the first sample above its bound.
    pub fn new(
        samples: &'a [f32],
        dims: [u32; 3],
        majorants: &'a [f32],
    ) -> Result<Self, MajorantError> {
        check_dims(samples, dims)?;
        let expected = majorant_count(dims).ok_or(MajorantError::Dimensions(dims))?;
        if majorants.len() != expected {
            return Err(MajorantError::Length {
                expected,
                found: majorants.len(),
            });
        }
        for_each_owner(samples, dims, |at, value, owner| {
            if !(value >= 0.0 && value.is_finite()) {
                return Err(MajorantError::Sample { at, value });
            }
            match majorants.get(owner) {
                Some(&bound) if bound >= value => Ok(()),
                _ => Err(MajorantError::Bound { at }),
            }
        })?;
        Ok(Self {
            samples,
            majorants,
            dims,
        })
    }

    /// Samples, and bounds, from one row and from one slice to the next, for grids of `dims` samples.
    #[inline]
    pub(crate) fn strides(dims: [u32; 3]) -> [[u32; 2]; 2] {
        let [nx, ny, _] = dims;
        let (bx, by) = (blocks(nx) + 2, blocks(ny) + 2);
        [[nx, nx.wrapping_mul(ny)], [bx, bx.wrapping_mul(by)]]
    }

    /// Samples along x, y and z.
    pub fn dims(&self) -> [u32; 3] {
        self.dims
    }

    /// The far corner of the domain, in grid units; the near one is the origin.
    #[inline]
    pub fn size<R: Real>(&self) -> crate::vec3::Vec3<R> {
        let last = |n: u32| (n - 1) as f32;
        crate::vec3::Vec3::splat(self.dims.map(last))
    }
}
