//! Planted mistakes, and the demand that every check has caught one.
//!
//! A check that never rejected anything proves nothing. So each suite names plausible mistakes, *mutants*, runs its
//! checks on them too, and fails when a mutant survives every check or a check rejects no mutant. A kill needs
//! |z| ≥ 10: a real bug of that size escapes a fresh stream with probability below 2·10⁻⁷.

use super::Verdict;
use std::collections::BTreeMap;

/// |z| at which a mutant counts as rejected.
pub const KILL_Z: f64 = 10.0;

/// Demands that the check `name` rejects what it was given, with room to spare.
///
/// # Panics
/// When `verdict` is not `Biased` with |z| ≥ [`KILL_Z`]. Blindness is no kill: a mutant whose weights explode must be
/// rejected for its value.
#[track_caller]
pub fn must_kill(name: &str, verdict: Verdict) {
    assert!(
        kills(verdict),
        "{name}: a planted mistake must be Biased with |z| of at least {KILL_Z}, not {verdict:?}"
    );
}

/// Whether a verdict rejects with |z| ≥ [`KILL_Z`].
const fn kills(verdict: Verdict) -> bool {
    matches!(verdict, Verdict::Biased { z } if z.abs() >= KILL_Z)
}

/// The checks of one suite, what each said of the real thing, and which mutants each rejected.
///
/// ```
/// use woodcock_tests::stats::{Mutants, Verdict};
///
/// let mut suite = Mutants::new("coin", &["always heads"]);
/// suite.check("mean", Verdict::Agrees); // the verdict on the real coin
/// suite.trial("mean", "always heads", Verdict::Biased { z: 51.0 });
/// suite.finish(); // panics where a mutant lives or a check never killed
/// ```
#[derive(Clone, Debug)]
pub struct Mutants {
    suite: String,
    checks: BTreeMap<String, Vec<Verdict>>,
    trials: BTreeMap<String, Vec<(String, Verdict)>>,
}

impl Mutants {
    /// A suite that promises to kill each of `mutants`.
    pub fn new(suite: &str, mutants: &[&str]) -> Self {
        Self {
            suite: suite.to_owned(),
            checks: BTreeMap::new(),
            trials: mutants
                .iter()
                .map(|&mutant| (mutant.to_owned(), Vec::new()))
                .collect(),
        }
    }

    /// Records what `check` says of the real thing; called once per fixture.
    pub fn check(&mut self, check: &str, verdict: Verdict) {
        self.checks
            .entry(check.to_owned())
            .or_default()
            .push(verdict);
    }

    /// Records what `check` says of `mutant`. One kill among all trials of a mutant suffices.
    ///
    /// # Panics
    /// When the suite did not name `mutant`: a misspelt one would never be missed.
    #[track_caller]
    pub fn trial(&mut self, check: &str, mutant: &str, verdict: Verdict) {
        let Some(trials) = self.trials.get_mut(mutant) else {
            panic!("{}: no mutant is called {mutant:?}", self.suite);
        };
        trials.push((check.to_owned(), verdict));
    }

