//! Media: where extinction comes from.
//!
//! A medium proposes majorant segments along a ray and answers point queries; it knows nothing of
//! free flights or transmittance. Each file has one medium; the registry
//! [`for_each_medium`](crate::for_each_medium) names them for tests and benches.

mod audited;

mod emissive;
mod exponential;
mod grid;
mod homogeneous;
mod interpolated;
mod linear;
mod overlap;
mod placed;
mod procedural;
mod procedural_grid;
mod voxels;
mod within;

pub use audited::Audited;
pub use emissive::{Emission, Emissive};
pub use exponential::Exponential;
pub use grid::{Affine, Grid, IDENTITY, transform_ray};
pub use homogeneous::{ExtinctionError, Homogeneous};
pub use interpolated::Interpolated;
pub use linear::Linear;
pub use overlap::Overlap;
pub use placed::Placed;
pub use procedural::Procedural;
pub use procedural_grid::ProceduralGrid;
pub use voxels::{Voxels, VoxelsError, fill_voxels, voxel_count};
pub use within::Within;

use crate::majorant::Segment;
use crate::ray::Ray;
use crate::real::Real;
use crate::stream::Stream;

/// Calls `$row!(name)` for each file of this folder that holds a medium.
#[macro_export]
macro_rules! for_each_medium {
    ($row:ident) => {
        $row!(homogeneous);
        $row!(linear);
        $row!(exponential);
        $row!(grid);
        $row!(interpolated);
        $row!(voxels);
        $row!(procedural);
        $row!(procedural_grid);
        $row!(overlap);
        $row!(placed);
        $row!(within);
    };
}

/// What is known of the extinction on a segment besides its bound, per lane.
#[derive(Clone, Copy, Debug)]
pub struct Control<R> {
    /// No estimate of the extinction on the segment lies below [1/length]; not negative.
    pub minimum: R,
    /// About the extinction's mean on the segment [1/length], from the minimum to the majorant.
    /// Its accuracy decides about variance only.
    pub mean: R,
}

/// A medium that knows more than a bound of its extinction: what control variates are made of.
///
/// Zero is a true minimum everywhere, and any number from it to the bound a mean; what is tighter
/// saves more.
pub trait Controlled<R: Real>: Medium<R> {
    /// The controls of the present segment.
    fn control(&self, walk: &Self::Walk) -> Control<R>;
}

/// A medium whose extinction is its bound, constant on each segment.
///
/// Implementors have [`Medium::TIGHT`] set.
pub trait PiecewiseConstant<R: Real>: Medium<R> {}

/// A medium with optical depth in closed form, and the distance to a given one.
pub trait ClosedForm<R: Real>: Medium<R> {
    /// τ of `[0, t)` on each lane's ray; `t` not negative \[length\].
    fn optical_depth(&self, ray: &Ray<R>, t: R) -> R;
    /// The t with optical depth `depth`, infinite where the ray never collects it \[length\].
    ///
    /// * `depth`: positive and finite.
    fn distance(&self, ray: &Ray<R>, depth: R) -> R;
}

/// What tracking asks of a medium, per lane.
pub trait Medium<R: Real> {
    /// Where a ray stands among the majorant segments.
    type Walk: Clone;
    /// The bound is one for the whole ray.
    const ONE_SEGMENT: bool;
    /// The extinction equals the bound everywhere: every tentative collision is real.
    const TIGHT: bool;

    /// A walk with no ray yet.
    fn idle(&self) -> Self::Walk;
    /// Puts the walks of the active lanes at the origin of a world-space ray, which must lie in the
    /// medium's domain up to rounding.
    fn begin(&self, walk: &mut Self::Walk, ray: &Ray<R>, active: R::Mask);
    /// The present segment.
    fn segment(&self, walk: &Self::Walk) -> Segment<R>;
    /// Moves the active lanes to their next segment.
    fn next_segment(&self, walk: &mut Self::Walk, active: R::Mask);
    /// An unbiased estimate of the extinction at distance `t` of the present segment [1/length],
    /// never above its bound. Called for finished lanes too, at any finite `t`.
    fn sigma_t(&self, walk: &Self::Walk, t: R, rng: &mut impl Stream<R>, active: R::Mask) -> R;
}
