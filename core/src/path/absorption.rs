//! Scenes that only absorb: a path is its camera ray, and what it brings is what passes.
//!
//! ```text
//! L = T L_sky,   T = ∏ over the stretches of the ray in media
//! ```
//!
//! Homogeneous stretches take the closed form; others a power series about a jittered estimate
//! ([`power_series`]), which on smooth media comes near the truth with a handful of look-ups, where an analog flight says one or zero.

use core::cell::Cell;

use crate::majorant::Segment;
use crate::medium::{Control, Controlled, Medium};
use crate::path::start::camera_ray;
use crate::path::{Counts, Geometry, PathSample, Scene, Tapped};
use crate::points::LaneStrata;
use crate::ray::Ray;
use crate::real::{Mask, Real, Word};
use crate::stream::Stream;
use crate::transmittance::analytic;
use crate::transmittance::power_series::{self, Depth};
use crate::vec3::Vec3;

/// One medium of a scene, with a factor on its extinction; counts its look-ups.
#[derive(Debug)]
struct Chosen<'a, R: Real, M> {
    medium: &'a M,
    id: R::Word,
    factor: R,
    counts: &'a Cell<Counts>,
}

impl<R: Real, M: Tapped<R>> Medium<R> for Chosen<'_, R, M> {
    type Walk = M::Walk;
    const ONE_SEGMENT: bool = M::ONE_SEGMENT;
    const TIGHT: bool = M::TIGHT;

    #[inline(always)]
    fn idle(&self) -> M::Walk {
        self.medium.idle()
    }
    #[inline(always)]
    fn begin(&self, walk: &mut M::Walk, ray: &Ray<R>, active: R::Mask) {
        self.medium.enter(walk, ray, self.id, active);
    }
    #[inline(always)]
    fn segment(&self, walk: &M::Walk) -> Segment<R> {
        let Segment { majorant, t_exit } = self.medium.segment(walk);
        Segment {
            majorant: majorant * self.factor,
            t_exit,
        }
    }
    #[inline(always)]
    fn next_segment(&self, walk: &mut M::Walk, active: R::Mask) {
        let mut counts = self.counts.get();
        counts.majorant_cells += u64::from(active.count());
        self.counts.set(counts);
        self.medium.next_segment(walk, active);
    }
    #[inline(always)]
    fn sigma_t(&self, walk: &M::Walk, t: R, rng: &mut impl Stream<R>, active: R::Mask) -> R {
        let sigma_t = self.medium.sigma_t(walk, t, rng, active);
        let majorant = self.medium.segment(walk).majorant;
        let number = u64::from(active.count());
        let mut counts = self.counts.get();
        counts.tentative_collisions += number;
        counts.lookups += number;
        counts.exact_lookups += number;
        // Written so that NaN counts.
        let violated = active.and_not(sigma_t.le(majorant));
        counts.majorant_violations += u64::from(violated.count());
        self.counts.set(counts);
        sigma_t * self.factor
    }
}

impl<R: Real, M: Tapped<R> + Controlled<R>> Controlled<R> for Chosen<'_, R, M> {
    #[inline(always)]
    fn control(&self, walk: &M::Walk) -> Control<R> {
        let Control { minimum, mean } = self.medium.control(walk);
        Control {
            minimum: minimum * self.factor,
            mean: mean * self.factor,
        }
    }
}

/// What the camera rays of active lanes bring, per lane: radiance, and how much of what is behind they hide.
///
/// * `x`, `y`: column and row of each path's pixel. `strata`: of each path, read where the scene asks for points.
pub fn absorb<R, M, G, const CHROMATIC: bool>(
    scene: &Scene<'_, M, G>,
    [x, y]: [R; 2],
    strata: &LaneStrata<R::Word>,
    rng: &mut impl Stream<R>,
    lanes: R::Mask,
    counts: &mut Counts,
) -> (Vec3<R>, R)
where
    R: Real,
    M: Tapped<R> + Controlled<R>,
    G: Geometry<R> + ?Sized,
{
    counts.paths += u64::from(lanes.count());
    let ray = camera_ray(scene, [x, y], strata, rng, lanes);
    let tally = Cell::new(*counts);
    let mut passes = Vec3::uniform(1.0);
    let mut cursor = R::Word::splat(0);
    let mut active = lanes;
    loop {
        let stretch = scene.geometry.stretch(&ray, cursor, active);
        active = active & stretch.found;
        if !active.any() {
            break;
        }
        let [t0, t1] = [stretch.interval.t0, stretch.interval.t1];
        let inside = t0.lt(t1) & active;
        let within = Ray {
            origin: ray.at(t0),
            direction: ray.direction,
        };
        let mut walk = scene.medium.idle();
        scene
            .medium
            .enter(&mut walk, &within, stretch.medium, inside);
        let mut through = |factor: R| {
            if M::TIGHT {
                let sigma_t = scene.medium.segment(&walk).majorant * factor;
                analytic::through(sigma_t, t1 - t0)
            } else {
                let medium = Chosen {
                    medium: scene.medium,
                    id: stretch.medium,
                    factor,
                    counts: &tally,
                };
                power_series::estimate::<Depth, R, _>(&medium, &within, t1 - t0, rng, inside)
            }
        };
        let factor = if CHROMATIC {
            let colour = scene.medium.optics(&walk).colour;
            Vec3::new(through(colour.x), through(colour.y), through(colour.z))
        } else {
            let grey = through(R::one());
            Vec3::new(grey, grey, grey)
        };
        passes = Vec3::select(inside, passes.times(factor), passes);
        cursor = cursor + R::Word::from_mask(active);
    }
    *counts = tally.get();
    let third = R::splat(1.0 / 3.0);
    let hidden = R::one() - (passes.x + passes.y + passes.z) * third;
    (passes.times(Vec3::splat(scene.lights.environment)), hidden)
}

/// As [`absorb`], of one lane.
pub fn sample_of<R: Real>((radiance, alpha): &(Vec3<R>, R), lane: usize) -> PathSample {
    PathSample {
        radiance: radiance.lane(lane),
        alpha: alpha.lane(lane),
    }
}
