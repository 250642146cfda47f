//! The laws of `uniform_fine` and `exponential` down to 2⁻¹²⁸ and up without end, by counting words.
//!
//! Statistics cannot see the ends of a law, where it happens once in 2³² draws and less. But a number grows with the
//! words it is made of, read as digits to the base 2³². So the probability of a number below x is the place where x
//! falls among the words: a search for the first digit, another for the second, and so on.

use super::{WORDS, exponential};
use std::f64::consts::LN_2;
use woodcock_core::free_flight::delta::is_real;
use woodcock_core::medium::Procedural;
use woodcock_core::real::Word32;
use woodcock_core::stream::Stream;
use woodcock_core::vec3::Vec3;
use woodcock_tests::stats::independent::SplitMix;

/// Some words, and then one for ever.
struct Digits<'a> {
    head: &'a [u32],
    tail: u32,
}

impl Stream<f32> for Digits<'_> {
    fn next_word(&mut self, _: bool) -> Word32 {
        let Some((first, rest)) = self.head.split_first() else {
            return Word32(self.tail);
        };
        self.head = rest;
        Word32(*first)
    }
}

impl Digits<'_> {
    fn word(&mut self) -> u32 {
        Stream::<f32>::next_word(self, true).0
    }
}

/// The number that a stream gives.
type Law<'a> = &'a dyn Fn(&mut Digits) -> f32;

fn uniform(digits: &mut Digits) -> f32 {
    Stream::<f32>::uniform_fine(digits, true)
}

fn flight(digits: &mut Digits) -> f32 {
    Stream::<f32>::exponential(digits, true)
}

/// How many first words there are, and how many of them begin a flight that does not begin anew at the top.
const ALL: u64 = 1 << 32;
const INNER: u64 = 0xffff_ff00;

/// The smallest and the largest number that begins with these words.
fn range(law: Law, head: &[u32]) -> [f32; 2] {
    [0, u32::MAX].map(|tail| law(&mut Digits { head, tail }))
}

/// P(number < x), where the first word is below `end`.
fn below(law: Law, end: u64, x: f64) -> f64 {
    let (mut head, mut end, mut weight, mut p) = (Vec::new(), end, 1.0 / WORDS, 0.0);
    while head.len() < 4 {
        head.push(0);
        let digit = head.len() - 1;
        // All that begins with a word lies below x, for how many words?
        let (mut low, mut high) = (0, end);
        while low < high {
            let middle = (low + high) / 2;
            head[digit] = middle as u32;
            if f64::from(range(law, &head)[1]) < x {
                low = middle + 1;
            } else {
                high = middle;
            }
        }
        p += low as f64 * weight;
        head[digit] = low as u32;
        if low == end || f64::from(range(law, &head)[0]) >= x {
            break;
        }
        // What begins with this word lies on both sides: its next words tell.
        (end, weight) = (ALL, weight / WORDS);
    }
    p
}

/// Places from 2⁻¹⁰⁴ to 1: steps of a hundredth, and where words, levels and roundings change.
fn places() -> Vec<f64> {
    let mut places = Vec::new();
    let mut x = 2.0_f64.powi(-104);
    while x < 1.0 {
        places.push(x);
        x *= 1.0103;
    }
    for e in 1..=104 {
        let power = 2.0_f64.powi(-e);
        for by in [-1.1, -1.0, -0.6, -0.2, 0.2, 0.6, 1.0, 1.1, 1.9] {
            places.push(power * (1.0 + by / 16_777_216.0));
        }
        places.extend([1.25, 1.5, 1.75].map(|by| power * by));
    }
    places.extend([1e-9, 3.3e-9, 1e-12, 1e-20, 1.0]);
    places.retain(|&x| (2.0_f64.powi(-104)..=1.0).contains(&x));
    places
}

/// The largest relative error of a law's distribution function, and where.
fn worst(law: Law, end: u64, exact: impl Fn(f64) -> f64) -> (f64, f64) {
    let error = |x: f64| (below(law, end, x) / exact(x) - 1.0).abs();
    let errors = places().into_iter().map(|x| (error(x), x));
    errors.fold((0.0, 0.0), |a, b| if b.0 > a.0 { b } else { a })
}

/// What u's rounding to 24 bits allows, and for flights 0.9 ulp of the logarithm more.
const UNIFORM: f64 = 1.0 / 8_388_608.0;
const FLIGHT: f64 = 1.9 / 8_388_608.0;

#[test]
fn uniforms_have_their_probability_at_any_smallness() {
    let (error, at) = worst(&uniform, ALL, |x| x);
    assert!(error <= UNIFORM, "off by {error:e} at {at:e}");
    // Close to one, the same from above: half a step of 2⁻²⁴.
    for k in 0..5000 {
        let x = 1.0 - f64::from(k) / 33_554_432.0;
        let p = below(&uniform, ALL, x);
        assert!(
            (p - x).abs() <= 0.5 / 16_777_216.0 + 1e-12,
            "P(u < {x}) = {p}"
        );
    }
    assert_eq!(below(&uniform, ALL, 1.0), 1.0, "below one");
}

#[test]
fn flights_have_their_probability_at_any_shortness() {
    let (error, at) = worst(&flight, INNER, |x| -(-x).exp_m1());
    assert!(error <= FLIGHT, "off by {error:e} at {at:e}");
    let mut x = 1.0;
    while x < 16.5 {
        // The tail is what matters here: half a step of u = 1 − 2⁻²⁴ k.
        let (q, tail) = (1.0 - below(&flight, INNER, x), (-x).exp());
        assert!(
            (q - tail).abs() <= 0.5 / 16_777_216.0 + 2e-7 * tail,
            "P(E ≥ {x}) = {q:e}, not {tail:e}"
        );
        x *= 1.013;
    }
}

