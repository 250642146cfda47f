//! Every operation of numbers, words and masks, on inputs chosen to tell implementations apart.
//!
//! Bits must be equal, but that any NaN equals any other: which payload an operation passes on is the processor's own.

use woodcock_core::real::{Binary32, Mask, Real, Word, Word32};
use woodcock_packet::lanes::{LANES, LaneMask, LaneWords, Lanes};
use woodcock_tests::stats::independent::SplitMix;

fn numbers() -> Vec<f32> {
    let tiny = f32::from_bits(1);
    let mut all = vec![
        0.0,
        1.0,
        2.0 / 3.0,
        0.1,
        3.0,
        1e-3,
        16_777_215.0,
        16_777_216.0,
        8_388_607.5,
        2_147_483_520.0,
        1e10,
        1e30,
        f32::MAX,
        f32::MIN_POSITIVE,
        f32::MIN_POSITIVE.next_down(),
        tiny,
        7.0 * tiny,
        f32::INFINITY,
        1.0_f32.next_up(),
        1.0_f32.next_down(),
        12_582_912.0,
        std::f32::consts::PI,
    ];
    let negative: Vec<f32> = all.iter().map(|x| -x).collect();
    all.extend(negative);
    all.push(f32::NAN);
    let mut rng = SplitMix::new(97);
    all.extend((0..19).map(|_| f32::from_bits(rng.bits() as u32)));
    all
}

fn words() -> Vec<u32> {
    let mut all = vec![
        0,
        1,
        2,
        7,
        8,
        31,
        32,
        255,
        256,
        65_535,
        65_536,
        0x7fff_ffff,
        0x8000_0000,
        0x8000_0001,
        u32::MAX,
    ];
    let mut rng = SplitMix::new(98);
    all.extend((0..17).map(|_| rng.bits() as u32));
    all
}

/// All pairs, eight at a time, with the position of a pair among the lanes changing.
fn pairs<T: Copy>(values: &[T], mut visit: impl FnMut([T; LANES], [T; LANES])) {
    let all: Vec<(T, T)> = values
        .iter()
        .flat_map(|&a| values.iter().map(move |&b| (a, b)))
        .collect();
    for first in 0..all.len() {
        let at = |lane: usize| all[(first + lane * 5) % all.len()];
        visit(
            std::array::from_fn(|l| at(l).0),
            std::array::from_fn(|l| at(l).1),
        );
    }
}

#[track_caller]
pub(super) fn same(name: &str, wide: f32, one: f32, inputs: &dyn std::fmt::Debug) {
    let equal = wide.to_bits() == one.to_bits() || wide.is_nan() && one.is_nan();
    assert!(
        equal,
        "{name} of {inputs:?}: lanes {wide:e}, scalar {one:e}"
    );
}

#[test]
fn numbers_agree() {
    type One = fn(f32, f32) -> f32;
    type Eight = fn(Lanes, Lanes) -> Lanes;
    let operations: [(&str, One, Eight); 11] = [
        ("sum", |a, b| a + b, |a, b| a + b),
        ("difference", |a, b| a - b, |a, b| a - b),
        ("product", |a, b| a * b, |a, b| a * b),
        ("quotient", |a, b| a / b, |a, b| a / b),
        ("minimum", Real::min, Real::min),
        ("maximum", Real::max, Real::max),
        ("negation", |a, _| -a, |a, _| -a),
        ("magnitude", |a, _| Real::abs(a), |a, _| a.abs()),
        ("root", |a, _| Real::sqrt(a), |a, _| a.sqrt()),
        (
            "select",
            |a, b| Real::select(Real::lt(a, b), a, b),
            |a, b| Real::select(a.lt(b), a, b),
        ),
        (
            "or zero",
            |a, b| a.or_zero(Real::le(a, b)),
            |a, b| a.or_zero(a.le(b)),
        ),
    ];
    pairs(&numbers(), |a, b| {
        let (wa, wb) = (Lanes::new(a), Lanes::new(b));
        for (name, one, eight) in operations {
            let wide = eight(wa, wb).to_array();
            for lane in 0..LANES {
                same(name, wide[lane], one(a[lane], b[lane]), &(a[lane], b[lane]));
            }
        }
        let (eq, lt, le) = (wa.eq(wb), wa.lt(wb), wa.le(wb));
        for lane in 0..LANES {
            assert_eq!(eq.lane(lane), Real::eq(a[lane], b[lane]));
            assert_eq!(lt.lane(lane), Real::lt(a[lane], b[lane]));
            assert_eq!(le.lane(lane), Real::le(a[lane], b[lane]));
        }
    });
}

