//! Next-event estimation: light that arrives at a place straight from one light, sampled there.

use glam::DVec3;

use super::Draws;
use super::glow::Spot;
use super::scatter::Site;
use super::tracer::Tracer;
use crate::bsdf::Transport;
use crate::light::LightSample;
use crate::ray::Anchor;

/// What was sampled.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Source {
    /// A lamp, a surface, or the sky.
    Lamp(LightSample),
    /// A place of a medium that shines.
    Glow(Spot),
}

/// Light that arrives.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Lit {
    pub(crate) source: Source,
    /// Unit direction to the source.
    pub(crate) direction: DVec3,
    /// Squared distance to it; infinite for light from far away.
    pub(crate) distance_squared: f64,
    /// Radiance scattered to where the path came from, over the density of the sample; no share deducted.
    pub(crate) radiance: DVec3,
    /// Density of the sample, the choice included [1/sr].
    pub(crate) pdf: f64,
    /// What the density has, per density of a direction, if a flight leads to the source instead ([`Passage`]
    /// and, in media, the rate of tentative collisions); zero if none ever does.
    ///
    /// [`Passage`]: super::transmit::Passage
    pub(crate) flown: f64,
    /// Passage of the segment.
    pub(crate) passage: f64,
}

/// Samples one light at a place and asks how much of its light arrives; `None` if none.
///
/// * `from`: unit direction to where the path came from.
pub(crate) fn sample<D: Draws>(
    tracer: &mut Tracer<'_>,
    site: &Site,
    from: DVec3,
    draws: &mut D,
) -> Option<Lit> {
    let world = tracer.world;
    let of_glow = world.glow_choice();
    if of_glow > 0.0 && draws.one() < of_glow {
        return glowing(tracer, site, from, draws);
    }
    if world.lighting.is_empty() {
        return None;
    }
    let u = draws.three();
    let place = site.anchor.point;
    let light = world
        .lighting
        .sample(&world.surfaces, place, site.normal, u)?;
    let scattered = site.eval(world, from, light.direction, Transport::Radiance);
    let radiance = scattered * DVec3::from(light.radiance);
    if radiance.max_element() <= 0.0 {
        return None;
    }
    let (passed, distance_squared) = match &light.anchor {
        Some(anchor) => (
            tracer.between(&site.anchor, anchor, draws)?,
            (anchor.point - place).length_squared(),
        ),
        None => {
            let ray = site.anchor.ray(light.direction);
            (tracer.transmit(&ray, f64::INFINITY, draws)?, f64::INFINITY)
        }
    };
    let pdf = light.pdf * light.choice * (1.0 - of_glow);
    Some(Lit {
        source: Source::Lamp(light),
        direction: light.direction,
        distance_squared,
        radiance: radiance * passed.weight / pdf,
        pdf,
        flown: if light.delta { 0.0 } else { 1.0 },
        passage: passed.passage,
    })
}

/// Samples a place of a medium that shines.
fn glowing<D: Draws>(
    tracer: &mut Tracer<'_>,
    site: &Site,
    from: DVec3,
    draws: &mut D,
) -> Option<Lit> {
    let world = tracer.world;
    let glow = world.glow.as_ref()?;
    let spot = glow.sample(world, draws)?;
    let towards = spot.place - site.anchor.point;
    let distance_squared = towards.length_squared();
    let direction = towards / distance_squared.sqrt();
    if !direction.is_finite() {
        return None;
    }
    let scattered = site.eval(world, from, direction, Transport::Radiance);
    let radiance = scattered * DVec3::from(spot.local.emission);
    if radiance.max_element() <= 0.0 {
        return None;
    }
    let target = Anchor::in_space(spot.place);
    let passed = tracer.between(&site.anchor, &target, draws)?;
    if !tracer.reached(spot.medium) {
        return None;
    }
    let pdf = spot.pdf * glow.choice() * distance_squared;
    Some(Lit {
        source: Source::Glow(spot),
        direction,
        distance_squared,
        radiance: radiance * passed.weight / pdf,
        pdf,
        flown: spot.majorant * passed.passage,
        passage: passed.passage,
    })
}
