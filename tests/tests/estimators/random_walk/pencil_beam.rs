//! The lateral spread of a thin beam: how far from where it enters light leaves again.
//!
//! Left out: the medium with a refractive index, whose face is a surface.

use super::{Ledger, honest_and, judge_near, names, record};
use woodcock_tests::refs::pencil_beam::{Case, load};
use woodcock_tests::stats::{Mutants, Sample};
use woodcock_tests::walker::{Closed, HenyeyGreenstein, Mistake, Run, Slab, Walk, ray, tally};

fn walk(case: &Case) -> Walk<Slab, Closed, HenyeyGreenstein> {
    let thickness = case.tau.map_or(f32::INFINITY, |tau| tau as f32);
    let law = HenyeyGreenstein(case.g as f32);
    Walk::new(Slab { thickness }, Closed::new(1.0), law)
}

/// Power leaving within each of `radii` and in all, first out of the lit face, then out of the far one.
fn leaving(
    walk: &Walk<Slab, Closed, HenyeyGreenstein>,
    albedo: f64,
    radii: &[f64],
    run: Run,
) -> Vec<Sample> {
    let each = radii.len() + 1;
    tally(run, 2 * each, |draws, scores| {
        let mut ray = ray([0.0; 3], [0.0, 0.0, 1.0]);
        let mut weight = 1.0;
        let left = walk.follow(&mut ray, draws, |_, draws| {
            weight = walk.absorb(weight, albedo);
            weight *= walk.roulette(weight, 0.2, draws);
            weight > 0.0
        });
        if left {
            let from_axis = f64::from(ray.origin.x).hypot(ray.origin.y.into());
            let face = if ray.direction.z > 0.0 { each } else { 0 };
            for (score, radius) in scores[face..].iter_mut().zip(radii) {
                if from_axis <= *radius {
                    *score += weight;
                }
            }
            scores[face + radii.len()] += weight;
        }
    })
}

#[test]
fn power_within_a_radius() {
    let table = load();
    let mut ledger = Ledger::new("pencil_beam");
    let mut skipped = 0;
    for (i, case) in table.cases.iter().enumerate() {
        if case.n != 1.0 {
            skipped += 1;
            continue;
        }
        let run = Run::new(105, i as u32, 1 << 19);
        let samples = leaving(&walk(case), case.albedo, &table.rho, run);
        let (reflected, transmitted) = samples.split_at(table.rho.len() + 1);
        let mut compare = |name: &str, samples: &[Sample], shares: &[f64], errors: &[f64]| {
            let known = shares.iter().zip(errors).zip(&table.rho);
            for (sample, ((share, error), rho)) in samples.iter().zip(known) {
                let name = format_args!("{i}, {name} within {rho}");
                ledger.within(name, sample, *share, *error, 0.015 * share);
            }
        };
        compare(
            "reflected",
            reflected,
            &case.reflected_within,
            &case.reflected_error,
        );
        if let (Some(shares), Some(errors)) = (&case.transmitted_within, &case.transmitted_error) {
            compare("transmitted", transmitted, shares, errors);
        }
        // The total has the error of its largest part.
        let (total, error) = (case.reflected, case.reflected_error[table.rho.len() - 1]);
        let sample = &reflected[table.rho.len()];
        ledger.within(
            format_args!("{i}, reflected"),
            sample,
            total,
            error,
            0.005 * total,
        );
    }
    assert_eq!(skipped, 1, "media with a face that refracts");
    ledger.finish(6 + 12 + 2);
}

/// The mistakes that these comparisons must reject.
pub(super) const MISTAKES: [Mistake; 5] = [
    Mistake::PhaseReversed,
    Mistake::StaleFlight,
    Mistake::ShortFrame,
    Mistake::HalfTurn,
    Mistake::AlbedoTwice,
];

#[test]
fn mutants_die() {
    let mut suite = Mutants::new("pencil_beam", &names(&MISTAKES));
    let table = load();
    let case = &table.cases[0];
    for mistake in honest_and(&MISTAKES) {
        let mut walk = walk(case);
        walk.mistake = mistake;
        let samples = leaving(&walk, case.albedo, &table.rho, Run::new(106, 0, 1 << 16));
        let mut check = |name, i: usize| {
            let (share, error) = (case.reflected_within[i], case.reflected_error[i]);
            let verdict = judge_near(samples[i].moments(), share, error, 0.03 * share);
            record(&mut suite, name, mistake, verdict);
        };
        check("within half a mean free path", 1);
        check("within four", 4);
    }
    suite.finish();
}
