//! Which estimator should find what passes along shadow rays?
//!
//! ```text
//! cargo bench -p woodcock-benches --bench shadows [-- cloud|smoke|fire|haze] [--rounds=9]
//! ```
//!
//! Takes the shadow rays that paths send in four scenes, by classes of what the majorant grid knows of them beforehand: their majorant
//! depth, the mean number of tentative collisions of ratio tracking. Every round lets each way estimate all of them in sixteen lanes,
//! with new random numbers. Errors are those against the true transmittance of each ray, which Simpson's rule finds; *variance* is
//! that of one estimate, each ray with the weight that it has in the relative variance of its pixel, over that of what paths
//! do. *eff* is that of 1/(variance × time). *z* tells how far the mean of a way is from the truth, *plant* how far it would be if
//! it were 5 % too large. CPU time, one thread, medians.
//!
//! Then what the whole picture would gain over one estimate by ratio tracking for each ray: its variance is that of its paths under
//! true transmittance and what the estimates add, its time that of its shadow rays and of all else. Ways may be chosen, and their
//! estimates repeated, by what is known of a ray: nothing; its *promise*, the density of scattering towards the light times throughput,
//! which is there anyway; its depth, for a walk over the blocks of each ray; or both. Last, what paths do about it, measured.
#![forbid(unsafe_code)]

use std::error::Error;
use std::hint::black_box;

use woodcock_benches::agreement::LIMIT;
use woodcock_benches::choice::{Found, Measured, Whole, sums};
use woodcock_benches::measure::{Way as Pictures, alone, assemble, compare, render};
use woodcock_benches::passing::{RENDERED, SERIES, Way, beforehand, ways, world_ray};
use woodcock_benches::picture::Pixel;
use woodcock_benches::relative::Picture;
use woodcock_benches::shadow::{Flown, ShadowRay, sunny};
use woodcock_benches::yardstick::Yardstick;
use woodcock_benches::{Times, option, quick, selected};
use woodcock_core::path::{OneGrid, ShadowEstimator};
use woodcock_core::stream::{Key, PathStream};
use woodcock_host::integrator::Integrator;
use woodcock_host::render::{Kernel, Plan};
use woodcock_host::world::{Feature, World};
use woodcock_packet::bundle::{Bundle, BundleRay};

/// Upper ends of the classes of majorant depth.
const CLASSES: [f32; 4] = [0.5, 2.0, 8.0, f32::INFINITY];
const CLASS_NAMES: [&str; 4] = ["< 0.5", "0.5 - 2", "2 - 8", "> 8"];
/// Rays whose floors of roulette, which tell their promise, lie between the same two of these share their mean.
const FLOORS: [f32; 3] = [0.03, 0.1, 0.3];
/// How often estimates may be repeated.
const REPEATED: [u32; 7] = [1, 2, 3, 4, 6, 10, 16];
/// The mistake that should be found.
const PLANTED: f64 = 0.05;

/// Shadow rays of one class whose floors are much the same, and what is known of them.
#[derive(Default)]
struct Group {
    rays: Vec<ShadowRay>,
    truths: Vec<f64>,
    /// The weight of a variance in the relative variance of the picture, per path.
    worths: Vec<f64>,
    floor: f32,
}

impl Group {
    fn requests(&self, group: usize, round: u64) -> Vec<BundleRay> {
        let ray = |(index, ray): (usize, &ShadowRay)| BundleRay {
            origin: ray.origin,
            direction: ray.direction,
            t_max: ray.t_max,
            key: Key {
                seed: 77 + round,
                pixel: index as u32,
                sample: group as u32,
            },
        };
        self.rays.iter().enumerate().map(ray).collect()
    }
}

/// What paths send.
struct Sent {
    /// By class, then by floor.
    groups: Vec<[Group; FLOORS.len() + 1]>,
    paths: f64,
    /// Relative variance of a path whose shadow rays are exact.
    exact: f64,
    /// How far the mean of such paths is from that of the renderer's, in standard errors.
    z: f64,
}

