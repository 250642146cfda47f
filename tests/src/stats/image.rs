//! Do two images agree, each being a mean with a variance? Welch's test at three scales.
//!
//! | scale | statistic | finds |
//! |---|---|---|
//! | whole image | difference of sums over its standard error | a bias everywhere, however small |
//! | tiles of 8 × 8 | largest of the same over tiles | a wrong object, shadow or edge |
//! | pixels | mean of t² over pixels, ν/(ν − 2) when all is well | structure that cancels in tiles; a misreported variance |
//!
//! Every pixel carries the variance *of its mean*. Pixels must be independent (box filter). *Blind to:* errors in
//! pixels where both images are exactly constant within the rounding of `f32` (they are counted as exact), and, with
//! few samples per pixel, to small ones: a pixel's variance is then correlated with its mean, which `allowance`
//! covers. Source: [Jung, Hanika, Dachsbacher 2020].

use super::{ALPHA, Moments, Verdict, Welch, Z_CRITICAL, deviate_of_ln_p};

/// Pixels along the edge of a tile.
const TILE: usize = 8;

/// One channel of an image: per pixel a mean and the variance of that mean.
#[derive(Clone, Debug, PartialEq)]
pub struct ImageMoments {
    width: usize,
    mean: Vec<f64>,
    variance: Vec<f64>,
    samples: f64,
}

impl ImageMoments {
    /// Rows of `width` pixels from the top: means, variances of the means, and samples behind each pixel.
    ///
    /// # Panics
    /// When the lengths differ, do not fill rows, or there are fewer than 2 samples per pixel.
    pub fn new(width: usize, mean: Vec<f64>, variance: Vec<f64>, samples: u64) -> Self {
        assert_eq!(mean.len(), variance.len(), "one variance per pixel");
        assert!(
            width > 0 && !mean.is_empty() && mean.len().is_multiple_of(width),
            "{} pixels do not fill rows of {width}",
            mean.len()
        );
        assert!(samples >= 2, "a variance needs two samples");
        Self {
            width,
            mean,
            variance,
            samples: samples as f64,
        }
    }

    /// From the moments of each pixel, all with the same count.
    ///
    /// # Panics
    /// As [`new`](Self::new), and when counts differ.
    pub fn from_pixels(width: usize, pixels: &[Moments]) -> Self {
        let samples = pixels.first().map_or(0, Moments::count);
        assert!(
            pixels.iter().all(|m| m.count() == samples),
            "all pixels hold {samples} samples"
        );
        Self::new(
            width,
            pixels.iter().map(Moments::mean).collect(),
            pixels.iter().map(|m| m.standard_error().powi(2)).collect(),
            samples,
        )
    }
}

/// What a comparison of images must be able to see.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ImageTest {
    /// Largest acceptable standard error of the whole difference, relative to the reference.
    pub resolution: f64,
    /// How far the mean of t² may lie from its expectation beyond chance, because pixel variances are estimated
    /// from skewed weights. 0 for normal weights; falls as 1/samples.
    pub allowance: f64,
}

/// The statistics of two images at three scales.
#[derive(Clone, Debug)]
pub struct ImageComparison {
    /// Deviate of the whole image.
    pub whole: f64,
    /// Largest deviate among tiles, and its column and row in tiles.
    pub worst_tile: (f64, usize, usize),
    /// Mean of t² over pixels with noise, divided by its expectation ν/(ν − 2): 1 when all is well.
    pub mean_square: f64,
    /// Deviate of that mean.
    pub mean_square_z: f64,
    /// Per pixel, t; for the z-map of a failure. Rows from the top.
    pub map: Vec<f64>,
    /// Standard error of the whole difference, relative to the reference.
    pub resolution: f64,
    /// Which test failed, or none.
    pub verdict: Verdict,
}

