//! One voxel of a cloud 10, 100, 1000 times as dense: what it costs.
//!
//! ```text
//! cargo bench -p woodcock-benches --bench spike
//! ```
//!
//! The picture hardly changes, and with a bound for every block neither does the time. With one majorant for all there are ever more
//! null collisions. The variance of analog tracking, which null collisions leave alone, is taken from the cloud without a spike. One
//! thread.
#![forbid(unsafe_code)]

use std::error::Error;

use woodcock_benches::analog::Analog;
use woodcock_benches::measure::{EDGE, Way, alone, assemble, median, render, timed};
use woodcock_benches::quick;
use woodcock_benches::yardstick::{Cells, Matter, Yardstick};
use woodcock_host::render::Kernel;
use woodcock_host::world::World;

const FACTORS: [f32; 4] = [1.0, 10.0, 100.0, 1000.0];

/// A cloud of density at most one whose spike makes it `factor`.
fn spiked(side: usize, factor: f32) -> Yardstick {
    let mut scene = Yardstick::cloud(side);
    if let Matter::Cells(cells) = &mut scene.matter {
        Cells::spike(cells, factor);
    }
    scene
}

fn main() -> Result<(), Box<dyn Error>> {
    let (samples, rounds, side) = if quick() { (1, 3, 64) } else { (16, 9, 256) };
    let scenes: Vec<Yardstick> = FACTORS.map(|factor| spiked(side, factor)).into();
    let worlds: Result<Vec<World>, _> = scenes.iter().map(|s| assemble(s, EDGE, &[])).collect();
    let worlds = worlds?;
    let mut ways: Vec<Way> = FACTORS.map(|_| Way::new(samples)).into();
    for seed in 0..rounds {
        for (world, way) in worlds.iter().zip(&mut ways) {
            way.run(|samples| render(world, Kernel::Packet, samples, seed));
        }
    }
    println!(
        "{:>6} {:>9} {:>7} {:>9} {:>10} {:>7} {:>12} {:>8}",
        "spike", "ns/path", "time", "var/path", "s x relMSE", "ratio", "analog ns", "time"
    );
    let first = alone(&ways[0]);
    let mut analog_first = f64::NAN;
    for ((factor, scene), way) in FACTORS.into_iter().zip(&scenes).zip(&ways) {
        let cost = alone(way);
        let slower = way
            .seconds
            .iter()
            .zip(&ways[0].seconds)
            .map(|(with, without)| with / without);
        let analog = Analog::new(scene);
        // The densest would take minutes for a whole picture: one pixel among sixteen will do.
        let stride = match (quick(), factor as u32) {
            (true, _) => 16,
            (_, 0..=10) => 1,
            (_, 11..=100) => 2,
            _ => 4,
        };
        let paths = (EDGE / stride).pow(2) as f64;
        let mut times: Vec<f64> = Vec::new();
        for seed in 0..5 {
            let (_, took) = timed(|| analog.render_every(stride, 1, seed));
            times.push(took * 1e9 / paths);
        }
        let nanoseconds = median(times);
        if factor == 1.0 {
            analog_first = nanoseconds;
        }
        println!(
            "{factor:>6} {:>9.1} {:>7.3} {:>9.4} {:>10.3e} {:>7.3} {nanoseconds:>12.0} {:>8.2}",
            cost.nanoseconds,
            median(slower),
            cost.variance,
            cost.efficiency,
            cost.efficiency / first.efficiency,
            nanoseconds / analog_first,
        );
    }
    Ok(())
}
