//! Radiance leaving slabs by direction, and fluence within them.
//!
//! Radiance is scored at every collision by what it sends straight to the eye:
//!
//! ```text
//! L(μ, φ) = μ₀ E Σ w α p(cos) T(depth/μ)/μ
//! ```
//!
//! for particles of a beam of irradiance 1 across it, which brings μ₀ to a unit of area. The cosine lies between the
//! direction of arrival and the way out. Fluence is found backwards, by reciprocity: a path from the depth in
//! question, in every direction alike, scores at its collisions what the beam sends there.

use super::{Ledger, honest_and, judge_near, names, record};
use std::f64::consts::PI;
use woodcock_core::vec3::Vec3;
use woodcock_tests::refs::slab_radiance::{Case, load};
use woodcock_tests::stats::{Mutants, Sample};
use woodcock_tests::walker::{
    Closed, HenyeyGreenstein, Law, Mistake, Run, Slab, Walk, ray, tally, vector,
};

type SlabWalk = Walk<Slab, Closed, HenyeyGreenstein>;

/// A slab of thickness 1.
fn walk(case: &Case) -> SlabWalk {
    let law = HenyeyGreenstein(case.g as f32);
    Walk::new(Slab { thickness: 1.0 }, Closed::new(case.tau), law)
}

/// A direction of travel with cosine `mu` to z, turned about it by `phi` degrees.
fn direction(mu: f64, phi: f64) -> [f64; 3] {
    let (sin, cos) = phi.to_radians().sin_cos();
    let across = (1.0 - mu * mu).sqrt();
    [across * cos, across * sin, mu]
}

/// Radiances out of the lit face by μ then φ, followed by those out of the far face.
fn radiances(walk: &SlabWalk, case: &Case, run: Run) -> Vec<Sample> {
    let faces = [-1.0, 1.0];
    let ways = |phis: &[f64]| -> Vec<(f64, Vec<Vec3<f32>>)> {
        let of = |(sign, mu): (f64, f64)| {
            let ways = phis.iter().map(|phi| vector(direction(sign * mu, *phi)));
            (mu, ways.collect())
        };
        let pairs = faces
            .into_iter()
            .flat_map(|sign| case.mu.iter().map(move |mu| (sign, *mu)));
        pairs.map(of).collect()
    };
    let ways = ways(&case.phi_deg);
    let count = ways.len() * case.phi_deg.len();
    tally(run, count, |draws, scores| {
        let mut ray = ray([0.0; 3], direction(case.mu0, 0.0));
        let mut weight = case.mu0;
        walk.follow(&mut ray, draws, |ray, draws| {
            weight = walk.absorb(weight, case.albedo);
            for ((mu, out), scores) in ways.iter().zip(scores.chunks_mut(case.phi_deg.len())) {
                let through = weight * walk.way_out(ray.origin, out[0], draws) / mu;
                for (out, score) in out.iter().zip(scores) {
                    let cosine = ray.direction.dot(*out);
                    *score += through * f64::from(walk.law.density(&ray.origin, cosine));
                }
            }
            weight *= walk.roulette(weight, 0.1, draws);
            weight > 0.0
        });
    })
}

/// Fluences at the depths of the table, one after the other, each by its own particles.
fn fluences(walk: &SlabWalk, case: &Case, run: Run) -> Vec<Sample> {
    let beam = vector(direction(case.mu0, 0.0));
    tally(run, case.depth.len(), |draws, scores| {
        for (depth, score) in case.depth.iter().zip(scores) {
            *score += (-depth / case.mu0).exp();
            let mut ray = ray([0.0, 0.0, depth / case.tau], [0.0, 0.0, 1.0]);
            ray.direction = draws.isotropic();
            let mut weight = 4.0 * PI;
            walk.follow(&mut ray, draws, |ray, draws| {
                weight = walk.absorb(weight, case.albedo);
                // Light travels against the path.
                let cosine = (-ray.direction).dot(beam);
                let density = f64::from(walk.law.density(&ray.origin, cosine));
                let lit = walk.way_out(ray.origin, -beam, draws);
                *score += weight * density * lit;
                weight *= walk.roulette(weight, 1.0, draws);
                weight > 0.0
            });
        }
    })
}

#[test]
fn radiance_by_direction() {
    let mut ledger = Ledger::new("slab_radiance");
    let mut expected = 0;
    for (i, case) in load().iter().enumerate() {
        let walk = walk(case);
        let samples = radiances(&walk, case, Run::new(80, i as u32, 1 << 17));
        let known = case.reflected.iter().chain(&case.transmitted).flatten();
        for (j, (sample, known)) in samples.iter().zip(known).enumerate() {
            ledger.agrees(format_args!("{i} way {j}"), sample, *known, 0.025);
        }
        expected += 2 * case.mu.len() * case.phi_deg.len();
    }
    assert_eq!(expected, 2 * 6 * (3 + 3 * 4));
    ledger.finish(expected);
}

#[test]
fn fluence_by_depth() {
    let mut ledger = Ledger::new("slab_radiance");
    for (i, case) in load().iter().enumerate() {
        let samples = fluences(&walk(case), case, Run::new(81, i as u32, 1 << 17));
        for ((depth, known), sample) in case.depth.iter().zip(&case.fluence).zip(samples) {
            ledger.agrees(
                format_args!("{i} fluence at {depth}"),
                &sample,
                *known,
                0.01,
            );
        }
    }
    ledger.finish(6 * 6);
}

/// The mistakes that these comparisons must reject.
pub(super) const MISTAKES: [Mistake; 6] = [
    Mistake::PhaseReversed,
    Mistake::StaleFlight,
    Mistake::ShortFrame,
    Mistake::HalfTurn,
    Mistake::OneUniform,
    Mistake::AlbedoTwice,
];

#[test]
fn mutants_die() {
    let mut suite = Mutants::new("slab_radiance", &names(&MISTAKES));
    let case = &load()[4];
    for mistake in honest_and(&MISTAKES) {
        let mut walk = walk(case);
        walk.mistake = mistake;
        let samples = radiances(&walk, case, Run::new(82, 0, 1 << 15));
        let mut check = |name, i: usize, known: f64| {
            let verdict = judge_near(samples[i].moments(), known, 0.0, 0.03 * known);
            record(&mut suite, name, mistake, verdict);
        };
        // Cosine 0.6 at 60 degrees, out of either face.
        check("reflected radiance", 3 * 4 + 1, case.reflected[3][1]);
        check(
            "transmitted radiance",
            (6 + 3) * 4 + 1,
            case.transmitted[3][1],
        );
        let samples = fluences(&walk, case, Run::new(82, 1, 1 << 14));
        let known = case.fluence[3];
        let verdict = judge_near(samples[3].moments(), known, 0.0, 0.03 * known);
        record(&mut suite, "fluence", mistake, verdict);
    }
    suite.finish();
}
