//! Transmittance: the probability T = e^−τ of passing a stretch of a ray without a collision.
//!
//! Each file has one estimator with a function `estimate`; the registry
//! [`for_each_transmittance`](crate::for_each_transmittance) names them for tests and benches. The
//! estimators by tracking differ only in what a tentative collision does to the weight, a
//! [`Rule`]; the walk is shared.

pub mod analytic;
pub mod delta;
pub mod ratio;

use crate::majorant::Tracker;
use crate::medium::Medium;
use crate::ray::Ray;
use crate::real::{Mask, Real};
use crate::stream::Stream;

/// Calls `$row!(name)` for each file of this folder.
#[macro_export]
macro_rules! for_each_transmittance {
    ($row:ident) => {
        $row!(analytic);
        $row!(delta);
        $row!(ratio);
    };
}

/// What a tentative collision does to an estimate.
pub trait Rule {
    /// The new weight of the active lanes; others keep theirs.
    ///
    /// * `sigma_t`: an unbiased estimate of the extinction there. `majorant`: the rate of the process
    ///   that led there. Both per lane [1/length].
    fn collide<R: Real, M: Medium<R>>(
        weight: R,
        sigma_t: R,
        majorant: R,
        rng: &mut impl Stream<R>,
        active: R::Mask,
    ) -> R;
}

/// Estimates under way, one per lane; see [`crate::free_flight::delta::Delta`] for the two steps.
#[derive(Clone, Debug)]
pub struct Estimate<R: Real, W> {
    tracker: Tracker<R, W>,
    tracking: R::Mask,
    tentative: R::Mask,
    weight: R,
}

impl<R: Real, W: Clone> Estimate<R, W> {
    /// No estimate yet in any lane.
    #[inline(always)]
    pub fn idle<M: Medium<R, Walk = W>>(medium: &M) -> Self {
        let none = R::Mask::splat(false);
        Self {
            tracker: Tracker::idle(medium.idle()),
            tracking: none,
            tentative: none,
            weight: R::zero(),
        }
    }

    /// Begins estimates over `[0, t_max)` of the rays of the active lanes.
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
        self.weight = R::select(active, R::one(), self.weight);
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

    /// Moves every tracking lane to its next tentative collision, its next segment, or out.
    #[inline(always)]
    pub fn advance<M: Medium<R, Walk = W>>(&mut self, medium: &M) {
        let advance = self.tracker.advance(medium, self.tracking);
        self.tracking = self.tracking.and_not(advance.left | advance.tentative);
        self.tentative = self.tentative | advance.tentative;
    }

    /// Applies the rule to the tentative collisions; a weight of zero completes its estimate.
    #[inline(always)]
    pub fn collide<M: Medium<R, Walk = W>, U: Rule>(
        &mut self,
        medium: &M,
        rng: &mut impl Stream<R>,
    ) {
        let lanes = self.tentative;
        let majorant = self.tracker.majorant(medium);
        let sigma_t = medium.sigma_t(&self.tracker.walk, self.tracker.t(), rng, lanes);
        self.weight = U::collide::<R, M>(self.weight, sigma_t, majorant, rng, lanes);
        let onward = lanes.and_not(self.weight.eq(R::zero()));
        self.tracking = self.tracking | onward;
        self.tentative = R::Mask::splat(false);
        // Where every collision is real, none is passed.
        if !M::TIGHT {
            self.tracker.redraw(rng, onward);
        }
    }

    /// The weights so far: complete estimates where a lane is neither tracking nor tentative.
    #[inline(always)]
    pub fn weight(&self) -> R {
        self.weight
    }
}

/// One estimate under a rule; see [`delta::estimate`] and [`ratio::estimate`].
#[inline(always)]
fn estimate<R: Real, M: Medium<R>, U: Rule>(
    medium: &M,
    ray: &Ray<R>,
    t_max: R,
    rng: &mut impl Stream<R>,
    active: R::Mask,
) -> R {
    let mut state = Estimate::idle(medium);
    state.begin(medium, ray, t_max, rng, active);
    loop {
        while state.tracking().any() {
            state.advance(medium);
        }
        if !state.tentative().any() {
            return state.weight();
        }
        state.collide::<M, U>(medium, rng);
    }
}
