//! Run time against error of every estimator of transmittance, on three kinds of rays.
//!
//! ```text
//! cargo bench -p woodcock-benches --bench estimators [-- --out FOLDER]
//! ```
//!
//! Prints variance, look-ups, nanoseconds and efficiency 1/(variance · seconds), all relative to T², and the bias
//! of what is biased; writes `estimators.csv` and `estimators.svg` into the folder (`target/estimators`). One
//! thread, scalar `f32`, full trilinear look-ups unless a row says one tap. Rounds interleave the rows, so that
//! they meet the same noise.
#![forbid(unsafe_code)]

use std::fmt::Write as _;
use std::hint::black_box;
use std::path::PathBuf;

use woodcock_benches::plot::{Curve, Panel, draw};
use woodcock_benches::profile::{LENGTH, Profile};
use woodcock_benches::{Times, quick};
use woodcock_core::free_flight;
use woodcock_core::line_integral;
use woodcock_core::medium::{Audited, Controlled, Homogeneous, Interpolated, Medium, Procedural};
use woodcock_core::ray::Ray;
use woodcock_core::stream::{Key, PathStream};
use woodcock_core::transmittance::power_series::{Depth, Distance};
use woodcock_core::transmittance::residual_ratio::{Mean, Minimum};
use woodcock_core::transmittance::{self, comb, power_series, ray_marching, residual_ratio};
use woodcock_core::vec3::Vec3;

type Estimate<'a> = Box<dyn Fn(&mut PathStream) -> f32 + 'a>;

/// An estimator on a profile: as it is timed, and as it is counted.
struct Method<'a> {
    name: &'static str,
    biased: bool,
    run: Estimate<'a>,
    counted: Box<dyn Fn(&mut PathStream) -> u64 + 'a>,
}

fn along() -> Ray<f32> {
    Ray {
        origin: Vec3::splat([0.0, 0.5, 0.5]),
        direction: Vec3::splat([1.0, 0.0, 0.0]),
    }
}

/// A method from one generic call.
macro_rules! method {
    ($name:literal, $medium:expr, $call:expr, biased = $biased:literal) => {{
        let medium = $medium;
        let counted = Audited::new(medium);
        Method {
            name: $name,
            biased: $biased,
            run: Box::new(move |rng| $call(&medium, &along(), LENGTH, rng, true)),
            counted: Box::new(move |rng| {
                let before = counted.lookups();
                black_box($call(&counted, &along(), LENGTH, rng, true));
                counted.lookups() - before
            }),
        }
    }};
    ($name:literal, $medium:expr, $call:expr) => {
        method!($name, $medium, $call, biased = false)
    };
}

/// Fixed parameters, so that every call has one signature.
fn comb_of_16<M: Medium<f32>>(
    m: &M,
    ray: &Ray<f32>,
    t: f32,
    rng: &mut PathStream,
    on: bool,
) -> f32 {
    comb::estimate(m, ray, t, 16, rng, on)
}
fn march_8<M: Medium<f32>>(m: &M, ray: &Ray<f32>, t: f32, rng: &mut PathStream, on: bool) -> f32 {
    ray_marching::estimate(m, ray, t, 8, rng, on)
}
fn march_32<M: Medium<f32>>(m: &M, ray: &Ray<f32>, t: f32, rng: &mut PathStream, on: bool) -> f32 {
    ray_marching::estimate(m, ray, t, 32, rng, on)
}
fn residual_minimum<M: Controlled<f32>>(
    m: &M,
    ray: &Ray<f32>,
    t: f32,
    rng: &mut PathStream,
    on: bool,
) -> f32 {
    residual_ratio::estimate::<Minimum, f32, M>(m, ray, t, rng, on)
}
fn residual_mean<M: Controlled<f32>>(
    m: &M,
    ray: &Ray<f32>,
    t: f32,
    rng: &mut PathStream,
    on: bool,
) -> f32 {
    residual_ratio::estimate::<Mean, f32, M>(m, ray, t, rng, on)
}
fn series_in_distance<M: Controlled<f32>>(
    m: &M,
    ray: &Ray<f32>,
    t: f32,
    rng: &mut PathStream,
    on: bool,
) -> f32 {
    power_series::estimate::<Distance, f32, M>(m, ray, t, rng, on)
}
fn series_in_depth<M: Controlled<f32>>(
    m: &M,
    ray: &Ray<f32>,
    t: f32,
    rng: &mut PathStream,
    on: bool,
) -> f32 {
    power_series::estimate::<Depth, f32, M>(m, ray, t, rng, on)
}

