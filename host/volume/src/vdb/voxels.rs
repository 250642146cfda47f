//! The values of a grid, whatever their type: look-ups in index space.

use super::cubes::Box3;
use super::tree::Tree;
use super::values::Voxel;
use super::{VdbError, cubes, integral, visit};
use crate::Limits;
use glam::DVec3;
use half::f16;

/// The values of a grid: voxels, tiles and background, as sparse as in the file.
///
/// Coordinates are in index space, where integers are voxel centres; every coordinate is in the domain. A scalar grid
/// has one component, a vector grid three; methods without a component speak of the first.
#[derive(Debug)]
pub struct Voxels(pub(crate) Typed);

#[derive(Debug)]
pub(crate) enum Typed {
    Float(Tree<f32>),
    #[cfg(feature = "all-types")]
    Double(Tree<f64>),
    Half(Tree<f16>),
    #[cfg(feature = "all-types")]
    Int32(Tree<i32>),
    #[cfg(feature = "all-types")]
    Int64(Tree<i64>),
    #[cfg(feature = "all-types")]
    Bool(Tree<bool>),
    #[cfg(feature = "all-types")]
    Vec3s(Tree<[f32; 3]>),
    #[cfg(feature = "all-types")]
    Vec3d(Tree<[f64; 3]>),
    #[cfg(feature = "all-types")]
    Vec3i(Tree<[i32; 3]>),
}

macro_rules! with_tree {
    ($voxels:expr, $tree:ident => $body:expr) => {
        match &$voxels.0 {
            Typed::Float($tree) => $body,
            #[cfg(feature = "all-types")]
            Typed::Double($tree) => $body,
            Typed::Half($tree) => $body,
            #[cfg(feature = "all-types")]
            Typed::Int32($tree) => $body,
            #[cfg(feature = "all-types")]
            Typed::Int64($tree) => $body,
            #[cfg(feature = "all-types")]
            Typed::Bool($tree) => $body,
            #[cfg(feature = "all-types")]
            Typed::Vec3s($tree) => $body,
            #[cfg(feature = "all-types")]
            Typed::Vec3d($tree) => $body,
            #[cfg(feature = "all-types")]
            Typed::Vec3i($tree) => $body,
        }
    };
}

/// What the active values of a grid amount to. Tiles count with all their voxels; a scalar fills all three components.
#[derive(Debug, Clone, PartialEq)]
pub struct Statistics {
    /// Active voxels.
    pub active_voxels: u64,
    /// Active tiles of all levels.
    pub active_tiles: u64,
    /// Leaf nodes (8³ voxels).
    pub leaf_nodes: u64,
    /// Box of the active voxels, both ends inclusive \[voxels\].
    pub active_bbox: Option<([i64; 3], [i64; 3])>,
    /// Box outside of which every value, active or not, is the background's. What interpolates must cover this one.
    pub stored_bbox: Option<([i64; 3], [i64; 3])>,
    /// Least active value per component, NaN apart; +∞ without active values.
    pub min: [f64; 3],
    /// Greatest active value per component, NaN apart; −∞ without active values.
    pub max: [f64; 3],
    /// Sum of the active values per component.
    pub sum: [f64; 3],
}

/// A value that cannot be a density: NaN, infinite or negative.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct InvalidValue {
    /// Where: a voxel, for a tile its first one; `None` is the background.
    pub voxel: Option<[i64; 3]>,
    /// The value.
    pub value: f64,
}

impl std::fmt::Display for InvalidValue {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self.voxel {
            Some([i, j, k]) => write!(f, "voxel ({i}, {j}, {k}) is {}", self.value),
            None => write!(f, "the background is {}", self.value),
        }
    }
}

/// The component if the type has it, else the first.
fn nth<T: Voxel>(_: &Tree<T>, n: usize) -> usize {
    n.min(T::COMPONENTS - 1)
}

impl Voxels {
    /// 1 for scalars, 3 for vectors.
    #[must_use]
    pub fn components(&self) -> usize {
        fn of<T: Voxel>(_: &Tree<T>) -> usize {
            T::COMPONENTS
        }
        with_tree!(self, tree => of(tree))
    }

    /// Whether the values are whole numbers or truth values.
    #[must_use]
    pub fn is_integral(&self) -> bool {
        fn of<T: Voxel>(_: &Tree<T>) -> bool {
            !T::REAL
        }
        with_tree!(self, tree => of(tree))
    }

    /// Whether the values are truth values (0 or 1).
    #[must_use]
    pub fn is_bool(&self) -> bool {
        #[cfg(feature = "all-types")]
        return matches!(self.0, Typed::Bool(_));
        #[cfg(not(feature = "all-types"))]
        false
    }

    /// The value where nothing is stored.
    #[must_use]
    pub fn background(&self) -> f64 {
        self.background_vector()[0]
    }

