//! Paths in a room, one a lane, and the step that all of them take at once.

use core::f32::consts::PI;

use super::lamp::{self, Seen};
use super::piece::Spot;
use super::{Fog, Room};
use crate::collision;
use crate::path::{Counts, PathSample};
use crate::phase::henyey_greenstein;
use crate::ray::{FAR, Ray};
use crate::real::{Mask, Real, Word};
use crate::stream::KeyedStream;
use crate::transmittance::analytic;
use crate::vec3::Vec3;

/// Below this throughput a path plays roulette, and survives with it.
const ROULETTE: f32 = 0.25;
/// A density that no competing strategy comes near.
const CERTAIN: f32 = 1e30;
/// No piece.
const NONE: u32 = 1 << 30;

/// A path in each lane.
#[derive(Clone, Debug)]
pub struct Walks<R: Real, S> {
    stream: S,
    ray: Ray<R>,
    throughput: Vec3<R>,
    radiance: Vec3<R>,
    /// Density with which the ray's direction was sampled [1/sr].
    pdf: R,
    /// The ball that the ray begins on.
    ball: R::Word,
    depth: R::Word,
    running: R::Mask,
    touched: R::Mask,
    counts: Counts,
}

/// Where a path changes direction.
#[derive(Clone, Copy, Debug)]
struct Site<R: Real> {
    /// Where rays that leave begin.
    origin: Vec3<R>,
    /// The ball that they leave.
    ball: R::Word,
    /// On a piece the unit normal on the side that the path came from; in fog the direction of travel.
    axis: Vec3<R>,
    in_fog: R::Mask,
    g: f32,
}

impl<R: Real> Site<R> {
    /// What of light from a direction goes on to where the path came from, over the reflectance or the albedo [1/sr]; also
    /// the density of [`sample`](Self::sample): on pieces cos θ / π, in fog the phase function.
    #[inline(always)]
    fn value(&self, direction: Vec3<R>) -> R {
        let cosine = self.axis.dot(direction);
        let mut value = cosine.max(R::zero()) * R::splat(1.0 / PI);
        if self.in_fog.any() {
            let one = R::one();
            let bounded = cosine.max(-one).min(one);
            let phase = henyey_greenstein::eval(bounded, R::splat(self.g));
            value = R::select(self.in_fog, phase, value);
        }
        value
    }

    /// A direction at two uniform numbers, and its density.
    #[inline(always)]
    fn sample(&self, u: R, turn: R) -> (Vec3<R>, R) {
        let mut cosine = (R::one() - u).sqrt();
        if self.in_fog.any() {
            let scattered = henyey_greenstein::sample(u, R::splat(self.g));
            cosine = R::select(self.in_fog, scattered, cosine);
        }
        let direction = self.axis.deflected(cosine, turn);
        (direction, self.value(direction))
    }
}

impl Fog {
    /// The length of the part [0, `t`) of rays that lies in the fog, and where it begins.
    #[inline(always)]
    fn within<R: Real>(&self, ray: &Ray<R>, t: R) -> (R, R) {
        let interval = self.region.clip(ray);
        let length = interval.t1.min(t) - interval.t0;
        (length.max(R::zero()), interval.t0)
    }
}

impl Room<'_> {
    /// The nearest piece on each ray, where it is met, and whether any is.
    #[inline(always)]
    fn nearest<R: Real>(&self, ray: &Ray<R>, ball: R::Word) -> (R, R::Word) {
        let mut t = R::splat(FAR);
        let mut piece = R::Word::splat(NONE);
        let mut number = 0;
        let mut enter = |(at, met): (R, R::Mask), t: &mut R| {
            *t = R::select(met, at, *t);
            piece = R::Word::select(met, R::Word::splat(number), piece);
            number += 1;
        };
        for flat in self.flats {
            enter(flat.meet(ray, t), &mut t);
        }
        for (index, shape) in (self.flats.len() as u32..).zip(self.balls) {
            let on_it = ball.eq(R::Word::splat(index));
            enter(shape.meet(ray, t, on_it), &mut t);
        }
        (t, piece)
    }

    /// Whether any piece lies at 0 < t < `t_max`.
    #[inline(always)]
    fn occluded<R: Real>(&self, ray: &Ray<R>, ball: R::Word, t_max: R) -> R::Mask {
        let mut occluded = R::Mask::splat(false);
        for flat in self.flats {
            occluded = occluded | flat.meet(ray, t_max).1;
        }
        for (index, shape) in (self.flats.len() as u32..).zip(self.balls) {
            let on_it = ball.eq(R::Word::splat(index));
            occluded = occluded | shape.meet(ray, t_max, on_it).1;
        }
        occluded
    }
}

