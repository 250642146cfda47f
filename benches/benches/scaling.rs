//! How speed and error change with threads, size of grid, optical depth and albedo.
//!
//! ```text
//! cargo bench -p woodcock-benches --bench scaling [-- threads|grid|full|depth|albedo] [--huge]
//! ```
//!
//! One factor at a time, from a ball of smoke under sun and sky on 128³ voxels, eight mean free paths across, of albedo 0.9.
//! Grids are made on the spot: `grid` is that ball, most of its box empty, `full` a haze without an empty voxel. `--huge` adds
//! those of 1024³ voxels; making them takes 17 GB, as the numbers pass through a file in memory. Threads each render their own samples of one
//! world; where other programs run, only their CPU time per path says something.
#![forbid(unsafe_code)]

use std::error::Error;
use std::thread;
use std::time::Instant;

use woodcock_benches::measure::{
    EDGE, Way, alone, assemble, assemble_text, median, pass, render, timed,
};
use woodcock_benches::yardstick::{Cells, Matter, Yardstick};
use woodcock_benches::{quick, selected};
use woodcock_host::render::Kernel;
use woodcock_host::world::World;

/// Grey smoke: optical depth through its middle, albedo.
fn smoke(side: usize, depth: f32, albedo: f32) -> Yardstick {
    // A unit of extinction at density one is about two thirds of a mean free path across.
    let sigma_t = 1.5 * depth;
    Yardstick {
        sigma_a: [sigma_t * (1.0 - albedo); 3],
        sigma_s: [sigma_t * albedo; 3],
        sun: Some(([-0.6, 0.7, -0.5], [2.0; 3])),
        sky: [0.5; 3],
        ..Yardstick::smoke(side)
    }
}

/// The same with matter everywhere, smooth, eight mean free paths across its middle.
fn haze(side: usize) -> Yardstick {
    let density = |p: [f32; 3]| {
        let square: f32 = p.iter().map(|c| c * c).sum();
        0.1 + 0.9 * (1.0 - square / 0.75)
    };
    Yardstick {
        matter: Matter::Cells(Cells::new([side; 3], density)),
        ..smoke(8, 6.0, 0.9)
    }
}

fn measure(
    factor: &str,
    value: &str,
    scene: Yardstick,
    samples: u32,
) -> Result<(), Box<dyn Error>> {
    let (name, text, volume) = (scene.name, scene.text(), scene.volume());
    // Largest grids leave no room for what is not needed any more.
    drop(scene);
    let (world, setup) = timed(|| assemble_text(name, &text, volume, EDGE, &[]));
    let world = world?;
    let mut way = Way::new(samples);
    for seed in 0..if quick() { 3 } else { 5 } {
        way.run(|samples| render(&world, Kernel::Packet, samples, seed));
    }
    let cost = alone(&way);
    println!(
        "{factor:<8} {value:>6} {:>9.3} {:>10.1} {:>9.4} {:>10.3e} {setup:>8.2}",
        1e3 / cost.nanoseconds,
        cost.nanoseconds,
        cost.variance,
        cost.efficiency,
    );
    Ok(())
}

/// Paths a second \[millions\], and CPU time a path \[ns\], of so many threads.
fn threaded(world: &World, threads: u32, samples: u32) -> (f64, f64) {
    let start = Instant::now();
    let ((), seconds) = timed(|| {
        thread::scope(|scope| {
            for index in 0..threads {
                let own = index * samples..(index + 1) * samples;
                scope.spawn(move || pass(world, Kernel::Packet, own, 0));
            }
        });
    });
    let paths = f64::from(threads * samples) * (EDGE * EDGE) as f64;
    (
        paths * 1e-6 / start.elapsed().as_secs_f64(),
        seconds * 1e9 / paths,
    )
}

fn main() -> Result<(), Box<dyn Error>> {
    let samples = if quick() { 1 } else { 16 };
    println!(
        "{:<8} {:>6} {:>9} {:>10} {:>9} {:>10} {:>8}",
        "factor", "", "Mpaths/s", "ns/path", "var/path", "s x relMSE", "setup s"
    );
    if selected("threads") {
        let world = assemble(&smoke(if quick() { 32 } else { 128 }, 8.0, 0.9), EDGE, &[])?;
        let cores = thread::available_parallelism().map_or(1, |n| n.get() as u32);
        let counts: Vec<u32> = (0..)
            .map(|i| 1 << i)
            .take_while(|n| *n <= 2 * cores)
            .collect();
        let rounds = if quick() { 1 } else { 7 };
        let mut paces = vec![Vec::new(); counts.len()];
        for _ in 0..rounds {
            for (threads, paces) in counts.iter().zip(&mut paces) {
                paces.push(threaded(&world, *threads, samples));
            }
        }
        for (threads, paces) in counts.iter().zip(paces) {
            let pace = median(paces.iter().map(|(pace, _)| *pace));
            let cost = median(paces.iter().map(|(_, cost)| *cost));
            println!("threads  {threads:>6} {pace:>9.3} {cost:>10.1}");
        }
    }
    let huge = std::env::args().any(|argument| argument == "--huge");
    let sides: &[usize] = match (quick(), huge) {
        (true, _) => &[32, 64],
        (_, false) => &[64, 128, 256, 512],
        (_, true) => &[64, 128, 256, 512, 1024],
    };
    if selected("grid") {
        for side in sides {
            measure("grid", &side.to_string(), smoke(*side, 8.0, 0.9), samples)?;
        }
    }
    if selected("full") {
        for side in sides {
            measure("full", &side.to_string(), haze(*side), samples)?;
        }
    }
    let side = if quick() { 32 } else { 128 };
    if selected("depth") {
        for depth in [0.1, 1.0, 10.0, 100.0, 1000.0] {
            let samples = if depth > 50.0 {
                samples.div_ceil(4)
            } else {
                samples
            };
            measure(
                "depth",
                &depth.to_string(),
                smoke(side, depth, 0.9),
                samples,
            )?;
        }
    }
    if selected("albedo") {
        for albedo in [0.5, 0.8, 0.9, 0.99, 0.999, 1.0] {
            measure(
                "albedo",
                &albedo.to_string(),
                smoke(side, 8.0, albedo),
                samples,
            )?;
        }
    }
    Ok(())
}
