//! Free flight and transmittance: scalar `f32` against sixteen lanes, lock step against refill.
//!
//! ```text
//! cargo bench -p woodcock-benches --bench tracking
//! ```
//!
//! Every round runs each row of a table once, so that rows meet the same noise; speed-ups are medians of
//! the ratios within rounds. One thread, 256 rays a bundle.
#![forbid(unsafe_code)]

use std::hint::black_box;

use woodcock_benches::{BUNDLES, Cube, RAYS, Times, Work, quick, variance_within_rays};
use woodcock_core::free_flight::{analytic, delta};
use woodcock_core::majorant::MajorantGrid;
use woodcock_core::medium::{Grid, Homogeneous, IDENTITY, Medium};
use woodcock_core::ray::Ray;
use woodcock_core::real::Mask;
use woodcock_core::stream::{KeyedStream, PathStream, Stream};
use woodcock_core::transmittance::delta::Delta;
use woodcock_core::transmittance::ratio::Ratio;
use woodcock_core::transmittance::{self};
use woodcock_core::vec3::Vec3;
use woodcock_packet::bits::LaneStream;
use woodcock_packet::both::Wide;
use woodcock_packet::bundle::{
    Bundle, BundleRay, Schedule, Usage, analytic_flights, free_flights, transmittances,
};
use woodcock_packet::lanes::{LANES, LaneMask};

type Scalar<'a> = Box<dyn Fn(&BundleRay, &mut PathStream) -> f32 + 'a>;
type Packet<'a> = Box<dyn Fn(&Bundle, Schedule, &mut [f32]) -> Usage + 'a>;

/// One estimator on one medium, in both widths.
struct Pair<'a> {
    name: String,
    scalar: Scalar<'a>,
    packet: Packet<'a>,
    /// What the variance is of: the value whose mean is the transmittance.
    score: fn(f32) -> f32,
    /// Whether lock step is another way to run it.
    schedules: bool,
}

fn world_ray(ray: &BundleRay) -> Ray<f32> {
    Ray {
        origin: Vec3::splat(ray.origin),
        direction: Vec3::splat(ray.direction),
    }
}

fn flight_length(flight: woodcock_core::free_flight::Flight<f32>) -> f32 {
    if flight.collided {
        flight.t
    } else {
        f32::INFINITY
    }
}

fn escaped(t: f32) -> f32 {
    f32::from(u8::from(t.is_infinite()))
}

/// The estimators that track through any medium.
fn tracked<'a, M>(medium: &'a M, on: &str) -> Vec<Pair<'a>>
where
    M: Medium<f32> + Medium<Wide>,
{
    vec![
        Pair {
            name: format!("free_flight/delta/{on}"),
            scalar: Box::new(move |ray, rng| {
                flight_length(delta::sample(medium, &world_ray(ray), ray.t_max, rng, true))
            }),
            packet: Box::new(move |bundle, schedule, out| {
                free_flights(medium, bundle, schedule, out)
            }),
            score: escaped,
            schedules: true,
        },
        Pair {
            name: format!("transmittance/delta/{on}"),
            scalar: Box::new(move |ray, rng| {
                transmittance::delta::estimate(medium, &world_ray(ray), ray.t_max, rng, true)
            }),
            packet: Box::new(move |bundle, schedule, out| {
                transmittances::<Delta, M>(medium, bundle, schedule, out)
            }),
            score: |weight| weight,
            schedules: true,
        },
        Pair {
            name: format!("transmittance/ratio/{on}"),
            scalar: Box::new(move |ray, rng| {
                transmittance::ratio::estimate(medium, &world_ray(ray), ray.t_max, rng, true)
            }),
            packet: Box::new(move |bundle, schedule, out| {
                transmittances::<Ratio, M>(medium, bundle, schedule, out)
            }),
            score: |weight| weight,
            schedules: true,
        },
    ]
}

fn closed_form(medium: &Homogeneous) -> Pair<'_> {
    Pair {
        name: "free_flight/analytic/homogeneous".to_owned(),
        scalar: Box::new(move |ray, rng| {
            flight_length(analytic::sample(
                medium,
                &world_ray(ray),
                ray.t_max,
                rng,
                true,
            ))
        }),
        packet: Box::new(move |bundle, _, out| analytic_flights(medium, bundle, out)),
        score: escaped,
        schedules: false,
    }
}

/// What a round of one row left behind.
struct Row {
    lanes: &'static str,
    times: Times,
    usage: Usage,
    values: Vec<Vec<f32>>,
}

impl Row {
    fn new(lanes: &'static str) -> Self {
        let values = vec![vec![0.0; RAYS]; BUNDLES];
        Self {
            lanes,
            times: Times::default(),
            usage: Usage::default(),
            values,
        }
    }

