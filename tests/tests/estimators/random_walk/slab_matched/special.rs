//! Slabs with other phase functions, with layers, and with an albedo that varies with depth.
//!
//! Left out: the slab over a ground, which is a surface.

use super::{Light, UNIT};
use crate::random_walk::Ledger;
use woodcock_core::phase::two_lobe::TwoLobe;
use woodcock_core::vec3::Vec3;
use woodcock_tests::refs::slab_matched::{self, Inputs, Special};
use woodcock_tests::walker::{
    Closed, Draine, Draws, HenyeyGreenstein, Law, Lobes, Rayleigh, Run, Walk, tally,
};

/// Optical thickness, phase function, and albedo by depth.
type Filling = (f64, Box<dyn Law>, Box<dyn Fn(f64) -> f64>);

/// What fills a special slab of thickness 1, if it has no surface.
fn filling(slab: &Special) -> Option<Filling> {
    // A ground is a surface.
    if slab.ground_albedo > 0.0 {
        return None;
    }
    let constant = |albedo: f64| Box::new(move |_| albedo);
    Some(match &slab.inputs {
        Inputs::Layers { layers } => {
            let tau: f64 = layers.iter().map(|l| l[0]).sum();
            let stack = Stack {
                layers: layers.clone(),
                tau,
            };
            let albedos = stack.clone();
            let albedo = move |z: f64| albedos.at(z)[1];
            (tau, Box::new(stack), Box::new(albedo))
        }
        &Inputs::AlbedoGradient { a0, a1, tau, g } => {
            let albedo = move |z: f64| a0 + (a1 - a0) * z;
            (tau, Box::new(HenyeyGreenstein(g as f32)), Box::new(albedo))
        }
        &Inputs::Mixture {
            g1,
            g2,
            w,
            albedo,
            tau,
            ..
        } => {
            let law = Lobes(TwoLobe {
                share: w as f32,
                g1: g1 as f32,
                g2: g2 as f32,
            });
            (tau, Box::new(law), constant(albedo))
        }
        &Inputs::Named {
            ref phase,
            g,
            alpha,
            albedo,
            tau,
        } => {
            let (g, alpha) = (g as f32, alpha as f32);
            let law: Box<dyn Law> = match phase.as_str() {
                "rayleigh" => Box::new(Rayleigh),
                "draine" => Box::new(Draine { g, alpha }),
                "hg" => Box::new(HenyeyGreenstein(g)),
                other => panic!("no phase function is called {other}"),
            };
            (tau, law, constant(albedo))
        }
    })
}

/// Layers of (τ, albedo, g) from the lit side, in a slab of thickness 1.
#[derive(Clone, Debug)]
struct Stack {
    layers: Vec<[f64; 3]>,
    tau: f64,
}

impl Stack {
    /// The layer at a depth.
    fn at(&self, z: f64) -> [f64; 3] {
        let mut depth = z * self.tau;
        for layer in &self.layers {
            depth -= layer[0];
            if depth < 0.0 {
                return *layer;
            }
        }
        self.layers[self.layers.len() - 1]
    }
}

impl Law for Stack {
    fn cosine(&self, at: &Vec3<f32>, draws: &mut Draws) -> f32 {
        HenyeyGreenstein(self.at(at.z.into())[2] as f32).cosine(at, draws)
    }
    fn density(&self, at: &Vec3<f32>, cosine: f32) -> f32 {
        HenyeyGreenstein(self.at(at.z.into())[2] as f32).density(at, cosine)
    }
}

#[test]
fn special_slabs_are_what_they_are() {
    let mut ledger = Ledger::new("slab_matched");
    let mut skipped = Vec::new();
    for slab in slab_matched::load().special {
        let Some((tau, law, albedo)) = filling(&slab) else {
            skipped.push(slab.id);
            continue;
        };
        let walk = Walk::new(UNIT, Closed::new(tau), law);
        let beams = slab
            .mu0
            .iter()
            .zip(&slab.reflectance)
            .zip(&slab.transmittance);
        let beams = beams.map(|((mu, r), t)| (Light::Beam(*mu), *r, *t));
        let (r, t) = (slab.diffuse_reflectance, slab.diffuse_transmittance);
        for (light, r, t) in beams.chain([(Light::Diffuse, r, t)]) {
            let run = Run::new(74, ledger.comparisons as u32, 1 << 16);
            let scores = tally(run, 2, |draws, scores| {
                let mut ray = light.enter(draws);
                let mut weight = 1.0;
                walk.follow(&mut ray, draws, |ray, _| {
                    weight = walk.absorb(weight, albedo(ray.origin.z.into()));
                    true
                });
                scores[usize::from(ray.direction.z > 0.0)] += weight;
            });
            let name = format!("{} {light:?}", slab.id);
            ledger.within(
                format_args!("{name} R"),
                &scores[0],
                r,
                0.0,
                0.0075 * r.max(t),
            );
            ledger.within(
                format_args!("{name} T"),
                &scores[1],
                t,
                0.0,
                0.0075 * r.max(t),
            );
        }
    }
    assert_eq!(skipped, ["ground"], "slabs without a surface");
    ledger.finish(7 * 4 * 2);
}
