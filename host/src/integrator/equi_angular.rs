//! Distances along a ray sampled by how near a light is [Kulla, Fajardo 2012].
//!
//! ```text
//! p(t) = D / ((θ_b − θ_a) (D² + (t − δ)²)),   t = δ + D tan θ,   θ even between θ_a and θ_b
//! ```
//!
//! δ is the place of the ray nearest to the light and D the distance there. In thin fog about a lamp it places scattering where the
//! light is, which free flights seldom do, and cancels the 1/r² of the light.
//!
//! Three strategies find a scattering at distance t whose light comes from a lamp z: a flight that ends at t and
//! samples z there, one whose next direction meets z, and this one. They share by the balance heuristic over
//!
//! ```text
//! σ(t) w · p(z),     σ(t) w · p(ω),     q p(t) · p_lamp(z)
//! ```
//!
//! with the passage w of the segment from ratio tracking ([`Passage`](super::transmit::Passage)), q the choice of the lamp by
//! power. The lamp's own place in p(t) is its middle; what it samples is a point of it.
//!
//! Where a lamp is many mean free paths away little is to be gained: there flights alone do it ([`LIMIT`]), and the
//! decision is one of geometry, the same for all strategies.

use glam::DVec3;

use super::Draws;
use super::scatter::Site;
use super::tracer::Tracer;
use super::transmit::mean;
use super::walk::{Stretch, tap_at};
use crate::bsdf::Transport;
use crate::ray::Ray;
use crate::world::World;

/// Optical depth, by the largest extinction on the ray, from its beginning to the place nearest to the lamp and from there to
/// the lamp, beyond which distances are not sampled by nearness.
const LIMIT: f64 = 6.0;

/// The part of a ray that lies in media, as far as distances are sampled on it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Segment {
    ray: Ray,
    from: f64,
    to: f64,
    /// The largest extinction of the media there [1/length].
    thickest: f64,
}

/// A scattering that a flight found: what else could have found it, per density of what follows.
#[derive(Clone, Copy, Debug)]
pub(super) struct Found {
    pub(super) segment: Segment,
    pub(super) t: f64,
    /// Density of the flight: extinction times passage [1/length].
    pub(super) density: f64,
}

impl Found {
    /// The density of this strategy at the place, with a lamp, over the flight's.
    pub(super) fn ratio(&self, world: &World, lamp: u32) -> f64 {
        self.segment.density(world, lamp, self.t) / self.density
    }
}

impl Segment {
    /// The part of a ray in media, if there is any.
    pub(super) fn new(world: &World, ray: &Ray, stretches: &[Stretch]) -> Option<Self> {
        let (first, last) = (stretches.first()?, stretches.last()?);
        let bound = |stretch: &Stretch| world.thickest.get(stretch.2).copied().unwrap_or(0.0);
        Some(Self {
            ray: *ray,
            from: first.0,
            to: last.1,
            thickest: stretches.iter().map(bound).fold(0.0, f64::max),
        })
    }

    /// Where a lamp is nearest, how near, and the angles of the ends; `None` where it is too far.
    fn angles(&self, centre: DVec3) -> Option<(f64, f64, f64, f64)> {
        let towards = centre - self.ray.origin;
        let nearest = towards.dot(self.ray.direction);
        let apart = (towards - self.ray.direction * nearest).length();
        // On the ray itself the law would be a point.
        let apart = apart.max(1e-6 * towards.length()).max(f64::MIN_POSITIVE);
        let way = nearest.clamp(self.from, self.to) - self.from + apart;
        if way * self.thickest > LIMIT {
            return None;
        }
        let (a, b) = (self.from - nearest, self.to - nearest);
        let low = libm::atan2(a, apart);
        // The difference of two angles, without cancellation.
        let width = libm::atan2((b - a) * apart, apart * apart + a * b);
        (width > 0.0).then_some((nearest, apart, low, width))
    }

    /// The density of a lamp's choice and of a distance [1/length].
    fn density(&self, world: &World, lamp: u32, t: f64) -> f64 {
        let lighting = &world.lighting;
        let choice = lighting.near_choice(lamp);
        let Some(centre) = lighting.centre(lamp).filter(|_| choice > 0.0) else {
            return 0.0;
        };
        self.angles(centre)
            .map_or(0.0, |(nearest, apart, _, width)| {
                let along = t - nearest;
                choice * apart / (width * (apart * apart + along * along))
            })
    }

    /// Light scattered once on this segment, by this strategy, times its share; `None` if none.
    pub(super) fn sample<D: Draws>(
        &self,
        tracer: &mut Tracer<'_>,
        stretches: &[Stretch],
        draws: &mut D,
    ) -> Option<DVec3> {
        let world = tracer.world;
        let lighting = &world.lighting;
        let lamp = lighting.choose_near(draws.one())?;
        let (nearest, apart, low, width) = self.angles(lighting.centre(lamp)?)?;
        let t = nearest + apart * libm::tan(low + width * draws.one());
        let within = |stretch: &&Stretch| stretch.0 <= t && t < stretch.1;
        let medium = stretches.iter().find(within)?.2;
        let place = self.ray.at(t);
        let tap = tap_at(world, medium, place, draws);
        let local = world.media.get(medium)?.local(&world.tables, tap, place);
        let sigma_s = DVec3::from(local.sigma_t) * DVec3::from(local.albedo);
        if sigma_s.max_element() <= 0.0 {
            return None;
        }
        let site = Site::in_medium(place, medium);
        let light = lighting.sample_lamp(lamp, &world.surfaces, place, draws.two())?;
        let from = -self.ray.direction;
        let scattered = site.eval(world, from, light.direction, Transport::Radiance);
        let radiance = sigma_s * scattered * DVec3::from(light.radiance);
        if radiance.max_element() <= 0.0 {
            return None;
        }
        let shadow = tracer.between(&site.anchor, light.anchor.as_ref()?, draws)?;
        let along = tracer.transmit_open(&self.ray, t, draws);
        let density = self.density(world, lamp, t);
        let flight = mean(local.sigma_t) * along.passage;
        let choice = lighting.choice(lamp, place, DVec3::ZERO) * (1.0 - world.glow_choice());
        let found = if light.delta {
            0.0
        } else {
            site.pdf(world, from, light.direction, Transport::Radiance)
        };
        let all = (density + flight * choice) * light.pdf + flight * found;
        Some(radiance * along.weight * shadow.weight / all)
    }
}
