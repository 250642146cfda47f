//! Samples that depend on each other, in independent groups.
//!
//! The points of a randomised net fill the unit cube more evenly than independent ones, so the samples of one net are correlated, and
//! the scatter of samples says nothing about the error of their mean. Nets randomised anew are independent: samples with the
//! indices `k N … (k + 1) N − 1` form the *replicate* `k` of `N`, and only the scatter of the means of replicates counts [Owen 1997]:
//!
//! ```text
//! mean = S / n,    variance of the mean = N / n · Σᵣ (mᵣ − m̄)² / (R − 1),    mᵣ the mean of whole replicate r, R of them
//! ```
//!
//! The mean is that of all samples. The last replicate of a render may be cut short, and one that lost a path which was not
//! finite is no whole one either: such samples enter the mean alone. The factor `N / n` then stands for their share too; a cut
//! replicate is less even than a whole one, so with few replicates that share is somewhat underestimated (exact where `N` divides
//! `n`). Means of replicates are rounded once to `f32`.

use std::ops::Range;

use woodcock_core::path::PathSample;

use super::moments::scatter;
use super::sum::BinnedSum;
use super::{PixelMoments, Tile};

/// The most samples of a replicate.
pub const LARGEST: u32 = 1 << 16;

/// Number and sum of the means of a pixel's whole replicates. The sum of their squares is in the pixel's moments, in the place of the
/// samples' own, which say nothing here.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct ReplicateSums {
    pub(super) count: u32,
    pub(super) means: [BinnedSum; 3],
}

impl ReplicateSums {
    /// Adds a whole replicate.
    pub(super) fn add(&mut self, mean: [f32; 3]) {
        self.count += 1;
        for (sum, mean) in self.means.iter_mut().zip(mean) {
            sum.add(mean);
        }
    }

    /// Adds another's replicates, which its pixel's moments have room for.
    pub(super) fn merge(&mut self, other: &Self) {
        self.count += other.count;
        for (sum, part) in self.means.iter_mut().zip(&other.means) {
            sum.merge(part);
        }
    }
}

/// What a film knows of a pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Pixel<'a> {
    pub(super) moments: &'a PixelMoments,
    /// The whole replicates and the size of one, where samples come in replicates.
    pub(super) replicates: Option<(&'a ReplicateSums, u32)>,
}

impl Pixel<'_> {
    /// Number of finite samples.
    pub fn samples(&self) -> u32 {
        self.moments.samples()
    }

    /// Number of independent values behind the variance: whole replicates, or samples where each is one.
    pub fn independent(&self) -> u32 {
        self.replicates
            .map_or_else(|| self.samples(), |(sums, _)| sums.count)
    }

    /// Mean radiance of all samples; zero without samples.
    pub fn mean(&self) -> [f64; 3] {
        self.moments.mean()
    }

    /// Mean alpha: the fraction of camera paths that met the scene; zero without samples.
    pub fn alpha(&self) -> f64 {
        self.moments.alpha()
    }

    /// Estimate of the variance of [`mean`](Self::mean), per channel (module documentation); `None` below two independent values.
    pub fn variance_of_mean(&self) -> Option<[f64; 3]> {
        let Some((sums, size)) = self.replicates else {
            return self.moments.variance_of_mean();
        };
        let r = sums.count;
        if r < 2 {
            return None;
        }
        let norm = f64::from(r) * f64::from(r - 1) * f64::from(self.samples());
        let mut variance = [0.0; 3];
        let squares = self.moments.squares();
        for ((v, sum), square) in variance.iter_mut().zip(&sums.means).zip(squares) {
            *v = scatter(r, sum, square) * f64::from(size) / norm;
        }
        Some(variance)
    }
}

/// Where a sample belongs.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Place {
    /// Column of its pixel in the whole picture.
    pub x: u32,
    /// Row of its pixel in the whole picture.
    pub y: u32,
    /// Index of the sample.
    pub sample: u32,
    /// All samples that land in this pixel now.
    pub samples: Range<u32>,
}

/// A replicate of which some samples have landed.
#[derive(Debug)]
struct Open {
    x: u32,
    y: u32,
    first: u32,
    landed: usize,
    samples: Vec<PathSample>,
}

/// Puts samples that come in any order into the order of their replicates, and these into a tile.
///
/// Samples begin in order, and few are on their way at any time, so few replicates are open: no more than paths in flight, and one.
#[derive(Debug, Default)]
pub struct Landing {
    open: Vec<Open>,
    spare: Vec<Vec<PathSample>>,
}

