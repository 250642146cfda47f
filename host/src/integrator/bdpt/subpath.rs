//! Subpaths: walks from the camera and from lights, with the densities that weights need.

use glam::DVec3;
use woodcock_core::collision;

use crate::bsdf::Transport;
use crate::integrator::scatter::Site;
use crate::integrator::tracer::{End, Tracer, Witness, end_density};
use crate::integrator::{Draws, Subpath};
use crate::ray::{Anchor, Ray};
use crate::surface::Hit;

/// Below this throughput a subpath plays roulette, and survives with it.
const ROULETTE: f64 = 0.25;
/// From this many vertices on every subpath plays another roulette, whatever it carries: joining two of n vertices takes n²
/// shadow rays. It survives each with this chance.
const LONG: u32 = 32;
const SURVIVAL: f64 = 0.95;

/// A vertex of a subpath, and the segment that leads to it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Vertex {
    /// Where.
    pub(super) anchor: Anchor,
    /// What scatters there; `None` at the ends of a path.
    pub(super) site: Option<Site>,
    /// What the subpath brings here over the density that it was sampled with, albedo of a particle included.
    pub(super) throughput: DVec3,
    /// Unit direction to the previous vertex.
    pub(super) from: DVec3,
    /// Squared distance to it.
    pub(super) distance_squared: f64,
    /// Passage of the segment from it.
    pub(super) passage: f64,
    /// What a flight that ends here has as density: extinction of a particle, one on surfaces.
    pub(super) end: f64,
    /// Density of this vertex as its own subpath samples it, per area or volume (of a light far away, per solid angle).
    pub(super) own: f64,
    /// Density as a subpath from the other side would sample it, if it had the vertices beyond.
    pub(super) back: f64,
    /// Far away: densities of it are those of directions.
    pub(super) infinite: bool,
}

impl Vertex {
    /// The end of a path.
    pub(super) fn end(anchor: Anchor, own: f64, infinite: bool) -> Self {
        Self {
            anchor,
            site: None,
            throughput: DVec3::ONE,
            from: DVec3::ZERO,
            distance_squared: 0.0,
            passage: 1.0,
            end: 1.0,
            own,
            back: 0.0,
            infinite,
        }
    }

    /// Whether a connection to it brings light.
    pub(super) fn connects(&self) -> bool {
        self.site.as_ref().is_none_or(|site| !site.is_specular())
    }

    /// The density of this vertex where a direction of density `pdf` leads here along a segment.
    ///
    /// * `direction`: of the segment, either way.
    pub(super) fn arrival(
        &self,
        pdf: f64,
        direction: DVec3,
        distance_squared: f64,
        passage: f64,
    ) -> f64 {
        if self.infinite {
            return pdf;
        }
        pdf * self.across(direction) * passage / distance_squared
    }

    /// The same, or where `parallel` light of density `pdf` per area across leads here, which no distance dilutes.
    pub(super) fn reached(
        &self,
        pdf: f64,
        parallel: bool,
        direction: DVec3,
        distance_squared: f64,
        passage: f64,
    ) -> f64 {
        if parallel {
            pdf * self.across(direction) * passage
        } else {
            self.arrival(pdf, direction, distance_squared, passage)
        }
    }

    /// What turns a density per area that faces `direction` into this vertex's own measure.
    pub(super) fn across(&self, direction: DVec3) -> f64 {
        let normal = self.anchor.normal;
        let cosine = if normal == DVec3::ZERO {
            1.0
        } else {
            normal.dot(direction).abs()
        };
        cosine * self.end
    }
}

/// Who watches a subpath grow.
pub(super) trait Growth {
    /// A watcher of the next flight, which leaves the last of `vertices`.
    ///
    /// * `pdf`: density of its direction [1/sr].
    fn flight<'b>(
        &'b mut self,
        vertices: &'b [Vertex],
        ray: &'b Ray,
        pdf: f64,
    ) -> impl Witness + 'b;
    /// The flight ended on a surface.
    fn surface(&mut self, vertices: &[Vertex], hit: &Hit, ray: &Ray);
    /// The flight ended at a particle of this albedo.
    fn collision(&mut self, vertices: &[Vertex], albedo: DVec3);
    /// The flight escaped with a direction of this density.
    fn escape(&mut self, vertices: &[Vertex], throughput: DVec3, ray: &Ray, pdf: f64, passage: f64);
}