impl ImageTest {
    /// Compares `image` with `reference`; the sign of a deviate is that of image − reference.
    ///
    /// # Panics
    /// When the sizes differ.
    pub fn compare(&self, image: &ImageMoments, reference: &ImageMoments) -> ImageComparison {
        assert!(
            image.width == reference.width && image.mean.len() == reference.mean.len(),
            "images of one size compare"
        );
        let counts = [image.samples, reference.samples];
        let welch_over = |pixels: &mut dyn Iterator<Item = usize>| {
            let (mut difference, mut variances, mut size, mut freedom) = (0.0, [0.0; 2], 0.0, 0.0);
            for i in pixels {
                difference += image.mean[i] - reference.mean[i];
                variances[0] += image.variance[i];
                variances[1] += reference.variance[i];
                size += reference.mean[i].abs().max(image.mean[i].abs());
                freedom += 1.0;
            }
            let counts = counts.map(|n| freedom * (n - 1.0) + 1.0);
            Welch::of(difference, variances, counts, size)
        };

        let whole = welch_over(&mut (0..image.mean.len()));
        let total: f64 = reference.mean.iter().sum();
        let resolution = whole.standard_error / total.abs();

        let (columns, rows) = (image.width, image.mean.len() / image.width);
        let mut worst_tile = (0.0_f64, 0, 0);
        let mut tiles = 0.0;
        for row in (0..rows).step_by(TILE) {
            for column in (0..columns).step_by(TILE) {
                let bottom = (row + TILE).min(rows);
                let right = (column + TILE).min(columns);
                let z = welch_over(
                    &mut (row..bottom).flat_map(|y| (column..right).map(move |x| y * columns + x)),
                )
                .z();
                tiles += 1.0;
                // A NaN stays the worst once it is there.
                if !worst_tile.0.is_nan() && (z.is_nan() || z.abs() > worst_tile.0.abs()) {
                    worst_tile = (z, column / TILE, row / TILE);
                }
            }
        }

        let mut squares = Squares::default();
        let map: Vec<f64> = (0..image.mean.len())
            .map(|i| {
                let pixel = welch_over(&mut std::iter::once(i));
                let noisy = image.variance[i] + reference.variance[i] > 0.0;
                squares.add(pixel, noisy);
                pixel.t
            })
            .collect();
        let (mean_square, mean_square_z) = squares.finish(self.allowance);

        let beyond = |z: f64, critical: f64| {
            if z.abs() < critical {
                Verdict::Agrees
            } else if z.is_nan() {
                Verdict::Blind {
                    resolution: f64::NAN,
                }
            } else {
                Verdict::Biased { z }
            }
        };
        let sees = resolution <= self.resolution;
        let verdict = if sees {
            // One false alarm rate for all tiles together.
            let tile_critical = deviate_of_ln_p((ALPHA / tiles).ln());
            beyond(whole.z(), Z_CRITICAL)
                .and(beyond(worst_tile.0, tile_critical))
                .and(beyond(mean_square_z, Z_CRITICAL))
        } else {
            Verdict::Blind { resolution }
        };
        ImageComparison {
            whole: whole.z(),
            worst_tile,
            mean_square,
            mean_square_z,
            map,
            resolution,
            verdict,
        }
    }
}

/// Sum of t² over pixels against Student's second and fourth moments.
#[derive(Default)]
struct Squares {
    sum: f64,
    expected: f64,
    variance: f64,
    impossible: bool,
}

impl Squares {
    fn add(&mut self, pixel: Welch, noisy: bool) {
        if !noisy {
            // Without noise a difference beyond rounding is certain, and no difference is no evidence.
            self.impossible |= pixel.t.abs() > Z_CRITICAL;
            return;
        }
        let nu = pixel.dof;
        self.sum += pixel.t * pixel.t;
        self.expected += nu / (nu - 2.0);
        // Var t² = 2ν²(ν − 1) / ((ν − 2)²(ν − 4)); below ν = 5 there is none to speak of.
        self.variance += if nu > 4.0 {
            2.0 * nu * nu * (nu - 1.0) / ((nu - 2.0) * (nu - 2.0) * (nu - 4.0))
        } else {
            f64::INFINITY
        };
    }

