//! The checks on the real estimators and on the planted mistakes.

use super::rows;
use super::rows::Estimator;
use woodcock_core::medium::Procedural;
use woodcock_core::ray::Ray;
use woodcock_core::stream::PathStream;
use woodcock_tests::mutants::{COMBS, Profile, SERIES, WEIGHTS};
use woodcock_tests::stats::independent::SplitMix;
use woodcock_tests::stats::{Mutants, Sample, Verdict, judge, samples, seed};
use woodcock_tests::widths::{per_lane, ray, sample};

const MEAN: &str = "mean";

#[test]
fn mutants_die() {
    let lists = [WEIGHTS, SERIES, COMBS].concat();
    let names: Vec<&str> = lists.iter().map(|(name, _)| *name).collect();
    let mut suite = Mutants::new("transmittance", &names);
    // A ramp, the same under a loose bound, where null collisions abound, fog at its bound, and what has a minimum.
    let ramp = |t: f64| 2.0 * t;
    let fog = |_: f64| 2.0;
    let slope = |t: f64| 1.0 + 2.0 * t;
    type Numbers<'a> = (&'a dyn Fn(f64) -> f64, f64, f64, f64);
    let profiles: [Numbers<'_>; 4] = [
        (&ramp, 2.0, 0.0, 1.0),
        (&ramp, 8.0, 0.0, 1.0),
        (&fog, 2.0, 1.0, 2.0),
        (&slope, 4.0, 1.0, 2.0),
    ];
    let cases = profiles.map(|(sigma_t, majorant, minimum, depth)| {
        let profile = Profile {
            sigma_t,
            majorant,
            minimum,
            t_max: 1.0,
        };
        (profile, (-depth).exp())
    });
    let along: Ray<f32> = ray([0.0; 3], [1.0, 0.0, 0.0]);
    for (profile, truth) in cases {
        let Profile {
            sigma_t,
            majorant,
            minimum,
            ..
        } = profile;
        let mean = 0.5 * (minimum + majorant);
        let medium = Procedural::new(per_lane::<f32>(|x, _, _| sigma_t(x)), majorant as f32)
            .with_control(minimum as f32, mean as f32);
        let mut check = |estimate: &dyn Fn(&mut PathStream) -> f32| {
            let weights = sample::<f32, PathStream>(seed(25), 0, samples(1 << 18), estimate);
            suite.check(MEAN, judge(weights.moments(), truth, 0.008));
        };
        macro_rules! row {
            ($name:ident) => {
                check(&|rng| rows::$name::Row::in_any(&medium, &along, 1.0, rng, true));
            };
        }
        row!(delta);
        row!(ratio);
        row!(residual_ratio);
        row!(residual_ratio_minimum);
        row!(power_series);
        row!(comb);
    }
    for (name, mutant) in lists {
        suite.hunt(name, samples(1 << 20), |n| {
            let mut rng = SplitMix::new(seed(27));
            let mut judged = |&(profile, truth): &(Profile<'_>, f64)| -> (&'static str, Verdict) {
                let weights: Sample = (0..n).map(|_| mutant(&profile, &mut rng)).collect();
                (MEAN, judge(weights.moments(), truth, 0.1))
            };
            cases.iter().map(&mut judged).collect()
        });
    }
    suite.finish();
}
