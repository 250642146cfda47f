//! The paths of all lanes, and the steps that move them from stage to stage.

mod among;

use crate::collision;
use crate::light::LightSample;
use crate::majorant::{Mark, Tracker};
use crate::path::{
    Counts, Geometry, Glow, NoSurfaces, Optics, PathSample, Scene, ShadowEstimator, Start, Stretch,
    Surfaces, Tapped,
};
use crate::phase::Phase;
use crate::points::{Choice, LaneStrata, Stratified};
use crate::ray::{FAR, Ray};
use crate::real::{Mask, Real, Word};
use crate::spectral::{Tentative, history_aware};
use crate::stream::{KeyedStream, Stream};
use crate::transmittance::{self, Rule};
use crate::vec3::Vec3;
use among::Among;

/// What a lane's path does next.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stage {
    /// Find the next stretch of the ray within a medium.
    Enter,
    /// Move to the next tentative collision or majorant segment.
    Track,
    /// Decide a tentative collision.
    Collide,
    /// Sample a light and a new direction.
    Scatter,
    /// Find the next surface along the ray; where there are any.
    Look,
    /// Sample a light and a new direction on a surface.
    Shade,
}

/// The nearest real collision found so far on a lane's ray.
#[derive(Clone, Copy, Debug)]
struct Hit<R: Real> {
    point: Vec3<R>,
    albedo: Vec3<R>,
    phase: Phase<R>,
}

/// A path in each lane.
///
/// `CHROMATIC`: extinction differs between colours; otherwise one scalar weight serves all three.
/// `ANY_RAYLEIGH`: some medium follows Rayleigh's law.
/// `H`: the surfaces among the media.
#[derive(Clone, Debug)]
pub struct Paths<R: Real, W, S, const CHROMATIC: bool, const ANY_RAYLEIGH: bool, H = NoSurfaces> {
    stream: S,
    strata: LaneStrata<R::Word>,
    /// The first stretch of camera rays, found before their launch; `found` until they enter it.
    first: Stretch<R>,
    tracker: Tracker<R, W>,
    ray: Ray<R>,
    /// Where the ray sets out, in a medium that is alone.
    mark: Mark<R>,
    /// Where the tracker's ray begins: the entry of the present stretch, and its distance.
    entry: Vec3<R>,
    entered: R,
    cursor: R::Word,
    limit: R,
    hit: Hit<R>,
    /// The flight that follows a shadow ray.
    next_direction: Vec3<R>,
    throughput: Vec3<R>,
    radiance: Vec3<R>,
    /// What the shadow ray's light brings, but for its transmittance, which is `weight`.
    direct: Vec3<R>,
    weight: Vec3<R>,
    /// What the throughput would be had nothing been absorbed: what scoring what passes left of it, or a branch began with. Roulette goes by
    /// the ratio of both.
    forced: R,
    /// Below this weight the shadow ray plays roulette, and survives with it.
    floor: R,
    /// How many further estimates of the shadow ray's transmittance follow the present one.
    further: R,
    depth: R::Word,
    /// Density with which the present direction was sampled [1/sr].
    pdf: R,
    shadow: R::Mask,
    /// Chance of the camera ray to meet a medium's particles.
    alpha: R,
    /// What camera rays see, the branches that are still to come, and the rays.
    glow: Glow<R>,
    camera: Ray<R>,
    /// Lanes on their way to the first tentative collision of a camera ray.
    opening: R::Mask,
    stages: [R::Mask; 6],
    counts: Counts,
    surfaces: H,
    among: Among<R>,
}

/// A word beyond any number of stretches: the next search finds nothing.
const NO_MORE: u32 = 1 << 30;
/// The part of what makes a shadow ray faint below which it plays roulette on its way, and survives with it.
const FAINT_ON_THE_WAY: f32 = 0.4;
/// Every shadow ray plays roulette below this weight.
const LEAST: f32 = 1.0 / 64.0;
/// No shadow ray plays roulette above this weight.
const ROULETTE_SHADOW: f32 = 0.5;
/// Estimates of the transmittance of one shadow ray, at most.
const MOST_ESTIMATES: f32 = 16.0;
/// Above this throughput a flight in a homogeneous medium is made to collide.
const FORCED: f32 = 0.2;
/// A density that no competing strategy comes near.
const CERTAIN: f32 = 1e30;

impl<R, W, S, H, const CHROMATIC: bool, const ANY_RAYLEIGH: bool>
    Paths<R, W, S, CHROMATIC, ANY_RAYLEIGH, H>