#[test]
fn below_everything_lies_next_to_nothing() {
    let grain = 2.0_f64.powi(-128);
    for law in [(&uniform as Law, ALL), (&flight, INNER)] {
        let mut x = 2.0_f64.powi(-104);
        while x > 1e-45 {
            let p = below(law.0, law.1, x);
            assert!((p - x).abs() <= grain * 1.000_001, "{p:e} below {x:e}");
            x *= 0.983;
        }
        // Zero itself takes four words of zero.
        assert_eq!(range(law.0, &[0, 0, 0, 0]), [0.0; 2]);
        assert!(range(law.0, &[0, 0, 0, 1])[0] > 0.0);
    }
}

/// A collision where the extinction is a millionth of a millionth of its bound.
#[test]
fn rare_collisions_have_their_probability() {
    type Medium = Procedural<fn(Vec3<f32>) -> f32>;
    for (majorant, ratio) in [
        (1.0_f32, 1e-12_f32),
        (3.7, 1e-12),
        (0.013, 3e-10),
        (4e5, 7e-8),
    ] {
        let sigma_t = majorant * ratio;
        let miss = |digits: &mut Digits| {
            let real = is_real::<f32, Medium>(sigma_t, majorant, digits, true);
            if real { 0.0 } else { 1.0 }
        };
        let exact = f64::from(sigma_t) / f64::from(majorant);
        let p = below(&miss, ALL, 0.5);
        assert!(
            (p / exact - 1.0).abs() < 2.0 * UNIFORM,
            "{p:e}, not {exact:e}"
        );
    }
}

/// What the enumeration rests on: more words of digits, more of a number.
#[test]
fn numbers_grow_with_their_words() {
    let mut rng = SplitMix::new(51);
    let check = |law: Law, head: &[u32], last_digit: bool| {
        let mut next = head.to_vec();
        if let Some(word) = next.last_mut() {
            *word += 1;
        }
        let [low, high] = [range(law, head), range(law, &next)];
        let up = |x: f32| if last_digit { x.next_up() } else { x };
        let ordered = low[0] <= up(low[1]) && low[1] <= up(high[0]) && high[0] <= up(high[1]);
        assert!(ordered, "{head:x?}: {low:?}, then {high:?}");
    };
    let last = INNER as u32 - 1;
    let low = |bits: u64| bits as u32 >> (bits >> 32 & 31);
    for _ in 0..1 << 18 {
        let bits = rng.bits();
        let middle = low(rng.bits()).min(last - 1);
        // The logarithm may fall back by its last digit, as the precision table counts; no more.
        for (law, last_digit) in [(&uniform as Law, false), (&flight, true)] {
            check(law, &[middle], last_digit);
            check(law, &[(bits >> 40) as u32 & 0x3f, middle], last_digit);
            check(law, &[0, 0, middle], last_digit);
        }
    }
    for seam in [1, 1 << 8, 1 << 16, 0x00ff_ff00, 1 << 24, last - 5000] {
        for word in seam - 1..(seam + 4999).min(last) {
            check(&uniform, &[word], false);
            check(&flight, &[word], true);
            check(&uniform, &[0, word], false);
        }
    }
}

#[test]
fn the_upper_end_has_no_memory() {
    let longest = f64::from(exponential(&[INNER as u32 - 1]));
    let start = 24.0 * LN_2;
    assert!((start - 1.0..start + 1e-5).contains(&longest), "{longest}");
    for top in [0xffff_ff00, 0xffff_ff80, 0xffff_ffff] {
        for word in [1 << 24, 1 << 27, 1 << 31, 0xffff_fe00] {
            let first = f64::from(exponential(&[word]));
            for levels in 1..4 {
                let mut words = vec![top; levels];
                words.push(word);
                let expected = levels as f64 * start + first;
                let got = f64::from(exponential(&words));
                assert!(
                    (got - expected).abs() <= 3e-7 * expected,
                    "{levels} levels, {word:#x}: {got} for {expected}"
                );
            }
            // Above the top, a low word draws again too: a flight of the offset and a little.
            let got = f64::from(exponential(&[top, 0, word]));
            assert!((got - start).abs() <= 3e-6, "{got}");
        }
    }
}

/// Ways to spoil the small numbers; the enumeration must see each.
#[test]
fn enumeration_sees_lost_digits() {
    const GRAIN: f32 = 1.0 / 4_294_967_296.0;
    /// One word, whose fraction begins anew below 2ᵏ.
    fn refined_below<const BITS: u32>(digits: &mut Digits) -> f32 {
        let word = digits.word();
        if word >> BITS == 0 {
            (word as f32 + digits.word() as f32 * GRAIN) * GRAIN
        } else {
            word as f32 * GRAIN
        }
    }
    let mutants: [(&str, Law, f64); 5] = [
        ("24 bits", &|d| Stream::<f32>::uniform(d, true), 0.9),
        ("one word", &|d| d.word() as f32 * GRAIN, 0.1),
        ("a second word after zero only", &refined_below::<0>, 0.1),
        ("digits that begin below 2⁻¹⁶", &refined_below::<16>, 1e-5),
        (
            "half a grain",
            &|d| (d.word() as f32 + d.word() as f32 * GRAIN / 2.0) * GRAIN,
            0.2,
        ),
    ];
    for (name, law, least) in mutants {
        // Where words are not zero: what comes below is missing anyway, and easier to see.
        let seen = places().into_iter().filter(|x| x * WORDS > 1.0);
        let error = seen.map(|x| (below(law, ALL, x) / x - 1.0).abs());
        let error = error.fold(0.0, f64::max);
        println!("{name}: {error:e}");
        assert!(
            error >= least && least > 10.0 * FLIGHT,
            "{name}: only {error:e}"
        );
    }
}