/// The elementary functions on their domains; elsewhere they promise a number or nothing.
#[test]
fn functions_agree_on_their_domains() {
    type Functions = (
        &'static str,
        fn(f32) -> bool,
        fn(f32) -> f32,
        fn(Lanes) -> Lanes,
    );
    let functions: [Functions; 7] = [
        (
            "ln",
            |x| x >= 0.0 && x.is_finite(),
            |x| Real::ln(x),
            |x| x.ln(),
        ),
        (
            "neg_ln_1m",
            |x| (0.0..1.0).contains(&x),
            |x| x.neg_ln_1m(),
            |x| x.neg_ln_1m(),
        ),
        (
            "ln_1p",
            |x| x >= -1.0 && x.is_finite(),
            |x| Real::ln_1p(x),
            |x| x.ln_1p(),
        ),
        ("exp", |x| !x.is_nan(), |x| Real::exp(x), |x| x.exp()),
        (
            "exp_m1",
            |x| !x.is_nan(),
            |x| Real::exp_m1(x),
            |x| x.exp_m1(),
        ),
        (
            "sine",
            |x| x.abs() <= 4096.0,
            |x| x.sin_cos_turn().0,
            |x| x.sin_cos_turn().0,
        ),
        (
            "cosine",
            |x| x.abs() <= 4096.0,
            |x| x.sin_cos_turn().1,
            |x| x.sin_cos_turn().1,
        ),
    ];
    for (name, domain, one, eight) in functions {
        let inside: Vec<f32> = numbers().into_iter().filter(|&x| domain(x)).collect();
        assert!(inside.len() > 8, "{name}");
        for first in 0..inside.len() {
            let x: [f32; LANES] = std::array::from_fn(|l| inside[(first + l) % inside.len()]);
            let wide = eight(Lanes::new(x)).to_array();
            for lane in 0..LANES {
                same(name, wide[lane], one(x[lane]), &x[lane]);
            }
        }
    }
}

#[test]
fn conversions_agree() {
    for first in 0..words().len() {
        let w: [u32; LANES] = std::array::from_fn(|l| words()[(first + l) % words().len()]);
        let wide = LaneWords::new(w);
        // Words below 2^31 only, as promised.
        let low = w.map(|w| w >> 1);
        let from = Lanes::from_word(LaneWords::new(low)).to_array();
        let bits = Lanes::from_f32_bits(wide).to_array();
        let back = Binary32::to_bits(<Lanes as Binary32>::from_bits(wide)).to_array();
        for lane in 0..LANES {
            assert_eq!(
                from[lane].to_bits(),
                f32::from_word(Word32(low[lane])).to_bits()
            );
            assert_eq!(bits[lane].to_bits(), w[lane]);
            assert_eq!(back[lane], w[lane]);
        }
    }
    let inside: Vec<f32> = numbers()
        .into_iter()
        .filter(|x| (0.0..2_147_483_648.0).contains(x))
        .collect();
    for first in 0..inside.len() {
        let x: [f32; LANES] = std::array::from_fn(|l| inside[(first + l) % inside.len()]);
        let wide = Lanes::new(x).to_word().to_array();
        for lane in 0..LANES {
            assert_eq!(wide[lane], x[lane].to_word().0, "{}", x[lane]);
            assert_eq!(wide[lane], x[lane] as u32);
        }
    }
}

