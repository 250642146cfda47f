//! Path tracing with next-event estimation, on surfaces and in media.
//!
//! At each vertex one light is sampled; what is sampled and what the path finds by itself share their common
//! contributions by the balance heuristic over *directional* densities, so that any unbiased estimate of transmittance
//! serves. Media that shine are scored at every tentative collision, not only at those that turn out real.

use glam::DVec3;
use woodcock_core::collision;
use woodcock_core::stream::Stream;

use super::draws::Given;
use super::equi_angular::{self, Segment};
use super::next_event::{self, Source};
use super::scatter::Site;
use super::tracer::{End, Tracer, Witness};
use super::transmit::mean;
use super::walk::Tentative;
use super::{Draws, Matter, Sample, Score, Settings, Subpath};
use crate::bsdf::Transport;
use crate::ray::Ray;
use crate::surface::Hit;
use crate::world::{Feature, World};

/// Below this throughput a path plays roulette, and survives with it.
const ROULETTE: f64 = 0.25;
/// From this many scatterings on every path plays another roulette, whatever it carries: between white walls it would never
/// end. It survives each with this chance.
const LONG: u32 = 1 << 16;
const SURVIVAL: f64 = 1.0 - 1.0 / 4096.0;

/// Where the present ray began, as light sampling there would compete with it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Last {
    point: DVec3,
    normal: DVec3,
    /// Density of the ray's direction [1/sr]; infinite where nothing competes.
    pdf: f64,
    /// How the place itself was found, if by a flight that competes with sampling by nearness.
    found: Option<equi_angular::Found>,
}

impl Last {
    /// A camera: nothing competes.
    pub(super) fn certain(point: DVec3) -> Self {
        Self {
            point,
            normal: DVec3::ZERO,
            pdf: f64::INFINITY,
            found: None,
        }
    }

    /// The share of what was found with the ray's density, against that of light sampling.
    fn share(&self, competing: f64) -> f64 {
        if self.pdf == f64::INFINITY {
            1.0
        } else {
            self.pdf / (self.pdf + competing)
        }
    }
}

/// Scores what a flight passes.
struct Scoring<'a> {
    score: &'a mut Score,
    last: &'a Last,
    ray: &'a Ray,
    /// Whether distances compete.
    near: bool,
}

impl Witness for Scoring<'_> {
    fn wants_passage(&self) -> bool {
        self.near
    }

    fn tentative(
        &mut self,
        world: &World,
        tentative: &Tentative,
        throughput: DVec3,
        passage: &dyn Fn() -> f64,
    ) {
        let source = DVec3::from(tentative.local.emission);
        if source == DVec3::ZERO {
            return;
        }
        let share = match &world.glow {
            Some(glow) if self.last.pdf != f64::INFINITY => {
                // The same place as sampled for its light: densities per volume, passage included in both.
                let along = self.last.pdf * tentative.majorant * passage();
                let distance_squared = (tentative.place - self.last.point).length_squared();
                let competing = glow.choice() * glow.pdf(tentative.medium, tentative.tap);
                along / (along + competing * distance_squared)
            }
            _ => 1.0,
        };
        let radiance = throughput * source * (share / tentative.majorant);
        self.score.add(radiance, Matter::Medium);
    }

    fn shining(&mut self, world: &World, hit: &Hit, throughput: DVec3, _: &dyn Fn() -> f64) {
        let radiance = throughput * found(world, self.last, self.ray, hit);
        self.score.add(radiance, Matter::Surface);
    }
}

/// Radiance of a surface that a ray found, times its share.
pub(super) fn found(world: &World, last: &Last, ray: &Ray, hit: &Hit) -> DVec3 {
    let lighting = &world.lighting;
    let radiance = DVec3::from(lighting.hit_radiance(hit, ray.direction));
    if radiance == DVec3::ZERO || last.pdf == f64::INFINITY {
        return radiance;
    }
    let surfaces = &world.surfaces;
    let mut competing = lighting.hit_pdf(surfaces, last.point, last.normal, hit);
    competing *= 1.0 - world.glow_choice();
    if let (Some(found), Some(emitter)) = (&last.found, hit.emitter) {
        let pdf = surfaces.emitter_pdf(emitter, last.point, &hit.anchor);
        competing += found.ratio(world, lighting.first_emitter() + emitter) * pdf;
    }
    radiance * last.share(competing)
}

/// Radiance that arrives from far away along a ray, times its share.
pub(super) fn escaped(world: &World, last: &Last, ray: &Ray) -> DVec3 {
    let lighting = &world.lighting;
    let escapes = lighting.escapes(ray.direction);
    escapes
        .map(|(light, radiance, pdf)| {
            let competing = pdf * lighting.choice(light, last.point, last.normal);
            DVec3::from(radiance) * last.share(competing * (1.0 - world.glow_choice()))
        })
        .sum()
}

