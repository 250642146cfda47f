//! Line integrals along a ray: Algorithm 2 of [Raab, Seibert, Keller 2006].
//!
//! ```text
//! C = c_∂V T(t_max) + ∫₀^{t_max} c_V(t) T(t) dt
//! ```
//!
//! The part that passes without a tentative collision is taken exactly; the first tentative points of n
//! walks are n equidistant numbers with one random offset Δ, a *comb*, warped through the majorant
//! depth D = ∫σ̄ dt of the ray:
//!
//! ```text
//! p = 1 − e^−D,   uᵢ = p (i + Δ)/n,   first tentative point of walk i: majorant depth −ln(1 − uᵢ)
//! C ≈ e^−D c_∂V + (p/n) Σᵢ (score of walk i)
//! ```
//!
//! *Unbiased*: let m(u) be the expected score of a walk whose first number is u. Delta tracking gives
//! ∫₀¹ m du = C, and (1/n) Σᵢ ∫₀¹ m((i + Δ)/n) dΔ = ∫₀¹ m du, whatever the dependence between walks.
//! *Variance*: (1/n) E\[Var(score | u)\] + Var_Δ((1/n) Σ m(uᵢ)), the second term falling like 1/n² for m of
//! bounded variation. The gain over n independent walks is large where the first tentative point
//! decides, i.e. under tight bounds; hence the warp through the majorant segments.
//!
//! A comb may resonate with a periodic m, where independent walks would not; the mean stays right.

use crate::free_flight::delta::is_real;
use crate::majorant::{Stages, majorant_depth};
use crate::medium::Medium;
use crate::ray::Ray;
use crate::real::{Mask, Real};
use crate::stream::Stream;

/// One estimate of `C`, scored at real collisions, per active lane.
///
/// * `walks`: n ≥ 1, the same in all lanes. `t_max`: per lane, finite \[length\].
/// * `source`: c_V/σ_t at a distance, for the lanes of the mask; total for the others. For emission it
///   is j/σ_t, and what shines without extinction is missed: take [`tentative`] then.
/// * `boundary`: c_∂V, per lane.
///
/// Cost: a pass over the majorant segments without look-ups, then at most n ∫σ̄T dt look-ups. One draw
/// for the comb; a walk's further draws are those of delta tracking. Inactive lanes give zero.
#[expect(
    clippy::too_many_arguments,
    reason = "each is one thing of the formula; a struct would only rename them"
)]
#[inline]
pub fn collisions<R: Real, M: Medium<R>>(
    medium: &M,
    ray: &Ray<R>,
    t_max: R,
    walks: u32,
    mut source: impl FnMut(R, R::Mask) -> R,
    boundary: R,
    rng: &mut impl Stream<R>,
    active: R::Mask,
) -> R {
    let mut comb = Comb::new(medium, ray, t_max, walks, rng, active);
    let mut sum = R::zero();
    while let Some((mut stages, beyond)) = comb.next_walk(medium) {
        sum = sum + boundary.or_zero(beyond);
        while stages.tentative().any() {
            let lanes = stages.tentative();
            let (sigma_t, majorant) = if M::TIGHT {
                (R::zero(), R::zero())
            } else {
                stages.sigma_t(medium, rng)
            };
            let real = is_real::<R, M>(sigma_t, majorant, rng, lanes);
            if real.any() {
                sum = sum + source(stages.tracker.t(), real).or_zero(real);
            }
            stages.resolve::<M>(rng, lanes.and_not(real));
            let left = run_on(&mut stages, medium);
            sum = sum + boundary.or_zero(left);
        }
    }
    comb.total(boundary, sum)
}