impl Landing {
    /// Takes a sample. Every sample of `place.samples` must come, each once; then the tile holds them all.
    ///
    /// The pixel must lie in the tile (panics otherwise).
    pub fn land(&mut self, tile: &mut Tile, place: Place, path: PathSample) {
        let Place { x, y, sample, .. } = place;
        let size = tile.replicate();
        if size == 1 {
            tile.add(x, y, sample, path.radiance, path.alpha);
            return;
        }
        let start = sample - sample % size;
        let first = start.max(place.samples.start);
        let end = start.saturating_add(size).min(place.samples.end);
        let found = self
            .open
            .iter()
            .rposition(|open| (open.x, open.y, open.first) == (x, y, first));
        let at = found.unwrap_or_else(|| {
            let mut samples = self.spare.pop().unwrap_or_default();
            samples.clear();
            samples.resize((end - first) as usize, PathSample::default());
            self.open.push(Open {
                x,
                y,
                first,
                landed: 0,
                samples,
            });
            self.open.len() - 1
        });
        let open = &mut self.open[at];
        open.samples[(sample - first) as usize] = path;
        open.landed += 1;
        if open.landed == open.samples.len() {
            let whole = self.open.swap_remove(at);
            tile.add_replicate(x, y, first, &whole.samples);
            self.spare.push(whole.samples);
        }
    }

