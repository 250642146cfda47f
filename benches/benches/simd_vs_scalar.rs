//! What lanes gain: kernel by kernel and end to end, one thread.
//!
//! ```text
//! cargo bench -p woodcock-benches --bench simd_vs_scalar [-- ROW...]
//! benches/instructions.sh                     instructions per step, counted by callgrind
//! ```
//!
//! Scalar code is woodcock's own: the same generic formulas, the same bits. Every round runs both widths; speed-ups are
//! medians of the ratios within rounds. *bare* is the generator and the logarithm alone, one of each a path: what a free flight cannot do
//! without.
#![forbid(unsafe_code)]

use std::error::Error;
use std::hint::black_box;

use woodcock_benches::measure::{EDGE, assemble, median, pass, timed};
use woodcock_benches::yardstick::Yardstick;
use woodcock_benches::{BUNDLES, Cube, RAYS, Times, Work, quick, selected};
use woodcock_core::free_flight::{Flight, analytic, delta};
use woodcock_core::majorant::MajorantGrid;
use woodcock_core::medium::{Grid, Homogeneous, IDENTITY, Medium};
use woodcock_core::path::Counts;
use woodcock_core::ray::Ray;
use woodcock_core::real::Mask;
use woodcock_core::stream::{Key, KeyedStream, PathStream, Stream};
use woodcock_core::transmittance::{self, ratio::Ratio};
use woodcock_core::vec3::Vec3;
use woodcock_host::render::Kernel;
use woodcock_packet::bits::LaneStream;
use woodcock_packet::both::Wide;
use woodcock_packet::bundle::{
    Bundle, BundleRay, Schedule, Usage, analytic_flights, free_flights, transmittances,
};
use woodcock_packet::lanes::{LANES, LaneMask, Lanes};

type Scalar<'a> = Box<dyn Fn(&BundleRay, &mut PathStream) -> f32 + 'a>;
type Packet<'a> = Box<dyn Fn(&Bundle, &mut [f32]) -> Usage + 'a>;

/// A kernel in both widths.
struct Pair<'a> {
    name: String,
    scalar: Scalar<'a>,
    packet: Packet<'a>,
    /// Whether both give the same numbers; the bare loop has streams of its own.
    same: bool,
}

fn world_ray(ray: &BundleRay) -> Ray<f32> {
    Ray {
        origin: Vec3::splat(ray.origin),
        direction: Vec3::splat(ray.direction),
    }
}

fn length(flight: &Flight<f32>) -> f32 {
    if flight.collided {
        flight.t
    } else {
        f32::INFINITY
    }
}

fn bare() -> Pair<'static> {
    Pair {
        name: "bare".to_owned(),
        scalar: Box::new(|_, rng| Stream::<f32>::exponential(rng, true)),
        packet: Box::new(|_, out| {
            let mut stream = LaneStream::idle();
            for lane in 0..LANES {
                let pixel = lane as u32;
                stream.set_key(
                    lane,
                    Key {
                        seed: 1,
                        pixel,
                        sample: 0,
                    },
                );
            }
            let all = LaneMask::splat(true);
            for group in out.as_chunks_mut::<LANES>().0 {
                let numbers: Lanes = stream.exponential(all);
                *group = numbers.to_array();
            }
            Usage::default()
        }),
        same: false,
    }
}

fn closed_form(medium: &Homogeneous) -> Pair<'_> {
    Pair {
        name: "flight/homogeneous".to_owned(),
        scalar: Box::new(move |ray, rng| {
            length(&analytic::sample(
                medium,
                &world_ray(ray),
                ray.t_max,
                rng,
                true,
            ))
        }),
        packet: Box::new(move |bundle, out| analytic_flights(medium, bundle, out)),
        same: true,
    }
}

