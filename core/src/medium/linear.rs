//! Extinction that rises or falls linearly along a direction, and is zero where it would be negative.
//!
//! ```text
//! σ_t(x) = max(0, σ₀ + ∇·x);   on a ray  max(0, a + bt),  a = σ₀ + ∇·o,  b = ∇·d
//! ```
//!
//! Optical depth and its inverse have closed forms. Where a ≥ 0, τ = t (a + bt/2) up to where a
//! falling ramp ends, and the distance to depth e is
//!
//! ```text
//! t = 2e / (a + √(a² + 2be))
//! ```
//!
//! which does not cancel for either sign of b; no distance has depth e where a² + 2be < 0. The root is
//! formed from q = √(2|b|e) as √(a − q)·√(a + q) or by scaling, so that no square overflows. A ramp
//! that begins below zero begins at t₀ = −a/b: τ = b (t − t₀)²/2.
//!
//! For trackers the ray is cut where the ramp has doubled or halved, so bounds stay within a factor of
//! two, or within one mean free path, of what they bound, however long the ray.

use crate::majorant::Segment;
use crate::medium::{ClosedForm, Control, Controlled, ExtinctionError, Medium};
use crate::ray::{FAR, Ray};
use crate::real::{Mask, Real};
use crate::stream::Stream;
use crate::vec3::Vec3;

/// A linear ramp of extinction that fills space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Linear {
    offset: f32,
    gradient: [f32; 3],
}

/// A ray's ramp, and the piece of it at hand, per lane.
#[derive(Clone, Copy, Debug)]
pub struct LinearWalk<R> {
    a: R,
    b: R,
    t_exit: R,
    /// The ramp at both ends of the piece, the smaller first [1/length].
    ends: [R; 2],
}

impl Linear {
    /// From the extinction at the origin [1/length], which may be negative, and its gradient
    /// [1/length²].
    ///
    /// # Errors
    /// A coefficient that is not finite.
    pub fn new(offset: f32, gradient: [f32; 3]) -> Result<Self, ExtinctionError> {
        let all = [offset, gradient[0], gradient[1], gradient[2]];
        match all.into_iter().find(|c| !c.is_finite()) {
            Some(bad) => Err(ExtinctionError(bad)),
            None => Ok(Self { offset, gradient }),
        }
    }

    /// a and b of each lane's ray.
    #[inline(always)]
    fn ramp<R: Real>(&self, ray: &Ray<R>) -> (R, R) {
        let gradient = Vec3::splat(self.gradient);
        let a = R::splat(self.offset) + gradient.dot(ray.origin);
        (a, gradient.dot(ray.direction))
    }
}

/// max(0, a + bt), rounded alike for bounds and look-ups and hence monotone in t.
#[inline(always)]
fn value<R: Real>(a: R, b: R, t: R) -> R {
    (a + b * t).max(R::zero()).min(R::splat(f32::MAX))
}

impl<R: Real> LinearWalk<R> {
    /// The piece that begins at `from`.
    #[inline(always)]
    fn piece(&self, from: R, active: R::Mask) -> Self {
        let (a, b) = (self.a, self.b);
        let steep = b.abs();
        let start = value(a, b, from);
        let rising = R::zero().lt(b);
        // Twice or half of the ramp, or about one mean free path where it is nearly zero.
        let free = R::one() / steep.sqrt();
        let double = start / steep;
        let ahead = R::select(rising, double, double * R::splat(0.5)).max(free);
        // An empty beginning is one piece, an empty end another.
        let empty_until = R::select(rising, -a / b, R::splat(FAR));
        // Not where the beginning itself lies at the crossing, rounded, or underflown to zero.
        let empty = start.le(R::zero()) & from.lt(empty_until);
        let exit = R::select(empty, empty_until, from + ahead);
        // A piece too short to resolve must still end beyond where it begins.
        let exit = exit.max(from * R::splat(1.000_001)).min(R::splat(FAR));
        // Nor does what has reached the largest number grow any more.
        let full = rising & R::splat(f32::MAX).le(start);
        let goes_on = R::zero().lt(steep).and_not(full);
        let exit = R::select(goes_on, exit, R::splat(FAR));
        let end = value(a, b, exit);
        Self {
            t_exit: R::select(active, exit, self.t_exit),
            ends: [
                R::select(active, start.min(end), self.ends[0]),
                R::select(active, start.max(end), self.ends[1]),
            ],
            ..*self
        }
    }
}

