//! How many samples a wanted error takes: a small render decides, and is thrown away.
//!
//! Stopping when the samples themselves say that they suffice is a bias: one stops when rare light happened not to be seen. So a
//! *pilot*, of other random numbers, decides how many samples each pixel gets, and the picture is then made of exactly so many.
//! Given the pilot, its counts are constants: the mean is unbiased and its variance that of a plain render.
//!
//! # What is promised
//!
//! The error of a block of [`BLOCK`] × [`BLOCK`] pixels is the root mean square, over its pixels p and channels c, of relative
//! standard errors of pixel means:
//!
//! ```text
//! e² = mean over p and c of  Var[mean_pc] / (μ_pc² + 10⁻² m²),    m the mean of the whole picture
//! ```
//!
//! With a target R, each block has e ≤ R with [`CONFIDENCE`]. The floor is that of relMSE: dark pixels may err by a tenth of
//! what bright ones may.
//!
//! # How it is kept
//!
//! A block gets D / R² samples a pixel. D bounds the relative variance of one sample from above:
//!
//! ```text
//! D = max(V + 2.326 σ_V, mean of V over the block and its neighbours) + 3 / K · E[x²] / (μ² + 10⁻² m²)
//! ```
//!
//! * V is the block's mean in the pilot, σ_V its standard error from the spread over pixels and no less than a normal law's: an
//!   upper confidence bound, with some room for skewness. For μ_pc stands the pixel's mean, drawn towards the block's by the part of
//!   the scatter that is noise.
//! * The neighbours warn a block that missed what they saw.
//! * The last term is for what nobody saw: of an event that did not occur in K samples the probability is below 3 / K at 95 %
//!   [Hanley, Lippman-Hand 1983], and it may be as bright as the picture's root mean square sample. So black blocks are not taken for done.
//!
//! The pilot grows until the picture needs at most [`SHARE`] times its samples, which also makes that last term small. And no
//! pixel gets fewer than [`least`] samples.
//!
//! What the bound cannot know: light so rare that neither the pilot nor any neighbour met it, and brighter than the picture.
//! Tests hold the promise where a block's pilot meets light four times or more.

use std::ops::Range;
use std::time::Duration;

use crate::drive::{Goal, Silent, Watch, drive};
use crate::film::{Allotment, Film, Window, sum};

/// Side of a block of pixels that get the same number of samples.
pub const BLOCK: u32 = 8;
/// Probability with which a block keeps its target.
pub const CONFIDENCE: f64 = 0.95;
/// The one-sided normal quantile of 99 %: estimates of variances are skewed, and with that of 95 % the bound would keep less.
const DEVIATE: f64 = 2.326;
/// −ln 0.05: what a probability may be times the samples that did not show it.
const UNSEEN: f64 = 3.0;
/// How many times the pilot's samples the picture may need.
pub const SHARE: f64 = 16.0;
/// As in relMSE.
const FLOOR: f64 = 1e-2;
/// Tells the pilot's random numbers from the picture's, whose colours may have seeds of their own: √11's fraction.
const STREAM: u64 = 0x510e_527f_ade6_82d1;

/// The seed of a pilot, other than the picture's, which is `seed`.
pub const fn seed(seed: u64) -> u64 {
    seed ^ STREAM
}

/// The least samples of a pixel whose samples come in replicates of this size.
pub fn least(replicate: u32) -> u32 {
    let n = replicate.max(1);
    n.saturating_mul(4).max(16)
}

/// What is asked.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Target {
    /// The relative error R of a block (module documentation); positive.
    pub error: f64,
    /// No pixel is to get more samples than this.
    pub most: Option<u32>,
    /// Whether all pixels must get the same number, because light lands anywhere.
    pub uniform: bool,
    /// Time for everything; an eighth of it may go to the pilot.
    pub time: Option<Duration>,
}

/// What a pilot decided.
#[derive(Clone, Debug, PartialEq)]
pub struct Decision {
    /// Samples of each pixel.
    pub allotment: Allotment,
    /// Whether that is enough for the target; otherwise a limit cut it.
    pub enough: bool,
    /// Samples per pixel of the pilot.
    pub pilot: u32,
}

/// What the pilot says of a block, relative to its brightness.
#[derive(Clone, Copy, Debug, Default)]
struct Block {
    /// Estimate of the variance of one sample.
    variance: f64,
    /// Upper bound of that.
    bound: f64,
    /// Allowance for what was not seen.
    unseen: f64,
}

/// Columns and rows of blocks.
fn grid(window: Window) -> [usize; 2] {
    window.size().map(|size| size.div_ceil(BLOCK) as usize)
}

