//! Points that lie well: the first choices of the sixteen paths of a *replicate* share out the unit interval.
//!
//! Sixteen paths of a pixel with consecutive samples form a replicate. Each of their first choices (where in the pixel, how
//! far, whereto) takes a number from its own sixteenth of [0, 1), and within a group of four choices any two of them form a
//! (0, 4, 2)-net: every elementary rectangle of area 1/16 holds one point. Within its sixteenth a number is as random as the
//! path's own stream makes it, and all further choices come from the stream alone.
//!
//! ```text
//! u = (P_d(C_d · π_g(i)) + ξ) / 16,   i = sample mod 16
//! ```
//!
//! C_d generates the net [Sobol' 1967], P_d is Owen's nested scrambling of its four digits [Owen 1995], and π_g shuffles the
//! order in each group, so that groups are independent of each other [Burley 2020]. Each number alone is uniform on
//! [0, 1), independent of those of other choices: so any estimate keeps its mean. The paths of a replicate are not
//! independent of each other; replicates are, and their spread is what the variance is estimated from.
//!
//! A path's points are a function of its [`Key`] alone.

use crate::real::{Mask, Real, Word, Word32};
use crate::stream::{Key, Stream};

/// Paths of a replicate.
pub const REPLICATE: u32 = 16;
/// Digits of a stratum.
const DIGITS: u32 = 4;
/// Choices that share a net.
const GROUP: usize = 4;

/// A choice whose number is stratified.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u32)]
pub enum Choice {
    /// Across the pixel.
    PixelX = 0,
    /// Down the pixel.
    PixelY = 1,
    /// The first flight of the camera ray.
    Flight0 = 2,
    /// Whether the camera ray's first tentative collision is real.
    Acceptance = 3,
    /// Cosine of the first scattering.
    Cosine0 = 4,
    /// Azimuth of the first scattering.
    Turn0 = 5,
    /// The flight after it.
    Flight1 = 6,
    /// Which light the first scattering looks for.
    Light = 7,
    /// Cosine of the second scattering.
    Cosine1 = 8,
    /// Azimuth of the second scattering.
    Turn1 = 9,
    /// The flight after it.
    Flight2 = 10,
    /// Place on the lens.
    LensRadius = 12,
    /// Place on the lens.
    LensTurn = 13,
    /// Cosine of the third scattering.
    Cosine2 = 14,
    /// Azimuth of the third scattering.
    Turn2 = 15,
}

/// Generating matrices of a group's choices, by columns, the leading digit of the number highest. Found by search among
/// all upper triangular ones; any two of them give a (0, 4, 2)-net.
const COLUMNS: [[u64; DIGITS as usize]; GROUP] = [
    [0b1000, 0b0100, 0b1110, 0b0011],
    [0b1000, 0b0100, 0b0110, 0b0111],
    [0b1000, 0b1100, 0b1010, 0b0101],
    [0b1000, 0b1100, 0b0010, 0b1001],
];

/// A digit of sixteen in each: 0, 1, … 15.
const ORDER: u64 = 0xfedc_ba98_7654_3210;

/// The digit at a place of a packed table of sixteen.
#[inline(always)]
const fn digit(table: u64, place: u64) -> u64 {
    (table >> ((place & 15) * 4)) & 15
}

/// The numbers of a group's choice before scrambling, in the order of points.
const NETS: [u64; GROUP] = {
    let mut nets = [0; GROUP];
    let mut d = 0;
    while d < GROUP {
        let mut i = 0;
        while i < 16 {
            let mut x = 0;
            let mut k = 0;
            while k < DIGITS as usize {
                if (i >> k) & 1 == 1 {
                    x ^= COLUMNS[d][k];
                }
                k += 1;
            }
            nets[d] |= x << (i * 4);
            i += 1;
        }
        d += 1;
    }
    nets
};

/// Orders that a group's points may come in.
const SHUFFLES: usize = 64;

/// The nets in each of these orders: random ones, by Fisher and Yates.
const SHUFFLED: [[u64; GROUP]; SHUFFLES] = {
    let mut all = [[0; GROUP]; SHUFFLES];
    let mut state = 0x243f_6a88_85a3_08d3_u64;
    let mut s = 0;
    while s < SHUFFLES {
        let mut order = ORDER;
        let mut last = 15;
        while last > 0 {
            state = state
                .wrapping_mul(0x5851_f42d_4c95_7f2d)
                .wrapping_add(0x1405_7b7e_f767_814f);
            let other = (state >> 33) % (last + 1);
            let difference = digit(order, last) ^ digit(order, other);
            order ^= (difference << (last * 4)) ^ (difference << (other * 4));
            last -= 1;
        }
        let mut d = 0;
        while d < GROUP {
            let mut i = 0;
            while i < 16 {
                all[s][d] |= digit(NETS[d], digit(order, i)) << (i * 4);
                i += 1;
            }
            d += 1;
        }
        s += 1;
    }
    all
};

