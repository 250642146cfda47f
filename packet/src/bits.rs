//! PCG32 over lanes: rand_pcg's generator restated, word for word, for eight paths at once.
//!
//! The 64-bit states lie in two vectors, those of the even lanes and those of the odd ones. So the
//! 32-bit results of both interleave without a permutation, and a 64-bit product takes three
//! 32-bit multiplications, as its upper half is not needed.

use bytemuck::cast;
use wide::u32x8;
use woodcock_core::stream::{Key, KeyedStream, PCG_INCREMENT, PCG_MULTIPLIER, Stream};

use crate::lanes::{LANES, LaneMask, LaneWords, Lanes};

/// The streams of eight paths.
#[derive(Clone, Debug, Default)]
pub struct LaneStream {
    even: u32x8,
    odd: u32x8,
}

impl LaneStream {
    /// Replaces the states of the given lanes, from their lower and upper halves.
    #[inline(always)]
    pub(crate) fn set_states(&mut self, low: LaneWords, high: LaneWords, lanes: LaneMask) {
        let (even, odd) = vector::interleave(low.0, high.0);
        let (even_mask, odd_mask) = vector::spread(lanes.words());
        self.even = vector::select(even_mask, even, self.even);
        self.odd = vector::select(odd_mask, odd, self.odd);
    }

    /// Replaces the state of one lane < 8, from its lower and upper half.
    #[inline(always)]
    pub(crate) fn set_state(&mut self, lane: usize, [low, high]: [u32; 2]) {
        let states = if lane.is_multiple_of(2) {
            &mut self.even
        } else {
            &mut self.odd
        };
        let halves = states.as_mut_array();
        let at = lane & !1 & (LANES - 1);
        halves[at] = low;
        halves[at + 1] = high;
    }

    /// The lower and upper halves of the states, by lane.
    #[inline(always)]
    pub(crate) fn states(&self) -> [[u32; LANES]; 2] {
        let (even, odd): ([u64; 4], [u64; 4]) = (cast(self.even), cast(self.odd));
        let state = |lane: usize| {
            let half = if lane.is_multiple_of(2) { even } else { odd };
            half[lane / 2]
        };
        [
            core::array::from_fn(|lane| state(lane) as u32),
            core::array::from_fn(|lane| (state(lane) >> 32) as u32),
        ]
    }
}

impl Stream<Lanes> for LaneStream {
    #[inline(always)]
    fn next_word(&mut self, active: LaneMask) -> LaneWords {
        let word = vector::output(self.even, self.odd);
        let (even, odd) = (vector::advance(self.even), vector::advance(self.odd));
        let (even_mask, odd_mask) = vector::spread(active.words());
        self.even = vector::select(even_mask, even, self.even);
        self.odd = vector::select(odd_mask, odd, self.odd);
        LaneWords(word)
    }
}

impl KeyedStream<Lanes> for LaneStream {
    fn idle() -> Self {
        Self {
            even: u32x8::splat(0),
            odd: u32x8::splat(0),
        }
    }
    #[inline]
    fn set_key(&mut self, lane: usize, key: Key) {
        if lane >= LANES {
            return;
        }
        let states = if lane.is_multiple_of(2) {
            &mut self.even
        } else {
            &mut self.odd
        };
        let mut array: [u64; 4] = cast(*states);
        array[lane / 2] = key.initial_state();
        *states = cast(array);
    }
}

/// The generator on four 64-bit states, as AVX2 has it.
#[cfg(all(target_arch = "x86_64", target_feature = "avx2"))]
mod vector {
    use super::{PCG_INCREMENT, PCG_MULTIPLIER, cast, u32x8};
    use safe_arch::{
        add_i64_m256i, bitxor_m256i, blend_imm_i32_m256i, blend_varying_i8_m256i, m256i,
        mul_u64_low_bits_m256i, set_splat_i64_m256i, shl_imm_u64_m256i, shr_each_u64_m256i,
        shr_imm_u64_m256i, shuffle_ai_i32_half_m256i,
    };

    /// state · multiplier + increment, modulo 2⁶⁴.
    #[inline(always)]
    pub(super) fn advance(state: u32x8) -> u32x8 {
        let state: m256i = cast(state);
        let low = set_splat_i64_m256i((PCG_MULTIPLIER & 0xffff_ffff) as i64);
        let high = set_splat_i64_m256i((PCG_MULTIPLIER >> 32) as i64);
        let increment = set_splat_i64_m256i(PCG_INCREMENT.cast_signed());
        let cross = add_i64_m256i(
            mul_u64_low_bits_m256i(state, high),
            mul_u64_low_bits_m256i(shr_imm_u64_m256i::<32>(state), low),
        );
        let product = add_i64_m256i(mul_u64_low_bits_m256i(state, low), increment);
        cast(add_i64_m256i(product, shl_imm_u64_m256i::<32>(cross)))
    }

