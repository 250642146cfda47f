//! Delta (Woodcock) tracking: free flights by rejection from a process that is dense enough.
//!
//! ```text
//! tᵢ: events of a Poisson process of rate σ̄; the flight ends at the first with ξᵢ σ̄(tᵢ) < σ_t(tᵢ)
//! ```
//!
//! Keeping each event with probability σ_t/σ̄ leaves a Poisson process of rate σ_t, so the density of
//! the first kept one is σ_t T, for any σ̄ ≥ σ_t. The extinction enters linearly, so that an unbiased
//! estimate of it within [0, σ̄] serves as well as its value. Mean cost: ∫σ̄T dt look-ups.
//! Sources: [Woodcock 1965], [Raab, Seibert, Keller 2006] Algorithm 1.

use crate::free_flight::Flight;
use crate::majorant::{Process, Stages};
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

/// Flights under way, one per lane. As a result: the distance to the collision, infinite without one.
#[derive(Clone, Debug)]
pub struct Delta<R: Real, W> {
    stages: Stages<R, W>,
    collided: R::Mask,
}

impl<R: Real, W: Clone> Delta<R, W> {
    /// No flight yet in any lane.
    #[inline(always)]
    pub fn idle<M: Medium<R, Walk = W>>(medium: &M) -> Self {
        Self {
            stages: Stages::idle(medium),
            collided: R::Mask::splat(false),
        }
    }

    /// The flights so far.
    #[inline(always)]
    pub fn flight(&self) -> Flight<R> {
        Flight {
            t: self.stages.tracker.t(),
            collided: self.collided,
        }
    }
}

impl<R: Real, M: Medium<R>> Process<R, M> for Delta<R, M::Walk> {
    #[inline(always)]
    fn stages(&mut self) -> &mut Stages<R, M::Walk> {
        &mut self.stages
    }
    #[inline(always)]
    fn begin(
        &mut self,
        medium: &M,
        ray: &Ray<R>,
        t_max: R,
        rng: &mut impl Stream<R>,
        active: R::Mask,
    ) {
        self.stages.begin(medium, ray, t_max, rng, active);
        self.collided = self.collided.and_not(active);
    }
    #[inline(always)]
    fn collide(&mut self, medium: &M, rng: &mut impl Stream<R>) {
        let lanes = self.stages.tentative();
        let (sigma_t, majorant) = self.stages.sigma_t(medium, rng);
        let real = is_real::<R, M>(sigma_t, majorant, rng, lanes);
        self.collided = self.collided | real;
        self.stages.resolve::<M>(rng, lanes.and_not(real));
    }
    #[inline(always)]
    fn result(&self) -> R {
        self.flight().or_infinite()
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
    Process::<R, M>::begin(&mut state, medium, ray, t_max, rng, active);
    state.run(medium, rng);
    state.flight()
}
