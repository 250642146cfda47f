//! Eight lanes behind newtypes that implement the core's [`Real`], [`Word`] and [`Mask`].
//!
//! `wide` shares one type between masks and numbers; the newtypes keep a mask from being mistaken for
//! a number, and only pass on operations that are correctly rounded, so that lane i of every result
//! has the bits that the same operation on `f32` has.

use core::ops::{Add, BitAnd, BitOr, BitXor, Div, Mul, Neg, Not, Sub};

use bytemuck::cast;
use wide::{f32x8, i32x8, u32x8};
use woodcock_core::elementary;
use woodcock_core::real::{Binary32, Mask, Real, Word};

use crate::gather;

/// How many lanes a packet has.
pub const LANES: usize = 8;

/// Eight numbers.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Lanes(pub(crate) f32x8);

/// Eight truths: all bits of a lane are ones or zeros.
#[derive(Clone, Copy, Debug)]
pub struct LaneMask(pub(crate) f32x8);

/// Eight words.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LaneWords(pub(crate) u32x8);

impl Lanes {
    /// From the numbers of the lanes.
    #[inline(always)]
    pub fn new(values: [f32; LANES]) -> Self {
        Self(f32x8::new(values))
    }
    /// The numbers of the lanes.
    #[inline(always)]
    pub fn to_array(self) -> [f32; LANES] {
        self.0.to_array()
    }
    /// Lane i takes the number of lane `order[i]` < 8.
    #[inline(always)]
    pub(crate) fn permuted(self, order: LaneWords) -> Self {
        let words: u32x8 = cast(self.0);
        Self(cast(words.shuffle_wrapping(order.0)))
    }
}

impl LaneWords {
    /// From the words of the lanes.
    #[inline(always)]
    pub fn new(values: [u32; LANES]) -> Self {
        Self(u32x8::new(values))
    }
    /// The words of the lanes.
    #[inline(always)]
    pub fn to_array(self) -> [u32; LANES] {
        self.0.to_array()
    }
    /// Lane i takes the word of lane `order[i]` < 8.
    #[inline(always)]
    pub(crate) fn permuted(self, order: Self) -> Self {
        Self(self.0.shuffle_wrapping(order.0))
    }
    /// `first` plus each lane's offset; places below 2³² only.
    #[inline(always)]
    pub(crate) fn places(first: usize, offset: Self) -> Self {
        Self(u32x8::splat(first as u32) + offset.0)
    }
    /// Whether every lane is one more than the lane before it.
    #[inline(always)]
    pub(crate) fn consecutive(self) -> bool {
        let first = u32x8::splat(self.to_array()[0]);
        let steps = u32x8::new([0, 1, 2, 3, 4, 5, 6, 7]);
        (first + steps).simd_eq(self.0).all()
    }
}

impl LaneMask {
    #[inline(always)]
    pub(crate) fn words(self) -> u32x8 {
        cast(self.0)
    }
}

macro_rules! operator {
    ($type:ty, $($trait:ident $method:ident),*) => {$(
        impl $trait for $type {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Self($trait::$method(self.0, other.0))
            }
        }
    )*};
}
operator!(Lanes, Add add, Sub sub, Mul mul, Div div);
operator!(LaneMask, BitAnd bitand, BitOr bitor, BitXor bitxor);
operator!(LaneWords, Add add, Sub sub, Mul mul, BitAnd bitand, BitOr bitor, BitXor bitxor);

impl Neg for Lanes {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self(-self.0)
    }
}

impl Not for LaneMask {
    type Output = Self;
    #[inline(always)]
    fn not(self) -> Self {
        Self(!self.0)
    }
}

impl Mask for LaneMask {
    #[inline(always)]
    fn splat(value: bool) -> Self {
        Self(cast(u32x8::splat(if value { u32::MAX } else { 0 })))
    }
    #[inline(always)]
    fn any(self) -> bool {
        self.0.any()
    }
    #[inline(always)]
    fn all(self) -> bool {
        self.0.all()
    }
    #[inline(always)]
    fn count(self) -> u32 {
        self.bits().count_ones()
    }
    #[inline(always)]
    fn lane(self, lane: usize) -> bool {
        lane < LANES && self.bits() >> lane & 1 == 1
    }
    #[inline(always)]
    fn set_lane(&mut self, lane: usize, value: bool) {
        if let Some(bits) = self.0.as_mut_array().get_mut(lane) {
            *bits = f32::from_bits(if value { u32::MAX } else { 0 });
        }
    }
    #[inline(always)]
    fn bits(self) -> u32 {
        self.0.to_bitmask()
    }
    #[inline(always)]
    fn from_bits(bits: u32) -> Self {
        let place = u32x8::new([1, 2, 4, 8, 16, 32, 64, 128]);
        Self(cast((u32x8::splat(bits) & place).simd_eq(place)))
    }
}

