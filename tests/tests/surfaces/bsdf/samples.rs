//! Samples against densities: direction histograms, and the quotient that weights are.

use super::subject::{
    Choice, Mistake, Mistaken, Scatter, TRANSPORTS, any_direction, at, dielectric, diffuse,
    direction, metal, uniforms,
};
use glam::DVec3;
use std::f64::consts::TAU;
use woodcock_host::bsdf::Transport;
use woodcock_tests::stats::independent::SplitMix;
use woodcock_tests::stats::{ChiSquare, Verdict, assert_verdict, must_kill, samples};

/// Cells of equal solid angle, by height and azimuth; one more is for light that is absorbed.
const HEIGHTS: usize = 32;
const AZIMUTHS: usize = 24;
/// Places per cell and axis at which the density is taken.
const PLACES: usize = 20;

fn histogram(
    subject: &dyn Scatter,
    from: DVec3,
    transport: Transport,
    n: u64,
    rng: &mut SplitMix,
) -> Vec<u64> {
    let mut counts = vec![0; HEIGHTS * AZIMUTHS + 1];
    for _ in 0..n {
        let cell = match subject.sample(from, uniforms(rng), transport) {
            Some(Choice { direction: w, .. }) => {
                let height = (w.z + 1.0) / 2.0 * HEIGHTS as f64;
                let turn = w.y.atan2(w.x) / TAU;
                let azimuth = (turn - turn.floor()) * AZIMUTHS as f64;
                (height as usize).min(HEIGHTS - 1) * AZIMUTHS + (azimuth as usize).min(AZIMUTHS - 1)
            }
            None => HEIGHTS * AZIMUTHS,
        };
        counts[cell] += 1;
    }
    counts
}

/// The probability of each cell by its density, which need not sum to one if the density is wrong.
fn probabilities(subject: &dyn Scatter, from: DVec3, transport: Transport) -> Vec<f64> {
    let mut cells = Vec::new();
    let middle = |i: usize, of: usize| (i as f64 + 0.5) / of as f64;
    for height in 0..HEIGHTS {
        for azimuth in 0..AZIMUTHS {
            let mut sum = 0.0;
            for i in 0..PLACES {
                for j in 0..PLACES {
                    let z = 2.0 * middle(height * PLACES + i, HEIGHTS * PLACES) - 1.0;
                    let phi = TAU * middle(azimuth * PLACES + j, AZIMUTHS * PLACES);
                    sum += subject.pdf(from, direction(z, phi), transport);
                }
            }
            cells.push(sum * 2.0 * TAU / (HEIGHTS * AZIMUTHS * PLACES * PLACES) as f64);
        }
    }
    cells
}

/// Whether samples follow the density and are absorbed where it lacks.
fn verdict(subject: &dyn Scatter, from: DVec3, transport: Transport, seed: u64) -> Verdict {
    let mut cells = probabilities(subject, from, transport);
    let whole: f64 = cells.iter().sum();
    // A density that integrates to more than one is wrong whatever the samples do; what the quadrature is off is not.
    if whole > 1.0 + 2e-3 {
        return Verdict::Biased { z: f64::INFINITY };
    }
    // Nothing is absorbed where the density integrates to one, but quadrature cannot tell 0 from 10⁻⁴.
    cells.push((1.0 - whole).max(1e-9));
    let whole: f64 = cells.iter().sum();
    let cells: Vec<f64> = cells.iter().map(|p| p / whole).collect();
    let n = samples(1 << 19);
    let counts = histogram(subject, from, transport, n as u64, &mut SplitMix::new(seed));
    ChiSquare::new(&counts, &cells).verdict(0.03)
}

#[test]
fn directions_follow_their_density() {
    let cases = [
        (metal(0.2, 3.0, [0.4, 0.4]), 0.0),
        (metal(0.2, 3.0, [0.25, 0.8]), 0.0),
        (metal(0.2, 3.0, [0.4, 0.4]), 0.3),
        (dielectric(1.5, [0.4, 0.4]), 0.0),
        (dielectric(0.65, [0.3, 0.7]), 0.0),
        (dielectric(1.5, [0.5, 0.3]), 0.3),
        (diffuse(0.5), 0.0),
        (diffuse(0.5), 0.5),
    ];
    for (i, (kind, tilt)) in cases.into_iter().enumerate() {
        let bsdf = at(kind.clone(), tilt);
        for (j, z) in [0.95, 0.5, 0.1, -0.7].into_iter().enumerate() {
            let from = direction(z, 0.3 + z);
            for transport in TRANSPORTS {
                let is_diffuse = kind_is_diffuse(&kind);
                if transport == Transport::Importance && !is_diffuse {
                    continue; // the same density
                }
                let seed = 40 + 10 * i as u64 + j as u64;
                let name = format!("{kind:?}, tilt {tilt}, z {z}, {transport:?}");
                assert_verdict(&name, verdict(&bsdf, from, transport, seed));
            }
        }
    }
}

