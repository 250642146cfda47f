//! The one walk: a Poisson process of rate σ̄ along a ray, carried across majorant segments.

use crate::majorant::Segment;
use crate::medium::Medium;
use crate::real::{Mask, Real};
use crate::stream::Stream;

/// Where each lane stands on its ray, and how far it still flies.
///
/// One exponential *depth* is drawn for each tentative collision and carried across segments: in a
/// segment of bound σ̄ and length Δ it shrinks by σ̄Δ, without a logarithm or a random number. The
/// distance within a segment is kept apart from where the segment begins, so that steps of 1e-7 of
/// the ray's length still advance it.
#[derive(Clone, Debug)]
pub struct Tracker<R, W> {
    /// The medium's walk over its majorant segments.
    pub walk: W,
    segment_start: R,
    within: R,
    t_end: R,
    depth: R,
}

/// What one advance came to, per lane; neither where the lane crossed into its next segment.
#[derive(Clone, Copy, Debug)]
pub struct Advance<M> {
    /// Lanes now at a tentative collision.
    pub tentative: M,
    /// Lanes that reached the end of their ray.
    pub left: M,
}

impl<R: Real, W> Tracker<R, W> {
    /// A tracker whose lanes all wait to be begun.
    #[inline(always)]
    pub fn idle(walk: W) -> Self {
        Self {
            walk,
            segment_start: R::zero(),
            within: R::zero(),
            t_end: R::zero(),
            depth: R::zero(),
        }
    }

    /// Distance along the ray \[length\].
    #[inline(always)]
    pub fn t(&self) -> R {
        self.segment_start + self.within
    }

    /// Puts the active lanes at t = 0 of rays of length `t_end`; their walks must have been begun.
    /// One exponential draw.
    #[inline(always)]
    pub fn begin(&mut self, t_end: R, rng: &mut impl Stream<R>, active: R::Mask) {
        self.segment_start = R::select(active, R::zero(), self.segment_start);
        self.within = R::select(active, R::zero(), self.within);
        self.t_end = R::select(active, t_end, self.t_end);
        self.redraw(rng, active);
    }

    /// After a null collision: draws the depth to the next tentative one. One exponential draw.
    #[inline(always)]
    pub fn redraw(&mut self, rng: &mut impl Stream<R>, active: R::Mask) {
        self.depth = R::select(active, rng.exponential(active), self.depth);
    }

    /// The bound at the present place [1/length].
    #[inline(always)]
    pub fn majorant<M: Medium<R, Walk = W>>(&self, medium: &M) -> R {
        medium.segment(&self.walk).majorant
    }

    /// Moves each active lane to its next tentative collision, or across the end of its segment.
    #[inline(always)]
    pub fn advance<M: Medium<R, Walk = W>>(
        &mut self,
        medium: &M,
        active: R::Mask,
    ) -> Advance<R::Mask> {
        let Segment { majorant, t_exit } = medium.segment(&self.walk);
        let t_exit = t_exit.min(self.t_end);
        // Rounding may put an exit a hair before the entry; such a segment has no length.
        let rest = ((t_exit - self.segment_start) - self.within).max(R::zero());
        let depth_to_exit = majorant * rest;
        let tentative = self.depth.lt(depth_to_exit) & active;
        let crossing = active.and_not(tentative);
        let flown = self.within + self.depth / majorant;
        self.within = R::select(tentative, flown, self.within.or_zero(!crossing));
        self.segment_start =
            R::select(crossing, self.segment_start.max(t_exit), self.segment_start);
        self.depth = R::select(crossing, self.depth - depth_to_exit, self.depth);
        let left = self.t_end.le(self.segment_start) & crossing;
        let on = crossing.and_not(left);
        if !M::ONE_SEGMENT && on.any() {
            medium.next_segment(&mut self.walk, on);
        }
        Advance { tentative, left }
    }
}
