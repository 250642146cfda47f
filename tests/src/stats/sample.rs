//! A stream of weights in the order drawn, with the one statistic that sees correlation between them.
//!
//! ```text
//! r = variance of block means × block size / sample variance
//! ```
//!
//! Independent weights give r = 1; weights repeated in fours give 4 while their mean looks as it should, only too
//! sure of itself; stratified weights give less than 1. With B blocks of b and n = Bb, analysis of variance gives
//!
//! ```text
//! E r = 1 exactly,   Var r = 2 (n − B) / ((B − 1)(n + 1))   for normal weights
//! ```
//!
//! and the excess kurtosis of other weights cancels between numerator and denominator to first order. *Blind to:*
//! correlation over distances much longer than a block, and to blocks so rare in events that a block mean is
//! nearly always the same number.

use super::{Moments, ROUNDING, Verdict, Z_CRITICAL, deviate_of_scaled_chi_square};

/// Weights per block unless asked otherwise: with 2²⁰ weights there are 4096 blocks, which see a repetition in
/// fours at well over a hundred standard errors.
pub const BLOCK_SIZE: u64 = 256;

/// Blocks below which the ratio says too little to pass.
const FEWEST_BLOCKS: u64 = 16;

/// Moments of all weights and of the means of consecutive blocks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    all: Moments,
    complete: Moments,
    block: Moments,
    block_means: Moments,
    block_size: u64,
}

impl Default for Sample {
    fn default() -> Self {
        Self::with_block_size(BLOCK_SIZE)
    }
}

impl Sample {
    /// An empty sample with blocks of [`BLOCK_SIZE`].
    pub fn new() -> Self {
        Self::default()
    }

    /// An empty sample with blocks of `block_size` weights, which should span the correlations feared.
    ///
    /// # Panics
    /// When `block_size` is below 2: blocks of one weight always have the variance of the weights.
    pub fn with_block_size(block_size: u64) -> Self {
        assert!(block_size >= 2, "a block holds at least two weights");
        Self {
            all: Moments::new(),
            complete: Moments::new(),
            block: Moments::new(),
            block_means: Moments::new(),
            block_size,
        }
    }

    /// Draws `n` weights, `weight(i)` for i = 0, 1, … n − 1.
    pub fn collect(n: usize, weight: impl FnMut(usize) -> f64) -> Self {
        (0..n).map(weight).collect()
    }

    /// Adds the next weight, in the order drawn.
    #[inline]
    pub fn push(&mut self, weight: f64) {
        self.all.push(weight);
        self.block.push(weight);
        if self.block.count() == self.block_size {
            self.block_means.push(self.block.mean());
            self.complete.merge(&self.block);
            self.block = Moments::new();
        }
    }

    /// Appends a part drawn elsewhere; its incomplete last block counts towards the mean only.
    ///
    /// # Panics
    /// When the block sizes differ.
    pub fn merge(&mut self, other: &Self) {
        assert_eq!(
            self.block_size, other.block_size,
            "only equal blocks have comparable means"
        );
        self.all.merge(&other.all);
        self.complete.merge(&other.complete);
        self.block_means.merge(&other.block_means);
        self.block = Moments::new(); // weights around a seam are not consecutive
    }

    /// Moments of all weights.
    pub const fn moments(&self) -> &Moments {
        &self.all
    }

    /// Weights per block.
    pub const fn block_size(&self) -> u64 {
        self.block_size
    }

    /// Complete blocks so far.
    pub const fn blocks(&self) -> u64 {
        self.block_means.count()
    }

    /// Variance of block means × block size / sample variance; 1 for independent weights. NaN without blocks.
    pub fn block_ratio(&self) -> f64 {
        self.block_means.variance() * self.block_size as f64 / self.complete.variance()
    }

    /// Normal deviate of [`block_ratio`](Self::block_ratio) under independence.
    pub fn block_z(&self) -> f64 {
        let blocks = self.blocks() as f64;
        let n = blocks * self.block_size as f64;
        let variance = 2.0 * (n - blocks) / ((blocks - 1.0) * (n + 1.0));
        deviate_of_scaled_chi_square(self.block_ratio(), 2.0 / variance)
    }

    /// Whether consecutive weights are independent, as far as blocks can tell.
    ///
    /// Weights that are all equal to the rounding of `f32` agree: an estimator without variance has no noise to
    /// correlate. Fewer than 16 blocks, or NaN, are `Blind` (resolution: standard deviation of the ratio).
    pub fn judge_blocks(&self) -> Verdict {
        let spread = self.complete.variance().sqrt();
        if self.blocks() >= FEWEST_BLOCKS && spread <= ROUNDING * self.complete.mean().abs() {
            return Verdict::Agrees;
        }
        let z = self.block_z();
        if self.blocks() < FEWEST_BLOCKS || z.is_nan() {
            return Verdict::Blind {
                resolution: (2.0 / self.blocks() as f64).sqrt(),
            };
        }
        if z.abs() < Z_CRITICAL {
            Verdict::Agrees
        } else {
            Verdict::Biased { z }
        }
    }
}

