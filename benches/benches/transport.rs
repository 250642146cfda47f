//! Ways to transport light, at equal time: path tracing, bidirectional path tracing, Metropolis light transport; and
//! the pace of the packet kernels on media alone.
//!
//! ```text
//! cargo bench -p woodcock-benches --bench transport
//! ```
//!
//! Each scene asks for one of the ways. A pilot run, thrown away, decides how many samples fit the time; then every round
//! renders each way once with a new seed. Efficiency is CPU seconds times relMSE, the seconds to reach relMSE 1: lower is
//! better. Few rounds miss rare light, so a way with fireflies looks better than it is. One thread.
//!
//! Two commits are compared by `benches/compare.sh`.
#![forbid(unsafe_code)]

use std::error::Error;
use std::hint::black_box;
use std::path::Path;
use std::time::Instant;

use woodcock_benches::relative::{Picture, Quality, Runs, judge};
use woodcock_benches::{Times, quick};
use woodcock_core::path::ShadowEstimator;
use woodcock_host::builtin;
use woodcock_host::drive::Silent;
use woodcock_host::film::Film;
use woodcock_host::integrator::Integrator;
use woodcock_host::render::{Kernel, Plan, render_pass};
use woodcock_host::report::cpu_time;
use woodcock_host::scene::{self, MemoryFiles, Scene};
use woodcock_host::world::{self, World};

/// What is compared.
const WAYS: [Integrator; 3] = [Integrator::Path, Integrator::Bdpt, Integrator::Mlt];
/// Seeds, each once with every way.
const ROUNDS: u64 = 4;

/// A scene for the comparison.
struct Stage {
    name: &'static str,
    text: &'static str,
    /// The way that it is for.
    favours: Integrator,
    /// CPU time of one run \[s\].
    seconds: f64,
}

const STAGES: [Stage; 2] = [
    Stage {
        name: "caustic",
        text: include_str!("../scenes/caustic.pbrt"),
        favours: Integrator::Bdpt,
        seconds: 1.0,
    },
    Stage {
        name: "keyhole",
        text: include_str!("../scenes/keyhole.pbrt"),
        favours: Integrator::Mlt,
        seconds: 2.0,
    },
];

fn read(name: &str, text: &str) -> Result<Scene, Box<dyn Error>> {
    let path = Path::new(name);
    let files = MemoryFiles::new().with(path, text.as_bytes());
    Ok(scene::read(path, &files, &scene::Options::default())?)
}

fn assemble(scene: &Scene, options: &world::Options) -> Result<World, Box<dyn Error>> {
    Ok(world::assemble(scene, &MemoryFiles::new(), options)?)
}

fn plan(world: &World, way: Integrator, seed: u64) -> Plan {
    let shadow = ShadowEstimator::Ratio;
    Plan::new(world, Kernel::Packet, way, seed, shadow, None)
}

/// The clock of the comparison \[s\]: CPU time where the system tells it.
fn seconds(start: Instant) -> f64 {
    cpu_time().map_or_else(|| start.elapsed().as_secs_f64(), |time| time.as_secs_f64())
}

/// A run: its picture, and what it took \[s\].
fn run(world: &World, way: Integrator, seed: u64, samples: u32) -> (Picture, f64) {
    let start = Instant::now();
    let before = seconds(start);
    let mut film = Film::new(world.resolution, world.window);
    render_pass(
        world,
        &plan(world, way, seed),
        &mut film,
        0..samples,
        &Silent,
    );
    let took = seconds(start) - before;
    let picture = film.pixels().map(|(.., pixel)| pixel.mean()).collect();
    (picture, took)
}

/// The results of one way on one scene.
#[derive(Default)]
struct Row {
    samples: u32,
    seconds: f64,
    runs: Runs,
}

fn compare(stage: &Stage) -> Result<(), Box<dyn Error>> {
    let world = assemble(&read(stage.name, stage.text)?, &world::Options::default())?;
    let pilot_seed = u64::MAX;
    let mut rows = WAYS.map(|way| {
        let (_, once) = run(&world, way, pilot_seed, 1);
        let samples = if quick() {
            1
        } else {
            (stage.seconds / once).max(1.0) as u32
        };
        Row {
            samples,
            ..Row::default()
        }
    });
    let rounds = if quick() { 2 } else { ROUNDS };
    for seed in 0..rounds {
        for (way, row) in WAYS.into_iter().zip(&mut rows) {
            let (picture, took) = run(&world, way, seed, row.samples);
            row.runs.add(picture);
            row.seconds += took / rounds as f64;
        }
    }
    let runs: Vec<Runs> = rows.iter().map(|row| row.runs.clone()).collect();
    let qualities = judge(&runs, world.resolution[0] as usize);
    let results = || WAYS.into_iter().zip(&rows).zip(&qualities);
    for ((way, row), quality) in results() {
        let Quality {
            error,
            block_median,
            mean,
            mean_error,
        } = quality;
        println!(
            "{:<9} {:<5} {:>6} {:>7.2} {error:>10.4} {block_median:>10.4} {:>10.3} {:>10.3} {mean:>10.5} +- {mean_error:.5}",
            stage.name,
            way.name(),
            row.samples,
            row.seconds,
            error * row.seconds,
            block_median * row.seconds,
        );
    }
    let efficiency = |wanted: Integrator| {
        results()
            .find(|((way, _), _)| *way == wanted)
            .map_or(f64::NAN, |((_, row), quality)| quality.error * row.seconds)
    };
    let others: Vec<String> = WAYS
        .into_iter()
        .filter(|way| *way != stage.favours)
        .map(|way| {
            let ratio = efficiency(way) / efficiency(stage.favours);
            format!("{} {ratio:.1} times", way.name())
        })
        .collect();
    println!(
        "{:<9} for the error of {}: {} the time",
        stage.name,
        stage.favours.name(),
        others.join(", "),
    );
    Ok(())
}

/// Paths a second of the packet kernel on a scene of media alone.
fn pace(name: &str, scene: &Scene, samples: u32) -> Result<(), Box<dyn Error>> {
    let options = world::Options {
        resolution: Some([160, 90]),
        ..world::Options::default()
    };
    let world = assemble(scene, &options)?;
    let plan = plan(&world, Integrator::Path, 0);
    assert!(
        plan.in_packets(&world),
        "{name}: the packet kernel should render it"
    );
    let (samples, rounds) = if quick() { (1, 1) } else { (samples, 9) };
    let mut times = Times::default();
    let mut paths = 0;
    for _ in 0..rounds {
        let mut film = Film::new(world.resolution, world.window);
        times.time(|| paths = render_pass(&world, &plan, &mut film, 0..samples, &Silent).paths);
        black_box(&film);
    }
    let rate = |quantile| paths as f64 * 1e-6 / times.quantile(quantile);
    println!(
        "{name:<9} {:>10.3} Msamples/s ({:.3}-{:.3})",
        rate(0.5),
        rate(0.75),
        rate(0.25),
    );
    Ok(())
}

fn main() -> Result<(), Box<dyn Error>> {
    println!(
        "{:<9} {:<5} {:>6} {:>7} {:>10} {:>10} {:>10} {:>10} {:>10}",
        "scene", "way", "spp", "CPU s", "relMSE", "median", "s x relMSE", "s x median", "mean"
    );
    for stage in &STAGES {
        compare(stage)?;
    }
    println!("\nmedia alone, packet kernel: median and quartiles");
    pace("cloud", &builtin::scene()?, 16)?;
    let fog = include_str!("../../host/scenes/fog-sphere.pbrt");
    pace("fog", &read("fog", fog)?, 128)?;
    Ok(())
}
