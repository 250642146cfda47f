//! What the page sums up and shows.

use crate::tone;

/// Linear Rec. 709 to luminance.
const LUMINANCE: [f64; 3] = [0.2126, 0.7152, 0.0722];

/// Sums over the samples of each pixel.
#[derive(Debug, Default)]
pub(crate) struct Film {
    width: usize,
    sums: Vec<[f64; 3]>,
    /// Of the squares of luminances.
    squares: Vec<f64>,
    /// Samples of each row.
    samples: Vec<u32>,
    /// Red, green, blue and opacity of what is shown.
    pub(crate) picture: Vec<[u8; 4]>,
    levels: Levels,
}

impl Film {
    /// Empties the film, for pictures of this size. Its levels stay, as every movement of a hand begins a film.
    pub(crate) fn begin(&mut self, width: u32, height: u32) {
        let [width, height] = [width, height].map(|n| n as usize);
        self.width = width;
        self.sums = vec![[0.0; 3]; width * height];
        self.squares = vec![0.0; width * height];
        self.samples = vec![0; height];
        self.picture = vec![[0, 0, 0, 255]; width * height];
    }

    /// Adds a sample to each pixel of some rows; what is beyond the film is left away.
    pub(crate) fn add(&mut self, first: u32, rows: &[[f32; 3]]) {
        let width = self.width.max(1);
        let first = first as usize;
        for row in self.samples.iter_mut().skip(first).take(rows.len() / width) {
            *row += 1;
        }
        let sums = self.sums.iter_mut().zip(&mut self.squares);
        for ((sum, square), radiance) in sums.skip(first * width).zip(rows) {
            let mut luminance = 0.0;
            for ((sum, new), weight) in sum.iter_mut().zip(radiance).zip(LUMINANCE) {
                let new = f64::from(*new);
                *sum += new;
                luminance += weight * new;
            }
            *square += luminance * luminance;
        }
    }

    /// Pixels with the number of their samples: sums of colours, and of squares.
    fn pixels(&self) -> impl Iterator<Item = (f64, &[f64; 3], f64)> {
        let width = self.width.max(1);
        let samples = self.samples.iter();
        let counts = samples.flat_map(move |n| std::iter::repeat_n(f64::from(*n), width));
        let pixels = counts.zip(&self.sums).zip(&self.squares);
        pixels.map(|((n, sum), square)| (n, sum, *square))
    }

    pub(crate) fn develop(&mut self) {
        let mut picture = std::mem::take(&mut self.picture);
        for (shown, (n, sum, _)) in picture.iter_mut().zip(self.pixels()) {
            let scale = if n > 0.0 { 1.0 / n } else { 0.0 };
            let [r, g, b] = sum.map(|x| self.levels.of((x * scale) as f32));
            *shown = [r, g, b, 255];
        }
        self.picture = picture;
    }

    /// See `noise` of the module. Dark pixels count little: the mean square error over the mean square.
    pub(crate) fn noise(&self) -> f64 {
        let (mut error, mut shown) = (0.0, 0.0);
        for (n, sum, square) in self.pixels() {
            let luminance: f64 = sum.iter().zip(LUMINANCE).map(|(x, w)| x * w).sum();
            let mean = luminance / n;
            let variance = (square / n - mean * mean).max(0.0) * n / (n - 1.0);
            error += if n > 1.0 { variance / n } else { f64::NAN };
            shown += mean * mean;
        }
        (error / shown).sqrt()
    }

    pub(crate) fn mean(&self) -> f64 {
        let means = self.pixels();
        let means = means.map(|(n, sum, _)| sum.iter().map(|x| x / n).sum::<f64>());
        means.sum::<f64>() / (3.0 * self.sums.len() as f64)
    }
}

/// The least number of each level of a picture, as the program's own pictures have them.
#[derive(Debug)]
struct Levels([f32; 256]);

impl Default for Levels {
    fn default() -> Self {
        let least = |level: usize| {
            // Positive floats are in the order of their bits.
            let (mut below, mut above) = (0_u32, f32::MAX.to_bits());
            while above - below > 1 {
                let middle = below + (above - below) / 2;
                if usize::from(tone::level(f32::from_bits(middle))) < level {
                    below = middle;
                } else {
                    above = middle;
                }
            }
            f32::from_bits(above)
        };
        Self(std::array::from_fn(least))
    }
}

impl Levels {
    fn of(&self, x: f32) -> u8 {
        let above = self.0[1..].partition_point(|least| *least <= x);
        above as u8
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn levels_are_those_of_pictures() {
        let levels = Levels::default();
        for step in 0..2_000_000_u32 {
            let x = f32::from_bits(step * 600 + 0x3000_0000);
            assert_eq!(levels.of(x), tone::level(x), "{x}");
        }
        for x in [0.0, -1.0, f32::NAN, f32::MIN_POSITIVE, f32::MAX] {
            assert_eq!(levels.of(x), tone::level(x), "{x}");
        }
    }

    #[test]
    fn means_and_errors_are_those_of_the_samples() {
        let mut film = Film::default();
        film.begin(2, 2);
        let row = |a: f32, b: f32| [[a; 3], [b; 3]];
        for [a, b] in [[1.0, 4.0], [3.0, 4.0]] {
            film.add(0, &row(a, b));
            film.add(1, &row(b, a));
        }
        assert_eq!(film.mean(), 3.0);
        // Of the mean of 1 and 3 the variance is 1, of 4 and 4 it is 0: the mean square is 1/2, over (4 + 16)/2.
        assert!((film.noise() - 0.05_f64.sqrt()).abs() < 1e-6);
        film.add(0, &row(1.0, 1.0));
        film.develop();
        let level = tone::level(5.0 / 3.0);
        assert_eq!(film.picture[0], [level, level, level, 255]);
        film.add(7, &row(9.0, 9.0));
        assert_eq!(film.picture.len(), 4);
        film.begin(2, 2);
        assert!(film.noise().is_nan());
    }
}
