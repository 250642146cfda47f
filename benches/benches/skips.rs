//! What skipping gains: each feature that a scene does not need, kept all the same.
//!
//! ```text
//! cargo bench -p woodcock-benches --bench skips [-- FEATURE...]
//! ```
//!
//! *time* is how many times longer a picture takes with the feature, *gain* how much worse CPU seconds times relMSE become: medians and
//! jackknife of interleaved runs with the same seeds, one thread. The last lines have the numbers for `explain`.
#![forbid(unsafe_code)]

use std::error::Error;

use woodcock_benches::measure::{EDGE, Way, assemble, compare, median, render};
use woodcock_benches::yardstick::Yardstick;
use woodcock_benches::{quick, selected};
use woodcock_host::render::Kernel;
use woodcock_host::world::Feature;

const SCENES: [&str; 6] = ["cloud", "ground", "fog", "smoke", "absorption", "fire"];

fn main() -> Result<(), Box<dyn Error>> {
    let (samples, rounds, coarser, edge) = if quick() {
        (1, 3, 4, EDGE / 4)
    } else {
        (16, 4, 1, EDGE / 2)
    };
    println!(
        "{:<24} {:<11} {:>7} {:>9} {:>7}",
        "feature kept", "scene", "time", "variance", "gain"
    );
    let mut largest = Vec::new();
    for name in SCENES {
        let Some(scene) = Yardstick::named(name, coarser) else {
            continue;
        };
        let lean = assemble(&scene, edge, &[])?;
        let skipped = |f: &Feature| f.can_be_kept() && !lean.needs.runs(*f) && selected(f.name());
        for feature in Feature::ALL.into_iter().filter(skipped) {
            let kept = assemble(&scene, edge, &[feature])?;
            let (mut with, mut without) = (Way::new(samples), Way::new(samples));
            for seed in 0..rounds {
                with.run(|samples| render(&kept, Kernel::Packet, samples, seed));
                without.run(|samples| render(&lean, Kernel::Packet, samples, seed));
            }
            let both = compare(&with, &without);
            let pairs = with.seconds.iter().zip(&without.seconds);
            let time = median(pairs.map(|(with, without)| with / without));
            let (gain, error) = both.gain;
            println!(
                "{:<24} {name:<11} {time:>7.2} {:>9.2} {gain:>7.2} (*/ {error:.2})",
                feature.name(),
                both.a.variance / both.b.variance,
            );
            largest.push((feature, name, time, gain));
        }
    }
    println!();
    for (feature, name, time, gain) in largest {
        println!("(Feature::{feature:?}, \"{name}\", {time:.2}, {gain:.2}),");
    }
    Ok(())
}
