//! Free flights and transmittance over bundles of rays.
//!
//! Sixteen rays are under way at a time. A lane whose ray has ended takes the next one of the bundle, and
//! the result lands at its ray's place; waiting for the slowest instead would leave half of the lanes idle. Every ray has its own stream, so neither order nor neighbours change a result.

use alloc::vec::Vec;
use core::array;

use woodcock_core::free_flight::{analytic, delta::Delta};
use woodcock_core::majorant::Process;
use woodcock_core::medium::{ClosedForm, Medium};
use woodcock_core::ray::Ray;
use woodcock_core::real::{Mask, Real, Word};
use woodcock_core::stream::Key;
use woodcock_core::transmittance::{Estimate, Rule};
use woodcock_core::vec3::Vec3;

use crate::bits::LaneStream;
use crate::both::{Both, WIDTH, Wide};
use crate::lanes::{LANES, LaneMask, LaneWords, Lanes};

/// A ray of a bundle.
#[derive(Clone, Copy, Debug)]
pub struct BundleRay {
    /// Where it begins \[length\].
    pub origin: [f32; 3],
    /// Unit direction.
    pub direction: [f32; 3],
    /// How far to look \[length\].
    pub t_max: f32,
    /// Its random numbers, from their beginning.
    pub key: Key,
}

/// Rays that wait for lanes, component by component, so that eight of them load at once.
#[derive(Clone, Debug, Default)]
pub struct Bundle {
    /// Origin, direction and length: seven numbers a ray.
    numbers: [Vec<f32>; 7],
    /// Lower and upper halves of the streams' states.
    states: [Vec<u32>; 2],
}

impl Bundle {
    /// How many rays there are.
    pub fn len(&self) -> usize {
        self.states[0].len()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Adds a ray.
    pub fn push(&mut self, ray: &BundleRay) {
        let ([ox, oy, oz], [dx, dy, dz]) = (ray.origin, ray.direction);
        let numbers = [ox, oy, oz, dx, dy, dz, ray.t_max];
        for (column, number) in self.numbers.iter_mut().zip(numbers) {
            column.push(number);
        }
        let state = ray.key.initial_state();
        self.states[0].push(state as u32);
        self.states[1].push((state >> 32) as u32);
    }
}

impl<'a> FromIterator<&'a BundleRay> for Bundle {
    fn from_iter<I: IntoIterator<Item = &'a BundleRay>>(rays: I) -> Self {
        let mut bundle = Self::default();
        for ray in rays {
            bundle.push(ray);
        }
        bundle
    }
}

/// Eight entries of a column from `first` on; zeros beyond its end.
#[inline(always)]
fn eight<T: Copy + Default>(column: &[T], first: usize) -> [T; LANES] {
    match column.get(first..first + LANES).map(TryInto::try_into) {
        Some(Ok(all)) => all,
        _ => last_few(column, first),
    }
}

#[cold]
#[inline(never)]
fn last_few<T: Copy + Default>(column: &[T], first: usize) -> [T; LANES] {
    array::from_fn(|i| column.get(first + i).copied().unwrap_or_default())
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
        self.busy_lanes as f64 / (self.steps * WIDTH as u64) as f64
    }

    /// Adds a step of so many busy lanes.
    #[inline(always)]
    fn add_step(&mut self, busy: u32) {
        self.steps += 1;
        self.busy_lanes += u64::from(busy);
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
    /// As soon as it pays.
    Refill,
    /// When all have finished: the baseline of the benches.
    LockStep,
}

/// Tentative collisions are decided when this many lanes are at one; moving on is cheaper.
const COLLIDE_AT: u32 = 11;

/// Moving on ends where rays wait and fewer lanes than these have one.
const REFILL_BELOW: u32 = 12;

/// A bit for every lane.
const ALL: u32 = (1 << WIDTH) - 1;

