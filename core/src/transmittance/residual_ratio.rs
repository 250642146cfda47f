//! Residual ratio tracking: a control is integrated exactly, only the rest is left to chance.
//!
//! ```text
//! T = exp(−∫c dt) · E[ ∏ᵢ (1 − (σ_t(tᵢ) − c)/r) ],  tᵢ the events of a Poisson process of rate r
//! ```
//!
//! with a control c and a rate r ≥ |σ_t − c| on each segment. Unbiased for any of them. Relative
//! variance exp(∫(σ_t − c)²/r) − 1, mean cost ∫r dt look-ups: both vanish as the control nears the
//! extinction. With the segment's minimum as control factors lie in [0, 1]; with its mean, r may be
//! half as large and the variance smaller still, and factors lie in [0, 2]. Source: [Novák, Selle,
//! Jarosz 2014].

use core::marker::PhantomData;

use crate::majorant::{Process, Segment, Stages};
use crate::medium::{Control, Controlled, Medium};
use crate::ray::{FAR, Ray};
use crate::real::{Mask, Real};
use crate::stream::Stream;
use crate::sum::Compensated;
use crate::transmittance::Rule;
use crate::transmittance::ratio::Ratio;

/// Which control a segment has.
pub trait Choice: Clone + 'static {
    /// The control, between the minimum and the majorant [1/length].
    fn control<R: Real>(known: Control<R>, majorant: R) -> R;
}

/// The segment's minimum: factors lie in [0, 1].
#[derive(Clone, Copy, Debug)]
pub struct Minimum;

impl Choice for Minimum {
    #[inline(always)]
    fn control<R: Real>(known: Control<R>, _: R) -> R {
        known.minimum
    }
}

/// The segment's mean: fewer look-ups and less variance.
#[derive(Clone, Copy, Debug)]
pub struct Mean;

impl Choice for Mean {
    #[inline(always)]
    fn control<R: Real>(known: Control<R>, majorant: R) -> R {
        known.mean.max(known.minimum).min(majorant)
    }
}

/// What is left of a medium when its control is taken away: rates r instead of bounds, and σ_t − c,
/// of either sign, instead of extinction.
///
/// Only [`Ratio`] may collide with it; [`check_work`](crate::majorant::check_work) of it tells what
/// residual ratio tracking costs.
#[derive(Debug)]
pub struct Residual<'a, M, C> {
    medium: &'a M,
    choice: PhantomData<C>,
}

impl<'a, M, C: Choice> Residual<'a, M, C> {
    /// Of a medium.
    #[inline(always)]
    pub fn new(medium: &'a M) -> Self {
        Self {
            medium,
            choice: PhantomData,
        }
    }

    #[inline(always)]
    fn control<R: Real>(&self, walk: &M::Walk) -> R
    where
        M: Controlled<R>,
    {
        C::control(
            self.medium.control(walk),
            self.medium.segment(walk).majorant,
        )
    }
}

impl<R: Real, M: Controlled<R>, C: Choice> Medium<R> for Residual<'_, M, C> {
    type Walk = M::Walk;
    const ONE_SEGMENT: bool = M::ONE_SEGMENT;
    const TIGHT: bool = false;

    #[inline(always)]
    fn idle(&self) -> M::Walk {
        self.medium.idle()
    }
    #[inline(always)]
    fn begin(&self, walk: &mut M::Walk, ray: &Ray<R>, active: R::Mask) {
        self.medium.begin(walk, ray, active);
    }
    #[inline(always)]
    fn segment(&self, walk: &M::Walk) -> Segment<R> {
        let Segment { majorant, t_exit } = self.medium.segment(walk);
        let known = self.medium.control(walk);
        let control = C::control(known, majorant);
        Segment {
            majorant: (majorant - control).max(control - known.minimum),
            t_exit,
        }
    }
    #[inline(always)]
    fn next_segment(&self, walk: &mut M::Walk, active: R::Mask) {
        self.medium.next_segment(walk, active);
    }
    #[inline(always)]
    fn sigma_t(&self, walk: &M::Walk, t: R, rng: &mut impl Stream<R>, active: R::Mask) -> R {
        self.medium.sigma_t(walk, t, rng, active) - self.control(walk)
    }
}

