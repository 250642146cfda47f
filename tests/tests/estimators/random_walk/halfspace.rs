//! The isotropic half-space: what it reflects, in which direction, and after how many collisions.
//!
//! One walk serves several albedos, as in [`super::slab_matched`]; core's roulette ends it, at the largest of them.
//! The number of collisions of an analogue photon is the sum of the weights with which the walk collides:
//!
//! ```text
//! E N = Σₖ αᵏ P(the k-th of a conservative walk) = H(μ)/√(1 − α)
//! ```
//!
//! Left out: albedo 1, where everything returns after infinitely many collisions on average, and with it Milne's
//! problem.

use super::{Ledger, honest_and, judge_near, names, record};
use woodcock_core::ray::Ray;
use woodcock_tests::refs::halfspace::{Case, Table, load};
use woodcock_tests::stats::{Mutants, Sample};
use woodcock_tests::walker::{
    Closed, Draws, Isotropic, Law, Mistake, Run, Slab, Walk, ray, tally, vector,
};

type HalfSpaceWalk = Walk<Slab, Closed, Isotropic>;

fn half_space() -> HalfSpaceWalk {
    let everything = Slab {
        thickness: f32::INFINITY,
    };
    Walk::new(everything, Closed::new(1.0), Isotropic)
}

fn direction(mu: f64) -> [f64; 3] {
    [(1.0 - mu * mu).sqrt(), 0.0, mu]
}

/// For each albedo in turn, ascending: the share reflected, the collisions, and the reflected radiance towards each
/// of `ways` over the irradiance of the face.
fn scores(
    walk: &HalfSpaceWalk,
    run: Run,
    albedos: &[f64],
    ways: &[f64],
    enter: impl Fn(&mut Draws) -> Ray<f32>,
) -> Vec<Sample> {
    let each = 2 + ways.len();
    let out: Vec<_> = ways
        .iter()
        .map(|mu| (*mu, vector(direction(-mu))))
        .collect();
    let mut weights = vec![1.0; albedos.len()];
    let mut shares = vec![0.0; ways.len()];
    tally(run, each * albedos.len(), |draws, scores| {
        let mut ray = enter(draws);
        weights.fill(1.0);
        let left = walk.follow(&mut ray, draws, |ray, draws| {
            for ((mu, out), share) in out.iter().zip(&mut shares) {
                let through = walk.way_out(ray.origin, *out, draws);
                let density = walk.law.density(&ray.origin, ray.direction.dot(*out));
                *share = f64::from(density) * through / mu;
            }
            for (i, (weight, albedo)) in weights.iter_mut().zip(albedos).enumerate() {
                scores[each * i + 1] += *weight;
                *weight = walk.absorb(*weight, *albedo);
                for (score, share) in scores[each * i + 2..].iter_mut().zip(&shares) {
                    *score += *weight * share;
                }
            }
            let factor = walk.roulette(weights[weights.len() - 1], 0.5, draws);
            weights.iter_mut().for_each(|weight| *weight *= factor);
            factor > 0.0
        });
        if left {
            for (i, weight) in weights.iter().enumerate() {
                scores[each * i] += weight;
            }
        }
    })
}

/// Albedos that are walked together, by how many particles, and the standard error asked for.
const GROUPS: [(&[f64], usize, f64); 2] = [
    (&[0.5, 0.9, 0.99], 1 << 15, 0.02),
    (&[0.999], 1 << 13, 0.06),
];

fn of(table: &Table, albedo: f64) -> &Case {
    let case = table.cases.iter().find(|c| c.albedo == albedo);
    case.expect("an albedo of the table")
}