    /// Tries a mutant with more and more samples, up to `most`, until a check rejects it: nearly all die early.
    ///
    /// * `trial`: the verdicts of checks, by name, on so many samples of the mutant.
    ///
    /// # Panics
    /// When the suite did not name `mutant`.
    #[track_caller]
    pub fn hunt(
        &mut self,
        mutant: &str,
        most: usize,
        mut trial: impl FnMut(usize) -> Vec<(&'static str, Verdict)>,
    ) {
        let mut n = (most / 64).max(1);
        loop {
            let verdicts = trial(n);
            for &(check, verdict) in &verdicts {
                self.trial(check, mutant, verdict);
            }
            if n >= most || verdicts.iter().any(|&(_, verdict)| kills(verdict)) {
                return;
            }
            n = (8 * n).min(most);
        }
    }

    /// What is wrong with the suite, one line each; empty when it may pass.
    pub fn complaints(&self) -> Vec<String> {
        let mut lines = Vec::new();
        let suite = &self.suite;
        if self.checks.is_empty() {
            lines.push(format!("{suite}: nothing was checked"));
        }
        for (check, verdicts) in &self.checks {
            for verdict in verdicts.iter().filter(|v| !v.agrees()) {
                lines.push(format!(
                    "{suite}: {check} says {verdict:?} of the real thing"
                ));
            }
            let killed = self
                .trials
                .values()
                .flatten()
                .any(|(by, verdict)| by == check && kills(*verdict));
            if !killed {
                lines.push(format!("{suite}: {check} never rejected a mutant"));
            }
        }
        for (mutant, trials) in &self.trials {
            if !trials.iter().any(|(_, verdict)| kills(*verdict)) {
                lines.push(format!("{suite}: mutant {mutant:?} lives: {trials:?}"));
            }
            for (check, _) in trials {
                if !self.checks.contains_key(check) {
                    lines.push(format!(
                        "{suite}: {check} judged a mutant, never the real thing"
                    ));
                }
            }
        }
        lines
    }

    /// The table of kills, one line per mutant: who rejected it, and at how many standard errors.
    pub fn report(&self) -> String {
        let mut text = String::new();
        for (mutant, trials) in &self.trials {
            text += &format!("{} / {mutant}:", self.suite);
            for (check, verdict) in trials {
                text += &match verdict {
                    Verdict::Biased { z } => format!(" {check} z {z:+.1};"),
                    other => format!(" {check} {other:?};"),
                };
            }
            text += "\n";
        }
        text
    }

    /// Ends the suite.
    ///
    /// # Panics
    /// With all complaints and the table of kills, when there is any complaint.
    #[track_caller]
    pub fn finish(self) {
        let complaints = self.complaints();
        assert!(
            complaints.is_empty(),
            "{}\n{}",
            complaints.join("\n"),
            self.report()
        );
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const KILL: Verdict = Verdict::Biased { z: -12.0 };
    const WEAK: Verdict = Verdict::Biased { z: 6.0 };

    fn complaint(build: impl FnOnce(&mut Mutants)) -> String {
        let mut suite = Mutants::new("suite", &["mutant"]);
        build(&mut suite);
        suite.complaints().join("; ")
    }

    #[test]
    fn a_complete_suite_has_nothing_to_complain_of() {
        let mut suite = Mutants::new("suite", &["first", "second"]);
        suite.check("mean", Verdict::Agrees);
        suite.check("blocks", Verdict::Agrees);
        suite.trial("mean", "first", KILL);
        suite.trial("mean", "second", Verdict::Agrees);
        suite.trial("blocks", "second", KILL);
        assert!(suite.report().contains("suite / first: mean z -12.0"));
        suite.finish();
    }

    #[test]
    fn every_gap_is_named() {
        assert!(complaint(|_| ()).contains("nothing was checked"));
        let survivor = complaint(|s| {
            s.check("mean", Verdict::Agrees);
            s.trial("mean", "mutant", WEAK);
        });
        assert!(survivor.contains("\"mutant\" lives") && survivor.contains("mean never rejected"));
        let sleeping = complaint(|s| {
            s.check("mean", Verdict::Agrees);
            s.check("asleep", Verdict::Agrees);
            s.trial("mean", "mutant", KILL);
        });
        assert_eq!(sleeping, "suite: asleep never rejected a mutant");
        let red = complaint(|s| {
            s.check("mean", WEAK);
            s.trial("mean", "mutant", KILL);
        });
        assert!(red.contains("of the real thing"));
        let unchecked = complaint(|s| s.trial("mean", "mutant", KILL));
        assert!(unchecked.contains("never the real thing"));
    }

    #[test]
    fn a_hunt_ends_with_the_kill_or_with_the_samples() {
        let mut suite = Mutants::new("suite", &["weak", "strong"]);
        suite.check("mean", Verdict::Agrees);
        let mut tried = Vec::new();
        let verdict = |dies| if dies { KILL } else { WEAK };
        suite.hunt("weak", 1000, |n| {
            tried.push(n);
            vec![("mean", verdict(n >= 900))]
        });
        suite.hunt("strong", 1 << 20, |n| {
            tried.push(n);
            vec![("mean", verdict(true))]
        });
        assert_eq!(tried, [15, 120, 960, 1 << 14]);
        suite.finish();
    }

    #[test]
    #[should_panic(expected = "no mutant is called")]
    fn misspelt_mutants_are_refused() {
        Mutants::new("suite", &["mutant"]).trial("mean", "mutnat", KILL);
    }

    #[test]
    #[should_panic(expected = "must be Biased")]
    fn blindness_is_no_kill() {
        must_kill("mean", Verdict::Blind { resolution: 1.0 });
    }

    #[test]
    fn a_clear_rejection_kills() {
        must_kill("mean", KILL);
    }
}
