//! Pictures whose pixels depend on each other, compared by independent replicates.
//!
//! A light path of the bidirectional integrators lands in any pixel, and a Markov chain visits one after the other: the
//! variance of a sum of pixels is not the sum of their variances. But samples with different indices are independent,
//! whatever the integrator, but where the
//! points of a plan's replicate depend on each other. So a *replicate* is one sample (or one such group) of every pixel; the mean of the picture, and of each tile of
//! [`TILE`] × [`TILE`] pixels, is one number of it; and Welch's test compares these numbers, replicate by replicate.
//!
//! A comparison makes one test of the whole and one of all tiles together, each at [`ALPHA`]. *Blind to:* errors that cancel
//! within a tile.

use woodcock_host::film::Window;

use crate::pictures::{Picture, Studio};
use crate::stats::{ALPHA, Moments, Verdict, Welch, Z_CRITICAL, deviate_of_ln_p, samples, welch};

/// Pixels along the edge of a tile.
pub const TILE: u32 = 6;

/// Moments over replicates, by colour.
type Colours = [Moments; 3];

/// What the replicates of a picture say of it.
#[derive(Clone, Debug)]
pub struct Replicates {
    columns: usize,
    whole: Colours,
    tiles: Vec<Colours>,
}

/// Two pictures, compared in one colour.
#[derive(Clone, Copy, Debug)]
pub struct Comparison {
    /// The means of the whole pictures.
    pub whole: Welch,
    /// Largest deviate among tiles, and its column and row in tiles.
    pub worst_tile: (f64, usize, usize),
    /// Standard error of the difference of the whole, relative to the reference.
    pub resolution: f64,
    /// Agrees where both tests do.
    pub verdict: Verdict,
}

impl Replicates {
    /// Renders `n` samples a pixel, times the environment's factor, in replicates of the plan's size, and asserts that no path was dropped and no bound exceeded.
    ///
    /// # Panics
    /// When one was.
    #[track_caller]
    pub fn of(name: &str, studio: &Studio, n: u32) -> Self {
        Self::of_part(name, studio, n, studio.world.window)
    }

    /// The same of a part of the picture.
    ///
    /// # Panics
    /// As [`of`](Self::of).
    #[track_caller]
    pub fn of_part(name: &str, studio: &Studio, n: u32, part: Window) -> Self {
        let size = studio.plan.replicate;
        let n = (samples(n as usize) as u32).div_ceil(size);
        let mut replicates = Self::none(part);
        for index in 0..n {
            let picture = studio.shoot_range(index * size..(index + 1) * size);
            picture.assert_sound(name);
            replicates.push(&picture, part);
        }
        replicates
    }

    /// A picture that is known: the same everywhere, without error.
    #[must_use]
    pub fn known(&self, value: f64) -> Self {
        let moments: Colours = std::array::from_fn(|_| [value; 2].into_iter().collect());
        Self {
            columns: self.columns,
            whole: moments,
            tiles: vec![moments; self.tiles.len()],
        }
    }

    fn none(part: Window) -> Self {
        let [columns, rows] = part.size().map(|n| n.div_ceil(TILE) as usize);
        Self {
            columns,
            whole: [Moments::new(); 3],
            tiles: vec![[Moments::new(); 3]; columns * rows],
        }
    }

    fn push(&mut self, picture: &Picture, part: Window) {
        let mut sums = vec![[0.0; 3]; self.tiles.len()];
        let mut counts = vec![0.0; self.tiles.len()];
        for (x, y, pixel) in picture
            .film
            .pixels()
            .filter(|(x, y, _)| part.contains(*x, *y))
        {
            let [column, row] = [x - part.x0, y - part.y0].map(|at| (at / TILE) as usize);
            let tile = row * self.columns + column;
            counts[tile] += 1.0;
            for (sum, value) in sums[tile].iter_mut().zip(pixel.mean()) {
                *sum += value;
            }
        }
        for colour in 0..3 {
            let total: f64 = sums.iter().map(|sum| sum[colour]).sum();
            self.whole[colour].push(total / part.pixels() as f64);
            for (tile, (sum, count)) in self.tiles.iter_mut().zip(sums.iter().zip(&counts)) {
                tile[colour].push(sum[colour] / count);
            }
        }
    }

    /// The mean of the picture in one colour, and its moments.
    pub fn whole(&self, colour: usize) -> &Moments {
        &self.whole[colour]
    }

    /// Compares with a reference that has an error of its own.
    ///
    /// * `resolution`: largest acceptable standard error of the difference of the whole, relative to the reference.
    pub fn compare(&self, reference: &Self, resolution: f64, colour: usize) -> Comparison {
        let whole = welch(&self.whole[colour], &reference.whole[colour]);
        let truth = reference.whole[colour].mean().abs();
        let mut worst_tile = (0.0_f64, 0, 0);
        for (index, (a, b)) in self.tiles.iter().zip(&reference.tiles).enumerate() {
            let z = welch(&a[colour], &b[colour]).z();
            // A NaN stays the worst once it is there.
            if !worst_tile.0.is_nan() && (z.is_nan() || z.abs() > worst_tile.0.abs()) {
                worst_tile = (z, index % self.columns, index / self.columns);
            }
        }
        let critical = deviate_of_ln_p((ALPHA / self.tiles.len() as f64).ln());
        let tiles = match worst_tile.0 {
            z if z.is_nan() => Verdict::Blind { resolution: z },
            z if z.abs() < critical => Verdict::Agrees,
            z => Verdict::Biased { z },
        };
        Comparison {
            whole,
            worst_tile,
            resolution: whole.standard_error / truth,
            verdict: whole.verdict(resolution * truth).and(tiles),
        }
    }

    /// Asserts that two pictures agree in every colour.
    ///
    /// # Panics
    /// When they do not, or when the comparison is blind.
    #[track_caller]
    pub fn assert_same(&self, name: &str, reference: &Self, resolution: f64) {
        for colour in 0..3 {
            let comparison = self.compare(reference, resolution, colour);
            assert!(
                comparison.verdict.agrees(),
                "{name}, colour {colour}: {}",
                self.report(reference, &comparison, colour)
            );
        }
    }

    /// A comparison in one line.
    pub fn report(&self, reference: &Self, comparison: &Comparison, colour: usize) -> String {
        let [a, b] = [self, reference].map(|r| r.whole[colour].mean());
        format!(
            "{:?}: {a:.6} against {b:.6}, relative {:+.2e}, z {:+.2}, worst tile {:?}, resolution {:.2e}, threshold {Z_CRITICAL}",
            comparison.verdict,
            a / b - 1.0,
            comparison.whole.z(),
            comparison.worst_tile,
            comparison.resolution,
        )
    }

    /// The verdict of the colour that sees a difference best.
    pub fn strongest(&self, reference: &Self, resolution: f64) -> Verdict {
        let deviate = |verdict: &Verdict| match verdict {
            Verdict::Biased { z } => z.abs(),
            _ => 0.0,
        };
        let verdicts = [0, 1, 2].map(|colour| {
            let c = self.compare(reference, resolution, colour);
            match c.verdict {
                // By whichever of its tests is the stronger.
                Verdict::Biased { .. } if c.whole.z().abs() > c.worst_tile.0.abs() => {
                    Verdict::Biased { z: c.whole.z() }
                }
                Verdict::Biased { .. } => Verdict::Biased { z: c.worst_tile.0 },
                other => other,
            }
        });
        verdicts
            .into_iter()
            .max_by(|a, b| deviate(a).total_cmp(&deviate(b)))
            .unwrap_or(Verdict::Agrees)
    }
}
