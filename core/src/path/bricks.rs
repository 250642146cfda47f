//! Samples in bricks: only where matter is, with a byte for each that brackets it.
//!
//! A brick holds 8³ samples; what is needed of a sample is found within it, without a border of its neighbours', because
//! one tap asks for one sample. A lattice of places says where each brick begins among all; the bricks that hold nothing but zeros
//! are all the first. So a grid costs four bytes in 512 where it is empty.
//!
//! The byte of a sample is the upper part of its bits, four of the exponent and four of the mantissa, counted back from
//! the largest sample of the grid:
//!
//! ```text
//! code(v) = max(0, bits(v) / 2¹⁹ − floor),   floor = bits(largest) / 2¹⁹ − 255
//! low(c) = float(2¹⁹ (c + floor)), 0 for c = 0,   high(c) = float(2¹⁹ (c + 1 + floor)):   low ≤ v < high
//! ```
//!
//! An analog decision compares v with a number. Where that number lies outside of [low, high) the byte decides as the
//! sample would, bit for bit (a *squeeze*); the sample itself is read for the rest, some two in a hundred.

use crate::real::{Real, Word};

/// Samples along an edge of a brick.
pub const BRICK: u32 = 8;
/// Samples of a brick.
pub const BRICK_SAMPLES: usize = 512;
/// Bits of a number below its code.
const BELOW: u32 = 19;

/// The exact samples of bricks.
#[derive(Clone, Copy, Debug)]
pub enum Exact<'a> {
    /// In single precision.
    Single(&'a [f32]),
    /// In half precision, two a word, the first in the lower half.
    Half(&'a [u32]),
}

/// Borrowed bricks of one grid.
///
/// Of tables that do not belong together nothing worse comes than wrong extinction; look-ups are clamped.
#[derive(Clone, Copy, Debug)]
pub struct Bricks<'a> {
    /// Index of each brick's first sample, for the lattice of all bricks of a grid, x fastest.
    pub places: &'a [u32],
    /// Codes of samples, four a word, the first in the lowest byte.
    pub codes: &'a [u32],
    /// The samples, brick by brick, x fastest within a brick.
    pub exact: Exact<'a>,
    /// What codes count from, see [`code_floor`].
    pub floor: u32,
}

/// Bricks along each axis of a grid of `dims` samples.
#[inline]
pub const fn brick_counts(dims: [u32; 3]) -> [u32; 3] {
    let [x, y, z] = dims;
    [x.div_ceil(BRICK), y.div_ceil(BRICK), z.div_ceil(BRICK)]
}

/// What the codes of a grid count from.
///
/// * `largest`: the largest sample; finite, not negative.
#[inline]
pub fn code_floor(largest: f32) -> u32 {
    (largest.to_bits() >> BELOW).saturating_sub(255)
}

/// The code of a sample from 0 to the largest that `floor` was made for.
#[inline]
pub fn code(sample: f32, floor: u32) -> u8 {
    let bits = sample.max(0.0).to_bits() >> BELOW;
    bits.saturating_sub(floor).min(255) as u8
}

/// The number of a half's bits; exact for finite ones.
#[inline(always)]
pub fn half_to_single<R: Real>(bits: R::Word) -> R {
    // The exponent's bias is 112 larger in single precision; subnormals become normal by multiplication.
    let magnitude = (bits & R::Word::splat(0x7fff)).shl(13);
    R::from_f32_bits(magnitude) * R::splat(f32::from_bits((112 + 127) << 23))
}

impl Bricks<'_> {
    /// The index of the sample at integer coordinates.
    ///
    /// * `strides`: bricks from one row, and from one slice, of the lattice to the next.
    #[inline(always)]
    pub(crate) fn index<R: Real>(&self, at: [R::Word; 3], strides: [R::Word; 2]) -> R::Word {
        let [x, y, z] = at;
        let within = R::Word::splat(BRICK - 1);
        let brick = x.shr(3) + y.shr(3) * strides[0] + z.shr(3) * strides[1];
        let place = R::Word::gather(self.places, brick);
        place + ((x & within) | (y & within).shl(3) | (z & within).shl(6))
    }

    /// Samples, exact.
    #[inline(always)]
    pub(crate) fn value<R: Real>(&self, index: R::Word) -> R {
        match self.exact {
            Exact::Single(samples) => R::gather(samples, index),
            Exact::Half(pairs) => {
                let pair = R::Word::gather(pairs, index.shr(1));
                let upper = (index & R::Word::splat(1)).shl(4);
                half_to_single(pair.shr_each(upper) & R::Word::splat(0xffff))
            }
        }
    }

    /// What samples are at least, and what they are below.
    #[inline(always)]
    pub(crate) fn bracket<R: Real>(&self, index: R::Word) -> (R, R) {
        let word = R::Word::gather(self.codes, index.shr(2));
        let byte = (index & R::Word::splat(3)).shl(3);
        let code = word.shr_each(byte) & R::Word::splat(0xff);
        let bits = code + R::Word::splat(self.floor);
        let zero = R::Word::splat(0);
        let low = R::Word::select(code.eq(zero), zero, bits.shl(BELOW));
        let high = (bits + R::Word::splat(1)).shl(BELOW);
        (R::from_f32_bits(low), R::from_f32_bits(high))
    }
}
