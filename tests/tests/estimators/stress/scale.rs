//! Units of length are nobody's business: extinctions by 2⁻ᵏ and lengths by 2ᵏ give the same collisions, bit by bit.
//!
//! No oracle and no statistics: wherever no number is subnormal or overflows, every operation commutes with a power
//! of two, so a result that does not has used a constant that has a unit. Kilometres, metres and nanometres are the
//! same test.

use super::media::{Is, Outcome, Tables, Visit, each, outcomes};
use super::{along_x, stream};
use woodcock_core::free_flight::{analytic, delta, regular};
use woodcock_core::medium::{Controlled, Exponential, Homogeneous, Linear, Procedural};
use woodcock_core::ray::Ray;
use woodcock_core::transmittance;
use woodcock_core::vec3::Vec3;

/// Lengths from 10⁻¹⁵ to 10¹⁵.
const POWERS: std::ops::RangeInclusive<i32> = -50..=50;
const PATHS: u32 = 12;

/// What happened, in units of length.
struct Recorded {
    unit: f32,
    bits: Vec<(&'static str, &'static str, u32)>,
}

impl Visit<f32> for Recorded {
    fn visit<M: Controlled<f32>>(
        &mut self,
        name: &'static str,
        medium: &M,
        ray: &Ray<f32>,
        t_max: f32,
    ) {
        for sample in 0..PATHS {
            for Outcome {
                name: call,
                value,
                is,
            } in outcomes(medium, ray, t_max, &stream(sample))
            {
                let value = if is == Is::Distance {
                    value / self.unit
                } else {
                    value
                };
                self.bits.push((name, call, value.to_bits()));
            }
        }
    }
}

fn recorded(tables: &Tables, unit: f32, depth: f32) -> Vec<(&'static str, &'static str, u32)> {
    let mut to = Recorded {
        unit,
        bits: Vec::new(),
    };
    each::<f32>(tables, unit, depth, &mut to);
    to.bits
}

fn power(k: i32) -> f32 {
    2.0_f64.powi(k) as f32
}

#[test]
fn no_estimator_knows_the_unit_of_length() {
    let tables = Tables::new();
    for depth in [0.5, 8.0] {
        let expected = recorded(&tables, 1.0, depth);
        assert!(
            expected.len() >= 15 * 12 * PATHS as usize,
            "every medium and estimator"
        );
        let collided = expected
            .iter()
            .filter(|(_, call, bits)| *call == "delta" && f32::from_bits(*bits) < 1.0);
        assert!(collided.count() > PATHS as usize, "something collided");
        for k in POWERS {
            let found = recorded(&tables, power(k), depth);
            for (found, expected) in found.iter().zip(&expected) {
                assert_eq!(found, expected, "in units of 2^{k}");
            }
            assert_eq!(found.len(), expected.len());
        }
    }
}

/// Distances in closed form and by delta tracking over the exponents of sixty decades.
#[test]
fn closed_forms_do_not_know_it_either() {
    let flights = |unit: f32| -> Vec<u32> {
        let sigma = 1.5 / unit;
        let fog = Homogeneous::new(sigma).expect("a valid extinction");
        let loose = Procedural::new(move |_: Vec3<f32>| 0.25 * sigma, sigma);
        let mut bits = Vec::new();
        for sample in 0..64 {
            let mut rng = stream(sample);
            for t in [
                analytic::sample(&fog, &along_x(), unit, &mut rng, true).t,
                regular::sample(&fog, &along_x(), unit, &mut rng, true).t,
                delta::sample(&loose, &along_x(), unit, &mut rng, true).t,
            ] {
                bits.push((t / unit).to_bits());
            }
        }
        bits.push(transmittance::analytic::estimate(&fog, &along_x(), unit).to_bits());
        bits
    };
    let expected = flights(1.0);
    for k in -99..=99 {
        assert_eq!(flights(power(k)), expected, "in units of 2^{k}");
    }
    let curved = |unit: f32| -> Vec<u32> {
        let (sigma, k) = (1.5 / unit, 0.5 / unit);
        let ramp = Linear::new(sigma, [-sigma * k, 0.0, 0.0]).expect("finite");
        let thin = Exponential::new(sigma, [k, 0.0, 0.0]).expect("finite");
        let thick = Exponential::new(sigma, [-k, 0.0, 0.0]).expect("finite");
        let mut bits = Vec::new();
        for sample in 0..64 {
            let mut rng = stream(sample);
            for t in [
                analytic::sample(&ramp, &along_x(), unit, &mut rng, true).t,
                analytic::sample(&thin, &along_x(), unit, &mut rng, true).t,
                analytic::sample(&thick, &along_x(), unit, &mut rng, true).t,
            ] {
                bits.push((t / unit).to_bits());
            }
        }
        bits
    };
    let expected = curved(1.0);
    // Roots commute with even powers only.
    for k in POWERS.step_by(2) {
        assert_eq!(curved(power(k)), expected, "in units of 2^{k}");
    }
}

/// Constants with a unit are found: a smallest step, an epsilon beside a length.
#[test]
fn constants_with_a_unit_are_found() {
    let beginner = |unit: f32, epsilon: f32, largest: f32| -> Vec<u32> {
        let mut rng = stream(1);
        let steps = (0..64).map(|_| {
            let step: f32 = woodcock_core::stream::Stream::<f32>::exponential(&mut rng, true);
            ((step * unit + epsilon).min(largest) / unit).to_bits()
        });
        steps.collect()
    };
    let expected = beginner(1.0, 1e-6, 100.0);
    let same = |k: i32| beginner(power(k), 1e-6, 100.0) == expected;
    let noticed = POWERS.filter(|&k| !same(k)).count();
    assert!(noticed >= 90, "noticed at {noticed} of 101 powers only");
    let harmless = |unit: f32| beginner(unit, 0.0, f32::INFINITY);
    assert!(
        POWERS.clone().all(|k| harmless(power(k)) == harmless(1.0)),
        "and nothing else is"
    );
}