/// The mean of paths through a point of the film, which share their camera ray.
///
/// The first free flights of `settings.split` paths begin with an even comb of numbers with one random offset: Algorithm 2 of
/// [Raab, Seibert, Keller 2006], with whole paths for its scores.
pub(crate) fn trace<D: Draws>(
    tracer: &mut Tracer<'_>,
    settings: &Settings,
    film: [f64; 2],
    draws: &mut D,
) -> Sample {
    draws.vertex(Subpath::Camera, 0);
    let ray = super::camera::ray(tracer.world, film, draws);
    let teeth = settings.split;
    if teeth <= 1 {
        return follow(tracer, settings, ray, None, draws);
    }
    let offset = u64::from(Stream::<f64>::next_word(draws, true).0);
    let mut sum = Sample::default();
    for tooth in 0..u64::from(teeth) {
        let word = ((tooth << 32) + offset) / u64::from(teeth);
        let sample = follow(tracer, settings, ray, Some(word as u32), draws);
        sum.add(&sample, 1.0 / f64::from(teeth));
    }
    sum
}

/// One path along a camera ray, its first flight beginning with a given number, if any.
fn follow<D: Draws>(
    tracer: &mut Tracer<'_>,
    settings: &Settings,
    mut ray: Ray,
    first: Option<u32>,
    draws: &mut D,
) -> Sample {
    let world = tracer.world;
    let mut score = Score::default();
    let mut throughput = DVec3::ONE;
    let mut last = Last::certain(ray.origin);
    let near = world.needs.runs(Feature::EquiAngular);
    for depth in 0.. {
        let mut scoring = Scoring {
            score: &mut score,
            last: &last,
            ray: &ray,
            near,
        };
        draws.vertex(Subpath::Camera, depth + 1);
        let before = throughput;
        let flight = match first {
            Some(word) if depth == 0 => {
                let mut given = Given::new(word, draws);
                tracer.fly(&ray, &mut throughput, &mut given, &mut scoring)
            }
            _ => tracer.fly(&ray, &mut throughput, draws, &mut scoring),
        };
        let segment = if near && depth < settings.max_depth {
            near_lamps(tracer, &ray, before, draws, &mut score)
        } else {
            None
        };
        let mut found_by_flight = None;
        let (site, albedo) = match flight.end {
            End::Escape => {
                score.add(throughput * escaped(world, &last, &ray), Matter::Nothing);
                break;
            }
            End::Surface(hit) => {
                score.add(
                    throughput * found(world, &last, &ray, &hit),
                    Matter::Surface,
                );
                let site = Site::on_surface(world, &hit);
                score.meet(Matter::Surface, &site, hit.t, site.albedo());
                (site, None)
            }
            End::Collision { t, medium, local } => {
                let site = Site::in_medium(ray.at(t), medium);
                let albedo = DVec3::from(local.albedo);
                score.meet(Matter::Medium, &site, t, albedo);
                found_by_flight = segment.map(|segment| equi_angular::Found {
                    segment,
                    t,
                    density: mean(local.sigma_t) * flight.passage,
                });
                (site, Some(albedo))
            }
        };
        if depth == settings.max_depth {
            break;
        }
        if let Some(albedo) = albedo {
            throughput *= albedo;
        }
        if !survives(&mut throughput, depth, draws) {
            break;
        }
        score.scatter();
        let from = -ray.direction;
        if !site.is_specular()
            && let Some(lit) = next_event::sample(tracer, &site, from, draws)
        {
            let found = site.pdf(world, from, lit.direction, Transport::Radiance) * lit.flown;
            let near = match (&found_by_flight, &lit.source) {
                (Some(found), Source::Lamp(lamp)) => found.ratio(world, lamp.light) * lamp.pdf,
                _ => 0.0,
            };
            let share = lit.pdf / (lit.pdf + found + near);
            let first = score.first();
            score.add(throughput * lit.radiance * share, first);
        }
        let Some(onward) = site.sample(world, from, Transport::Radiance, draws) else {
            break;
        };
        throughput *= onward.weight;
        if throughput.max_element() <= 0.0 {
            break;
        }
        ray = site.anchor.ray(onward.direction);
        last = Last {
            point: site.anchor.point,
            normal: site.normal,
            pdf: if onward.specular {
                f64::INFINITY
            } else {
                onward.pdf
            },
            found: found_by_flight,
        };
    }
    score.sample()
}

/// Scores light of lamps that is scattered once on the stretch of a ray that was flown last, where nearness is worth
/// sampling; then others need to know.
fn near_lamps<D: Draws>(
    tracer: &mut Tracer<'_>,
    ray: &Ray,
    throughput: DVec3,
    draws: &mut D,
    score: &mut Score,
) -> Option<Segment> {
    let stretches = std::mem::take(&mut tracer.stretches);
    let segment = Segment::new(tracer.world, ray, &stretches);
    if let Some(radiance) = segment.and_then(|s| s.sample(tracer, &stretches, draws)) {
        score.add_scattered(
            throughput * radiance,
            Matter::Medium,
            score.scatterings() + 1,
        );
    }
    tracer.stretches = stretches;
    segment
}

/// Roulette on throughput times albedo.
fn survives(throughput: &mut DVec3, depth: u32, draws: &mut impl Draws) -> bool {
    if depth >= LONG {
        if draws.one() >= SURVIVAL {
            return false;
        }
        *throughput /= SURVIVAL;
    }
    let largest = throughput.max_element();
    if largest <= 0.0 {
        return false;
    }
    let factor = collision::roulette(largest, ROULETTE, draws, true);
    *throughput *= factor;
    factor > 0.0
}
