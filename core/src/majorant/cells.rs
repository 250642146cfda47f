//! A box cut into cells, each with a bound that interval arithmetic proves.
//!
//! Extinction that is a formula has no samples to take the largest of. Its *interval extension*, the
//! same formula over [`Enclosure`]s, gives for the box of a cell an upper bound on all values that the
//! formula takes there, rounding included. The walk is that of the majorant grids: a cell is eight grid
//! units wide, as a block is, so that [`GridWalk`](crate::majorant::GridWalk) serves both, and bounds
//! have the same layout, with a rim of zeros.
//!
//! A place in grid units g, kept within its cell by the walk, stands for the place
//!
//! ```text
//! p = low ⊕ g ⊗ s,   s = (high − low) / (8 · cells),   8 i ≤ g ≤ 8 (i + 1)
//! ```
//!
//! Evaluated over enclosures the same expression gives the box of the cell: every p that a look-up can
//! meet lies in it, however the coordinates were rounded.

use core::fmt;

use crate::enclosure::Enclosure;
use crate::majorant::footprint::for_each_entry;
use crate::majorant::{BLOCK, GridLayout, majorant_count};
use crate::ray::{Interval, Ray, clip_to_box};
use crate::real::Real;
use crate::vec3::Vec3;

/// What can be wrong with cells or their bounds.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum CellError {
    /// The box has an axis without extent, or one that single precision cannot divide.
    Extent {
        /// Its lower corner.
        low: [f32; 3],
        /// Its upper corner.
        high: [f32; 3],
    },
    /// An axis has no cell or more than 2²⁰, or the box more than 2³¹.
    Counts([u32; 3]),
    /// A slice has another length than the cells ask for.
    Length {
        /// The length it needs.
        expected: usize,
        /// The length it has.
        found: usize,
    },
    /// The interval extension has no finite upper bound in a cell, or a negative one.
    Extension {
        /// The cell's indices along x, y and z.
        cell: [u32; 3],
        /// What it gave.
        value: Enclosure,
    },
    /// A bound is infinite, or smaller than that of the interval extension.
    Bound {
        /// The cell's indices along x, y and z.
        cell: [u32; 3],
    },
    /// An entry of the rim is not zero.
    Rim {
        /// Its place in the table.
        index: usize,
    },
}

impl fmt::Display for CellError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Extent { low, high } => {
                write!(
                    f,
                    "the box from {low:?} to {high:?} cannot be cut into cells"
                )
            }
            Self::Counts([x, y, z]) => write!(
                f,
                "{x} x {y} x {z} cells: each axis needs one to 2^20, all together at most 2^31"
            ),
            Self::Length { expected, found } => {
                write!(f, "a slice of {found} values where {expected} are needed")
            }
            Self::Extension {
                cell: [x, y, z],
                value,
            } => write!(
                f,
                "the extinction in the cell ({x}, {y}, {z}) lies between {:e} and {:e}: a bound is finite and not negative",
                value.low(),
                value.high()
            ),
            Self::Bound { cell: [x, y, z] } => write!(
                f,
                "the majorant of the cell ({x}, {y}, {z}) does not bound its extinction"
            ),
            Self::Rim { index } => write!(f, "entry {index} lies in the rim and is not zero"),
        }
    }
}

impl core::error::Error for CellError {}

/// An axis-parallel box cut into equal cells.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cells {
    low: [f32; 3],
    counts: [u32; 3],
    /// Grid units in a unit of length, and lengths of a grid unit.
    to_grid: [f32; 3],
    from_grid: [f32; 3],
}

impl Cells {
    /// * `low`, `high`: corners of the box \[length\]. `counts`: cells along x, y, z.
    ///
    /// # Errors
    /// A box without extent, or too few or too many cells.
    pub fn new(low: [f32; 3], high: [f32; 3], counts: [u32; 3]) -> Result<Self, CellError> {
        let sized = counts.iter().all(|n| (1..=1 << 20).contains(n));
        if !sized || majorant_count(samples(counts)).is_none() {
            return Err(CellError::Counts(counts));
        }
        let units = counts.map(|n| (n * BLOCK) as f32);
        let extent = [0, 1, 2].map(|a| high[a] - low[a]);
        let to_grid = [0, 1, 2].map(|a| units[a] / extent[a]);
        let from_grid = [0, 1, 2].map(|a| extent[a] / units[a]);
        let sound = |x: &f32| x.is_normal() && *x > 0.0;
        if !to_grid.iter().chain(&from_grid).all(sound) {
            return Err(CellError::Extent { low, high });
        }
        Ok(Self {
            low,
            counts,
            to_grid,
            from_grid,
        })
    }