impl<R: Real, S: KeyedStream<R>> Walks<R, S> {
    /// No path in any lane.
    pub fn idle() -> Self {
        let zero = Vec3::uniform(0.0);
        let none = R::Mask::splat(false);
        Self {
            stream: S::idle(),
            ray: Ray {
                origin: zero,
                direction: Vec3::splat([0.0, 0.0, 1.0]),
            },
            throughput: zero,
            radiance: zero,
            pdf: R::zero(),
            ball: R::Word::splat(NONE),
            depth: R::Word::splat(0),
            running: none,
            touched: none,
            counts: Counts::default(),
        }
    }

    /// The lanes with an unfinished path.
    #[inline(always)]
    pub fn running(&self) -> R::Mask {
        self.running
    }

    /// The streams, to be given new keys before a launch.
    #[inline(always)]
    pub fn stream(&mut self) -> &mut S {
        &mut self.stream
    }

    /// What has been done so far.
    pub fn counts(&self) -> &Counts {
        &self.counts
    }

    /// What the path of a finished lane brings.
    #[inline]
    pub fn sample(&self, lane: usize) -> PathSample {
        PathSample {
            radiance: self.radiance.lane(lane),
            alpha: f32::from(u8::from(self.touched.lane(lane))),
        }
    }

    /// Begins paths in the given lanes, whose streams have been given their keys.
    ///
    /// * `x`, `y`: column and row of each path's pixel.
    #[inline(always)]
    pub fn launch(&mut self, room: &Room<'_>, x: R, y: R, lanes: R::Mask) {
        let ray = room.camera.ray(x, y, &mut self.stream, lanes);
        self.ray = Ray::select(lanes, &ray, &self.ray);
        self.throughput = Vec3::select(lanes, Vec3::uniform(1.0), self.throughput);
        self.radiance = Vec3::select(lanes, Vec3::uniform(0.0), self.radiance);
        self.pdf = R::select(lanes, R::splat(CERTAIN), self.pdf);
        self.ball = R::Word::select(lanes, R::Word::splat(NONE), self.ball);
        self.depth = R::Word::select(lanes, R::Word::splat(0), self.depth);
        self.touched = self.touched.and_not(lanes);
        self.running = self.running | lanes;
        self.counts.paths += u64::from(lanes.count());
    }

    /// Adds what the lanes of a mask see, dimmed by their throughput.
    #[inline(always)]
    fn score(&mut self, lanes: R::Mask, seen: Vec3<R>) {
        let radiance = self.radiance + self.throughput.times(seen);
        self.radiance = Vec3::select(lanes, radiance, self.radiance);
    }

    /// Moves every path from one vertex to the next.
    #[inline(always)]
    pub fn step(&mut self, room: &Room<'_>) {
        let lanes = self.running;
        self.counts.steps += 1;
        self.counts.busy_lanes += u64::from(lanes.count());
        let (t_piece, piece) = room.nearest(&self.ray, self.ball);
        let mut t = t_piece;
        let mut in_fog = R::Mask::splat(false);
        if let Some(fog) = &room.fog {
            let (length, begins) = fog.within(&self.ray, t_piece);
            let flight = self.stream.exponential(lanes) * R::splat(1.0 / fog.sigma_t);
            in_fog = flight.lt(length) & lanes;
            t = R::select(in_fog, begins + flight, t);
            let collided = u64::from(in_fog.count());
            self.counts.tentative_collisions += collided;
            self.counts.real_collisions += collided;
        }
        let escaped = lanes.and_not(in_fog | t_piece.lt(R::splat(FAR)));
        if escaped.any() {
            self.score(escaped, Vec3::splat(room.environment));
        }
        let met = lanes.and_not(escaped);
        let on_piece = met.and_not(in_fog);
        self.touched = self.touched | met;
        self.find_lamps(room, piece, t, on_piece);
        let going = met.and_not(self.depth.eq(R::Word::splat(room.max_depth)));
        self.depth = self.depth + R::Word::from_mask(going);
        if !going.any() {
            self.running = going;
            return;
        }
        let site = self.arrive(room, piece, t, in_fog);
        let going = going & R::zero().lt(self.throughput.max_component());
        if going.any() {
            self.look_for_light(room, &site, going);
        }
        let going = self.survive(going);
        if going.any() {
            let (u, turn) = (self.stream.uniform(going), self.stream.uniform(going));
            let (direction, pdf) = site.sample(u, turn);
            self.ray.direction = Vec3::select(going, direction, self.ray.direction);
            self.ray.origin = Vec3::select(going, site.origin, self.ray.origin);
            self.pdf = R::select(going, pdf, self.pdf);
            self.ball = R::Word::select(going, site.ball, self.ball);
        }
        self.running = going;
    }

