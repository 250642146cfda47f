//! Controls: what the extinction of a block is at least, and on average.
//!
//! Trackers that split the extinction into a part known in closed form and a rest need one number for
//! each block beside its bound: the smallest value that its interpolant takes, so that the rest is
//! not negative, or the mean, so that the rest is small ([Novák, Selle, Jarosz 2014], [Kutz 2017]).
//! Both are laid out as the bounds are, so the index of a walk serves all three, and both are zero in
//! the rim.

use crate::majorant::footprint::{
    block_counts, check_dims, check_table, find, for_each_entry, rows,
};
use crate::majorant::grid::{check_edge, check_rim, invalid_sample, is_valid};
use crate::majorant::{BLOCK, MajorantError, MajorantGrid, rounding};

/// Computes the controls of a grid of samples.
///
/// ```text
/// minorant = (1 − 2⁻²⁰) min over the footprint,   mean = (1/V) ∫ over the block of the interpolant
/// ```
///
/// The interpolant's mean over a cell is the mean of its eight corners; over a block of cells that is
/// the trapezium rule, which is summed in `f64` and lies between the footprint's extremes.
///
/// * `samples`, `dims`: as for [`fill_majorants`](crate::majorant::fill_majorants).
/// * `minorants`, `means`: [`majorant_count`](crate::majorant::majorant_count) values each, overwritten.
///
/// # Errors
/// Wrong dimensions or lengths, or a sample that no extinction can have.
pub fn fill_controls(
    samples: &[f32],
    dims: [u32; 3],
    minorants: &mut [f32],
    means: &mut [f32],
) -> Result<(), MajorantError> {
    check_table(minorants, dims, BLOCK)?;
    check_table(means, dims, BLOCK)?;
    let [x, y, _] = block_counts(dims, BLOCK).map(|n| n as usize + 2);
    let slabs = minorants.chunks_exact_mut(x * y);
    for (slab, (minorants, means)) in slabs.zip(means.chunks_exact_mut(x * y)).enumerate() {
        fill_control_slab(samples, dims, BLOCK, slab, [minorants, means])?;
    }
    Ok(())
}

/// Computes one slab of the tables of controls, so that slabs may be computed side by side.
///
/// * `edge`, `slab`: as for [`fill_slab`](crate::majorant::fill_slab).
/// * `entries`: of the minorants and of the means.
///
/// # Errors
/// As [`fill_controls`], and an edge that blocks cannot have.
pub fn fill_control_slab(
    samples: &[f32],
    dims: [u32; 3],
    edge: u32,
    slab: usize,
    [minorants, means]: [&mut [f32]; 2],
) -> Result<(), MajorantError> {
    check_dims(samples, dims)?;
    check_edge(edge)?;
    let [nx, ny, nz] = block_counts(dims, edge);
    let across = nx as usize + 2;
    let expected = across * (ny as usize + 2);
    if let Some(found) = [minorants.len(), means.len()]
        .into_iter()
        .find(|n| *n != expected)
    {
        return Err(MajorantError::Length { expected, found });
    }
    let z = (slab as u32).wrapping_sub(1);
    for (index, (minorant, mean)) in minorants.iter_mut().zip(means).enumerate() {
        let [x, y] = [index % across, index / across].map(|i| (i as u32).wrapping_sub(1));
        let inner = x < nx && y < ny && z < nz;
        (*minorant, *mean) = if inner {
            let (smallest, mean) = smallest_and_mean(samples, dims, edge, [x, y, z])?;
            (rounding::minorant(smallest), mean)
        } else {
            (0.0, 0.0)
        };
    }
    Ok(())
}

