//! How noisy the picture still is, in one number.

use super::{Film, Pixel};

/// Added to the squared reference so that dark pixels do not decide alone; the 10⁻² of the usual relMSE.
const EPSILON: f64 = 1.0e-2;

/// Pixels a quick estimate looks at.
const QUICK_PIXELS: u64 = 1 << 14;

impl Film {
    /// Relative error of the image as it estimates itself:
    ///
    /// ```text
    /// √( mean over pixels p and channels c of  Var[mean_pc] / (mean_pc² + 10⁻² · m²) ),   m = mean of all mean_pc
    /// ```
    ///
    /// The square is the expected relMSE (the image's own mean stands for the reference, so it is meant for many
    /// samples a pixel). Pixels with fewer than two independent samples are left out; `None` if that is all of them. A black
    /// image has error 0.
    pub fn relative_error(&self) -> Option<f64> {
        relative_error(self.pixels().map(|(.., pixel)| pixel))
    }

    /// The same from a regular subset of about 2¹⁴ pixels: cheap enough for every pass of a progress display.
    pub fn relative_error_quick(&self) -> Option<f64> {
        let stride = (self.window.pixels() / QUICK_PIXELS).max(1);
        // Odd, so that it does not fall into step with the 16 columns of a tile.
        relative_error(self.pixels().map(|(.., p)| p).step_by(stride as usize | 1))
    }

    /// Samples per pixel, those that were not finite aside; zero of an empty window.
    pub fn samples_per_pixel(&self) -> f64 {
        let all: u64 = self.pixels().map(|(.., p)| u64::from(p.samples())).sum();
        all as f64 / self.window.pixels().max(1) as f64
    }
}

/// Sums run in the order of the pixels, in `f64`: the same number for the same film.
fn relative_error<'a>(pixels: impl Iterator<Item = Pixel<'a>> + Clone) -> Option<f64> {
    let known = || pixels.clone().filter(|p| p.independent() >= 2);
    let count = 3.0 * known().count() as f64;
    let image_mean = known().flat_map(|p| p.mean()).sum::<f64>() / count;
    let floor = EPSILON * image_mean * image_mean;
    let mut sum = 0.0;
    for pixel in known() {
        let variance = pixel.variance_of_mean()?;
        for (mean, variance) in pixel.mean().into_iter().zip(variance) {
            if variance > 0.0 {
                sum += variance / (mean * mean + floor);
            }
        }
    }
    (count > 0.0).then(|| (sum / count).sqrt())
}

#[cfg(test)]
mod tests {
    use crate::film::{Film, Window};

    /// Every pixel gets the two samples `a`, `b` in all channels.
    fn film(a: f32, b: f32) -> Film {
        let mut film = Film::new([50, 30], Window::full([50, 30]));
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
    fn matches_the_definition() {
        // mean 2, variance of the mean ((1 − 2)² + (3 − 2)²) / (2 · 1) = 1
        let expected = (1.0_f64 / (4.0 + 0.04)).sqrt();
        let error = film(1.0, 3.0).relative_error().expect("two samples");
        assert!((error - expected).abs() < 1e-12);
        let quick = film(1.0, 3.0).relative_error_quick().expect("two samples");
        assert!((quick - expected).abs() < 1e-12);
    }

    #[test]
    fn knows_what_it_does_not_know() {
        assert_eq!(
            Film::new([4, 4], Window::full([4, 4])).relative_error(),
            None
        );
        assert_eq!(film(0.0, 0.0).relative_error(), Some(0.0));
        assert_eq!(film(1.0, 1.0).relative_error(), Some(0.0));
    }
}
