//! Relative mean squared error of pictures, by blocks of pixels.
//!
//! ```text
//! relMSE of a block = mean over its pixels and channels of  variance / (ref² + 0.01 mean(ref)²)
//! ```
//!
//! The variance is that of one run, estimated from several with different seeds. The reference is the mean of
//! all runs of all ways, each way weighted by one over its variance, and averaged over the block: the single pixels of
//! runs this short would not do. The mean over blocks feels fireflies; the median does not.

/// Edge of a block \[pixels\].
const BLOCK: usize = 16;
/// Share of the picture's mean that keeps black pixels from counting without bound.
const FLOOR: f64 = 1e-2;

/// A picture in linear colour, row by row.
pub type Picture = Vec<[f64; 3]>;

/// Runs of one way to make a picture.
#[derive(Clone, Debug, Default)]
pub struct Runs(Vec<Picture>);

/// What several runs tell of one of them.
#[derive(Clone, Copy, Debug)]
pub struct Quality {
    /// Mean over blocks of the relative mean squared error.
    pub error: f64,
    /// Median over the blocks that have noise.
    pub block_median: f64,
    /// Mean of the picture over pixels, channels and runs.
    pub mean: f64,
    /// Standard error of `mean`, from its spread over runs.
    pub mean_error: f64,
}

impl Runs {
    /// Adds a run; all have the same size.
    pub fn add(&mut self, picture: Picture) {
        self.0.push(picture);
    }

    fn count(&self) -> f64 {
        self.0.len() as f64
    }

    /// Mean and variance of one run's value at a pixel.
    fn moments(&self, pixel: usize, channel: usize) -> (f64, f64) {
        let values = || {
            self.0
                .iter()
                .filter_map(|run| Some(*run.get(pixel)?.get(channel)?))
        };
        let mean = values().sum::<f64>() / self.count();
        let squares: f64 = values().map(|v| (v - mean) * (v - mean)).sum();
        (mean, squares / (self.count() - 1.0))
    }

    /// Mean of each run over pixels and channels.
    fn means(&self) -> Vec<f64> {
        let mean =
            |run: &Picture| run.iter().flatten().sum::<f64>() / (3.0 * run.len().max(1) as f64);
        self.0.iter().map(mean).collect()
    }

    /// Variance of the mean of the runs, averaged over the picture.
    fn variance(&self, pixels: usize) -> f64 {
        let sum: f64 = (0..pixels)
            .flat_map(|pixel| (0..3).map(move |channel| self.moments(pixel, channel).1))
            .sum();
        sum / (3.0 * pixels as f64 * self.count())
    }
}

/// Judges ways to make one picture of `width` columns, at least two runs each, by a reference that all of them give.
pub fn judge(ways: &[Runs], width: usize) -> Vec<Quality> {
    let pixels = ways
        .iter()
        .flat_map(|runs| &runs.0)
        .map(Vec::len)
        .min()
        .unwrap_or(0);
    // What found nothing has no variance, and no say.
    let weight = |runs: &Runs| {
        Some(runs.variance(pixels))
            .filter(|v| *v > 0.0)
            .map_or(0.0, |v| 1.0 / v)
    };
    let weights: Vec<f64> = ways.iter().map(weight).collect();
    let total: f64 = weights.iter().sum();
    let reference = |pixel: usize, channel: usize| {
        let weighted = ways.iter().zip(&weights);
        weighted
            .map(|(runs, w)| w * runs.moments(pixel, channel).0)
            .sum::<f64>()
            / total
    };
    let all: f64 = (0..pixels)
        .flat_map(|pixel| (0..3).map(move |channel| (pixel, channel)))
        .map(|(pixel, channel)| reference(pixel, channel))
        .sum();
    let picture_mean = all / (3.0 * pixels as f64);
    let floor = FLOOR * picture_mean * picture_mean;
    let blocks = blocks(pixels, width);
    // Of each block and channel, what errors are relative to.
    let scales: Vec<[f64; 3]> = blocks
        .iter()
        .map(|block| {
            [0, 1, 2].map(|channel| {
                let sum: f64 = block.iter().map(|pixel| reference(*pixel, channel)).sum();
                let mean = sum / block.len() as f64;
                mean * mean + floor
            })
        })
        .collect();
    ways.iter()
        .map(|runs| {
            let mut errors: Vec<f64> = blocks
                .iter()
                .zip(&scales)
                .map(|(block, scale)| relative(runs, block, scale))
                .collect();
            let means = runs.means();
            let mean = means.iter().sum::<f64>() / runs.count();
            let squares: f64 = means.iter().map(|m| (m - mean) * (m - mean)).sum();
            let error = errors.iter().sum::<f64>() / errors.len() as f64;
            errors.retain(|e| *e > 0.0);
            errors.sort_by(f64::total_cmp);
            Quality {
                error,
                block_median: errors.get(errors.len() / 2).copied().unwrap_or(0.0),
                mean,
                mean_error: (squares / (runs.count() - 1.0) / runs.count()).sqrt(),
            }
        })
        .collect()
}

