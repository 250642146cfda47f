//! Bidirectional path tracing [Lafortune, Willems 1996], [Veach 1997], in media without ray marching [Raab, Seibert, Keller
//! 2006].
//!
//! A path from the camera and one from a light are joined in every way; each way counts by its [`weight`]. Paths
//! that reach the camera from the light's side (t = 1) land anywhere on the film: they are *splats*.

mod light_end;
mod subpath;
mod weight;

use glam::DVec3;

use self::light_end::{INV_4PI, LightEnd};
use self::subpath::{Growth, Start, Unwatched, Vertex, grow};
use self::weight::Densities;
use super::next_event::{self, Source};
use super::scatter::{Site, deflected};
use super::tracer::{Tracer, Witness};
use super::{Draws, Matter, Sample, Score, Settings, Subpath, Tentative, camera};
use crate::bsdf::Transport;
use crate::ray::{Anchor, Ray};
use crate::surface::Hit;
use crate::world::World;

/// Light that lands on the film.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Splat {
    /// Where \[pixels\].
    pub(crate) film: [f64; 2],
    /// What it brings to its pixel, if one light path is traced for each pixel of the whole picture.
    pub(crate) radiance: DVec3,
}

/// Room that samples share.
#[derive(Debug, Default)]
pub(crate) struct Workspace {
    eye: Vec<Vertex>,
    light: Vec<Vertex>,
    weigher: Weigher,
}

/// A segment from x₁ to the light.
#[derive(Clone, Copy, Debug)]
struct Leg {
    direction: DVec3,
    distance_squared: f64,
    passage: f64,
}

/// Room for weights.
#[derive(Debug, Default)]
struct Weigher {
    densities: Densities,
    shares: Vec<f64>,
}

impl Weigher {
    /// Enters a path: the vertices of both subpaths, and the squared length of what joins them.
    fn enter(&mut self, light: &[Vertex], eye: &[Vertex], joined: f64) {
        let densities = &mut self.densities;
        densities.clear();
        for vertex in light {
            densities.light.push(vertex.own);
            densities.camera.push(vertex.back);
            densities.connects.push(vertex.connects());
        }
        for vertex in eye.iter().rev() {
            densities.light.push(vertex.back);
            densities.camera.push(vertex.own);
            densities.connects.push(vertex.connects());
        }
        let apart = light.iter().skip(1).map(|vertex| vertex.distance_squared);
        let back = eye.iter().rev().map(|vertex| vertex.distance_squared);
        let all = apart.chain(std::iter::once(joined)).chain(back);
        densities.closeness.extend(all.map(|squared| 1.0 / squared));
    }

    /// Enters what is known of the light end, as seen from x₁ in `direction`.
    fn enter_light(
        &mut self,
        world: &World,
        end: &LightEnd,
        vertex: &Vertex,
        from: &Vertex,
        leg: &Leg,
    ) {
        let &Leg {
            direction,
            distance_squared,
            passage,
        } = leg;
        let densities = &mut self.densities;
        let (emitted, towards) = end.emission(world, -direction);
        densities.emitted = emitted;
        densities.next_event = end.next_event(world, vertex, from, direction, distance_squared);
        densities.delta = end.delta;
        if let Some(second) = densities.light.get_mut(1) {
            *second = from.reached(towards, end.infinite, direction, distance_squared, passage);
        }
    }

    fn weight(&mut self, s: usize, settings: &Settings) -> f64 {
        self.densities
            .weight(s, settings.connection_bound, &mut self.shares)
    }

    /// The weight of a camera path that found a light by itself (s = 0).
    ///
    /// * `eye`: the vertices before the light. `light`: that on it, with the segment that led there.
    fn found(
        &mut self,
        world: &World,
        settings: &Settings,
        eye: &[Vertex],
        end: &LightEnd,
        light: &Vertex,
    ) -> f64 {
        let Some(last) = eye.last().filter(|_| eye.len() > 1) else {
            return 1.0;
        };
        self.enter(&[*light], eye, light.distance_squared);
        if let Some(first) = self.densities.camera.first_mut() {
            *first = light.own;
        }
        let leg = Leg {
            direction: -light.from,
            distance_squared: light.distance_squared,
            passage: light.passage,
        };
        self.enter_light(world, end, light, last, &leg);
        self.weight(0, settings)
    }
}