    /// Scores lamps that paths found by themselves, times their share.
    #[inline(always)]
    fn find_lamps(&mut self, room: &Room<'_>, piece: R::Word, t: R, on_piece: R::Mask) {
        let shining = piece.lt(R::Word::splat(room.shining)) & on_piece;
        if !shining.any() {
            return;
        }
        let lamps = room.lamps.iter().take(room.shining as usize);
        for (index, lamp) in (0..).zip(lamps) {
            let this = piece.eq(R::Word::splat(index)) & shining;
            if this.any() {
                let (radiance, competing) = lamp.found(self.ray.direction, t);
                let share = self.pdf / (self.pdf + competing);
                self.score(this, radiance * share);
            }
        }
    }

    /// Comes to where the ray ends: throughput pays for what is absorbed there.
    #[inline(always)]
    fn arrive(&mut self, room: &Room<'_>, piece: R::Word, t: R, in_fog: R::Mask) -> Site<R> {
        let near = self.ray.at(t);
        let direction = self.ray.direction;
        let spot = Spot::look(room.matter, piece, near);
        let behind = R::zero().lt(spot.normal.dot(direction));
        let normal = Vec3::select(behind, -spot.normal, spot.normal);
        let origin = spot.point + normal * R::splat(room.step);
        let round = spot.round.and_not(in_fog);
        let none = R::Word::splat(NONE);
        let mut site = Site {
            origin,
            ball: R::Word::select(round, piece, none),
            axis: normal,
            in_fog,
            g: 0.0,
        };
        let mut albedo = spot.reflectance;
        if let Some(fog) = &room.fog {
            site.origin = Vec3::select(in_fog, near, site.origin);
            site.axis = Vec3::select(in_fog, direction, site.axis);
            site.g = fog.g;
            albedo = Vec3::select(in_fog, Vec3::splat(fog.albedo), albedo);
        }
        self.throughput = self.throughput.times(albedo);
        site
    }

    /// Samples one light, and scores what of it arrives and goes on along the path.
    #[inline(always)]
    fn look_for_light(&mut self, room: &Room<'_>, site: &Site<R>, lanes: R::Mask) {
        if room.lamps.is_empty() {
            return;
        }
        let seen: Seen<R> =
            lamp::sample(room.lamps, site.origin, room.step, &mut self.stream, lanes);
        let value = site.value(seen.direction);
        // Over the density of the sample and times its share; of what only sampling finds, over nothing.
        let found = R::zero().lt(seen.pdf);
        let weight = R::select(found, value / (seen.pdf + value), value);
        let mut lit = seen.radiance * weight;
        let lanes = R::zero().lt(lit.max_component()) & lanes;
        if !lanes.any() {
            return;
        }
        let ray = Ray {
            origin: site.origin,
            direction: seen.direction,
        };
        let open = lanes.and_not(room.occluded(&ray, site.ball, seen.distance));
        if let Some(fog) = &room.fog {
            let (length, _) = fog.within(&ray, seen.distance);
            lit = lit * analytic::through(R::splat(fog.sigma_t), length);
        }
        self.score(open, lit);
    }

    /// Roulette on throughput.
    #[inline(always)]
    fn survive(&mut self, lanes: R::Mask) -> R::Mask {
        let largest = self.throughput.max_component();
        let factor = collision::roulette(largest, R::splat(ROULETTE), &mut self.stream, lanes);
        self.throughput = self.throughput * factor;
        lanes & R::zero().lt(factor)
    }
}