#[test]
fn words_agree() {
    type One = fn(Word32, Word32) -> Word32;
    type Eight = fn(LaneWords, LaneWords) -> LaneWords;
    let operations: [(&str, One, Eight); 8] = [
        ("sum", |a, b| a + b, |a, b| a + b),
        ("difference", |a, b| a - b, |a, b| a - b),
        ("product", |a, b| a * b, |a, b| a * b),
        ("and", |a, b| a & b, |a, b| a & b),
        ("or", |a, b| a | b, |a, b| a | b),
        ("exclusive or", |a, b| a ^ b, |a, b| a ^ b),
        (
            "select",
            |a, b| Word::select(a.eq(b), a, b),
            |a, b| Word::select(a.eq(b), a, b),
        ),
        (
            "from mask",
            |a, b| Word::from_mask(a.eq(b)),
            |a, b| Word::from_mask(a.eq(b)),
        ),
    ];
    pairs(&words(), |a, b| {
        let (wa, wb) = (LaneWords::new(a), LaneWords::new(b));
        for (name, one, eight) in operations {
            let wide = eight(wa, wb).to_array();
            for lane in 0..LANES {
                assert_eq!(
                    wide[lane],
                    one(Word32(a[lane]), Word32(b[lane])).0,
                    "{name} of {:#x}, {:#x}",
                    a[lane],
                    b[lane]
                );
            }
        }
        let eq = wa.eq(wb);
        // Less is promised below 2^31.
        let (la, lb) = (a.map(|w| w >> 1), b.map(|w| w >> 1));
        let lt = LaneWords::new(la).lt(LaneWords::new(lb));
        for lane in 0..LANES {
            assert_eq!(eq.lane(lane), a[lane] == b[lane]);
            assert_eq!(lt.lane(lane), la[lane] < lb[lane]);
        }
        for bits in 0..32 {
            let shifted =
                [wa.shl(bits), wa.shr(bits), wa.shr_signed(bits)].map(LaneWords::to_array);
            for lane in 0..LANES {
                let one = Word32(a[lane]);
                let expected = [one.shl(bits).0, one.shr(bits).0, one.shr_signed(bits).0];
                assert_eq!(
                    shifted.map(|s| s[lane]),
                    expected,
                    "{:#x} by {bits}",
                    a[lane]
                );
            }
        }
    });
}

#[test]
fn masks_agree_with_their_bits() {
    for bits in 0..256_u32 {
        let mask = LaneMask::from_bits(bits);
        assert_eq!(mask.bits(), bits);
        assert_eq!(
            (mask.any(), mask.all(), mask.count()),
            (bits != 0, bits == 255, bits.count_ones())
        );
        assert_eq!((!mask).bits(), !bits & 255);
        for lane in 0..LANES + 3 {
            assert_eq!(mask.lane(lane), lane < LANES && bits >> lane & 1 == 1);
        }
        for other in [0, 1, 0x5a, 0xff, bits.reverse_bits() >> 24] {
            let wide = LaneMask::from_bits(other);
            assert_eq!((mask & wide).bits(), bits & other);
            assert_eq!((mask | wide).bits(), bits | other);
            assert_eq!((mask ^ wide).bits(), bits ^ other);
            assert_eq!(mask.and_not(wide).bits(), bits & !other);
        }
    }
    assert!(LaneMask::splat(true).all() && !LaneMask::splat(false).any());
    assert!(bool::splat(true) && !Mask::and_not(true, true));
    assert_eq!(
        (true.count(), true.lane(0), true.lane(1), false.lane(0)),
        (1, true, false, false)
    );
}

/// Look-ups clamp, so that finished lanes may ask for anything; empty tables give zero.
#[test]
fn gathers_are_total() {
    for length in [0, 1, 2, 7, 8, 1000] {
        let numbers: Vec<f32> = (0..length).map(|i| i as f32 + 0.5).collect();
        let words: Vec<u32> = (0..length).map(|i| i as u32 ^ 0x8000_00ff).collect();
        pairs(&self::words(), |a, _| {
            let wide = Lanes::gather(&numbers, LaneWords::new(a)).to_array();
            let wide_words = LaneWords::gather(&words, LaneWords::new(a)).to_array();
            for lane in 0..LANES {
                let at = (a[lane] as usize).min(numbers.len().saturating_sub(1));
                let (number, word) = (
                    numbers.get(at).copied().unwrap_or(0.0),
                    words.get(at).copied().unwrap_or(0),
                );
                assert_eq!((wide[lane], wide_words[lane]), (number, word));
                assert_eq!(f32::gather(&numbers, Word32(a[lane])), number);
                assert_eq!(Word32::gather(&words, Word32(a[lane])).0, word);
            }
        });
    }
}

#[test]
fn lanes_are_set_and_read_one_by_one() {
    let mut number = Lanes::new([0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0]);
    let mut word = LaneWords::new([0, 1, 2, 3, 4, 5, 6, 7]);
    for lane in 0..LANES {
        assert_eq!(
            (number.lane(lane), word.lane(lane)),
            (lane as f32, lane as u32)
        );
        number.set_lane(lane, -1.5);
        word.set_lane(lane, 99);
    }
    number.set_lane(LANES, 3.0);
    word.set_lane(LANES, 3);
    assert_eq!(
        (number.to_array(), word.to_array()),
        ([-1.5; LANES], [99; LANES])
    );
    assert_eq!((number.lane(LANES), word.lane(LANES)), (0.0, 0));
    let mut one = 1.0_f32;
    one.set_lane(1, 5.0);
    assert_eq!((one, one.lane(1)), (1.0, 0.0));
}