#[test]
fn albedos_and_collisions() {
    let table = load();
    let mut ledger = Ledger::new("halfspace");
    for (albedos, particles, asked) in GROUPS {
        for (j, &mu) in table.mu.iter().enumerate() {
            let run = Run::new(85, j as u32, particles);
            let enter = |_: &mut Draws| ray([0.0; 3], direction(mu));
            let samples = scores(&half_space(), run, albedos, &[], enter);
            for (albedo, sample) in albedos.iter().zip(samples.chunks(2)) {
                let case = of(&table, *albedo);
                let name = format!("albedo {albedo} mu {mu}");
                let plane = case.plane_albedo[j];
                ledger.agrees(
                    format_args!("{name}, plane albedo"),
                    &sample[0],
                    plane,
                    0.01,
                );
                let collisions = case.h[j] / (1.0 - albedo).sqrt();
                ledger.agrees(
                    format_args!("{name}, collisions"),
                    &sample[1],
                    collisions,
                    asked,
                );
            }
        }
        let lambertian = |draws: &mut Draws| {
            let mut ray = ray([0.0; 3], [0.0, 0.0, 1.0]);
            ray.direction = draws.lambertian(ray.direction);
            ray
        };
        let samples = scores(
            &half_space(),
            Run::new(85, 11, particles),
            albedos,
            &[],
            lambertian,
        );
        for (albedo, sample) in albedos.iter().zip(samples.chunks(2)) {
            let case = of(&table, *albedo);
            let spherical = case.spherical_albedo;
            ledger.agrees(
                format_args!("albedo {albedo}, spherical"),
                &sample[0],
                spherical,
                0.01,
            );
            // ⟨H⟩ over Lambertian light is 2 ∫ μ H dμ.
            let collisions = 2.0 * case.alpha1 / (1.0 - albedo).sqrt();
            ledger.agrees(
                format_args!("albedo {albedo}, collisions"),
                &sample[1],
                collisions,
                asked,
            );
        }
    }
    ledger.finish(4 * (11 + 1) * 2);
}

#[test]
fn radiance_by_direction() {
    let table = load();
    let mut ledger = Ledger::new("halfspace");
    for (albedos, particles, asked) in GROUPS {
        for k in 0..2 {
            let mu0 = of(&table, albedos[0]).brdf[k].mu0;
            let run = Run::new(86, k as u32, particles);
            let enter = |_: &mut Draws| ray([0.0; 3], direction(mu0));
            let samples = scores(&half_space(), run, albedos, &table.mu, enter);
            for (albedo, sample) in albedos.iter().zip(samples.chunks(2 + table.mu.len())) {
                let brdf = &of(&table, *albedo).brdf[k];
                assert_eq!(brdf.mu0, mu0);
                for ((mu, known), sample) in table.mu.iter().zip(&brdf.brdf_at_mu).zip(&sample[2..])
                {
                    let name = format_args!("albedo {albedo} from {mu0} to {mu}");
                    ledger.agrees(name, sample, *known, asked);
                }
            }
        }
    }
    ledger.finish(4 * 2 * 11);
}

/// The mistakes that these comparisons must reject.
pub(super) const MISTAKES: [Mistake; 4] = [
    Mistake::StaleFlight,
    Mistake::ShortFrame,
    Mistake::AlbedoTwice,
    Mistake::LossyRoulette,
];

#[test]
fn mutants_die() {
    let table = load();
    let mut suite = Mutants::new("halfspace", &names(&MISTAKES));
    let case = of(&table, 0.9);
    let (mu, known) = (table.mu[5], case.brdf[0].brdf_at_mu[5]);
    for mistake in honest_and(&MISTAKES) {
        let mut walk = half_space();
        walk.mistake = mistake;
        let run = Run::new(87, 0, 1 << 17);
        let enter = |_: &mut Draws| ray([0.0; 3], [0.0, 0.0, 1.0]);
        let samples = scores(&walk, run, &[0.9], &[mu], enter);
        let mut check = |name, i: usize, known: f64| {
            let verdict = judge_near(samples[i].moments(), known, 0.0, 0.02 * known);
            record(&mut suite, name, mistake, verdict);
        };
        check("plane albedo", 0, case.plane_albedo[10]);
        check("collisions", 1, case.h[10] / 0.1_f64.sqrt());
        check("radiance", 2, known);
    }
    suite.finish();
}
