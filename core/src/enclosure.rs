//! Intervals that enclose: arithmetic whose results are certain to hold.
//!
//! An [`Enclosure`] stands for a number of which two bounds are known. Every operation gives bounds on
//! what it can make of *any* numbers within its operands, computed without rounding error or in `f32`
//! by [`Real`]'s operation of the same name. So a formula restated over enclosures, its
//! *interval extension*, bounds the formula over a whole box of places, and that bound is a proof
//! ([Moore 1966]): a majorant without a search.
//!
//! Ends are rounded outward: an operation that rounds to nearest errs by less than the distance to the
//! next float, so its result is moved there. Operations that do not round (negation, minimum,
//! maximum, magnitude, hull) move nothing, and no zero that is known to be exact becomes less.
//! Where an operand occurs twice the result is wider than need be (x − x is not zero), but never wrong;
//! hence [`square`](Enclosure::square) beside the product.
//!
//! An end may be infinite: what lies beyond the largest float, computed in `f32`, is infinite. A result
//! that cannot be bounded, a NaN in `f32`, is [`Enclosure::EVERYTHING`]; and since a NaN may hide in it,
//! nothing bounds it again, not even a minimum.

use core::ops::{Add, Div, Mul, Neg, Sub};

use crate::real::Real;

/// The numbers from one bound to another, both included.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Enclosure {
    // Neither is NaN, low ≤ high, low < ∞, high > −∞.
    low: f32,
    high: f32,
}

/// At most the number that rounds to `x`: below it, or zero where that is certain.
#[inline]
fn down(x: f32) -> f32 {
    // Rounding keeps the sign even where it underflows: what gives +0 is not negative.
    if x.to_bits() == 0 { x } else { x.next_down() }
}

/// At least the number that rounds to `x`.
#[inline]
fn up(x: f32) -> f32 {
    -down(-x)
}

impl Enclosure {
    /// Any number, or none: nothing is known.
    pub const EVERYTHING: Self = Self {
        low: f32::NEG_INFINITY,
        high: f32::INFINITY,
    };

    /// From its bounds; [`EVERYTHING`](Self::EVERYTHING) where one is NaN or they are in the wrong order.
    #[inline]
    pub fn new(low: f32, high: f32) -> Self {
        if low <= high {
            // A number that rounds to infinity is finite itself.
            Self {
                low: low.min(f32::MAX),
                high: high.max(f32::MIN),
            }
        } else {
            Self::EVERYTHING
        }
    }

    /// One number, exactly.
    #[inline]
    pub fn point(x: f32) -> Self {
        Self::new(x, x)
    }

    /// The lower bound.
    #[inline]
    pub fn low(self) -> f32 {
        self.low
    }

    /// The upper bound.
    #[inline]
    pub fn high(self) -> f32 {
        self.high
    }

    /// Whether a number lies within the bounds; NaN only within everything.
    #[inline]
    pub fn contains(self, x: f64) -> bool {
        let within = f64::from(self.low) <= x && x <= f64::from(self.high);
        within || self == Self::EVERYTHING
    }

    /// What lies in either, or between them.
    #[inline]
    pub fn hull(self, other: Self) -> Self {
        Self {
            low: self.low.min(other.low),
            high: self.high.max(other.high),
        }
    }

    /// `f` of the bounds of one operand, unless nothing is known of it.
    #[inline]
    fn known(self, f: impl FnOnce(f32, f32) -> Self) -> Self {
        if self == Self::EVERYTHING {
            self
        } else {
            f(self.low, self.high)
        }
    }

    /// The smaller of two numbers.
    #[inline]
    pub fn min(self, other: Self) -> Self {
        self.known(|a, b| other.known(|c, d| Self::new(a.min(c), b.min(d))))
    }

    /// The larger of two numbers.
    #[inline]
    pub fn max(self, other: Self) -> Self {
        -(-self).min(-other)
    }

    /// Magnitude.
    #[inline]
    pub fn abs(self) -> Self {
        self.max(-self).max(Self::point(0.0))
    }

    /// A number times itself: not negative.
    #[inline]
    pub fn square(self) -> Self {
        let Self { low, high } = self.abs();
        self.known(|_, _| product(low, low).hull(product(high, high)))
    }

