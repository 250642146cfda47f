//! Phase functions: every row normalised, sampled with its own density, and inverted by its own inverse.
//!
//! Quadrature, tables and round trips first; then a histogram of sampled cosines. The checks must reject every
//! planted mistake.

use std::f64::consts::PI;
use woodcock_core::for_each_phase;
use woodcock_core::real::Real;
use woodcock_core::stream::{PathStream, Stream};
use woodcock_packet::lanes::{LANES, Lanes};
use woodcock_tests::stats::{
    ChiSquare, Sample, Verdict, assert_verdict, judge_within, samples, seed,
};
use woodcock_tests::widths::{collect, everyone};

mod constructors;
mod identities;
mod law;
mod mutants;
mod references;
mod rows;
mod tables;

use law::Law;
use rows::{Case, Parameters, Row};

/// Cosines from −1 to 1, evenly, both ends included.
fn cosines(steps: i32) -> impl Iterator<Item = f32> {
    (-steps..=steps).map(move |i| i as f32 / steps as f32)
}

fn integrals<T: Row>() {
    for case in T::cases() {
        let Case { row, p, ref law } = case;
        let name = case.name();
        let close = |what: &str, got: f64, expected: f64, by: f64| {
            assert!(
                (got - expected).abs() <= by,
                "{what} of {name}: {got} for {expected}"
            );
        };
        // 1/4π is a constant of `f32`, good to 5e-8.
        let double = |c: f64| 2.0 * PI * row.eval(c, p);
        close("norm", law.over(-1.0, 1.0, double), 1.0, 1e-7);
        let mean = law.over(-1.0, 1.0, |c| c * double(c));
        close("mean cosine", mean, law.moment(1), 1e-7);
        close(
            "stated mean cosine",
            row.mean_cosine(p),
            law.moment(1),
            1e-7,
        );
        let single = case.single();
        let mut share = 0.0;
        let mut before = -1.0;
        for c in cosines(4000) {
            // The density and the distribution function of `f32` against those of the law.
            let (one, exact) = (f64::from(row.eval(c, single)), law.eval(f64::from(c)));
            assert!(
                (one - exact).abs() <= T::DENSITY * exact,
                "p({c}) of {name}: {one} for {exact}"
            );
            share += law.share(before, f64::from(c));
            before = f64::from(c);
            let one = f64::from(row.cumulative(c, single));
            close("distribution function", one, share, 8e-7);
        }
    }
}

/// Uniform numbers at both ends and between.
fn uniforms() -> Vec<f32> {
    let below_one = 1.0_f32.next_down();
    let mut all = vec![
        0.0,
        f32::MIN_POSITIVE,
        2.0_f32.powi(-32),
        2.0_f32.powi(-24),
        0.5,
        below_one,
    ];
    all.extend((0..4096).map(|i| (i as f32 + 0.5) / 4096.0));
    all.extend((1..200).map(|i| 1.0 - i as f32 * 2.0_f32.powi(-24)));
    all.extend((1..200).map(|i| i as f32 * 2.0_f32.powi(-24)));
    all
}

fn round_trips<T: Row>() {
    for case in T::cases() {
        if T::MONOTONE {
            one_map(&case);
        } else {
            several_ways(&case);
        }
    }
}

/// From u to the cosine and back.
fn one_map<T: Row>(case: &Case<T>) {
    let Case { row, p, ref law } = *case;
    let name = case.name();
    let single = case.single();
    let mut before = -1.0;
    let mut sorted = uniforms();
    sorted.sort_by(f32::total_cmp);
    for &u in &sorted {
        let cosine = row.sample(u, single);
        // A lobe of negative g is turned around: its cosines fall.
        let turned = p[0] < 0.0;
        let rising = if turned { -cosine } else { cosine };
        assert!(
            rising >= before - 4e-7,
            "cosines of {name} turn back at {u:e}"
        );
        before = rising.max(before);
        // In double precision the trip is exact; in f32 within what one digit of the cosine is worth.
        let u = f64::from(u);
        let back = row.invert(row.sample(u, p), 0.0, p);
        assert!(
            (back - u).abs() < 1e-7,
            "{u:e} comes back as {back:e} of {name}"
        );
        let back = f64::from(row.invert(cosine, 0.0, single));
        let density = 2.0 * PI * law.eval(f64::from(cosine));
        assert!(
            (back - u).abs() < 2e-6 + 3e-7 * density,
            "{u:e} comes back as {back:e} of {name} in f32"
        );
    }
}

