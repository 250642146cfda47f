//! Extinction that is constant in each cell of a grid: its own bound, cell by cell.
//!
//! A walk from cell to cell finds collisions and optical depths exactly (*regular tracking*), at the
//! price of visiting every cell. The values lie in a table with a rim of empty cells around them,
//! where a walk may end up by rounding at the very edge; [`fill_voxels`] makes it.

use core::fmt;

use crate::majorant::{GridLayout, GridWalk, Segment, for_each_entry};
use crate::medium::{Affine, Control, Controlled, Medium, PiecewiseConstant, transform_ray};
use crate::ray::{Interval, Ray, clip_to_box};
use crate::real::Real;
use crate::stream::Stream;

/// How many values a table of this many cells has, rim included; `None` where the number does not fit.
pub const fn voxel_count(dims: [u32; 3]) -> Option<usize> {
    let [x, y, z] = dims;
    if x == 0 || y == 0 || z == 0 || x > LARGEST || y > LARGEST || z > LARGEST {
        return None;
    }
    let (x, y, z) = (x as u64 + 2, y as u64 + 2, z as u64 + 2);
    match (x * y).checked_mul(z) {
        Some(count) if count <= i32::MAX as u64 => Some(count as usize),
        _ => None,
    }
}

/// Voxels along an axis, so that eight units each stay exact.
const LARGEST: u32 = 1 << 20;

/// What can be wrong with a table of cells.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum VoxelsError {
    /// An axis without cells or with more than 2²⁰, or more than 2³¹ cells.
    Dimensions([u32; 3]),
    /// A slice of another length than the dimensions ask for.
    Length {
        /// The length it needs.
        expected: usize,
        /// The length it has.
        found: usize,
    },
    /// A value that is negative, infinite or NaN, or becomes so when scaled, or is not zero in the rim.
    Value {
        /// Its index in the table.
        at: usize,
        /// The value.
        value: f32,
    },
    /// A map or a scale that is not finite, or a negative scale.
    Placement,
}

impl fmt::Display for VoxelsError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Dimensions([x, y, z]) => write!(
                f,
                "{x} x {y} x {z} cells: each axis needs 1 to 2^20, all together at most 2^31"
            ),
            Self::Length { expected, found } => {
                write!(f, "a slice of {found} values where {expected} are needed")
            }
            Self::Value { at, value } => write!(
                f,
                "value number {at} is {value}: extinction is finite and not negative, scaled too, and the rim is zero"
            ),
            Self::Placement => write!(f, "map and scale are finite, the scale not negative"),
        }
    }
}

impl core::error::Error for VoxelsError {}

/// Copies the values of cells into a table with a rim.
///
/// * `values`: of the cells, x fastest. `table`: [`voxel_count`] values, overwritten.
///
/// # Errors
/// Dimensions or lengths that do not fit. The values themselves are judged by [`Voxels::new`].
pub fn fill_voxels(values: &[f32], dims: [u32; 3], table: &mut [f32]) -> Result<(), VoxelsError> {
    let expected = voxel_count(dims).ok_or(VoxelsError::Dimensions(dims))?;
    let [nx, ny, nz] = dims.map(|n| n as usize);
    let lengths = [(table.len(), expected), (values.len(), nx * ny * nz)];
    if let Some(&(found, expected)) = lengths.iter().find(|(found, expected)| found != expected) {
        return Err(VoxelsError::Length { expected, found });
    }
    let mut values = values.iter().copied();
    for_each_entry(dims, |at, cell| {
        let value = cell.and_then(|_| values.next()).unwrap_or(0.0);
        if let Some(entry) = table.get_mut(at) {
            *entry = value;
        }
        Ok(())
    })
}

/// Voxels placed in space; domain: the box of all cells.
///
/// σ_t(x) = scale · value of the cell that `world_to_grid` x lies in, cell (i, j, k) being
/// [i, i + 1) × [j, j + 1) × [k, k + 1).
#[derive(Clone, Copy, Debug)]
pub struct Voxels<'a> {
    table: &'a [f32],
    dims: [u32; 3],
    world_to_grid: Affine,
    scale: f32,
}

