//! What a render did, for scripts: the file of `--stats`.

use serde::{Deserialize, Serialize};
use std::io::{self, Write};
use std::time::Duration;

/// Counts and times of a render. The keys are a contract: they are not renamed or removed.
///
/// Times are seconds, counts are of this run. What is not known (the error of a single sample, the CPU time where the system does
/// not tell) is `null`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Statistics {
    /// The scene's file as given, or the name of the built-in scene.
    pub scene: String,
    /// Name of the integrator.
    pub integrator: String,
    /// Name of the transmittance estimator.
    pub transmittance: String,
    /// Name of the kernel, `packet` or `scalar`.
    pub kernel: String,
    /// Threads that rendered.
    pub threads: u64,
    /// Seed of the streams.
    pub seed: u64,
    /// Samples per pixel that were traced; rounded mean where pixels differ.
    pub spp: u64,
    /// Width of the rendered window, in pixels.
    pub width: u64,
    /// Height of the rendered window, in pixels.
    pub height: u64,
    /// Reading files and building structures, wall clock.
    pub setup_seconds: f64,
    /// Rendering, wall clock; with a pilot's.
    pub render_seconds: f64,
    /// Rendering, user and system time of all threads; with a pilot's.
    pub cpu_seconds: Option<f64>,
    /// Camera paths.
    pub paths: u64,
    /// Events of the majorant process: real and null together.
    pub tentative_collisions: u64,
    /// Absorptions and scatterings.
    pub real_collisions: u64,
    /// Null collisions.
    pub null_collisions: u64,
    /// Look-ups of the medium.
    pub lookups: u64,
    /// Look-ups that had to fetch the exact value.
    pub exact_lookups: u64,
    /// Cells of the majorant grid that were walked.
    pub majorant_cells: u64,
    /// Mean fraction of the lanes that did useful work, in [0, 1]; 1 for the scalar kernel.
    pub lane_utilisation: f64,
    /// Look-ups that exceeded their majorant; anything but 0 is a biased image.
    pub majorant_violations: u64,
    /// Paths dropped because they were not finite.
    pub nonfinite_paths: u64,
    /// [`Film::relative_error`](crate::film::Film::relative_error) of the image.
    pub relative_error: Option<f64>,
    /// The error that was asked for by `--target-error`.
    pub target_error: Option<f64>,
    /// Camera paths of the pilot that decided the counts of samples; not among `paths`.
    pub pilot_paths: u64,
    /// What the scene needs.
    pub needs: Vec<String>,
    /// What was skipped because the scene does not need it.
    pub skipped: Vec<String>,
}

impl Statistics {
    /// Writes JSON, indented, keys in the order of the fields; numbers that are not finite become `null`.
    pub fn write(&self, mut to: impl Write) -> io::Result<()> {
        serde_json::to_writer_pretty(&mut to, self)?;
        to.write_all(b"\n")
    }
}

/// User and system time of all threads of this process so far, or `None` where the system does not tell.
pub fn cpu_time() -> Option<Duration> {
    #[cfg(unix)]
    {
        let now = rustix::time::clock_gettime(rustix::time::ClockId::ProcessCPUTime);
        Some(Duration::new(
            u64::try_from(now.tv_sec).ok()?,
            u32::try_from(now.tv_nsec).ok()?,
        ))
    }
    #[cfg(not(unix))]
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_keys_are_the_contract() {
        let mut json = Vec::new();
        let statistics = Statistics {
            seed: u64::MAX,
            render_seconds: f64::NAN,
            ..Statistics::default()
        };
        statistics.write(&mut json).expect("written to memory");
        let text = String::from_utf8(json).expect("JSON is UTF-8");
        let keys: Vec<&str> = text
            .lines()
            .filter_map(|line| line.trim().strip_prefix('"')?.split_once("\":"))
            .map(|(key, _)| key)
            .collect();
        let contract = "scene integrator transmittance kernel threads seed spp width height \
            setup_seconds render_seconds cpu_seconds paths tentative_collisions real_collisions \
            null_collisions lookups exact_lookups majorant_cells lane_utilisation \
            majorant_violations nonfinite_paths relative_error target_error pilot_paths needs skipped";
        assert_eq!(keys, contract.split_whitespace().collect::<Vec<_>>());
        assert!(text.contains("\"seed\": 18446744073709551615"), "{text}");
        assert!(text.contains("\"render_seconds\": null"), "{text}");
    }

    #[test]
    #[cfg(unix)]
    fn working_costs_cpu_time() {
        let before = cpu_time().expect("Unix tells");
        let mut x = 1.0_f64;
        while cpu_time().expect("Unix tells") - before < Duration::from_millis(5) {
            x = std::hint::black_box(x.sqrt() + 1.0);
        }
        assert!(x > 1.0);
    }
}