/// From the cosine to one of its u and back, and each of them as often as it should be.
fn several_ways<T: Row>(case: &Case<T>) {
    let Case { row, p, .. } = *case;
    let name = case.name();
    for c in cosines(500).map(f64::from) {
        for v in [0.0, 0.3, 0.7, 1.0 - 1e-9] {
            let u = row.invert(c, v, p);
            let back = row.sample(u, p);
            assert!(
                (back - c).abs() < 4e-7,
                "{c} comes back as {back} by {u:e} of {name}"
            );
        }
    }
    let single = case.single();
    let returned = collect::<f32, PathStream>(seed(63), 0, samples(1 << 18), |rng| {
        let [u, v] = [(); 2].map(|()| Stream::<f32>::uniform(rng, true));
        row.invert(row.sample(u, single), v, single)
    });
    let even: Vec<f64> = (1..CELLS).map(|i| i as f64 / CELLS as f64).collect();
    let verdict = histogram(&returned, &even, |from, to| to.min(1.0) - from.max(0.0));
    assert_verdict(&name, verdict);
}

/// Error of sampled cosines against double precision, and ranges, for the most extreme parameters too.
fn extremes<T: Row>() {
    for case in T::cases().into_iter().chain(T::extremes()) {
        let Case { row, p, ref law } = case;
        let name = case.name();
        let single = case.single();
        let [of_cosine, of_u] = T::errors(p);
        for u in uniforms() {
            let cosine = row.sample(u, single);
            assert!(
                (-1.0..=1.0).contains(&cosine),
                "{cosine} at {u:e} of {name}"
            );
            let exact = row.sample(f64::from(u), p);
            let error = (f64::from(cosine) - exact).abs();
            let allowed = of_cosine + of_u / (2.0 * PI * law.drawn_at(f64::from(u), exact));
            assert!(
                error <= allowed,
                "{cosine} for {exact} at {u:e} of {name}: error {error:e}, allowed {allowed:e}"
            );
            if T::MONOTONE {
                let back = row.invert(exact, 0.0, p);
                let allowed = 3e-11 + 2e-15 * law.eval(exact);
                assert!(
                    (back - f64::from(u)).abs() <= allowed,
                    "{u:e} comes back as {back:e} of {name} in f64"
                );
            }
            let density = row.eval(cosine, single);
            assert!(
                density >= 0.0 && density.is_finite(),
                "p = {density} at {u:e} of {name}"
            );
            for back in [
                row.invert(cosine, u, single),
                row.cumulative(cosine, single),
            ] {
                assert!(
                    (-1e-6..=1.0 + 1e-6).contains(&back),
                    "u = {back} at {u:e} of {name}"
                );
            }
        }
    }
}

fn lanes<T: Row>() {
    let cosines: Vec<f32> = cosines(1000).collect();
    let uniforms = uniforms();
    let cases: Vec<Case<T>> = T::cases().into_iter().chain(T::extremes()).collect();
    for (at, case) in cases.iter().enumerate() {
        let row = case.row;
        // Neighbouring lanes have other parameters, unless they are in another table.
        let of_lane = |lane: usize| {
            let other = &cases[(at + lane) % cases.len()];
            if other.row == row { other } else { case }.single()
        };
        let singles: [Parameters<f32>; LANES] = std::array::from_fn(of_lane);
        let wide: Parameters<Lanes> =
            std::array::from_fn(|i| Lanes::new(singles.map(|single| single[i])));
        let same = |values: &[f32],
                    one: &dyn Fn(f32, Parameters<f32>) -> f32,
                    eight: &dyn Fn(Lanes, Parameters<Lanes>) -> Lanes| {
            for chunk in values.chunks_exact(LANES) {
                let x: [f32; LANES] = chunk.try_into().expect("eight");
                let got = eight(Lanes::new(x), wide).to_array();
                for lane in 0..LANES {
                    assert_eq!(
                        got[lane].to_bits(),
                        one(x[lane], singles[lane]).to_bits(),
                        "{} at {}",
                        case.name(),
                        x[lane]
                    );
                }
            }
        };
        same(&cosines, &|c, p| row.eval(c, p), &|c, p| row.eval(c, p));
        same(&uniforms, &|u, p| row.sample(u, p), &|u, p| {
            row.sample(u, p)
        });
        same(&cosines, &|c, p| row.cumulative(c, p), &|c, p| {
            row.cumulative(c, p)
        });
        same(&cosines, &|c, p| row.invert(c, c.abs(), p), &|c, p| {
            row.invert(c, c.abs(), p)
        });
    }
}

