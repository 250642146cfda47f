//! Free flights of all wavelengths together: delta tracking whose decisions leave weights.
//!
//! ```text
//! E[w_λ · 1(leaves)] = e^−τ_λ(t_max),   E[w_λ · 1(collides before s)] = 1 − e^−τ_λ(s)
//! ```
//!
//! The distances follow no wavelength's law by themselves, their weighted frequencies follow each one's.
//! Mean cost: ∫σ̄ P(not yet collided) dt look-ups.

use crate::free_flight::Flight;
use crate::majorant::{Process, Stages};
use crate::ray::Ray;
use crate::real::{Mask, Real};
use crate::spectral::{Decision, SpectralMedium, Spectrum, Tentative};
use crate::stream::Stream;

/// A sampled flight, per lane.
#[derive(Clone, Copy, Debug)]
pub struct SpectralFlight<R: Real, const N: usize> {
    /// Where it ended, and whether in a real collision.
    pub flight: Flight<R>,
    /// What each wavelength's contribution is multiplied with.
    pub weight: Spectrum<R, N>,
}

/// Flights under way, one per lane. As a result: the distance to the collision, infinite without one;
/// the weights come with [`flight`](Self::flight).
#[derive(Clone, Debug)]
pub struct Flights<R: Real, W, D, const N: usize> {
    stages: Stages<R, W>,
    collided: R::Mask,
    decision: D,
}

impl<R: Real, W: Clone, D: Decision<R, N>, const N: usize> Flights<R, W, D, N> {
    /// No flight yet in any lane.
    #[inline(always)]
    pub fn idle<M: SpectralMedium<R, N, Walk = W>>(medium: &M, decision: D) -> Self {
        const { assert!(!M::TIGHT, "coloured media have null collisions") };
        Self {
            stages: Stages::idle(medium),
            collided: R::Mask::splat(false),
            decision,
        }
    }

    /// The next flights of the paths of the active lanes, which keep their weights and their heroes.
    ///
    /// * `ray`, `t_max`: as of [`sample`].
    #[inline(always)]
    pub fn onward<M: SpectralMedium<R, N, Walk = W>>(
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

    /// The flights so far; final for lanes in neither stage.
    #[inline(always)]
    pub fn flight(&self) -> SpectralFlight<R, N> {
        SpectralFlight {
            flight: Flight {
                t: self.stages.tracker.t(),
                collided: self.collided,
            },
            weight: self.decision.weight(),
        }
    }
}

impl<R, M, D, const N: usize> Process<R, M> for Flights<R, M::Walk, D, N>
where
    R: Real,
    M: SpectralMedium<R, N>,
    D: Decision<R, N>,
{
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
        self.decision.begin(rng, active);
        self.onward(medium, ray, t_max, rng, active);
    }
    #[inline(always)]
    fn collide(&mut self, medium: &M, rng: &mut impl Stream<R>) {
        let lanes = self.stages.tentative();
        let event = tentative(&self.stages, medium, rng);
        let real = self.decision.decide(&event, rng, lanes);
        self.collided = self.collided | real;
        self.stages.resolve::<M>(rng, lanes.and_not(real));
    }
    #[inline(always)]
    fn result(&self) -> R {
        let Flight { t, collided } = self.flight().flight;
        R::select(collided, t, R::splat(f32::INFINITY))
    }
}

/// The tentative collisions at which lanes stand.
#[inline(always)]
pub(super) fn tentative<R: Real, M: SpectralMedium<R, N>, const N: usize>(
    stages: &Stages<R, M::Walk>,
    medium: &M,
    rng: &mut impl Stream<R>,
) -> Tentative<R, N> {
    let (sigma_t, majorant) = stages.sigma_t(medium, rng);
    let tracker = &stages.tracker;
    Tentative {
        sigma_t,
        majorant,
        colour: medium.colour(&tracker.walk, tracker.t()),
    }
}

/// Samples one flight on `[0, t_max)` of each active lane's ray, under a way to decide.
///
/// * `ray`: per lane, world space; its part `[0, t_max)` must lie in the medium's domain.
/// * `t_max`: per lane \[length\].
///
/// Inactive lanes get t = 0 and no collision, and draw nothing.
#[inline(always)]
pub fn sample<R: Real, const N: usize, M: SpectralMedium<R, N>>(
    medium: &M,
    decision: impl Decision<R, N>,
    ray: &Ray<R>,
    t_max: R,
    rng: &mut impl Stream<R>,
    active: R::Mask,
) -> SpectralFlight<R, N> {
    let mut state = Flights::idle(medium, decision);
    Process::<R, M>::begin(&mut state, medium, ray, t_max, rng, active);
    state.run(medium, rng);
    state.flight()
}
