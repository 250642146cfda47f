//! An exponential atmosphere: extinction that falls by a constant factor per height.
//!
//! ```text
//! σ_t(x) = σ₀ e^(−κ·x);   on a ray  σ₀ e^(−(h + kt)),  h = κ·o,  k = κ·d
//! ```
//!
//! κ points to where the air thins, and its length is one over the scale height. With s = σ₀ e^−h, the
//! extinction where the ray begins,
//!
//! ```text
//! τ(t) = s (1 − e^(−kt))/k,   distance to depth e:  t = −ln(1 − ke/s)/k,  never where ke ≥ s
//! ```
//!
//! both written with `exp_m1` and `ln_1p`, so that nothing cancels as k → 0. Towards denser air
//! (k < 0) s may underflow where the end of the ray does not: τ is then formed from its dense end, and
//! the distance from logarithms. For trackers the ray is cut where the extinction has doubled or
//! halved. Extinctions beyond the largest `f32` count as that.

use crate::majorant::Segment;
use crate::medium::{ClosedForm, Control, Controlled, ExtinctionError, Medium};
use crate::ray::{FAR, Ray};
use crate::real::Real;
use crate::stream::Stream;
use crate::vec3::Vec3;

/// An exponential atmosphere that fills space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Exponential {
    sigma_0: f32,
    falloff: [f32; 3],
}

/// A ray's exponent, and the piece of it at hand, per lane.
#[derive(Clone, Copy, Debug)]
pub struct ExponentialWalk<R> {
    h: R,
    k: R,
    t_exit: R,
    /// Bounds of the extinction on the piece, the lower first [1/length].
    ends: [R; 2],
}

impl Exponential {
    /// From the extinction at the origin [1/length] and the falloff κ [1/length].
    ///
    /// # Errors
    /// An extinction that is negative or not finite, or a falloff that is not finite.
    pub fn new(sigma_0: f32, falloff: [f32; 3]) -> Result<Self, ExtinctionError> {
        if !(sigma_0 >= 0.0 && sigma_0.is_finite()) {
            return Err(ExtinctionError(sigma_0));
        }
        match falloff.into_iter().find(|c| !c.is_finite()) {
            Some(bad) => Err(ExtinctionError(bad)),
            None => Ok(Self { sigma_0, falloff }),
        }
    }

    /// h and k of each lane's ray.
    #[inline(always)]
    fn exponent<R: Real>(&self, ray: &Ray<R>) -> (R, R) {
        let falloff = Vec3::splat(self.falloff);
        (falloff.dot(ray.origin), falloff.dot(ray.direction))
    }

    #[inline(always)]
    fn value<R: Real>(&self, exponent: R) -> R {
        if self.sigma_0 <= 0.0 {
            return R::zero();
        }
        // In two halves, as the factor may overflow or vanish where the product does not.
        let half = (exponent * R::splat(-0.5)).exp();
        (R::splat(self.sigma_0) * half * half).min(R::splat(f32::MAX))
    }

    /// The piece that begins at `from`.
    #[inline(always)]
    fn piece<R: Real>(
        &self,
        walk: &ExponentialWalk<R>,
        from: R,
        active: R::Mask,
    ) -> ExponentialWalk<R> {
        let (h, k) = (walk.h, walk.k);
        let steep = k.abs();
        let doubled = from + R::splat(core::f32::consts::LN_2) / steep;
        // Far above the air there is nothing to halve: one piece down to where a scale height has a
        // depth of e⁻⁶⁰.
        let dense = (R::splat(self.sigma_0) / steep).ln().max(R::zero());
        let thin = (h - (R::splat(60.0) + dense)) / steep;
        let next = R::select(k.lt(R::zero()), doubled.max(thin), doubled);
        // A piece too short to resolve must still end beyond where it begins.
        let next = next.max(from * R::splat(1.000_001)).min(R::splat(FAR));
        let start = self.value(h + k * from);
        let vacuum = R::splat(self.sigma_0).le(R::zero());
        let nothing = start.le(R::zero()) & (R::zero().le(k) | vacuum);
        // Nor is there anything to halve or double in what exceeds the largest number.
        let full = R::splat(f32::MAX).le(start);
        let saturated = full & k.le(R::zero());
        let ends = (R::splat(self.sigma_0).ln() - R::splat(88.0) - h) / steep;
        let next = R::select(full, next.max(ends.min(R::splat(FAR))), next);
        let straight = steep.eq(R::zero());
        let exit = R::select(nothing | saturated | straight, R::splat(FAR), next);
        let end = R::select(straight, start, self.value(h + k * exit));
        // The value is good to three units in the last place, but not monotone; a subnormal one to as many
        // of the smallest numbers.
        let (above, below) = (R::splat(1.0 + 1e-6), R::splat(1.0 - 1e-6));
        let grains = R::splat(f32::from_bits(4));
        let low = (start.min(end) * below - grains).max(R::zero());
        let high = (start.max(end) * above + grains).min(R::splat(f32::MAX));
        let high = R::select(vacuum, R::zero(), high);
        ExponentialWalk {
            t_exit: R::select(active, exit, walk.t_exit),
            ends: [
                R::select(active, low, walk.ends[0]),
                R::select(active, high, walk.ends[1]),
            ],
            ..*walk
        }
    }
}