/// Flies paths; `reference` is the renderer's picture, `error` the relative standard error of its mean.
fn send(flown: &Flown<'_>, edge: usize, samples: u32, reference: &Picture, error: f64) -> Sent {
    let mut groups: Vec<[Group; FLOORS.len() + 1]> =
        CLASSES.iter().map(|_| Default::default()).collect();
    let count = 3.0 * reference.len() as f64;
    let mean = reference.iter().flatten().sum::<f64>() / count;
    let paths = reference.len() as f64 * f64::from(samples);
    let (mut exact, mut whole, mut whole_variance) = (0.0, 0.0, 0.0);
    for (pixel, seen) in reference.iter().enumerate() {
        let scale = seen.map(|c| c * c + 0.01 * mean * mean);
        let (mut sum, mut square) = ([0.0; 3], [0.0; 3]);
        for sample in 0..samples {
            let key = Key {
                seed: 1,
                pixel: pixel as u32,
                sample,
            };
            let place = [(pixel % edge) as u32, (pixel / edge) as u32];
            let brought = flown.path(key, place, |ray| {
                let truth = flown.transmittance(ray);
                let depth = flown.majorant_depth(ray);
                let class = CLASSES.iter().position(|end| depth < *end).unwrap_or(3);
                let floor = FLOORS.iter().filter(|f| **f <= ray.floor).count();
                let group = &mut groups[class][floor];
                let worth = |c: usize| f64::from(ray.direct[c]).powi(2) / scale[c];
                group.rays.push(*ray);
                group.truths.push(truth);
                group
                    .worths
                    .push((0..3).map(worth).sum::<f64>() / 3.0 / paths);
                group.floor += ray.floor;
                truth
            });
            for c in 0..3 {
                sum[c] += brought[c];
                square[c] += brought[c] * brought[c];
            }
        }
        let n = f64::from(samples);
        for c in 0..3 {
            let variance = (square[c] - sum[c] * sum[c] / n) / (n - 1.0);
            exact += variance / scale[c] / count;
            whole += sum[c] / n / count;
            whole_variance += variance / n / (count * count);
        }
    }
    for group in groups.iter_mut().flatten() {
        group.floor /= group.rays.len().max(1) as f32;
    }
    // Colours go together: as if there were a third as many pixels.
    let deviation = (3.0 * whole_variance + (error * mean).powi(2)).sqrt();
    Sent {
        groups,
        paths,
        exact,
        z: (whole - mean) / deviation,
    }
}