/// A path from the camera and one from a light, joined. Returns what falls on the given point of the film, and adds
/// the rest to `splats`.
pub(crate) fn trace<D: Draws>(
    tracer: &mut Tracer<'_>,
    settings: &Settings,
    film: [f64; 2],
    draws: &mut D,
    room: &mut Workspace,
    splats: &mut Vec<Splat>,
) -> Sample {
    let world = tracer.world;
    let Workspace {
        eye,
        light,
        weigher,
    } = room;
    eye.clear();
    light.clear();
    draws.vertex(Subpath::Light, 0);
    let source = depart(tracer, settings, light, draws);

    draws.vertex(Subpath::Camera, 0);
    let ray = camera::ray(world, film, draws);
    eye.push(Vertex::end(Anchor::in_space(ray.origin), 1.0, false));
    let start = Start {
        ray,
        throughput: DVec3::ONE,
        pdf: camera::density(world, &ray, 1.0),
        parallel: camera::is_parallel(world),
        transport: Transport::Radiance,
        limit: settings.max_depth.saturating_add(2),
    };
    let mut found = Found {
        world,
        settings,
        score: Score::default(),
        weigher,
    };
    grow(tracer, &start, eye, draws, &mut found);
    let mut score = found.score;
    let first = score.first();
    let scatterings = |s: usize, t: usize| (s + t - 2) as u32;
    let mut join = Join {
        settings,
        eye,
        light,
        source,
        weigher,
    };
    for t in 2..=join.eye.len() {
        if scatterings(1, t) <= settings.max_depth {
            draws.vertex(Subpath::Join, join_number(1, t));
            let radiance = join.next_event(tracer, t, draws);
            score.add_scattered(radiance, first, scatterings(1, t));
        }
    }
    for s in 2..=join.light.len() {
        draws.vertex(Subpath::Join, join_number(s, 1));
        splats.extend(join.reach_camera(tracer, s, draws));
        for t in 2..=join.eye.len() {
            if scatterings(s, t) > settings.max_depth {
                break;
            }
            draws.vertex(Subpath::Join, join_number(s, t));
            let radiance = join.connect(tracer, s, t, draws);
            score.add_scattered(radiance, first, scatterings(s, t));
        }
    }
    score.sample()
}

/// A number for each pair of s and t below 2¹⁶.
fn join_number(s: usize, t: usize) -> u32 {
    ((s as u32) << 16) | (t as u32 & 0xffff)
}

/// Lets light set out.
fn depart<D: Draws>(
    tracer: &mut Tracer<'_>,
    settings: &Settings,
    vertices: &mut Vec<Vertex>,
    draws: &mut D,
) -> Option<LightEnd> {
    let world = tracer.world;
    let of_glow = world.glow_choice();
    let (end, own, start) = if of_glow > 0.0 && draws.one() < of_glow {
        let spot = world.glow.as_ref()?.sample(world, draws)?;
        if !world.is_within(spot.medium, spot.place) {
            return None;
        }
        let end = LightEnd::glow(world, spot.place, spot.pdf, spot.majorant);
        let own = spot.pdf * of_glow;
        let [u, turn] = draws.two();
        let source = DVec3::from(spot.local.emission);
        let start = Start {
            ray: end.anchor.ray(deflected(DVec3::Z, 1.0 - 2.0 * u, turn)),
            throughput: source / (own * INV_4PI),
            pdf: INV_4PI,
            parallel: false,
            transport: Transport::Importance,
            limit: settings.max_depth.saturating_add(1),
        };
        (end, own, start)
    } else {
        let [a, b, c, d, e] = [(); 5].map(|()| draws.one());
        let departure = world.lighting.emit(&world.surfaces, [a, b, c, d, e])?;
        let light = departure.light;
        let infinite = world.lighting.is_infinite(light);
        let choice = departure.choice * (1.0 - of_glow);
        let end = LightEnd {
            anchor: departure.anchor,
            infinite,
            ..LightEnd::lamp(
                light,
                Some(departure.anchor),
                world.lighting.is_delta(light),
            )
        };
        let densities = choice * departure.pdf_position * departure.pdf_direction;
        let (own, pdf) = if infinite {
            (choice * departure.pdf_direction, departure.pdf_position)
        } else {
            (choice * departure.pdf_position, departure.pdf_direction)
        };
        let start = Start {
            ray: departure.anchor.ray(departure.direction),
            throughput: DVec3::from(departure.radiance) * (departure.cosine / densities),
            pdf,
            parallel: infinite,
            transport: Transport::Importance,
            limit: settings.max_depth.saturating_add(1),
        };
        (end, own, start)
    };
    if start.throughput.max_element() <= 0.0 || !start.throughput.is_finite() {
        return None;
    }
    vertices.push(end.vertex(own));
    grow(tracer, &start, vertices, draws, &mut Unwatched);
    Some(end)
}