impl<R: Real> Medium<R> for Exponential {
    type Walk = ExponentialWalk<R>;
    const ONE_SEGMENT: bool = false;
    const TIGHT: bool = false;

    #[inline(always)]
    fn idle(&self) -> ExponentialWalk<R> {
        let zero = R::zero();
        ExponentialWalk {
            h: zero,
            k: zero,
            t_exit: zero,
            ends: [zero; 2],
        }
    }
    #[inline(always)]
    fn begin(&self, walk: &mut ExponentialWalk<R>, ray: &Ray<R>, active: R::Mask) {
        let (h, k) = self.exponent(ray);
        walk.h = R::select(active, h, walk.h);
        walk.k = R::select(active, k, walk.k);
        *walk = self.piece(walk, R::zero(), active);
    }
    #[inline(always)]
    fn segment(&self, walk: &ExponentialWalk<R>) -> Segment<R> {
        Segment {
            majorant: walk.ends[1],
            t_exit: walk.t_exit,
        }
    }
    #[inline(always)]
    fn next_segment(&self, walk: &mut ExponentialWalk<R>, active: R::Mask) {
        *walk = self.piece(walk, walk.t_exit, active);
    }
    #[inline(always)]
    fn sigma_t(&self, walk: &ExponentialWalk<R>, t: R, _: &mut impl Stream<R>, _: R::Mask) -> R {
        // A distance may be rounded a hair out of the piece, the value not out of its bounds.
        let [low, high] = walk.ends;
        self.value(walk.h + walk.k * t).max(low).min(high)
    }
}

impl<R: Real> Controlled<R> for Exponential {
    #[inline(always)]
    fn control(&self, walk: &ExponentialWalk<R>) -> Control<R> {
        let [low, high] = walk.ends;
        // The mean of an exponential between its ends differs from theirs by little over a factor of two.
        Control {
            minimum: low,
            mean: low + (high - low) * R::splat(0.5),
        }
    }
}

impl<R: Real> ClosedForm<R> for Exponential {
    #[inline(always)]
    fn optical_depth(&self, ray: &Ray<R>, t: R) -> R {
        let (h, k) = self.exponent(ray);
        let steep = k.abs();
        let heights = steep * t;
        // (1 − e^(−|k|t))/|k|: as long as t where nothing thins.
        let length = -((-heights).exp_m1()) / steep;
        let length = R::select(heights.le(R::zero()), t, length);
        let densest = R::select(k.lt(R::zero()), h + k * t, h);
        // Where the dense end exceeds the largest number the depth need not. All factors are finite, so
        // that products with nothing are nothing.
        let (largest, sigma_0) = (R::splat(f32::MAX), R::splat(self.sigma_0));
        let half = (densest * R::splat(-0.5)).exp().min(largest);
        let sigma_t = self.value(densest);
        let too_dense = (sigma_0 * half).min(largest) * (half * length).min(largest);
        let depth = R::select(sigma_t.lt(largest), sigma_t * length, too_dense);
        R::select(R::zero().lt(sigma_0), depth, R::zero())
    }
    #[inline(always)]
    fn distance(&self, ray: &Ray<R>, depth: R) -> R {
        let never = R::splat(f32::INFINITY);
        let (h, k) = self.exponent(ray);
        let steep = k.abs();
        let sigma_0 = R::splat(self.sigma_0);
        // depth/s, in an order that passes no subnormal number on its way to a normal one.
        let half = (h * R::splat(0.5)).exp();
        let straight = depth * half / sigma_0 * half;
        let y = straight * steep;
        // Towards thinner air: −ln(1 − y)/k, up to y = 1.
        let thinning = R::select(
            y.lt(R::one()),
            y.min(R::splat(0.999_999_94)).neg_ln_1m(),
            never,
        );
        // Towards denser air: ln(1 + y)/|k|, from the logarithm of y where that is large.
        let ln_y = ((steep.ln() - sigma_0.ln()) + depth.ln()) + h;
        let dense = R::splat(20.0).lt(ln_y);
        let thickening = R::select(dense, ln_y, y.min(R::splat(1e30)).ln_1p());
        let bent = R::select(k.lt(R::zero()), thickening, thinning) / steep;
        // Below that ln(1 ± y) is y, which may have lost its digits where the distance has not.
        let t = R::select(R::splat(1e-9).lt(y), bent, straight);
        R::select(sigma_0.le(R::zero()), never, t)
    }
}