    /// How many bounds the cells need, the rim included.
    pub fn majorant_count(&self) -> usize {
        majorant_count(samples(self.counts)).unwrap_or_default()
    }

    /// The box of a cell: all places that a look-up in it can meet.
    pub fn enclosure(&self, cell: [u32; 3]) -> [Enclosure; 3] {
        [0, 1, 2].map(|a| {
            let near = (cell[a] * BLOCK) as f32;
            let units = Enclosure::new(near, near + BLOCK as f32);
            units * self.from_grid[a] + self.low[a]
        })
    }

    /// Computes the bounds of all cells.
    ///
    /// * `extension`: bounds on the extinction in a box of places [1/length].
    /// * `majorants`: [`majorant_count`](Self::majorant_count) values, overwritten.
    ///
    /// # Errors
    /// A wrong length, or a cell whose extinction has no bound.
    pub fn fill_majorants(
        &self,
        extension: impl Fn([Enclosure; 3]) -> Enclosure,
        majorants: &mut [f32],
    ) -> Result<(), CellError> {
        self.check_length(majorants)?;
        for_each_entry(self.counts, |index, cell| {
            let bound = match cell {
                Some(cell) => self.bound(&extension, cell)?,
                None => 0.0,
            };
            if let Some(entry) = majorants.get_mut(index) {
                *entry = bound;
            }
            Ok(())
        })
    }

    /// Proves that every bound covers the interval extension in its cell.
    ///
    /// # Errors
    /// As [`fill_majorants`](Self::fill_majorants), and the first cell whose bound fails.
    pub fn prove(
        &self,
        extension: impl Fn([Enclosure; 3]) -> Enclosure,
        majorants: &[f32],
    ) -> Result<(), CellError> {
        self.check_length(majorants)?;
        for_each_entry(self.counts, |index, cell| {
            let found = majorants.get(index).copied().unwrap_or(f32::NAN);
            let Some(cell) = cell else {
                let empty = found == 0.0;
                return empty.then_some(()).ok_or(CellError::Rim { index });
            };
            let needed = self.bound(&extension, cell)?;
            let covered = needed <= found && found.is_finite();
            covered.then_some(()).ok_or(CellError::Bound { cell })
        })
    }

    fn check_length(&self, majorants: &[f32]) -> Result<(), CellError> {
        let (expected, found) = (self.majorant_count(), majorants.len());
        if found == expected {
            Ok(())
        } else {
            Err(CellError::Length { expected, found })
        }
    }

    /// The upper bound of the extension in a cell.
    fn bound(
        &self,
        extension: impl Fn([Enclosure; 3]) -> Enclosure,
        cell: [u32; 3],
    ) -> Result<f32, CellError> {
        let value = extension(self.enclosure(cell));
        let bound = value.high();
        if (0.0..=f32::MAX).contains(&bound) {
            Ok(bound)
        } else {
            Err(CellError::Extension { cell, value })
        }
    }

    /// What a walk needs to know: blocks of eight units, and no samples.
    #[inline(always)]
    pub(crate) fn layout<R: Real>(&self) -> GridLayout<R> {
        GridLayout::of_blocks(self.counts, 1.0)
    }

    /// The far corner in grid units; the near one is the origin.
    #[inline(always)]
    fn size<R: Real>(&self) -> Vec3<R> {
        Vec3::splat(self.counts.map(|n| (n * BLOCK) as f32))
    }

    /// A ray in grid units; t keeps its meaning.
    #[inline(always)]
    pub(crate) fn in_units<R: Real>(&self, ray: &Ray<R>) -> Ray<R> {
        let scale = Vec3::splat(self.to_grid);
        Ray {
            origin: (ray.origin - Vec3::splat(self.low)).times(scale),
            direction: ray.direction.times(scale),
        }
    }

    /// The place that stands for one in grid units.
    #[inline(always)]
    pub(crate) fn place<R: Real>(&self, units: Vec3<R>) -> Vec3<R> {
        units.times(Vec3::splat(self.from_grid)) + Vec3::splat(self.low)
    }

    /// The part of a ray within the box.
    #[inline(always)]
    pub fn clip<R: Real>(&self, ray: &Ray<R>) -> Interval<R> {
        let local = self.in_units(ray);
        clip_to_box(local.origin, local.direction, self.size())
    }
}

/// Samples of the grid whose blocks the cells are.
const fn samples(cells: [u32; 3]) -> [u32; 3] {
    let [x, y, z] = cells;
    [x * BLOCK + 1, y * BLOCK + 1, z * BLOCK + 1]
}