impl<'a> Voxels<'a> {
    /// * `table`: as [`fill_voxels`] makes it. `world_to_grid`: maps to the space in which cells are
    ///   unit cubes. `scale`: extinction of a value of one [1/length].
    ///
    /// # Errors
    /// Whatever of these is not as it must be.
    pub fn new(
        table: &'a [f32],
        dims: [u32; 3],
        world_to_grid: Affine,
        scale: f32,
    ) -> Result<Self, VoxelsError> {
        let expected = voxel_count(dims).ok_or(VoxelsError::Dimensions(dims))?;
        if table.len() != expected {
            let found = table.len();
            return Err(VoxelsError::Length { expected, found });
        }
        let finite = world_to_grid.iter().flatten().all(|x| x.is_finite());
        if !(finite && scale >= 0.0 && scale.is_finite()) {
            return Err(VoxelsError::Placement);
        }
        for_each_entry(dims, |at, cell| {
            let value = table.get(at).copied().unwrap_or(f32::NAN);
            let sound = value >= 0.0 && (value * scale).is_finite();
            if sound && (cell.is_some() || value == 0.0) {
                Ok(())
            } else {
                Err(VoxelsError::Value { at, value })
            }
        })?;
        Ok(Self {
            table,
            dims,
            world_to_grid,
            scale,
        })
    }

    /// A world-space ray in the walk's space, where a cell is as large as a majorant block.
    #[inline(always)]
    fn in_units<R: Real>(&self, ray: &Ray<R>) -> Ray<R> {
        let edge = R::splat(crate::majorant::BLOCK as f32);
        let cells = transform_ray(self.world_to_grid.map(|row| row.map(R::splat)), ray);
        Ray {
            origin: cells.origin * edge,
            direction: cells.direction * edge,
        }
    }

    #[inline(always)]
    fn layout<R: Real>(&self) -> GridLayout<R> {
        GridLayout::of_blocks(self.dims, self.scale)
    }

    /// The part of a world-space ray within the domain.
    #[inline(always)]
    pub fn clip<R: Real>(&self, ray: &Ray<R>) -> Interval<R> {
        let local = self.in_units(ray);
        clip_to_box(local.origin, local.direction, self.layout::<R>().last)
    }
}

impl<R: Real> Medium<R> for Voxels<'_> {
    type Walk = GridWalk<R>;
    const ONE_SEGMENT: bool = false;
    const TIGHT: bool = true;

    #[inline(always)]
    fn idle(&self) -> GridWalk<R> {
        GridWalk::idle()
    }
    #[inline(always)]
    fn begin(&self, walk: &mut GridWalk<R>, ray: &Ray<R>, active: R::Mask) {
        walk.begin(&self.layout(), &self.in_units(ray), self.table, active);
    }
    #[inline(always)]
    fn segment(&self, walk: &GridWalk<R>) -> Segment<R> {
        walk.segment()
    }
    #[inline(always)]
    fn next_segment(&self, walk: &mut GridWalk<R>, active: R::Mask) {
        walk.next_segment(self.table, active);
    }
    #[inline(always)]
    fn sigma_t(&self, walk: &GridWalk<R>, _: R, _: &mut impl Stream<R>, _: R::Mask) -> R {
        walk.segment().majorant
    }
}

impl<R: Real> PiecewiseConstant<R> for Voxels<'_> {}

impl<R: Real> Controlled<R> for Voxels<'_> {
    #[inline(always)]
    fn control(&self, walk: &GridWalk<R>) -> Control<R> {
        let sigma_t = walk.segment().majorant;
        Control {
            minimum: sigma_t,
            mean: sigma_t,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::medium::IDENTITY;

    #[test]
    fn values_lie_within_a_rim_of_zeros() {
        let dims = [2, 1, 3];
        let values = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0];
        let mut table = [f32::NAN; 4 * 3 * 5];
        assert_eq!(voxel_count(dims), Some(table.len()));
        assert_eq!(fill_voxels(&values, dims, &mut table), Ok(()));
        for (at, &found) in table.iter().enumerate() {
            let (x, y, z) = (at % 4, at / 4 % 3, at / 12);
            let inner = (1..3).contains(&x) && y == 1 && (1..4).contains(&z);
            let expected = if inner {
                values[x - 1 + 2 * (z - 1)]
            } else {
                0.0
            };
            assert_eq!(found, expected, "entry {at}");
        }
        assert!(Voxels::new(&table, dims, IDENTITY, 1.0).is_ok());
        // What the rim holds, and what no extinction can be, is found where it stands.
        for (at, value) in [(0, 1.0), (17, -1.0), (18, f32::INFINITY), (59, 1e-30)] {
            let mut bad = table;
            bad[at] = value;
            let error = Voxels::new(&bad, dims, IDENTITY, 1.0).err();
            assert_eq!(error, Some(VoxelsError::Value { at, value }));
        }
        let short = fill_voxels(&values[1..], dims, &mut table);
        assert!(matches!(
            short,
            Err(VoxelsError::Length {
                expected: 6,
                found: 5
            })
        ));
    }
}
