//! Sixteen lanes: two vectors of eight side by side.
//!
//! A step of a path is one long chain of operations, each of which waits for the one before. Two chains side by side, operation by
//! operation, take hardly longer than one.

use core::ops::{Add, BitAnd, BitOr, BitXor, Div, Mul, Neg, Not, Sub};

use woodcock_core::elementary;
use woodcock_core::real::{Binary32, Mask, Real, Word};
use woodcock_core::stream::{Key, KeyedStream, Stream};

use crate::bits::LaneStream;
use crate::lanes::{LANES, LaneMask, LaneWords, Lanes};

/// Sixteen numbers.
pub type Wide = Both<Lanes>;

/// How many lanes there are.
pub const WIDTH: usize = 2 * LANES;

/// Lanes 0 to 7 and lanes 8 to 15.
#[derive(Clone, Copy, Debug, Default)]
pub struct Both<T>(pub T, pub T);

macro_rules! operator {
    ($($trait:ident $method:ident),*) => {$(
        impl<T: $trait<Output = T>> $trait for Both<T> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Self($trait::$method(self.0, other.0), $trait::$method(self.1, other.1))
            }
        }
    )*};
}
operator!(Add add, Sub sub, Mul mul, Div div, BitAnd bitand, BitOr bitor, BitXor bitxor);

impl<T: Neg<Output = T>> Neg for Both<T> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self(-self.0, -self.1)
    }
}
impl<T: Not<Output = T>> Not for Both<T> {
    type Output = Self;
    #[inline(always)]
    fn not(self) -> Self {
        Self(!self.0, !self.1)
    }
}

impl<T> Both<T> {
    #[inline(always)]
    fn half(&self, lane: usize) -> (&T, usize) {
        if lane < LANES {
            (&self.0, lane)
        } else {
            (&self.1, lane - LANES)
        }
    }
    #[inline(always)]
    fn half_mut(&mut self, lane: usize) -> (&mut T, usize) {
        if lane < LANES {
            (&mut self.0, lane)
        } else {
            (&mut self.1, lane - LANES)
        }
    }
}

impl Mask for Both<LaneMask> {
    #[inline(always)]
    fn splat(value: bool) -> Self {
        Self(Mask::splat(value), Mask::splat(value))
    }
    #[inline(always)]
    fn any(self) -> bool {
        (self.0 | self.1).any()
    }
    #[inline(always)]
    fn all(self) -> bool {
        (self.0 & self.1).all()
    }
    #[inline(always)]
    fn count(self) -> u32 {
        self.bits().count_ones()
    }
    #[inline(always)]
    fn lane(self, lane: usize) -> bool {
        let (half, lane) = self.half(lane);
        half.lane(lane)
    }
    #[inline(always)]
    fn set_lane(&mut self, lane: usize, value: bool) {
        let (half, lane) = self.half_mut(lane);
        half.set_lane(lane, value);
    }
    #[inline(always)]
    fn bits(self) -> u32 {
        self.0.bits() | self.1.bits() << LANES
    }
    #[inline(always)]
    fn from_bits(bits: u32) -> Self {
        Self(Mask::from_bits(bits), Mask::from_bits(bits >> LANES))
    }
}

impl Word for Both<LaneWords> {
    type Mask = Both<LaneMask>;
    #[inline(always)]
    fn splat(value: u32) -> Self {
        Self(Word::splat(value), Word::splat(value))
    }
    #[inline(always)]
    fn shl(self, bits: u32) -> Self {
        Self(self.0.shl(bits), self.1.shl(bits))
    }
    #[inline(always)]
    fn shr(self, bits: u32) -> Self {
        Self(self.0.shr(bits), self.1.shr(bits))
    }
    #[inline(always)]
    fn shr_signed(self, bits: u32) -> Self {
        Self(self.0.shr_signed(bits), self.1.shr_signed(bits))
    }
    #[inline(always)]
    fn shr_each(self, bits: Self) -> Self {
        Self(self.0.shr_each(bits.0), self.1.shr_each(bits.1))
    }
    #[inline(always)]
    fn eq(self, other: Self) -> Both<LaneMask> {
        Both(Word::eq(self.0, other.0), Word::eq(self.1, other.1))
    }
    #[inline(always)]
    fn lt(self, other: Self) -> Both<LaneMask> {
        Both(Word::lt(self.0, other.0), Word::lt(self.1, other.1))
    }
    #[inline(always)]
    fn select(mask: Both<LaneMask>, a: Self, b: Self) -> Self {
        Self(
            Word::select(mask.0, a.0, b.0),
            Word::select(mask.1, a.1, b.1),
        )
    }
    #[inline(always)]
    fn lane(self, lane: usize) -> u32 {
        let (half, lane) = self.half(lane);
        half.lane(lane)
    }
    #[inline(always)]
    fn set_lane(&mut self, lane: usize, value: u32) {
        let (half, lane) = self.half_mut(lane);
        half.set_lane(lane, value);
    }
    #[inline(always)]
    fn gather(table: &[u32], index: Self) -> Self {
        Self(Word::gather(table, index.0), Word::gather(table, index.1))
    }
    #[inline(always)]
    fn from_mask(mask: Both<LaneMask>) -> Self {
        Self(Word::from_mask(mask.0), Word::from_mask(mask.1))
    }
}