impl<R: Real> Medium<R> for Linear {
    type Walk = LinearWalk<R>;
    const ONE_SEGMENT: bool = false;
    const TIGHT: bool = false;

    #[inline(always)]
    fn idle(&self) -> LinearWalk<R> {
        let zero = R::zero();
        LinearWalk {
            a: zero,
            b: zero,
            t_exit: zero,
            ends: [zero; 2],
        }
    }
    #[inline(always)]
    fn begin(&self, walk: &mut LinearWalk<R>, ray: &Ray<R>, active: R::Mask) {
        let (a, b) = self.ramp(ray);
        walk.a = R::select(active, a, walk.a);
        walk.b = R::select(active, b, walk.b);
        *walk = walk.piece(R::zero(), active);
    }
    #[inline(always)]
    fn segment(&self, walk: &LinearWalk<R>) -> Segment<R> {
        Segment {
            majorant: walk.ends[1],
            t_exit: walk.t_exit,
        }
    }
    #[inline(always)]
    fn next_segment(&self, walk: &mut LinearWalk<R>, active: R::Mask) {
        *walk = walk.piece(walk.t_exit, active);
    }
    #[inline(always)]
    fn sigma_t(&self, walk: &LinearWalk<R>, t: R, _: &mut impl Stream<R>, _: R::Mask) -> R {
        // A distance may be rounded a hair out of the piece, the value not out of its bounds.
        let [low, high] = walk.ends;
        value(walk.a, walk.b, t).max(low).min(high)
    }
}

impl<R: Real> Controlled<R> for Linear {
    #[inline(always)]
    fn control(&self, walk: &LinearWalk<R>) -> Control<R> {
        let [low, high] = walk.ends;
        Control {
            minimum: low,
            mean: low + (high - low) * R::splat(0.5),
        }
    }
}

impl<R: Real> ClosedForm<R> for Linear {
    #[inline(always)]
    fn optical_depth(&self, ray: &Ray<R>, t: R) -> R {
        let (zero, half) = (R::zero(), R::splat(0.5));
        let (a, b) = self.ramp(ray);
        let crossing = -(a / b);
        // Where it begins at zero or above; a falling ramp counts up to its end.
        let end = R::select(b.lt(zero), t.min(crossing), t);
        let from_above = end * (a + b * half * end);
        // Where it begins below: only a rising ramp ever leaves zero.
        let since = (t - crossing).max(zero);
        let from_below = R::select(zero.lt(b), b * half * since * since, zero);
        R::select(a.lt(zero), from_below, from_above)
    }
    #[inline(always)]
    fn distance(&self, ray: &Ray<R>, depth: R) -> R {
        let zero = R::zero();
        let never = R::splat(f32::INFINITY);
        let (a, b) = self.ramp(ray);
        let twice = depth + depth;
        let q = b.abs().sqrt() * twice.sqrt();
        // √(a² + 2be): from factors where it falls, scaled by the larger where it rises.
        let falling = (a - q).max(zero).sqrt() * (a + q).sqrt();
        let m = a.max(q).max(R::splat(f32::MIN_POSITIVE));
        let (u, v) = (a / m, q / m);
        let rising = m * (u * u + v * v).sqrt();
        let root = R::select(b.lt(zero), falling, rising);
        let from_above = R::select(b.lt(zero) & a.lt(q), never, twice / (a + root));
        let from_below = R::select(zero.lt(b), -(a / b) + twice.sqrt() / b.sqrt(), never);
        R::select(a.lt(zero), from_below, from_above)
    }
}