impl Extend<f64> for Sample {
    fn extend<I: IntoIterator<Item = f64>>(&mut self, weights: I) {
        for weight in weights {
            self.push(weight);
        }
    }
}

impl FromIterator<f64> for Sample {
    fn from_iter<I: IntoIterator<Item = f64>>(weights: I) -> Self {
        let mut sample = Self::new();
        sample.extend(weights);
        sample
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stats::independent::SplitMix;
    use crate::stats::judge;

    const N: usize = 1 << 20;

    #[test]
    fn independent_streams_of_many_shapes_agree() {
        let mut rng = SplitMix::new(21);
        type Draw<'a> = &'a dyn Fn(&mut SplitMix) -> f64;
        let shapes: [(&str, Draw<'_>); 4] = [
            ("uniform", &SplitMix::uniform),
            ("normal", &SplitMix::normal),
            ("heavy tail", &|r| r.exponential().powi(3)),
            ("rare", &|r| f64::from(u8::from(r.uniform() < 0.01))),
        ];
        for (name, weight) in shapes {
            let sample = Sample::collect(N, |_| weight(&mut rng));
            assert_eq!(sample.blocks(), 4096);
            assert_eq!(sample.judge_blocks(), Verdict::Agrees, "{name}: {sample:?}");
        }
    }

    #[test]
    fn repeats_in_fours_hide_from_the_mean_but_not_from_blocks() {
        let mut rng = SplitMix::new(22);
        let mut weight = 0.0;
        let sample = Sample::collect(N, |i| {
            if i % 4 == 0 {
                weight = rng.uniform();
            }
            weight
        });
        assert!(judge(sample.moments(), 0.5, 0.01).agrees());
        assert!(
            (sample.block_ratio() - 4.0).abs() < 0.5,
            "{}",
            sample.block_ratio()
        );
        let Verdict::Biased { z } = sample.judge_blocks() else {
            panic!("repeats in fours went unseen")
        };
        assert!(z > 60.0, "{z}");
    }

    #[test]
    fn stratification_shows_as_too_little_variance() {
        let mut rng = SplitMix::new(23);
        let sample = Sample::collect(N, |i| ((i % 16) as f64 + rng.uniform()) / 16.0);
        assert!(matches!(sample.judge_blocks(), Verdict::Biased { z } if z < -10.0));
    }

    #[test]
    fn the_ratio_has_the_stated_mean_and_variance() {
        // 2000 runs of 32 blocks of 16, exponential weights: kurtosis must cancel.
        let (blocks, block_size) = (32.0, 16.0);
        let mut ratios = Moments::new();
        let mut alarms = 0;
        for run in 0..2000 {
            let mut rng = SplitMix::new(5000 + run);
            let mut sample = Sample::with_block_size(16);
            sample.extend((0..512).map(|_| rng.exponential()));
            ratios.push(sample.block_ratio());
            alarms += u32::from(sample.block_z().abs() > 1.959_964);
        }
        let n = blocks * block_size;
        let variance = 2.0 * (n - blocks) / ((blocks - 1.0) * (n + 1.0));
        assert!(judge(&ratios, 1.0, 0.01).agrees(), "{ratios:?}");
        assert!(
            (ratios.variance() / variance - 1.0).abs() < 0.2,
            "{ratios:?}"
        );
        assert!((52..=148).contains(&alarms), "{alarms} of 2000 at 5 %");
    }

    #[test]
    fn constants_agree_and_nan_or_few_blocks_are_blind() {
        let constant = Sample::collect(N, |_| 0.7);
        assert!(constant.judge_blocks().agrees());
        let mut rng = SplitMix::new(24);
        let few = Sample::collect(256 * 15, |_| rng.uniform());
        assert!(matches!(few.judge_blocks(), Verdict::Blind { .. }));
        let spoilt = Sample::collect(N, |i| if i == 9 { f64::NAN } else { rng.uniform() });
        assert!(matches!(spoilt.judge_blocks(), Verdict::Blind { .. }));
    }

    #[test]
    fn merged_parts_keep_their_blocks() {
        let mut rng = SplitMix::new(25);
        let mut whole = Sample::new();
        for _ in 0..64 {
            whole.merge(&Sample::collect(1000, |_| rng.normal()));
        }
        assert_eq!(whole.blocks(), 64 * 3);
        assert_eq!(whole.moments().count(), 64_000);
        assert!(whole.judge_blocks().agrees());
    }
}
