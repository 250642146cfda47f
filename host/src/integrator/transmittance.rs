//! Light that arrives without having been scattered: emission and sky, dimmed.
//!
//! ```text
//! L = T(d) L_d + ∫₀ᵈ T(t) σ_a(t) L_e(t) dt
//! ```
//!
//! Nothing is decided. Homogeneous media have closed forms, others are passed by ratio tracking; where a medium shines,
//! its source over σ̄ is scored at each tentative collision with the weight that is left, which is never zero as long as
//! light passes (Algorithm 2 of [Raab, Seibert, Keller 2006], scored at every tentative point).

use glam::DVec3;

use super::path::{Last, escaped, found};
use super::scatter::Site;
use super::tracer::{Tracer, ahead};
use super::walk::{Next, walk};
use super::{Draws, Matter, Sample, Score, Subpath};
use crate::ray::Ray;

/// One estimate for a point of the film.
pub(crate) fn trace<D: Draws>(tracer: &mut Tracer<'_>, film: [f64; 2], draws: &mut D) -> Sample {
    let world = tracer.world;
    draws.vertex(Subpath::Camera, 0);
    let ray = super::camera::ray(world, film, draws);
    let last = Last::certain(ray.origin);
    let mut score = Score::default();
    let (shining, solid) = ahead(world, &ray);
    let t_max = solid.map_or(f64::INFINITY, |hit| hit.t);
    for hit in &shining {
        let radiance = found(world, &last, &ray, hit) * passed(tracer, &ray, hit.t, draws);
        score.add(radiance, Matter::Surface);
    }
    let (weight, glowing) = pass(tracer, &ray, t_max, draws);
    score.add(glowing, Matter::Medium);
    match solid {
        Some(hit) => {
            score.add(weight * found(world, &last, &ray, &hit), Matter::Surface);
            let site = Site::on_surface(world, &hit);
            score.meet(Matter::Surface, &site, hit.t, site.albedo());
        }
        None => score.add(weight * escaped(world, &last, &ray), Matter::Nothing),
    }
    let mut sample = score.sample();
    if solid.is_none() {
        // What a medium keeps back of the sky.
        sample.alpha = 1.0 - weight.element_sum() / 3.0;
    }
    sample
}

fn passed<D: Draws>(tracer: &mut Tracer<'_>, ray: &Ray, t: f64, draws: &mut D) -> DVec3 {
    let passed = tracer.transmit_open(ray, t, draws);
    passed.weight
}

/// What is left of light along the part of a ray up to `t_max`, and what media there add.
fn pass<D: Draws>(tracer: &mut Tracer<'_>, ray: &Ray, t_max: f64, draws: &mut D) -> (DVec3, DVec3) {
    let world = tracer.world;
    let stretches = tracer.stretches(ray, t_max);
    let shines = |medium: usize| world.media.get(medium).is_some_and(|m| m.is_emissive());
    if !stretches.iter().any(|stretch| shines(stretch.2)) {
        return (passed(tracer, ray, t_max, draws), DVec3::ZERO);
    }
    let mut weight = DVec3::ONE;
    let mut radiance = DVec3::ZERO;
    walk(
        world,
        ray,
        &stretches,
        draws,
        &mut tracer.counts,
        |_, tentative| {
            let source = DVec3::from(tentative.local.emission);
            radiance += weight * source / tentative.majorant;
            weight *= DVec3::ONE - DVec3::from(tentative.local.sigma_t) / tentative.majorant;
            if weight == DVec3::ZERO {
                Next::Stop
            } else {
                Next::On
            }
        },
    );
    (weight, radiance)
}
