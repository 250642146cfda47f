//! Random numbers keyed by path: uniform number n of a path is a pure function of its [`Key`].
//!
//! Each path owns a PCG32 ([O'Neill 2014], rand_pcg's `Lcg64Xsh32`). The key is hashed into the
//! generator's *state*; the increment is one constant, because streams that differ only in
//! increment correlate. The stream travels with the path, not with the lane, and a draw advances
//! only the active lanes; so the numbers of a path depend on nothing but its key.

use rand_core::Rng;
use rand_pcg::Lcg64Xsh32;

use crate::real::{Mask, Real, Word, Word32};

/// What identifies a path, and with it all its random numbers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Key {
    /// Seed of the whole image.
    pub seed: u64,
    /// Index of the pixel in the uncropped image, row by row.
    pub pixel: u32,
    /// Index of the sample in its pixel.
    pub sample: u32,
}

/// The one stream selector: any odd increment serves, as states carry the key.
pub const PCG_STREAM: u64 = 0x5bf0_3635_d6a5_6a85;
/// Multiplier of the generator's recurrence.
pub const PCG_MULTIPLIER: u64 = 6_364_136_223_846_793_005;
/// Increment of the generator's recurrence, as rand_pcg forms it from the selector.
pub const PCG_INCREMENT: u64 = (PCG_STREAM << 1) | 1;

impl Key {
    /// The key as 64 well-mixed bits: three rounds of xor-shift and multiply, one a word of the key.
    ///
    /// Distinct keys of one seed give distinct states, since every round is a bijection and pixel and
    /// sample enter as one 64-bit number.
    #[inline]
    pub fn hash(self) -> u64 {
        let mix = |mut z: u64| {
            z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
            z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
            z ^ (z >> 31)
        };
        let place = (u64::from(self.pixel) << 32) | u64::from(self.sample);
        let seed = mix(self.seed.wrapping_add(0x9e37_79b9_7f4a_7c15));
        mix(mix(place ^ seed).wrapping_add(seed))
    }

    /// The generator's state after rand_pcg's `new` has been given this key's hash: what code that
    /// restates the generator over lanes begins from.
    #[inline]
    pub fn initial_state(self) -> u64 {
        self.hash()
            .wrapping_add(PCG_INCREMENT)
            .wrapping_mul(PCG_MULTIPLIER)
            .wrapping_add(PCG_INCREMENT)
    }
}

/// A source of random numbers, one independent sequence per lane.
pub trait Stream<R: Real> {
    /// The next 32 random bits of each active lane; any word elsewhere. Inactive lanes do not advance.
    fn next_word(&mut self, active: R::Mask) -> R::Word;

    /// Uniform in [0, 1) on the grid k · 2⁻²⁴. One draw.
    #[inline(always)]
    fn uniform(&mut self, active: R::Mask) -> R {
        R::from_word(self.next_word(active).shr(8)) * R::splat(1.0 / 16_777_216.0)
    }

    /// Uniform in [0, 1) from 32 bits kept to 24 significant ones: small numbers keep a relative
    /// precision that [`uniform`](Self::uniform) lacks, and so rare events their probability. One draw.
    #[inline(always)]
    fn uniform_fine(&mut self, active: R::Mask) -> R {
        fraction::<R>(self.next_word(active))
    }

    /// Exponentially distributed with mean one: a free flight in mean free paths. One draw, more with
    /// probability 6e-8.
    ///
    /// u has 32 bits kept to 24 significant, and the result is −ln(1 − u). At the upper end, where
    /// the top 24 bits are all ones, the law has no memory: add 24 ln 2 and begin anew. At the
    /// lower end, where all bits are zero, u = 2⁻³² u' with the next u'. So no mass sits on zero,
    /// and there is no longest flight.
    #[inline(always)]
    fn exponential(&mut self, active: R::Mask) -> R {
        let word = self.next_word(active);
        let u = fraction::<R>(word);
        let rare = (is_zero::<R>(word) | is_top::<R>(word)) & active;
        if rare.any() {
            return exponential_ends::<R, Self>(self, active, word, u);
        }
        u.neg_ln_1m()
    }
}

#[inline(always)]
fn is_zero<R: Real>(word: R::Word) -> R::Mask {
    word.eq(R::Word::splat(0))
}

#[inline(always)]
fn is_top<R: Real>(word: R::Word) -> R::Mask {
    word.shr(8).eq(R::Word::splat(0x00ff_ffff))
}

/// The word as a fraction of 2³², rounded to 24 significant bits, below one.
#[inline(always)]
fn fraction<R: Real>(word: R::Word) -> R {
    let high = R::from_word(word.shr(16)) * R::splat(1.0 / 65_536.0);
    let low = R::from_word(word & R::Word::splat(0xffff)) * R::splat(1.0 / 4_294_967_296.0);
    (high + low).min(R::splat(1.0 - 1.0 / 16_777_216.0))
}