fn methods(profile: &Profile) -> Option<Vec<Method<'_>>> {
    let tap = profile.local()?;
    let (local, global) = (Interpolated(tap), Interpolated(profile.global()?));
    Some(vec![
        method!("delta, one bound", global, transmittance::delta::estimate),
        method!("ratio, one bound", global, transmittance::ratio::estimate),
        method!("ratio", local, transmittance::ratio::estimate),
        method!("comb of 16 walks", local, comb_of_16),
        method!("residual ratio, minimum", local, residual_minimum),
        method!("residual ratio, mean", local, residual_mean),
        method!("power series, distance", local, series_in_distance),
        method!("power series, depth", local, series_in_depth),
        method!("ray marching, 8 steps", local, march_8, biased = true),
        method!("ray marching, 32 steps", local, march_32, biased = true),
        method!("ratio, one tap", tap, transmittance::ratio::estimate),
        method!("residual ratio, mean, one tap", tap, residual_mean),
        method!("power series, depth, one tap", tap, series_in_depth),
    ])
}

/// What was measured of a method.
struct Row {
    variance: f64,
    lookups: f64,
    nanoseconds: f64,
    quartiles: [f64; 2],
    /// (mean − T)/T, and its standard error.
    bias: [f64; 2],
    /// Samples and relative error of their mean.
    errors: Vec<(u64, f64)>,
}

const BATCH: usize = 256;

fn stream(index: u64) -> PathStream {
    PathStream::new(Key {
        seed: 3,
        pixel: (index >> 32) as u32,
        sample: index as u32,
    })
}

/// Root mean square of the relative error of means of n samples, for n in powers of four.
fn errors(values: &[f64], truth: f64) -> Vec<(u64, f64)> {
    let mut errors = Vec::new();
    let mut n = 1;
    while n * 16 <= values.len() {
        let chunks = values.chunks_exact(n);
        let count = chunks.len() as f64;
        let square: f64 = chunks
            .map(|c| (c.iter().sum::<f64>() / n as f64 / truth - 1.0).powi(2))
            .sum();
        errors.push((n as u64, (square / count).sqrt()));
        n *= 4;
    }
    errors
}