fn kind_is_diffuse(kind: &woodcock_host::scene::MaterialKind) -> bool {
    matches!(kind, woodcock_host::scene::MaterialKind::Diffuse { .. })
}

/// A density that is another's.
struct Borrowed<'a>(&'a dyn Scatter, &'a dyn Scatter);

impl Scatter for Borrowed<'_> {
    fn eval(&self, from: DVec3, to: DVec3, transport: Transport) -> f64 {
        self.0.eval(from, to, transport)
    }

    fn pdf(&self, from: DVec3, to: DVec3, transport: Transport) -> f64 {
        self.1.pdf(from, to, transport)
    }

    fn sample(&self, from: DVec3, u: [f64; 3], transport: Transport) -> Option<Choice> {
        self.0.sample(from, u, transport)
    }
}

#[test]
fn wrong_densities_are_caught() {
    let from = direction(0.5, 0.8);
    let bsdf = at(dielectric(1.5, [0.4, 0.4]), 0.0);
    for mistake in [Mistake::LensWithoutEta, Mistake::NormalsForDirections] {
        let wrong = Mistaken {
            bsdf,
            eta: 1.5,
            tilt: 0.0,
            mistake,
        };
        let verdict = verdict(&wrong, from, Transport::Radiance, 90);
        must_kill(&format!("{mistake:?}"), verdict);
    }
    let metals = [[0.4, 0.4], [0.42, 0.4]].map(|alpha| at(metal(0.2, 3.0, alpha), 0.0));
    let borrowed = Borrowed(&metals[0], &metals[1]);
    must_kill(
        "a width 5 % off",
        verdict(&borrowed, from, Transport::Radiance, 91),
    );
    let diffuse = [0.5, 0.4].map(|tilt| at(diffuse(0.5), tilt));
    let borrowed = Borrowed(&diffuse[0], &diffuse[1]);
    must_kill(
        "the normal of elsewhere",
        verdict(&borrowed, from, Transport::Radiance, 92),
    );
}

/// The largest relative distance of weights and densities of samples from what is said of their directions.
fn quotient(subject: &dyn Scatter, seed: u64) -> f64 {
    let mut rng = SplitMix::new(seed);
    let mut worst: f64 = 0.0;
    for _ in 0..20_000 {
        let from = any_direction(&mut rng);
        for transport in TRANSPORTS {
            let Some(choice) = subject.sample(from, uniforms(&mut rng), transport) else {
                continue;
            };
            let to = choice.direction;
            assert!((to.length() - 1.0).abs() < 1e-14);
            let pdf = subject.pdf(from, to, transport);
            let value = subject.eval(from, to, transport);
            worst = worst
                .max((choice.pdf / pdf - 1.0).abs())
                .max((choice.weight * pdf / value - 1.0).abs());
        }
    }
    worst
}

#[test]
fn weights_are_values_over_densities() {
    for tilt in [0.0, 0.3] {
        let got = quotient(&at(diffuse(0.3), tilt), 93);
        assert!(got < 1e-12, "diffuse, tilt {tilt}: {got:e}");
        for alpha in [[0.3, 0.3], [0.05, 0.6], [1e-3, 1e-3], [2.0, 2.0]] {
            for kind in [
                metal(0.2, 3.0, alpha),
                dielectric(1.5, alpha),
                dielectric(0.4, alpha),
            ] {
                let got = quotient(&at(kind.clone(), tilt), 94);
                // Half vectors of narrow lobes lose the digits that 1 / α² has.
                let tolerance = 1e-9 / (alpha[0] * alpha[0]).min(1.0);
                assert!(got < tolerance, "{kind:?}, tilt {tilt}: {got:e}");
            }
        }
    }
    let alpha = [0.3; 2];
    let bsdf = at(dielectric(1.5, alpha), 0.0);
    struct Unmasked(Mistaken);
    impl Scatter for Unmasked {
        fn eval(&self, from: DVec3, to: DVec3, transport: Transport) -> f64 {
            Scatter::eval(&self.0.bsdf, from, to, transport)
        }
        fn pdf(&self, from: DVec3, to: DVec3, transport: Transport) -> f64 {
            Scatter::pdf(&self.0.bsdf, from, to, transport)
        }
        fn sample(&self, from: DVec3, u: [f64; 3], transport: Transport) -> Option<Choice> {
            self.0.sample(from, u, transport)
        }
    }
    let mistake = Mistake::NothingMasked(alpha);
    assert!(
        quotient(
            &Unmasked(Mistaken {
                bsdf,
                eta: 1.5,
                tilt: 0.0,
                mistake
            }),
            95
        ) > 0.1
    );
}