    /// The XSH-RR permutation, its result in the low half of each state's place.
    #[inline(always)]
    fn permuted(state: m256i) -> m256i {
        let mixed = bitxor_m256i(shr_imm_u64_m256i::<18>(state), state);
        let word = shr_imm_u64_m256i::<27>(mixed);
        // A rotation of 32 bits is a shift of the word written twice.
        let twice = shuffle_ai_i32_half_m256i::<0b10_10_00_00>(word);
        shr_each_u64_m256i(twice, shr_imm_u64_m256i::<59>(state))
    }

    /// The next words of even and odd states, interleaved.
    #[inline(always)]
    pub(super) fn output(even: u32x8, odd: u32x8) -> u32x8 {
        let even = permuted(cast(even));
        let odd = shl_imm_u64_m256i::<32>(permuted(cast(odd)));
        cast(blend_imm_i32_m256i::<0b1010_1010>(even, odd))
    }

    /// The masks of the even lanes' states and of the odd ones'.
    #[inline(always)]
    pub(super) fn spread(mask: u32x8) -> (u32x8, u32x8) {
        let mask: m256i = cast(mask);
        let even = shuffle_ai_i32_half_m256i::<0b10_10_00_00>(mask);
        let odd = shuffle_ai_i32_half_m256i::<0b11_11_01_01>(mask);
        (cast(even), cast(odd))
    }

    /// The states of the even lanes and of the odd ones from the halves of all.
    #[inline(always)]
    pub(super) fn interleave(low: u32x8, high: u32x8) -> (u32x8, u32x8) {
        let (low, high): (m256i, m256i) = (cast(low), cast(high));
        let even = blend_imm_i32_m256i::<0b1010_1010>(low, shl_imm_u64_m256i::<32>(high));
        let odd = blend_imm_i32_m256i::<0b1010_1010>(shr_imm_u64_m256i::<32>(low), high);
        (cast(even), cast(odd))
    }

    #[inline(always)]
    pub(super) fn select(mask: u32x8, if_true: u32x8, if_false: u32x8) -> u32x8 {
        cast(blend_varying_i8_m256i(
            cast(if_false),
            cast(if_true),
            cast(mask),
        ))
    }
}

/// The same in plain integers, which compilers turn into what the target has.
#[cfg(not(all(target_arch = "x86_64", target_feature = "avx2")))]
mod vector {
    use super::{PCG_INCREMENT, PCG_MULTIPLIER, cast, u32x8};

    #[inline(always)]
    fn map(state: u32x8, f: impl Fn(u64) -> u64) -> u32x8 {
        let states: [u64; 4] = cast(state);
        cast(states.map(f))
    }

    #[inline(always)]
    pub(super) fn advance(state: u32x8) -> u32x8 {
        map(state, |s| {
            s.wrapping_mul(PCG_MULTIPLIER).wrapping_add(PCG_INCREMENT)
        })
    }

    #[inline(always)]
    pub(super) fn output(even: u32x8, odd: u32x8) -> u32x8 {
        let permuted = |s: u64| {
            let word = (((s >> 18) ^ s) >> 27) as u32;
            u64::from(word.rotate_right((s >> 59) as u32))
        };
        map(even, permuted) | map(odd, |s| permuted(s) << 32)
    }

    #[inline(always)]
    pub(super) fn spread(mask: u32x8) -> (u32x8, u32x8) {
        (
            map(mask, |m| (m & 0xffff_ffff).wrapping_mul(0x1_0000_0001)),
            map(mask, |m| (m >> 32).wrapping_mul(0x1_0000_0001)),
        )
    }

    #[inline(always)]
    pub(super) fn interleave(low: u32x8, high: u32x8) -> (u32x8, u32x8) {
        let (l, h) = (low.to_array(), high.to_array());
        let state = |i: usize| (u64::from(h[i]) << 32) | u64::from(l[i]);
        (
            cast([state(0), state(2), state(4), state(6)]),
            cast([state(1), state(3), state(5), state(7)]),
        )
    }

    #[inline(always)]
    pub(super) fn select(mask: u32x8, if_true: u32x8, if_false: u32x8) -> u32x8 {
        (mask & if_true) | (if_false & !mask)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use woodcock_core::real::{Mask, Word32};
    use woodcock_core::stream::PathStream;

    #[test]
    fn lanes_repeat_rand_pcg_word_for_word() {
        let key = |lane: usize| Key {
            seed: 99,
            pixel: lane as u32 * 7,
            sample: 3,
        };
        let mut lanes = LaneStream::idle();
        let mut singles: [PathStream; LANES] = core::array::from_fn(|i| PathStream::new(key(i)));
        for lane in 0..LANES {
            lanes.set_key(lane, key(lane));
        }
        for round in 0..1000_u32 {
            // Lanes are drawn in ever other patterns; the idle ones must stand still.
            let active = LaneMask::from_bits(round.wrapping_mul(0x9e37_79b9) >> 24);
            let words = lanes.next_word(active).to_array();
            for (lane, single) in singles.iter_mut().enumerate() {
                if active.bits() >> lane & 1 == 1 {
                    let expected: Word32 = Stream::<f32>::next_word(single, true);
                    assert_eq!(words[lane], expected.0, "round {round}, lane {lane}");
                }
            }
        }
    }
}