/// Brightness of a block in a channel, and how far its pixels' means may be believed.
#[derive(Clone, Copy, Default)]
struct Brightness {
    pixels: f64,
    mean: f64,
    squares: f64,
    variance: f64,
}

impl Brightness {
    fn add(&mut self, mean: f64, variance: f64) {
        self.pixels += 1.0;
        self.mean += mean;
        self.squares += mean * mean;
        self.variance += variance;
    }

    /// Mean over pixels.
    fn level(&self) -> f64 {
        self.mean / self.pixels.max(1.0)
    }

    /// What is best believed of a pixel: its mean, drawn towards the block's by the part of the scatter of means that is noise
    /// [James, Stein 1961]. The mean of a pilot's pixel alone may be anything where light is rare.
    fn believed(&self, mean: f64) -> f64 {
        let (level, pixels) = (self.level(), self.pixels.max(1.0));
        let scatter = (self.squares / pixels - level * level) * pixels / (pixels - 1.0).max(1.0);
        // Noise with some room: by chance it may scatter more, and a pixel must not be taken for bright because it is noisy.
        let noise = 1.5 * self.variance / pixels;
        let trust = if scatter > noise {
            (scatter - noise) / scatter
        } else {
            0.0
        };
        // A level that is high by chance would make noise look small: half a standard error is taken off.
        let error = self.variance.sqrt() / pixels;
        (level - 0.5 * error).max(0.0) + trust * (mean - level)
    }
}

/// Sums of relative variances over a block.
#[derive(Clone, Copy, Default)]
struct Sums {
    pixels: f64,
    samples: f64,
    freedom: f64,
    relative: f64,
    squares: f64,
}

/// What each block, row by row, gathers from its pixels.
fn gather(film: &Film) -> Vec<Block> {
    let window = film.window();
    let [columns, rows] = grid(window);
    let block_of = |x: u32, y: u32| {
        let [column, row] = [x - window.x0, y - window.y0].map(|at| (at / BLOCK) as usize);
        row * columns + column
    };
    let (mut sum, mut squares, mut values) = (0.0, 0.0, 0.0_f64);
    let mut brightness = vec![[Brightness::default(); 3]; columns * rows];
    for (x, y, pixel) in film.pixels() {
        let variances = pixel.variance_of_mean().unwrap_or([0.0; 3]);
        let channels = &mut brightness[block_of(x, y)];
        for ((mean, variance), channel) in pixel.mean().into_iter().zip(variances).zip(channels) {
            channel.add(mean, variance);
            sum += mean;
            squares += mean * mean + variance * f64::from(pixel.samples());
            values += 1.0;
        }
    }
    let mean = sum / values.max(1.0);
    let (floor, bright) = (FLOOR * mean * mean, squares / values.max(1.0));
    let mut blocks = vec![Sums::default(); columns * rows];
    for (x, y, pixel) in film.pixels() {
        let Some(variances) = pixel.variance_of_mean() else {
            continue;
        };
        let n = f64::from(pixel.samples());
        let at = block_of(x, y);
        let mut relative = 0.0;
        for ((mean, variance), channel) in
            pixel.mean().into_iter().zip(variances).zip(&brightness[at])
        {
            if variance > 0.0 {
                relative += n * variance / (channel.believed(mean).powi(2) + floor) / 3.0;
            }
        }
        let block = &mut blocks[at];
        block.pixels += 1.0;
        block.samples += n;
        block.freedom += f64::from(pixel.independent()) - 1.0;
        block.relative += relative;
        block.squares += relative * relative;
    }
    let block = |(sums, channels): (&Sums, &[Brightness; 3])| {
        if sums.pixels == 0.0 {
            return Block::default();
        }
        let variance = sums.relative / sums.pixels;
        let spread = (sums.squares / sums.pixels - variance * variance).max(0.0);
        let of_mean = if sums.pixels > 1.0 {
            spread / (sums.pixels - 1.0)
        } else {
            0.0
        };
        let normal = 2.0 * variance * variance / sums.freedom.max(1.0);
        let level = channels.iter().map(Brightness::level).sum::<f64>() / 3.0;
        let seen = level * level + floor;
        Block {
            variance,
            bound: variance + DEVIATE * of_mean.max(normal).sqrt(),
            unseen: if seen > 0.0 {
                UNSEEN / sums.samples * bright / seen
            } else {
                0.0
            },
        }
    };
    blocks.iter().zip(&brightness).map(block).collect()
}