fn smallest_and_mean(
    samples: &[f32],
    dims: [u32; 3],
    edge: u32,
    block: [u32; 3],
) -> Result<(f32, f32), MajorantError> {
    let first = block.map(|b| b * edge);
    let last = [0, 1, 2].map(|a| (first[a] + edge).min(dims[a] - 1));
    // The outermost planes of the block belong to one layer of its cells, the others to two.
    let weight = |axis: usize, i: u32| {
        let outer = i == first[axis] || i == last[axis];
        if outer { 0.5 } else { 1.0 }
    };
    let (mut smallest, mut valid, mut sum) = (f32::INFINITY, true, 0.0_f64);
    rows(samples, dims, edge, block).for_each(|([_, y, z], row)| {
        let mut of_row = 0.0_f64;
        for &sample in row {
            valid &= is_valid(sample);
            smallest = smallest.min(sample);
            of_row += f64::from(sample);
        }
        if let [near, .., far] = row {
            of_row -= 0.5 * (f64::from(*near) + f64::from(*far));
        }
        sum += of_row * (weight(1, y) * weight(2, z));
    });
    if valid {
        let cells = [0, 1, 2].map(|a| f64::from(last[a] - first[a]));
        return Ok((smallest, (sum / (cells[0] * cells[1] * cells[2])) as f32));
    }
    Err(invalid_sample(samples, dims, edge, block))
}

/// A majorant grid with controls, proved against its samples on construction.
#[derive(Clone, Copy, Debug)]
pub struct ControlledGrid<'a> {
    bounds: MajorantGrid<'a>,
    minorants: &'a [f32],
    means: &'a [f32],
}

impl<'a> MajorantGrid<'a> {
    /// Proves that no look-up within a block falls below its minorant, one tap or interpolated,
    /// rounding included, and that minorant ≤ mean ≤ bound; keeps all.
    ///
    /// A minorant is zero, or falls short of the smallest sample of its footprint by the factor
    /// 1 − 2⁻²¹ and three of the smallest floats; those of [`fill_controls`] do. That a mean *is* the
    /// mean is not asked: any number between serves as a control.
    ///
    /// # Errors
    /// Wrong lengths, or what fails and where.
    pub fn with_controls(
        self,
        minorants: &'a [f32],
        means: &'a [f32],
    ) -> Result<ControlledGrid<'a>, MajorantError> {
        let (samples, dims, edge) = (self.samples, self.dims, self.edge);
        check_table(minorants, dims, edge)?;
        check_table(means, dims, edge)?;
        let entry = |table: &[f32], index| table.get(index).copied().unwrap_or(f32::NAN);
        for_each_entry(block_counts(dims, edge), |index, block| {
            let (minorant, mean) = (entry(minorants, index), entry(means, index));
            let Some(block) = block else {
                check_rim(index, minorant)?;
                return check_rim(index, mean);
            };
            // NaN fails as well, and −0 is zero.
            let below = |sample| (0.0..=rounding::lowest(sample)).contains(&f64::from(minorant));
            if let Some((at, _)) = find(samples, dims, edge, block, |sample| !below(sample)) {
                return Err(MajorantError::Minorant { at });
            }
            // A leap stands for a bound of zero.
            if (minorant..=entry(self.majorants, index).max(0.0)).contains(&mean) {
                Ok(())
            } else {
                Err(MajorantError::Mean { block })
            }
        })?;
        Ok(ControlledGrid {
            bounds: self,
            minorants,
            means,
        })
    }
}

impl<'a> ControlledGrid<'a> {
    /// The samples with their bounds.
    #[inline]
    pub fn bounds(&self) -> MajorantGrid<'a> {
        self.bounds
    }
    /// The smallest value of each block, in the layout of the bounds.
    #[inline]
    pub fn minorants(&self) -> &'a [f32] {
        self.minorants
    }
    /// The mean of each block, in the layout of the bounds.
    #[inline]
    pub fn means(&self) -> &'a [f32] {
        self.means
    }
}

/// A grid without controls: no table, which reads as zeros.
impl<'a> From<MajorantGrid<'a>> for ControlledGrid<'a> {
    fn from(bounds: MajorantGrid<'a>) -> Self {
        Self {
            bounds,
            minorants: &[],
            means: &[],
        }
    }
}