impl Real for Both<Lanes> {
    type Mask = Both<LaneMask>;
    type Word = Both<LaneWords>;
    const LANES: usize = WIDTH;

    #[inline(always)]
    fn splat(value: f32) -> Self {
        Self(Real::splat(value), Real::splat(value))
    }
    #[inline(always)]
    fn eq(self, other: Self) -> Both<LaneMask> {
        Both(Real::eq(self.0, other.0), Real::eq(self.1, other.1))
    }
    #[inline(always)]
    fn lt(self, other: Self) -> Both<LaneMask> {
        Both(Real::lt(self.0, other.0), Real::lt(self.1, other.1))
    }
    #[inline(always)]
    fn le(self, other: Self) -> Both<LaneMask> {
        Both(Real::le(self.0, other.0), Real::le(self.1, other.1))
    }
    #[inline(always)]
    fn select(mask: Both<LaneMask>, a: Self, b: Self) -> Self {
        Self(
            Real::select(mask.0, a.0, b.0),
            Real::select(mask.1, a.1, b.1),
        )
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        Self(self.0.sqrt(), self.1.sqrt())
    }
    #[inline(always)]
    fn abs(self) -> Self {
        Self(self.0.abs(), self.1.abs())
    }
    #[inline(always)]
    fn to_word(self) -> Both<LaneWords> {
        Both(self.0.to_word(), self.1.to_word())
    }
    #[inline(always)]
    fn from_word(word: Both<LaneWords>) -> Self {
        Self(Real::from_word(word.0), Real::from_word(word.1))
    }
    #[inline(always)]
    fn from_f32_bits(bits: Both<LaneWords>) -> Self {
        Self(Real::from_f32_bits(bits.0), Real::from_f32_bits(bits.1))
    }
    #[inline(always)]
    fn gather(table: &[f32], index: Both<LaneWords>) -> Self {
        Self(Real::gather(table, index.0), Real::gather(table, index.1))
    }
    #[inline(always)]
    fn lane(self, lane: usize) -> f32 {
        let (half, lane) = self.half(lane);
        half.lane(lane)
    }
    #[inline(always)]
    fn set_lane(&mut self, lane: usize, value: f32) {
        let (half, lane) = self.half_mut(lane);
        half.set_lane(lane, value);
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
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        Self(self.0.min(other.0), self.1.min(other.1))
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Self(self.0.max(other.0), self.1.max(other.1))
    }
    #[inline(always)]
    fn or_zero(self, mask: Both<LaneMask>) -> Self {
        Self(self.0.or_zero(mask.0), self.1.or_zero(mask.1))
    }
}

impl Binary32 for Both<Lanes> {
    #[inline(always)]
    fn to_bits(self) -> Both<LaneWords> {
        Both(self.0.to_bits(), self.1.to_bits())
    }
    #[inline(always)]
    fn from_bits(bits: Both<LaneWords>) -> Self {
        Self(Binary32::from_bits(bits.0), Binary32::from_bits(bits.1))
    }
}

impl Stream<Both<Lanes>> for Both<LaneStream> {
    #[inline(always)]
    fn next_word(&mut self, active: Both<LaneMask>) -> Both<LaneWords> {
        Both(self.0.next_word(active.0), self.1.next_word(active.1))
    }
}

impl KeyedStream<Both<Lanes>> for Both<LaneStream> {
    fn idle() -> Self {
        Self(LaneStream::idle(), LaneStream::idle())
    }
    fn set_key(&mut self, lane: usize, key: Key) {
        let (half, lane) = self.half_mut(lane);
        half.set_key(lane, key);
    }
}

impl Both<LaneStream> {
    /// Replaces the states of the given lanes, from their lower and upper halves.
    #[inline(always)]
    pub(crate) fn set_states(
        &mut self,
        low: Both<LaneWords>,
        high: Both<LaneWords>,
        lanes: Both<LaneMask>,
    ) {
        self.0.set_states(low.0, high.0, lanes.0);
        self.1.set_states(low.1, high.1, lanes.1);
    }

    /// Replaces the state of one lane, from its lower and upper half.
    #[cfg(not(target_family = "wasm"))] // where paths run in one vector
    #[inline(always)]
    pub(crate) fn set_state(&mut self, lane: usize, state: [u32; 2]) {
        let (half, lane) = self.half_mut(lane);
        half.set_state(lane, state);
    }
}
