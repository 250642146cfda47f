//! Weighted tracking: free flights under a rate that need not bound the extinction.
//!
//! ```text
//! P(real) = σ_t / (σ_t + |σ̄ − σ_t|),   real: w ← w (σ_t + |σ̄ − σ_t|)/σ̄,
//!                                        null: w ← ±w (σ_t + |σ̄ − σ_t|)/σ̄,  − where σ_t > σ̄
//! ```
//!
//! Both weights follow from w σ_t/(σ̄ P) and w (σ̄ − σ_t)/(σ̄ (1 − P)). Where σ̄ bounds σ_t they are 1 and
//! this is delta tracking. Elsewhere E\[w · 1(collided before t)\] = 1 − T(t) and E\[w · 1(left)\] = T still
//! hold, for any σ̄ > 0. **The variance does not stay small**: each event above the bound multiplies |w|
//! by 2σ_t/σ̄ − 1. With m the second moment of the weight of what is still under way at t,
//!
//! ```text
//! m(t) = E[w² · 1(t reached)] = exp(∫₀ᵗ h ds),   h = −σ_t under the bound, σ_t (2σ_t/σ̄ − 3) beyond it
//! E[w²] = m(t_max) + ∫ m σ_t max(1, 2σ_t/σ̄ − 1) dt
//! ```
//!
//! Above two thirds of the extinction a bound that fails lets m fall with distance, and the variance
//! stays moderate on rays of any length; below, m grows with every mean free path and the estimate is
//! soon useless. A medium's segment with a bound of zero and extinction above it is never seen. Sources:
//! [Carter, Cashwell, Taylor 1972], [Kutz 2017].

use crate::free_flight::Flight;
use crate::majorant::{Process, Stages};
use crate::medium::Medium;
use crate::ray::Ray;
use crate::real::{Mask, Real};
use crate::stream::Stream;

/// A flight with the weight that makes it right in expectation, per lane.
#[derive(Clone, Copy, Debug)]
pub struct WeightedFlight<R: Real> {
    /// Where it went.
    pub flight: Flight<R>,
    /// What it counts: 1 as long as the bound held, any sign and size elsewhere.
    pub weight: R,
}

/// Flights under way, one per lane. As a result: the distance to the collision, infinite without one,
/// which means little without its [`weight`](WeightedFlight::weight).
#[derive(Clone, Debug)]
pub struct Weighted<R: Real, W> {
    stages: Stages<R, W>,
    collided: R::Mask,
    weight: R,
}

impl<R: Real, W: Clone> Weighted<R, W> {
    /// No flight yet in any lane.
    #[inline(always)]
    pub fn idle<M: Medium<R, Walk = W>>(medium: &M) -> Self {
        Self {
            stages: Stages::idle(medium),
            collided: R::Mask::splat(false),
            weight: R::one(),
        }
    }

    /// The flights so far.
    #[inline(always)]
    pub fn flight(&self) -> WeightedFlight<R> {
        WeightedFlight {
            flight: Flight {
                t: self.stages.tracker.t(),
                collided: self.collided,
            },
            weight: self.weight,
        }
    }
}

impl<R: Real, M: Medium<R>> Process<R, M> for Weighted<R, M::Walk> {
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
        self.weight = R::select(active, R::one(), self.weight);
    }
    #[inline(always)]
    fn collide(&mut self, medium: &M, rng: &mut impl Stream<R>) {
        let lanes = self.stages.tentative();
        let mut real = lanes;
        if !M::TIGHT {
            let (sigma_t, rate) = self.stages.sigma_t(medium, rng);
            let total = sigma_t + (rate - sigma_t).abs();
            real = (rng.uniform_fine(lanes) * total).lt(sigma_t) & lanes;
            // Where the bound holds the total is the rate up to rounding, and the weight stays.
            let beyond = rate.lt(sigma_t) & lanes;
            let factor = R::select(beyond, total / rate, R::one());
            let signed = R::select(beyond.and_not(real), -factor, factor);
            self.weight = self.weight * R::select(lanes, signed, R::one());
        }
        self.collided = self.collided | real;
        self.stages.resolve::<M>(rng, lanes.and_not(real));
    }
    #[inline(always)]
    fn result(&self) -> R {
        self.flight().flight.or_infinite()
    }
}

/// Samples one flight on `[0, t_max)` of each active lane's ray, with its weight.
///
/// * `medium`: any; its segments' bounds serve as rates, positive wherever the extinction is.
/// * `ray`: per lane, world space; its part `[0, t_max)` must lie in the medium's domain.
/// * `t_max`: per lane \[length\].
///
/// Draws an exponential, the medium's own draws and one uniform number per tentative collision.
#[inline]
pub fn sample<R: Real, M: Medium<R>>(
    medium: &M,
    ray: &Ray<R>,
    t_max: R,
    rng: &mut impl Stream<R>,
    active: R::Mask,
) -> WeightedFlight<R> {
    let mut state = Weighted::idle(medium);
    Process::<R, M>::begin(&mut state, medium, ray, t_max, rng, active);
    state.run(medium, rng);
    state.flight()
}