/// Bounds of the relative variance of one sample, by block.
fn bounds(film: &Film) -> Vec<f64> {
    let [columns, rows] = grid(film.window());
    let blocks = &gather(film);
    let around = |at: usize, limit: usize| at.saturating_sub(1)..(at + 2).min(limit);
    let mut bounds = Vec::with_capacity(blocks.len());
    for row in 0..rows {
        for column in 0..columns {
            let near = around(row, rows)
                .flat_map(|r| around(column, columns).map(move |c| blocks[r * columns + c]));
            let (count, sum) = near.fold((0.0, 0.0), |(n, sum), b| (n + 1.0, sum + b.variance));
            let own = blocks[row * columns + column];
            bounds.push(own.bound.max(sum / count) + own.unseen);
        }
    }
    bounds
}

/// What a film of pilot samples says of the samples that a target takes.
pub fn decide(film: &Film, target: &Target) -> Decision {
    let window = film.window();
    let n = film.replicate();
    let most = target.most.unwrap_or(sum::CAPACITY).min(sum::CAPACITY);
    let mut needed: Vec<f64> = bounds(film)
        .into_iter()
        .map(|bound| bound / (target.error * target.error))
        .collect();
    if target.uniform {
        let largest = needed.iter().copied().fold(0.0, f64::max);
        needed.fill(largest);
    }
    let enough = needed.iter().all(|&count| count <= f64::from(most));
    let whole = |count: f64| {
        let count = (count.ceil() as u32).max(least(n)); // saturates
        count.checked_next_multiple_of(n).unwrap_or(count).min(most)
    };
    let counts: Vec<u32> = needed.into_iter().map(whole).collect();
    let [columns, _] = grid(window);
    let allotment = Allotment::new(window, |x, y| {
        let [column, row] = [x - window.x0, y - window.y0].map(|at| (at / BLOCK) as usize);
        counts[row * columns + column]
    });
    let pilot = film.pixels().map(|(.., p)| p.samples()).max().unwrap_or(0);
    Decision {
        allotment,
        enough,
        pilot,
    }
}