fn tracked<'a, M>(medium: &'a M, on: &str) -> [Pair<'a>; 2]
where
    M: Medium<f32> + Medium<Wide>,
{
    [
        Pair {
            name: format!("flight/{on}"),
            scalar: Box::new(move |ray, rng| {
                length(&delta::sample(
                    medium,
                    &world_ray(ray),
                    ray.t_max,
                    rng,
                    true,
                ))
            }),
            packet: Box::new(move |bundle, out| {
                free_flights(medium, bundle, Schedule::Refill, out)
            }),
            same: true,
        },
        Pair {
            name: format!("transmittance/{on}"),
            scalar: Box::new(move |ray, rng| {
                transmittance::ratio::estimate(medium, &world_ray(ray), ray.t_max, rng, true)
            }),
            packet: Box::new(move |bundle, out| {
                transmittances::<Ratio, M>(medium, bundle, Schedule::Refill, out)
            }),
            same: true,
        },
    ]
}

fn scalar_round(pair: &Pair<'_>, work: &Work, values: &mut [Vec<f32>]) {
    for (bundle, out) in work.singles.iter().zip(values) {
        for ((ray, stream), out) in bundle.iter().zip(out) {
            *out = (pair.scalar)(ray, &mut stream.clone());
        }
    }
}

fn packet_round(pair: &Pair<'_>, work: &Work, values: &mut [Vec<f32>]) -> Usage {
    let mut usage = Usage::default();
    for (bundle, out) in work.bundles.iter().zip(values) {
        usage.add(&(pair.packet)(bundle, out));
    }
    usage
}

/// Both widths in turn, or, for callgrind, rounds of only one.
fn kernel(pair: &Pair<'_>, work: &Work, rounds: usize, count: Option<&Count>) {
    if !selected(&pair.name) && count.is_none() {
        return;
    }
    let mut singles = vec![vec![0.0; RAYS]; BUNDLES];
    let mut lanes = singles.clone();
    if let Some(count) = count {
        if count.row == pair.name {
            // Tentative collisions are the steps of both widths: their values are the same.
            let collisions = packet_round(pair, work, &mut lanes).tentative_collisions;
            for _ in 0..count.rounds {
                if count.scalar {
                    scalar_round(pair, work, &mut singles);
                } else {
                    packet_round(pair, work, &mut lanes);
                }
            }
            black_box((&singles, &lanes));
            println!("{} {collisions}", Work::PATHS);
        }
        return;
    }
    let (mut one, mut eight) = (Times::default(), Times::default());
    let mut usage = Usage::default();
    for _ in 0..rounds {
        one.time(|| scalar_round(pair, work, &mut singles));
        eight.time(|| usage = packet_round(pair, work, &mut lanes));
        black_box((&singles, &lanes));
    }
    assert!(
        !pair.same || singles == lanes,
        "{}: lanes changed a result",
        pair.name
    );
    let ns = |times: &Times| times.quantile(0.5) * 1e9 / Work::PATHS as f64;
    let utilisation = if usage.steps == 0 {
        "    -".to_owned()
    } else {
        format!("{:5.3}", usage.lane_utilisation())
    };
    println!(
        "{:<24} {:>9.1} {:>9.1} {:>7.2} {:>10.2} {utilisation}",
        pair.name,
        ns(&one),
        ns(&eight),
        eight.speed_up_over(&one),
        usage.tentative_collisions as f64 / Work::PATHS as f64,
    );
}

/// A whole picture with each kernel of the host.
fn picture(scene: &Yardstick, samples: u32, rounds: u64) -> Result<(), Box<dyn Error>> {
    let world = assemble(scene, EDGE, &[])?;
    let mut ratios = Vec::new();
    let (mut singles, mut lanes) = (Vec::new(), Vec::new());
    let mut counts = Counts::default();
    for seed in 0..rounds {
        let ((one, _), slow) = timed(|| pass(&world, Kernel::Scalar, 0..samples, seed));
        let ((eight, counted), fast) = timed(|| pass(&world, Kernel::Packet, 0..samples, seed));
        let same = one.iter().zip(&eight).all(|(a, b)| a.mean == b.mean);
        assert!(same, "{}: lanes changed the picture", scene.name);
        counts = counted;
        singles.push(slow);
        lanes.push(fast);
        ratios.push(slow / fast);
    }
    let ns = |times: Vec<f64>| median(times) * 1e9 / counts.paths as f64;
    println!(
        "{:<24} {:>9.1} {:>9.1} {:>7.2} {:>10.2} {:5.3}",
        format!("picture/{}", scene.name),
        ns(singles),
        ns(lanes),
        median(ratios),
        counts.tentative_collisions as f64 / counts.paths as f64,
        counts.busy_lanes as f64 / counts.lanes.max(1) as f64,
    );
    Ok(())
}

/// `--count ROW scalar|packet ROUNDS`: work for callgrind.
struct Count {
    row: String,
    scalar: bool,
    rounds: usize,
}

fn count_wanted() -> Result<Option<Count>, Box<dyn Error>> {
    let mut arguments = std::env::args().skip_while(|a| a != "--count").skip(1);
    let Some(row) = arguments.next() else {
        return Ok(None);
    };
    let width = arguments.next().ok_or("--count ROW scalar|packet ROUNDS")?;
    let rounds = arguments.next().ok_or("--count ROW scalar|packet ROUNDS")?;
    Ok(Some(Count {
        row,
        scalar: width == "scalar",
        rounds: rounds.parse()?,
    }))
}

fn main() -> Result<(), Box<dyn Error>> {
    let count = count_wanted()?;
    let count = count.as_ref();
    let rounds = if quick() { 1 } else { 31 };
    if count.is_none() {
        println!(
            "{:<24} {:>9} {:>9} {:>7} {:>10} lanes   ({rounds} rounds)",
            "row", "x1 ns", "x8 ns", "x", "coll/path"
        );
    }
    let edge = 63.0;
    let homogeneous = Homogeneous::new(1.5 / edge)?;
    let work = Work::new(edge);
    kernel(&bare(), &work, 4 * rounds, count);
    kernel(&closed_form(&homogeneous), &work, 4 * rounds, count);
    let sides: &[u32] = if quick() { &[64] } else { &[64, 256, 512] };
    for side in sides {
        let name = format!("grid{side}");
        let rows = [format!("flight/{name}"), format!("transmittance/{name}")];
        let wanted = match count {
            Some(count) => rows.contains(&count.row),
            None => rows.iter().any(|row| selected(row)),
        };
        if !wanted {
            continue;
        }
        let cube = Cube::new(*side)?;
        let bounds = MajorantGrid::new(&cube.samples, [*side; 3], &cube.majorants)?;
        let edge = (side - 1) as f32;
        let medium = Grid::new(bounds, IDENTITY, 8.0 / edge).ok_or("a grid out of range")?;
        let work = Work::new(edge);
        for pair in tracked(&medium, &name) {
            kernel(&pair, &work, rounds, count);
        }
    }
    if count.is_none() {
        let (samples, rounds, coarser) = if quick() { (1, 1, 4) } else { (8, 7, 1) };
        for name in ["cloud", "ground", "fog", "smoke", "absorption"] {
            let scene =
                Yardstick::named(name, coarser).filter(|_| selected(&format!("picture/{name}")));
            if let Some(scene) = scene {
                picture(&scene, samples, rounds)?;
            }
        }
    }
    Ok(())
}