const CELLS: usize = 64;

/// Histogram of numbers over cells between edges, whose shares come from `share`.
fn histogram(numbers: &[f64], edges: &[f64], share: impl Fn(f64, f64) -> f64) -> Verdict {
    let mut counts = vec![0_u64; edges.len() + 1];
    for number in numbers {
        counts[edges.partition_point(|edge| edge <= number)] += 1;
    }
    let mut ends = vec![-1.0];
    ends.extend(edges);
    ends.push(1.0);
    let shares: Vec<f64> = ends.windows(2).map(|w| share(w[0], w[1])).collect();
    ChiSquare::new(&counts, &shares).verdict(0.02)
}

/// Histogram of cosines over cells of about equal shares, which quadrature of the law tells exactly.
fn histogram_of(cosines: &[f64], law: &Law, edges: &[f64]) -> Verdict {
    histogram(cosines, edges, |from, to| law.share(from, to))
}

/// Edges of cells with about equal shares: where they lie is free, so core may say.
fn edges<T: Row>(case: &Case<T>) -> Vec<f64> {
    let fine = 64 * CELLS;
    let middle = |i: usize| (i as f64 + 0.5) / fine as f64;
    let mut cosines: Vec<f64> = (0..fine)
        .map(|i| case.row.sample(middle(i), case.p))
        .collect();
    cosines.sort_by(f64::total_cmp);
    cosines.into_iter().step_by(64).skip(1).collect()
}

fn draws(pixel: u32, sample: impl Fn(f32) -> f32) -> Vec<f64> {
    collect::<f32, PathStream>(seed(61), pixel, samples(1 << 18), |rng| {
        sample(Stream::<f32>::uniform(rng, everyone::<f32>()))
    })
}

/// Whether cosines have this moment.
fn moment(cosines: &[f64], power: i32, expected: f64) -> Verdict {
    let sample: Sample = cosines.iter().map(|c| c.powi(power)).collect();
    judge_within(sample.moments(), expected, 0.002)
}

fn sampled<T: Row>() {
    for (pixel, case) in (0..).zip(T::cases()) {
        let single = case.single();
        let cosines = draws(pixel, |u| case.row.sample(u, single));
        if !case.law.too_sharp() {
            let verdict = histogram_of(&cosines, &case.law, &edges(&case));
            assert_verdict(&case.name(), verdict);
        }
        for power in 1..=3 {
            let verdict = moment(&cosines, power, case.law.moment(power));
            assert_verdict(&format!("moment {power} of {}", case.name()), verdict);
        }
    }
}

macro_rules! row {
    ($name:ident) => {
        mod $name {
            type Row = super::rows::$name;
            #[test]
            fn integrals_are_those_of_a_density() {
                super::integrals::<Row>();
            }
            #[test]
            fn tables_are_reproduced() {
                super::references::tables::<Row>();
            }
            #[test]
            fn sampling_and_inverting_are_one_map() {
                super::round_trips::<Row>();
            }
            #[test]
            fn extremes_stay_in_range() {
                super::extremes::<Row>();
            }
            #[test]
            fn cosines_follow_the_density() {
                super::sampled::<Row>();
            }
            #[test]
            fn lanes_have_the_bits_of_scalars() {
                super::lanes::<Row>();
            }
        }
    };
}
for_each_phase!(row);
