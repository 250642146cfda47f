//! Rays through varying densities: how far a flight goes, and the emission that it gathers.
//!
//! ```text
//! ∫ σ_t T (1 + x) dt = E [(1 + x(t)) 1(collided)],   ∫ T dt = E min(t, t_max),   T = P(leaves)
//! ```
//!
//! with one flight of delta tracking through each of the twelve fields, four rays each, under a loose bound.

use super::{Ledger, honest_and, judge_near, names, record};
use woodcock_tests::fixtures::{self, Fixture};
use woodcock_tests::stats::{Mutants, Sample};
use woodcock_tests::walker::{Isotropic, Mistake, Run, Stretch, UnderBound, Walk, ray, tally};

/// Emission, length flown and share that leaves.
fn flown(fixture: &Fixture, mistake: Option<Mistake>, run: Run) -> Vec<Sample> {
    let flights = fixture.sigma_t().under(1.2 * fixture.majorant);
    let mut walk = Walk::new(Stretch(fixture.ray.t_max as f32), flights, Isotropic);
    walk.mistake = mistake;
    let from = ray(fixture.ray.origin, fixture.ray.dir);
    tally(run, 3, |draws, scores| {
        let mut ray = from;
        let flight = walk.fly(&mut ray, draws);
        scores[1] += f64::from(flight.t);
        if flight.collided {
            scores[0] += 1.0 + f64::from(ray.origin.x);
        } else {
            scores[2] += 1.0;
        }
    })
}

#[test]
fn emission_and_length() {
    let mut ledger = Ledger::new("transmittance");
    for (i, fixture) in fixtures::all().iter().enumerate() {
        let samples = flown(fixture, None, Run::new(120, i as u32, 1 << 16));
        let (name, known) = (&fixture.name, &fixture.ray);
        ledger.agrees(
            format_args!("{name}, emission"),
            &samples[0],
            known.emission,
            0.015,
        );
        let length = known.mean_free_flight;
        ledger.agrees(format_args!("{name}, length"), &samples[1], length, 0.01);
        let leaves = known.transmittance;
        ledger.agrees(format_args!("{name}, leaves"), &samples[2], leaves, 0.06);
    }
    ledger.finish(12 * 4 * 3);
}

/// The mistakes that these comparisons must reject.
pub(super) const MISTAKES: [Mistake; 2] = [Mistake::NullScatters, Mistake::Unclipped];

#[test]
fn mutants_die() {
    let mut suite = Mutants::new("transmittance", &names(&MISTAKES));
    let fixture = &fixtures::of_field("gaussian")[0];
    for mistake in honest_and(&MISTAKES) {
        let samples = flown(fixture, mistake, Run::new(121, 0, 1 << 16));
        let mut check = |name, i: usize, known: f64| {
            let verdict = judge_near(samples[i].moments(), known, 0.0, 0.02 * known);
            record(&mut suite, name, mistake, verdict);
        };
        check("emission", 0, fixture.ray.emission);
        check("length", 1, fixture.ray.mean_free_flight);
        check("share that leaves", 2, fixture.ray.transmittance);
    }
    suite.finish();
}
