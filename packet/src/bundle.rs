//! Free flights and transmittance over bundles of rays.
//!
//! Eight rays are under way at a time. A lane whose ray has ended takes the next one of the bundle, and
//! the result lands at its ray's place; waiting for the slowest of eight instead would leave half of the
//! lanes idle. The streams are keyed by ray, so neither order nor neighbours change a result.

use woodcock_core::free_flight::delta::Delta;
use woodcock_core::medium::Medium;
use woodcock_core::ray::Ray;
use woodcock_core::real::{Mask, Real};
use woodcock_core::stream::{Key, KeyedStream};
use woodcock_core::transmittance::{Estimate, Rule};
use woodcock_core::vec3::Vec3;

use crate::bits::LaneStream;
use crate::lanes::{LANES, LaneMask, Lanes};

/// A ray of a bundle.
#[derive(Clone, Copy, Debug)]
pub struct BundleRay {
    /// Where it begins [length].
    pub origin: [f32; 3],
    /// Unit direction.
    pub direction: [f32; 3],
    /// How far to look [length].
    pub t_max: f32,
    /// Its random numbers.
    pub key: Key,
}

/// What became of a flight.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BundleFlight {
    /// Where it ended [length]: the collision, or `t_max`.
    pub t: f32,
    /// Whether it collided.
    pub collided: bool,
}

/// How a bundle went.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Usage {
    /// Steps of all lanes together.
    pub steps: u64,
    /// Lanes that had a ray, summed over steps.
    pub busy_lanes: u64,
    /// Tentative collisions.
    pub tentative_collisions: u64,
}

impl Usage {
    /// The share of lanes that had a ray.
    pub fn lane_utilisation(&self) -> f64 {
        if self.steps == 0 {
            return 1.0;
        }
        self.busy_lanes as f64 / (self.steps * LANES as u64) as f64
    }

    /// Adds another's.
    pub fn add(&mut self, other: &Self) {
        self.steps += other.steps;
        self.busy_lanes += other.busy_lanes;
        self.tentative_collisions += other.tentative_collisions;
    }
}

/// When finished lanes take new rays.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Schedule {
    /// At once.
    Refill,
    /// When all eight have finished: the baseline of the benches.
    LockStep,
}

/// What eight rays are put through.
trait Process {
    fn begin(&mut self, ray: &Ray<Lanes>, t_max: Lanes, rng: &mut LaneStream, lanes: LaneMask);
    fn running(&self) -> LaneMask;
    fn step(&mut self, rng: &mut LaneStream) -> LaneMask;
}

/// Runs a process over a bundle; `land(lane, ray, process)` takes the result of a finished ray.
#[inline(always)]
fn run<P: Process>(
    process: &mut P,
    rays: &[BundleRay],
    schedule: Schedule,
    mut land: impl FnMut(&P, usize, usize),
) -> Usage {
    let mut usage = Usage::default();
    let mut rng = LaneStream::idle();
    let mut owners = [usize::MAX; LANES];
    let mut waiting = rays.iter().enumerate();
    let mut held = 0_u32;
    let zero = Vec3::uniform(0.0);
    let mut ray = Ray {
        origin: zero,
        direction: zero,
    };
    let mut t_max = Lanes::zero();
    loop {
        let running = process.running().bits();
        let finished = held & !running;
        let refill = match schedule {
            Schedule::Refill => running != 0xff && (finished != 0 || held == 0),
            Schedule::LockStep => running == 0,
        };
        if refill {
            let mut begun = 0_u32;
            for (lane, owner) in owners.iter_mut().enumerate() {
                let bit = 1 << lane;
                if running & bit != 0 {
                    continue;
                }
                if held & bit != 0 {
                    land(process, lane, *owner);
                    held &= !bit;
                }
                if let Some((index, next)) = waiting.next() {
                    *owner = index;
                    held |= bit;
                    begun |= bit;
                    ray.origin.set_lane(lane, next.origin);
                    ray.direction.set_lane(lane, next.direction);
                    t_max.set_lane(lane, next.t_max);
                    rng.set_key(lane, next.key);
                }
            }
            if begun != 0 {
                process.begin(&ray, t_max, &mut rng, LaneMask::from_bits(begun));
            }
            if held == 0 {
                return usage;
            }
        }
        usage.steps += 1;
        usage.busy_lanes += u64::from(process.running().count());
        usage.tentative_collisions += u64::from(process.step(&mut rng).count());
    }
}

struct Flights<'a, M: Medium<Lanes>> {
    medium: &'a M,
    state: Delta<Lanes, M::Walk>,
}

impl<M: Medium<Lanes>> Process for Flights<'_, M> {
    #[inline(always)]
    fn begin(&mut self, ray: &Ray<Lanes>, t_max: Lanes, rng: &mut LaneStream, lanes: LaneMask) {
        self.state.begin(self.medium, ray, t_max, rng, lanes);
    }
    #[inline(always)]
    fn running(&self) -> LaneMask {
        self.state.running()
    }
    #[inline(always)]
    fn step(&mut self, rng: &mut LaneStream) -> LaneMask {
        self.state.step(self.medium, rng)
    }
}

/// One free flight by delta tracking for each ray of a bundle.
///
/// * `flights`: as many as rays; a shorter slice receives the first ones.
///
/// The result of a ray is that of [`woodcock_core::free_flight::delta::sample`] with its key, bit by bit.
pub fn free_flights<M: Medium<Lanes>>(
    medium: &M,
    rays: &[BundleRay],
    schedule: Schedule,
    flights: &mut [BundleFlight],
) -> Usage {
    let mut process = Flights {
        medium,
        state: Delta::idle(medium),
    };
    run(&mut process, rays, schedule, |process, lane, index| {
        let flight = process.state.flight();
        if let Some(place) = flights.get_mut(index) {
            *place = BundleFlight {
                t: flight.t.lane(lane),
                collided: flight.collided.lane(lane),
            };
        }
    })
}

struct Weights<'a, M: Medium<Lanes>, U> {
    medium: &'a M,
    state: Estimate<Lanes, M::Walk>,
    rule: core::marker::PhantomData<U>,
}

impl<M: Medium<Lanes>, U: Rule> Process for Weights<'_, M, U> {
    #[inline(always)]
    fn begin(&mut self, ray: &Ray<Lanes>, t_max: Lanes, rng: &mut LaneStream, lanes: LaneMask) {
        self.state.begin(self.medium, ray, t_max, rng, lanes);
    }
    #[inline(always)]
    fn running(&self) -> LaneMask {
        self.state.running()
    }
    #[inline(always)]
    fn step(&mut self, rng: &mut LaneStream) -> LaneMask {
        self.state.step::<M, U>(self.medium, rng)
    }
}

/// One estimate of transmittance under the rule `U` for each ray of a bundle.
///
/// * `weights`: as many as rays; a shorter slice receives the first ones.
pub fn transmittances<U: Rule, M: Medium<Lanes>>(
    medium: &M,
    rays: &[BundleRay],
    schedule: Schedule,
    weights: &mut [f32],
) -> Usage {
    let mut process = Weights::<M, U> {
        medium,
        state: Estimate::idle(medium),
        rule: core::marker::PhantomData,
    };
    run(&mut process, rays, schedule, |process, lane, index| {
        if let Some(place) = weights.get_mut(index) {
            *place = process.state.weight().lane(lane);
        }
    })
}
