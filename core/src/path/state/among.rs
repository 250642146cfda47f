//! Paths among surfaces: the two steps, looking and shading, that are made one lane at a time, and what they ask of the others.
//!
//! A ray is known to be free as far as the boxes around surfaces ([`clearance`]); a flight goes there at most and then waits for a look,
//! which tells how far it may go at all. Flights have no memory: what is drawn beyond is drawn anew. Shadow rays that may meet a surface
//! look at once.

use super::{CERTAIN, Paths, Stage};
use crate::collision;
use crate::path::surfaces::clearance;
use crate::path::{Geometry, NO_PLANE, Scene, Surfaces, Tapped};
use crate::ray::FAR;
use crate::real::{Mask, Real, Word};
use crate::stream::KeyedStream;
use crate::vec3::Vec3;

/// From this many scatterings on every path that meets a surface plays another roulette, whatever it carries: between white walls it
/// would never end. It survives each with this chance.
const LONG: u32 = 1 << 16;
const SURVIVAL: f32 = 1.0 - 1.0 / 4096.0;

/// No shadow ray from a surface plays roulette for being traced if it promises more [1/sr]: most soon leave the media, and surfaces are
/// few beside collisions.
const FAINT: f32 = 0.01;

/// Where lanes are among surfaces.
#[derive(Clone, Copy, Debug)]
pub(super) struct Among<R: Real> {
    /// Distance up to which the present ray has been flown; stretches before are over.
    pub(super) from: R,
    /// Flights that have collided before their limit.
    pub(super) struck: R::Mask,
    /// Rays that are known to meet nothing before their limit, and there a surface or nothing at all; else there is a box.
    sighted: R::Mask,
    /// Those that meet a surface at their limit, or did before they collided.
    bounded: R::Mask,
    /// Paths whose flight leaves a surface, near which single precision may not tell the sides apart.
    leaves: R::Mask,
    /// Paths that stand where their surfaces say; others stand at their ray's origin.
    stands: R::Mask,
    /// The flat box whose plane they stand in.
    plane: R::Word,
}

impl<R: Real> Among<R> {
    pub(super) fn idle() -> Self {
        let none = R::Mask::splat(false);
        Self {
            from: R::zero(),
            struck: none,
            sighted: none,
            bounded: none,
            leaves: none,
            stands: none,
            plane: R::Word::splat(NO_PLANE),
        }
    }
}

/// The lanes of a mask.
fn each<K: Mask>(lanes: K) -> impl Iterator<Item = usize> {
    let mut bits = lanes.bits();
    core::iter::from_fn(move || {
        let lane = bits.trailing_zeros() as usize;
        (bits != 0).then(|| {
            bits &= bits - 1;
            lane
        })
    })
}

impl<R, W, S, H, const CHROMATIC: bool, const ANY_RAYLEIGH: bool>
    Paths<R, W, S, CHROMATIC, ANY_RAYLEIGH, H>
