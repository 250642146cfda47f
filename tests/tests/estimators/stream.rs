//! Random streams: the exponential law at both ends by enumeration, uniforms in their range, keys that share nothing.
//!
//! Statistics cannot see the ends of a law, where it happens once in 2³² draws. But the map from words to numbers is
//! monotone, so its distribution function follows from a search for the word where it passes x.

use woodcock_core::real::{Real, Word32};
use woodcock_core::stream::{Key, KeyedStream, PathStream, Stream};
use woodcock_packet::bits::LaneStream;
use woodcock_packet::lanes::{LANES, LaneMask, Lanes};
use woodcock_tests::each_width;
use woodcock_tests::stats::independent::SplitMix;
use woodcock_tests::stats::{
    KolmogorovSmirnov, Sample, assert_agrees, assert_verdict, samples, seed,
};
use woodcock_tests::widths::{collect, everyone, sample, width};

mod keys;

/// A stream that gives the words it is told to.
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

/// The flight of a word that is at neither end.
fn first_level(word: u32) -> f32 {
    exponential(&[word])
}

/// Words whose draw ends with them: not zero, and not all ones in the top 24 bits.
const INNER: std::ops::Range<u32> = 1..0xffff_ff00;

/// How many inner words give a flight below `x`.
fn words_below(x: f64) -> u64 {
    let (mut low, mut high) = (u64::from(INNER.start), u64::from(INNER.end));
    while low < high {
        let middle = (low + high) / 2;
        if f64::from(first_level(middle as u32)) < x {
            low = middle + 1;
        } else {
            high = middle;
        }
    }
    low - u64::from(INNER.start)
}

const WORDS: f64 = 4_294_967_296.0;

/// P(E < x) by enumeration, for x of at least 2⁻³² and below 24 ln 2: zero lies below, the top above.
fn below(x: f64) -> f64 {
    (words_below(x) + 1) as f64 / WORDS
}

#[test]
fn the_lower_end_has_the_right_probability() {
    // A collision before τ = k · 2⁻³² has k of 2³² words, as many as 1 − e^−τ says but for the curvature of e …
    for k in 1..2000 {
        let x = f64::from(k) / WORDS;
        let exact = -(-x).exp_m1() * WORDS;
        let counted = (words_below(x) + 1) as f64;
        assert!(
            (counted - exact).abs() <= 1e-3,
            "{counted} words for {exact}"
        );
    }
    // … and between the marks the count is the next whole number: an excess of less than one word in all of 2³².
    for x in [1e-9, 3.3e-9, 1.7e-8, 4.1e-7, 2.9e-5, 1.1e-3] {
        let exact = -f64::exp_m1(-x) * WORDS;
        let excess = (words_below(x) + 1) as f64 - exact;
        assert!(
            (-1e-7 * exact..1.0 + 1e-7 * exact).contains(&excess),
            "{excess} words at {x:e}"
        );
    }
    // Below the first mark lies the second level, a copy of the first on a scale of 2⁻³², and below that the third.
    for (word, expected) in [
        (1_u32, 1.0),
        (77, 77.0),
        (1 << 31, 2_147_483_648.0),
        (0xffff_ff00, 4_294_967_040.0),
    ] {
        let second = f64::from(exponential(&[0, word]));
        assert!(
            (second / (expected / WORDS / WORDS) - 1.0).abs() < 1e-6,
            "{second:e}"
        );
        let third = f64::from(exponential(&[0, 0, word]));
        assert!(
            (third / (expected / WORDS / WORDS / WORDS) - 1.0).abs() < 1e-6,
            "{third:e}"
        );
    }
    assert!(exponential(&[0, 0, 0, 1]) > 0.0, "no mass on zero");
}

