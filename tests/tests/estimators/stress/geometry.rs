//! Clipping against boxes and spheres: zeros of both signs, rays along faces, far away, tiny and huge.

use super::{Worst, ray};
use woodcock_core::ray::{Interval, clip_to_box, clip_to_unit_sphere};
use woodcock_core::vec3::Vec3;
use woodcock_tests::stats::independent::SplitMix;

/// The part of a ray in a box, in double precision, a direction of zero being outside or inside for ever.
fn exact_box(o: [f32; 3], d: [f32; 3], size: [f32; 3]) -> (f64, f64) {
    let (mut t0, mut t1) = (0.0_f64, f64::INFINITY);
    for a in 0..3 {
        let (o, d, size) = (f64::from(o[a]), f64::from(d[a]), f64::from(size[a]));
        if d == 0.0 {
            if !(0.0..=size).contains(&o) {
                return (0.0, -1.0);
            }
        } else {
            let (near, far) = (-o / d, (size - o) / d);
            t0 = t0.max(near.min(far));
            t1 = t1.min(near.max(far));
        }
    }
    (t0, t1)
}

/// Components of directions: both zeros, tiny, ordinary.
const COMPONENTS: [f32; 9] = [0.0, -0.0, 1e-40, -1e-30, 1e-7, -1e-7, 0.6, -0.8, 1.0];

/// Errors of both ends, in units of what coordinates lose: 2⁻²⁴ (|o| + size)/|d|, and a relative 2⁻²³.
fn clipped(clip: impl Fn([f32; 3], [f32; 3], [f32; 3]) -> Interval<f32>) -> Worst {
    let mut worst = Worst::default();
    let mut rng = SplitMix::new(4);
    for unit in [1e-15_f32, 1e-3, 1.0, 1e6, 1e15] {
        for _ in 0..20_000 {
            let mut pick = |from: &[f32]| from[(rng.bits() % from.len() as u64) as usize];
            let size = [0; 3].map(|_| unit * pick(&[1.0, 0.5, 8.0, 1e-6, 1e6]));
            let d = [0; 3].map(|_| pick(&COMPONENTS));
            let o = [0, 1, 2].map(|a| {
                let share = pick(&[0.0, -0.0, 0.5, 0.25, 1.0, 2.0, -1.0, -1e6, 1e6]);
                share * size[a]
            });
            let largest = d.into_iter().fold(0.0_f32, |m, d| m.max(d.abs()));
            if largest < 0.5 {
                continue;
            }
            let (t0, t1) = exact_box(o, d, size);
            let found = clip(o, d, size);
            let at =
                || format!("from {o:?} along {d:?} in {size:?}: {found:?}, not {t0:e} to {t1:e}");
            let lost = (0..3).map(|a| {
                let d = f64::from(d[a].abs());
                let lost = f64::from(o[a].abs() + size[a]) / 16_777_216.0;
                if d > 4e-38 { lost / d } else { 0.0 }
            });
            let lost = lost.fold(0.0, f64::max)
                + 1e-7 * t0.abs().max(if t1 < 1e37 { t1.abs() } else { 0.0 });
            let hits = found.t0 < found.t1;
            let nan = found.t0.is_nan() || found.t1.is_nan();
            // Along a face a ray is inside or outside, both right; nearly empty intervals may be empty.
            let on_a_face = (0..3).any(|a| d[a].abs() < 4e-38 && (o[a] == 0.0 || o[a] == size[a]));
            let error = if nan {
                f64::INFINITY
            } else if t1 - t0 > 4.0 * lost && !on_a_face {
                let near = (f64::from(found.t0) - t0).abs() / lost;
                // What lies beyond 1e22 units is as good as no end.
                let far = if t1 > 1e22 * f64::from(unit) {
                    0.0
                } else {
                    (f64::from(found.t1) - t1).abs() / lost
                };
                if hits { near.max(far) } else { f64::INFINITY }
            } else if t0 - t1 > 4.0 * lost && hits {
                f64::INFINITY
            } else {
                0.0
            };
            worst.see(error, at);
        }
    }
    worst
}

#[test]
fn boxes_are_clipped_to_the_rounding_of_their_coordinates() {
    const BOUND: f64 = 3.0;
    let real = |o: [f32; 3], d: [f32; 3], size: [f32; 3]| {
        clip_to_box(Vec3::splat(o), Vec3::splat(d), Vec3::splat(size))
    };
    clipped(real).within("clipping to boxes, in units of lost digits", BOUND, 50_000);
    // Slabs as they stand in textbooks: 0 · ∞ along a face.
    let textbook = |o: [f32; 3], d: [f32; 3], size: [f32; 3]| {
        let (mut t0, mut t1) = (0.0_f32, f32::INFINITY);
        for a in 0..3 {
            let inverse = 1.0 / d[a];
            let (near, far) = ((0.0 - o[a]) * inverse, (size[a] - o[a]) * inverse);
            let (near, far) = if near < far { (near, far) } else { (far, near) };
            t0 = if t0 > near { t0 } else { near };
            t1 = if t1 < far { t1 } else { far };
        }
        Interval { t0, t1 }
    };
    clipped(textbook).must_fail("clipping with 0 times infinity", BOUND);
}

