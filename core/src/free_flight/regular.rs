//! Regular tracking: free flight through a piecewise constant medium, cell by cell.
//!
//! ```text
//! e ~ Exp(1);  the flight ends in the first cell with Σ σ_t Δ ≥ e
//! ```
//!
//! Exact: one exponential, no look-ups and no rejections, but every cell up to the collision is
//! visited. It wins where cells are larger than a mean free path. The walk is that of delta tracking,
//! in which every tentative collision is real because the bound is the extinction itself.

use crate::free_flight::Flight;
use crate::majorant::Stages;
use crate::medium::PiecewiseConstant;
use crate::ray::Ray;
use crate::real::{Mask, Real};
use crate::stream::Stream;

/// Samples one flight on `[0, t_max)` of each active lane's ray.
///
/// * `ray`: per lane, world space; its part `[0, t_max)` must lie in the medium's domain.
/// * `t_max`: per lane \[length\].
#[inline]
pub fn sample<R: Real, M: PiecewiseConstant<R>>(
    medium: &M,
    ray: &Ray<R>,
    t_max: R,
    rng: &mut impl Stream<R>,
    active: R::Mask,
) -> Flight<R> {
    const { assert!(M::TIGHT, "a piecewise constant medium is its own bound") }
    let mut stages = Stages::idle(medium);
    stages.begin(medium, ray, t_max, rng, active);
    while stages.tracking().any() {
        stages.advance(medium);
    }
    Flight {
        t: stages.tracker.t(),
        collided: stages.tentative(),
    }
}
