//! The pieces that every path is made of, in one lane and in eight.
//!
//! ```text
//! cargo bench -p woodcock-benches --bench kernels
//! ```
//!
//! Times are per group of eight numbers in both widths.
#![forbid(unsafe_code)]

use std::hint::black_box;

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use woodcock_benches::Cube;
use woodcock_core::majorant::{GridLayout, GridWalk, MajorantGrid};
use woodcock_core::phase::mie_fit::MieFit;
use woodcock_core::phase::tabulated::{Tabulated, fill_cumulative};
use woodcock_core::phase::{draine, henyey_greenstein};
use woodcock_core::ray::Ray;
use woodcock_core::real::{Mask, Real};
use woodcock_core::stream::{Key, KeyedStream, PathStream, Stream};
use woodcock_core::vec3::Vec3;
use woodcock_packet::bits::LaneStream;
use woodcock_packet::lanes::{LANES, Lanes};

const NUMBERS: usize = 1024;

/// Benches one function of numbers in (0, 1) in both widths.
fn both(
    c: &mut Criterion,
    name: &str,
    scalar: impl Fn(f32) -> f32,
    packet: impl Fn(Lanes) -> Lanes,
) {
    let inputs: Vec<f32> = (0..NUMBERS)
        .map(|i| (i as f32 + 0.5) / NUMBERS as f32)
        .collect();
    let groups: Vec<Lanes> = inputs
        .as_chunks::<LANES>()
        .0
        .iter()
        .map(|group| Lanes::new(*group))
        .collect();
    let mut group = c.benchmark_group(name);
    group.throughput(criterion::Throughput::Elements((NUMBERS / LANES) as u64));
    let mut out = inputs.clone();
    group.bench_function(BenchmarkId::from_parameter("x1"), |b| {
        b.iter(|| {
            for (out, x) in out.iter_mut().zip(black_box(&inputs)) {
                *out = scalar(*x);
            }
            black_box(&out);
        });
    });
    let mut out = groups.clone();
    group.bench_function(BenchmarkId::from_parameter("x8"), |b| {
        b.iter(|| {
            for (out, x) in out.iter_mut().zip(black_box(&groups)) {
                *out = packet(*x);
            }
            black_box(&out);
        });
    });
    group.finish();
}

fn elementary(c: &mut Criterion) {
    both(c, "elementary/ln", Real::ln, Real::ln);
    both(c, "elementary/neg_ln_1m", Real::neg_ln_1m, Real::neg_ln_1m);
    both(c, "elementary/exp", Real::exp, Real::exp);
    both(
        c,
        "elementary/sin_cos_turn",
        |x| x.sin_cos_turn().0,
        |x| x.sin_cos_turn().0,
    );
}

fn phase(c: &mut Criterion) {
    let g = 0.85;
    both(
        c,
        "phase/henyey_greenstein/sample",
        |u| henyey_greenstein::sample(u, g),
        |u| henyey_greenstein::sample(u, Lanes::splat(g)),
    );
    both(
        c,
        "phase/henyey_greenstein/eval",
        |u| henyey_greenstein::eval(u, g),
        |u| henyey_greenstein::eval(u, Lanes::splat(g)),
    );
    let alpha = 20.0;
    both(
        c,
        "phase/draine/sample",
        |u| draine::sample(u, g, alpha),
        |u| draine::sample(u, Lanes::splat(g), Lanes::splat(alpha)),
    );
    let diameter = 20.0;
    if let (Ok(one), Ok(eight)) = (MieFit::<f32>::new(diameter), MieFit::<Lanes>::new(diameter)) {
        both(
            c,
            "phase/mie_fit/sample",
            |u| one.sample(u),
            |u| eight.sample(u),
        );
    }
    // The same lobe as Henyey–Greenstein's above, from 1024 segments.
    let cosines: Vec<f32> = (0..=1024).map(|i| i as f32 / 512.0 - 1.0).collect();
    let values: Vec<f32> = cosines
        .iter()
        .map(|&cosine| henyey_greenstein::eval(cosine, g))
        .collect();
    let mut cumulative = vec![0.0; cosines.len()];
    if fill_cumulative(&cosines, &values, &mut cumulative).is_ok()
        && let Ok(table) = Tabulated::new(&cosines, &values, &cumulative)
    {
        both(
            c,
            "phase/tabulated/sample",
            |u| table.sample(u),
            |u| table.sample(u),
        );
    }
}

/// 1024 numbers from a stream of one path, or 128 from each of eight.
fn draws<R: Real, S: KeyedStream<R>>(
    c: &mut Criterion,
    name: &str,
    draw: impl Fn(&mut S, R::Mask) -> R,
) {
    let mut stream = S::idle();
    for lane in 0..R::LANES {
        stream.set_key(
            lane,
            Key {
                seed: 3,
                pixel: lane as u32,
                sample: 0,
            },
        );
    }
    let mut group = c.benchmark_group(name);
    group.throughput(criterion::Throughput::Elements((NUMBERS / LANES) as u64));
    let all = R::Mask::splat(true);
    group.bench_function(BenchmarkId::from_parameter(format!("x{}", R::LANES)), |b| {
        b.iter(|| {
            let mut sum = R::zero();
            for _ in 0..NUMBERS / R::LANES {
                sum = sum + draw(&mut stream, black_box(all));
            }
            black_box(sum)
        });
    });
    group.finish();
}

fn stream(c: &mut Criterion) {
    draws::<f32, PathStream>(c, "stream/uniform", Stream::<f32>::uniform);
    draws::<Lanes, LaneStream>(c, "stream/uniform", |s, all| s.uniform(all));
    draws::<f32, PathStream>(c, "stream/exponential", |s, all| {
        Stream::<f32>::exponential(s, all)
    });
    draws::<Lanes, LaneStream>(c, "stream/exponential", |s, all| s.exponential(all));
}

fn look_ups(c: &mut Criterion) {
    for side in [64, 256] {
        let Ok(cube) = Cube::new(side) else { continue };
        let Ok(bounds) = MajorantGrid::new(&cube.samples, [side; 3], &cube.majorants) else {
            continue;
        };
        look_up::<f32, PathStream>(c, &cube, &bounds);
        look_up::<Lanes, LaneStream>(c, &cube, &bounds);
    }
}

/// One-tap and trilinear look-ups at 1024 places along a ray within one block.
fn look_up<R: Real, S: KeyedStream<R>>(c: &mut Criterion, cube: &Cube, bounds: &MajorantGrid<'_>) {
    let layout = GridLayout::<R>::of(bounds, 1.0);
    let all = R::Mask::splat(true);
    let middle = (cube.side / 2) as f32;
    let ray = Ray {
        origin: Vec3::splat([middle + 0.1; 3]),
        direction: Vec3::splat([0.6, 0.64, 0.48]),
    };
    let mut walk = GridWalk::idle();
    walk.begin(&layout, &ray, &cube.majorants, all);
    draws::<R, S>(
        c,
        &format!("look_up/one_tap/grid{}", cube.side),
        |stream, all| {
            let t = stream.uniform(all) * R::splat(10.0);
            walk.sigma_t(&cube.samples, t, stream, all)
        },
    );
    draws::<R, S>(
        c,
        &format!("look_up/trilinear/grid{}", cube.side),
        |stream, all| {
            let t = stream.uniform(all) * R::splat(10.0);
            walk.trilinear(&cube.samples, t)
        },
    );
}

criterion_group!(kernels, elementary, stream, phase, look_ups);
criterion_main!(kernels);
