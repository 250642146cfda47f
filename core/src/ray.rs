//! Rays and the intervals on them.

use crate::real::Real;
use crate::vec3::Vec3;

/// A half-line per lane.
#[derive(Clone, Copy, Debug)]
pub struct Ray<R> {
    /// Where it begins \[length\].
    pub origin: Vec3<R>,
    /// Unit direction, so that `t` is a length.
    pub direction: Vec3<R>,
}

impl<R: Real> Ray<R> {
    /// The point at distance `t`.
    #[inline(always)]
    pub fn at(&self, t: R) -> Vec3<R> {
        self.origin + self.direction * t
    }
    /// `if_true` where the mask holds, else `if_false`.
    #[inline(always)]
    pub fn select(mask: R::Mask, if_true: &Self, if_false: &Self) -> Self {
        Self {
            origin: Vec3::select(mask, if_true.origin, if_false.origin),
            direction: Vec3::select(mask, if_true.direction, if_false.direction),
        }
    }
}

/// A part [`t0`, `t1`] of a ray; empty where `t1 ≤ t0`.
#[derive(Clone, Copy, Debug)]
pub struct Interval<R> {
    /// Where it begins \[length\].
    pub t0: R,
    /// Where it ends \[length\].
    pub t1: R,
}

/// Larger than any scene: "no end". Walks end there, even on rays that are longer.
pub const FAR: f32 = 1e30;

/// The reciprocal of a direction component, bounded so that a product with a distance of zero is
/// zero and not NaN: a ray along a face then crosses it at once or never, both of which are right.
#[inline(always)]
pub(crate) fn bounded_reciprocal<R: Real>(d: R) -> R {
    const LARGEST: f32 = 3e37;
    const SMALLEST: f32 = 4e-38;
    let large = R::select(d.lt(R::zero()), R::splat(-LARGEST), R::splat(LARGEST));
    R::select(d.abs().lt(R::splat(SMALLEST)), large, R::one() / d)
}

/// The part of a ray with t ≥ 0 that lies in the axis-parallel box [0, `size`], in whichever space
/// `origin` and `direction` (of any length) are given.
#[inline(always)]
pub fn clip_to_box<R: Real>(origin: Vec3<R>, direction: Vec3<R>, size: Vec3<R>) -> Interval<R> {
    let slab = |o: R, d: R, size: R| {
        let inverse = bounded_reciprocal(d);
        let a = (R::zero() - o) * inverse;
        let b = (size - o) * inverse;
        (a.min(b), a.max(b))
    };
    let (x0, x1) = slab(origin.x, direction.x, size.x);
    let (y0, y1) = slab(origin.y, direction.y, size.y);
    let (z0, z1) = slab(origin.z, direction.z, size.z);
    Interval {
        t0: x0.max(y0).max(z0).max(R::zero()),
        t1: x1.min(y1).min(z1),
    }
}

/// The part of a ray with t ≥ 0 that lies in the unit sphere about the origin, in whichever space
/// `origin` and `direction` (of any length) are given.
///
/// The distance of closest approach is formed first and the half chord from it, which keeps the
/// digits that `b² − 4ac` loses when the origin is far away.
#[inline(always)]
pub fn clip_to_unit_sphere<R: Real>(origin: Vec3<R>, direction: Vec3<R>) -> Interval<R> {
    let inverse = R::one() / direction.dot(direction);
    let closest = -(origin.dot(direction) * inverse);
    let foot = origin + direction * closest;
    let half_squared = (R::one() - foot.dot(foot)) * inverse;
    let half = half_squared.max(R::zero()).sqrt();
    Interval {
        t0: (closest - half).max(R::zero()),
        t1: R::select(half_squared.lt(R::zero()), R::splat(-1.0), closest + half),
    }
}