impl Word for LaneWords {
    type Mask = LaneMask;
    #[inline(always)]
    fn splat(value: u32) -> Self {
        Self(u32x8::splat(value))
    }
    #[inline(always)]
    fn shl(self, bits: u32) -> Self {
        Self(self.0 << bits)
    }
    #[inline(always)]
    fn shr(self, bits: u32) -> Self {
        Self(self.0 >> bits)
    }
    #[inline(always)]
    fn shr_signed(self, bits: u32) -> Self {
        let signed: i32x8 = cast(self.0);
        Self(cast(signed >> bits))
    }
    #[inline(always)]
    fn shr_each(self, bits: Self) -> Self {
        Self(self.0 >> bits.0)
    }
    #[inline(always)]
    fn eq(self, other: Self) -> LaneMask {
        LaneMask(cast(self.0.simd_eq(other.0)))
    }
    #[inline(always)]
    fn lt(self, other: Self) -> LaneMask {
        let (a, b): (i32x8, i32x8) = (cast(self.0), cast(other.0));
        LaneMask(cast(a.simd_lt(b)))
    }
    #[inline(always)]
    fn select(mask: LaneMask, if_true: Self, if_false: Self) -> Self {
        let (a, b): (f32x8, f32x8) = (cast(if_true.0), cast(if_false.0));
        Self(cast(wide::Select::select(mask.0, a, b)))
    }
    #[inline(always)]
    fn lane(self, lane: usize) -> u32 {
        self.to_array().get(lane).copied().unwrap_or(0)
    }
    #[inline(always)]
    fn set_lane(&mut self, lane: usize, value: u32) {
        if let Some(word) = self.0.as_mut_array().get_mut(lane) {
            *word = value;
        }
    }
    #[inline(always)]
    fn gather(table: &[u32], index: Self) -> Self {
        gather::words(table, index)
    }
    #[inline(always)]
    fn from_mask(mask: LaneMask) -> Self {
        Self(mask.words() & u32x8::splat(1))
    }
}

impl Real for Lanes {
    type Mask = LaneMask;
    type Word = LaneWords;
    const LANES: usize = LANES;

    #[inline(always)]
    fn splat(value: f32) -> Self {
        Self(f32x8::splat(value))
    }
    #[inline(always)]
    fn eq(self, other: Self) -> LaneMask {
        LaneMask(self.0.simd_eq(other.0))
    }
    #[inline(always)]
    fn lt(self, other: Self) -> LaneMask {
        LaneMask(self.0.simd_lt(other.0))
    }
    #[inline(always)]
    fn le(self, other: Self) -> LaneMask {
        LaneMask(self.0.simd_le(other.0))
    }
    #[inline(always)]
    fn select(mask: LaneMask, if_true: Self, if_false: Self) -> Self {
        Self(wide::Select::select(mask.0, if_true.0, if_false.0))
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        Self(self.0.sqrt())
    }
    #[inline(always)]
    fn abs(self) -> Self {
        Self(self.0.abs())
    }
    #[inline(always)]
    fn to_word(self) -> LaneWords {
        LaneWords(cast(self.0.fast_trunc_int()))
    }
    #[inline(always)]
    fn from_word(word: LaneWords) -> Self {
        Self(f32x8::from_i32x8(cast(word.0)))
    }
    #[inline(always)]
    fn from_f32_bits(bits: LaneWords) -> Self {
        Self(cast(bits.0))
    }
    #[inline(always)]
    fn gather(table: &[f32], index: LaneWords) -> Self {
        gather::numbers(table, index)
    }
    #[inline(always)]
    fn lane(self, lane: usize) -> f32 {
        self.to_array().get(lane).copied().unwrap_or(0.0)
    }
    #[inline(always)]
    fn set_lane(&mut self, lane: usize, value: f32) {
        if let Some(number) = self.0.as_mut_array().get_mut(lane) {
            *number = value;
        }
    }
    #[inline(always)]
    fn ln(self) -> Self {
        elementary::ln(self)
    }
    #[inline(always)]
    fn neg_ln_1m(self) -> Self {
        elementary::neg_ln_1m(self)
    }
    #[inline(always)]
    fn ln_1p(self) -> Self {
        elementary::ln_1p(self)
    }
    #[inline(always)]
    fn exp(self) -> Self {
        elementary::exp(self)
    }
    #[inline(always)]
    fn exp_m1(self) -> Self {
        elementary::exp_m1(self)
    }
    #[inline(always)]
    fn sin_cos_turn(self) -> (Self, Self) {
        elementary::sin_cos_turn(self)
    }
    // The AVX instructions are exactly `if a < b { a } else { b }` and its like; other targets'
    // minima treat NaN and signed zeros in ways of their own, so they keep the portable form.
    #[cfg(all(target_arch = "x86_64", target_feature = "avx"))]
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        Self(self.0.fast_min(other.0))
    }
    #[cfg(all(target_arch = "x86_64", target_feature = "avx"))]
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Self(self.0.fast_max(other.0))
    }
    #[inline(always)]
    fn or_zero(self, mask: LaneMask) -> Self {
        Self(self.0 & mask.0)
    }
}

impl Binary32 for Lanes {
    #[inline(always)]
    fn to_bits(self) -> LaneWords {
        LaneWords(cast(self.0))
    }
    #[inline(always)]
    fn from_bits(bits: LaneWords) -> Self {
        Self(cast(bits.0))
    }
}
