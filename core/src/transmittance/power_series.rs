//! Unbiased ray marching: a power series about a jittered estimate, of random order.
//!
//! ```text
//! T = e^X₀ Σ_k E[X − X₀]^k / k!,   X = −(estimate of τ from a comb of M points)
//! ```
//!
//! X₀ is one such estimate, and the powers of what it misses come from further independent ones,
//! X₁ … X_N, each power k as the mean of all products of k of them (U-statistics: elementary symmetric
//! polynomials over binomials). The order N is random and unbounded: N = 0 with probability 0.9, else
//! N ≥ 2 with P(N ≥ k) = P(N ≥ k − 1) · 2/k, so that k! P(N ≥ k) = 2^(k−1)/10. Each of X₀ … X_N serves as the
//! pivot in turn, and the results are averaged:
//!
//! ```text
//! T̂ = mean_i e^{X_i} Σ_{k ≤ N} m_k(X_j − X_i, j ≠ i) / (k! P(N ≥ k)),   M ≈ ∛((0.015 + s)(0.65 + s)(60.3 + s))/1.31945
//! ```
//!
//! with s the range that X can have. Not truncated: beyond eleven further estimates the powers go on as
//! plain products, which have the same expectation and need no memory. Estimates may be negative, and
//! exceed one.
//!
//! A comb may be spaced equally in distance ([`Distance`]), where s = (max σ̄ − min c) L with c the known
//! minimum; or in the depth ∫(σ̄ − c) dt of what is unknown ([`Depth`]), which is then s, ∫c dt being added
//! exactly. The former is far better on smooth media, where its error falls with a high power of M; the
//! latter skips empty space, and is exact where the bound is the extinction. Mean number of look-ups:
//! M (1 + E N) = M (1 + (e² − 1)/20) = 1.319 M. Source: [Kettunen 2021], which truncates nothing either;
//! its constants.

use crate::majorant::{Stages, for_each_segment, majorant_depth};
use crate::medium::{Controlled, Medium};
use crate::ray::{FAR, Ray};
use crate::real::{Mask, Real};
use crate::stream::Stream;
use crate::sum::Compensated;
use crate::transmittance::delta;
use crate::transmittance::residual_ratio::{Minimum, Residual};

/// How the points of a comb are spaced along the ray.
pub trait Spacing: 'static {
    /// An unbiased estimate of the optical depth from `points` look-ups, a whole number per lane.
    fn optical_depth<R: Real, M: Controlled<R>>(
        medium: &M,
        ray: &Ray<R>,
        t_max: R,
        points: R,
        rng: &mut impl Stream<R>,
        active: R::Mask,
    ) -> R;
    /// How far two such estimates can lie apart.
    fn spread<R: Real, M: Controlled<R>>(medium: &M, ray: &Ray<R>, t_max: R, active: R::Mask) -> R;
}

/// Points equidistant along the ray.
#[derive(Clone, Copy, Debug)]
pub struct Distance;

/// Points equidistant in ∫(σ̄ − c) dt: none in empty space, nor where everything is known.
#[derive(Clone, Copy, Debug)]
pub struct Depth;

impl Spacing for Distance {
    #[inline(always)]
    fn optical_depth<R: Real, M: Controlled<R>>(
        medium: &M,
        ray: &Ray<R>,
        t_max: R,
        points: R,
        rng: &mut impl Stream<R>,
        active: R::Mask,
    ) -> R {
        comb_in_distance(medium, ray, t_max, points, rng, active)
    }
    #[inline(always)]
    fn spread<R: Real, M: Controlled<R>>(medium: &M, ray: &Ray<R>, t_max: R, active: R::Mask) -> R {
        let (mut low, mut high) = (R::splat(f32::INFINITY), R::zero());
        for_each_segment(medium, ray, t_max, active, |walk, majorant, _, lanes| {
            high = R::select(lanes, high.max(majorant), high);
            low = R::select(lanes, low.min(medium.control(walk).minimum), low);
        });
        (high - low.min(high)).max(R::zero()) * t_max
    }
}

impl Spacing for Depth {
    #[inline(always)]
    fn optical_depth<R: Real, M: Controlled<R>>(
        medium: &M,
        ray: &Ray<R>,
        t_max: R,
        points: R,
        rng: &mut impl Stream<R>,
        active: R::Mask,
    ) -> R {
        comb_in_depth(medium, ray, t_max, points, rng, active)
    }
    #[inline(always)]
    fn spread<R: Real, M: Controlled<R>>(medium: &M, ray: &Ray<R>, t_max: R, active: R::Mask) -> R {
        majorant_depth(&Residual::<M, Minimum>::new(medium), ray, t_max, active)
    }
}