/// Scores the light that a camera path finds by itself.
struct Found<'a> {
    world: &'a World,
    settings: &'a Settings,
    score: Score,
    weigher: &'a mut Weigher,
}

/// Scores what a flight of a camera path passes.
struct Passing<'b, 'a> {
    found: &'b mut Found<'a>,
    eye: &'b [Vertex],
    ray: &'b Ray,
    pdf: f64,
}

impl Passing<'_, '_> {
    /// The vertex of a light at distance `t`.
    fn vertex(&self, end: &LightEnd, t: f64, passage: f64) -> Vertex {
        let from = -self.ray.direction;
        let mut vertex = Vertex {
            from,
            distance_squared: t * t,
            passage,
            ..end.vertex(0.0)
        };
        let parallel = self.eye.len() == 1 && camera::is_parallel(self.found.world);
        vertex.own = vertex.reached(self.pdf, parallel, from, t * t, passage);
        vertex
    }
}

impl Witness for Passing<'_, '_> {
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
        let glow = world.glow.as_ref();
        let pdf = glow.map_or(0.0, |glow| glow.pdf(tentative.medium, tentative.tap));
        let weight = if pdf > 0.0 {
            let end = LightEnd::glow(world, tentative.place, pdf, tentative.majorant);
            let light = self.vertex(&end, tentative.t, passage());
            let Found {
                settings, weigher, ..
            } = &mut *self.found;
            weigher.found(world, settings, self.eye, &end, &light)
        } else {
            1.0
        };
        let radiance = throughput * source * (weight / tentative.majorant);
        let scatterings = self.eye.len() as u32 - 1;
        self.found
            .score
            .add_scattered(radiance, Matter::Medium, scatterings);
    }

    fn shining(&mut self, _: &World, hit: &Hit, throughput: DVec3, passage: &dyn Fn() -> f64) {
        let end = LightEnd::lamp(0, Some(hit.anchor), false);
        let light = self.vertex(&end, hit.t, passage());
        self.found.emitted(self.eye, hit, &light, throughput);
    }
}

impl Found<'_> {
    fn emitted(&mut self, eye: &[Vertex], hit: &Hit, light: &Vertex, throughput: DVec3) {
        let Some(emitter) = hit.emitter else {
            return;
        };
        let world = self.world;
        let radiance = DVec3::from(world.lighting.hit_radiance(hit, -light.from));
        if radiance == DVec3::ZERO {
            return;
        }
        let index = world.lighting.first_emitter() + emitter;
        let end = LightEnd::lamp(index, Some(hit.anchor), false);
        let light = Vertex { end: 1.0, ..*light };
        let weight = self.weigher.found(world, self.settings, eye, &end, &light);
        let scatterings = eye.len() as u32 - 1;
        let radiance = throughput * radiance * weight;
        self.score
            .add_scattered(radiance, Matter::Surface, scatterings);
    }
}

