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

    /// Uniform in [0, 1) with 24 significant bits however small it is: a rare event keeps its
    /// probability, which [`uniform`](Self::uniform) denies it.
    ///
    /// P(u < x) = x within a relative 2⁻²³ for all real x in [2⁻¹⁰⁴, 1], and within 2⁻¹²⁸ below. One
    /// draw, with probability 2⁻⁸ a second, with 2⁻⁴⁰ a third.
    #[inline(always)]
    fn uniform_fine(&mut self, active: R::Mask) -> R {
        let word = self.next_word(active);
        if (is_at_an_end::<R>(word) & active).any() {
            return uniform_ends::<R, Self>(self, active, word);
        }
        fraction::<R>(word)
    }

    /// Exponentially distributed with mean one: a free flight in mean free paths. One draw, with
    /// probability 2⁻⁸ more.
    ///
    /// The result is −ln(1 − u) with u as in [`uniform_fine`](Self::uniform_fine), so that the
    /// shortest flights have their probability, to the digits stated there. At the upper end, where
    /// the top 24 bits of u are all ones, the law has no memory: add 24 ln 2 and begin anew. So no
    /// mass sits on zero, and there is no longest flight.
    #[inline(always)]
    fn exponential(&mut self, active: R::Mask) -> R {
        let word = self.next_word(active);
        if (is_at_an_end::<R>(word) & active).any() {
            return exponential_ends::<R, Self>(self, active, word);
        }
        fraction::<R>(word).neg_ln_1m()
    }
}

/// Whether a word is [low](is_low) or at the [top](is_top), in one comparison, as every draw asks.
#[inline(always)]
fn is_at_an_end<R: Real>(word: R::Word) -> R::Mask {
    // The top 2⁸ words wrap around to the bottom.
    (word + R::Word::splat(1 << 8))
        .shr(24)
        .eq(R::Word::splat(0))
}

/// Whether a word is below 2²⁴ − 2⁸, where one more or less of it is more than the rounding to 24 bits.
#[inline(always)]
fn is_low<R: Real>(word: R::Word) -> R::Mask {
    is_at_an_end::<R>(word).and_not(is_top::<R>(word))
}

/// Whether the top 24 bits of a word are all ones: its fraction is next to one or rounded to it.
#[inline(always)]
fn is_top<R: Real>(word: R::Word) -> R::Mask {
    word.shr(8).eq(R::Word::splat(0x00ff_ffff))
}

/// The word as a fraction of 2³², rounded to 24 significant bits: in [0, 1].
#[inline(always)]
fn fraction<R: Real>(word: R::Word) -> R {
    let high = R::from_word(word.shr(16)) * R::splat(1.0 / 65_536.0);
    let low = R::from_word(word & R::Word::splat(0xffff)) * R::splat(GRAIN);
    high + low
}

/// 2⁻³²: what the last bit of a word stands for.
const GRAIN: f32 = 1.0 / 4_294_967_296.0;

/// The word as a fraction of 2³²; where it is low, its digits go on in words drawn anew.
///
/// ```text
/// u = (word + next · 2⁻³²) · 2⁻³², and where word = 0 and next is low: (next + another · 2⁻³²) · 2⁻⁶⁴ …
/// ```
///
/// These are the first words of a number with endless random digits, as many as its rounding to 24
/// bits can tell. Rounding keeps their order, so that counting words gives the distribution.
#[inline(always)]
fn refined<R: Real, S: Stream<R> + ?Sized>(
    stream: &mut S,
    active: R::Mask,
    mut word: R::Word,
) -> R {
    let mut u = fraction::<R>(word);
    let mut low = is_low::<R>(word) & active;
    let mut scale = R::one();
    // The fourth word stands for multiples of 2⁻¹²⁸, where f32 itself is about to end.
    let mut rounds = 3;
    while low.any() && rounds > 0 {
        rounds -= 1;
        scale = scale * R::splat(GRAIN);
        let next = stream.next_word(low);
        u = R::select(low, (R::from_word(word) + fraction::<R>(next)) * scale, u);
        low = low & word.eq(R::Word::splat(0)) & is_low::<R>(next);
        word = next;
    }
    u
}