/// The mean of all runs of all ways pixel by pixel, each way weighted by one over its variance; for smooth pictures and long
/// runs, where it needs no blocks.
pub fn reference(ways: &[&Runs]) -> Picture {
    let pixels = ways.iter().flat_map(|runs| &runs.0).map(Vec::len).min();
    let pixels = pixels.unwrap_or(0);
    let weights: Vec<f64> = ways
        .iter()
        .map(|runs| 1.0 / runs.variance(pixels).max(f64::MIN_POSITIVE))
        .collect();
    let total: f64 = weights.iter().sum();
    let mean = |pixel: usize, channel: usize| {
        let weighted = ways.iter().zip(&weights);
        let sum: f64 = weighted
            .map(|(runs, w)| w * runs.moments(pixel, channel).0)
            .sum();
        sum / total
    };
    (0..pixels)
        .map(|pixel| [0, 1, 2].map(|channel| mean(pixel, channel)))
        .collect()
}

impl Runs {
    /// Mean over pixels and channels of the relative mean squared error of one run, its variance seen from run to run.
    pub fn error(&self, reference: &Picture) -> f64 {
        let count = 3.0 * reference.len() as f64;
        let mean = reference.iter().flatten().sum::<f64>() / count;
        let floor = FLOOR * mean * mean;
        let pixels = reference.iter().enumerate();
        let of = |(pixel, value): (usize, &[f64; 3])| -> f64 {
            let channels = value.iter().enumerate();
            let error =
                |(channel, v): (usize, &f64)| self.moments(pixel, channel).1 / (v * v + floor);
            channels.map(error).sum()
        };
        pixels.map(of).sum::<f64>() / count
    }

    /// All runs but one.
    #[must_use]
    pub fn without(&self, run: usize) -> Self {
        let others = self.0.iter().enumerate().filter(|(i, _)| *i != run);
        Self(others.map(|(_, picture)| picture.clone()).collect())
    }
}

/// Relative mean squared error of one run in a block.
fn relative(runs: &Runs, block: &[usize], scale: &[f64; 3]) -> f64 {
    let sum: f64 = block
        .iter()
        .flat_map(|pixel| {
            let relative = |(channel, scale)| runs.moments(*pixel, channel).1 / scale;
            scale.iter().enumerate().map(relative)
        })
        .sum();
    sum / (3.0 * block.len() as f64)
}

/// The pixels of each block.
fn blocks(pixels: usize, width: usize) -> Vec<Vec<usize>> {
    let across = width.div_ceil(BLOCK);
    let down = pixels.div_ceil(width).div_ceil(BLOCK);
    let mut blocks = vec![Vec::new(); across * down];
    for pixel in 0..pixels {
        let (x, y) = (pixel % width, pixel / width);
        if let Some(block) = blocks.get_mut(y / BLOCK * across + x / BLOCK) {
            block.push(pixel);
        }
    }
    blocks
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two runs of 32 × 16 pixels, `deviation` below and above one.
    fn around_one(deviation: f64) -> Runs {
        Runs(vec![
            vec![[1.0 - deviation; 3]; 512],
            vec![[1.0 + deviation; 3]; 512],
        ])
    }

    #[test]
    fn errors_are_variances_relative_to_the_reference() {
        let qualities = judge(&[around_one(0.1), around_one(0.3)], 32);
        for (quality, deviation) in qualities.iter().zip([0.1, 0.3]) {
            let error = 2.0 * deviation * deviation / 1.01;
            assert!((quality.error - error).abs() < 1e-12, "{quality:?}");
            assert!((quality.block_median - error).abs() < 1e-12);
            assert!((quality.mean - 1.0).abs() < 1e-12);
            assert!((quality.mean_error - deviation).abs() < 1e-12);
        }
    }

    #[test]
    fn errors_pixel_by_pixel_are_those_of_blocks_where_pictures_are_flat() {
        let ways = [around_one(0.1), around_one(0.3)];
        let reference = reference(&[&ways[0], &ways[1]]);
        for (runs, deviation) in ways.iter().zip([0.1, 0.3]) {
            let error = 2.0 * deviation * deviation / 1.01;
            assert!((runs.error(&reference) - error).abs() < 1e-12);
        }
        assert_eq!(ways[0].without(1).0.len(), 1);
    }

    #[test]
    fn a_firefly_moves_the_mean_but_not_the_median() {
        let mut runs = around_one(0.1);
        let mut wide: Vec<Picture> = runs.0.iter().map(|run| run.repeat(4)).collect();
        runs.0.clone_from(&wide);
        let clean = judge(&[runs.clone(), runs.clone()], 32);
        wide[0][0] = [500.0; 3];
        let spoilt = judge(&[Runs(wide), runs], 32);
        assert!(spoilt[0].error > 100.0 * clean[0].error, "{spoilt:?}");
        let ratio = spoilt[0].block_median / clean[0].block_median;
        assert!((ratio - 1.0).abs() < 0.05, "{ratio}");
    }
}