/// Measures one group.
fn measure(
    medium: &OneGrid<'_>,
    ways: &[Way<'_>],
    (class, promise, group): (usize, usize, &Group),
    rounds: u64,
) -> Result<Measured, Box<dyn Error>> {
    let count = group.rays.len();
    let mut found = vec![Found::default(); ways.len()];
    let mut times = vec![[Times::default(), Times::default()]; ways.len()];
    let mut walks = Times::default();
    let mut out = vec![0.0; count];
    for round in 0..rounds {
        let requests = group.requests(class * CLASSES.len() + promise, round);
        let bundle: Bundle = requests.iter().collect();
        walks.time(|| beforehand(medium, &bundle, &mut out));
        black_box(&out);
        for ((way, found), [lanes, single]) in ways.iter().zip(&mut found).zip(&mut times) {
            lanes.time(|| (way.lanes)(&bundle, group.floor, &mut out));
            let truths = group.truths.iter().zip(&group.worths);
            for (estimate, (truth, worth)) in out.iter().zip(truths) {
                let error = f64::from(*estimate) - truth;
                found.variance += worth * error * error / rounds as f64;
                found.error += error;
                found.square += error * error;
                found.truth += truth;
            }
            if round > 0 {
                continue;
            }
            let mut singles = vec![0.0; count];
            single.time(|| {
                for (ray, out) in requests.iter().zip(&mut singles) {
                    let mut rng = PathStream::new(ray.key);
                    *out = (way.single)(&world_ray(ray), ray.t_max, group.floor, &mut rng);
                }
            });
            if singles != out {
                return Err(format!("{}: lanes changed a result", way.name).into());
            }
            let every = count.div_ceil(1024).max(1);
            let looked = requests.iter().step_by(every);
            let lookups: u64 = looked.map(|ray| (way.lookups)(ray, group.floor)).sum();
            found.lookups = lookups as f64 * count as f64 / count.div_ceil(every) as f64;
        }
    }
    for (found, [lanes, single]) in found.iter_mut().zip(&times) {
        found.rays = count as f64;
        (found.lanes, found.single) = (lanes.quantile(0.5), single.quantile(0.5));
    }
    Ok(Measured {
        class,
        promise,
        found,
        walks: walks.quantile(0.5),
    })
}

/// The renderer's own pictures with one estimate a ray and with several: the mean of all, its relative standard error, and both ways.
fn rendered(worlds: [&World; 2], edge: usize, samples: u32) -> (Picture, f64, [Pictures; 2]) {
    let mut ways = [Pictures::new(samples), Pictures::new(samples)];
    for seed in 0..if quick() { 3 } else { 12 } {
        for (way, world) in ways.iter_mut().zip(worlds) {
            way.run(|samples| render(world, Kernel::Packet, samples, seed));
        }
    }
    let runs = || ways.iter().flat_map(|way| &way.runs);
    let n = runs().count() as f64;
    let mean = |pixel: usize| [0, 1, 2].map(|c| runs().map(|r| r[pixel].mean[c]).sum::<f64>() / n);
    let reference: Picture = (0..edge * edge).map(mean).collect();
    let sum = |run: &Vec<Pixel>| run.iter().flat_map(|p| p.mean).sum::<f64>();
    let middle = runs().map(sum).sum::<f64>() / n;
    let spread: f64 = runs().map(|r| (sum(r) / middle - 1.0).powi(2)).sum();
    (reference, (spread / (n - 1.0) / n).sqrt(), ways)
}

/// Prints what all ways came to on rays of one class.
fn class_table(name: &str, share: f64, ways: &[Way<'_>], found: &[Found], walks: f64) {
    let base = &found[RENDERED];
    for (way, found) in ways.iter().zip(found) {
        let variance = found.variance / base.variance;
        let nanoseconds = |seconds: f64| seconds * 1e9 / found.rays;
        println!(
            "{name:<8} {:>5.1}% {:<26} {variance:>9.4} {:>8.1} {:>8.1} {:>8.2} {:>8.2} {:>+6.1} {:>6.1}",
            100.0 * share,
            way.name,
            nanoseconds(found.lanes),
            nanoseconds(found.single),
            found.lookups / found.rays,
            base.lanes / (variance * found.lanes),
            found.z(0.0),
            found.z(PLANTED),
        );
    }
    let nanoseconds = walks * 1e9 / base.rays;
    println!(
        "{name:<8} {:>6} {:<26} {:>9} {nanoseconds:>8.1}",
        "", "(its depth beforehand)", ""
    );
}

/// Prints what choices by what is known of rays would gain.
fn choices(scene: &str, whole: &Whole, ways: &[Way<'_>], measured: &[Measured]) {
    let walks: f64 = measured.iter().map(|m| m.walks).sum();
    let same = |a: &Measured, b: &Measured, [class, promise]: [bool; 2]| {
        (!class || a.class == b.class) && (!promise || a.promise == b.promise)
    };
    println!(
        "{scene:<8} {:<18} {:>13} {:>13} {:>13} {:>13}",
        "known of a ray", "ratio, n", "tracking, n", "any way, 1", "any way, n"
    );
    for (name, by) in [
        ("nothing", [false, false]),
        ("promise", [false, true]),
        ("depth", [true, false]),
        ("depth and promise", [true, true]),
    ] {
        let first = measured
            .iter()
            .enumerate()
            .filter(|(i, a)| !measured[..*i].iter().any(|b| same(a, b, by)));
        let mut first: Vec<&Measured> = first.map(|(_, a)| a).collect();
        first.sort_by_key(|m| m.promise);
        let kinds: Vec<Vec<Found>> = first
            .iter()
            .map(|a| sums(measured, |b| same(a, b, by)))
            .collect();
        let known = if by[0] { walks } else { 0.0 };
        let of = |ways: std::ops::Range<usize>, repeated: &[u32]| {
            let kinds: Vec<_> = kinds.iter().map(|k| k[ways.clone()].to_vec()).collect();
            whole.best(&kinds, repeated, known)
        };
        let all = of(0..ways.len(), &REPEATED);
        println!(
            "{scene:<8} {name:<18} {:>13.3} {:>13.3} {:>13.3} {:>13.3}",
            of(RENDERED..RENDERED + 1, &REPEATED).0,
            of(0..SERIES, &REPEATED).0,
            of(0..ways.len(), &[1]).0,
            all.0,
        );
        if by == [false, true] {
            let chosen = all
                .1
                .iter()
                .map(|(way, n)| format!("{} x {n}", ways[*way].name));
            let chosen: Vec<String> = chosen.collect();
            println!(
                "{scene:<8} from much promise to little: {}",
                chosen.join("; ")
            );
        }
    }
}

fn study(scene: &Yardstick, rounds: u64) -> Result<(), Box<dyn Error>> {
    let (edge, samples, flown) = if quick() { (16, 4, 4) } else { (64, 64, 8) };
    let mut world = assemble(scene, edge, &[Feature::SingleEstimates])?;
    let several = assemble(scene, edge, &[])?;
    let (reference, error, pictures) = rendered([&world, &several], edge, samples);
    let cost = alone(&pictures[0]);
    let record = world.media[0].record;
    world.tables.fill_controls(&record);
    let shadow = ShadowEstimator::ByNeed;
    let plan = Plan::new(&world, Kernel::Packet, Integrator::Path, 0, shadow, None);
    let paths = Flown::new(&world, plan.settings).ok_or("not a grey grid under a sun")?;
    let sent = send(&paths, edge, flown, &reference, error);
    let ways = ways(&paths.medium);
    let name = scene.name;
    println!("\n{name}: z of the paths flown here {:+.1}", sent.z);
    if sent.z.abs() > LIMIT {
        return Err(format!("{name}: these are not the renderer's paths").into());
    }
    let mut measured = Vec::new();
    for (class, groups) in sent.groups.iter().enumerate() {
        for (promise, group) in groups.iter().enumerate() {
            if !group.rays.is_empty() {
                let group = (class, promise, group);
                measured.push(measure(&paths.medium, &ways, group, rounds)?);
            }
        }
    }
    let all = sums(&measured, |_| true);
    let base = all[RENDERED];
    println!(
        "{:<8} {:>6} {:<26} {:>9} {:>8} {:>8} {:>8} {:>8} {:>6} {:>6}",
        "depth",
        "rays",
        "estimator",
        "variance",
        "ns x16",
        "ns x1",
        "look-ups",
        "eff",
        "z",
        "plant"
    );
    for (class, class_name) in CLASS_NAMES.iter().enumerate() {
        let found = sums(&measured, |m| m.class == class);
        let of_class = measured.iter().filter(|m| m.class == class);
        let walks: f64 = of_class.map(|m| m.walks).sum();
        if found[RENDERED].rays > 0.0 {
            let share = found[RENDERED].rays / base.rays;
            class_table(class_name, share, &ways, &found, walks);
        }
    }
    // In classes of few rays roulette meets too few events to know its error.
    for (way, found) in ways.iter().zip(&all).filter(|_| !quick()) {
        if found.z(0.0).abs() > LIMIT {
            return Err(format!("{name}: {} is biased", way.name).into());
        }
        if found.z(PLANTED).abs() < LIMIT {
            return Err(format!(
                "{name}: {} could be biased unseen; take more rounds",
                way.name
            )
            .into());
        }
    }
    let whole = Whole {
        variance: cost.variance,
        seconds: cost.nanoseconds * 1e-9,
        exact: cost.variance - base.variance,
        rest: cost.nanoseconds * 1e-9 - base.lanes / sent.paths,
        paths: sent.paths,
    };
    println!(
        "{name}: {:.2} shadow rays a path; {:.0} % of the variance of a path ({:.4}; exact ones flown here had {:.4}), {:.0} % of its time ({:.0} ns)",
        base.rays / sent.paths,
        100.0 * base.variance / whole.variance,
        whole.variance,
        sent.exact,
        100.0 * base.lanes / sent.paths / whole.seconds,
        cost.nanoseconds,
    );
    println!(
        "{name}: exact transmittance would gain {:.2} at the present cost, {:.2} at none",
        whole.gain(0.0, base.lanes / sent.paths),
        whole.gain(0.0, 0.0)
    );
    choices(name, &whole, &ways, &measured);
    let both = compare(&pictures[0], &pictures[1]);
    println!(
        "{name}: paths with several estimates for bright rays: time {:.3} x variance {:.3} = gain {:.3} (*/ {:.3})",
        both.a.nanoseconds / both.b.nanoseconds,
        both.a.variance / both.b.variance,
        both.gain.0,
        both.gain.1,
    );
    Ok(())
}

fn main() -> Result<(), Box<dyn Error>> {
    let rounds = if quick() { 2 } else { option("--rounds", 9) };
    println!("{rounds} rounds, one thread");
    for name in ["cloud", "smoke", "fire", "haze"] {
        if let Some(scene) = sunny(name, if quick() { 4 } else { 1 }).filter(|_| selected(name)) {
            study(&scene, rounds)?;
        }
    }
    Ok(())
}