    fn scalar(&mut self, pair: &Pair<'_>, work: &Work) {
        let values = &mut self.values;
        self.times.time(|| {
            for (bundle, out) in work.singles.iter().zip(values) {
                for ((ray, stream), out) in bundle.iter().zip(out) {
                    *out = (pair.scalar)(ray, &mut stream.clone());
                }
            }
        });
        black_box(&self.values);
    }

    fn packet(&mut self, pair: &Pair<'_>, work: &Work, schedule: Schedule) {
        let values = &mut self.values;
        let mut usage = Usage::default();
        self.times.time(|| {
            for (bundle, out) in work.bundles.iter().zip(values) {
                usage.add(&(pair.packet)(bundle, schedule, out));
            }
        });
        self.usage = usage;
        black_box(&self.values);
    }
}

fn compare(pair: &Pair<'_>, work: &Work, rounds: usize) {
    let mut scalar = Row::new("x1");
    let mut refill = Row::new("x16");
    let mut lock_step = Row::new("x16-lockstep");
    for _ in 0..rounds {
        scalar.scalar(pair, work);
        refill.packet(pair, work, Schedule::Refill);
        if pair.schedules {
            lock_step.packet(pair, work, Schedule::LockStep);
        }
    }
    assert_eq!(
        scalar.values, refill.values,
        "{}: lanes changed a result",
        pair.name
    );
    let collisions = refill.usage.tentative_collisions as f64 / Work::PATHS as f64;
    let rows = [
        Some(&scalar),
        Some(&refill),
        pair.schedules.then_some(&lock_step),
    ];
    for row in rows.into_iter().flatten() {
        let scores: Vec<Vec<f32>> = row
            .values
            .iter()
            .map(|b| b.iter().map(|v| (pair.score)(*v)).collect())
            .collect();
        let variance = variance_within_rays(&scores);
        let ns = |q: f64| row.times.quantile(q) * 1e9 / Work::PATHS as f64;
        let efficiency = 1.0 / (variance * ns(0.5) * 1e-9);
        let utilisation = match row.lanes {
            "x1" => "    -".to_owned(),
            _ => format!("{:5.3}", row.usage.lane_utilisation()),
        };
        println!(
            "{:<48} {:>8.1} {:>8.1}-{:<8.1} {:>6.2} {collisions:>10.2} {variance:>9.5} {efficiency:>11.3e} {utilisation}",
            format!("{}/{}", pair.name, row.lanes),
            ns(0.5),
            ns(0.25),
            ns(0.75),
            row.times.speed_up_over(&scalar.times),
        );
    }
}

/// What no flight in lanes can do without: a word of the stream and a logarithm, eight at a time.
///
/// Prints how fast that is, and which part of that speed flights in closed form reach.
fn bare(medium: &Homogeneous, work: &Work, rounds: usize) {
    let flights = closed_form(medium);
    let (mut loops, mut whole) = (Times::default(), Row::new("x16"));
    let all = LaneMask::splat(true);
    let mut out = vec![0.0_f32; RAYS];
    for _ in 0..rounds {
        let mut stream = LaneStream::idle();
        for lane in 0..LANES {
            stream.set_key(lane, work.singles[0][lane].0.key);
        }
        loops.time(|| {
            for _ in 0..BUNDLES {
                for group in out.as_chunks_mut::<LANES>().0 {
                    *group = stream.exponential(all).to_array();
                }
                black_box(&out);
            }
        });
        whole.packet(&flights, work, Schedule::Refill);
    }
    println!(
        "{:<48} {:>8.1}: flights in closed form reach {:.0} % of it",
        "bare stream and logarithm/x8",
        loops.quantile(0.5) * 1e9 / Work::PATHS as f64,
        100.0 * whole.times.speed_up_over(&loops)
    );
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let rounds = if quick() { 1 } else { 61 };
    println!("{RAYS} rays a bundle, {BUNDLES} bundles a round, {rounds} rounds, one thread");
    println!(
        "{:<48} {:>8} {:>17} {:>6} {:>10} {:>9} {:>11} lanes",
        "row", "ns/path", "quartiles", "x", "coll/path", "variance", "efficiency"
    );
    let edge = 63.0;
    let homogeneous = Homogeneous::new(1.5 / edge)?;
    let work = Work::new(edge);
    compare(&closed_form(&homogeneous), &work, rounds * 4);
    bare(&homogeneous, &work, rounds * 4);
    for pair in tracked(&homogeneous, "homogeneous") {
        compare(&pair, &work, rounds * 4);
    }
    for side in [64, 256] {
        let cube = Cube::new(side)?;
        let bounds = MajorantGrid::new(&cube.samples, [side; 3], &cube.majorants)?;
        let edge = (side - 1) as f32;
        let medium = Grid::new(bounds, IDENTITY, 8.0 / edge).ok_or("a grid out of range")?;
        let work = Work::new(edge);
        for pair in tracked(&medium, &format!("grid{side}")) {
            compare(&pair, &work, rounds);
        }
    }
    Ok(())
}