/// Runs any process over a bundle; results land at their rays' places.
///
/// * `process`: no ray in it yet. `results`: as long as the bundle; a shorter slice receives the first ones.
#[inline(always)]
pub fn run<M: Medium<Wide>, P: Process<Wide, M>>(
    medium: &M,
    process: &mut P,
    bundle: &Bundle,
    schedule: Schedule,
    results: &mut [f32],
) -> Usage {
    if M::TIGHT && M::ONE_SEGMENT {
        return run_in_groups(medium, process, bundle, results);
    }
    let mut usage = Usage::default();
    let mut rng = Both::<LaneStream>::default();
    let mut owners = Both::<LaneWords>::default();
    let mut next = 0_usize;
    let mut held = 0_u32;
    loop {
        let running = (process.stages().tracking() | process.stages().tentative()).bits();
        let idle = !running & ALL;
        let refill = match schedule {
            Schedule::Refill => idle != 0,
            Schedule::LockStep => idle == ALL,
        };
        if refill {
            land(process.result(), held & idle, owners, results);
            held &= running;
            let waiting = bundle.len() - next;
            if waiting > 0 {
                let begun = lowest_bits(idle, waiting);
                let mask = Both::<LaneMask>::from_bits(begun);
                // Lanes of the upper half take the rays that follow those of the lower.
                let order = Both(ranks(begun), ranks(begun >> LANES));
                let upper = next + (begun & 0xff).count_ones() as usize;
                let column = |i: usize| {
                    let column = &bundle.numbers[i];
                    Both(
                        Lanes::new(eight(column, next)).permuted(order.0),
                        Lanes::new(eight(column, upper)).permuted(order.1),
                    )
                };
                let ray = Ray {
                    origin: Vec3::new(column(0), column(1), column(2)),
                    direction: Vec3::new(column(3), column(4), column(5)),
                };
                let [low, high] = [0, 1].map(|i: usize| {
                    let half = &bundle.states[i];
                    Both(
                        LaneWords::new(eight(half, next)).permuted(order.0),
                        LaneWords::new(eight(half, upper)).permuted(order.1),
                    )
                });
                rng.set_states(low, high, mask);
                let places = Both(
                    LaneWords::places(next, order.0),
                    LaneWords::places(upper, order.1),
                );
                owners = Word::select(mask, places, owners);
                process.begin(medium, &ray, column(6), &mut rng, mask);
                held |= begun;
                next += begun.count_ones() as usize;
            } else if held == 0 {
                return usage;
            }
        }
        loop {
            let tracking = process.stages().tracking();
            let tentative = process.stages().tentative();
            if !tracking.any() || tentative.count() >= COLLIDE_AT {
                break;
            }
            usage.add_step((tracking | tentative).count());
            process.advance(medium);
            let busy = (process.stages().tracking() | process.stages().tentative()).count();
            // Where rays wait, lanes that have left are worth more than a fuller decision.
            if schedule == Schedule::Refill && next < bundle.len() && busy < REFILL_BELOW {
                break;
            }
        }
        let tentative = process.stages().tentative();
        let deciding = tentative.count();
        if deciding >= COLLIDE_AT || (deciding > 0 && !process.stages().tracking().any()) {
            usage.add_step((process.stages().tracking() | tentative).count());
            usage.tentative_collisions += u64::from(deciding);
            process.collide(medium, &mut rng);
        }
    }
}

/// Runs a process in one segment of a tight bound, where every ray ends with its first step: sixteen rays after sixteen.
#[inline(always)]
fn run_in_groups<M: Medium<Wide>, P: Process<Wide, M>>(
    medium: &M,
    process: &mut P,
    bundle: &Bundle,
    results: &mut [f32],
) -> Usage {
    let mut usage = Usage::default();
    let mut group = |first: usize, rays: usize| {
        // Every lane begins, the ones beyond the bundle too: their results go nowhere.
        let all = Mask::splat(true);
        let (ray, t_max, mut rng) = group(bundle, first);
        process.begin(medium, &ray, t_max, &mut rng, all);
        process.advance(medium);
        let counted = Both::<LaneMask>::from_bits((1 << rays) - 1);
        usage.add_step(rays as u32);
        usage.tentative_collisions += u64::from((process.stages().tentative() & counted).count());
        process.collide(medium, &mut rng);
        process.result()
    };
    in_groups(bundle, results, &mut group);
    usage
}

/// Sixteen rays from `first` on, their lengths and their streams.
#[inline(always)]
fn group(bundle: &Bundle, first: usize) -> (Ray<Wide>, Wide, Both<LaneStream>) {
    let column = |i: usize| {
        let column = &bundle.numbers[i];
        let half = |first: usize| Lanes::new(eight(column, first));
        Both(half(first), half(first + LANES))
    };
    let states = |i: usize| {
        let half = |first: usize| LaneWords::new(eight(&bundle.states[i], first));
        Both(half(first), half(first + LANES))
    };
    let mut stream = Both::<LaneStream>::default();
    stream.set_states(states(0), states(1), Mask::splat(true));
    let ray = Ray {
        origin: Vec3::new(column(0), column(1), column(2)),
        direction: Vec3::new(column(3), column(4), column(5)),
    };
    (ray, column(6), stream)
}

/// Calls `group(first, rays)` for sixteen rays after sixteen, and writes what it gives.
#[inline(always)]
fn in_groups(bundle: &Bundle, results: &mut [f32], mut group: impl FnMut(usize, usize) -> Wide) {
    let count = bundle.len().min(results.len());
    let (whole, rest) = results[..count].as_chunks_mut::<WIDTH>();
    let mut first = 0;
    for out in whole {
        let Both(low, high) = group(first, WIDTH);
        out[..LANES].copy_from_slice(&low.to_array());
        out[LANES..].copy_from_slice(&high.to_array());
        first += WIDTH;
    }
    if !rest.is_empty() {
        let last = group(first, rest.len());
        for (lane, out) in rest.iter_mut().enumerate() {
            *out = Real::lane(last, lane);
        }
    }
}

