//! What a number must be able to do, so that one formula serves one lane or eight.
//!
//! [`Real`] is a vector of numbers and [`Mask`] the matching vector of truths; `f32` and `bool` are
//! the vectors of one lane, `f64` is the oracle of the stability tests. A formula written over
//! `Real` uses [`Real::select`] where scalar code would use `if`, and threads a mask of *active*
//! lanes: a finished lane may compute rubbish, but never writes it and never draws random numbers.
//!
//! All operations but the elementary functions of `f64` are correctly rounded IEEE operations in a
//! fixed order, none is fused, and so every implementation for `f32` lanes gives the same bits.

use core::fmt::Debug;
use core::ops::{Add, BitAnd, BitOr, BitXor, Div, Mul, Neg, Not, Sub};

use crate::elementary;

/// One truth per lane.
pub trait Mask:
    Copy
    + Debug
    + 'static
    + BitAnd<Output = Self>
    + BitOr<Output = Self>
    + BitXor<Output = Self>
    + Not<Output = Self>
{
    /// The same truth in every lane.
    fn splat(value: bool) -> Self;
    /// Whether at least one lane is true.
    fn any(self) -> bool;
    /// Whether every lane is true.
    fn all(self) -> bool;
    /// How many lanes are true.
    fn count(self) -> u32;
    /// The truth of one lane; `false` beyond the last lane.
    fn lane(self, lane: usize) -> bool;
    /// Replaces the truth of one lane; nothing beyond the last lane.
    fn set_lane(&mut self, lane: usize, value: bool);
    /// One bit a lane, lane zero lowest.
    fn bits(self) -> u32;
    /// The lanes whose bit is set; bits beyond the last lane are ignored.
    fn from_bits(bits: u32) -> Self;
    /// Lanes of `self` that are not in `other`.
    #[inline(always)]
    fn and_not(self, other: Self) -> Self {
        self & !other
    }
}

/// One 32-bit unsigned integer per lane; addition, subtraction and multiplication wrap.
pub trait Word:
    Copy
    + Debug
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + BitAnd<Output = Self>
    + BitOr<Output = Self>
    + BitXor<Output = Self>
    + 'static
{
    /// The mask of as many lanes.
    type Mask: Mask;
    /// The same word in every lane.
    fn splat(value: u32) -> Self;
    /// Shifts every lane left by `bits` < 32.
    fn shl(self, bits: u32) -> Self;
    /// Shifts every lane right by `bits` < 32, filling with zeros.
    fn shr(self, bits: u32) -> Self;
    /// Shifts every lane right by `bits` < 32, filling with the sign bit.
    fn shr_signed(self, bits: u32) -> Self;
    /// Shifts each lane right by its own number of bits < 32, filling with zeros.
    fn shr_each(self, bits: Self) -> Self;
    /// Lanes that are equal.
    fn eq(self, other: Self) -> Self::Mask;
    /// Lanes that are smaller, both sides below 2³¹.
    fn lt(self, other: Self) -> Self::Mask;
    /// `if_true` where the mask holds, else `if_false`.
    fn select(mask: Self::Mask, if_true: Self, if_false: Self) -> Self;
    /// The word of one lane; zero beyond the last lane.
    fn lane(self, lane: usize) -> u32;
    /// Replaces the word of one lane; nothing beyond the last lane.
    fn set_lane(&mut self, lane: usize, value: u32);
    /// `table[index]` per lane. Indices beyond the table read its last entry, so that finished
    /// lanes may ask for anything; an empty table gives zero.
    fn gather(table: &[u32], index: Self) -> Self;
    /// One where the mask holds, else zero.
    #[inline(always)]
    fn from_mask(mask: Self::Mask) -> Self {
        Self::select(mask, Self::splat(1), Self::splat(0))
    }
}