#[test]
fn the_whole_first_level_has_the_right_distribution() {
    let mut x = 2.0_f64.powi(-32);
    while x < 16.5 {
        let (p, exact) = (below(x), -(-x).exp_m1());
        // One word, and the rounding of numbers of 24 bits.
        let allowed = 1.0 / WORDS + exact * 1.3e-7;
        assert!(
            (p - exact).abs() <= allowed,
            "P(E < {x:e}) = {p:e}, not {exact:e}"
        );
        // The same from above, where the tail is what matters: half a step of u = 1 − 2⁻²⁴ k.
        let (q, tail) = (1.0 - p, (-x).exp());
        assert!(
            (q - tail).abs() <= 1.0 / 33_554_432.0 + 2e-7 * tail,
            "P(E ≥ {x:e}) = {q:e}, not {tail:e}"
        );
        x *= 1.013;
    }
}

#[test]
fn the_first_level_is_monotone() {
    let mut rng = SplitMix::new(51);
    let last = u64::from(INNER.end - 2);
    let check = |word: u32| {
        let (low, high) = (first_level(word), first_level(word + 1));
        // The logarithm may fall back by its last digit, as `elementary.rs` counts; no more.
        assert!(
            high >= low.next_down(),
            "words {word:#x}: {low:e}, then {high:e}"
        );
    };
    for _ in 0..1 << 20 {
        check((rng.bits() % last) as u32 + 1);
    }
    for word in (1..5000).chain(INNER.end - 5000..INNER.end - 1) {
        check(word);
    }
}

#[test]
fn the_upper_end_has_no_memory() {
    let longest = f64::from(first_level(INNER.end - 1));
    let start = 24.0 * std::f64::consts::LN_2;
    assert!((start - 1.0..start + 1e-5).contains(&longest), "{longest}");
    for top in [0xffff_ff00, 0xffff_ff80, 0xffff_ffff] {
        for word in [1, 1 << 10, 1 << 24, 1 << 31, 0xffff_fe00] {
            let first = f64::from(first_level(word));
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
            // Above the top, zero is a flight of exactly the offset and a little: it draws again too.
            let got = f64::from(exponential(&[top, 0, word]));
            assert!((got - start).abs() <= 3e-6, "{got}");
        }
    }
}

#[test]
fn uniforms_stay_in_range_and_keep_their_digits() {
    let ends = [
        0,
        1,
        2,
        255,
        256,
        0xffff,
        1 << 16,
        1 << 24,
        1 << 31,
        0xffff_fe7f,
        0xffff_fe80,
        0xffff_ff00,
        u32::MAX,
    ];
    for word in ends {
        let coarse = Stream::<f32>::uniform(&mut Words(&[word]), true);
        let fine = Stream::<f32>::uniform_fine(&mut Words(&[word]), true);
        assert_eq!(coarse, (word >> 8) as f32 / 16_777_216.0);
        assert!((0.0..1.0).contains(&coarse) && (0.0..1.0).contains(&fine));
        let exact = f64::from(word) / WORDS;
        assert!(
            (f64::from(fine) - exact).abs() <= exact * 6e-8,
            "{word:#x}: {fine:e}"
        );
    }
}

#[test]
fn laws_hold_at_every_width() {
    let n = samples(1 << 18);
    each_width!(R, S => {
        let name = width::<R>();
        let mut flights = collect::<R, S>(seed(52), 0, n, |rng| rng.exponential(everyone::<R>()));
        assert_verdict(name, KolmogorovSmirnov::exponential(&mut flights).verdict(0.006));
        for fine in [false, true] {
            let mut uniforms = collect::<R, S>(seed(52), 1, n, |rng| {
                if fine { rng.uniform_fine(everyone::<R>()) } else { rng.uniform(everyone::<R>()) }
            });
            assert_verdict(name, KolmogorovSmirnov::new(&mut uniforms, |u| u).verdict(0.006));
        }
        let mean: Sample = sample::<R, S>(seed(52), 2, n, |rng| rng.exponential(everyone::<R>()));
        assert_agrees(name, &mean, 1.0, 0.003);
    });
}

