//! Scores of many particles as samples that the harness can judge.

use super::Draws;
use crate::stats::{Sample, samples, seed};
use woodcock_core::stream::Key;

/// Which particles, and how many.
#[derive(Clone, Copy, Debug)]
pub struct Run {
    /// Seed of the suite; [`seed`] moves it.
    pub seed: u64,
    /// Tells runs of one seed apart.
    pub pixel: u32,
    /// Particles; [`samples`] multiplies them.
    pub particles: usize,
    /// Particles to a weight: the mean score of so many is one number of the sample, which saves time where scores
    /// are many and particles short.
    pub batch: usize,
}

impl Run {
    /// Batches of up to 16 that leave at least 8192 weights where there are so many particles.
    pub fn new(seed: u64, pixel: u32, particles: usize) -> Self {
        Self {
            seed,
            pixel,
            particles,
            batch: (particles >> 13).clamp(1, 16),
        }
    }
}

/// Walks the particles of a run, each with the stream of its own key, and collects `scores` means.
///
/// `walk` adds what a particle scores to the slots it is given.
pub fn tally(run: Run, scores: usize, mut walk: impl FnMut(&mut Draws, &mut [f64])) -> Vec<Sample> {
    let mut collected = vec![Sample::new(); scores];
    let mut slots = vec![0.0; scores];
    let batches = samples(run.particles).div_ceil(run.batch);
    let mut key = Key {
        seed: seed(run.seed),
        pixel: run.pixel,
        sample: 0,
    };
    for _ in 0..batches {
        slots.fill(0.0);
        for _ in 0..run.batch {
            walk(&mut Draws::new(key), &mut slots);
            key.sample += 1;
        }
        for (sample, score) in collected.iter_mut().zip(&slots) {
            sample.push(score / run.batch as f64);
        }
    }
    collected
}
