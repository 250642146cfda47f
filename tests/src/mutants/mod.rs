//! Planted mistakes: estimators that go wrong the way estimators do.
//!
//! Each is written out on its own, in plain `f64`, as a beginner's first version of the real thing; the suites demand
//! that their checks reject every one. All walk [0, `t_max`) of a ray whose extinction is a function of distance.

mod combs;
mod flights;
mod lines;
mod series;
mod weights;

pub use combs::COMBS;
pub use flights::{CELLS, FLIGHTS, RAMPS, WEIGHTED, WeightedMutant};
pub use lines::{LINES, Line, LineMutant};
pub use series::SERIES;
pub use weights::WEIGHTS;

use crate::stats::independent::SplitMix;

/// Extinction as a function of distance, and what is known of it.
#[derive(Clone, Copy)]
pub struct Profile<'a> {
    /// σ_t(t) [1/length], monotone in each quarter of the ray.
    pub sigma_t: &'a dyn Fn(f64) -> f64,
    /// σ̄ [1/length].
    pub majorant: f64,
    /// c ≤ σ_t everywhere [1/length].
    pub minimum: f64,
    /// Length of the ray.
    pub t_max: f64,
}

impl std::fmt::Debug for Profile<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self {
            majorant,
            minimum,
            t_max,
            ..
        } = self;
        write!(f, "a profile from {minimum} to {majorant} on {t_max}")
    }
}

/// A planted mistake in free flight; infinite where the flight leaves.
pub type FlightMutant = fn(&Profile<'_>, &mut SplitMix) -> f64;

/// A planted mistake in the estimate of transmittance.
pub type WeightMutant = fn(&Profile<'_>, &mut SplitMix) -> f64;

/// Suite and name of every mistake of this module.
pub fn all() -> Vec<(&'static str, &'static str)> {
    fn named<M>(
        suite: &'static str,
        list: &[(&'static str, M)],
    ) -> Vec<(&'static str, &'static str)> {
        list.iter().map(|(name, _)| (suite, *name)).collect()
    }
    [
        named("free flight", FLIGHTS),
        named("free flight", CELLS),
        named("free flight", RAMPS),
        named("weighted flight", WEIGHTED),
        named("transmittance", WEIGHTS),
        named("transmittance", SERIES),
        named("transmittance", COMBS),
        named("line integral", LINES),
    ]
    .concat()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn every_mistake_has_a_name_of_its_own() {
        let all = all();
        let names: BTreeSet<_> = all.iter().collect();
        assert_eq!(names.len(), all.len());
        assert!(all.len() >= 39, "{}", all.len());
    }
}
