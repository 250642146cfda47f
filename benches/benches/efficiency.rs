//! Seconds to a relative mean squared error of one: woodcock against plain analog tracking at full lane width.
//!
//! ```text
//! cargo bench -p woodcock-benches --bench efficiency [-- SCENE... --rounds=6]
//! ```
//!
//! Every round renders each scene once each way, with a new seed and one thread. Errors are those between rounds; setting
//! up is not timed. *gain* is how many times better woodcock is, with its standard error as a factor (jackknife over rounds), and
//! is the product of the two ratios before it. *z* tells how far apart the means of the pictures are, and those of the blocks
//! that differ most; the two must agree. *plant* is that z if one of them were 2 % brighter.
#![forbid(unsafe_code)]

use std::error::Error;

use woodcock_benches::agreement::{Agreement, LIMIT, average};
use woodcock_benches::analog::Analog;
use woodcock_benches::measure::{Cost, EDGE, Way, alone, assemble, assemble_text, compare, render};
use woodcock_benches::yardstick::{BOX_FOG, NAMES, Yardstick};
use woodcock_benches::{option, quick, selected};
use woodcock_host::render::{Kernel, kernel_name};

/// Seeds, each once each way.
const ROUNDS: u64 = 6;
/// Samples a pixel: so many that the pictures' mean will do as the reference.
const SAMPLES: u32 = 64;

fn row(scene: &str, way: &str, cost: &Cost) {
    println!(
        "{scene:<11} {way:<9} {:>8.3} {:>10.3e} {:>10.3e} {:>9.1} {:>9.4}",
        cost.seconds, cost.error, cost.efficiency, cost.nanoseconds, cost.variance,
    );
}

fn against_analog(scene: &Yardstick, samples: u32, rounds: u64) -> Result<(), Box<dyn Error>> {
    let world = assemble(scene, EDGE, &[])?;
    let analog = Analog::new(scene);
    let mut ours = Way::new(samples);
    let mut plain = Way::new(samples - samples % 3); // colours take turns
    for seed in 0..rounds {
        plain.run(|samples| analog.render(samples, seed));
        ours.run(|samples| render(&world, Kernel::Packet, samples, seed));
    }
    let both = compare(&plain, &ours);
    row(scene.name, "analog", &both.a);
    row(scene.name, "woodcock", &both.b);
    let (gain, error) = both.gain;
    println!(
        "{:<11} {}: time {:.2} x variance {:.2} = gain {gain:.2} (*/ {error:.2})",
        scene.name,
        kernel_name(&world, Kernel::Packet),
        both.a.nanoseconds / both.b.nanoseconds,
        both.a.variance / both.b.variance,
    );
    let found = Agreement::of(
        &average(&ours.runs),
        &average(&plain.runs),
        EDGE,
        rounds as f64 * f64::from(samples),
    );
    println!(
        "{:<11} z {:+.2}, of blocks {:+.2}, difference {:+.1e}, plant {:.1}",
        scene.name, found.picture, found.block, found.difference, found.planted,
    );
    // Few samples make the z of few pixels unsteady.
    let apart = if quick() {
        found.picture.abs() > LIMIT
    } else {
        !found.holds()
    };
    if apart {
        return Err(format!("{}: the two have different means", scene.name).into());
    }
    Ok(())
}

/// A scene that analog tracking cannot render.
fn by_itself(name: &str, text: &str, samples: u32, rounds: u64) -> Result<(), Box<dyn Error>> {
    let world = assemble_text(name, text, None, EDGE / 2, &[])?;
    let mut ours = Way::new(samples);
    for seed in 0..rounds {
        ours.run(|samples| render(&world, Kernel::Packet, samples, seed));
    }
    row(name, "woodcock", &alone(&ours));
    Ok(())
}

fn main() -> Result<(), Box<dyn Error>> {
    let (samples, rounds, coarser) = if quick() {
        (3, 3, 4)
    } else {
        (SAMPLES, option("--rounds", ROUNDS).max(3), 1)
    };
    println!("{rounds} rounds, {samples} samples a pixel, one thread");
    println!(
        "{:<11} {:<9} {:>8} {:>10} {:>10} {:>9} {:>9}",
        "scene", "way", "CPU s", "relMSE", "s x relMSE", "ns/path", "var/path"
    );
    for name in NAMES.into_iter().filter(|name| selected(name)) {
        match Yardstick::named(name, coarser) {
            Some(scene) => against_analog(&scene, samples, rounds)?,
            None => by_itself(name, BOX_FOG, samples, rounds)?,
        }
    }
    Ok(())
}