/// One estimate for each ray of a bundle, sixteen rays after sixteen: for estimators that go over their rays more than once.
///
/// * `estimate(ray, t_max, rng, lanes)`: the estimates; what other lanes hold goes nowhere. `estimates`: one a ray. As long as the
///   bundle; a shorter slice receives the first ones.
#[inline(always)]
pub fn in_turn(
    bundle: &Bundle,
    estimates: &mut [f32],
    mut estimate: impl FnMut(&Ray<Wide>, Wide, &mut Both<LaneStream>, Both<LaneMask>) -> Wide,
) {
    in_groups(bundle, estimates, |first, rays| {
        let (ray, t_max, mut rng) = group(bundle, first);
        let lanes = Both::<LaneMask>::from_bits((1 << rays) - 1);
        estimate(&ray, t_max, &mut rng, lanes)
    });
}

/// The lowest `count` set bits of `bits`.
#[inline(always)]
fn lowest_bits(mut bits: u32, count: usize) -> u32 {
    while bits.count_ones() as usize > count {
        bits &= !(1 << (31 - bits.leading_zeros()));
    }
    bits
}

/// For each lane, how many lanes below it are set.
#[inline(always)]
fn ranks(bits: u32) -> LaneWords {
    const TABLE: [[u8; LANES]; 256] = {
        let mut table = [[0; LANES]; 256];
        let mut bits = 0;
        while bits < 256 {
            let mut lane = 0;
            let mut rank = 0;
            while lane < LANES {
                table[bits][lane] = rank;
                rank += (bits >> lane & 1) as u8;
                lane += 1;
            }
            bits += 1;
        }
        table
    };
    LaneWords::new(TABLE[(bits & 0xff) as usize].map(u32::from))
}

/// Writes the results of the given lanes to the places of their rays.
#[inline(always)]
fn land(result: Wide, lanes: u32, owners: Both<LaneWords>, results: &mut [f32]) {
    land_half(result.0, lanes & 0xff, owners.0, results);
    land_half(result.1, lanes >> LANES, owners.1, results);
}

/// The same, of eight lanes.
#[inline(always)]
fn land_half(result: Lanes, lanes: u32, owners: LaneWords, results: &mut [f32]) {
    let values = result.to_array();
    let places = owners.to_array();
    if lanes == 0xff && owners.consecutive() {
        let first = places[0] as usize;
        if let Some(all) = results.get_mut(first..first + LANES) {
            all.copy_from_slice(&values);
            return;
        }
    }
    let mut rest = lanes;
    while rest != 0 {
        let lane = rest.trailing_zeros() as usize & (LANES - 1);
        rest &= rest - 1;
        if let Some(place) = results.get_mut(places[lane] as usize) {
            *place = values[lane];
        }
    }
}

/// One free flight by delta tracking for each ray of a bundle.
///
/// * `flights`: the distance to each ray's collision, infinite if it flew beyond its length. As long as
///   the bundle; a shorter slice receives the first ones.
///
/// The result of a ray is that of [`woodcock_core::free_flight::delta::sample`] with its key, bit by bit.
pub fn free_flights<M: Medium<Wide>>(
    medium: &M,
    bundle: &Bundle,
    schedule: Schedule,
    flights: &mut [f32],
) -> Usage {
    run(medium, &mut Delta::idle(medium), bundle, schedule, flights)
}

/// One free flight in closed form for each ray of a bundle.
///
/// * `flights`: as of [`free_flights`].
///
/// The result of a ray is that of [`woodcock_core::free_flight::analytic::sample`] with its key.
pub fn analytic_flights(
    medium: &impl ClosedForm<Wide>,
    bundle: &Bundle,
    flights: &mut [f32],
) -> Usage {
    let mut usage = Usage::default();
    in_groups(bundle, flights, |first, rays| {
        let (ray, t_max, mut rng) = group(bundle, first);
        let flight = analytic::sample(medium, &ray, t_max, &mut rng, Mask::splat(true));
        usage.add_step(rays as u32);
        usage.tentative_collisions += rays as u64;
        flight.or_infinite()
    });
    usage
}

/// One estimate of transmittance under the rule `U` for each ray of a bundle.
///
/// * `weights`: one a ray. As long as the bundle; a shorter slice receives the first ones.
pub fn transmittances<U: Rule, M: Medium<Wide>>(
    medium: &M,
    bundle: &Bundle,
    schedule: Schedule,
    weights: &mut [f32],
) -> Usage {
    let mut process = Estimate::<Wide, M::Walk, U>::idle(medium);
    run(medium, &mut process, bundle, schedule, weights)
}
