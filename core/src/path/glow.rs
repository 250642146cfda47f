//! What camera rays see of a medium that shines, found by a comb of points instead of flights.
//!
//! ```text
//! L = ∫ T(t) (σ_a L_e + σ_s L_i) dt + T(∞) L_sky
//! ```
//!
//! In units of majorant depth the ray is cut into [strata](super::stratum) with a point or a few in each, that estimate what a
//! stratum lets through and what its sources bring to its near end.
//!
//! Strata are independent of each other, so their transmittances multiply. The last of a stretch goes on beyond its end, where
//! nothing is: σ_t = 0. No points lie in empty space, and each asks for one tap, as all is linear in what is tapped: no point's σ_t
//! multiplies its own source. What passes plays roulette where it is faint.
//!
//! The same points say where light scatters: of all of them some are picked with a chance in proportion to what a source of
//! strength σ_t would bring there, and a path *branches*: from each of these it goes on as if it had collided. Among sixteen paths of a
//! replicate, and among the branches of a path, single points of strata and directions share out their intervals.

use crate::collision;
use crate::majorant::Tracker;
use crate::path::stratum::{STRATUM, Stratum};
use crate::path::{Counts, Geometry, Scene, Start, Tapped};
use crate::points::{Choice, Stratified};
use crate::ray::Ray;
use crate::real::{Mask, Real, Word};
use crate::stream::Stream;
use crate::vec3::Vec3;

/// Below this transmittance a ray plays roulette, and survives with it.
const FAINT: f32 = 0.1;

/// Branches of a path at most.
pub const BRANCHES: usize = 4;
/// Branches per albedo; of less than one, the chance that there is one.
///
/// With time C and variance V of a comb, F and W of a branch, b branches cost (C + b F)(V + W/b), least at b = √(C W/(F V)). The
/// variance W goes with the square of the albedo, so b with the albedo. Measured on a fire of albedo 1/4: C = 290 and F = 67
/// nanoseconds, V = 0.015 and W = 0.087 of a pixel's square, b = 5; eight cost as much as four, and a tenth more.
const BRANCHING: f32 = 16.0;

/// What camera rays see of the medium in front of them, per lane.
#[derive(Clone, Copy, Debug)]
pub struct Glow<R: Real> {
    /// Radiance, but for what is scattered into the ray.
    pub radiance: Vec3<R>,
    /// The part of what is behind that is hidden.
    pub alpha: R,
    /// How many times the path goes on with a scattering: a whole number.
    pub branches: R,
    /// What each of these counts, before the albedo.
    pub weight: R,
    /// Where they are on the camera ray \[length\]; in order of no meaning.
    pub distances: [R; BRANCHES],
}

impl<R: Real> Glow<R> {
    /// Nothing is seen.
    pub fn none() -> Self {
        Self {
            radiance: Vec3::uniform(0.0),
            alpha: R::zero(),
            branches: R::zero(),
            weight: R::zero(),
            distances: [R::zero(); BRANCHES],
        }
    }

    /// Replaces what one lane sees.
    #[inline(always)]
    pub fn set_lane(&mut self, lane: usize, glow: &Glow<f32>) {
        self.radiance.set_lane(lane, glow.radiance.lane(0));
        self.alpha.set_lane(lane, glow.alpha);
        self.branches.set_lane(lane, glow.branches);
        self.weight.set_lane(lane, glow.weight);
        for (own, distance) in self.distances.iter_mut().zip(glow.distances) {
            own.set_lane(lane, distance);
        }
    }
}