    fn finish(self, allowance: f64) -> (f64, f64) {
        if self.impossible {
            return (f64::INFINITY, f64::INFINITY);
        }
        if self.expected == 0.0 {
            return (1.0, 0.0); // no pixel has noise
        }
        let standard_error = self.variance.sqrt() / self.expected;
        let ratio = self.sum / self.expected;
        let excess = ratio - 1.0;
        let beyond = (excess.abs() - allowance).max(0.0).copysign(excess);
        (
            ratio,
            if excess.is_nan() {
                f64::NAN
            } else {
                beyond / standard_error
            },
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stats::independent::SplitMix;

    const WIDTH: usize = 36; // no multiple of a tile
    const TEST: ImageTest = ImageTest {
        resolution: 0.01,
        allowance: 0.0,
    };

    fn render(seed: u64, samples: u64, radiance: impl Fn(usize, usize) -> f64) -> ImageMoments {
        let mut rng = SplitMix::new(seed);
        let pixels: Vec<Moments> = (0..WIDTH * 20)
            .map(|i| {
                let truth = radiance(i % WIDTH, i / WIDTH);
                (0..samples)
                    .map(|_| truth + 0.5 * truth * rng.normal())
                    .collect()
            })
            .collect();
        ImageMoments::from_pixels(WIDTH, &pixels)
    }

    fn gradient(x: usize, y: usize) -> f64 {
        0.2 + 0.02 * x as f64 + 0.01 * y as f64
    }

    #[test]
    fn equal_images_agree_at_every_scale() {
        let reference = render(101, 256, gradient);
        let comparison = TEST.compare(&render(102, 32, gradient), &reference);
        assert_eq!(comparison.verdict, Verdict::Agrees, "{comparison:?}");
        assert_eq!(comparison.map.len(), WIDTH * 20);
        let mean_squares: Moments = (0..60)
            .map(|seed| {
                TEST.compare(&render(seed, 16, gradient), &reference)
                    .mean_square
            })
            .collect();
        assert!((mean_squares.mean() - 1.0).abs() < 0.05, "{mean_squares:?}");
    }

    #[test]
    fn each_scale_finds_its_own_mistake() {
        let reference = render(103, 256, gradient);
        let dim = TEST.compare(&render(104, 64, |x, y| 0.95 * gradient(x, y)), &reference);
        assert!(dim.whole < -KILL, "{dim:?}");
        // One tile is wrong; the whole hardly moves.
        let tile = |x: usize, y: usize| {
            let wrong = (8..16).contains(&x) && (8..16).contains(&y);
            gradient(x, y) * if wrong { 1.25 } else { 1.0 }
        };
        let tile = TEST.compare(&render(105, 64, tile), &reference);
        assert_eq!((tile.worst_tile.1, tile.worst_tile.2), (1, 1));
        assert!(tile.worst_tile.0 > KILL, "{tile:?}");
        // Alternating errors cancel in tiles.
        let ripple =
            |x: usize, y: usize| gradient(x, y) * if (x + y).is_multiple_of(2) { 1.1 } else { 0.9 };
        let ripple = TEST.compare(&render(106, 64, ripple), &reference);
        assert!(ripple.mean_square_z > KILL, "{ripple:?}");
        for comparison in [dim, tile, ripple] {
            assert!(matches!(comparison.verdict, Verdict::Biased { .. }));
        }
    }

    const KILL: f64 = crate::stats::KILL_Z;

    #[test]
    fn a_misreported_variance_is_found() {
        let reference = render(107, 256, gradient);
        let mut boastful = render(108, 64, gradient);
        boastful.variance.iter_mut().for_each(|v| *v /= 4.0);
        let comparison = TEST.compare(&boastful, &reference);
        assert!(comparison.mean_square_z > KILL, "{comparison:?}");
    }

    #[test]
    fn nan_wide_bars_and_exact_pixels() {
        let reference = render(109, 256, gradient);
        let mut spoilt = render(110, 64, gradient);
        spoilt.mean[77] = f64::NAN;
        let verdict = TEST.compare(&spoilt, &reference).verdict;
        assert!(matches!(verdict, Verdict::Blind { .. }), "{verdict:?}");
        let sharp = ImageTest {
            resolution: 1e-4,
            allowance: 0.0,
        };
        let verdict = sharp
            .compare(&render(111, 64, gradient), &reference)
            .verdict;
        assert!(matches!(verdict, Verdict::Blind { .. }));
        let black = ImageMoments::new(8, vec![0.5; 64], vec![0.0; 64], 16);
        assert!(TEST.compare(&black, &black).verdict.agrees());
        let mut wrong = black.clone();
        wrong.mean[3] = 0.6;
        assert!(matches!(
            TEST.compare(&wrong, &black).verdict,
            Verdict::Biased { .. }
        ));
    }
}