/// One floating-point number per lane.
pub trait Real:
    Copy
    + Debug
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + 'static
{
    /// The mask of as many lanes.
    type Mask: Mask;
    /// The integers of as many lanes.
    type Word: Word<Mask = Self::Mask>;
    /// How many lanes there are.
    const LANES: usize;

    /// The same number in every lane.
    fn splat(value: f32) -> Self;
    /// `self = other`, per lane.
    fn eq(self, other: Self) -> Self::Mask;
    /// `self < other`, per lane; false for NaN.
    fn lt(self, other: Self) -> Self::Mask;
    /// `self ≤ other`, per lane; false for NaN.
    fn le(self, other: Self) -> Self::Mask;
    /// `if_true` where the mask holds, else `if_false`.
    fn select(mask: Self::Mask, if_true: Self, if_false: Self) -> Self;
    /// Square root, correctly rounded; NaN below zero.
    fn sqrt(self) -> Self;
    /// Magnitude.
    fn abs(self) -> Self;
    /// The integer part of `0 ≤ self < 2³¹`; any word elsewhere.
    fn to_word(self) -> Self::Word;
    /// The number of a word below 2³¹, rounded to nearest.
    fn from_word(word: Self::Word) -> Self;
    /// The bits of an `f32` in each lane, read as a number.
    fn from_f32_bits(bits: Self::Word) -> Self;
    /// `table[index]` per lane, under the rules of [`Word::gather`].
    fn gather(table: &[f32], index: Self::Word) -> Self;
    /// The number of one lane; zero beyond the last lane.
    fn lane(self, lane: usize) -> f32;
    /// Replaces the number of one lane; nothing beyond the last lane.
    fn set_lane(&mut self, lane: usize, value: f32);

    /// Natural logarithm; see [`elementary::ln`] for domain and bound.
    fn ln(self) -> Self;
    /// `−ln(1 − u)` for `0 ≤ u < 1`; see [`elementary::neg_ln_1m`].
    fn neg_ln_1m(self) -> Self;
    /// `ln(1 + self)`; see [`elementary::ln_1p`].
    fn ln_1p(self) -> Self;
    /// Exponential; see [`elementary::exp`].
    fn exp(self) -> Self;
    /// `e^self − 1`; see [`elementary::exp_m1`].
    fn exp_m1(self) -> Self;
    /// Sine and cosine of an angle given as a fraction of a full turn; see
    /// [`elementary::sin_cos_turn`].
    fn sin_cos_turn(self) -> (Self, Self);

    /// Zero in every lane.
    #[inline(always)]
    fn zero() -> Self {
        Self::splat(0.0)
    }
    /// One in every lane.
    #[inline(always)]
    fn one() -> Self {
        Self::splat(1.0)
    }
    /// The smaller number; `other` where either is NaN.
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        Self::select(self.lt(other), self, other)
    }
    /// The larger number; `other` where either is NaN.
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Self::select(other.lt(self), self, other)
    }
    /// `self` where the mask holds, else zero.
    #[inline(always)]
    fn or_zero(self, mask: Self::Mask) -> Self {
        Self::select(mask, self, Self::zero())
    }
}

/// Lanes of IEEE binary32, whose bits can be read: what [`elementary`] is made of.
pub trait Binary32: Real {
    /// The bits of each lane.
    fn to_bits(self) -> Self::Word;
    /// The numbers with these bits.
    fn from_bits(bits: Self::Word) -> Self;
}

impl Mask for bool {
    #[inline(always)]
    fn splat(value: bool) -> Self {
        value
    }
    #[inline(always)]
    fn any(self) -> bool {
        self
    }
    #[inline(always)]
    fn all(self) -> bool {
        self
    }
    #[inline(always)]
    fn count(self) -> u32 {
        u32::from(self)
    }
    #[inline(always)]
    fn lane(self, lane: usize) -> bool {
        self && lane == 0
    }
    #[inline(always)]
    fn set_lane(&mut self, lane: usize, value: bool) {
        if lane == 0 {
            *self = value;
        }
    }
    #[inline(always)]
    fn bits(self) -> u32 {
        u32::from(self)
    }
    #[inline(always)]
    fn from_bits(bits: u32) -> Self {
        bits & 1 == 1
    }
}

/// A `u32` whose arithmetic wraps: the word of one lane.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Word32(
    /// The word.
    pub u32,
);

macro_rules! word32_operator {
    ($trait:ident, $method:ident, $body:expr) => {
        impl $trait for Word32 {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                let body: fn(u32, u32) -> u32 = $body;
                Self(body(self.0, other.0))
            }
        }
    };
}
word32_operator!(Add, add, |a, b| a.wrapping_add(b));
word32_operator!(Sub, sub, |a, b| a.wrapping_sub(b));
word32_operator!(Mul, mul, |a, b| a.wrapping_mul(b));
word32_operator!(BitAnd, bitand, |a, b| a & b);
word32_operator!(BitOr, bitor, |a, b| a | b);
word32_operator!(BitXor, bitxor, |a, b| a ^ b);

impl Word for Word32 {
    type Mask = bool;
    #[inline(always)]
    fn splat(value: u32) -> Self {
        Self(value)
    }
    #[inline(always)]
    fn shl(self, bits: u32) -> Self {
        Self(self.0 << (bits & 31))
    }
    #[inline(always)]
    fn shr(self, bits: u32) -> Self {
        Self(self.0 >> (bits & 31))
    }
    #[inline(always)]
    fn shr_signed(self, bits: u32) -> Self {
        Self((self.0.cast_signed() >> (bits & 31)).cast_unsigned())
    }
    #[inline(always)]
    fn shr_each(self, bits: Self) -> Self {
        Self(self.0 >> (bits.0 & 31))
    }
    #[inline(always)]
    fn eq(self, other: Self) -> bool {
        self.0 == other.0
    }
    #[inline(always)]
    fn lt(self, other: Self) -> bool {
        self.0 < other.0
    }
    #[inline(always)]
    fn select(mask: bool, if_true: Self, if_false: Self) -> Self {
        if mask { if_true } else { if_false }
    }
    #[inline(always)]
    fn lane(self, lane: usize) -> u32 {
        if lane == 0 { self.0 } else { 0 }
    }
    #[inline(always)]
    fn set_lane(&mut self, lane: usize, value: u32) {
        if lane == 0 {
            self.0 = value;
        }
    }
    #[inline(always)]
    fn gather(table: &[u32], index: Self) -> Self {
        Self(clamped(table, index.0))
    }
}