/// Estimates under way, one per lane. As a result: the weights.
#[derive(Clone, Debug)]
pub struct ResidualRatio<R: Real, W, C> {
    stages: Stages<R, W>,
    weight: R,
    control_depth: Compensated<R>,
    choice: PhantomData<C>,
}

impl<R: Real, W: Clone, C: Choice> ResidualRatio<R, W, C> {
    /// No estimate yet in any lane.
    #[inline(always)]
    pub fn idle<M: Medium<R, Walk = W>>(medium: &M) -> Self {
        Self {
            stages: Stages::idle(medium),
            weight: R::zero(),
            control_depth: Compensated::zero(),
            choice: PhantomData,
        }
    }
}

impl<R: Real, M: Controlled<R>, C: Choice> Process<R, M> for ResidualRatio<R, M::Walk, C> {
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
        let residual = Residual::<M, C>::new(medium);
        self.stages.begin(&residual, ray, t_max, rng, active);
        self.weight = R::select(active, R::one(), self.weight);
        self.control_depth = Compensated::select(active, Compensated::zero(), self.control_depth);
    }
    #[inline(always)]
    fn advance(&mut self, medium: &M) {
        let residual = Residual::<M, C>::new(medium);
        let lanes = self.stages.tracking();
        let control = residual.control::<R>(&self.stages.tracker.walk);
        let length = self.stages.advance(&residual).length;
        // Steps may be many and small: a plain sum of 10⁷ of them loses some per cent. None overflows it.
        let step = (control * length).min(R::splat(FAR));
        let depth = self.control_depth.plus(step);
        self.control_depth = Compensated::select(lanes, depth, self.control_depth);
    }
    #[inline(always)]
    fn collide(&mut self, medium: &M, rng: &mut impl Stream<R>) {
        let residual = Residual::<M, C>::new(medium);
        let lanes = self.stages.tentative();
        let (rest, rate) = self.stages.sigma_t(&residual, rng);
        self.weight = Ratio::collide::<R, Residual<'_, M, C>>(self.weight, rest, rate, rng, lanes);
        // Weight and depth of a deep ray may both leave the range of numbers where their product does not:
        // 2⁶⁴ of the one, 64 ln 2 of the other.
        let large = R::splat(18_446_744_073_709_551_616.0).lt(self.weight) & lanes;
        if large.any() {
            let smaller = self.weight * R::splat(1.0 / 18_446_744_073_709_551_616.0);
            let less = R::splat(-64.0 * core::f32::consts::LN_2);
            let shallower = self.control_depth.plus(less);
            self.weight = R::select(large, smaller, self.weight);
            self.control_depth = Compensated::select(large, shallower, self.control_depth);
        }
        // A weight of zero completes its estimate.
        let onward = lanes.and_not(self.weight.eq(R::zero()));
        self.stages.resolve::<Residual<'_, M, C>>(rng, onward);
    }
    #[inline(always)]
    fn result(&self) -> R {
        self.weight * (-self.control_depth.high).exp()
    }
}

/// One sample of the transmittance of `[0, t_max)` of each active lane's ray; average many.
///
/// * `C`: [`Mean`] or [`Minimum`].
///
/// Draws an exponential and the medium's own draws per tentative collision. Where the medium's control
/// is exact (homogeneous, constant segments) it draws one exponential, looks up nothing, and is exact.
#[inline]
pub fn estimate<C: Choice, R: Real, M: Controlled<R>>(
    medium: &M,
    ray: &Ray<R>,
    t_max: R,
    rng: &mut impl Stream<R>,
    active: R::Mask,
) -> R {
    let mut state = ResidualRatio::<R, M::Walk, C>::idle(medium);
    Process::<R, M>::begin(&mut state, medium, ray, t_max, rng, active);
    Process::<R, M>::run(&mut state, medium, rng);
    Process::<R, M>::result(&state)
}
