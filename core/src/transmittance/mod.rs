//! Transmittance: the probability T = e^−τ of passing a stretch of a ray without a collision.
//!
//! Each file has one estimator with a function `estimate`; the registry
//! [`for_each_transmittance`](crate::for_each_transmittance) names them for tests and benches. The
//! estimators by tracking differ only in what a tentative collision does to the weight, a
//! [`Rule`]; the walk is shared.
//!
//! | estimator | unbiased | relative variance | look-ups | estimates |
//! |---|---|---|---|---|
//! | [`analytic`] | yes | 0 | 0 | exact |
//! | [`regular`] | yes | 0 | 0 (visits every cell) | exact |
//! | [`delta`] | yes | e^τ − 1 | ∫σ̄T dt | 0 or 1 |
//! | [`ratio`] | yes | exp(∫σ_t²/σ̄ dt) − 1 | ∫σ̄ dt | in \[0, 1\] |
//! | [`residual_ratio`] | yes | exp(∫(σ_t − c)²/r dt) − 1 | ∫r dt, r ≥ \|σ_t − c\| | not negative |
//! | [`comb`] | yes | below delta's over n | at most n ∫σ̄T dt | in \[0, 1\] |
//! | [`power_series`] | yes | falls fast with the number of points | about τ̄ + 4 | any sign |
//! | [`ray_marching`] | **BIASED** | small | n | in (0, 1\] |
//!
//! Take closed forms where there are any. On grids residual ratio tracking is the safe choice, and
//! power series win on smooth or noisy media that fill the ray; delta tracking where only the
//! visibility of opaque media matters.

pub mod analytic;
pub mod comb;
pub mod delta;
pub mod power_series;
pub mod ratio;
pub mod ray_marching;
pub mod regular;
pub mod residual_ratio;

use core::marker::PhantomData;

use crate::majorant::{Process, Stages};
use crate::medium::Medium;
use crate::ray::Ray;
use crate::real::{Mask, Real};
use crate::stream::Stream;

/// Calls `$row!(name)` for each file of this folder that holds an unbiased estimator.
#[macro_export]
macro_rules! for_each_transmittance {
    ($row:ident) => {
        $row!(analytic);
        $row!(comb);
        $row!(delta);
        $row!(power_series);
        $row!(ratio);
        $row!(regular);
        $row!(residual_ratio);
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

/// Estimates under a rule, one per lane. As a result: the weights.
#[derive(Clone, Debug)]
pub struct Estimate<R: Real, W, U> {
    stages: Stages<R, W>,
    weight: R,
    rule: PhantomData<U>,
}

impl<R: Real, W: Clone, U: Rule> Estimate<R, W, U> {
    /// No estimate yet in any lane.
    #[inline(always)]
    pub fn idle<M: Medium<R, Walk = W>>(medium: &M) -> Self {
        Self {
            stages: Stages::idle(medium),
            weight: R::zero(),
            rule: PhantomData,
        }
    }
}

impl<R: Real, M: Medium<R>, U: Rule> Process<R, M> for Estimate<R, M::Walk, U> {
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
        self.weight = R::select(active, R::one(), self.weight);
    }
    #[inline(always)]
    fn collide(&mut self, medium: &M, rng: &mut impl Stream<R>) {
        let lanes = self.stages.tentative();
        let (sigma_t, majorant) = self.stages.sigma_t(medium, rng);
        self.weight = U::collide::<R, M>(self.weight, sigma_t, majorant, rng, lanes);
        // A weight of zero completes its estimate.
        let onward = lanes.and_not(self.weight.eq(R::zero()));
        self.stages.resolve::<M>(rng, onward);
    }
    #[inline(always)]
    fn result(&self) -> R {
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
    let mut state = Estimate::<R, M::Walk, U>::idle(medium);
    Process::<R, M>::begin(&mut state, medium, ray, t_max, rng, active);
    state.run(medium, rng);
    Process::<R, M>::result(&state)
}