where
    R: Real,
    W: Clone,
    S: KeyedStream<R>,
    H: Surfaces,
{
    /// No path in any lane.
    pub fn idle<M: Tapped<R, Walk = W>>(medium: &M, surfaces: H) -> Self {
        let zero = Vec3::uniform(0.0);
        let none = R::Mask::splat(false);
        Self {
            stream: S::idle(),
            strata: LaneStrata::idle(),
            first: Stretch::none(),
            tracker: Tracker::idle(medium.idle()),
            ray: Ray {
                origin: zero,
                direction: zero,
            },
            mark: Mark::none(),
            entry: zero,
            entered: R::zero(),
            cursor: R::Word::splat(0),
            limit: R::zero(),
            hit: Hit {
                point: zero,
                albedo: zero,
                phase: Phase {
                    g: R::zero(),
                    rayleigh: none,
                },
            },
            next_direction: zero,
            throughput: zero,
            radiance: zero,
            direct: zero,
            weight: zero,
            forced: R::one(),
            floor: R::zero(),
            further: R::zero(),
            depth: R::Word::splat(0),
            pdf: R::zero(),
            shadow: none,
            alpha: R::zero(),
            glow: Glow::none(),
            camera: Ray {
                origin: zero,
                direction: zero,
            },
            opening: none,
            stages: [none; 6],
            counts: Counts::default(),
            surfaces,
            among: Among::idle(),
        }
    }

    /// The lanes at a stage.
    #[inline(always)]
    pub fn at(&self, stage: Stage) -> R::Mask {
        self.stages[stage as usize]
    }

    /// The lanes with an unfinished path.
    #[inline(always)]
    pub fn running(&self) -> R::Mask {
        let [a, b, c, d, look, shade] = self.stages;
        let running = a | b | c | d;
        if H::ANY {
            running | look | shade
        } else {
            running
        }
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

    /// The same, to add what is done outside of lanes; and the surfaces, to look along rays before they have lanes.
    pub fn outside(&mut self) -> (&mut Counts, &mut H) {
        (&mut self.counts, &mut self.surfaces)
    }

    /// What the path of a finished lane brings.
    #[inline]
    pub fn sample(&self, lane: usize) -> PathSample {
        PathSample {
            radiance: self.radiance.lane(lane),
            alpha: self.alpha.lane(lane),
        }
    }

    #[inline(always)]
    fn go(&mut self, lanes: R::Mask, from: Stage, to: Stage) {
        self.stages[from as usize] = self.at(from).and_not(lanes);
        self.stages[to as usize] = self.at(to) | lanes;
    }

    #[inline(always)]
    fn finish(&mut self, lanes: R::Mask, from: Stage) {
        self.stages[from as usize] = self.at(from).and_not(lanes);
    }

    #[inline(always)]
    fn count_step(&mut self) {
        let busy = self.running().count();
        self.counts.add_step(R::LANES, busy);
    }

    /// Begins a path that stands ready in one lane, with the stream that made it so.
    ///
    /// Written one by one: as many lanes as finish begin anew, mostly one, and all others keep what they have.
    ///
    /// * `alone`: whether it [sets out from its mark](Self::sets_out_from_marks).
    #[inline(always)]
    pub fn launch(&mut self, lane: usize, start: &Start<f32>, alone: bool) {
        let (ray, first) = (&start.ray, &start.first);
        self.ray.direction.set_lane(lane, ray.direction.lane(0));
        if alone {
            self.ray
                .origin
                .set_lane(lane, ray.at(first.interval.t0).lane(0));
            self.mark.set_lane(lane, &start.mark);
        } else {
            self.ray.origin.set_lane(lane, ray.origin.lane(0));
            self.first.interval.t0.set_lane(lane, first.interval.t0);
            self.first.interval.t1.set_lane(lane, first.interval.t1);
            self.first.medium.set_lane(lane, first.medium.0);
            self.first.found.set_lane(lane, first.found);
        }
        self.strata.set_lane(lane, start.strata);
        self.throughput.set_lane(lane, [1.0; 3]);
        self.forced.set_lane(lane, 1.0);
        self.radiance.set_lane(lane, [0.0; 3]);
        self.depth.set_lane(lane, 0);
        self.pdf.set_lane(lane, CERTAIN);
        self.shadow.set_lane(lane, false);
        self.alpha.set_lane(lane, 0.0);
        // A ray that misses a medium that is alone has passed it.
        let passed = alone && !first.found;
        self.cursor.set_lane(lane, u32::from(passed));
        self.limit.set_lane(lane, FAR);
        self.counts.paths += 1;
        self.stages[Stage::Enter as usize].set_lane(lane, true);
    }

    /// Whether rays set out from where others ended: the medium [is alone](crate::path::PathMedium::is_alone), without surfaces.
    #[inline(always)]
    pub fn sets_out_from_marks<M: Tapped<R>, G: ?Sized>(scene: &Scene<'_, M, G>) -> bool {
        !H::ANY && scene.medium.is_alone()
    }

    /// Whether paths begin with the [glow](crate::path::glow()) of what is before them.
    #[inline(always)]
    pub fn combs<M: Tapped<R>, G: ?Sized>(scene: &Scene<'_, M, G>) -> bool {
        M::SHINES && !CHROMATIC && !H::ANY && scene.settings.combed
    }

    /// Gives a path that was just launched what its camera ray was found to see; it waits for [`branch`](Self::branch).
    #[inline(always)]
    pub fn launch_glowing(&mut self, lane: usize, camera: &Ray<f32>, glow: &Glow<f32>) {
        self.stages[Stage::Enter as usize].set_lane(lane, false);
        // The camera ray is done with its stretches.
        self.first.found.set_lane(lane, false);
        self.camera.origin.set_lane(lane, camera.origin.lane(0));
        self.camera
            .direction
            .set_lane(lane, camera.direction.lane(0));
        self.radiance.set_lane(lane, glow.radiance.lane(0));
        self.alpha.set_lane(lane, glow.alpha);
        self.glow.set_lane(lane, glow);
    }

    /// Begins the next branch of all paths that have run to an end and have another.
    #[inline(always)]
    pub fn branch<M: Tapped<R, Walk = W>, G: ?Sized>(&mut self, scene: &Scene<'_, M, G>) {
        let lanes = R::zero().lt(self.glow.branches).and_not(self.running());
        if !lanes.any() {
            return;
        }
        let rest = self.glow.branches - R::one();
        self.glow.branches = R::select(lanes, rest, self.glow.branches);
        if scene.settings.points {
            let strata = self.strata.branched(rest.to_word());
            self.strata = LaneStrata::select(lanes, strata, self.strata);
        }
        let mut distance = self.glow.distances[0];
        for (branch, other) in self.glow.distances.iter().enumerate().skip(1) {
            distance = R::select(rest.eq(R::splat(branch as f32)), *other, distance);
        }
        let point = self.camera.at(distance);
        let Optics { albedo, phase, .. } = scene.medium.optics(&self.tracker.walk);
        self.hit = Hit {
            point: Vec3::select(lanes, point, self.hit.point),
            albedo: Vec3::select(lanes, albedo, self.hit.albedo),
            phase: Phase::select(lanes, &phase, &self.hit.phase),
        };
        self.ray = Ray::select(lanes, &self.camera, &self.ray);
        if Self::sets_out_from_marks(scene) {
            let ray = Ray {
                origin: point,
                direction: self.camera.direction,
            };
            // It scatters, and a rounding may have put it into an empty block.
            let mark = scene.medium.mark_origin(&ray, lanes).for_all_directions();
            self.mark = Mark::select(lanes, &mark, &self.mark);
        }
        let weight = self.glow.weight;
        let throughput = Vec3::new(weight, weight, weight);
        self.throughput = Vec3::select(lanes, throughput, self.throughput);
        self.forced = R::select(lanes, weight * albedo.max_component(), self.forced);
        self.depth = R::Word::select(lanes, R::Word::splat(0), self.depth);
        self.stages[Stage::Scatter as usize] = self.at(Stage::Scatter) | lanes;
    }

    #[inline(always)]
    fn begin_ray(&mut self, lanes: R::Mask) {
        self.cursor = R::Word::select(lanes, R::Word::splat(0), self.cursor);
        self.limit = R::select(lanes, R::splat(FAR), self.limit);
    }

    #[inline(always)]
    fn next_stretch(&mut self, lanes: R::Mask) {
        self.cursor = self.cursor + R::Word::from_mask(lanes);
    }

    /// Finds the next stretch of the rays of all lanes at [`Stage::Enter`]; where there is none, ends
    /// the ray.
    #[inline(always)]
    pub fn enter<M, G>(&mut self, scene: &Scene<'_, M, G>)
    where
        M: Tapped<R, Walk = W>,
        G: Geometry<R> + ?Sized,
    {
        self.count_step();
        if scene.geometry.is_single() {
            // Ends at once what has passed, so that flights after shadow rays set out in the same step.
            let on_first = self.cursor.eq(R::Word::splat(0));
            let passed = self.at(Stage::Enter).and_not(on_first);
            if passed.any() {
                self.end_ray(scene, passed);
            }
        }
        let lanes = self.at(Stage::Enter);
        if Self::sets_out_from_marks(scene) {
            let walk = &mut self.tracker.walk;
            let length = scene
                .medium
                .resume(walk, &self.mark, self.ray.direction, lanes);
            self.entry = Vec3::select(lanes, self.ray.origin, self.entry);
            self.begin_flight(scene, length, lanes);
            self.go(lanes, Stage::Enter, Stage::Track);
            return;
        }
        let known = self.first.found & lanes;
        let sought = lanes.and_not(known);
        let stretch = if sought.any() {
            let stretch = scene.geometry.stretch(&self.ray, self.cursor, sought);
            Stretch::select(known, &self.first, &stretch)
        } else {
            self.first
        };
        self.first.found = self.first.found.and_not(lanes);
        let found = (stretch.found & sought) | known;
        let mut t0 = stretch.interval.t0;
        if H::ANY {
            t0 = t0.max(self.among.from);
        }
        let t1 = stretch.interval.t1.min(self.limit);
        let inside = t0.lt(t1) & found;
        self.next_stretch(found.and_not(inside));
        if inside.any() {
            self.entry = Vec3::select(inside, self.ray.at(t0), self.entry);
            self.entered = R::select(inside, t0, self.entered);
            let ray = Ray {
                origin: self.entry,
                direction: self.ray.direction,
            };
            scene
                .medium
                .enter(&mut self.tracker.walk, &ray, stretch.medium, inside);
            let mut tracked = inside;
            if M::CLOSED {
                let closed = scene.medium.is_closed(&self.tracker.walk);
                let through = inside & self.shadow & closed;
                if through.any() {
                    self.attenuate(scene.medium, t1 - t0, through);
                    self.next_stretch(through);
                    tracked = tracked.and_not(through);
                }
            }
            let length = t1 - t0;
            if M::TIGHT && !CHROMATIC && scene.settings.forces(&scene.lights) {
                self.fly(scene, length, tracked);
            } else {
                self.begin_flight(scene, length, tracked);
                self.go(tracked, Stage::Enter, Stage::Track);
            }
        }
        let ended = lanes.and_not(found);
        if ended.any() {
            self.end_ray(scene, ended);
        }
    }

    /// The lanes whose present flight is one of the first three, and its leading digits.
    #[inline(always)]
    fn flight_digits(&self, lanes: R::Mask) -> (R::Mask, R::Word) {
        let nth = |n: u32| self.depth.eq(R::Word::splat(n));
        let choices = [Choice::Flight0, Choice::Flight1, Choice::Flight2];
        self.digits(lanes, [nth(0), nth(1), nth(2)], choices)
    }

    /// The lanes in any of three classes, and the leading digits of the choice of each class.
    #[inline(always)]
    fn digits(
        &self,
        lanes: R::Mask,
        classes: [R::Mask; 3],
        choices: [Choice; 3],
    ) -> (R::Mask, R::Word) {
        let [a, b, c] = choices.map(|choice| self.strata.leading(choice));
        let word = R::Word::select(classes[0], a, R::Word::select(classes[1], b, c));
        (lanes & (classes[0] | classes[1] | classes[2]), word)
    }

    /// Draws the depth of the first tentative collision on a stretch.
    #[inline(always)]
    fn begin_flight<M, G: ?Sized>(&mut self, scene: &Scene<'_, M, G>, length: R, lanes: R::Mask) {
        if scene.settings.points {
            self.opening = self.opening.and_not(lanes);
            // Further stretches of a ray draw anew: what the first took is spent.
            let mut first = lanes.and_not(self.shadow) & self.cursor.eq(R::Word::splat(0));
            if H::ANY {
                first = first & self.among.from.eq(R::zero());
            }
            let (early, word) = self.flight_digits(first);
            if early.any() {
                let mut stream = Stratified::<R, S, 1>::new(&mut self.stream, [word], early);
                self.tracker.begin(length, &mut stream, lanes);
                self.opening = self.opening | (early & self.depth.eq(R::Word::splat(0)));
                return;
            }
        }
        self.tracker.begin(length, &mut self.stream, lanes);
    }

    /// Flights on a stretch of constant extinction, beyond which is the environment alone. Where a path still has much to
    /// bring, what would pass is scored, and the flight is one that is known to collide; otherwise it takes its chance.
    #[inline(always)]
    fn fly<M, G>(&mut self, scene: &Scene<'_, M, G>, length: R, lanes: R::Mask)
    where
        M: Tapped<R, Walk = W>,
        G: Geometry<R> + ?Sized,
    {
        let sigma_t = scene.medium.segment(&self.tracker.walk).majorant;
        let whole = sigma_t * length;
        let collides = -(-whole).exp_m1();
        let u = if scene.settings.points {
            let (early, word) = self.flight_digits(lanes);
            Stratified::<R, S, 1>::new(&mut self.stream, [word], early).uniform_fine(lanes)
        } else {
            self.stream.uniform_fine(lanes)
        };
        // A uniform number below one ends at 16.6 mean free paths: no chance is left to be taken beyond.
        let forced =
            R::splat(FORCED).le(self.throughput.max_component()) | R::splat(16.0).le(whole);
        let share = R::select(forced, collides, R::one());
        let depth = (u * share).neg_ln_1m();
        let escapes = lanes.and_not(forced | depth.lt(whole));
        let passes = R::select(forced, R::one() - collides, R::one().or_zero(escapes));
        let sky = Vec3::splat(scene.lights.environment);
        let radiance = self.radiance + (self.throughput * passes).times(sky);
        self.radiance = Vec3::select(lanes, radiance, self.radiance);
        self.throughput = Vec3::select(lanes, self.throughput * share, self.throughput);
        self.forced = R::select(lanes, self.forced * share, self.forced);
        self.finish(escapes, Stage::Enter);
        let hits = lanes.and_not(escapes);
        let number = u64::from(hits.count());
        self.counts.tentative_collisions += number;
        self.counts.real_collisions += number;
        let camera = self.depth.eq(R::Word::splat(0)) & lanes;
        let alpha = R::select(camera, collides, self.alpha);
        let t = (depth / sigma_t).min(length);
        self.record_hit(scene, Stage::Enter, t, hits);
        self.alpha = alpha;
    }

    /// Shadow rays through a stretch whose transmittance has a closed form.
    #[inline(always)]
    fn attenuate<M: Tapped<R, Walk = W>>(&mut self, medium: &M, length: R, lanes: R::Mask) {
        let sigma_t = medium.segment(&self.tracker.walk).majorant;
        let through = |sigma_t| transmittance::analytic::through(sigma_t, length);
        let factor = if CHROMATIC {
            let colour = medium.optics(&self.tracker.walk).colour;
            (colour * sigma_t).map(through)
        } else {
            let grey = through(sigma_t);
            Vec3::new(grey, grey, grey)
        };
        self.weight = Vec3::select(lanes, self.weight.times(factor), self.weight);
    }

    /// No further medium on these rays: a shadow ray reaches its light, or sets out once more; a flight its nearest
    /// collision or the environment.
    #[inline(always)]
    fn end_ray<M, G: ?Sized>(&mut self, scene: &Scene<'_, M, G>, ended: R::Mask) {
        let lit = ended & self.shadow;
        let radiance = self.radiance + self.direct.times(self.weight);
        self.radiance = Vec3::select(lit, radiance, self.radiance);
        let again = R::zero().lt(self.further) & lit;
        if again.any() {
            self.further = R::select(again, self.further - R::one(), self.further);
            self.weight = Vec3::select(again, Vec3::uniform(1.0), self.weight);
            self.begin_ray(again);
            if H::ANY {
                // No surface is in the way: that is known.
                self.among.from = R::select(again, R::zero(), self.among.from);
            }
        }
        let done = lit.and_not(again);
        self.ray.direction = Vec3::select(done, self.next_direction, self.ray.direction);
        self.shadow = self.shadow.and_not(done);
        let flown = ended.and_not(lit);
        let escaped = if H::ANY {
            self.begin_ray_among(done, Stage::Enter);
            self.end_flights_among(flown)
        } else {
            self.begin_ray(done);
            let collided = self.limit.lt(R::splat(FAR)) & flown;
            self.go(collided, Stage::Enter, Stage::Scatter);
            flown.and_not(collided)
        };
        if escaped.any() {
            let mut sky = Vec3::splat(scene.lights.environment);
            if scene.lights.sample_environment {
                let competing = scene.lights.environment_pdf::<R>();
                sky = sky * (self.pdf / (self.pdf + competing));
            }
            let radiance = self.radiance + self.throughput.times(sky);
            self.radiance = Vec3::select(escaped, radiance, self.radiance);
            self.finish(escaped, Stage::Enter);
        }
    }

    /// Moves all lanes at [`Stage::Track`] to their next tentative collision or segment.
    #[inline(always)]
    pub fn track<M: Tapped<R, Walk = W>, G: ?Sized>(&mut self, scene: &Scene<'_, M, G>) {
        self.count_step();
        let lanes = self.at(Stage::Track);
        self.counts.majorant_cells += u64::from(lanes.count());
        let advance = self.tracker.advance(scene.medium, lanes);
        self.next_stretch(advance.left);
        self.go(advance.left, Stage::Track, Stage::Enter);
        self.go(advance.tentative, Stage::Track, Stage::Collide);
    }

    /// Decides the tentative collisions of all lanes at [`Stage::Collide`].
    #[inline(always)]
    pub fn collide<M, G>(&mut self, scene: &Scene<'_, M, G>)
    where
        M: Tapped<R, Walk = W>,
        G: Geometry<R> + ?Sized,
    {
        self.count_step();
        let lanes = self.at(Stage::Collide);
        let t = self.tracker.t();
        let majorant = self.tracker.majorant(scene.medium);
        let flight = lanes.and_not(self.shadow);
        let shadow = lanes & self.shadow;
        let number = u64::from(lanes.count());
        self.counts.tentative_collisions += number;
        self.counts.lookups += if M::TIGHT { 0 } else { number };
        let tap = scene
            .medium
            .tap(&self.tracker.walk, t, &mut self.stream, lanes);
        let valued = if CHROMATIC || M::SHINES {
            lanes
        } else {
            shadow
        };
        let mut sigma_t = majorant;
        if valued.any() {
            sigma_t = scene.medium.value(&self.tracker.walk, tap, valued);
            self.count_exact::<M>(valued, majorant.lt(sigma_t) & valued);
        }
        if M::SHINES && flight.any() {
            let place = self.entry + self.ray.direction * t;
            let source = scene.medium.emission(sigma_t, place) * (R::one() / majorant);
            let radiance = self.radiance + self.throughput.times(source);
            self.radiance = Vec3::select(flight, radiance, self.radiance);
        }
        let mut real = R::Mask::splat(false);
        if flight.any() {
            let rng = &mut self.stream;
            real = if CHROMATIC {
                let optics = scene.medium.optics(&self.tracker.walk);
                let event = Tentative {
                    sigma_t,
                    majorant,
                    colour: optics.colour.into(),
                };
                let weight = self.throughput.into();
                let (real, weight) = history_aware::decide(&event, weight, rng, flight);
                self.throughput = weight.into();
                real
            } else {
                let walk = &self.tracker.walk;
                let decided = if scene.settings.points {
                    let first = self.opening & flight;
                    self.opening = self.opening.and_not(flight);
                    let digits = [self.strata.leading(Choice::Acceptance)];
                    let mut rng = Stratified::<R, S, 1>::new(rng, digits, first);
                    scene.medium.decide(walk, tap, majorant, &mut rng, flight)
                } else {
                    scene.medium.decide(walk, tap, majorant, rng, flight)
                };
                self.count_exact::<M>(decided.exact, decided.violated);
                decided.real
            };
            let reals = u64::from(real.count());
            self.counts.real_collisions += reals;
            self.counts.null_collisions += u64::from(flight.count()) - reals;
        }
        if real.any() {
            self.record_hit(scene, Stage::Collide, t, real);
        }
        let mut onward = flight.and_not(real);
        if shadow.any() {
            let blocked = self.dim(scene, sigma_t, majorant, shadow);
            self.cursor = R::Word::select(blocked, R::Word::splat(NO_MORE), self.cursor);
            self.go(blocked, Stage::Collide, Stage::Enter);
            onward = onward | shadow.and_not(blocked);
        }
        if !M::TIGHT || CHROMATIC {
            self.tracker.redraw(&mut self.stream, onward);
        }
        self.go(onward, Stage::Collide, Stage::Track);
    }

    #[inline(always)]
    fn count_exact<M: Tapped<R, Walk = W>>(&mut self, exact: R::Mask, violated: R::Mask) {
        if !M::TIGHT {
            self.counts.exact_lookups += u64::from(exact.count());
        }
        self.counts.majorant_violations += u64::from(violated.count());
    }

    /// Keeps the place and the optics of real collisions.
    #[inline(always)]
    fn record_hit<M, G>(&mut self, scene: &Scene<'_, M, G>, from: Stage, t: R, real: R::Mask)
    where
        M: Tapped<R, Walk = W>,
        G: Geometry<R> + ?Sized,
    {
        let Optics { albedo, phase, .. } = scene.medium.optics(&self.tracker.walk);
        let point = self.entry + self.ray.direction * t;
        self.hit = Hit {
            point: Vec3::select(real, point, self.hit.point),
            albedo: Vec3::select(real, albedo, self.hit.albedo),
            phase: Phase::select(real, &phase, &self.hit.phase),
        };
        if Self::sets_out_from_marks(scene) {
            let mark = scene.medium.mark(&self.tracker.walk, t);
            self.mark = Mark::select(real, &mark, &self.mark);
        }
        let seen = real & self.depth.eq(R::Word::splat(0));
        self.alpha = R::select(seen, self.alpha.max(R::one()), self.alpha);
        if H::ANY {
            self.limit = R::select(real, self.entered + t, self.limit);
            self.among.struck = self.among.struck | real;
        }
        if scene.geometry.overlaps() {
            // Another stretch may hold a nearer one; search on, up to here.
            self.limit = R::select(real, self.entered + t, self.limit);
            self.next_stretch(real);
            self.go(real, from, Stage::Enter);
        } else {
            self.go(real, from, Stage::Scatter);
        }
    }

    /// A tentative collision of shadow rays: lowers their weights. Returns the rays that are blocked.
    #[inline(always)]
    fn dim<M: Tapped<R, Walk = W>, G: ?Sized>(
        &mut self,
        scene: &Scene<'_, M, G>,
        sigma_t: R,
        majorant: R,
        shadow: R::Mask,
    ) -> R::Mask {
        use crate::transmittance::{delta::Delta, ratio::Ratio};
        let rng = &mut self.stream;
        let old = self.weight;
        let mut lower = |sigma_t: R, weight: R| match scene.settings.shadow {
            ShadowEstimator::ByNeed | ShadowEstimator::Ratio => {
                Ratio::collide::<R, M>(weight, sigma_t, majorant, rng, shadow)
            }
            ShadowEstimator::Delta => {
                Delta::collide::<R, M>(weight, sigma_t, majorant, rng, shadow)
            }
        };
        let new = if CHROMATIC {
            let colour = scene.medium.optics(&self.tracker.walk).colour;
            Vec3::new(
                lower(sigma_t * colour.x, old.x),
                lower(sigma_t * colour.y, old.y),
                lower(sigma_t * colour.z, old.z),
            )
        } else {
            let grey = lower(sigma_t, old.x);
            Vec3::new(grey, grey, grey)
        };
        let largest = if CHROMATIC {
            new.max_component()
        } else {
            new.x
        };
        let factor = collision::roulette(largest, self.floor, &mut self.stream, shadow);
        self.weight = Vec3::select(shadow, new * factor, old);
        (largest * factor).eq(R::zero()) & shadow
    }

    /// Scatters the paths of all lanes at [`Stage::Scatter`]: albedo, roulette, a new direction, and a
    /// shadow ray to a light.
    #[inline(always)]
    pub fn scatter<M, G>(&mut self, scene: &Scene<'_, M, G>)
    where
        M: Tapped<R, Walk = W>,
        G: Geometry<R> + ?Sized,
    {
        self.count_step();
        let lanes = self.at(Stage::Scatter);
        let limit = R::Word::splat(scene.settings.max_depth.min(i32::MAX.cast_unsigned()));
        let mut alive = self.depth.lt(limit) & lanes;
        self.depth = self.depth + R::Word::from_mask(lanes);
        let throughput = self.throughput.times(self.hit.albedo);
        // What flights were made to leave is not lost: only losses play roulette, or paths that lose nothing would be noisy.
        // Branches are many because each brings little: they play for what is left of their own beginning.
        let own = M::TIGHT && !CHROMATIC && scene.settings.forces(&scene.lights);
        let left = if own || Self::combs(scene) {
            throughput.max_component() / self.forced
        } else {
            throughput.max_component()
        };
        let factor = collision::roulette(
            left,
            R::splat(scene.settings.roulette),
            &mut self.stream,
            alive,
        );
        alive = alive.and_not(factor.eq(R::zero()) | throughput.max_component().eq(R::zero()));
        self.throughput = Vec3::select(alive, throughput * factor, self.throughput);
        self.finish(lanes.and_not(alive), Stage::Scatter);
        if !alive.any() {
            return;
        }
        if H::ANY {
            self.collide_among(alive);
        }
        self.ray.origin = Vec3::select(alive, self.hit.point, self.ray.origin);
        let incoming = self.ray.direction;
        let phase = self.hit.phase;
        let (u, turn) = self.phase_numbers(scene.settings.points, alive);
        let cosine = phase.sample::<ANY_RAYLEIGH>(u);
        let direction = incoming.deflected(cosine, turn);
        if scene.lights.sample_environment {
            self.pdf = R::select(alive, phase.eval::<ANY_RAYLEIGH>(cosine), self.pdf);
        }
        if scene.lights.count() == 0 {
            self.ray.direction = Vec3::select(alive, direction, incoming);
        } else {
            let light = self.pick_light(scene, alive);
            let density = phase.eval::<ANY_RAYLEIGH>(incoming.dot(light.direction));
            // Balance heuristic; one for a light that only next-event estimation can find.
            let share = if scene.lights.sample_environment {
                R::select(
                    light.pdf.eq(R::zero()),
                    R::one(),
                    light.pdf / (light.pdf + density),
                )
            } else {
                R::one()
            };
            let direct = self.throughput.times(light.radiance) * (density * share);
            let promise = self.throughput.max_component() * density;
            let faint = scene.settings.faint;
            // The noise of one that brings much is worth several estimates.
            let estimates = Self::estimates::<M>(promise, scene.settings.bright);
            self.send(
                faint,
                &light,
                direct,
                (promise, estimates),
                direction,
                alive,
            );
        }
        if H::ANY {
            self.begin_ray_among(alive, Stage::Scatter);
        } else {
            self.begin_ray(alive);
            self.go(alive, Stage::Scatter, Stage::Enter);
        }
    }

    /// Samples a light for a scattering that has been counted.
    #[inline(always)]
    fn pick_light<M, G: ?Sized>(
        &mut self,
        scene: &Scene<'_, M, G>,
        alive: R::Mask,
    ) -> LightSample<R> {
        if scene.settings.points && scene.lights.count() > 1 {
            let first = self.depth.eq(R::Word::splat(1)) & alive;
            let digits = [self.strata.leading(Choice::Light)];
            let mut stream = Stratified::<R, S, 1>::new(&mut self.stream, digits, first);
            scene.lights.sample(&mut stream, alive)
        } else {
            scene.lights.sample(&mut self.stream, alive)
        }
    }

    /// Turns rays towards a light, if it promises enough, or else to where their paths go on.
    ///
    /// * `faint`: the promise below which they play roulette for it [1/sr].
    /// * `direct`: what the light brings if nothing is in its way. `promise`: throughput times the density of scattering towards it
    ///   [1/sr]. `estimates`: how many of its transmittance it is worth.
    #[inline(always)]
    fn send(
        &mut self,
        faint: f32,
        light: &LightSample<R>,
        direct: Vec3<R>,
        (promise, estimates): (R, R),
        direction: Vec3<R>,
        alive: R::Mask,
    ) {
        // A shadow ray that would bring little is seldom worth its way.
        let faint = R::splat(faint);
        let factor = collision::roulette(promise, faint, &mut self.stream, alive);
        let looks = alive.and_not(factor.eq(R::zero()));
        let part = factor / estimates;
        self.direct = Vec3::select(looks, direct * part, self.direct);
        self.further = R::select(looks, estimates - R::one(), self.further);
        self.weight = Vec3::select(looks, Vec3::uniform(1.0), self.weight);
        let floor = faint * R::splat(FAINT_ON_THE_WAY) / promise.max(faint);
        let floor = floor.max(R::splat(LEAST)).min(R::splat(ROULETTE_SHADOW));
        self.floor = R::select(looks, floor, self.floor);
        self.next_direction = Vec3::select(looks, direction, self.next_direction);
        let onward = Vec3::select(looks, light.direction, direction);
        self.ray.direction = Vec3::select(alive, onward, self.ray.direction);
        self.shadow = self.shadow | looks;
    }

    /// How many estimates of its transmittance a shadow ray of so much promise is worth; one where each is exact.
    #[inline(always)]
    fn estimates<M: Tapped<R>>(promise: R, bright: f32) -> R {
        if M::TIGHT {
            return R::one();
        }
        let worth = (promise * R::splat(1.0 / bright)).min(R::splat(MOST_ESTIMATES));
        R::from_word(worth.to_word()).max(R::one())
    }

    /// Two uniform numbers for the direction of a scattering that has been counted.
    #[inline(always)]
    fn phase_numbers(&mut self, points: bool, alive: R::Mask) -> (R, R) {
        if points {
            let nth = |n: u32| self.depth.eq(R::Word::splat(n));
            let classes = [nth(1), nth(2), nth(3)];
            let cosines = [Choice::Cosine0, Choice::Cosine1, Choice::Cosine2];
            let turns = [Choice::Turn0, Choice::Turn1, Choice::Turn2];
            let (early, cosine) = self.digits(alive, classes, cosines);
            if early.any() {
                let (_, turn) = self.digits(alive, classes, turns);
                let leading = [cosine, turn];
                let mut stream = Stratified::<R, S, 2>::new(&mut self.stream, leading, early);
                return (stream.uniform(alive), stream.uniform(alive));
            }
        }
        (self.stream.uniform(alive), self.stream.uniform(alive))
    }

    /// Runs one stage.
    #[inline(always)]
    pub fn step<M, G>(&mut self, scene: &Scene<'_, M, G>, stage: Stage)
    where
        M: Tapped<R, Walk = W>,
        G: Geometry<R> + ?Sized,
    {
        match stage {
            Stage::Enter => self.enter(scene),
            Stage::Track => self.track(scene),
            Stage::Collide => self.collide(scene),
            Stage::Scatter => self.scatter(scene),
            Stage::Look => self.look(),
            Stage::Shade => self.shade(scene),
        }
    }
}
