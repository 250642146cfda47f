//! What little comes through where weights alone do not resolve it, by a weight window.
//!
//! The window falls with depth as the light does, which keeps particles about as many at every depth: core's roulette
//! below it, splitting above. Flights end at planes, so that those that meet no collision are split as well.

use super::{Light, UNIT, is_deep, of_slab};
use crate::random_walk::Ledger;
use woodcock_core::ray::Ray;
use woodcock_tests::refs::slab_matched::{self, Fluxes};
use woodcock_tests::stats::Sample;
use woodcock_tests::walker::{Body, Closed, Flights, HenyeyGreenstein, Law, Run, Walk, tally};

/// The slab cut into layers: a flight ends at the next plane, and begins anew there without memory.
#[derive(Clone, Copy, Debug)]
pub(super) struct Layers {
    /// How many.
    pub(super) count: f32,
}

impl Layers {
    /// Whether a ray that stopped at a plane stands at a face.
    fn is_face(ray: &Ray<f32>) -> bool {
        let z = ray.origin.z;
        if ray.direction.z < 0.0 {
            z < 1e-4
        } else {
            z > 1.0 - 1e-4
        }
    }
}

impl Body for Layers {
    fn exit(&self, ray: &Ray<f32>) -> f32 {
        let (depth, slope) = (ray.origin.z * self.count, ray.direction.z * self.count);
        // A ray that stands on a plane goes on to the next.
        let ahead = if slope < 0.0 {
            (depth - 1e-3).floor() - depth
        } else {
            (depth + 1e-3).floor() + 1.0 - depth
        };
        let faces = UNIT.exit(ray);
        if slope == 0.0 {
            faces
        } else {
            faces.min(ahead / slope)
        }
    }
}

/// Transmittance by a weight window: at optical depth t the weight is kept within 1 to 2 times e^(−rate t).
pub(super) fn through<F: Flights, L: Law>(
    walk: &Walk<Layers, F, L>,
    run: Run,
    light: Light,
    (albedo, tau, rate): (f64, f64, f64),
) -> Sample {
    let mut waiting: Vec<(Ray<f32>, f64)> = Vec::new();
    let mut samples = tally(run, 1, |draws, scores| {
        waiting.push((light.enter(draws), 1.0));
        while let Some((mut ray, mut weight)) = waiting.pop() {
            loop {
                if walk.fly(&mut ray, draws).collided {
                    weight = walk.absorb(weight, albedo);
                    walk.scatter(&mut ray, draws);
                } else if Layers::is_face(&ray) {
                    if ray.direction.z > 0.0 {
                        scores[0] += weight;
                    }
                    break;
                }
                let importance = (rate * tau * f64::from(ray.origin.z)).exp();
                weight *= walk.roulette(weight * importance, 1.0, draws);
                if weight == 0.0 {
                    break;
                }
                let copies = ((weight * importance) as usize).max(1);
                weight /= copies as f64;
                waiting.resize(waiting.len() + copies - 1, (ray, weight));
            }
        }
    });
    samples.remove(0)
}

/// How fast light falls with optical depth, by the table's perpendicular beam; any rate gives the same mean.
pub(super) fn decay(slabs: &[slab_matched::Slab], albedo: f64, g: f64) -> f64 {
    let through = |tau: f64| {
        let same = |s: &&slab_matched::Slab| s.albedo == albedo && s.tau == tau && s.g == g;
        let slab = slabs.iter().find(same).expect("a slab of the table");
        slab.beams[0].1.transmittance
    };
    (through(4.0) / through(16.0)).ln() / 12.0
}

#[test]
fn what_little_comes_through_deep_slabs() {
    let mut ledger = Ledger::new("slab_matched");
    let slabs = slab_matched::load().slabs;
    for slab in &slabs {
        let (albedo, tau, g) = (slab.albedo, slab.tau, slab.g);
        if !is_deep(albedo, tau) {
            continue;
        }
        let rate = decay(&slabs, albedo, g);
        let count = (rate * tau / std::f64::consts::LN_2).ceil() as f32;
        let law = HenyeyGreenstein(g as f32);
        let walk = Walk::new(Layers { count }, Closed::new(tau), law);
        for (light, Fluxes { transmittance, .. }) in of_slab(slab) {
            // Slanting light seldom gets in, and then its particles end soon.
            let particles = match light {
                Light::Beam(mu) if mu < 0.2 => 1 << 16,
                Light::Beam(mu) if mu < 0.9 => 1 << 15,
                _ => 1 << 14,
            };
            let run = Run::new(73, ledger.comparisons as u32, particles);
            let sample = through(&walk, run, light, (albedo, tau, rate));
            ledger.agrees(
                format_args!("through albedo {albedo} tau {tau} g {g} {light:?}"),
                &sample,
                transmittance,
                0.1,
            );
        }
    }
    ledger.finish(3 * 4 * 4);
}
