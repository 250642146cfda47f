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

/// Estimates under way, one per lane.
#[derive(Clone, Debug)]
pub struct Estimate<R: Real, W> {
    tracker: Tracker<R, W>,
    running: R::Mask,
    weight: R,
}

impl<R: Real, W: Clone> Estimate<R, W> {
    /// No estimate yet in any lane.
    #[inline(always)]
    pub fn idle<M: Medium<R, Walk = W>>(medium: &M) -> Self {
        Self {
            tracker: Tracker::idle(medium.idle()),
            running: R::Mask::splat(false),
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
        self.running = self.running | active;
    }

    /// Lanes whose estimate is not complete.
    #[inline(always)]
    pub fn running(&self) -> R::Mask {
        self.running
    }

    /// One advance of every running lane, and the rule where it met a tentative collision. Returns
    /// the lanes that met one.
    #[inline(always)]
    pub fn step<M: Medium<R, Walk = W>, U: Rule>(
        &mut self,
        medium: &M,
        rng: &mut impl Stream<R>,
    ) -> R::Mask {
        let advance = self.tracker.advance(medium, self.running);
        self.running = self.running.and_not(advance.left);
        let tentative = advance.tentative;
        if tentative.any() {
            let majorant = self.tracker.majorant(medium);
            let t = self.tracker.t();
            let sigma_t = medium.sigma_t(&self.tracker.walk, t, rng, tentative);
            self.weight = U::collide::<R, M>(self.weight, sigma_t, majorant, rng, tentative);
            let extinct = self.weight.eq(R::zero()) & tentative;
            self.running = self.running.and_not(extinct);
            self.tracker.redraw(rng, tentative.and_not(extinct));
        }
        tentative
    }

    /// The weights so far: complete estimates where a lane is not running.
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
    while state.running().any() {
        state.step::<M, U>(medium, rng);
    }
    state.weight()
}