/// The next word of a scalar stream.
fn word(rng: &mut PathStream) -> u32 {
    Stream::<f32>::next_word(rng, true).0
}

/// Eight lanes under random masks, and keys exchanged on the way: each lane repeats its own scalar stream.
#[test]
fn lanes_draw_the_words_of_their_paths() {
    let mut rng = SplitMix::new(54);
    let mut lanes = <LaneStream as KeyedStream<Lanes>>::idle();
    let mut singles: Vec<PathStream> = Vec::new();
    for lane in 0..LANES {
        let key = Key {
            seed: rng.bits(),
            pixel: rng.bits() as u32,
            sample: lane as u32,
        };
        lanes.set_key(lane, key);
        singles.push(PathStream::new(key));
    }
    for round in 0..200_000 {
        let bits = rng.bits();
        let active = LaneMask::from_bits(bits as u32 & 0xff);
        if bits >> 60 == 0 {
            let lane = (bits >> 32) as usize % LANES;
            let key = Key {
                seed: bits,
                pixel: round,
                sample: 7,
            };
            lanes.set_key(lane, key);
            singles[lane] = PathStream::new(key);
        }
        let active_lane = |lane: usize| bits >> lane & 1 == 1;
        match round % 4 {
            0 => {
                let words = lanes.next_word(active).to_array();
                for (lane, single) in singles
                    .iter_mut()
                    .enumerate()
                    .filter(|(l, _)| active_lane(*l))
                {
                    assert_eq!(words[lane], word(single), "round {round}, lane {lane}");
                }
            }
            kind => {
                let wide = match kind {
                    1 => lanes.uniform(active),
                    2 => lanes.uniform_fine(active),
                    _ => lanes.exponential(active),
                };
                for (lane, single) in singles
                    .iter_mut()
                    .enumerate()
                    .filter(|(l, _)| active_lane(*l))
                {
                    let one: f32 = match kind {
                        1 => single.uniform(true),
                        2 => single.uniform_fine(true),
                        _ => single.exponential(true),
                    };
                    assert_eq!(
                        wide.lane(lane).to_bits(),
                        one.to_bits(),
                        "round {round}, lane {lane}"
                    );
                }
            }
        }
    }
}

/// The rare ends in lanes: streams made to begin with a word at an end, beside lanes that do not.
#[test]
fn lanes_agree_at_the_rare_ends() {
    /// Eight scripts, each lane at its own place in its own.
    struct Scripts([Vec<u32>; LANES], [usize; LANES]);
    impl Stream<Lanes> for Scripts {
        fn next_word(&mut self, active: LaneMask) -> woodcock_packet::lanes::LaneWords {
            let mut words = [0xdead_beef_u32; LANES];
            for lane in (0..LANES).filter(|lane| active.bits() >> lane & 1 == 1) {
                words[lane] = self.0[lane][self.1[lane]];
                self.1[lane] += 1;
            }
            woodcock_packet::lanes::LaneWords::new(words)
        }
    }
    let scripts = [
        vec![0, 5],
        vec![u32::MAX, 1 << 31],
        vec![1 << 30],
        vec![0, 0, 9],
        vec![0xffff_ff00, 0, 77],
        vec![0, 0, 0, 3],
        vec![0xffff_ff11, 0xffff_ff22, 0xffff_feff],
        vec![1],
    ];
    for bits in 0..256 {
        let mut wide = Scripts(scripts.clone(), [0; LANES]);
        let result = wide.exponential(LaneMask::from_bits(bits));
        for (lane, script) in scripts.iter().enumerate() {
            let active = bits >> lane & 1 == 1;
            let drawn = if active { script.len() } else { 0 };
            assert_eq!(wide.1[lane], drawn, "draws of lane {lane}");
            if active {
                assert_eq!(result.lane(lane).to_bits(), exponential(script).to_bits());
            }
        }
    }
}
