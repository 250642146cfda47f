//! Three-vectors of lanes, and the frame that a scattered direction is built in.

use core::ops::{Add, Mul, Neg, Sub};

use crate::real::Real;

/// A point, a direction or a colour; per lane.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Vec3<R> {
    /// First component.
    pub x: R,
    /// Second component.
    pub y: R,
    /// Third component.
    pub z: R,
}

impl<R: Real> Vec3<R> {
    /// From its components.
    #[inline(always)]
    pub fn new(x: R, y: R, z: R) -> Self {
        Self { x, y, z }
    }
    /// The same vector in every lane.
    #[inline(always)]
    pub fn splat(v: [f32; 3]) -> Self {
        Self::new(R::splat(v[0]), R::splat(v[1]), R::splat(v[2]))
    }
    /// The same number in every component of every lane.
    #[inline(always)]
    pub fn uniform(value: f32) -> Self {
        Self::splat([value; 3])
    }
    /// `f` of every component.
    #[inline(always)]
    pub fn map(self, f: impl Fn(R) -> R) -> Self {
        Self::new(f(self.x), f(self.y), f(self.z))
    }
    /// `f` of every pair of components.
    #[inline(always)]
    pub fn zip(self, other: Self, f: impl Fn(R, R) -> R) -> Self {
        Self::new(f(self.x, other.x), f(self.y, other.y), f(self.z, other.z))
    }
    /// Component by component product, as colours multiply.
    #[inline(always)]
    pub fn times(self, other: Self) -> Self {
        self.zip(other, |a, b| a * b)
    }
    /// Scalar product.
    #[inline(always)]
    pub fn dot(self, other: Self) -> R {
        self.x * other.x + self.y * other.y + self.z * other.z
    }
    /// Largest component.
    #[inline(always)]
    pub fn max_component(self) -> R {
        self.x.max(self.y).max(self.z)
    }
    /// Sum of the components.
    #[inline(always)]
    pub fn sum(self) -> R {
        self.x + self.y + self.z
    }
    /// To unit length; NaN for the zero vector.
    #[inline(always)]
    pub fn normalised(self) -> Self {
        self * (R::one() / self.dot(self).sqrt())
    }
    /// `if_true` where the mask holds, else `if_false`.
    #[inline(always)]
    pub fn select(mask: R::Mask, if_true: Self, if_false: Self) -> Self {
        if_true.zip(if_false, |a, b| R::select(mask, a, b))
    }
    /// The vector of one lane.
    #[inline(always)]
    pub fn lane(self, lane: usize) -> [f32; 3] {
        [self.x.lane(lane), self.y.lane(lane), self.z.lane(lane)]
    }
    /// Replaces the vector of one lane.
    #[inline(always)]
    pub fn set_lane(&mut self, lane: usize, value: [f32; 3]) {
        self.x.set_lane(lane, value[0]);
        self.y.set_lane(lane, value[1]);
        self.z.set_lane(lane, value[2]);
    }

    /// The unit direction at `cos_theta` from `self` (a unit vector), turned about it by `turn` of a
    /// full circle.
    ///
    /// The frame is the branch-free one of [Duff 2017], which has no pole. The result is brought
    /// back to unit length, so that a long chain of scatterings does not drift.
    #[inline(always)]
    pub fn deflected(self, cos_theta: R, turn: R) -> Self {
        let one = R::one();
        let sin_theta = (one - cos_theta * cos_theta).max(R::zero()).sqrt();
        let (sin_phi, cos_phi) = turn.sin_cos_turn();
        let sign = R::select(self.z.lt(R::zero()), -one, one);
        let a = -(one / (sign + self.z));
        let b = self.x * self.y * a;
        let tangent = Self::new(one + sign * self.x * self.x * a, sign * b, -(sign * self.x));
        let bitangent = Self::new(b, sign + self.y * self.y * a, -self.y);
        let direction =
            tangent * (sin_theta * cos_phi) + bitangent * (sin_theta * sin_phi) + self * cos_theta;
        direction.normalised()
    }
}

impl<R: Real> Add for Vec3<R> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        self.zip(other, |a, b| a + b)
    }
}
impl<R: Real> Sub for Vec3<R> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        self.zip(other, |a, b| a - b)
    }
}
impl<R: Real> Mul<R> for Vec3<R> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, factor: R) -> Self {
        self.map(|a| a * factor)
    }
}
impl<R: Real> Neg for Vec3<R> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        self.map(|a| -a)
    }
}
