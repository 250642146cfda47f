//! The checks on both ways to score, and on the planted mistakes.

use woodcock_core::line_integral::{collisions, tentative};
use woodcock_core::medium::Procedural;
use woodcock_core::ray::Ray;
use woodcock_core::stream::PathStream;
use woodcock_tests::depth::Depth;
use woodcock_tests::mutants::{LINES, Line, Profile};
use woodcock_tests::stats::independent::SplitMix;
use woodcock_tests::stats::{Mutants, Sample, Verdict, judge, samples, seed};
use woodcock_tests::widths::{per_lane, ray, sample};

const MEAN: &str = "mean";

#[test]
fn mutants_die() {
    let names: Vec<&str> = LINES.iter().map(|(name, _)| *name).collect();
    let mut suite = Mutants::new("line integral", &names);
    let profile = |sigma_t| Profile {
        sigma_t,
        majorant: 4.0,
        minimum: 0.0,
        t_max: 1.0,
    };
    // A slope whose source rises with it; and light throughout of which half the ray absorbs nothing.
    let slope = |t: f64| 1.0 + 2.0 * t;
    let rising = |t: f64| (1.0 + 2.0 * t) * (1.0 + t);
    let half = |t: f64| if t < 0.5 { 2.0 } else { 0.0 };
    let lines = [
        Line {
            profile: profile(&slope),
            volume: &rising,
            boundary: 0.75,
        },
        Line {
            profile: profile(&half),
            volume: &|_| 1.0,
            boundary: 0.25,
        },
    ];
    let cases = lines.map(|line| {
        let depth = Depth::new(1.0, 64, &[], line.profile.sigma_t);
        let truth = depth.attenuated(line.volume) + line.boundary * (-depth.total()).exp();
        (line, truth)
    });
    let along: Ray<f32> = ray([0.0; 3], [1.0, 0.0, 0.0]);
    for (line, truth) in cases {
        let (sigma_t, volume) = (line.profile.sigma_t, line.volume);
        let medium = Procedural::new(per_lane::<f32>(|x, _, _| sigma_t(x)), 4.0);
        let end = line.boundary as f32;
        let mut check = |estimate: &dyn Fn(&mut PathStream) -> f32| {
            let found = sample::<f32, PathStream>(seed(124), 0, samples(1 << 17), estimate);
            suite.check(MEAN, judge(found.moments(), truth, 0.003));
        };
        let light = |t: f32, _| volume(f64::from(t)) as f32;
        check(&|rng| tentative(&medium, &along, 1.0, 4, light, end, 0.0, rng, true));
        // Half of the light of the second line is not theirs to find.
        if sigma_t(1.0) > 0.0 {
            let source = |t: f32, _| (volume(f64::from(t)) / sigma_t(f64::from(t))) as f32;
            check(&|rng| collisions(&medium, &along, 1.0, 4, source, end, rng, true));
        }
    }
    for (name, mutant) in LINES {
        suite.hunt(name, samples(1 << 20), |n| {
            let mut rng = SplitMix::new(seed(125));
            let mut judged = |(line, truth): &(Line<'_>, f64)| -> (&'static str, Verdict) {
                let found: Sample = (0..n).map(|_| mutant(line, &mut rng)).collect();
                (MEAN, judge(found.moments(), *truth, 0.1))
            };
            // Only the mistake that it is named for may be made.
            let cases = if name.contains("nothing collides") {
                &cases[1..]
            } else {
                &cases[..1]
            };
            cases.iter().map(&mut judged).collect()
        });
    }
    suite.finish();
}
