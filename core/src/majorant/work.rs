//! How much work a tracker will have, known before it begins.
//!
//! Ratio tracking makes ∫σ̄ dt tentative collisions on average, whatever the medium; delta tracking at
//! most that many. Where a bound is loose and a ray long, that number can be astronomical. Cutting the
//! walk short would bias the estimate, so the number is computed beforehand, without a look-up or a
//! random number, and what is beyond a limit is refused.

use core::fmt;

use crate::medium::Medium;
use crate::ray::{FAR, Ray};
use crate::real::{Mask, Real};

/// Tentative collisions a ray that [`check_work`] lets pass by default: about a second's work.
pub const WORK_LIMIT: f32 = 1e7;

/// A ray that would take too long.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WorkError {
    /// Tentative collisions to be expected.
    pub expected: f32,
    /// How many are accepted.
    pub limit: f32,
}

impl fmt::Display for WorkError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { expected, limit } = self;
        write!(
            f,
            "{expected:e} tentative collisions are to be expected on one ray, and {limit:e} accepted: tighten the \
             majorant, shorten the ray, or take an estimator that needs fewer"
        )
    }
}

impl core::error::Error for WorkError {}

/// The majorant depth ∫σ̄ dt of `[0, t_max)`, per active lane: the mean number of tentative collisions
/// on it. Zero in other lanes.
///
/// Visits every majorant segment once; no look-ups, no draws. Infinite where it overflows.
#[inline]
pub fn majorant_depth<R: Real, M: Medium<R>>(
    medium: &M,
    ray: &Ray<R>,
    t_max: R,
    active: R::Mask,
) -> R {
    let mut depth = R::zero();
    for_each_segment(medium, ray, t_max, active, |_, majorant, length, lanes| {
        depth = R::select(lanes, depth + majorant * length, depth);
    });
    depth
}

/// Calls `visit(walk, majorant, length, lanes)` for the segments of `[0, t_max)`, lane by lane in order.
#[inline(always)]
pub(crate) fn for_each_segment<R: Real, M: Medium<R>>(
    medium: &M,
    ray: &Ray<R>,
    t_max: R,
    active: R::Mask,
    mut visit: impl FnMut(&M::Walk, R, R, R::Mask),
) {
    let mut walk = medium.idle();
    medium.begin(&mut walk, ray, active);
    // As trackers do; no segment ends later.
    let t_max = t_max.min(R::splat(FAR));
    let mut t = R::zero();
    let mut lanes = active & t.lt(t_max);
    while lanes.any() {
        let segment = medium.segment(&walk);
        let exit = segment.t_exit.min(t_max);
        visit(&walk, segment.majorant, (exit - t).max(R::zero()), lanes);
        t = R::select(lanes, t.max(exit), t);
        lanes = lanes & t.lt(t_max);
        if !M::ONE_SEGMENT && lanes.any() {
            medium.next_segment(&mut walk, lanes);
        }
    }
}

/// The majorant depth of a ray, if tracking it is affordable.
///
/// * `limit`: tentative collisions that are accepted on a ray, see [`WORK_LIMIT`].
///
/// # Errors
/// More are to be expected, on the ray of any lane.
#[inline]
pub fn check_work<R: Real, M: Medium<R>>(
    medium: &M,
    ray: &Ray<R>,
    t_max: R,
    limit: f32,
) -> Result<R, WorkError> {
    let depth = majorant_depth(medium, ray, t_max, R::Mask::splat(true));
    // Written so that NaN is refused.
    if depth.le(R::splat(limit)).all() {
        return Ok(depth);
    }
    let depths = (0..R::LANES).map(|lane| depth.lane(lane));
    // The largest, or NaN if there is one.
    let larger = |a: f32, b| if a.is_nan() || b <= a { a } else { b };
    let expected = depths.fold(0.0, larger);
    Err(WorkError { expected, limit })
}
