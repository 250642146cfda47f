//! Random streams: uniforms in their range, lanes that draw what their paths draw, laws in the large.
//!
//! The ends of the laws are proved by enumeration in `ends`; that keys share nothing is looked for in `keys`.

use woodcock_core::real::{Mask, Real, Word32};
use woodcock_core::stream::{Key, KeyedStream, PathStream, Stream};
use woodcock_packet::bits::LaneStream;
use woodcock_packet::lanes::{LANES, LaneMask, Lanes};
use woodcock_tests::each_width;
use woodcock_tests::stats::independent::SplitMix;
use woodcock_tests::stats::{
    KolmogorovSmirnov, Sample, assert_agrees, assert_verdict, samples, seed,
};
use woodcock_tests::widths::{collect, everyone, sample, width};

mod ends;
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

/// 2³²: how many words there are.
const WORDS: f64 = 4_294_967_296.0;

#[test]
fn uniforms_stay_in_range_and_keep_their_digits() {
    for word in [
        0,
        1,
        255,
        256,
        0xffff,
        1 << 16,
        0x00ff_feff,
        0x00ff_ff00,
        1 << 24,
        1 << 31,
        0xffff_fe7f,
        0xffff_fe80,
        0xffff_ff00,
        u32::MAX,
    ] {
        let coarse = Stream::<f32>::uniform(&mut Words(&[word]), true);
        assert_eq!(coarse, (word >> 8) as f32 / 16_777_216.0);
        // Small words ask for more, which here add nothing.
        let fine = Stream::<f32>::uniform_fine(&mut Words(&[word, 0, 0, 0]), true);
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
        vec![0, 1 << 24],
        vec![u32::MAX, 1 << 31],
        vec![1 << 30],
        vec![0, 0, 9, 5],
        vec![0xffff_ff00, 0, 1 << 30],
        vec![0, 0, 0, 3],
        vec![0xffff_ff11, 0xffff_ff22, 0xffff_feff],
        vec![1, u32::MAX],
    ];
    for (bits, fine) in (0..256).flat_map(|bits| [(bits, false), (bits, true)]) {
        let mut wide = Scripts(scripts.clone(), [0; LANES]);
        let active = LaneMask::from_bits(bits);
        let result = if fine {
            wide.uniform_fine(active)
        } else {
            wide.exponential(active)
        };
        for (lane, script) in scripts.iter().enumerate() {
            if bits >> lane & 1 == 0 {
                assert_eq!(wide.1[lane], 0, "draws of lane {lane}");
                continue;
            }
            let mut words = Words(script);
            let one: f32 = if fine {
                words.uniform_fine(true)
            } else {
                words.exponential(true)
            };
            let drawn = script.len() - words.0.len();
            assert!(fine || drawn == script.len(), "a script ends too late");
            assert_eq!(wide.1[lane], drawn, "draws of lane {lane}");
            assert_eq!(result.lane(lane).to_bits(), one.to_bits());
        }
    }
}