where
    R: Real,
    W: Clone,
    S: KeyedStream<R>,
    H: Surfaces,
{
    /// Tells a path that was just launched what its camera ray meets first.
    ///
    /// * `place`: where the surfaces have looked along it, if they did. `distance`: what they found.
    #[inline(always)]
    pub fn launch_among(&mut self, lane: usize, place: Option<usize>, distance: f32) {
        let origin = self.ray.origin.lane(lane);
        self.surfaces.launch(lane, place, origin);
        self.limit.set_lane(lane, distance);
        let Among {
            from,
            struck,
            sighted,
            bounded,
            leaves,
            stands,
            plane,
        } = &mut self.among;
        from.set_lane(lane, 0.0);
        struck.set_lane(lane, false);
        sighted.set_lane(lane, true);
        bounded.set_lane(lane, distance < FAR);
        leaves.set_lane(lane, false);
        stands.set_lane(lane, true);
        plane.set_lane(lane, NO_PLANE);
    }

    /// Begins the rays of lanes at a stage, whose origins and directions are set. Flights of paths that carry nothing end instead.
    #[inline(always)]
    pub(super) fn begin_ray_among(&mut self, lanes: R::Mask, from: Stage) {
        let spent = self.throughput.max_component().eq(R::zero()) & lanes;
        let spent = spent.and_not(self.shadow);
        self.finish(spent, from);
        let lanes = lanes.and_not(spent);
        if !lanes.any() {
            return;
        }
        let near = clearance(self.surfaces.enclosures(), &self.ray, self.among.plane);
        let free = R::splat(FAR).le(near);
        self.cursor = R::Word::select(lanes, R::Word::splat(0), self.cursor);
        self.limit = R::select(lanes, near, self.limit);
        let among = &mut self.among;
        among.from = R::select(lanes, R::zero(), among.from);
        among.struck = among.struck.and_not(lanes);
        among.sighted = among.sighted.and_not(lanes) | (free & lanes);
        among.bounded = among.bounded.and_not(lanes);
        let looks = lanes.and_not(free) & (self.shadow | near.le(R::zero()));
        self.go(looks, from, Stage::Look);
        self.go(lanes.and_not(looks), from, Stage::Enter);
    }

    /// Sends flights on that have come to their limit, all stretches searched; returns those that escape.
    #[inline(always)]
    pub(super) fn end_flights_among(&mut self, flown: R::Mask) -> R::Mask {
        let struck = flown & self.among.struck;
        let passed = flown.and_not(struck);
        let unsure = passed.and_not(self.among.sighted);
        let arrived = (passed & self.among.bounded).and_not(unsure);
        self.go(struck, Stage::Enter, Stage::Scatter);
        self.go(unsure, Stage::Enter, Stage::Look);
        self.go(arrived, Stage::Enter, Stage::Shade);
        passed.and_not(unsure | arrived)
    }

    /// Collisions of lanes about to scatter: those before a surface, and those behind one that they left, keep to their side of it.
    #[inline(always)]
    pub(super) fn collide_among(&mut self, lanes: R::Mask) {
        let before = lanes & (self.among.bounded | self.among.leaves);
        self.among.leaves = self.among.leaves.and_not(lanes);
        let none = R::Word::splat(NO_PLANE);
        self.among.plane = R::Word::select(lanes, none, self.among.plane);
        self.among.stands = self.among.stands.and_not(lanes) | before;
        for lane in each(before) {
            let direction = self.ray.direction.lane(lane);
            let point = self
                .surfaces
                .collide(lane, direction, self.limit.lane(lane));
            self.hit.point.set_lane(lane, point);
        }
    }

    /// Looks for surfaces along the rays of all lanes at [`Stage::Look`].
    pub fn look(&mut self) {
        self.count_step();
        let lanes = self.at(Stage::Look);
        let mut hidden = R::Mask::splat(false);
        let mut distance = R::splat(FAR);
        for lane in each(lanes) {
            if !self.among.stands.lane(lane) {
                self.surfaces.stand(lane, self.ray.origin.lane(lane));
            }
            let direction = self.ray.direction.lane(lane);
            if self.shadow.lane(lane) {
                hidden.set_lane(lane, self.surfaces.is_hidden(lane, direction));
            } else {
                distance.set_lane(lane, self.surfaces.look(lane, direction));
            }
        }
        self.among.stands = self.among.stands | lanes;
        let open = lanes.and_not(hidden);
        let flown = R::select(self.shadow, R::zero(), self.limit);
        self.cursor = R::Word::select(open, R::Word::splat(0), self.cursor);
        self.among.from = R::select(open, flown, self.among.from);
        self.limit = R::select(open, distance, self.limit);
        self.among.sighted = self.among.sighted | open;
        self.among.bounded = self.among.bounded.and_not(open) | (distance.lt(R::splat(FAR)) & open);
        self.go(open, Stage::Look, Stage::Enter);
        if hidden.any() {
            self.ray.direction = Vec3::select(hidden, self.next_direction, self.ray.direction);
            self.shadow = self.shadow.and_not(hidden);
            self.begin_ray_among(hidden, Stage::Look);
        }
    }

    /// Scatters the paths of all lanes at [`Stage::Shade`] at the surfaces that they have met: roulette, a new direction, and a shadow
    /// ray to a light.
    pub fn shade<M, G>(&mut self, scene: &Scene<'_, M, G>)
    where
        M: Tapped<R, Walk = W>,
        G: Geometry<R> + ?Sized,
    {
        self.count_step();
        let lanes = self.at(Stage::Shade);
        let seen = lanes & self.depth.eq(R::Word::splat(0));
        self.alpha = R::select(seen, R::one(), self.alpha);
        let limit = R::Word::splat(scene.settings.max_depth.min(i32::MAX.cast_unsigned()));
        let mut alive = self.depth.lt(limit) & lanes;
        self.depth = self.depth + R::Word::from_mask(lanes);
        let mut point = self.ray.origin;
        let mut albedo = Vec3::uniform(0.0);
        let mut plane = R::Word::splat(NO_PLANE);
        for lane in each(alive) {
            let arrival = self.surfaces.arrive(lane, self.ray.direction.lane(lane));
            point.set_lane(lane, arrival.point);
            albedo.set_lane(lane, arrival.albedo);
            plane.set_lane(lane, arrival.plane.unwrap_or(NO_PLANE));
        }
        let left = self.throughput.times(albedo).max_component();
        let roulette = R::splat(scene.settings.roulette);
        let mut factor = collision::roulette(left, roulette, &mut self.stream, alive);
        let long = R::Word::splat(LONG).lt(self.depth) & alive;
        if long.any() {
            let survives = self.stream.uniform(long).lt(R::splat(SURVIVAL));
            let survived = R::select(survives, factor * R::splat(1.0 / SURVIVAL), R::zero());
            factor = R::select(long, survived, factor);
        }
        alive = alive.and_not(factor.eq(R::zero()) | left.eq(R::zero()));
        self.throughput = Vec3::select(alive, self.throughput * factor, self.throughput);
        self.finish(lanes.and_not(alive), Stage::Shade);
        if !alive.any() {
            return;
        }
        self.ray.origin = Vec3::select(alive, point, self.ray.origin);
        self.among.stands = self.among.stands | alive;
        self.among.leaves = self.among.leaves | alive;
        self.among.plane = R::Word::select(alive, plane, self.among.plane);
        let kind = self.stream.uniform(alive);
        let (u, v) = self.phase_numbers(scene.settings.points, alive);
        let mut direction = self.ray.direction;
        let mut weight = Vec3::uniform(0.0);
        let mut pdf = R::splat(CERTAIN);
        for lane in each(alive) {
            let numbers = [kind, u, v].map(|number| number.lane(lane));
            if let Some(onward) = self.surfaces.sample(lane, numbers) {
                direction.set_lane(lane, onward.direction);
                weight.set_lane(lane, onward.weight);
                pdf.set_lane(lane, onward.pdf.unwrap_or(CERTAIN));
            }
        }
        let throughput = self.throughput;
        self.throughput = Vec3::select(alive, throughput.times(weight), throughput);
        self.ray.direction = Vec3::select(alive, direction, self.ray.direction);
        self.pdf = R::select(alive, pdf, self.pdf);
        if scene.lights.count() > 0 {
            let light = self.pick_light(scene, alive);
            let mut value = Vec3::uniform(0.0);
            let mut density = R::zero();
            for lane in each(alive) {
                let (scattered, found) = self.surfaces.scatter(lane, light.direction.lane(lane));
                value.set_lane(lane, scattered);
                density.set_lane(lane, found);
            }
            // Balance heuristic; one for a light that only next-event estimation can find.
            let share = R::select(
                light.pdf.eq(R::zero()),
                R::one(),
                light.pdf / (light.pdf + density),
            );
            let scattered = throughput.times(value);
            let direct = scattered.times(light.radiance) * share;
            let promise = scattered.max_component();
            let lit = alive & R::zero().lt(promise);
            if lit.any() {
                let faint = scene.settings.faint.min(FAINT);
                // Much of what surfaces send meets no medium: one estimate is enough.
                let once = (promise, R::one());
                self.send(faint, &light, direct, once, direction, lit);
            }
        }
        self.begin_ray_among(alive, Stage::Shade);
    }
}
