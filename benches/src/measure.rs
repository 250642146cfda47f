//! Rendering with woodcock's library under the clock.

use std::error::Error;
use std::ops::Range;
use std::path::Path;
use std::time::Instant;

use woodcock_core::path::{Counts, ShadowEstimator};
use woodcock_host::drive::Silent;
use woodcock_host::film::Film;
use woodcock_host::integrator::Integrator;
use woodcock_host::render::{Kernel, Plan, render_pass};
use woodcock_host::report::cpu_time;
use woodcock_host::scene::{self, MemoryFiles};
use woodcock_host::world::{self, Feature, World};

use crate::picture::Pixel;
use crate::relative::{Runs, reference};
use crate::yardstick::{RESOLUTION, Yardstick};

/// CPU time of the process since some moment \[s\]; the clock on the wall where the system does not tell.
pub fn seconds(start: Instant) -> f64 {
    cpu_time().map_or_else(|| start.elapsed().as_secs_f64(), |time| time.as_secs_f64())
}

/// What a piece of work gives, and the CPU time that it takes \[s\].
pub fn timed<T>(work: impl FnOnce() -> T) -> (T, f64) {
    let start = Instant::now();
    let before = seconds(start);
    let result = work();
    (result, seconds(start) - before)
}

/// A scene of the yardstick made ready by the library, as a square of `edge` pixels.
///
/// # Errors
/// Those of reading and assembling.
pub fn assemble(scene: &Yardstick, edge: usize, keep: &[Feature]) -> Result<World, Box<dyn Error>> {
    assemble_text(scene.name, &scene.text(), scene.volume(), edge, keep)
}

/// A scene of text, which may name one volume.
///
/// # Errors
/// Those of reading and assembling.
pub fn assemble_text(
    name: &str,
    text: &str,
    volume: Option<(String, Vec<u8>)>,
    edge: usize,
    keep: &[Feature],
) -> Result<World, Box<dyn Error>> {
    let path = Path::new(name);
    let mut files = MemoryFiles::new().with(path, text.as_bytes());
    if let Some((name, bytes)) = volume {
        files = files.with(name, bytes);
    }
    let options = world::Options {
        keep: keep.to_vec(),
        resolution: Some([edge as u32; 2]),
        ..world::Options::default()
    };
    let scene = scene::read(path, &files, &scene::Options::default())?;
    Ok(world::assemble(&scene, &files, &options)?)
}

/// Renders with the default integrator and one thread.
pub fn render(world: &World, kernel: Kernel, samples: u32, seed: u64) -> Vec<Pixel> {
    pass(world, kernel, 0..samples, seed).0
}

/// Renders the samples of these indices, and says what tracing them came to.
pub fn pass(world: &World, kernel: Kernel, samples: Range<u32>, seed: u64) -> (Vec<Pixel>, Counts) {
    let shadow = ShadowEstimator::ByNeed;
    let plan = Plan::new(world, kernel, Integrator::Path, seed, shadow, None);
    let mut film = Film::new(world.resolution, world.window);
    let counts = render_pass(world, &plan, &mut film, samples, &Silent);
    let width = world.resolution[0] as usize;
    let mut pixels = vec![Pixel::default(); width * world.resolution[1] as usize];
    for (x, y, moments) in film.pixels() {
        pixels[y as usize * width + x as usize] = Pixel {
            mean: moments.mean(),
            variance: moments.variance_of_mean().unwrap_or([f64::NAN; 3]),
        };
    }
    (pixels, counts)
}

/// One way to render a scene: its runs and their CPU times.
#[derive(Clone, Debug, Default)]
pub struct Way {
    /// Samples a pixel of each run.
    pub samples: u32,
    /// CPU time of each run \[s\].
    pub seconds: Vec<f64>,
    /// The pictures.
    pub runs: Vec<Vec<Pixel>>,
}

/// What a way costs, per path of the picture.
#[derive(Clone, Copy, Debug)]
pub struct Cost {
    /// CPU time of a path \[ns\].
    pub nanoseconds: f64,
    /// Relative mean squared error of a pixel with a single path.
    pub variance: f64,
    /// CPU seconds times relMSE.
    pub efficiency: f64,
    /// CPU time of a run \[s\].
    pub seconds: f64,
    /// Relative mean squared error of a run.
    pub error: f64,
}

impl Way {
    /// A way of so many samples a pixel.
    pub fn new(samples: u32) -> Self {
        Self {
            samples,
            ..Self::default()
        }
    }

    /// Runs and times it once more.
    pub fn run(&mut self, render: impl FnOnce(u32) -> Vec<Pixel>) {
        let (picture, took) = timed(|| render(self.samples));
        self.seconds.push(took);
        self.runs.push(picture);
    }

    fn pictures(&self) -> Runs {
        let mut runs = Runs::default();
        for run in &self.runs {
            runs.add(run.iter().map(|pixel| pixel.mean).collect());
        }
        runs
    }

    fn cost(&self, runs: &Runs, seconds: f64, reference: &crate::relative::Picture) -> Cost {
        let error = runs.error(reference);
        Cost {
            nanoseconds: seconds * 1e9 / (reference.len() as f64 * f64::from(self.samples)),
            variance: error * f64::from(self.samples),
            efficiency: seconds * error,
            seconds,
            error,
        }
    }
}

/// Two ways side by side.
#[derive(Clone, Copy, Debug)]
pub struct Comparison {
    /// Of the first.
    pub a: Cost,
    /// Of the second.
    pub b: Cost,
    /// How many times better the second is, and the factor of its standard error (jackknife over runs).
    pub gain: (f64, f64),
}

fn mean(values: impl ExactSizeIterator<Item = f64>) -> f64 {
    let n = values.len() as f64;
    values.sum::<f64>() / n
}

/// What a way costs by itself, if it was run at least three times.
pub fn alone(way: &Way) -> Cost {
    compare(way, way).b
}

/// Median of numbers; NaN of none.
pub fn median(values: impl IntoIterator<Item = f64>) -> f64 {
    let mut values: Vec<f64> = values.into_iter().collect();
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(f64::NAN)
}

/// Compares two ways that were run equally often, at least three times each.
pub fn compare(a: &Way, b: &Way) -> Comparison {
    let (runs_a, runs_b) = (a.pictures(), b.pictures());
    let reference = reference(&[&runs_a, &runs_b]);
    let cost = |way: &Way, runs: &Runs, left_out: Option<usize>| {
        let times = way.seconds.iter().enumerate();
        let kept: Vec<f64> = times
            .filter(|(i, _)| Some(*i) != left_out)
            .map(|(_, t)| *t)
            .collect();
        way.cost(runs, mean(kept.into_iter()), &reference)
    };
    let (all_a, all_b) = (cost(a, &runs_a, None), cost(b, &runs_b, None));
    let n = a.runs.len().min(b.runs.len());
    let logarithms: Vec<f64> = (0..n)
        .map(|i| {
            let (a, b) = (
                cost(a, &runs_a.without(i), Some(i)),
                cost(b, &runs_b.without(i), Some(i)),
            );
            (a.efficiency / b.efficiency).ln()
        })
        .collect();
    let centre = mean(logarithms.iter().copied());
    let spread: f64 = logarithms.iter().map(|l| (l - centre).powi(2)).sum();
    let error = (spread * (n as f64 - 1.0) / n as f64).sqrt();
    Comparison {
        a: all_a,
        b: all_b,
        gain: (all_a.efficiency / all_b.efficiency, error.exp()),
    }
}

/// Pixels along an edge of the pictures of the yardstick.
pub const EDGE: usize = RESOLUTION;