/// How a subpath begins, and how it goes on.
#[derive(Clone, Copy, Debug)]
pub(super) struct Start {
    /// The first ray.
    pub(super) ray: Ray,
    /// What it carries.
    pub(super) throughput: DVec3,
    /// Density of its direction [1/sr]; of parallel light and cameras, of its place per area across.
    pub(super) pdf: f64,
    /// `pdf` is per area across, and no distance dilutes it.
    pub(super) parallel: bool,
    /// What is carried.
    pub(super) transport: Transport,
    /// Most vertices, the first included.
    pub(super) limit: u32,
}

/// Lets a subpath grow from its first vertex.
pub(super) fn grow<D: Draws>(
    tracer: &mut Tracer<'_>,
    start: &Start,
    vertices: &mut Vec<Vertex>,
    draws: &mut D,
    growth: &mut impl Growth,
) {
    let world = tracer.world;
    let (subpath, opposite) = match start.transport {
        Transport::Radiance => (Subpath::Camera, Transport::Importance),
        Transport::Importance => (Subpath::Light, Transport::Radiance),
    };
    let mut ray = start.ray;
    let mut throughput = start.throughput;
    let mut pdf = start.pdf;
    let mut parallel = start.parallel;
    for number in 1..start.limit {
        draws.vertex(subpath, number);
        let flight = {
            let mut witness = growth.flight(vertices, &ray, pdf);
            tracer.fly(&ray, &mut throughput, draws, &mut witness)
        };
        let (site, t, albedo) = match &flight.end {
            End::Escape => {
                growth.escape(vertices, throughput, &ray, pdf, flight.passage);
                return;
            }
            End::Surface(hit) => (Site::on_surface(world, hit), hit.t, DVec3::ONE),
            End::Collision { t, medium, local } => {
                let site = Site::in_medium(ray.at(*t), *medium);
                (site, *t, DVec3::from(local.albedo))
            }
        };
        let from = -ray.direction;
        let mut vertex = Vertex {
            site: Some(site),
            throughput: throughput * albedo,
            from,
            distance_squared: t * t,
            passage: flight.passage,
            end: end_density(&flight.end),
            ..Vertex::end(site.anchor, 0.0, false)
        };
        vertex.own = vertex.reached(pdf, parallel, from, t * t, flight.passage);
        vertices.push(vertex);
        match &flight.end {
            // Light is met before anything scatters.
            End::Surface(hit) => growth.surface(vertices, hit, &ray),
            _ => growth.collision(vertices, albedo),
        }
        throughput *= albedo;
        let largest = throughput.max_element();
        if largest <= 0.0 || number + 1 == start.limit {
            return;
        }
        let mut factor = collision::roulette(largest, ROULETTE, draws, true);
        if number >= LONG {
            let survives = draws.one() < SURVIVAL;
            factor *= if survives { 1.0 / SURVIVAL } else { 0.0 };
        }
        if factor == 0.0 {
            return;
        }
        let Some(onward) = site.sample(world, from, start.transport, draws) else {
            return;
        };
        throughput *= onward.weight * factor;
        if throughput.max_element() <= 0.0 {
            return;
        }
        let reverse = if onward.specular {
            onward.pdf
        } else {
            site.pdf(world, onward.direction, from, opposite)
        };
        let [.., previous, _] = vertices.as_mut_slice() else {
            return;
        };
        previous.back = previous.arrival(reverse, from, t * t, flight.passage);
        pdf = onward.pdf;
        parallel = false;
        ray = site.anchor.ray(onward.direction);
    }
}

/// Watches nothing: subpaths from lights.
#[derive(Debug)]
pub(super) struct Unwatched;

impl Growth for Unwatched {
    fn flight<'b>(&'b mut self, _: &'b [Vertex], _: &'b Ray, _: f64) -> impl Witness + 'b {
        crate::integrator::tracer::Unseen
    }
    fn surface(&mut self, _: &[Vertex], _: &Hit, _: &Ray) {}
    fn collision(&mut self, _: &[Vertex], _: DVec3) {}
    fn escape(&mut self, _: &[Vertex], _: DVec3, _: &Ray, _: f64, _: f64) {}
}