/// The strata of a path's choices, four bits each.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Strata(u64);

impl Strata {
    /// The lower and upper half, as lanes keep them.
    #[inline(always)]
    pub const fn words(self) -> [u32; 2] {
        [self.0 as u32, (self.0 >> 32) as u32]
    }

    /// The stratum of a choice, below [`REPLICATE`].
    #[inline]
    pub const fn of(self, choice: Choice) -> u32 {
        digit(self.0, choice as u64) as u32
    }
}

/// The strata of the sixteen paths of a replicate, in the order of their samples.
///
/// * `key`: of any path of the replicate.
#[inline]
pub fn replicate(key: Key) -> [Strata; REPLICATE as usize] {
    // Streams are keyed by the same hash of other keys: the seed tells them apart.
    let mut state = Key {
        seed: key.seed ^ 0x6a09_e667_f3bc_c909,
        pixel: key.pixel,
        sample: key.sample / REPLICATE,
    }
    .hash();
    let mut random = || {
        state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (state ^ (state >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    };
    let mut paths = [0_u64; REPLICATE as usize];
    for group in 0..16 / GROUP {
        let nets = &SHUFFLED[(random() % SHUFFLES as u64) as usize];
        // Sixteen bits for each choice, of which scrambling takes fifteen.
        let trees = random();
        for (d, net) in nets.iter().enumerate() {
            let table = scrambling(trees >> (16 * d));
            let place = (group * GROUP + d) * 4;
            for (i, path) in paths.iter_mut().enumerate() {
                *path |= digit(table, digit(*net, i as u64)) << place;
            }
        }
    }
    paths.map(Strata)
}

/// A random word that the paths of a replicate have in common.
///
/// * `key`: of any of them.
#[inline]
pub fn common(key: Key) -> u32 {
    let key = Key {
        seed: key.seed ^ 0xbb67_ae85_84ca_a73b,
        pixel: key.pixel,
        sample: key.sample / REPLICATE,
    };
    key.hash() as u32
}

/// The strata of one path.
#[inline]
pub fn strata(key: Key) -> Strata {
    replicate(key)[(key.sample % REPLICATE) as usize]
}

/// Owen's scrambling of four digits, as a packed table: a digit is flipped or not by a random bit that belongs to the
/// digits above it.
#[inline(always)]
const fn scrambling(tree: u64) -> u64 {
    // The lowest bits of `tree`, one to each part of the table whose numbers begin alike, at the part's lowest bit.
    const fn to_bytes(bits: u64) -> u64 {
        let one_each = ((bits & 0xff) * 0x0101_0101_0101_0101) & 0x8040_2010_0804_0201;
        ((one_each + 0x7f7f_7f7f_7f7f_7f7f) >> 7) & 0x0101_0101_0101_0101
    }
    const fn to_quarters(bits: u64) -> u64 {
        let one_each = ((bits & 15) * 0x0001_0001_0001_0001) & 0x0008_0004_0002_0001;
        ((one_each + 0x7fff_7fff_7fff_7fff) >> 15) & 0x0001_0001_0001_0001
    }
    let all = (tree & 1) * 0x8888_8888_8888_8888;
    let halves = (((tree >> 1) & 1) | ((tree & 4) << 30)) * 0x4444_4444;
    let quarters = to_quarters(tree >> 3) * 0x2222;
    let bytes = to_bytes(tree >> 7) * 0x11;
    ORDER ^ (all | halves | quarters | bytes)
}

/// The strata of the path in each lane.
#[derive(Clone, Copy, Debug)]
pub struct LaneStrata<W> {
    digits: [W; 2],
    common: W,
}

impl<W: Word> LaneStrata<W> {
    /// No path yet.
    #[inline(always)]
    pub fn idle() -> Self {
        Self::new([W::splat(0); 2])
    }

    /// From the lower and upper halves of each lane's [`Strata`].
    #[inline(always)]
    pub fn new(words: [W; 2]) -> Self {
        Self {
            digits: words,
            common: W::splat(0),
        }
    }

    /// With the word that the paths of each lane's replicate have in [common](common()).
    #[inline(always)]
    #[must_use]
    pub fn with_common(self, common: W) -> Self {
        Self { common, ..self }
    }

    /// A word for the choice number `index` of those that a path makes along its way: as random as any, but in the paths of a
    /// replicate their leading digits are those of all sixteenths, as those of `word` are.
    #[inline(always)]
    pub fn rotated(&self, word: W, index: W) -> W {
        // Multiply and xorshift, with the constants of [Wellons 2018].
        let mut z = self.common + index * W::splat(0x9e37_79b9);
        z = (z ^ z.shr(16)) * W::splat(0x7feb_352d);
        z = (z ^ z.shr(15)) * W::splat(0x846c_a68b);
        word + (z ^ z.shr(16))
    }

    /// The lower and upper halves.
    #[inline(always)]
    pub fn words(self) -> [W; 2] {
        self.digits
    }

    /// `if_true` where the mask holds, else `if_false`.
    #[inline(always)]
    pub fn select(mask: W::Mask, if_true: Self, if_false: Self) -> Self {
        let [a, b] = if_true.digits;
        let [c, d] = if_false.digits;
        Self {
            digits: [W::select(mask, a, c), W::select(mask, b, d)],
            common: W::select(mask, if_true.common, if_false.common),
        }
    }

    /// Strata for one more branch of the same path, which has `rest` more to come. The four strata of each choice that branches
    /// have lie within a quarter, and those of two choices in different rows and columns of it, so that sixteen paths with four
    /// branches share out the unit square more finely than without.
    #[inline(always)]
    pub fn branched(self, rest: W) -> Self {
        let odd = (rest & W::splat(1)).eq(W::splat(1));
        let step = W::select(odd, W::splat(0x3112_3112), W::splat(0x2321_2321));
        Self {
            digits: self.digits.map(|word| word ^ step),
            ..self
        }
    }

    /// Replaces the strata of one lane.
    #[inline(always)]
    pub fn set_lane(&mut self, lane: usize, strata: LaneStrata<Word32>) {
        for (words, Word32(word)) in self.digits.iter_mut().zip(strata.digits) {
            words.set_lane(lane, word);
        }
        self.common.set_lane(lane, strata.common.0);
    }

    /// The stratum of a choice as the leading digits of a word.
    #[inline(always)]
    pub fn leading(&self, choice: Choice) -> W {
        self.leading_of(choice as u32)
    }

    /// The stratum of one of the sixteen choices by its number, for paths whose choices are others than [`Choice`] names.
    #[inline(always)]
    pub fn leading_of(&self, place: u32) -> W {
        let word = self.digits[((place / 8) & 1) as usize];
        word.shr(4 * (place % 8)).shl(32 - DIGITS)
    }
}

/// A stream whose next words have given leading digits, in the lanes that still have any; all else is the stream's own.
///
/// Words beyond those given are untouched, so that a draw that takes a second word in rare cases is right.
#[derive(Debug)]
pub struct Stratified<'a, R: Real, S: ?Sized, const N: usize> {
    stream: &'a mut S,
    leading: [R::Word; N],
    lanes: R::Mask,
    drawn: usize,
}

impl<'a, R: Real, S: Stream<R>, const N: usize> Stratified<'a, R, S, N> {
    /// * `leading`: by draw, per lane. `lanes`: that take them.
    #[inline(always)]
    pub fn new(stream: &'a mut S, leading: [R::Word; N], lanes: R::Mask) -> Self {
        Self {
            stream,
            leading,
            lanes,
            drawn: 0,
        }
    }
}

impl<R: Real, S: Stream<R>, const N: usize> Stream<R> for Stratified<'_, R, S, N> {
    #[inline(always)]
    fn next_word(&mut self, active: R::Mask) -> R::Word {
        let word = self.stream.next_word(active);
        let Some(leading) = self.leading.get(self.drawn) else {
            return word;
        };
        self.drawn += 1;
        if !self.lanes.any() {
            return word;
        }
        R::Word::select(self.lanes, *leading | word.shr(DIGITS), word)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::real::Word32;

    const ALL: [Choice; 15] = [
        Choice::PixelX,
        Choice::PixelY,
        Choice::Flight0,
        Choice::Acceptance,
        Choice::Cosine0,
        Choice::Turn0,
        Choice::Flight1,
        Choice::Light,
        Choice::Cosine1,
        Choice::Turn1,
        Choice::Flight2,
        Choice::LensRadius,
        Choice::LensTurn,
        Choice::Cosine2,
        Choice::Turn2,
    ];

    fn key(pixel: u32, sample: u32) -> Key {
        Key {
            seed: 5,
            pixel,
            sample,
        }
    }

    #[test]
    fn each_choice_fills_every_stratum_once() {
        for pixel in 0..200 {
            let paths = replicate(key(pixel, 16 * 7));
            for choice in ALL {
                let seen = paths.iter().fold(0_u32, |m, p| m | 1 << p.of(choice));
                assert_eq!(seen, 0xffff, "{choice:?}");
            }
        }
    }

    /// Every elementary rectangle of area 1/16 holds one point of any two choices of a group.
    #[test]
    fn two_choices_of_a_group_form_a_net() {
        for pixel in 0..50 {
            let paths = replicate(key(pixel, 3));
            for (i, a) in ALL.iter().enumerate() {
                for b in &ALL[i + 1..] {
                    if *a as usize / GROUP != *b as usize / GROUP {
                        continue;
                    }
                    for digits in 0..=DIGITS {
                        let cell = |p: &Strata| {
                            p.of(*a) >> (4 - digits) << (4 - digits) | p.of(*b) >> digits
                        };
                        let seen = paths.iter().fold(0_u32, |m, p| m | 1 << cell(p));
                        assert_eq!(seen, 0xffff, "{a:?} {b:?} {digits}");
                    }
                }
            }
        }
    }

    /// Chi-square of pairs of strata of one path over replicates: no choice of a path tells of another.
    #[test]
    fn choices_of_one_path_are_independent() {
        let n = 40_000;
        let path = |pixel| strata(key(pixel, pixel % 16));
        for (i, a) in ALL.iter().enumerate() {
            for b in &ALL[i + 1..] {
                let mut counts = [0_u32; 256];
                for p in (0..n).map(path) {
                    counts[(p.of(*a) * 16 + p.of(*b)) as usize] += 1;
                }
                let expected = f64::from(n) / 256.0;
                let chi: f64 = counts
                    .iter()
                    .map(|c| (f64::from(*c) - expected).powi(2) / expected)
                    .sum();
                // 255 degrees of freedom: mean 255, deviation 22.6; six deviations for 105 pairs.
                assert!(chi < 255.0 + 6.0 * 22.6, "{a:?} {b:?}: {chi}");
            }
        }
    }

    /// All 2¹⁵ scramblings: numbers share as many leading digits as before, and each number becomes each other equally often.
    #[test]
    fn scrambling_is_nested_and_fair() {
        let mut became = [[0_u32; 16]; 16];
        for tree in 0..1 << 15 {
            let table = scrambling(tree);
            for a in 0..16 {
                became[a as usize][digit(table, a) as usize] += 1;
                for b in 0..a {
                    let apart = digit(table, a) ^ digit(table, b);
                    assert_eq!(apart.leading_zeros(), (a ^ b).leading_zeros(), "{tree:x}");
                }
            }
        }
        assert_eq!(became, [[1 << 11; 16]; 16]);
    }

    /// The words of a choice on the way, of all paths of a replicate: one in each sixteenth, wherever it begins.
    #[test]
    fn choices_on_the_way_share_out_their_interval() {
        let mut before = 0;
        for pixel in 0..200 {
            for index in 1..20 {
                let mut words = [0_u32; 16];
                for (i, word) in words.iter_mut().enumerate() {
                    let key = key(pixel, i as u32);
                    let strata = LaneStrata::new(strata(key).words().map(Word32));
                    let strata = strata.with_common(Word32(common(key)));
                    let leading = strata.leading(Choice::Flight0);
                    *word = strata.rotated(leading, Word32(index)).0;
                }
                words.sort_unstable();
                assert!(
                    words.windows(2).all(|w| w[1] - w[0] == 1 << 28),
                    "{words:x?}"
                );
                // Neighbouring choices begin anywhere.
                let offset = words[0];
                before += u32::from(offset > 1 << 27);
            }
        }
        // 3800 of chance one half: deviation 31.
        assert!(before.abs_diff(1900) < 6 * 31, "{before}");
        assert_ne!(common(key(9, 0)), common(key(9, 16)));
        assert_eq!(common(key(9, 0)), common(key(9, 15)));
    }

    /// Four branches of a path: for two choices four strata in rows and columns of their own, within the quarter of the path's.
    #[test]
    fn branches_lie_apart_within_a_quarter() {
        let pairs = [
            [Choice::Cosine0, Choice::Turn0],
            [Choice::Cosine0, Choice::Flight1],
            [Choice::Cosine1, Choice::Turn1],
        ];
        for [a, b] in pairs {
            for sample in 0..16 {
                let own = LaneStrata::new(strata(key(3, sample)).words().map(Word32));
                let mut branch = own;
                let mut seen = [0_u32; 2];
                for rest in (0..4).rev() {
                    branch = branch.branched(Word32(rest));
                    for (seen, choice) in seen.iter_mut().zip([a, b]) {
                        let digit = branch.leading(choice).0 >> 28;
                        assert_eq!(digit >> 2, own.leading(choice).0 >> 30);
                        *seen |= 1 << (digit & 3);
                    }
                }
                assert_eq!(seen, [15, 15], "{a:?} {b:?}");
            }
        }
    }

    #[test]
    fn a_path_has_the_strata_of_its_replicate() {
        for sample in 0..64 {
            let all = replicate(key(9, sample / 16 * 16));
            assert_eq!(strata(key(9, sample)), all[(sample % 16) as usize]);
        }
        assert_ne!(replicate(key(9, 0)), replicate(key(9, 16)));
        assert_ne!(replicate(key(9, 0)), replicate(key(10, 0)));
    }
}