/// Half chords and middles of rays through the unit sphere, in units of what coordinates lose.
fn chords(clip: impl Fn([f32; 3], [f32; 3]) -> Interval<f32>) -> Worst {
    let mut worst = Worst::default();
    let mut rng = SplitMix::new(8);
    for far in [0.0_f64, 0.5, 2.0, 100.0, 1e4, 1e6] {
        for length in [1e-15_f64, 1e-3, 1.0, 1e3, 1e15] {
            for _ in 0..500 {
                let mut unit =
                    || woodcock_tests::grids::unit([rng.normal(), rng.normal(), rng.normal()]);
                let (d, aside) = (unit(), unit());
                let o: [f32; 3] = std::array::from_fn(|a| (-far * d[a] + 0.7 * aside[a]) as f32);
                let d = d.map(|v| (length * v) as f32);
                // Exactly: the quadratic in double precision, from the numbers as they are.
                let (o64, d64) = (o.map(f64::from), d.map(f64::from));
                let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
                let dd = dot(d64, d64);
                let closest = -dot(o64, d64) / dd;
                let foot: [f64; 3] = std::array::from_fn(|a| o64[a] + closest * d64[a]);
                let half_squared = (1.0 - dot(foot, foot)) / dd;
                let found = clip(o, d);
                let reach = dot(o64, o64).sqrt() + 1.0;
                let at = || format!("from {far:e} away, direction {length:e}: {found:?}");
                // In units of the sphere's radius.
                let radius = dd.sqrt();
                let lost = 1.2e-7 * reach;
                let (t0, t1) = (f64::from(found.t0) * radius, f64::from(found.t1) * radius);
                let half = half_squared.max(0.0).sqrt() * radius;
                let (a, b) = ((closest * radius - half).max(0.0), closest * radius + half);
                let error = if half_squared * dd < 8.0 * lost {
                    // Nearly missed: what matters is that nothing is NaN, and no chord is long.
                    let long = (t1 - t0).max(0.0).powi(2) / (40.0 * lost);
                    if t0.is_nan() || t1.is_nan() {
                        f64::INFINITY
                    } else {
                        long
                    }
                } else if b < -4.0 * lost {
                    if t1 <= t0 { 0.0 } else { (t1 - t0) / lost }
                } else {
                    // An end errs as half its square does.
                    let allowed = lost * (1.0 + 1.0 / half);
                    ((t0 - a).abs().max((t1.max(0.0) - b.max(0.0)).abs())) / allowed
                };
                worst.see(error, at);
            }
        }
    }
    worst
}

#[test]
fn spheres_are_clipped_from_afar() {
    const BOUND: f64 = 2.0;
    let real =
        |o: [f32; 3], d: [f32; 3]| clip_to_unit_sphere(Vec3::splat(o), Vec3::<f32>::splat(d));
    chords(real).within(
        "clipping to spheres, in units of lost digits",
        BOUND,
        10_000,
    );
    let textbook = |o: [f32; 3], d: [f32; 3]| {
        let (o, d) = (Vec3::<f32>::splat(o), Vec3::<f32>::splat(d));
        let (a, b, c) = (d.dot(d), o.dot(d), o.dot(o) - 1.0);
        let root = (b * b - a * c).max(0.0).sqrt();
        Interval {
            t0: ((-b - root) / a).max(0.0),
            t1: (-b + root) / a,
        }
    };
    chords(textbook).must_fail("the quadratic formula", BOUND);
}

/// A box at an offset of a million: places are exact there, as far as they are numbers at all.
#[test]
fn boxes_far_away_keep_their_faces() {
    use woodcock_core::enclosure::Enclosure;
    use woodcock_core::majorant::Cells;
    use woodcock_core::medium::ProceduralGrid;
    let low = [1e6_f32, -1e6, 1e6];
    let high = low.map(|x| x + 8.0);
    let cells = Cells::new(low, high, [4, 4, 4]).expect("a box");
    let one = |_: [Enclosure; 3]| Enclosure::new(0.0, 1.0);
    let mut bounds = vec![0.0; cells.majorant_count()];
    cells.fill_majorants(one, &mut bounds).expect("a bound");
    let medium = ProceduralGrid::new(|_: Vec3<f32>| 0.5_f32, cells, one, &bounds).expect("proved");
    for k in 0..=128 {
        let y = k as f32 / 16.0;
        let inside = medium.clip(&ray([1e6 - 4.0, -1e6 + y, 1e6 + 4.0], [1.0, 0.0, -0.0]));
        if y < 8.0 {
            assert_eq!((inside.t0, inside.t1), (4.0, 12.0), "y {y}");
        } else {
            assert!(
                inside.t1 <= 12.0 || inside.t1 <= inside.t0,
                "y {y}: {inside:?}"
            );
        }
    }
}