impl Growth for Found<'_> {
    fn flight<'b>(
        &'b mut self,
        vertices: &'b [Vertex],
        ray: &'b Ray,
        pdf: f64,
    ) -> impl Witness + 'b {
        Passing {
            found: self,
            eye: vertices,
            ray,
            pdf,
        }
    }

    fn surface(&mut self, vertices: &[Vertex], hit: &Hit, _: &Ray) {
        if let [eye @ .., light] = vertices {
            self.emitted(eye, hit, light, light.throughput);
            let site = light.site.as_ref();
            if let Some(site) = site {
                let distance = light.distance_squared.sqrt();
                self.score
                    .meet(Matter::Surface, site, distance, site.albedo());
            }
        }
    }

    fn collision(&mut self, vertices: &[Vertex], albedo: DVec3) {
        if let Some(vertex) = vertices.last()
            && let Some(site) = &vertex.site
        {
            let distance = vertex.distance_squared.sqrt();
            self.score.meet(Matter::Medium, site, distance, albedo);
        }
    }

    fn escape(
        &mut self,
        vertices: &[Vertex],
        throughput: DVec3,
        ray: &Ray,
        pdf: f64,
        passage: f64,
    ) {
        let world = self.world;
        for (index, radiance, _) in world.lighting.escapes(ray.direction) {
            let end = LightEnd::lamp(index, None, false);
            let light = Vertex {
                from: -ray.direction,
                distance_squared: f64::INFINITY,
                passage,
                ..end.vertex(pdf)
            };
            let weight = self
                .weigher
                .found(world, self.settings, vertices, &end, &light);
            let radiance = throughput * DVec3::from(radiance) * weight;
            let scatterings = vertices.len() as u32 - 1;
            self.score
                .add_scattered(radiance, Matter::Nothing, scatterings);
        }
    }
}

/// Joins the two subpaths.
struct Join<'a> {
    settings: &'a Settings,
    eye: &'a [Vertex],
    light: &'a [Vertex],
    source: Option<LightEnd>,
    weigher: &'a mut Weigher,
}

