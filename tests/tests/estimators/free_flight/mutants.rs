//! The checks reject what they should: each mutant by the law of the distance or the share that leaves.

use super::{distance, judge};
use woodcock_core::free_flight::{analytic, decomposition, delta, regular};
use woodcock_core::medium::{Linear, Procedural};
use woodcock_core::ray::Ray;
use woodcock_core::stream::PathStream;
use woodcock_tests::depth::Depth;
use woodcock_tests::mutants::{CELLS, FLIGHTS, FlightMutant, Profile, RAMPS};
use woodcock_tests::stats::independent::SplitMix;
use woodcock_tests::stats::{Mutants, Verdict, samples, seed};
use woodcock_tests::voxels::TestVoxels;
use woodcock_tests::widths::{collect, per_lane, ray};

const LAW: &str = "law of the distance";
const SHARE: &str = "share that leaves";

/// Values of four cells.
const STEPS: [f32; 4] = [0.5, 3.0, 0.2, 1.5];

/// Extinction on [0, 1), bound and minimum.
type Numbers<'a> = (&'a dyn Fn(f64) -> f64, f64, f64);

/// A profile with the law that its flights should have.
struct Case<'a> {
    profile: Profile<'a>,
    depth: Depth<'a>,
}

impl<'a> Case<'a> {
    fn new((sigma_t, majorant, minimum): Numbers<'a>) -> Self {
        let profile = Profile {
            sigma_t,
            majorant,
            minimum,
            t_max: 1.0,
        };
        Self {
            profile,
            depth: Depth::new(1.0, 4, &[], sigma_t),
        }
    }

    /// * `resolution`: of the law; a mutant need only be rejected, however blunt the check.
    fn judge(&self, flights: Vec<f64>, resolution: f64) -> Vec<(&'static str, Verdict)> {
        let (law, share) = judge(flights, 1.0, resolution, |t| self.depth.collided(t));
        vec![(LAW, law), (SHARE, share)]
    }
}

fn hunt(suite: &mut Mutants, mutants: &[(&str, FlightMutant)], cases: &[Case<'_>]) {
    for (name, mutant) in mutants {
        suite.hunt(name, samples(1 << 20), |n| {
            let mut rng = SplitMix::new(seed(16));
            let mut judged = |case: &Case<'_>| {
                let flights = (0..n).map(|_| mutant(&case.profile, &mut rng)).collect();
                case.judge(flights, 1.0)
            };
            cases.iter().flat_map(&mut judged).collect()
        });
    }
}

#[test]
fn mutants_die() {
    let lists = [FLIGHTS, CELLS, RAMPS].concat();
    let names: Vec<&str> = lists.iter().map(|(name, _)| *name).collect();
    let mut suite = Mutants::new("free flight", &names);
    // A ramp, the same under a loose bound, where null collisions abound, fog at its bound, and what has a minimum.
    let ramp = |t: f64| 2.0 * t;
    let fog = |_: f64| 2.0;
    let slope = |t: f64| 1.0 + 2.0 * t;
    let steps = |t: f64| f64::from(STEPS[((4.0 * t) as usize).min(3)]);
    let (ramp, loose): (Numbers<'_>, Numbers<'_>) = ((&ramp, 2.0, 0.0), (&ramp, 12.0, 0.0));
    let (fog, slope): (Numbers<'_>, Numbers<'_>) = ((&fog, 2.0, 1.0), (&slope, 4.0, 1.0));
    let steps: Numbers<'_> = (&steps, 3.0, 0.2);

    let along: Ray<f32> = ray([0.0; 3], [1.0, 0.0, 0.0]);
    let n = samples(1 << 18);
    let mut check = |numbers: Numbers<'_>, fly: &mut dyn FnMut(&mut PathStream) -> f32| {
        let flights = collect::<f32, PathStream>(seed(15), 0, n, fly);
        for (check, verdict) in Case::new(numbers).judge(flights, 0.006) {
            suite.check(check, verdict);
        }
    };
    for numbers in [ramp, loose, fog, slope] {
        let (sigma_t, majorant, minimum) = numbers;
        let medium = Procedural::new(per_lane::<f32>(|x, _, _| sigma_t(x)), majorant as f32)
            .with_control(minimum as f32, minimum as f32);
        check(numbers, &mut |rng| {
            distance(delta::sample(&medium, &along, 1.0, rng, true), 1.0)
        });
        check(numbers, &mut |rng| {
            distance(decomposition::sample(&medium, &along, 1.0, rng, true), 1.0)
        });
    }
    let closed = Linear::new(1.0, [2.0, 0.0, 0.0]).expect("a finite ramp");
    check(slope, &mut |rng| {
        distance(analytic::sample(&closed, &along, 1.0, rng, true), 1.0)
    });
    let cells = TestVoxels::new([4, 1, 1], |[x, _, _]| STEPS[x as usize]);
    let quarters = [
        [4.0, 0.0, 0.0, 0.0],
        [0.0, 1.0, 0.0, 0.5],
        [0.0, 0.0, 1.0, 0.5],
    ];
    let cells = cells.medium(quarters, 1.0);
    check(steps, &mut |rng| {
        distance(regular::sample(&cells, &along, 1.0, rng, true), 1.0)
    });

    hunt(
        &mut suite,
        FLIGHTS,
        &[ramp, loose, fog, slope].map(Case::new),
    );
    hunt(&mut suite, CELLS, &[steps, slope].map(Case::new));
    hunt(&mut suite, RAMPS, &[ramp, slope].map(Case::new));
    suite.finish();
}