    /// Whether all that began to land has landed.
    pub fn is_done(&self) -> bool {
        self.open.is_empty()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::{Film, MergeError, Window};

    const ONE: [u32; 2] = [1, 1];

    fn film(replicate: u32) -> Film {
        Film::of_replicates(ONE, Window::full(ONE), replicate)
    }

    fn sample(x: f32) -> PathSample {
        PathSample {
            radiance: [x, 2.0 * x, -x],
            alpha: 1.0,
        }
    }

    /// Uniform numbers in [0, 1).
    fn uniforms(seed: u32) -> impl Iterator<Item = f32> {
        let mut state = seed;
        std::iter::repeat_with(move || {
            state = state.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
            let word = (state >> ((state >> 28) + 4) ^ state).wrapping_mul(277_803_737);
            ((word >> 22 ^ word) >> 8) as f32 / 16_777_216.0
        })
    }

    /// Adds samples in replicates, in order.
    fn fill(film: &mut Film, values: &[f32], first: u32) {
        let mut landing = Landing::default();
        let samples = first..first + values.len() as u32;
        for (sample_index, value) in samples.clone().zip(values) {
            let place = Place {
                x: 0,
                y: 0,
                sample: sample_index,
                samples: samples.clone(),
            };
            landing.land(&mut film.tiles_mut()[0], place, sample(*value));
        }
        assert!(landing.is_done());
    }

    fn variance(film: &Film) -> Option<[f64; 3]> {
        film.pixels()
            .next()
            .and_then(|(.., pixel)| pixel.variance_of_mean())
    }

    #[test]
    fn small_integers_are_exact() {
        let mut film = film(2);
        fill(&mut film, &[1.0, 3.0, 4.0, 6.0, 8.0, 8.0], 0);
        let (.., pixel) = film.pixels().next().expect("a pixel");
        assert_eq!((pixel.samples(), pixel.independent()), (6, 3));
        assert_eq!(pixel.mean(), [5.0, 10.0, -5.0]);
        // Means 2, 5, 8: Σ (m − 5)² = 18, over R (R − 1) = 6.
        assert_eq!(pixel.variance_of_mean(), Some([3.0, 12.0, 3.0]));
    }

    #[test]
    fn antithetic_pairs_have_the_variance_of_pairs() {
        // x² at u and 1 − u: the samples have variance 4/45, a pair's mean ½ − u (1 − u) has variance 1/180. So of n samples
        // the mean has variance 1/(90 n), and the scatter of samples would say 4/(45 n): eight times too much.
        const PAIRS: usize = 1 << 16;
        let pairs = uniforms(7).take(PAIRS);
        let values: Vec<f32> = pairs.flat_map(|u| [u, 1.0 - u]).map(|u| u * u).collect();
        let mut independent = film(1);
        let mut paired = film(2);
        fill(&mut independent, &values, 0);
        fill(&mut paired, &values, 0);
        let n = values.len() as f64;
        let ratio = |film: &Film, truth: f64| variance(film).map_or(f64::NAN, |v| v[0] * n / truth);
        // The relative standard error of a variance is √((κ − 1)/R), κ the kurtosis: of the mean of a pair 15/7, of x² 15/7 too.
        let error = 5.0 * (8.0 / 7.0 / PAIRS as f64).sqrt();
        assert!((ratio(&paired, 1.0 / 90.0) - 1.0).abs() < error);
        assert!((ratio(&independent, 4.0 / 45.0) - 1.0).abs() < error);
        assert!(
            (ratio(&independent, 1.0 / 90.0) - 8.0).abs() < 8.0 * error,
            "the planted mistake"
        );
    }

    #[test]
    fn replicates_of_one_are_samples() {
        let values: Vec<f32> = uniforms(3).take(100).collect();
        let mut by_landing = film(1);
        fill(&mut by_landing, &values, 5);
        let mut by_hand = Film::new(ONE, Window::full(ONE));
        for (value, index) in values.iter().zip(5..) {
            let path = sample(*value);
            by_hand.tiles_mut()[0].add(0, 0, index, path.radiance, path.alpha);
        }
        assert!(by_landing == by_hand);
    }

    #[test]
    fn the_order_of_landing_changes_no_bit() {
        let values: Vec<f32> = uniforms(1).take(64).map(|u| u * u - 0.3).collect();
        let mut in_order = film(16);
        fill(&mut in_order, &values, 0);
        let mut shuffled = film(16);
        let mut landing = Landing::default();
        for k in 0..64 {
            let index = k * 37 % 64;
            let place = Place {
                x: 0,
                y: 0,
                sample: index,
                samples: 0..64,
            };
            let path = sample(values[index as usize]);
            landing.land(&mut shuffled.tiles_mut()[0], place, path);
        }
        assert!(landing.is_done());
        assert!(in_order == shuffled);
    }

    #[test]
    fn cut_replicates_enter_the_mean_alone() {
        let values: Vec<f32> = uniforms(9).take(40).collect();
        let mut cut = film(16);
        fill(&mut cut, &values, 0);
        let mut whole = film(16);
        fill(&mut whole, &values[..32], 0);
        let (.., pixel) = cut.pixels().next().expect("a pixel");
        assert_eq!((pixel.samples(), pixel.independent()), (40, 2));
        let mean = values.iter().map(|&v| f64::from(v)).sum::<f64>() / 40.0;
        assert!((pixel.mean()[0] - mean).abs() < 1e-12);
        let expected = variance(&whole).map(|v| v[0] * 32.0 / 40.0);
        let found = variance(&cut).map(|v| v[0]);
        assert!(
            found
                .zip(expected)
                .is_some_and(|(a, b)| (a / b - 1.0).abs() < 1e-12)
        );
        // A range that begins within a replicate has no whole one there.
        let mut late = film(16);
        fill(&mut late, &values, 8);
        let (.., pixel) = late.pixels().next().expect("a pixel");
        assert_eq!((pixel.samples(), pixel.independent()), (40, 2));
        let mut short = film(16);
        fill(&mut short, &values[..16], 0);
        assert_eq!(variance(&short), None, "one replicate knows no variance");
    }

    #[test]
    fn a_lost_path_costs_its_replicate() {
        let mut values = vec![1.0_f32; 48];
        values[20] = f32::NAN;
        let mut film = film(16);
        fill(&mut film, &values, 0);
        let (.., pixel) = film.pixels().next().expect("a pixel");
        assert_eq!((pixel.samples(), pixel.independent()), (47, 2));
        assert_eq!(pixel.mean()[0], 1.0);
        assert_eq!(pixel.variance_of_mean(), Some([0.0; 3]));
        assert_eq!(film.nonfinite().count, 1);
        assert_eq!(film.nonfinite().first.map(|path| path.sample), Some(20));
    }

    #[test]
    fn films_of_one_kind_merge() {
        let values: Vec<f32> = uniforms(2).take(96).collect();
        let mut whole = film(16);
        fill(&mut whole, &values, 0);
        let mut merged = film(16);
        fill(&mut merged, &values[32..], 32);
        let mut part = film(16);
        fill(&mut part, &values[..32], 0);
        merged.merge(&part).expect("of one kind");
        assert!(merged == whole);
        assert_eq!(merged.merge(&film(8)), Err(MergeError::Replicates));
    }
}