/// `table[index]`, or the last entry, or the default of an empty table: total, without a panic path.
#[inline(always)]
fn clamped<T: Copy + Default>(table: &[T], index: u32) -> T {
    let last = table.len().saturating_sub(1);
    table
        .get((index as usize).min(last))
        .copied()
        .unwrap_or_default()
}

macro_rules! one_lane {
    ($float:ty, sqrt = $sqrt:path, ln = $ln:expr, neg_ln_1m = $neg_ln_1m:expr, ln_1p = $ln_1p:expr,
     exp = $exp:expr, exp_m1 = $exp_m1:expr, sin_cos_turn = $sin_cos:expr) => {
        impl Real for $float {
            type Mask = bool;
            type Word = Word32;
            const LANES: usize = 1;

            #[inline(always)]
            fn splat(value: f32) -> Self {
                value.into()
            }
            #[inline(always)]
            fn eq(self, other: Self) -> bool {
                self == other
            }
            #[inline(always)]
            fn lt(self, other: Self) -> bool {
                self < other
            }
            #[inline(always)]
            fn le(self, other: Self) -> bool {
                self <= other
            }
            #[inline(always)]
            fn select(mask: bool, if_true: Self, if_false: Self) -> Self {
                if mask { if_true } else { if_false }
            }
            #[inline(always)]
            fn sqrt(self) -> Self {
                $sqrt(self)
            }
            #[inline(always)]
            fn abs(self) -> Self {
                <$float>::abs(self)
            }
            #[inline(always)]
            fn to_word(self) -> Word32 {
                Word32((self as i32).cast_unsigned())
            }
            #[inline(always)]
            fn from_word(word: Word32) -> Self {
                word.0.cast_signed() as $float
            }
            #[inline(always)]
            fn from_f32_bits(bits: Word32) -> Self {
                f32::from_bits(bits.0).into()
            }
            #[inline(always)]
            fn gather(table: &[f32], index: Word32) -> Self {
                clamped(table, index.0).into()
            }
            #[inline(always)]
            fn lane(self, lane: usize) -> f32 {
                if lane == 0 { self as f32 } else { 0.0 }
            }
            #[inline(always)]
            fn set_lane(&mut self, lane: usize, value: f32) {
                if lane == 0 {
                    *self = value.into();
                }
            }
            #[inline(always)]
            fn ln(self) -> Self {
                $ln(self)
            }
            #[inline(always)]
            fn neg_ln_1m(self) -> Self {
                $neg_ln_1m(self)
            }
            #[inline(always)]
            fn ln_1p(self) -> Self {
                $ln_1p(self)
            }
            #[inline(always)]
            fn exp(self) -> Self {
                $exp(self)
            }
            #[inline(always)]
            fn exp_m1(self) -> Self {
                $exp_m1(self)
            }
            #[inline(always)]
            fn sin_cos_turn(self) -> (Self, Self) {
                $sin_cos(self)
            }
        }
    };
}

#[cfg(feature = "std")]
extern crate std;

#[inline(always)]
fn sqrt_f32(x: f32) -> f32 {
    // Both are correctly rounded; the standard library's compiles to the one instruction.
    #[cfg(feature = "std")]
    return x.sqrt();
    #[cfg(not(feature = "std"))]
    libm::sqrtf(x)
}

one_lane!(
    f32,
    sqrt = sqrt_f32,
    ln = elementary::ln,
    neg_ln_1m = elementary::neg_ln_1m,
    ln_1p = elementary::ln_1p,
    exp = elementary::exp,
    exp_m1 = elementary::exp_m1,
    sin_cos_turn = elementary::sin_cos_turn
);
one_lane!(
    f64,
    sqrt = libm::sqrt,
    ln = libm::log,
    neg_ln_1m = |u: f64| -libm::log1p(-u),
    ln_1p = libm::log1p,
    exp = libm::exp,
    exp_m1 = libm::expm1,
    sin_cos_turn = |turn: f64| libm::sincos(core::f64::consts::TAU * turn)
);

impl Binary32 for f32 {
    #[inline(always)]
    fn to_bits(self) -> Word32 {
        Word32(Self::to_bits(self))
    }
    #[inline(always)]
    fn from_bits(bits: Word32) -> Self {
        Self::from_bits(bits.0)
    }
}