/// (L/M) Σ σ_t((i + ξ) L/M) for i < M: an unbiased estimate of the optical depth. One draw and the
/// medium's own.
///
/// * `points`: M ≥ 1, a whole number per lane.
#[inline]
pub(crate) fn comb_in_distance<R: Real, M: Medium<R>>(
    medium: &M,
    ray: &Ray<R>,
    t_max: R,
    points: R,
    rng: &mut impl Stream<R>,
    active: R::Mask,
) -> R {
    let t_max = t_max.min(R::splat(FAR));
    let mut lanes = active & R::zero().lt(t_max);
    let mut walk = medium.idle();
    medium.begin(&mut walk, ray, lanes);
    let step = t_max / points;
    let mut tooth = R::zero();
    let offset = rng.uniform(lanes);
    let mut sum = Compensated::zero();
    while lanes.any() {
        let t = ((tooth + offset) * step).min(t_max);
        if !M::ONE_SEGMENT {
            loop {
                let behind = medium.segment(&walk).t_exit.lt(t) & lanes;
                if !behind.any() {
                    break;
                }
                medium.next_segment(&mut walk, behind);
            }
        }
        let sigma_t = medium.sigma_t(&walk, t, rng, lanes);
        sum = Compensated::select(lanes, sum.plus(sigma_t), sum);
        tooth = tooth + R::one();
        lanes = lanes & tooth.lt(points);
    }
    sum.high * step
}

/// ∫c dt + (D/M) Σ (σ_t − c)/(σ̄ − c) at the depths (i + ξ) D/M for i < M, D = ∫(σ̄ − c) dt the whole ray's.
#[inline]
fn comb_in_depth<R: Real, M: Controlled<R>>(
    medium: &M,
    ray: &Ray<R>,
    t_max: R,
    points: R,
    rng: &mut impl Stream<R>,
    active: R::Mask,
) -> R {
    let unknown = Residual::<M, Minimum>::new(medium);
    let (mut known, mut depth) = (R::zero(), R::zero());
    for_each_segment(&unknown, ray, t_max, active, |walk, rate, length, lanes| {
        let minimum = medium.control(walk).minimum;
        known = R::select(lanes, known + minimum * length, known);
        depth = R::select(lanes, depth + rate * length, depth);
    });
    let lanes = active & R::zero().lt(depth);
    if !lanes.any() {
        return known;
    }
    let step = depth / points;
    let offset = rng.uniform(lanes);
    let mut stages = Stages::idle(medium);
    stages.begin_towards(&unknown, ray, t_max, offset * step, lanes);
    let mut tooth = R::zero();
    let mut sum = Compensated::zero();
    loop {
        // The last point may be rounded beyond the end, with a chance of about 1e-7; it is then missed.
        while stages.tracking().any() {
            stages.advance(&unknown);
        }
        let lanes = stages.tentative();
        if !lanes.any() {
            return known + sum.high * step;
        }
        let (rest, rate) = stages.sigma_t(&unknown, rng);
        sum = Compensated::select(lanes, sum.plus(rest / rate), sum);
        tooth = tooth + R::one();
        let on = lanes & tooth.lt(points);
        stages.redirect(step, on);
        stages.finish(lanes.and_not(on));
    }
}

/// Estimates that serve as pivots, and whose powers are averaged over all products.
const PIVOTS: usize = 12;

/// Beyond this spread powers of `f32` could overflow; delta tracking takes over.
const LARGEST_SPREAD: f32 = 64.0;

/// M for a spread: a whole number, at least one.
#[inline(always)]
fn points<R: Real>(spread: R) -> R {
    let s = spread;
    let product = (s + R::splat(0.015)) * (s + R::splat(0.65)) * (s + R::splat(60.3));
    let cube_root = (product.ln() * R::splat(1.0 / 3.0)).exp();
    let whole = |x: R| R::from_word(x.to_word());
    let ceiling = whole(cube_root + R::splat(0.999_999));
    whole(ceiling * R::splat(1.0 / 1.319_45) + R::splat(0.5)).max(R::one())
}

/// One sample of the transmittance of `[0, t_max)` of each active lane's ray, of any sign; average many.
///
/// * `S`: [`Distance`] or [`Depth`].
///
/// Where the spread s exceeds 64, which is known before anything is drawn, the estimate is that of
/// [`delta`]: powers of differences that large would overflow.
#[inline]
pub fn estimate<S: Spacing, R: Real, M: Controlled<R>>(
    medium: &M,
    ray: &Ray<R>,
    t_max: R,
    rng: &mut impl Stream<R>,
    active: R::Mask,
) -> R {
    let spread = S::spread(medium, ray, t_max, active);
    let moderate = spread.le(R::splat(LARGEST_SPREAD)) & active;
    let steep = active.and_not(moderate);
    let mut result = R::zero();
    if steep.any() {
        result = delta::estimate(medium, ray, t_max, rng, steep);
    }
    if moderate.any() {
        let points = points(spread.min(R::splat(LARGEST_SPREAD)));
        let series = series::<S, R, M>(medium, ray, t_max, points, rng, moderate);
        result = R::select(moderate, series, result);
    }
    result
}

