//! Do two ways to render a scene have the same mean?
//!
//! ```text
//! z = (a − b) / √(Var a + Var b)
//! ```
//!
//! for each colour of the whole picture and of blocks of 16 × 16 pixels, the variances being those that pixels report. With
//! thousands of samples in a block Welch's t is a normal z. What the comparison is worth is told by a copy of one picture that is
//! two per cent too bright. Blocks where the noisier way has met too few events to know its variance count for the picture only.

use crate::picture::Pixel;

/// Edge of a block \[pixels\].
const BLOCK: usize = 16;
/// One in a million, two-sided.
pub const LIMIT: f64 = 4.892;
/// Variance of a block's mean \[(mean / samples)²\] from which it is believed: that of so many events.
const EVENTS: f64 = 200.0;
/// The mistake that should be found.
const PLANTED: f64 = 1.02;

/// How far two pictures are apart.
#[derive(Clone, Copy, Debug)]
pub struct Agreement {
    /// Of the whole picture, in the colour that differs most.
    pub picture: f64,
    /// Of the block and colour that differ most.
    pub block: f64,
    /// The first picture's mean over the second's, less one.
    pub difference: f64,
    /// The larger of the two if the first were two per cent brighter, where there is noise.
    pub planted: f64,
}

impl Agreement {
    /// Compares pictures of `width` columns and so many samples a pixel.
    pub fn of(a: &[Pixel], b: &[Pixel], width: usize, samples: f64) -> Self {
        let brighter: Vec<Pixel> = a
            .iter()
            .map(|pixel| Pixel {
                mean: pixel.mean.map(|m| m * PLANTED),
                variance: pixel.variance.map(|v| v * PLANTED * PLANTED),
            })
            .collect();
        let (picture, block) = furthest(a, b, [width, samples as usize], f64::INFINITY);
        let planted = furthest(&brighter, b, [width, samples as usize], 0.0);
        let sum = |pixels: &[Pixel]| pixels.iter().flat_map(|p| p.mean).sum::<f64>();
        Self {
            picture,
            block,
            difference: sum(a) / sum(b) - 1.0,
            planted: planted.0.abs().max(planted.1.abs()),
        }
    }

    /// Whether nothing tells them apart.
    pub fn holds(&self) -> bool {
        // Not `>=`: a NaN agrees with nothing.
        self.picture.abs() < LIMIT && self.block.abs() < LIMIT
    }
}

/// The z that is furthest from zero: of the picture's colours, of blocks and colours; `certain` where things differ though
/// nothing is random.
fn furthest(a: &[Pixel], b: &[Pixel], [width, samples]: [usize; 2], certain: f64) -> (f64, f64) {
    let across = width.div_ceil(BLOCK);
    let blocks = across * a.len().div_ceil(width).div_ceil(BLOCK);
    let mut sums = vec![[Sum::default(); 3]; blocks];
    for (index, (a, b)) in a.iter().zip(b).enumerate() {
        let block = index / width / BLOCK * across + index % width / BLOCK;
        for (c, sum) in sums[block].iter_mut().enumerate() {
            sum.samples += samples as f64;
            sum.mean += b.mean[c];
            sum.difference += a.mean[c] - b.mean[c];
            sum.variances[0] += a.variance[c];
            sum.variances[1] += b.variance[c];
        }
    }
    let mut whole = [Sum::default(); 3];
    for block in &sums {
        for (sum, part) in whole.iter_mut().zip(block) {
            sum.difference += part.difference;
            sum.variances[0] += part.variances[0];
            sum.variances[1] += part.variances[1];
        }
    }
    let largest = |values: &mut dyn Iterator<Item = Sum>| {
        let z = values.map(|sum| sum.z(certain));
        z.fold(0.0_f64, |most, z| {
            if z.abs() > most.abs() || z.is_nan() {
                z
            } else {
                most
            }
        })
    };
    (
        largest(&mut whole.into_iter()),
        largest(&mut sums.into_iter().flatten().filter(Sum::is_known)),
    )
}

/// Of the pixels of a block, in one colour.
#[derive(Clone, Copy, Debug, Default)]
struct Sum {
    samples: f64,
    mean: f64,
    difference: f64,
    variances: [f64; 2],
}

impl Sum {
    /// Where nothing is random, rounding is all that may differ.
    fn z(&self, certain: f64) -> f64 {
        let variance = self.variances[0] + self.variances[1];
        if variance > 0.0 {
            self.difference / variance.sqrt()
        } else if self.difference.abs() < 1e-4 {
            0.0
        } else {
            certain
        }
    }

    /// Whether the noisier way has met enough to know its variance, or neither has any.
    fn is_known(&self) -> bool {
        let [a, b] = self.variances;
        let largest = if a.is_nan() { a } else { a.max(b) };
        // Not `>=`: a NaN is known to be wrong.
        !(largest > 0.0 && largest * self.samples * self.samples < EVENTS * self.mean * self.mean)
    }
}

/// The mean of several runs of the same length.
pub fn average(runs: &[Vec<Pixel>]) -> Vec<Pixel> {
    let n = runs.len() as f64;
    let pixels = runs.iter().map(Vec::len).min().unwrap_or(0);
    let mean = |pixel: usize| {
        let mut all = Pixel::default();
        for run in runs {
            for c in 0..3 {
                all.mean[c] += run[pixel].mean[c] / n;
                all.variance[c] += run[pixel].variance[c] / (n * n);
            }
        }
        all
    };
    (0..pixels).map(mean).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn flat(mean: f64, deviation: f64) -> Vec<Pixel> {
        let pixel = Pixel {
            mean: [mean; 3],
            variance: [deviation * deviation; 3],
        };
        vec![pixel; 1024]
    }

    #[test]
    fn z_is_that_of_sums() {
        let found = Agreement::of(&flat(1.01, 0.3), &flat(1.0, 0.4), 32, 99.0);
        // 0.01 over 0.5 / √1024 and over 0.5 / √256.
        assert!((found.picture - 0.64).abs() < 1e-9, "{found:?}");
        assert!((found.block - 0.32).abs() < 1e-9, "{found:?}");
        assert!((found.planted - 0.0302 / (0.3_f64 * 1.02).hypot(0.4) * 32.0).abs() < 1e-9);
        assert!(found.holds());
    }

    #[test]
    fn what_differs_does_not_agree() {
        assert!(!Agreement::of(&flat(1.1, 0.3), &flat(1.0, 0.4), 32, 99.0).holds());
        assert!(!Agreement::of(&flat(1.1, 0.0), &flat(1.0, 0.0), 32, 99.0).holds());
        assert!(!Agreement::of(&flat(f64::NAN, 0.3), &flat(1.0, 0.4), 32, 99.0).holds());
        // Too few events for blocks, but not for the picture.
        let rare = Agreement::of(&flat(1.0, 1e-4), &flat(1.001, 1e-4), 32, 99.0);
        assert!(rare.block == 0.0 && rare.picture < -LIMIT, "{rare:?}");
        assert!(Agreement::of(&flat(1.0, 0.0), &flat(1.0, 0.0), 32, 99.0).holds());
    }
}
