//! Media: where extinction comes from.
//!
//! A medium proposes majorant segments along a ray and answers point queries; it knows nothing of
//! free flights or transmittance. Each file has one medium; the registry
//! [`for_each_medium`](crate::for_each_medium) names them for tests and benches.

mod grid;
mod homogeneous;
mod procedural;
mod procedural_grid;

pub use grid::{Affine, Grid, IDENTITY, transform_ray};
pub use homogeneous::{ExtinctionError, Homogeneous};
pub use procedural::Procedural;
pub use procedural_grid::ProceduralGrid;

use crate::majorant::Segment;
use crate::ray::Ray;
use crate::real::Real;
use crate::stream::Stream;

/// Calls `$row!(name)` for each file of this folder that holds a medium.
#[macro_export]
macro_rules! for_each_medium {
    ($row:ident) => {
        $row!(homogeneous);
        $row!(grid);
        $row!(procedural);
        $row!(procedural_grid);
    };
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
