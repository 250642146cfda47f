//! The one walk: a Poisson process of rate σ̄ along a ray, carried across majorant segments.

use crate::majorant::Segment;
use crate::medium::Medium;
use crate::ray::FAR;
use crate::real::{Mask, Real};
use crate::stream::Stream;
use crate::sum::Compensated;

/// Where each lane stands on its ray, and how far it still flies.
///
/// One exponential *depth* is drawn for each tentative collision and carried across segments: in a
/// segment of bound σ̄ and length Δ it shrinks by σ̄Δ, without a logarithm or a random number. The
/// distance is kept as a [`Compensated`] sum, so that steps of 1e-12 of it still advance: 10⁷ tentative
/// collisions on a ray would stall a single `f32`.
#[derive(Clone, Debug)]
pub struct Tracker<R, W> {
    /// The medium's walk over its majorant segments.
    pub walk: W,
    t: Compensated<R>,
    t_end: R,
    depth: R,
}

/// What one advance came to, per lane; neither where the lane crossed into its next segment.
#[derive(Clone, Copy, Debug)]
pub struct Advance<R: Real> {
    /// Lanes now at a tentative collision.
    pub tentative: R::Mask,
    /// Lanes that reached the end of their ray.
    pub left: R::Mask,
    /// How far the active lanes flew \[length\].
    pub length: R,
}

impl<R: Real, W> Tracker<R, W> {
    /// A tracker whose lanes all wait to be begun.
    #[inline(always)]
    pub fn idle(walk: W) -> Self {
        Self {
            walk,
            t: Compensated::zero(),
            t_end: R::zero(),
            depth: R::zero(),
        }
    }

    /// Distance along the ray \[length\].
    #[inline(always)]
    pub fn t(&self) -> R {
        self.t.high
    }

    /// Puts the active lanes at t = 0 of rays of length `t_end`, or [`FAR`] where that is shorter;
    /// their walks must have been begun. One exponential draw.
    #[inline(always)]
    pub fn begin(&mut self, t_end: R, rng: &mut impl Stream<R>, active: R::Mask) {
        self.begin_towards(t_end, R::zero(), active);
        self.redraw(rng, active);
    }

    /// As [`begin`](Self::begin), with the next tentative collision at a given majorant depth
    /// ∫σ̄ dt instead of a drawn one.
    #[inline(always)]
    pub fn begin_towards(&mut self, t_end: R, depth: R, active: R::Mask) {
        self.t = Compensated::select(active, Compensated::zero(), self.t);
        // No medium has a segment that ends later, so a walk that went on would never end.
        let t_end = t_end.min(R::splat(FAR));
        self.t_end = R::select(active, t_end, self.t_end);
        self.redirect(depth, active);
    }

    /// Sets the majorant depth from the present place to the next tentative collision.
    #[inline(always)]
    pub fn redirect(&mut self, depth: R, active: R::Mask) {
        self.depth = R::select(active, depth, self.depth);
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
    pub fn advance<M: Medium<R, Walk = W>>(&mut self, medium: &M, active: R::Mask) -> Advance<R> {
        let Segment { majorant, t_exit } = medium.segment(&self.walk);
        let t_exit = t_exit.min(self.t_end);
        // Rounding may put an exit a hair before the entry; such a segment has no length.
        let Compensated { high, low } = self.t;
        let rest = ((t_exit - high) - low).max(R::zero());
        let depth_to_exit = majorant * rest;
        let tentative = self.depth.lt(depth_to_exit) & active;
        let crossing = active.and_not(tentative);
        let step = self.depth / majorant;
        let mut flown = self.t.plus(step);
        // A step may be rounded up to the exit, but not beyond it.
        flown.high = flown.high.min(t_exit);
        let crossed = Compensated::new(high.max(t_exit));
        let moved = Compensated::select(crossing, crossed, self.t);
        self.t = Compensated::select(tentative, flown, moved);
        self.depth = R::select(crossing, self.depth - depth_to_exit, self.depth);
        let left = self.t_end.le(self.t.high) & crossing;
        let on = crossing.and_not(left);
        if !M::ONE_SEGMENT && on.any() {
            medium.next_segment(&mut self.walk, on);
        }
        Advance {
            tentative,
            left,
            length: R::select(tentative, step, rest),
        }
    }
}