    /// [`background`](Self::background) of all components; a scalar three times.
    #[must_use]
    pub fn background_vector(&self) -> [f64; 3] {
        with_tree!(self, tree => std::array::from_fn(|n| tree.background.component(nth(tree, n))))
    }

    /// The value at a voxel: stored, a tile's, or the background.
    #[must_use]
    pub fn value(&self, ijk: [i64; 3]) -> f64 {
        with_tree!(self, tree => tree.find(ijk).value.component(0))
    }

    /// [`value`](Self::value) of all components; a scalar three times.
    #[must_use]
    pub fn vector(&self, ijk: [i64; 3]) -> [f64; 3] {
        with_tree!(self, tree => {
            let value = tree.find(ijk).value;
            std::array::from_fn(|n| value.component(nth(tree, n)))
        })
    }

    /// Whether a voxel is active.
    #[must_use]
    pub fn is_active(&self, ijk: [i64; 3]) -> bool {
        with_tree!(self, tree => tree.find(ijk).active)
    }

    /// Counts, bounds and sums, in one walk over what is stored.
    #[must_use]
    pub fn statistics(&self) -> Statistics {
        with_tree!(self, tree => visit::statistics(tree))
    }

    /// The first NaN, infinite or negative value among all that is stored, the inactive and the background included:
    /// interpolation mixes them in.
    #[must_use]
    pub fn first_invalid(&self) -> Option<InvalidValue> {
        with_tree!(self, tree => {
            let clean = cubes::all_valid(tree);
            (!clean).then(|| visit::first_invalid(tree)).flatten()
        })
    }

    /// Box outside of which every value is the background's; that of [`Statistics`], without the rest.
    #[must_use]
    pub fn stored_box(&self) -> Option<Box3> {
        with_tree!(self, tree => cubes::bounds(tree, |v| !v.same(tree.background)))
    }

    /// Box outside of which no stored value differs from zero, as `f32`; the background is not asked.
    #[must_use]
    pub fn visible_box(&self) -> Option<Box3> {
        with_tree!(self, tree => cubes::bounds(tree, |v| single(v) != 0.0))
    }

    /// Which cubes of 8³ voxels may hold stored values above zero, as `f32`: all that do, and few others.
    ///
    /// * `low`: the first voxel of the first cube. `cubes`: of them along x, y, z. `marks`: one for each, x fastest; only set.
    pub fn mark_cubes(&self, low: [i64; 3], cubes: [u32; 3], marks: &mut [bool]) {
        with_tree!(self, tree => cubes::mark(tree, low, cubes, |v| single(v) > 0.0, marks));
    }

    /// The values of the cube of 8³ voxels that begins at `low`, as `f32`, x fastest; zeros beyond the voxel `high`.
    #[must_use]
    pub fn cube(&self, low: [i64; 3], high: [i64; 3]) -> [f32; 512] {
        with_tree!(self, tree => cubes::cube(tree, low, high, single))
    }

    /// Trilinear interpolation between the eight voxels around a point of index space, active or not. Component `n` of a
    /// vector (a scalar has but one). NaN where the point is not finite.
    #[must_use]
    pub fn trilinear(&self, n: usize, index: DVec3) -> f64 {
        with_tree!(self, tree => integral::trilinear(tree, nth(tree, n), index))
    }

    /// Mean of the trilinear interpolant along a segment of index space, exact up to rounding; times the length in the
    /// world it is the line integral. NaN where an end is not finite.
    #[must_use]
    pub fn mean_along(&self, n: usize, from: DVec3, to: DVec3) -> f64 {
        with_tree!(self, tree => integral::mean_along(tree, nth(tree, n), from, to))
    }

    /// All values of the box from `min` to `max` (inclusive), x fastest, as `f32`: what does not fit becomes infinite.
    /// An empty box gives no values.
    ///
    /// # Errors
    /// [`VdbError::Memory`] where the box exceeds the limit.
    pub fn to_dense(
        &self,
        min: [i64; 3],
        max: [i64; 3],
        limits: &Limits,
    ) -> Result<Vec<f32>, VdbError> {
        with_tree!(self, tree => visit::dense(tree, min, max, limits, single))
    }

    /// [`to_dense`](Self::to_dense) of all components; a scalar three times.
    ///
    /// # Errors
    /// [`VdbError::Memory`] where the box exceeds the limit.
    pub fn to_dense_vectors(
        &self,
        min: [i64; 3],
        max: [i64; 3],
        limits: &Limits,
    ) -> Result<Vec<[f32; 3]>, VdbError> {
        with_tree!(self, tree => {
            let convert = |v: _| std::array::from_fn(|n| component(v, n) as f32);
            visit::dense(tree, min, max, limits, convert)
        })
    }
}

/// The first component in single precision.
fn single<T: Voxel>(value: T) -> f32 {
    value.component(0) as f32
}

fn component<T: Voxel>(value: T, n: usize) -> f64 {
    value.component(n.min(T::COMPONENTS - 1))
}
