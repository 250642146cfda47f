//! Core's estimators against numbers from outside, by random walks made of nothing else.
//!
//! Each file takes one reference table and walks it with [`woodcock_tests::walker`]: flights, phase functions, turned
//! directions, transmittance and roulette are core's, in `f32`, each particle with the stream of its own key. The
//! numbers that need no surface are compared, and the comparisons are counted, so that none can be skipped unnoticed;
//! what is left out is named in its file, with the reason.
//!
//! Every table also has planted mistakes, which its comparisons must reject at ten standard errors.

use std::fmt::Arguments;
use woodcock_tests::stats::{
    Moments, Mutants, ROUNDING, Sample, Verdict, Z_CRITICAL, judge_within,
};
use woodcock_tests::walker::Mistake;

mod directions;
mod furnace;
mod halfspace;
mod infinite_medium;
mod invariance;
mod pencil_beam;
mod scenes3d;
mod single_scatter;
mod slab_matched;
mod slab_radiance;
mod transmittance;

/// Counts comparisons with a table and remembers those that fail, so that one run shows all.
struct Ledger {
    table: &'static str,
    comparisons: usize,
    complaints: Vec<String>,
    squares: f64,
    largest: f64,
}

impl Ledger {
    fn new(table: &'static str) -> Self {
        Self {
            table,
            comparisons: 0,
            complaints: Vec::new(),
            squares: 0.0,
            largest: 0.0,
        }
    }

    /// Compares a mean with an exact number, to a standard error of `resolution` relative to it.
    fn agrees(&mut self, name: Arguments<'_>, sample: &Sample, truth: f64, resolution: f64) {
        self.within(name, sample, truth, 0.0, resolution * truth.abs());
    }

    /// Compares a mean with a number of standard error `truth_error`, both errors together below `resolution`, in
    /// the unit of the number.
    fn within(
        &mut self,
        name: Arguments<'_>,
        sample: &Sample,
        truth: f64,
        truth_error: f64,
        resolution: f64,
    ) {
        self.comparisons += 1;
        let m = sample.moments();
        let z = deviate(m, truth, truth_error);
        if z.is_finite() {
            self.squares += z * z;
            self.largest = self.largest.max(z.abs());
        }
        let verdict = judge_near(m, truth, truth_error, resolution).and(sample.judge_blocks());
        if !verdict.agrees() {
            self.complaints.push(format!(
                "{}, {name}: mean {:.6e} for {truth:.6e}, standard error {:.1e} (asked {resolution:.1e}), z {z:+.2}, \
                 block ratio {:.3}: {verdict:?}",
                self.table,
                m.mean(),
                m.standard_error(),
                sample.block_ratio(),
            ));
        }
    }

    /// Ends the table after so many comparisons.
    #[track_caller]
    fn finish(self, comparisons: usize) {
        println!(
            "{}: {} comparisons, root mean square of z {:.3}, largest {:.2}",
            self.table,
            self.comparisons,
            (self.squares / self.comparisons as f64).sqrt(),
            self.largest,
        );
        assert!(
            self.complaints.is_empty(),
            "{} of {} comparisons fail:\n{}",
            self.complaints.len(),
            self.comparisons,
            self.complaints.join("\n")
        );
        assert_eq!(
            self.comparisons, comparisons,
            "{}: not all numbers of the table were compared",
            self.table
        );
    }
}

/// Deviation in standard errors, those of the truth and of rounding to `f32` included.
fn deviate(m: &Moments, truth: f64, truth_error: f64) -> f64 {
    let error = m
        .standard_error()
        .hypot(truth_error)
        .hypot(ROUNDING * truth.abs());
    (m.mean() - truth) / error
}

/// Compares a mean with a number that may have a standard error of its own; see [`judge_within`].
fn judge_near(m: &Moments, truth: f64, truth_error: f64, resolution: f64) -> Verdict {
    if truth_error == 0.0 {
        return judge_within(m, truth, resolution);
    }
    let z = deviate(m, truth, truth_error);
    let error = m.standard_error().hypot(truth_error);
    let sees = error <= resolution;
    if !sees || z.is_nan() {
        Verdict::Blind { resolution: error }
    } else if z.abs() < Z_CRITICAL {
        Verdict::Agrees
    } else {
        Verdict::Biased { z }
    }
}

/// Records a verdict on the honest walk, or on one that makes a mistake.
fn record(suite: &mut Mutants, check: &str, mistake: Option<Mistake>, verdict: Verdict) {
    record_named(suite, check, mistake.map(Mistake::name), verdict);
}

/// The same for a mistake that a suite has of its own.
fn record_named(suite: &mut Mutants, check: &str, mistake: Option<&str>, verdict: Verdict) {
    match mistake {
        None => suite.check(check, verdict),
        Some(mistake) => suite.trial(check, mistake, verdict),
    }
}

/// The honest walk, then each mistake.
fn honest_and(mistakes: &[Mistake]) -> impl Iterator<Item = Option<Mistake>> {
    std::iter::once(None).chain(mistakes.iter().copied().map(Some))
}

/// What each table's planted mistakes are; those of `single_scatter` lie in what is scored.
const PLANTED: [(&str, &[Mistake]); 10] = [
    ("furnace", &furnace::MISTAKES),
    ("halfspace", &halfspace::MISTAKES),
    ("infinite_medium", &infinite_medium::MISTAKES),
    ("invariance", &invariance::MISTAKES),
    ("pencil_beam", &pencil_beam::MISTAKES),
    ("phase_functions", &directions::MISTAKES),
    ("scenes3d", &scenes3d::MISTAKES),
    ("slab_matched", &slab_matched::MISTAKES),
    ("slab_radiance", &slab_radiance::MISTAKES),
    ("transmittance", &transmittance::MISTAKES),
];

#[test]
fn every_mistake_is_planted_somewhere() {
    for mistake in Mistake::ALL {
        let tables = PLANTED.iter().filter(|(_, all)| all.contains(&mistake));
        assert!(tables.count() >= 1, "{} is planted nowhere", mistake.name());
    }
    let planted: usize = PLANTED.iter().map(|(_, all)| all.len()).sum();
    assert_eq!(planted + single_scatter::SLIPS.len(), 49);
    assert!(PLANTED.iter().all(|(_, all)| !all.is_empty()));
}

fn names(mistakes: &[Mistake]) -> Vec<&'static str> {
    mistakes.iter().map(|m| m.name()).collect()
}