/// What the camera rays of active lanes see of a medium that is the only one, grey, and whose optics are everywhere the same.
///
/// * `rng`: as [`Start::new`] left it.
#[inline(always)]
pub fn glow<R, M, G>(
    scene: &Scene<'_, M, G>,
    start: &Start<R>,
    rng: &mut impl Stream<R>,
    lanes: R::Mask,
    counts: &mut Counts,
) -> Glow<R>
where
    R: Real,
    M: Tapped<R>,
    G: Geometry<R> + ?Sized,
{
    let ray = &start.ray;
    let medium = scene.medium;
    let mut radiance = Vec3::uniform(0.0);
    let mut distances = [R::zero(); BRANCHES];
    let (mut passes, mut weight) = (R::one(), R::zero());
    let mut tracker = Tracker::idle(medium.idle());
    let shifts = scene.settings.points.then(|| {
        let leading = start.strata.leading(Choice::Flight0);
        let word = Stratified::<R, _, 1>::new(rng, [leading], lanes).next_word(lanes);
        (start.strata, word)
    });
    let mut stratum = Stratum::idle();
    let mut albedo = R::zero();
    let mut stretch = start.first;
    let mut active = lanes & stretch.found;
    let mut cursor = R::Word::splat(0);
    while active.any() {
        let [t0, t1] = [stretch.interval.t0, stretch.interval.t1];
        let inside = t0.lt(t1) & active;
        let entry = ray.at(t0);
        let within = Ray {
            origin: entry,
            direction: ray.direction,
        };
        medium.enter(&mut tracker.walk, &within, stretch.medium, inside);
        let mut running = inside;
        let first = stratum.open(shifts.as_ref(), rng, running);
        tracker.begin_towards(t1 - t0, first, running);
        let mut beyond = R::Mask::splat(false);
        while running.any() {
            let mut tracking = running.and_not(beyond);
            let mut here = R::Mask::splat(false);
            while tracking.any() {
                counts.add_step(R::LANES, tracking.count());
                counts.majorant_cells += u64::from(tracking.count());
                let advance = tracker.advance(medium, tracking);
                here = here | advance.tentative;
                beyond = beyond | advance.left;
                tracking = tracking.and_not(advance.tentative | advance.left);
            }
            let mut a = R::zero();
            if here.any() {
                counts.add_step(R::LANES, here.count());
                let number = u64::from(here.count());
                counts.tentative_collisions += number;
                counts.lookups += number;
                counts.exact_lookups += number;
                let t = tracker.t();
                let majorant = tracker.majorant(medium);
                let tap = medium.tap(&tracker.walk, t, rng, here);
                let sigma_t = medium.value(&tracker.walk, tap, here);
                counts.majorant_violations += u64::from((majorant.lt(sigma_t) & here).count());
                let matter = R::zero().lt(sigma_t) & here;
                if matter.any() {
                    let scale = R::one() / majorant;
                    a = (sigma_t * scale).or_zero(matter);
                    let damped = (stratum.depth * R::splat(-0.5)).exp();
                    let factor = passes * damped * stratum.source(here);
                    let at = entry + ray.direction * t;
                    let source = medium.emission(sigma_t, at) * (factor * scale);
                    radiance = Vec3::select(matter, radiance + source, radiance);
                    let share = factor * a;
                    weight = R::select(matter, weight + share, weight);
                    // Numbers that share out the unit interval: of equal points each is picked about equally often.
                    let u = rng.uniform(matter);
                    let distance = t0 + t;
                    for (branch, picked) in distances.iter_mut().enumerate() {
                        let u = u + R::splat(branch as f32 / BRANCHES as f32);
                        let u = u - R::one().or_zero(R::one().le(u));
                        let here = (u * weight).lt(share) & matter;
                        *picked = R::select(here, distance, *picked);
                    }
                }
            }
            let points = (here | beyond) & running;
            stratum.add(a - R::splat(0.5), points);
            let closed = points & stratum.ahead.lt(R::splat(0.5));
            let open = running.and_not(closed);
            let mut ended = closed & beyond;
            let mut towards = R::zero();
            if closed.any() {
                let through = passes * stratum.passes(closed);
                passes = R::select(closed, through, passes);
                let on = closed.and_not(ended);
                let factor = collision::roulette(passes, R::splat(FAINT), rng, on);
                passes = R::select(on, passes * factor, passes);
                ended = ended | (factor.eq(R::zero()) & on);
                let rest = R::splat(STRATUM) - stratum.depth;
                let on = closed.and_not(ended);
                if on.any() {
                    let first = stratum.open(shifts.as_ref(), rng, on);
                    towards = R::select(on, rest + first, towards);
                }
            }
            let further = open & here;
            if further.any() {
                let word = rng.next_word(further);
                let step = stratum.step(word, further);
                towards = R::select(further, step, towards);
            }
            tracker.redirect(towards, here);
            running = running.and_not(ended);
        }
        let optics = medium.optics(&tracker.walk);
        albedo = R::select(inside, optics.albedo.max_component(), albedo);
        cursor = cursor + R::Word::from_mask(active);
        active = active & R::zero().lt(passes);
        if !active.any() {
            break;
        }
        stretch = scene.geometry.stretch(ray, cursor, active);
        active = active & stretch.found;
    }
    let sky = Vec3::splat(scene.lights.environment);
    let radiance = radiance + sky * passes;
    // As many branches as albedo makes worthwhile; of less than one a part of the paths has one.
    let scatters = lanes & R::zero().lt(weight) & R::zero().lt(albedo);
    let wanted = (albedo * R::splat(BRANCHING)).min(R::splat(BRANCHES as f32));
    let factor = collision::roulette(wanted, R::one(), rng, scatters);
    let whole = R::from_word(wanted.max(R::one()).to_word());
    Glow {
        radiance,
        alpha: R::one() - passes,
        branches: whole.or_zero(scatters.and_not(factor.eq(R::zero()))),
        weight: weight * factor / whole,
        distances,
    }
}