/// [`Stream::uniform_fine`] where a lane is at an end.
#[cold]
#[inline(never)]
fn uniform_ends<R: Real, S: Stream<R> + ?Sized>(
    stream: &mut S,
    active: R::Mask,
    word: R::Word,
) -> R {
    refined(stream, active, word).min(R::splat(1.0 - 1.0 / 16_777_216.0))
}

/// [`Stream::exponential`] where a lane is at an end: those at the top draw until they have left it.
#[cold]
#[inline(never)]
fn exponential_ends<R: Real, S: Stream<R> + ?Sized>(
    stream: &mut S,
    active: R::Mask,
    mut word: R::Word,
) -> R {
    let mut offset = R::zero();
    let mut top = is_top::<R>(word) & active;
    while top.any() {
        offset = R::select(top, offset + R::splat(16.635_532), offset); // 24 ln 2
        word = R::Word::select(top, stream.next_word(top), word);
        top = is_top::<R>(word) & top;
    }
    offset + refined(stream, active, word).neg_ln_1m()
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

    fn uniform_fine(words: &[u32]) -> f32 {
        Stream::<f32>::uniform_fine(&mut Words(words), true)
    }

    #[test]
    fn small_numbers_keep_their_digits() {
        let half = 1 << 31;
        // Where grains are finer than the rounding, one word is enough; `Words` has no more.
        assert_eq!(uniform_fine(&[0x0100_0000]), 1.0 / 256.0);
        assert_eq!(uniform_fine(&[0x00ff_ff00]), 16_776_960.0 * GRAIN);
        // Below that, the next word is the rest of a grain …
        assert_eq!(uniform_fine(&[0x007f_ffff, half]), 8_388_607.5 * GRAIN);
        assert_eq!(uniform_fine(&[3, half]), 3.5 * GRAIN);
        assert_eq!(uniform_fine(&[1, 1]), GRAIN);
        assert_eq!(uniform_fine(&[1, u32::MAX]), 2.0 * GRAIN);
        // … and nothing but it after a zero, again with a next word where it is small.
        assert_eq!(uniform_fine(&[0, half]), GRAIN / 2.0);
        assert_eq!(uniform_fine(&[0, 3, half]), 3.5 * GRAIN * GRAIN);
        assert_eq!(uniform_fine(&[0, 0, half]), GRAIN * GRAIN / 2.0);
        let smallest = GRAIN * GRAIN * GRAIN * GRAIN;
        assert_eq!(uniform_fine(&[0, 0, 0, 1]), smallest);
        assert_eq!(uniform_fine(&[0, 0, 0, 0]), 0.0);
        assert_eq!(exponential(&[3, half]), 3.5 * GRAIN);
        assert_eq!(exponential(&[0, 0, 0, 1]), smallest);
    }

    #[test]
    fn the_longest_flight_has_a_longer_one() {
        use core::f32::consts::LN_2;
        let longest = exponential(&[0xffff_feff]);
        assert!((15.9..16.7).contains(&longest), "{longest}");
        let next = exponential(&[0xffff_ff00, 1 << 31]);
        assert!((next - 25.0 * LN_2).abs() < 2e-6);
        let far = exponential(&[0xffff_ffff, 0xffff_ffff, 1 << 31]);
        assert!((far - 49.0 * LN_2).abs() < 4e-6);
        // What begins anew may be small: it goes on downwards as any other.
        let little = exponential(&[0xffff_ffff, 0, 0, 77, 1]);
        assert!((little - 24.0 * LN_2).abs() < 2e-6);
    }

    #[test]
    fn uniform_stays_below_one() {
        assert!(Stream::<f32>::uniform(&mut Words(&[u32::MAX]), true) < 1.0);
        for top in [0xffff_ff00, 0xffff_ff7f, 0xffff_ff80, u32::MAX] {
            assert_eq!(uniform_fine(&[top]), 1.0_f32.next_down());
        }
        assert_eq!(uniform_fine(&[0xffff_feff]), 1.0_f32.next_down());
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
