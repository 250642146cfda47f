//! Weighted tracking under bounds that fail: expectations hold, and the second moment is that of theory.

use woodcock_core::free_flight::weighted;
use woodcock_core::medium::Procedural;
use woodcock_core::ray::Ray;
use woodcock_core::real::Real;
use woodcock_core::stream::{KeyedStream, PathStream};
use woodcock_tests::each_width;
use woodcock_tests::fixtures::{self, Fixture};
use woodcock_tests::mutants::{Profile, WEIGHTED};
use woodcock_tests::stats::independent::SplitMix;
use woodcock_tests::stats::{
    Mutants, Sample, Verdict, assert_agrees, assert_verdict, judge_within, samples, seed,
};
use woodcock_tests::widths::{collect, everyone, per_lane, ray, width};

/// Flights with their weights, of a field under a bound.
fn fly<R: Real, S: KeyedStream<R>>(fixture: &Fixture, bound: f32, n: usize) -> Vec<(f64, f64)> {
    let medium = Procedural::new(per_lane::<R>(fixture.sigma_t()), bound);
    let along: Ray<R> = ray(fixture.ray.origin, fixture.ray.dir);
    let end = R::splat(fixture.ray.t_max as f32);
    let mut weights = Vec::with_capacity(n + R::LANES);
    let flights = collect::<R, S>(seed(101), 0, n, |rng| {
        let flown = weighted::sample(&medium, &along, end, rng, everyone::<R>());
        weights.extend((0..R::LANES).map(|lane| f64::from(flown.weight.lane(lane))));
        flown.flight.or_infinite()
    });
    flights.into_iter().zip(weights).collect()
}

/// A share of the largest extinction on a field's ray.
fn bound(fixture: &Fixture, share: f64) -> f32 {
    let at = |i: u32| fixture.along()(fixture.ray.t_max * f64::from(i) / 4096.0);
    (share * (0..=4096).map(at).fold(0.0, f64::max)) as f32
}

/// E[w²] of those that leave, and of all, by quadrature of the formulas in `weighted.rs`.
fn second_moments(fixture: &Fixture, bound: f64) -> (f64, f64) {
    let pieces = 20_000;
    let step = fixture.ray.t_max / f64::from(pieces);
    let (mut alive, mut collided) = (1.0_f64, 0.0);
    for i in 0..pieces {
        let sigma_t = fixture.along()((f64::from(i) + 0.5) * step);
        let excess = 2.0 * sigma_t / bound;
        let (growth, factor) = if sigma_t > bound {
            (sigma_t * (excess - 3.0), excess - 1.0)
        } else {
            (-sigma_t, 1.0)
        };
        let middle = alive * (0.5 * growth * step).exp();
        collided += middle * sigma_t * factor * step;
        alive *= (growth * step).exp();
    }
    (alive, alive + collided)
}

fn some_fields() -> Vec<Fixture> {
    ["linear/0", "gaussian/3", "sine_product/1", "checkerboard/2"]
        .into_iter()
        .map(|name| {
            let mut all = fixtures::all();
            all.retain(|fixture| fixture.name == name);
            all.pop().unwrap_or_else(|| panic!("no field {name:?}"))
        })
        .collect()
}

#[test]
fn expectations_hold_under_a_bound_that_fails() {
    for fixture in some_fields() {
        for share in [0.9, 0.7] {
            let bound = bound(&fixture, share);
            let (left, all) = second_moments(&fixture, f64::from(bound));
            each_width!(R, S => {
                let sharp = width::<R>() == "f32";
                let n = samples(if sharp { 1 << 18 } else { 1 << 15 });
                let resolution = if sharp { 0.004 } else { 0.012 };
                let flown = fly::<R, S>(&fixture, bound, n);
                let name = |what: &str| format!("{what} of {} at {share}, {}", fixture.name, width::<R>());
                for (t, p) in fixture.collision_probabilities() {
                    let before: Sample = flown.iter().map(|&(d, w)| if d < t { w } else { 0.0 }).collect();
                    assert_verdict(&name(&format!("flights before {t}")), judge_within(before.moments(), p, resolution));
                }
                let leaving: Sample = flown.iter().map(|&(d, w)| if d.is_finite() { 0.0 } else { w }).collect();
                assert_verdict(&name("flights that leave"), judge_within(leaving.moments(), fixture.ray.transmittance, resolution));
                assert!(leaving.judge_blocks().agrees());
                let squares: Sample = flown.iter().map(|&(_, w)| w * w).collect();
                assert_agrees(&name("second moment"), &squares, all, 0.03);
                let squares: Sample = flown.iter().map(|&(d, w)| if d.is_finite() { 0.0 } else { w * w }).collect();
                assert_verdict(&name("second moment of those that leave"), judge_within(squares.moments(), left, 10.0 * resolution));
                let negative = flown.iter().filter(|&&(_, w)| w < 0.0).count();
                assert!(negative > 0, "{}", name("no negative weight"));
            });
        }
    }
}

/// As long as the bound holds the weight is one exactly, however loose it is.
#[test]
fn a_bound_that_holds_leaves_the_weight_alone() {
    for fixture in some_fields() {
        each_width!(R, S => {
            let flown = fly::<R, S>(&fixture, bound(&fixture, 2.0), 4096);
            assert!(flown.iter().all(|&(_, w)| w == 1.0), "{}", fixture.name);
        });
    }
}

#[test]
fn mutants_die() {
    const BEFORE: &str = "weighted share before three quarters";
    const LEAVING: &str = "weighted share that leaves";
    let names: Vec<&str> = WEIGHTED.iter().map(|(name, _)| *name).collect();
    let mut suite = Mutants::new("weighted flight", &names);
    let sigma_t = |t: f64| 1.0 + 2.0 * t;
    let profile = Profile {
        sigma_t: &sigma_t,
        majorant: 2.1,
        minimum: 1.0,
        t_max: 1.0,
    };
    let judge = |flown: Vec<(f64, f64)>| -> Vec<(&'static str, Verdict)> {
        let (mut before, mut leaving) = (Sample::new(), Sample::new());
        for (t, w) in flown {
            before.push(if t < 0.75 { w } else { 0.0 });
            leaving.push(if t.is_finite() { 0.0 } else { w });
        }
        // τ(t) = t + t².
        let (before_it, end) = (-(-1.3125_f64).exp_m1(), (-2.0_f64).exp());
        vec![
            (BEFORE, judge_within(before.moments(), before_it, 0.1)),
            (LEAVING, judge_within(leaving.moments(), end, 0.1)),
        ]
    };
    let medium = Procedural::new(per_lane::<f32>(|x, _, _| sigma_t(x)), 2.1);
    let along: Ray<f32> = ray([0.0; 3], [1.0, 0.0, 0.0]);
    let mut weights = Vec::new();
    let flights = collect::<f32, PathStream>(seed(102), 0, samples(1 << 18), |rng| {
        let flown = weighted::sample(&medium, &along, 1.0, rng, true);
        weights.push(f64::from(flown.weight));
        flown.flight.or_infinite()
    });
    for (check, verdict) in judge(flights.into_iter().zip(weights).collect()) {
        suite.check(check, verdict);
    }
    for (name, mutant) in WEIGHTED {
        suite.hunt(name, samples(1 << 20), |n| {
            let mut rng = SplitMix::new(seed(103));
            judge((0..n).map(|_| mutant(&profile, &mut rng)).collect())
        });
    }
    suite.finish();
}
