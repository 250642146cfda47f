//! Whole pictures, through the library: what is known exactly, what independent tables say, and what must not matter.
//!
//! Comparisons follow `woodcock_tests::stats`: each raises a false alarm with probability 10⁻⁶ under a change of
//! random numbers. Seeds are constants; `WOODCOCK_SAMPLES` and `WOODCOCK_SEED` deepen and move a run.

use std::path::PathBuf;
use woodcock_host::scene::MemoryFiles;
use woodcock_host::world::Feature;
use woodcock_tests::pictures::Picture;
use woodcock_tests::stats::{ImageTest, Moments, ROUNDING, Verdict, Welch, Z_CRITICAL, welch};

mod assembly;
mod bits;
mod closed_forms;
mod equivalence;
mod furnace;
mod media;
mod numerics;
mod tables;

/// A volume of the tests' data, under its own name in memory.
fn volume(name: &str) -> MemoryFiles {
    MemoryFiles::new().with(name, volume_bytes(name))
}

fn volume_bytes(name: &str) -> Vec<u8> {
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR"))
        .join("data/vdb")
        .join(name);
    std::fs::read(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// Asserts that a mean agrees with a truth that has an error of its own.
///
/// * `resolution`: the relative standard error that the measurement must reach.
#[track_caller]
fn assert_near(name: &str, m: &Moments, truth: f64, truth_error: f64, resolution: f64) {
    let error = m
        .standard_error()
        .hypot(truth_error)
        .hypot(ROUNDING * truth.abs());
    let z = (m.mean() - truth) / error;
    assert!(
        error <= resolution * truth.abs(),
        "{name}: blind: error {error:.2e} for {truth}"
    );
    assert!(
        z.abs() < Z_CRITICAL,
        "{name}: mean {:.8} for {truth:.8}, z {z:+.2}, relative {:+.2e}",
        m.mean(),
        m.mean() / truth - 1.0
    );
}

/// Asserts that two pictures of independent paths show the same, as a whole, in tiles and in pixels.
#[track_caller]
fn assert_same_picture(name: &str, a: &Picture, b: &Picture, resolution: f64) {
    a.assert_sound(name);
    b.assert_sound(name);
    let test = ImageTest {
        resolution,
        // Pixels of few, skewed paths misjudge their own variance.
        allowance: 0.1,
    };
    for channel in 0..3 {
        let comparison = test.compare(&a.image(channel), &b.image(channel));
        let Welch { t, .. } = welch(&a.moments(channel), &b.moments(channel));
        assert!(
            comparison.verdict == Verdict::Agrees,
            "{name}, channel {channel}: {:?}, whole {:+.2} ({t:+.2}), worst tile {:?}, mean square {:.3} ({:+.2}), resolution {:.2e}",
            comparison.verdict,
            comparison.whole,
            comparison.worst_tile,
            comparison.mean_square,
            comparison.mean_square_z,
            comparison.resolution,
        );
    }
}

/// What `--keep` can keep.
fn keepable() -> impl Iterator<Item = Feature> {
    Feature::ALL.into_iter().filter(|f| f.can_be_kept())
}