/// Runs a pilot over an empty film: its passes, which get [`seed`], until they suffice for a decision.
///
/// Heeds the clock and signals; then the decision rests on what there is. Errors: those of `pass`.
pub fn run<E>(
    film: &mut Film,
    target: &Target,
    watch: Watch<'_>,
    mut pass: impl FnMut(&mut Film, Range<u32>) -> Result<(), E>,
) -> Result<Decision, E> {
    let start = (watch.clock)();
    let limit = target.time.map(|time| time / 8);
    let mut wanted = least(film.replicate()).max(32);
    let mut done = 0;
    loop {
        let left = limit.map(|limit| {
            let elapsed = (watch.clock)().saturating_sub(start);
            limit.saturating_sub(elapsed)
        });
        let goal = Goal {
            samples: Some(wanted - done),
            time: left,
            first_sample: done,
            replicate: film.replicate(),
        };
        let unseen = Watch {
            progress: &Silent,
            ..watch
        };
        let outcome = drive(film, &goal, unseen, &mut pass)?;
        done = outcome.samples.end;
        let decision = decide(film, target);
        let share = (decision.allotment.mean() / SHARE).ceil() as u32;
        if !outcome.complete || done >= share || (watch.interrupted)() {
            return Ok(decision);
        }
        let next = share.min(done.saturating_mul(4));
        let replicate = film.replicate();
        wanted = next.checked_next_multiple_of(replicate).unwrap_or(next);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::cell::Cell;
    use std::convert::Infallible;

    const SIZE: [u32; 2] = [32, 24];

    /// Adds samples that are `bright` with probability one in `rare`, else zero, in the left half, and 1 in the right half.
    fn shine(film: &mut Film, samples: Range<u32>, bright: f32, rare: u32) {
        for tile in film.tiles_mut() {
            let w = tile.window();
            for (x, y) in (w.y0..w.y1).flat_map(|y| (w.x0..w.x1).map(move |x| (x, y))) {
                for s in samples.clone() {
                    let word = (x * 640 + y * 7919 + s)
                        .wrapping_mul(747_796_405)
                        .wrapping_add(2_891_336_453);
                    let word = (word >> ((word >> 28) + 4) ^ word).wrapping_mul(277_803_737);
                    let lit = (word >> 22 ^ word) % rare == 0;
                    let value = match (x < SIZE[0] / 2, lit) {
                        (true, true) => bright,
                        (true, false) => 0.0,
                        (false, _) => 1.0,
                    };
                    tile.add(x, y, s, [value; 3], 1.0);
                }
            }
        }
    }

    fn target(error: f64) -> Target {
        Target {
            error,
            most: None,
            uniform: false,
            time: None,
        }
    }

    fn decision(target: &Target, bright: f32, rare: u32) -> Decision {
        let mut film = Film::new(SIZE, Window::full(SIZE));
        let watch = Watch {
            clock: &|| Duration::ZERO,
            interrupted: &|| false,
            progress: &Silent,
        };
        let result = run(&mut film, target, watch, |film, samples| {
            shine(film, samples, bright, rare);
            Ok::<_, Infallible>(())
        });
        result.unwrap_or_else(|never| match never {})
    }

    #[test]
    fn samples_go_where_the_error_is_and_suffice() {
        // Bernoulli of p = 1/4 times 2: mean 1/2, variance 3/4. The picture's mean is 3/4.
        let relative = 0.75 / (0.25 + FLOOR * 0.75 * 0.75);
        for error in [0.1, 0.03] {
            let decision = decision(&target(error), 2.0, 4);
            assert!(decision.enough);
            let needed = relative / (error * error);
            let noisy = f64::from(decision.allotment.samples(3, 3));
            assert!(noisy > needed && noisy < 1.7 * needed, "{noisy} {needed}");
            // Two blocks away from the noise: only what was not seen can be there.
            let calm = decision.allotment.samples(31, 3);
            assert!(f64::from(calm) < needed / 4.0 && calm >= 16, "{calm}");
            assert!(f64::from(decision.pilot) * SHARE >= decision.allotment.mean());
        }
    }

    #[test]
    fn black_blocks_are_not_taken_for_done() {
        // Light so rare that most blocks of the first pilot miss it: its variance is 1999 times its mean squared.
        let decision = decision(&target(0.1), 1000.0, 2000);
        let mean = 0.75; // (0.5 + 1) / 2
        let needed = 0.25 * 1999.0 / (0.25 + FLOOR * mean * mean) / 0.01;
        let least = (0..24)
            .flat_map(|y| (0..16).map(move |x| (x, y)))
            .map(|(x, y)| f64::from(decision.allotment.samples(x, y)))
            .fold(f64::INFINITY, f64::min);
        assert!(least > 0.5 * needed, "{least} of {needed}");
    }

    #[test]
    fn limits_are_kept_and_told() {
        let capped = Target {
            most: Some(100),
            ..target(0.01)
        };
        let decided = decision(&capped, 2.0, 4);
        assert!(!decided.enough);
        assert_eq!(decided.allotment.largest(), 100);
        let uniform = Target {
            uniform: true,
            ..target(0.1)
        };
        let decided = decision(&uniform, 2.0, 4);
        assert_eq!(decided.allotment.smallest(), decided.allotment.largest());
        assert!(decided.enough);
    }

    #[test]
    fn a_black_picture_ends() {
        let decided = decision(&target(0.01), 0.0, 1_000_000);
        assert!(decided.allotment.smallest() >= 16);
        let mut film = Film::new(SIZE, Window::full(SIZE));
        let watch = Watch {
            clock: &|| Duration::ZERO,
            interrupted: &|| false,
            progress: &Silent,
        };
        let black = run(&mut film, &target(0.01), watch, |film, samples| {
            for tile in film.tiles_mut() {
                let w = tile.window();
                for (x, y) in (w.y0..w.y1).flat_map(|y| (w.x0..w.x1).map(move |x| (x, y))) {
                    for s in samples.clone() {
                        tile.add(x, y, s, [0.0; 3], 0.0);
                    }
                }
            }
            Ok::<_, Infallible>(())
        });
        let black = black.unwrap_or_else(|never| match never {});
        assert_eq!(black.allotment.largest(), 16);
    }

    #[test]
    fn a_pilot_can_be_stopped() {
        let now = Cell::new(0);
        let mut film = Film::new(SIZE, Window::full(SIZE));
        let watch = Watch {
            clock: &|| Duration::from_secs(now.get()),
            interrupted: &|| false,
            progress: &Silent,
        };
        let limited = Target {
            time: Some(Duration::from_secs(80)),
            ..target(0.001)
        };
        let decided = run(&mut film, &limited, watch, |film, samples| {
            now.set(now.get() + samples.len() as u64);
            shine(film, samples, 2.0, 4);
            Ok::<_, Infallible>(())
        });
        let decided = decided.unwrap_or_else(|never| match never {});
        assert!((1..=12).contains(&decided.pilot), "{}", decided.pilot);
    }
}