fn measure(methods: &[Method<'_>], truth: f64, rounds: usize) -> Vec<Row> {
    let mut times: Vec<Times> = methods.iter().map(|_| Times::default()).collect();
    let mut values: Vec<Vec<f64>> = methods.iter().map(|_| Vec::new()).collect();
    for round in 0..rounds {
        for (method, (times, values)) in methods.iter().zip(times.iter_mut().zip(&mut values)) {
            let mut out = [0.0_f32; BATCH];
            times.time(|| {
                for (i, out) in out.iter_mut().enumerate() {
                    *out = (method.run)(&mut stream((round * BATCH + i) as u64));
                }
            });
            values.extend(black_box(out).map(f64::from));
        }
    }
    let rows = methods.iter().zip(times.iter().zip(&values));
    rows.map(|(method, (times, values))| {
        let n = values.len() as f64;
        let mean = values.iter().sum::<f64>() / n;
        let variance = values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (n - 1.0);
        let counted = 4096.min(values.len());
        let lookups: u64 = (0..counted)
            .map(|i| (method.counted)(&mut stream(i as u64)))
            .sum();
        let per_sample = |q: f64| times.quantile(q) * 1e9 / BATCH as f64;
        Row {
            variance: variance / (truth * truth),
            lookups: lookups as f64 / counted as f64,
            nanoseconds: per_sample(0.5),
            quartiles: [per_sample(0.25), per_sample(0.75)],
            bias: [mean / truth - 1.0, (variance / n).sqrt() / truth],
            errors: errors(values, truth),
        }
    })
    .collect()
}

/// Algorithm 2 against as many independent walks: how much variance the comb saves.
fn combs(rounds: usize) {
    println!(
        "\nLine integral: variance of n independent walks over that of a comb of n (C = 1 + x at collisions, 1 at the end)"
    );
    println!(
        "{:<34} {:>9} {:>9} {:>9}",
        "medium", "n = 4", "n = 16", "n = 64"
    );
    let row = |name: String, gain: [f64; 3]| {
        println!(
            "{name:<34} {:>9.1} {:>9.1} {:>9.1}",
            gain[0], gain[1], gain[2]
        );
    };
    for depth in [1.0, 3.0, 10.0] {
        let Ok(fog) = Homogeneous::new(depth) else {
            continue;
        };
        row(
            format!("homogeneous, majorant depth {depth}"),
            [4, 16, 64].map(|n| gain(&fog, n, rounds)),
        );
    }
    for depth in [1.0, 3.0, 10.0_f32] {
        let bump = move |p: Vec3<f32>| depth * (-18.0 * (p.x - 0.5) * (p.x - 0.5)).exp();
        let medium = Procedural::new(bump, depth);
        row(
            format!("bump, majorant depth {depth}"),
            [4, 16, 64].map(|n| gain(&medium, n, rounds)),
        );
    }
}

fn gain<M: Medium<f32>>(medium: &M, walks: u32, rounds: usize) -> f64 {
    let ray = Ray {
        origin: Vec3::uniform(0.0),
        direction: Vec3::splat([1.0, 0.0, 0.0]),
    };
    let source = |t: f32| 1.0 + t;
    let estimates = rounds * 16;
    let variance = |values: &mut dyn Iterator<Item = f64>| {
        let (mut sum, mut square, mut n) = (0.0, 0.0, 0.0);
        for v in values {
            sum += v;
            square += v * v;
            n += 1.0;
        }
        (square - sum * sum / n) / (n - 1.0)
    };
    let comb = variance(&mut (0..estimates).map(|i| {
        let mut rng = stream(i as u64);
        f64::from(line_integral::collisions(
            medium,
            &ray,
            1.0,
            walks,
            |t, _| source(t),
            1.0,
            &mut rng,
            true,
        ))
    }));
    let single = variance(&mut (0..estimates * 4).map(|i| {
        let flight = free_flight::delta::sample(medium, &ray, 1.0, &mut stream(i as u64), true);
        f64::from(if flight.collided {
            source(flight.t)
        } else {
            1.0
        })
    }));
    single / f64::from(walks) / comb
}

fn out_folder() -> PathBuf {
    let mut arguments = std::env::args().skip_while(|a| a != "--out").skip(1);
    let target = || {
        std::env::var_os("CARGO_TARGET_DIR").map_or_else(
            || PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../target"),
            PathBuf::from,
        )
    };
    arguments
        .next()
        .map_or_else(|| target().join("estimators"), PathBuf::from)
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let rounds = if quick() { 16 } else { 4096 };
    let folder = out_folder();
    std::fs::create_dir_all(&folder)?;
    let mut csv = "profile,method,biased,relative_variance,lookups,nanoseconds,variance_x_lookups,efficiency,bias,\
                   bias_standard_error,samples,seconds,relative_rmse\n".to_owned();
    let mut panels = Vec::new();
    println!("{} estimates a row, one thread, scalar f32", rounds * BATCH);
    for profile in Profile::all()? {
        let depth = profile.optical_depth();
        let truth = (-depth).exp();
        let methods = methods(&profile).ok_or("a profile out of range")?;
        let rows = measure(&methods, truth, rounds);
        println!(
            "\n{}: optical depth {depth:.3}, largest extinction x length 8",
            profile.name
        );
        println!(
            "{:<30} {:>10} {:>8} {:>10} {:>8} {:>17} {:>11} {:>10} {:>7}",
            "method",
            "variance",
            "look-ups",
            "product",
            "ns",
            "quartiles",
            "efficiency",
            "bias",
            "z"
        );
        let mut curves = Vec::new();
        for (method, row) in methods.iter().zip(&rows) {
            let product = row.variance * row.lookups;
            let efficiency = 1.0 / (row.variance * row.nanoseconds * 1e-9);
            let [bias, error] = row.bias;
            println!(
                "{:<30} {:>10.3e} {:>8.1} {product:>10.3e} {:>8.1} {:>8.1}-{:<8.1} {efficiency:>11.2e} {bias:>+10.1e} {:>7.1}{}",
                method.name,
                row.variance,
                row.lookups,
                row.nanoseconds,
                row.quartiles[0],
                row.quartiles[1],
                bias / error,
                if method.biased { "  BIASED" } else { "" }
            );
            let points: Vec<(f64, f64)> = row
                .errors
                .iter()
                .map(|&(n, e)| (n as f64 * row.nanoseconds * 1e-9, e))
                .collect();
            for (&(n, _), (seconds, rmse)) in row.errors.iter().zip(&points) {
                writeln!(
                    csv,
                    "{},{},{},{:e},{},{},{product:e},{efficiency:e},{bias:e},{error:e},{n},{seconds:e},{rmse:e}",
                    profile.name,
                    method.name.replace(',', ""),
                    method.biased,
                    row.variance,
                    row.lookups,
                    row.nanoseconds
                )?;
            }
            if !method.name.contains("tap") && method.name != "comb of 16 walks" {
                curves.push(Curve {
                    name: method.name.to_owned(),
                    points,
                    biased: method.biased,
                });
            }
        }
        panels.push(Panel {
            title: format!("{}, optical depth {depth:.2}", profile.name),
            curves,
        });
    }
    combs(rounds);
    std::fs::write(folder.join("estimators.csv"), csv)?;
    draw(&panels, &folder.join("estimators.svg"))?;
    println!(
        "\nwrote {} and .svg",
        folder.join("estimators.csv").display()
    );
    Ok(())
}