/// One estimate of `C`, scored at every tentative point, per active lane.
///
/// A walk's weight w begins at 1; each tentative point scores w c_V/σ̄ and leaves w (1 − σ_t/σ̄), and the
/// end of the ray scores w c_∂V. So emission is found where nothing absorbs, and the variance is lower
/// than that of [`collisions`] at up to σ̄/σ_t times the look-ups. Points fall where the bound is
/// positive: a medium that shines must have one there, however thin, or its light is missed.
///
/// * `volume`: c_V at a distance, for the lanes of the mask; total for the others.
/// * `survival`: walks whose weight falls below play roulette, and survive with it; zero lets them walk
///   to the end, which on deep rays costs n ∫σ̄ dt look-ups.
///
/// Otherwise as [`collisions`]; no estimate below zero where c_V, c_∂V are not negative.
#[expect(
    clippy::too_many_arguments,
    reason = "each is one thing of the formula; a struct would only rename them"
)]
#[inline]
pub fn tentative<R: Real, M: Medium<R>>(
    medium: &M,
    ray: &Ray<R>,
    t_max: R,
    walks: u32,
    mut volume: impl FnMut(R, R::Mask) -> R,
    boundary: R,
    survival: f32,
    rng: &mut impl Stream<R>,
    active: R::Mask,
) -> R {
    let mut comb = Comb::new(medium, ray, t_max, walks, rng, active);
    let mut sum = R::zero();
    while let Some((mut stages, beyond)) = comb.next_walk(medium) {
        sum = sum + boundary.or_zero(beyond);
        let mut weight = R::one();
        while stages.tentative().any() {
            let lanes = stages.tentative();
            let (sigma_t, majorant) = stages.sigma_t(medium, rng);
            let score = volume(stages.tracker.t(), lanes) * weight / majorant;
            sum = sum + score.or_zero(lanes);
            let passing = R::one() - sigma_t / majorant;
            let factor = R::select(lanes, passing, R::one());
            weight = weight * factor;
            let threshold = R::splat(survival);
            weight = weight * crate::collision::roulette(weight, threshold, rng, lanes);
            stages.resolve::<M>(rng, lanes.and_not(weight.eq(R::zero())));
            let left = run_on(&mut stages, medium);
            sum = sum + (weight * boundary).or_zero(left);
        }
    }
    comb.total(boundary, sum)
}

/// Moves all walks to their next tentative point; the lanes that left their ray instead.
#[inline(always)]
fn run_on<R: Real, M: Medium<R>>(stages: &mut Stages<R, M::Walk>, medium: &M) -> R::Mask {
    let mut left = R::Mask::splat(false);
    while stages.tracking().any() {
        left = left | stages.advance(medium).left;
    }
    left
}

/// The first tentative points of n walks, in the order of the ray: one walk of the segments serves all.
struct Comb<R: Real, W> {
    /// Stands at the present tooth in each lane that has one.
    front: Stages<R, W>,
    /// Lanes that take part.
    active: R::Mask,
    /// Majorant depth of the present tooth.
    passed: R,
    /// e^−D and 1 − e^−D.
    reach: R,
    collides: R,
    /// 1 − Δ: small numbers, which decide about the far end, keep their digits.
    offset: R,
    tooth: u32,
    walks: u32,
}

impl<R: Real, W: Clone> Comb<R, W> {
    #[inline(always)]
    fn new<M: Medium<R, Walk = W>>(
        medium: &M,
        ray: &Ray<R>,
        t_max: R,
        walks: u32,
        rng: &mut impl Stream<R>,
        active: R::Mask,
    ) -> Self {
        let depth = majorant_depth(medium, ray, t_max, active);
        let active_ray = active & R::zero().lt(depth);
        let mut front = Stages::idle(medium);
        front.begin_towards(medium, ray, t_max, R::zero(), active_ray);
        Self {
            front,
            active,
            passed: R::zero(),
            reach: (-depth).exp(),
            collides: -((-depth).exp_m1()),
            offset: rng.uniform_fine(active_ray),
            tooth: 0,
            walks: walks.max(1),
        }
    }

    /// The majorant depth of a tooth.
    ///
    /// With v = 1 − Δ: u = p (i + 1 − v)/n, and 1 − u = e^−D + p (n − 1 − i + v)/n without cancellation.
    #[inline(always)]
    fn depth(&self, tooth: u32) -> R {
        let n = R::splat(self.walks as f32);
        let below = R::splat(tooth as f32) + (R::one() - self.offset);
        let above = R::splat((self.walks - 1 - tooth) as f32) + self.offset;
        let u = self.collides * below / n;
        let rest = self.reach + self.collides * above / n;
        let half = R::splat(0.5);
        let near = u.min(half).neg_ln_1m();
        let far = -(rest.max(R::splat(f32::MIN_POSITIVE)).ln());
        R::select(u.lt(half), near, far).max(R::zero())
    }

    /// A walk at its first tentative point, and the lanes in which that point was rounded beyond the end.
    #[inline(always)]
    fn next_walk<M: Medium<R, Walk = W>>(&mut self, medium: &M) -> Option<(Stages<R, W>, R::Mask)> {
        if self.tooth == self.walks || !self.active.any() {
            return None;
        }
        let depth = self.depth(self.tooth);
        // Lanes beyond the end stay there: teeth ascend.
        let on = self.front.tentative() | self.front.tracking();
        self.front
            .redirect((depth - self.passed).max(R::zero()), on);
        self.passed = depth;
        self.tooth += 1;
        while self.front.tracking().any() {
            self.front.advance(medium);
        }
        let beyond = self.active.and_not(self.front.tentative());
        Some((self.front.clone(), beyond))
    }

    #[inline(always)]
    fn total(&self, boundary: R, sum: R) -> R {
        let walks = R::splat(self.walks as f32);
        let total = self.reach * boundary + self.collides * sum / walks;
        total.or_zero(self.active)
    }
}