/// X = −τ, estimated. A depth that overflows is a finite one whose exponential is zero as well, so that
/// differences are numbers.
#[inline]
fn estimate_of_ln<S: Spacing, R: Real, M: Controlled<R>>(
    medium: &M,
    ray: &Ray<R>,
    t_max: R,
    points: R,
    rng: &mut impl Stream<R>,
    active: R::Mask,
) -> R {
    let depth = S::optical_depth(medium, ray, t_max, points, rng, active);
    -(depth.min(R::splat(f32::MAX)))
}

#[inline]
fn series<S: Spacing, R: Real, M: Controlled<R>>(
    medium: &M,
    ray: &Ray<R>,
    t_max: R,
    points: R,
    rng: &mut impl Stream<R>,
    active: R::Mask,
) -> R {
    let longer = rng.uniform_fine(active).lt(R::splat(0.1)) & active;
    let first = estimate_of_ln::<S, R, M>(medium, ray, t_max, points, rng, active);
    if !longer.any() {
        return first.exp();
    }
    // X₀, X₁, … of each lane, and how many it has.
    let mut all = [R::zero(); PIVOTS];
    let mut count = R::one();
    let mut going = longer;
    for (k, x) in all.iter_mut().enumerate() {
        if k == 0 {
            *x = first;
            continue;
        }
        if k > 2 {
            going = goes_on::<R>(k as f32, rng, going);
        }
        if !going.any() {
            break;
        }
        *x = estimate_of_ln::<S, R, M>(medium, ray, t_max, points, rng, going);
        count = R::select(going, count + R::one(), count);
    }
    let mut sum = R::zero();
    let mut highest = [R::zero(); PIVOTS];
    let mut index = R::zero();
    for (pivot, highest) in all.iter().zip(&mut highest) {
        let mine = index.lt(count);
        if mine.any() {
            let (series, top) = about(*pivot, index, &all, count);
            sum = R::select(mine, sum + series, sum);
            *highest = top;
        }
        index = index + R::one();
    }
    // Further powers, rarely: one more factor each.
    let mut k = PIVOTS as f32;
    loop {
        going = goes_on::<R>(k, rng, going);
        if !going.any() {
            return sum / count;
        }
        let x = estimate_of_ln::<S, R, M>(medium, ray, t_max, points, rng, going);
        for (pivot, highest) in all.iter().zip(&mut highest) {
            // The factor 1/2 is that of k! P(N ≥ k) over its predecessor.
            *highest = *highest * (x - *pivot) * R::splat(0.5);
            sum = R::select(going, sum + *highest, sum);
        }
        k += 1.0;
    }
}

/// The lanes of `going` whose order reaches k > 2.
#[inline(always)]
fn goes_on<R: Real>(k: f32, rng: &mut impl Stream<R>, going: R::Mask) -> R::Mask {
    (rng.uniform_fine(going) * R::splat(k)).lt(R::splat(2.0)) & going
}

/// The series about one pivot, e^{X_i} Σ_k m_k/(k! P(N ≥ k)) over the other `count − 1` estimates, and its
/// last term.
#[inline(always)]
fn about<R: Real>(pivot: R, index: R, all: &[R; PIVOTS], count: R) -> (R, R) {
    // Elementary symmetric polynomials of the differences, scaled by e^{X_i} so that nothing overflows.
    let mut symmetric = [R::zero(); PIVOTS];
    symmetric[0] = pivot.exp();
    let mut j = R::zero();
    for x in all {
        let other = j.lt(count).and_not(j.eq(index));
        let difference = (*x - pivot).or_zero(other);
        let mut lower = symmetric[0];
        for power in symmetric.iter_mut().skip(1) {
            let old = *power;
            *power = old + difference * lower;
            lower = old;
        }
        j = j + R::one();
    }
    let others = count - R::one();
    let (mut binomial, mut inverse) = (R::one(), R::splat(20.0));
    let (mut sum, mut last) = (symmetric[0], symmetric[0]);
    let mut k = R::one();
    for power in symmetric.iter().skip(1) {
        // C(n, k) from C(n, k − 1), and 1/(k! P(N ≥ k)) = 10/2^(k − 1).
        binomial = binomial * (others - k + R::one()) / k;
        inverse = inverse * R::splat(0.5);
        let counts = k.le(others);
        last = (*power / binomial.max(R::one()) * inverse).or_zero(counts);
        sum = sum + last;
        k = k + R::one();
    }
    (sum, last)
}
