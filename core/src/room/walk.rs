//! Paths in a room, one a lane, and the step that all of them take at once.

use core::f32::consts::PI;

use super::lamp::Seen;
use super::nearness::Nearness;
use super::piece::Spot;
use super::{Fog, Room};
use crate::collision;
use crate::path::{Counts, PathSample};
use crate::phase::henyey_greenstein;
use crate::points::{Choice, LaneStrata, Stratified};
use crate::ray::{FAR, Ray};
use crate::real::{Mask, Real, Word};
use crate::stream::{KeyedStream, Stream};
use crate::transmittance::analytic;
use crate::vec3::Vec3;

/// Below this throughput a path plays roulette, and survives with it.
const ROULETTE: f32 = 0.5;
/// From this many scatterings on every path plays another roulette, whatever it carries: between white walls it would never
/// end. It survives each with the inverse of this.
const LONG: u32 = 1 << 16;
const STAKE: f32 = 1.0 + 1.0 / 4096.0;
/// A density that no competing strategy comes near.
const CERTAIN: f32 = 1e30;
/// No piece.
const NONE: u32 = 1 << 30;

/// Numbers of stratified choices on the first and the second segment of a path, in nets of four: the camera has the first
/// two, and those of a lens, which then takes the place of others.
mod choice {
    pub(super) const FLIGHT: [[u32; 1]; 2] = [[2], [10]];
    /// Where light is scattered once, and a place on the lamp.
    pub(super) const FOG: [[u32; 3]; 2] = [[3, 4, 5], [11, 12, 13]];
    /// A place on the lamp that lights a piece.
    pub(super) const PIECE: [[u32; 2]; 2] = [[6, 7], [14, 15]];
    pub(super) const DIRECTION: [u32; 2] = [8, 9];
}

/// A path in each lane.
#[derive(Clone, Debug)]
pub struct Walks<R: Real, S> {
    stream: S,
    strata: LaneStrata<R::Word>,
    /// Lanes on their first and on their second segment, as far as their choices are stratified.
    early: [R::Mask; 2],
    ray: Ray<R>,
    throughput: Vec3<R>,
    radiance: Vec3<R>,
    /// Density with which the ray's direction was sampled [1/sr].
    pdf: R,
    /// The ball that the ray begins on.
    ball: R::Word,
    /// How the ray's beginning was found, where that was in fog.
    found: Flown<R>,
    from_fog: R::Mask,
    /// Whether the ray's beginning is known to be on the inner side of all walls.
    enclosed: R::Mask,
    depth: R::Word,
    running: R::Mask,
    touched: R::Mask,
    counts: Counts,
}

/// A flight through fog: where else its end could have been found.
#[derive(Clone, Copy, Debug)]
struct Flown<R> {
    ray: Ray<R>,
    /// Where the ray enters the fog, and how far it goes through it \[length\].
    begins: R,
    length: R,
    /// The chance of a collision within that length.
    blocked: R,
    /// Where the flight ended, from there \[length\].
    flight: R,
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
    /// The part of light that goes on, by colour.
    albedo: Vec3<R>,
    in_fog: R::Mask,
    g: f32,
}

impl<R: Real> Site<R> {
    /// Where nothing is.
    #[inline(always)]
    fn nowhere() -> Self {
        let zero = Vec3::uniform(0.0);
        Self {
            origin: zero,
            ball: R::Word::splat(NONE),
            axis: zero,
            albedo: zero,
            in_fog: R::Mask::splat(false),
            g: 0.0,
        }
    }

    /// Becomes the end of a flight in the given lanes.
    #[inline(always)]
    fn enter_fog(&mut self, fog: &Fog, way: &Flown<R>, lanes: R::Mask) {
        let point = way.ray.at(way.begins + way.flight);
        self.origin = Vec3::select(lanes, point, self.origin);
        self.ball = R::Word::select(lanes, R::Word::splat(NONE), self.ball);
        self.axis = Vec3::select(lanes, way.ray.direction, self.axis);
        self.albedo = Vec3::select(lanes, Vec3::splat(fog.albedo), self.albedo);
        self.in_fog = lanes;
        self.g = fog.g;
    }

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

