//! Streams of neighbouring keys share nothing that an estimator could notice.

use super::{WORDS, word};
use woodcock_core::stream::{Key, PathStream};
use woodcock_tests::stats::{
    ChiSquare, Sample, assert_agrees, assert_verdict, judge_within, must_kill, samples, seed,
};

/// A name, and the key of each number.
type Neighbours = (&'static str, fn(u32) -> Key);

/// Ways from one key to its neighbour.
const NEIGHBOURS: [Neighbours; 5] = [
    ("samples", |i| Key {
        seed: 0,
        pixel: 0,
        sample: i,
    }),
    ("pixels", |i| Key {
        seed: 0,
        pixel: i,
        sample: 0,
    }),
    ("seeds", |i| Key {
        seed: i as u64,
        pixel: 3,
        sample: 5,
    }),
    ("powers", |i| Key {
        seed: 1,
        pixel: i << 16,
        sample: i,
    }),
    ("high seeds", |i| Key {
        seed: u64::from(i) << 40,
        pixel: 0,
        sample: 0,
    }),
];

#[test]
fn first_words_of_neighbouring_keys_are_uniform_bytes() {
    let n = samples(1 << 18) as u32;
    for (name, key) in NEIGHBOURS {
        for draw in [0, 1, 7] {
            let mut counts = vec![[0_u64; 256]; 4];
            for i in 0..n {
                let mut rng = PathStream::new(key(i));
                let word = (0..=draw).map(|_| word(&mut rng)).last().expect("one word");
                for (count, byte) in counts.iter_mut().zip(word.to_le_bytes()) {
                    count[usize::from(byte)] += 1;
                }
            }
            for (place, count) in counts.iter().enumerate() {
                let verdict = ChiSquare::new(count, &[1.0 / 256.0; 256]).verdict(0.03);
                assert_verdict(&format!("{name}, word {draw}, byte {place}"), verdict);
            }
        }
    }
}

#[test]
fn neighbouring_streams_do_not_correlate() {
    let n = samples(1 << 17) as u32;
    let centred = |word: u32| (f64::from(word) / WORDS - 0.5) * 12.0_f64.sqrt();
    for (name, key) in NEIGHBOURS {
        for (mine, theirs) in [(0, 0), (1, 1), (0, 1), (1, 0), (3, 2)] {
            let nth = |key: Key, at: usize| {
                let mut rng = PathStream::new(key);
                centred((0..=at).map(|_| word(&mut rng)).last().expect("one word"))
            };
            let products = Sample::collect(n as usize, |i| {
                nth(key(2 * i as u32), mine) * nth(key(2 * i as u32 + 1), theirs)
            });
            let name = format!("{name}, words {mine} and {theirs}");
            assert_verdict(&name, judge_within(products.moments(), 0.0, 0.004));
            assert_verdict(&name, products.judge_blocks());
        }
        // Consecutive paths, as an estimator averages them.
        let uniforms = Sample::collect(n as usize, |i| {
            f64::from(word(&mut PathStream::new(key(i as u32)))) / WORDS
        });
        assert_agrees(name, &uniforms, 0.5, 0.003);
    }
    // One stream within itself, at small lags.
    for lag in [1, 2, 8] {
        let mut rng = PathStream::new(Key {
            seed: seed(53),
            pixel: 0,
            sample: 0,
        });
        let words: Vec<f64> = (0..n as usize + lag)
            .map(|_| centred(word(&mut rng)))
            .collect();
        let products = Sample::collect(n as usize, |i| words[i] * words[i + lag]);
        assert_verdict(
            &format!("lag {lag}"),
            judge_within(products.moments(), 0.0, 0.004),
        );
    }
}

/// The checks above can fail: keys hashed by an addition, as a beginner would, and lanes on one stream.
#[test]
fn poor_keys_are_rejected() {
    let n = 1_u32 << 18;
    let poor = |i: u32| f64::from(i.wrapping_mul(0x0001_0dcd).wrapping_add(12_345)) / WORDS;
    let mut bytes = [0_u64; 256];
    for i in 0..n {
        bytes[(i.wrapping_mul(0x0001_0dcd) & 0xff) as usize / 2] += 1;
    }
    must_kill(
        "bytes",
        ChiSquare::new(&bytes, &[1.0 / 256.0; 256]).verdict(0.03),
    );
    let centred = |u: f64| (u - 0.5) * 12.0_f64.sqrt();
    let products = Sample::collect(n as usize, |i| {
        centred(poor(2 * i as u32)) * centred(poor(2 * i as u32 + 1))
    });
    must_kill("correlation", judge_within(products.moments(), 0.0, 0.004));
    let blocks = Sample::collect(n as usize, |i| poor(i as u32));
    must_kill("blocks", blocks.judge_blocks());
}

/// Distinct keys of one seed begin in distinct states: all of a strip of pixels and samples, no two alike.
#[test]
fn states_are_distinct() {
    let mut states = Vec::new();
    for pixel in 0..1024_u32 {
        for sample in 0..256_u32 {
            let pixel = pixel.wrapping_mul(0x0080_0001);
            states.push(
                Key {
                    seed: 9,
                    pixel,
                    sample,
                }
                .initial_state(),
            );
        }
    }
    let count = states.len();
    states.sort_unstable();
    states.dedup();
    assert_eq!(states.len(), count);
}