/// The lanes at one of the two ends of the exponential law draw again until they have left it.
#[cold]
#[inline(never)]
fn exponential_ends<R: Real, S: Stream<R> + ?Sized>(
    stream: &mut S,
    active: R::Mask,
    mut word: R::Word,
    mut u: R,
) -> R {
    let mut offset = R::zero();
    let mut top = is_top::<R>(word) & active;
    while top.any() {
        offset = R::select(top, offset + R::splat(16.635_532), offset); // 24 ln 2
        word = R::Word::select(top, stream.next_word(top), word);
        u = R::select(top, fraction::<R>(word), u);
        top = is_top::<R>(word) & top;
    }
    let mut zero = is_zero::<R>(word) & active;
    let mut scale = R::one();
    // Below 2⁻⁹⁶ no f32 optical depth can tell the difference.
    let mut rounds = 3;
    while zero.any() && rounds > 0 {
        rounds -= 1;
        scale = R::select(zero, scale * R::splat(1.0 / 4_294_967_296.0), scale);
        word = R::Word::select(zero, stream.next_word(zero), word);
        u = R::select(zero, fraction::<R>(word) * scale, u);
        zero = is_zero::<R>(word) & zero;
    }
    offset + u.neg_ln_1m()
}

/// The stream of one path: rand_pcg's PCG32.
#[derive(Clone, Debug)]
pub struct PathStream(Lcg64Xsh32);

impl PathStream {
    /// The stream of a path, at its beginning.
    #[inline]
    pub fn new(key: Key) -> Self {
        Self(Lcg64Xsh32::new(key.hash(), PCG_STREAM))
    }
}

impl<R: Real<Mask = bool, Word = Word32>> Stream<R> for PathStream {
    #[inline(always)]
    fn next_word(&mut self, active: bool) -> Word32 {
        // A caller's mask is nearly always known true here, and the branch folds away.
        Word32(if active { self.0.next_u32() } else { 0 })
    }
}

/// Streams that can be rekeyed lane by lane, which is what refilling needs.
pub trait KeyedStream<R: Real>: Stream<R> + Clone {
    /// Streams whose keys do not matter yet.
    fn idle() -> Self;
    /// Puts the stream of a path at its beginning into a lane.
    fn set_key(&mut self, lane: usize, key: Key);
}

impl<R: Real<Mask = bool, Word = Word32>> KeyedStream<R> for PathStream {
    fn idle() -> Self {
        Self::new(Key::default())
    }
    #[inline]
    fn set_key(&mut self, lane: usize, key: Key) {
        if lane == 0 {
            *self = Self::new(key);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 2⁻³².
    const GRAIN: f32 = 1.0 / 4_294_967_296.0;

    /// A stream that gives the words it is told to, to look at both ends of a law.
    struct Words<'a>(&'a [u32]);
    impl Stream<f32> for Words<'_> {
        fn next_word(&mut self, _: bool) -> Word32 {
            let (first, rest) = self.0.split_first().expect("no word left");
            self.0 = rest;
            Word32(*first)
        }
    }
    fn exponential(words: &[u32]) -> f32 {
        Stream::<f32>::exponential(&mut Words(words), true)
    }

    #[test]
    fn exponential_is_right_at_both_ends() {
        // The smallest words keep their digits …
        assert_eq!(exponential(&[1]), GRAIN);
        assert_eq!(exponential(&[3]), 3.0 * GRAIN);
        // … zero goes on below them, twice if need be …
        assert_eq!(exponential(&[0, 1 << 31]), GRAIN / 2.0);
        assert_eq!(exponential(&[0, 0, 1 << 31]), GRAIN * GRAIN / 2.0);
        // … and the top has no end.
        let longest = exponential(&[0xffff_feff]);
        assert!((15.9..16.7).contains(&longest), "{longest}");
        let next = exponential(&[0xffff_ff00, 1 << 31]);
        assert!((next - (24.0 + 1.0) * core::f32::consts::LN_2).abs() < 2e-6);
        let far = exponential(&[0xffff_ffff, 0xffff_ffff, 1 << 31]);
        assert!((far - 49.0 * core::f32::consts::LN_2).abs() < 4e-6);
    }

    #[test]
    fn uniform_stays_below_one() {
        assert!(Stream::<f32>::uniform(&mut Words(&[u32::MAX]), true) < 1.0);
        assert!(Stream::<f32>::uniform_fine(&mut Words(&[u32::MAX]), true) < 1.0);
        assert_eq!(Stream::<f32>::uniform_fine(&mut Words(&[1]), true), GRAIN);
    }

    #[test]
    fn the_initial_state_is_that_of_rand_pcg() {
        let key = Key {
            seed: 7,
            pixel: 11,
            sample: 13,
        };
        let mut state = key.initial_state();
        let mut stream = PathStream::new(key);
        for _ in 0..8 {
            let xorshifted = (((state >> 18) ^ state) >> 27) as u32;
            let expected = xorshifted.rotate_right((state >> 59) as u32);
            state = state
                .wrapping_mul(PCG_MULTIPLIER)
                .wrapping_add(PCG_INCREMENT);
            assert_eq!(
                Stream::<f32>::next_word(&mut stream, true),
                Word32(expected)
            );
        }
    }
}
