//! Delta (Woodcock) tracking: free flights by rejection from a process that is dense enough.
//!
//! ```text
//! tᵢ: events of a Poisson process of rate σ̄; the flight ends at the first with ξᵢ σ̄(tᵢ) < σ_t(tᵢ)
//! ```
//!
//! Keeping each event with probability σ_t/σ̄ leaves a Poisson process of rate σ_t, so the density of
//! the first kept one is σ_t T, for any σ̄ ≥ σ_t. The extinction enters linearly, so that an unbiased
//! estimate of it within [0, σ̄] serves as well as its value. Mean cost: ∫σ̄T dt look-ups.
//! Sources: [Woodcock 1965], [Raab 2006] Algorithm 1.

use crate::free_flight::Flight;
use crate::majorant::Tracker;
use crate::medium::Medium;
use crate::ray::Ray;
use crate::real::{Mask, Real};
use crate::stream::Stream;

/// Whether tentative collisions are real. One draw, none where the medium's bound is tight.
///
/// * `sigma_t`, `majorant`: at the collision, per lane [1/length].
#[inline(always)]
pub fn is_real<R: Real, M: Medium<R>>(
    sigma_t: R,
    majorant: R,
    rng: &mut impl Stream<R>,
    active: R::Mask,
) -> R::Mask {
    if M::TIGHT {
        active
    } else {
        (rng.uniform_fine(active) * majorant).lt(sigma_t) & active
    }
}

/// Flights under way, one per lane.
///
/// A running flight is either *tracking* towards its next tentative collision, or *at* one. The two
/// steps serve one kind each, in whatever order the caller likes.
#[derive(Clone, Debug)]
pub struct Delta<R: Real, W> {
    tracker: Tracker<R, W>,
    tracking: R::Mask,
    tentative: R::Mask,
    collided: R::Mask,
}

impl<R: Real, W: Clone> Delta<R, W> {
    /// No flight yet in any lane.
    #[inline(always)]
    pub fn idle<M: Medium<R, Walk = W>>(medium: &M) -> Self {
        let none = R::Mask::splat(false);
        Self {
            tracker: Tracker::idle(medium.idle()),
            tracking: none,
            tentative: none,
            collided: none,
        }
    }

    /// Begins flights on `[0, t_max)` of the rays of the active lanes.
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
        self.collided = self.collided.and_not(active);
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

    /// Decides the tentative collisions.
    #[inline(always)]
    pub fn collide<M: Medium<R, Walk = W>>(&mut self, medium: &M, rng: &mut impl Stream<R>) {
        let lanes = self.tentative;
        let majorant = self.tracker.majorant(medium);
        let sigma_t = medium.sigma_t(&self.tracker.walk, self.tracker.t(), rng, lanes);
        let real = is_real::<R, M>(sigma_t, majorant, rng, lanes);
        let null = lanes.and_not(real);
        self.collided = self.collided | real;
        self.tracking = self.tracking | null;
        self.tentative = R::Mask::splat(false);
        if !M::TIGHT {
            self.tracker.redraw(rng, null);
        }
    }

    /// The flights so far.
    #[inline(always)]
    pub fn flight(&self) -> Flight<R> {
        Flight {
            t: self.tracker.t(),
            collided: self.collided,
        }
    }
}

/// Samples one flight on `[0, t_max)` of each active lane's ray.
///
/// * `ray`: per lane, world space; its part `[0, t_max)` must lie in the medium's domain.
/// * `t_max`: per lane \[length\].
///
/// Draws an exponential and the medium's own draws per tentative collision, and one uniform number
/// to decide it.
#[inline]
pub fn sample<R: Real, M: Medium<R>>(
    medium: &M,
    ray: &Ray<R>,
    t_max: R,
    rng: &mut impl Stream<R>,
    active: R::Mask,
) -> Flight<R> {
    let mut state = Delta::idle(medium);
    state.begin(medium, ray, t_max, rng, active);
    loop {
        while state.tracking().any() {
            state.advance(medium);
        }
        if !state.tentative().any() {
            return state.flight();
        }
        state.collide(medium, rng);
    }
}
