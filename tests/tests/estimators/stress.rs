//! Stress: what holds where, at the ends of every range, against double precision and closed formulas.
//!
//! `core/src/stability.rs` has the table of what is asserted here. Each check is a function of what it checks, so
//! that a planted mistake can go through the same check and must fail it by an order of magnitude. Runs are
//! deterministic. `WOODCOCK_EXHAUSTIVE=1` adds the longest sums.

mod closed_forms;
mod geometry;
mod grids;
mod media;
mod phases;
mod scale;
mod sums;
mod sweeps;
mod tracking;
mod work;

use woodcock_core::ray::Ray;
use woodcock_core::stream::{Key, PathStream};
use woodcock_core::vec3::Vec3;

/// The largest error met, and where.
#[derive(Clone, Debug, Default)]
struct Worst {
    error: f64,
    at: String,
    seen: u64,
}

impl Worst {
    /// NaN is infinitely wrong.
    fn see(&mut self, error: f64, at: impl FnOnce() -> String) {
        self.seen += 1;
        let error = if error.is_nan() { f64::INFINITY } else { error };
        if error > self.error {
            (self.error, self.at) = (error, at());
        }
    }

    #[track_caller]
    fn within(&self, name: &str, bound: f64, least: u64) {
        println!(
            "{name}: {:.3e} of {bound:e} in {} cases, at {}",
            self.error, self.seen, self.at
        );
        assert!(self.seen >= least, "{name}: only {} cases", self.seen);
        assert!(
            self.error <= bound,
            "{name}: off by {:e}, promised {bound:e}, at {}",
            self.error,
            self.at
        );
    }

    /// For a planted mistake: the check that the real thing passed must reject it with room to spare.
    #[track_caller]
    fn must_fail(&self, name: &str, bound: f64) {
        println!("{name}: {:.3e}, at {}", self.error, self.at);
        assert!(
            self.error > 10.0 * bound,
            "{name}: a planted mistake, and only off by {:e}",
            self.error
        );
    }
}

/// Distance from the exact value, relative to it, or to the smallest normal number where it is smaller.
fn relative(found: f32, exact: f64) -> f64 {
    let found = f64::from(found);
    if found == exact {
        return 0.0;
    }
    (found - exact).abs() / exact.abs().max(f64::from(f32::MIN_POSITIVE))
}

/// 10ᵉ for exponents from `low` to `high`, each with a few mantissas.
fn decades(low: i32, high: i32, step: usize) -> impl Iterator<Item = f32> + Clone {
    (low..=high)
        .step_by(step)
        .flat_map(|e| [1.0, 1.3, 3.7, 9.1].map(|m| (m * 10.0_f64.powi(e)) as f32))
}

fn stream(sample: u32) -> PathStream {
    PathStream::new(Key {
        seed: 0x57e5,
        pixel: 0,
        sample,
    })
}

/// The ray along the first axis.
fn along_x() -> Ray<f32> {
    ray([0.0; 3], [1.0, 0.0, 0.0])
}

fn ray(origin: [f32; 3], direction: [f32; 3]) -> Ray<f32> {
    Ray {
        origin: Vec3::splat(origin),
        direction: Vec3::splat(direction),
    }
}
