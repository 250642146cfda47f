//! What runs are held against, and how far from it they are.

use crate::film::{Film, Window};
use crate::image::Image;

/// Side of the blocks whose median fireflies do not move.
const BLOCK: u32 = 16;
/// As in relMSE.
const FLOOR: f64 = 1e-2;

/// A picture with the variance of its pixels.
#[derive(Clone, Debug, PartialEq)]
pub struct Reference {
    window: Window,
    /// Mean and variance of it, by pixel and channel.
    pixels: Vec<[(f64, f64); 3]>,
    /// 10⁻² times the square of the mean of all.
    floor: f64,
}

/// How far a run is from the reference.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Judgement {
    /// Mean square error, without the reference's.
    pub mse: f64,
    /// relMSE, without the reference's.
    pub relative: f64,
    /// The median of relMSE over blocks of 16 × 16 pixels that have noise.
    pub median: f64,
}

impl Reference {
    fn new(window: Window, pixels: Vec<[(f64, f64); 3]>) -> Self {
        let all = pixels.iter().flatten();
        let mean = all.map(|(m, _)| m).sum::<f64>() / (3.0 * pixels.len().max(1) as f64);
        Self {
            window,
            pixels,
            floor: FLOOR * mean * mean,
        }
    }

    /// Of a film. Pixels without a variance count as exact.
    pub fn of_film(film: &Film) -> Self {
        let window = film.window();
        let mut pixels = vec![[(0.0, 0.0); 3]; window.pixels() as usize];
        for (x, y, pixel) in film.pixels() {
            let (mean, variance) = (pixel.mean(), pixel.variance_of_mean().unwrap_or([0.0; 3]));
            pixels[window.index(x, y)] = [0, 1, 2].map(|c| (mean[c], variance[c]));
        }
        Self::new(window, pixels)
    }

    /// Of an image with `R G B` and `Variance.R/G/B`; `None` if a channel is missing or holds what is not finite.
    pub fn of_image(image: &Image) -> Option<Self> {
        let mut pixels = vec![[(0.0, 0.0); 3]; image.window.pixels() as usize];
        for (c, colour) in ["R", "G", "B"].into_iter().enumerate() {
            let mean = image.channel(colour)?;
            let variance = image.channel(&format!("Variance.{colour}"))?;
            for ((pixel, m), v) in pixels.iter_mut().zip(mean).zip(variance) {
                if !(m.is_finite() && v.is_finite() && *v >= 0.0) {
                    return None;
                }
                pixel[c] = (f64::from(*m), f64::from(*v));
            }
        }
        Some(Self::new(image.window, pixels))
    }

    /// The pixels it has.
    pub fn window(&self) -> Window {
        self.window
    }

    /// Its own relMSE, as its variance tells.
    pub fn error(&self) -> f64 {
        let of = |&(mean, variance): &(f64, f64)| {
            if variance > 0.0 {
                variance / (mean * mean + self.floor)
            } else {
                0.0
            }
        };
        self.pixels.iter().flatten().map(of).sum::<f64>() / (3 * self.pixels.len()).max(1) as f64
    }

    /// How far a film of the same window is.
    pub fn judge(&self, film: &Film) -> Judgement {
        let [width, height] = self.window.size();
        let [columns, rows] = [width, height].map(|size| size.div_ceil(BLOCK) as usize);
        /// Sums over a block.
        #[derive(Clone, Copy, Default)]
        struct Sums {
            values: f64,
            square: f64,
            relative: f64,
            noisy: bool,
        }
        let mut blocks = vec![Sums::default(); columns * rows];
        for (x, y, pixel) in film.pixels() {
            if !self.window.contains(x, y) {
                continue;
            }
            let of_block = [x - self.window.x0, y - self.window.y0].map(|n| (n / BLOCK) as usize);
            let block = &mut blocks[of_block[1] * columns + of_block[0]];
            let references = self.pixels[self.window.index(x, y)];
            for (value, (mean, variance)) in pixel.mean().into_iter().zip(references) {
                let square = (value - mean).powi(2) - variance;
                block.values += 1.0;
                block.square += square;
                block.noisy |= square != 0.0;
                let scale = mean * mean + self.floor;
                if scale > 0.0 {
                    block.relative += square / scale;
                }
            }
        }
        let total = |of: fn(&Sums) -> f64| blocks.iter().map(of).sum::<f64>();
        let values = total(|b| b.values).max(1.0);
        let noisy = blocks.iter().filter(|b| b.noisy);
        let mut medians: Vec<f64> = noisy.map(|b| b.relative / b.values).collect();
        medians.sort_by(f64::total_cmp);
        Judgement {
            mse: total(|b| b.square) / values,
            relative: total(|b| b.relative) / values,
            median: match medians.len() {
                0 => 0.0,
                n => 0.5 * (medians[(n - 1) / 2] + medians[n / 2]),
            },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every pixel gets the two samples.
    fn film(a: f32, b: f32) -> Film {
        let mut film = Film::new([40, 20], Window::full([40, 20]));
        for tile in film.tiles_mut() {
            let w = tile.window();
            for (x, y) in (w.y0..w.y1).flat_map(|y| (w.x0..w.x1).map(move |x| (x, y))) {
                tile.add(x, y, 0, [a; 3], 1.0);
                tile.add(x, y, 1, [b; 3], 1.0);
            }
        }
        film
    }

    #[test]
    fn the_reference_pays_for_its_own_error() {
        // Mean 2, variance of the mean 1/4 · 2 / 2 = 1/16 (samples 1.75 and 2.25).
        let reference = Reference::of_film(&film(1.75, 2.25));
        assert!((reference.error() - 0.0625 / 4.04).abs() < 1e-12);
        let judged = reference.judge(&film(3.0, 3.0));
        assert!((judged.mse - (1.0 - 0.0625)).abs() < 1e-12);
        assert!((judged.relative - (1.0 - 0.0625) / 4.04).abs() < 1e-12);
        assert!((judged.median - judged.relative).abs() < 1e-12);
        let image = Image::from_film(&film(1.75, 2.25));
        assert_eq!(Reference::of_image(&image), Some(reference));
    }

    #[test]
    fn fireflies_move_the_mean_and_not_the_median() {
        let reference = Reference::of_film(&film(2.0, 2.0));
        let mut bright = film(2.5, 2.5);
        bright.tiles_mut()[0].add(3, 4, 2, [1e6; 3], 1.0);
        let judged = reference.judge(&bright);
        assert!((judged.median - 0.25 / 4.04).abs() < 1e-12);
        assert!(judged.relative > 1e6);
    }
}
