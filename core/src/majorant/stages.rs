//! Rays under way, one per lane, in the two stages that tracking has.
//!
//! A running ray is either *tracking* towards its next tentative collision, or *at* one. A step serves one
//! stage and all lanes in it; which step runs when is the caller's choice and changes no result.

use crate::majorant::{Advance, Tracker};
use crate::medium::Medium;
use crate::ray::Ray;
use crate::real::{Mask, Real};
use crate::stream::Stream;

/// The tracker of all lanes, and which lanes are in which stage.
#[derive(Clone, Debug)]
pub struct Stages<R: Real, W> {
    /// Where each lane is.
    pub tracker: Tracker<R, W>,
    tracking: R::Mask,
    tentative: R::Mask,
}

impl<R: Real, W: Clone> Stages<R, W> {
    /// No ray yet in any lane.
    #[inline(always)]
    pub fn idle<M: Medium<R, Walk = W>>(medium: &M) -> Self {
        let none = R::Mask::splat(false);
        Self {
            tracker: Tracker::idle(medium.idle()),
            tracking: none,
            tentative: none,
        }
    }

    /// Begins the parts `[0, t_max)` of the rays of the active lanes.
    #[inline(always)]
    pub fn begin<M: Medium<R, Walk = W>>(
        &mut self,
        medium: &M,
        ray: &Ray<R>,
        t_max: R,
        rng: &mut impl Stream<R>,
        active: R::Mask,
    ) {
        medium.begin(&mut self.tracker.walk, ray, active);
        self.tracker.begin(t_max, rng, active);
        self.tracking = self.tracking | active;
    }

    /// Lanes on their way to a tentative collision.
    #[inline(always)]
    pub fn tracking(&self) -> R::Mask {
        self.tracking
    }

    /// Lanes at a tentative collision.
    #[inline(always)]
    pub fn tentative(&self) -> R::Mask {
        self.tentative
    }

    /// Begins as [`begin`](Self::begin), with the first tentative collision at a given majorant depth.
    #[inline(always)]
    pub fn begin_towards<M: Medium<R, Walk = W>>(
        &mut self,
        medium: &M,
        ray: &Ray<R>,
        t_max: R,
        depth: R,
        active: R::Mask,
    ) {
        medium.begin(&mut self.tracker.walk, ray, active);
        self.tracker.begin_towards(t_max, depth, active);
        self.tracking = self.tracking | active;
    }

    /// Sends the active lanes, at a tentative collision, on to the one at a further majorant depth.
    #[inline(always)]
    pub fn redirect(&mut self, depth: R, active: R::Mask) {
        self.tracker.redirect(depth, active);
        self.tentative = self.tentative.and_not(active);
        self.tracking = self.tracking | active;
    }

    /// Ends the rays of the active lanes where they are.
    #[inline(always)]
    pub fn finish(&mut self, active: R::Mask) {
        self.tentative = self.tentative.and_not(active);
        self.tracking = self.tracking.and_not(active);
    }

    /// Moves every tracking lane to its next tentative collision, its next segment, or out.
    #[inline(always)]
    pub fn advance<M: Medium<R, Walk = W>>(&mut self, medium: &M) -> Advance<R> {
        let advance = self.tracker.advance(medium, self.tracking);
        self.tracking = self.tracking.and_not(advance.left | advance.tentative);
        self.tentative = self.tentative | advance.tentative;
        advance
    }

    /// An estimate of the extinction at the tentative collisions, and its bound [1/length].
    #[inline(always)]
    pub fn sigma_t<M: Medium<R, Walk = W>>(&self, medium: &M, rng: &mut impl Stream<R>) -> (R, R) {
        let t = self.tracker.t();
        let sigma_t = medium.sigma_t(&self.tracker.walk, t, rng, self.tentative);
        (sigma_t, self.tracker.majorant(medium))
    }

    /// Ends the stage of tentative collisions: the lanes `onward` track on, the others have ended.
    #[inline(always)]
    pub fn resolve<M: Medium<R, Walk = W>>(&mut self, rng: &mut impl Stream<R>, onward: R::Mask) {
        self.tentative = R::Mask::splat(false);
        // Where every collision is real, none is passed.
        if !M::TIGHT {
            self.tracking = self.tracking | onward;
            self.tracker.redraw(rng, onward);
        }
    }
}

/// What tracking is for: what becomes of tentative collisions.
pub trait Process<R: Real, M: Medium<R>> {
    /// The lanes' stages.
    fn stages(&mut self) -> &mut Stages<R, M::Walk>;

    /// Begins the parts `[0, t_max)` of the rays of the active lanes.
    fn begin(
        &mut self,
        medium: &M,
        ray: &Ray<R>,
        t_max: R,
        rng: &mut impl Stream<R>,
        active: R::Mask,
    );

    /// Moves every tracking lane on: to a tentative collision, to its next segment, or out.
    #[inline(always)]
    fn advance(&mut self, medium: &M) {
        self.stages().advance(medium);
    }

    /// Decides the tentative collisions.
    fn collide(&mut self, medium: &M, rng: &mut impl Stream<R>);

    /// The results so far; final for lanes in neither stage.
    fn result(&self) -> R;

    /// Runs all lanes to their end.
    #[inline(always)]
    fn run(&mut self, medium: &M, rng: &mut impl Stream<R>) {
        loop {
            while self.stages().tracking().any() {
                self.advance(medium);
            }
            if !self.stages().tentative().any() {
                return;
            }
            self.collide(medium, rng);
        }
    }
}