    /// Square root; nothing is known where a number may be negative.
    #[inline]
    pub fn sqrt(self) -> Self {
        let root = |x: f32| {
            let root = Real::sqrt(x);
            if x == 0.0 {
                Self::point(0.0)
            } else {
                Self::new(down(root), up(root))
            }
        };
        self.known(|low, high| {
            if low < 0.0 {
                return Self::EVERYTHING;
            }
            root(low).hull(root(high))
        })
    }

    /// Exponential.
    ///
    /// [`elementary::exp`](crate::elementary::exp) errs by at most 2⁻²³ of the value, and by half the
    /// smallest float where that is subnormal, and need not be monotone. So the bounds leave room for
    /// twice that: 2⁻²¹, and two floats.
    #[inline]
    pub fn exp(self) -> Self {
        self.known(|low, high| {
            let (least, most) = (Real::exp(low).min(f32::MAX), Real::exp(high));
            let low = down(down(least - least * LIBRARY)).max(0.0);
            Self::new(low, up(up(most + most * LIBRARY)))
        })
    }

    /// Natural logarithm; nothing is known where a number may be zero (of either sign) or negative.
    ///
    /// [`elementary::ln`](crate::elementary::ln) errs by at most 2⁻²³ of the value; the bounds leave room
    /// as those of [`exp`](Self::exp) do.
    #[inline]
    pub fn ln(self) -> Self {
        self.known(|low, high| {
            if low <= 0.0 {
                return Self::EVERYTHING;
            }
            let least = Real::ln(low);
            let most = if high == f32::INFINITY {
                high
            } else {
                Real::ln(high)
            };
            let low = down(least - least.abs() * LIBRARY);
            Self::new(low, up(most + most.abs() * LIBRARY))
        })
    }
}

/// 2⁻²¹: four times the relative error of our elementary functions.
const LIBRARY: f32 = 1.0 / 2_097_152.0;

impl From<f32> for Enclosure {
    #[inline]
    fn from(x: f32) -> Self {
        Self::point(x)
    }
}

impl Neg for Enclosure {
    type Output = Self;
    #[inline]
    fn neg(self) -> Self {
        Self {
            low: -self.high,
            high: -self.low,
        }
    }
}

impl Add for Enclosure {
    type Output = Self;
    #[inline]
    fn add(self, other: Self) -> Self {
        // Infinite ends of both signs make everything of themselves: low is never +∞, high never −∞.
        Self::new(down(self.low + other.low), up(self.high + other.high))
    }
}

impl Sub for Enclosure {
    type Output = Self;
    #[inline]
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

/// The hull of an operation's results for all four pairs of ends.
#[inline]
fn corners(a: Enclosure, b: Enclosure, f: impl Fn(f32, f32) -> Enclosure) -> Enclosure {
    f(a.low, b.low)
        .hull(f(a.low, b.high))
        .hull(f(a.high, b.low))
        .hull(f(a.high, b.high))
}

/// What the product of two numbers lies in; zero times a number is exact.
#[inline]
fn product(x: f32, y: f32) -> Enclosure {
    let product = x * y;
    if product == 0.0 && (x == 0.0 || y == 0.0) {
        Enclosure::point(0.0)
    } else {
        Enclosure::new(down(product), up(product))
    }
}

impl Mul for Enclosure {
    type Output = Self;
    #[inline]
    fn mul(self, other: Self) -> Self {
        corners(self, other, product)
    }
}

impl Div for Enclosure {
    type Output = Self;
    /// Nothing is known where the divisor may be zero.
    #[inline]
    fn div(self, other: Self) -> Self {
        if other.low <= 0.0 && 0.0 <= other.high {
            return Self::EVERYTHING;
        }
        corners(self, other, |x, y| {
            let quotient = x / y;
            if x == 0.0 {
                Self::point(0.0)
            } else {
                Self::new(down(quotient), up(quotient))
            }
        })
    }
}

macro_rules! with_number {
    ($trait:ident, $method:ident) => {
        impl $trait<f32> for Enclosure {
            type Output = Self;
            #[inline]
            fn $method(self, other: f32) -> Self {
                self.$method(Self::point(other))
            }
        }
    };
}
with_number!(Add, add);
with_number!(Sub, sub);
with_number!(Mul, mul);
with_number!(Div, div);