impl Join<'_> {
    /// The first `t` vertices of the camera path with a light sampled from the last of them (s = 1).
    fn next_event<D: Draws>(&mut self, tracer: &mut Tracer<'_>, t: usize, draws: &mut D) -> DVec3 {
        let world = tracer.world;
        let Some((eye, last, site)) = upto(self.eye, t) else {
            return DVec3::ZERO;
        };
        let Some(lit) = next_event::sample(tracer, site, last.from, draws) else {
            return DVec3::ZERO;
        };
        let end = match &lit.source {
            Source::Lamp(lamp) => LightEnd::lamp(lamp.light, lamp.anchor, lamp.delta),
            Source::Glow(spot) => LightEnd::glow(world, spot.place, spot.pdf, spot.majorant),
        };
        let light = end.vertex(0.0);
        let (direction, squared) = (lit.direction, lit.distance_squared);
        self.weigher.enter(&[light], eye, squared);
        let forth = site.pdf(world, last.from, direction, Transport::Radiance);
        let back = site.pdf(world, direction, last.from, Transport::Importance);
        let densities = &mut self.weigher.densities;
        densities.camera[0] = if end.delta {
            0.0
        } else {
            light.arrival(forth, direction, squared, lit.passage)
        };
        leads_back(densities, 2, last, eye, back);
        let leg = Leg {
            direction,
            distance_squared: squared,
            passage: lit.passage,
        };
        self.weigher.enter_light(world, &end, &light, last, &leg);
        last.throughput * lit.radiance * self.weigher.weight(1, self.settings)
    }

    /// The first `s` vertices of the light path with the camera (t = 1).
    fn reach_camera<D: Draws>(
        &mut self,
        tracer: &mut Tracer<'_>,
        s: usize,
        draws: &mut D,
    ) -> Option<Splat> {
        let world = tracer.world;
        let (light, last, site) = upto(self.light, s)?;
        if site.is_specular() {
            return None;
        }
        let sight = camera::sight(world, last.anchor.point, draws)?;
        let direction = -sight.direction;
        let scattered = site.eval(world, last.from, direction, Transport::Importance);
        let radiance = last.throughput * scattered * sight.density;
        if radiance.max_element() <= 0.0 {
            return None;
        }
        let lens = Anchor::in_space(sight.origin);
        let passed = tracer.between(&last.anchor, &lens, draws)?;
        let squared = (sight.origin - last.anchor.point).length_squared();
        self.weigher.enter(light, &self.eye[..1], squared);
        let back = site.pdf(world, direction, last.from, Transport::Radiance);
        let densities = &mut self.weigher.densities;
        densities.camera[s - 1] = sight.density * last.across(direction) * passed.passage;
        let before = &light[s - 2];
        densities.camera[s - 2] =
            before.arrival(back, last.from, last.distance_squared, last.passage);
        self.enter_source(world, s);
        let weight = self.weigher.weight(s, self.settings);
        Some(Splat {
            film: sight.film,
            radiance: radiance * passed.weight * weight,
        })
    }

    /// The first `s` vertices of the light path with the first `t` of the camera path, both at least two.
    fn connect<D: Draws>(
        &mut self,
        tracer: &mut Tracer<'_>,
        s: usize,
        t: usize,
        draws: &mut D,
    ) -> DVec3 {
        let world = tracer.world;
        let (Some((light, y, y_site)), Some((eye, z, z_site))) =
            (upto(self.light, s), upto(self.eye, t))
        else {
            return DVec3::ZERO;
        };
        if y_site.is_specular() || z_site.is_specular() {
            return DVec3::ZERO;
        }
        let towards = y.anchor.point - z.anchor.point;
        let squared = towards.length_squared();
        let direction = towards / squared.sqrt();
        if !direction.is_finite() {
            return DVec3::ZERO;
        }
        let scattered = z_site.eval(world, z.from, direction, Transport::Radiance)
            * y_site.eval(world, y.from, -direction, Transport::Importance);
        let radiance = z.throughput * scattered * y.throughput / squared;
        if !radiance.is_finite() || radiance.max_element() <= 0.0 {
            return DVec3::ZERO;
        }
        let Some(passed) = tracer.between(&z.anchor, &y.anchor, draws) else {
            return DVec3::ZERO;
        };
        let passage = passed.passage;
        self.weigher.enter(light, eye, squared);
        let pdf = |site: &Site, from, to, transport| site.pdf(world, from, to, transport);
        let to_y = pdf(z_site, z.from, direction, Transport::Radiance);
        let beyond_y = pdf(y_site, -direction, y.from, Transport::Radiance);
        let to_z = pdf(y_site, y.from, -direction, Transport::Importance);
        let beyond_z = pdf(z_site, direction, z.from, Transport::Importance);
        let densities = &mut self.weigher.densities;
        densities.camera[s - 1] = y.arrival(to_y, direction, squared, passage);
        let before = &light[s - 2];
        densities.camera[s - 2] = before.arrival(beyond_y, y.from, y.distance_squared, y.passage);
        densities.light[s] = z.arrival(to_z, direction, squared, passage);
        leads_back(densities, s + 1, z, eye, beyond_z);
        self.enter_source(world, s);
        radiance * passed.weight * self.weigher.weight(s, self.settings)
    }

    /// Enters the densities of the light end that the light path set out from.
    fn enter_source(&mut self, world: &World, s: usize) {
        let (Some(end), [first, second, ..]) = (&self.source, &self.light[..s]) else {
            return;
        };
        let densities = &mut self.weigher.densities;
        densities.emitted = first.own;
        densities.next_event =
            end.next_event(world, first, second, second.from, second.distance_squared);
        densities.delta = end.delta;
        if end.delta {
            densities.camera[0] = 0.0;
        }
    }
}

/// The first `n` vertices of a subpath, at least two, and the last of them with what scatters there.
fn upto(vertices: &[Vertex], n: usize) -> Option<(&[Vertex], &Vertex, &Site)> {
    let vertices = vertices.get(..n).filter(|_| n >= 2)?;
    let last = vertices.last()?;
    Some((vertices, last, last.site.as_ref()?))
}

/// Enters the density with which light scattered at `last` reaches the camera vertex before it, number `index` of the
/// path.
fn leads_back(densities: &mut Densities, index: usize, last: &Vertex, eye: &[Vertex], pdf: f64) {
    if let [.., before, _] = eye
        && let Some(density) = densities.light.get_mut(index)
    {
        *density = before.arrival(pdf, last.from, last.distance_squared, last.passage);
    }
}