    /// The density with which a lamp's scattering is placed on a flight's way, over that of the flight; see
    /// [`Walks::scatter_once`].
    ///
    /// * `near`: the way as seen from the lamp, as [`nearness`](super::lamp::Lamp::nearness) has it.
    #[inline(always)]
    fn placing<R: Real>(&self, near: Option<&(Nearness<R>, R)>, way: &Flown<R>) -> R {
        let by_flight = R::one() / way.blocked;
        let Some((nearness, nearest)) = near else {
            return by_flight;
        };
        let density = nearness.density(way.begins + way.flight - *nearest);
        let sigma_t = R::splat(self.sigma_t);
        let by_nearness = density * (sigma_t * way.flight).exp() * R::splat(1.0 / self.sigma_t);
        R::splat(0.5) * (by_flight + by_nearness)
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

    /// How many of the flats are no walls.
    #[inline(always)]
    fn others(&self) -> usize {
        self.flats.len() - (self.walls as usize).min(self.flats.len())
    }

    /// Whether a piece is a wall.
    #[inline(always)]
    fn is_wall<R: Real>(&self, piece: R::Word) -> R::Mask {
        let below = |end: usize| piece.lt(R::Word::splat(end as u32));
        below(self.flats.len()).and_not(below(self.others()))
    }

    /// Whether any piece lies at 0 < t < `t_max`.
    ///
    /// * `enclosed`: rays of which all of that part lies on the inner side of all walls.
    #[inline(always)]
    fn occluded<R: Real>(
        &self,
        ray: &Ray<R>,
        ball: R::Word,
        t_max: R,
        enclosed: R::Mask,
    ) -> R::Mask {
        let mut occluded = R::Mask::splat(false);
        if !enclosed.all() {
            for flat in self.flats.iter().skip(self.others()) {
                occluded = occluded | flat.meet(ray, t_max).1;
            }
            occluded = occluded.and_not(enclosed);
        }
        for flat in self.flats.iter().take(self.others()) {
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
            strata: LaneStrata::idle(),
            early: [none; 2],
            ray: Ray {
                origin: zero,
                direction: Vec3::splat([0.0, 0.0, 1.0]),
            },
            throughput: zero,
            radiance: zero,
            pdf: R::zero(),
            ball: R::Word::splat(NONE),
            found: Flown {
                ray: Ray {
                    origin: zero,
                    direction: zero,
                },
                begins: R::zero(),
                length: R::zero(),
                blocked: R::zero(),
                flight: R::zero(),
            },
            from_fog: none,
            enclosed: none,
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
    /// * `place`: column and row of each path's pixel. `strata`: of its first choices, if they have any.
    #[inline(always)]
    pub fn launch(
        &mut self,
        room: &Room<'_>,
        [x, y]: [R; 2],
        strata: &LaneStrata<R::Word>,
        lanes: R::Mask,
    ) {
        let ray = if room.points {
            self.strata = LaneStrata::select(lanes, *strata, self.strata);
            let choices = [
                Choice::PixelX,
                Choice::PixelY,
                Choice::LensRadius,
                Choice::LensTurn,
            ];
            let leading = choices.map(|choice| self.strata.leading(choice));
            let mut stream = Stratified::new(&mut self.stream, leading, lanes);
            room.camera.ray(x, y, &mut stream, lanes)
        } else {
            room.camera.ray(x, y, &mut self.stream, lanes)
        };
        self.ray = Ray::select(lanes, &ray, &self.ray);
        self.throughput = Vec3::select(lanes, Vec3::uniform(1.0), self.throughput);
        self.radiance = Vec3::select(lanes, Vec3::uniform(0.0), self.radiance);
        self.pdf = R::select(lanes, R::splat(CERTAIN), self.pdf);
        self.ball = R::Word::select(lanes, R::Word::splat(NONE), self.ball);
        self.depth = R::Word::select(lanes, R::Word::splat(0), self.depth);
        self.touched = self.touched.and_not(lanes);
        self.from_fog = self.from_fog.and_not(lanes);
        let within = lanes & R::Mask::splat(room.camera_within);
        self.enclosed = self.enclosed.and_not(lanes) | within;
        self.running = self.running | lanes;
        self.counts.paths += u64::from(lanes.count());
    }

    /// The stratified digits of choices by their numbers on the first and the second segment, and the lanes that have any.
    #[inline(always)]
    fn leading<const N: usize>(&self, numbers: [[u32; N]; 2]) -> ([R::Word; N], R::Mask) {
        let [first, second] = self.early;
        let leading = core::array::from_fn(|i| {
            let of = |segment: usize| self.strata.leading_of(numbers[segment][i]);
            R::Word::select(first, of(0), of(1))
        });
        (leading, first | second)
    }

    /// Uniform numbers for choices.
    #[inline(always)]
    fn uniforms<const N: usize>(&mut self, numbers: [[u32; N]; 2], lanes: R::Mask) -> [R; N] {
        let (leading, early) = self.leading(numbers);
        if (early & lanes).any() {
            let mut stream = Stratified::<R, S, N>::new(&mut self.stream, leading, early);
            core::array::from_fn(|_| stream.uniform(lanes))
        } else {
            core::array::from_fn(|_| self.stream.uniform(lanes))
        }
    }

    /// How far flights go, in mean free paths.
    #[inline(always)]
    fn flight(&mut self, lanes: R::Mask) -> R {
        let (leading, early) = self.leading(choice::FLIGHT);
        if (early & lanes).any() {
            let mut stream = Stratified::<R, S, 1>::new(&mut self.stream, leading, early);
            stream.exponential(lanes)
        } else {
            self.stream.exponential(lanes)
        }
    }

    /// Adds light that arrives in the lanes of a mask.
    #[inline(always)]
    fn score(&mut self, lanes: R::Mask, light: Vec3<R>) {
        self.radiance = Vec3::select(lanes, self.radiance + light, self.radiance);
    }

    /// Moves every path from one vertex to the next.
    #[inline(always)]
    pub fn step(&mut self, room: &Room<'_>) {
        let lanes = self.running;
        self.counts.add_step(R::LANES, lanes.count());
        let may_scatter = lanes.and_not(self.depth.eq(R::Word::splat(room.max_depth)));
        if room.points {
            let on = |n: u32| self.depth.eq(R::Word::splat(n));
            self.early = [on(0), on(1)];
        }
        let (t_piece, piece) = room.nearest(&self.ray, self.ball);
        // What lies before a piece is as enclosed as the ray's beginning.
        let on_piece = t_piece.lt(R::splat(FAR)) & lanes;
        self.enclosed = (self.enclosed & on_piece) | !lanes;
        let mut way = Flown {
            ray: self.ray,
            begins: R::zero(),
            length: R::zero(),
            blocked: R::zero(),
            flight: R::zero(),
        };
        let mut through = R::one();
        let mut in_fog = R::Mask::splat(false);
        if let Some(fog) = &room.fog {
            (way.length, way.begins) = fog.within(&self.ray, t_piece);
            way.blocked = -(-(way.length * R::splat(fog.sigma_t))).exp_m1();
            through = R::one() - way.blocked;
            let foggy = R::zero().lt(way.length) & may_scatter;
            if foggy.any() {
                self.scatter_once(room, fog, &way, foggy);
            }
            way.flight = self.flight(lanes) * R::splat(1.0 / fog.sigma_t);
            in_fog = way.flight.lt(way.length) & lanes;
            let collided = u64::from(in_fog.count());
            self.counts.tentative_collisions += collided;
            self.counts.real_collisions += collided;
        }
        // What lies behind the fog is scored for every path; whether it goes on from there is the flight's affair.
        let beyond = lanes.and_not(on_piece);
        if beyond.any() {
            let sky = Vec3::splat(room.environment) * through;
            self.score(beyond, self.throughput.times(sky));
        }
        self.touched = self.touched | on_piece | in_fog;
        self.find_lamps(room, piece, t_piece, through, on_piece);
        if !may_scatter.any() {
            self.running = may_scatter;
            return;
        }
        let before = self.enclosed;
        // Walls have an outside.
        self.enclosed = before | !room.is_wall::<R>(piece);
        let mut site = self.at_piece(room, piece, t_piece);
        let reflected = on_piece & may_scatter & R::zero().lt(site.albedo.max_component());
        if reflected.any() {
            let throughput = self.throughput.times(site.albedo) * through;
            self.reflect_once(room, &site, throughput, reflected);
        }
        if let Some(fog) = &room.fog {
            site.enter_fog(fog, &way, in_fog);
            self.enclosed = (before & in_fog) | self.enclosed.and_not(in_fog);
        }
        self.depth = self.depth + R::Word::from_mask(may_scatter);
        self.throughput = self.throughput.times(site.albedo);
        let going = self.survive((on_piece | in_fog) & may_scatter);
        if going.any() {
            self.early[1] = R::Mask::splat(false);
            let [u, turn] = self.uniforms([choice::DIRECTION; 2], going);
            let (direction, pdf) = site.sample(u, turn);
            let onward = Ray {
                origin: site.origin,
                direction,
            };
            self.ray = Ray::select(going, &onward, &self.ray);
            self.pdf = R::select(going, pdf, self.pdf);
            self.ball = R::Word::select(going, site.ball, self.ball);
            self.found = way;
            self.from_fog = in_fog;
        }
        self.running = going;
    }

    /// Scores lamps that paths found by themselves, times their share.
    #[inline(always)]
    fn find_lamps(&mut self, room: &Room<'_>, piece: R::Word, t: R, through: R, on_piece: R::Mask) {
        let shining = piece.lt(R::Word::splat(room.shining)) & on_piece;
        if !shining.any() {
            return;
        }
        let lamps = room.lamps.iter().take(room.shining as usize);
        for (index, lamp) in (0..).zip(lamps) {
            let this = piece.eq(R::Word::splat(index)) & shining;
            if !this.any() {
                continue;
            }
            let (radiance, mut competing) = lamp.found(&self.ray, t, room.step);
            let placed = this & self.from_fog;
            if let Some(fog) = room.fog.as_ref().filter(|_| placed.any()) {
                let way = &self.found;
                let near = lamp.nearness(&way.ray, way.begins, way.length);
                let placing = fog.placing(near.as_ref(), way);
                competing = R::select(placed, competing * placing, competing);
            }
            let share = self.pdf / (self.pdf + competing);
            self.score(this, self.throughput.times(radiance) * (through * share));
        }
    }

    /// The piece where rays end: what it would do to them.
    #[inline(always)]
    fn at_piece(&self, room: &Room<'_>, piece: R::Word, t: R) -> Site<R> {
        let spot = Spot::look(room.matter, piece, self.ray.at(t));
        let behind = R::zero().lt(spot.normal.dot(self.ray.direction));
        let normal = Vec3::select(behind, -spot.normal, spot.normal);
        Site {
            origin: spot.point + normal * R::splat(room.step),
            ball: R::Word::select(spot.round, piece, R::Word::splat(NONE)),
            axis: normal,
            albedo: spot.reflectance,
            in_fog: R::Mask::splat(false),
            g: 0.0,
        }
    }

    /// Chooses a lamp for each lane. One draw if there are several.
    #[inline(always)]
    fn choose(&mut self, room: &Room<'_>, lanes: R::Mask) -> R::Word {
        let mut chosen = R::Word::splat(0);
        if room.lamps.len() > 1 {
            let u = self.stream.uniform(lanes);
            let mut below = 0.0;
            for lamp in room.lamps.iter().take(room.lamps.len() - 1) {
                below += lamp.choice;
                chosen = chosen + R::Word::from_mask(R::splat(below).le(u));
            }
        }
        chosen
    }

    /// Scores light of one lamp that a piece reflects to where the path came from.
    #[inline(always)]
    fn reflect_once(
        &mut self,
        room: &Room<'_>,
        site: &Site<R>,
        throughput: Vec3<R>,
        lanes: R::Mask,
    ) {
        if room.lamps.is_empty() {
            return;
        }
        let chosen = self.choose(room, lanes);
        let uv = self.uniforms(choice::PIECE, lanes);
        for (index, lamp) in (0..).zip(room.lamps) {
            let this = chosen.eq(R::Word::splat(index)) & lanes;
            if this.any() {
                let seen = lamp.look(site.origin, uv, room.step);
                let value = site.value(seen.direction);
                let over = R::select(R::zero().lt(seen.pdf), seen.pdf + value, R::one());
                self.arrive(room, site, &seen, throughput * (value / over), this);
            }
        }
    }

    /// Scores light of one lamp that is scattered once on the way through the fog.
    ///
    /// The place is chosen half by a flight that must collide, half by nearness to the lamp. With both, a flight that
    /// ends at the place and then meets the lamp shares by the balance heuristic: all have σ e^−σs in common, so
    /// that only the ratio of densities ([`Fog::placing`]) enters.
    #[inline(always)]
    fn scatter_once(&mut self, room: &Room<'_>, fog: &Fog, way: &Flown<R>, lanes: R::Mask) {
        if room.lamps.is_empty() {
            return;
        }
        let chosen = self.choose(room, lanes);
        let [u, x, y] = if room.camera.lens_radius > 0.0 {
            // A lens has the numbers of the second segment.
            let second = core::mem::replace(&mut self.early[1], R::Mask::splat(false));
            let numbers = self.uniforms(choice::FOG, lanes);
            self.early[1] = second;
            numbers
        } else {
            self.uniforms(choice::FOG, lanes)
        };
        let uv = [x, y];
        // One number says which, and its rest where.
        let twice = u + u;
        let near = R::one().le(twice);
        let rest = R::select(near, twice - R::one(), twice);
        let mean = R::splat(1.0 / fog.sigma_t);
        let by_flight = (rest * way.blocked).neg_ln_1m() * mean;
        for (index, lamp) in (0..).zip(room.lamps) {
            let this = chosen.eq(R::Word::splat(index)) & lanes;
            if !this.any() {
                continue;
            }
            let mut way = *way;
            let seen_near = lamp.nearness(&way.ray, way.begins, way.length);
            way.flight = match &seen_near {
                Some((nearness, nearest)) => {
                    let by_nearness = nearness.sample(rest) + *nearest - way.begins;
                    R::select(near, by_nearness, by_flight)
                }
                // All by a flight.
                None => (u * way.blocked).neg_ln_1m() * mean,
            };
            way.flight = way.flight.max(R::zero()).min(way.length);
            let mut site = Site::nowhere();
            site.enter_fog(fog, &way, R::Mask::splat(true));
            let seen = lamp.look(site.origin, uv, room.step);
            let value = site.value(seen.direction);
            let placing = fog.placing(seen_near.as_ref(), &way);
            let found = R::zero().lt(seen.pdf);
            let over = R::select(found, seen.pdf * placing + value, placing);
            let throughput = self.throughput.times(site.albedo) * (value / over);
            self.arrive(room, &site, &seen, throughput, this);
        }
    }

    /// Scores what of a lamp's light arrives at a site.
    #[inline(always)]
    fn arrive(
        &mut self,
        room: &Room<'_>,
        site: &Site<R>,
        seen: &Seen<R>,
        throughput: Vec3<R>,
        lanes: R::Mask,
    ) {
        let mut light = throughput.times(seen.radiance);
        let lanes = R::zero().lt(light.max_component()) & lanes;
        if !lanes.any() {
            return;
        }
        let ray = Ray {
            origin: site.origin,
            direction: seen.direction,
        };
        let near = seen.distance.lt(R::splat(FAR));
        let enclosed = (self.enclosed & near) | !lanes;
        let hidden = room.occluded(&ray, site.ball, seen.distance, enclosed);
        let open = lanes.and_not(hidden);
        if let Some(fog) = &room.fog {
            let (length, _) = fog.within(&ray, seen.distance);
            light = light * analytic::through(R::splat(fog.sigma_t), length);
        }
        self.score(open, light);
    }

    /// Roulette on throughput.
    #[inline(always)]
    fn survive(&mut self, lanes: R::Mask) -> R::Mask {
        let largest = self.throughput.max_component();
        let lanes = lanes & R::zero().lt(largest);
        let mut threshold = R::splat(ROULETTE);
        let long = lanes.and_not(self.depth.lt(R::Word::splat(LONG)));
        if long.any() {
            let stake = threshold.max(largest * R::splat(STAKE));
            threshold = R::select(long, stake, threshold);
        }
        let factor = collision::roulette(largest, threshold, &mut self.stream, lanes);
        self.throughput = self.throughput * factor;
        lanes & R::zero().lt(factor)
    }
}
