//! Decomposition tracking: the part of the extinction that is known everywhere collides unseen.
//!
//! ```text
//! σ_t = c + (σ_t − c),   t = min(t_control, t_residual)
//! ```
//!
//! The control, of rate c ≤ σ_t, needs no look-up; the residual is found by delta tracking under σ̄ − c.
//! Both processes together have rate σ̄, and an event belongs to the control with probability c/σ̄. So
//! one exponential and one uniform number serve both: an event below c is a control collision, one
//! below σ_t a residual collision, else it is null. Mean cost: ∫(σ̄ − c) T dt look-ups instead of
//! ∫σ̄T dt. The distribution is that of delta tracking. Source: [Kutz 2017].

use crate::free_flight::Flight;
use crate::majorant::{Process, Stages};
use crate::medium::Controlled;
use crate::ray::Ray;
use crate::real::{Mask, Real};
use crate::stream::Stream;

/// Flights under way, one per lane. As a result: the distance to the collision, infinite without one.
#[derive(Clone, Debug)]
pub struct Decomposition<R: Real, W> {
    stages: Stages<R, W>,
    collided: R::Mask,
}

impl<R: Real, W: Clone> Decomposition<R, W> {
    /// No flight yet in any lane.
    #[inline(always)]
    pub fn idle<M: Controlled<R, Walk = W>>(medium: &M) -> Self {
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

impl<R: Real, M: Controlled<R>> Process<R, M> for Decomposition<R, M::Walk> {
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
        let walk = &self.stages.tracker.walk;
        let mut real = lanes;
        if !M::TIGHT {
            let rate = rng.uniform_fine(lanes) * medium.segment(walk).majorant;
            real = rate.lt(medium.control(walk).minimum) & lanes;
            let unknown = lanes.and_not(real);
            if unknown.any() {
                let sigma_t = medium.sigma_t(walk, self.stages.tracker.t(), rng, unknown);
                real = real | (rate.lt(sigma_t) & unknown);
            }
        }
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
/// Draws an exponential and one uniform number per tentative collision, and the medium's own draws
/// where it looks up.
#[inline]
pub fn sample<R: Real, M: Controlled<R>>(
    medium: &M,
    ray: &Ray<R>,
    t_max: R,
    rng: &mut impl Stream<R>,
    active: R::Mask,
) -> Flight<R> {
    let mut state = Decomposition::idle(medium);
    Process::<R, M>::begin(&mut state, medium, ray, t_max, rng, active);
    state.run(medium, rng);
    state.flight()
}
