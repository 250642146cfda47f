//! Phase functions at both ends of u and g, and deflections about every axis.

use super::{Worst, decades, relative};
use woodcock_core::phase::{henyey_greenstein, isotropic, rayleigh};
use woodcock_core::real::Real;
use woodcock_core::vec3::Vec3;
use woodcock_tests::stats::independent::SplitMix;

/// Uniform numbers at both ends, at powers of two and in between.
fn uniforms() -> Vec<f32> {
    let mut all: Vec<f32> = vec![
        0.0,
        f32::from_bits(1),
        0.5,
        0.5_f32.next_down(),
        0.5_f32.next_up(),
    ];
    for e in 1..=128 {
        let power = 2.0_f64.powi(-e) as f32;
        all.extend([power, 1.5 * power, 1.0 - power]);
    }
    all.extend((0..2000).map(|i| (i as f32 + 0.37) / 2000.0));
    all.retain(|u| (0.0..1.0).contains(u));
    all
}

/// Mean cosines from 10⁻⁴⁰ to 1 − 2⁻²⁴, of both signs.
fn mean_cosines(largest: f32) -> Vec<f32> {
    let mut all: Vec<f32> = decades(-40, -1, 1).collect();
    all.extend((1..24).map(|e| 1.0 - 2.0_f64.powi(-e) as f32));
    all.extend([
        0.0,
        0.3,
        0.76,
        0.877,
        0.9999,
        1.0 - 1e-7,
        1.0_f32.next_down(),
    ]);
    all.retain(|g| *g <= largest);
    all.iter().flat_map(|&g| [g, -g]).collect()
}

/// The cosine in double precision, by the form that does not divide by g.
fn exact_cosine(u: f32, g: f32) -> f64 {
    let (u, magnitude) = (f64::from(u), f64::from(g.abs()));
    let rest = 1.0 - magnitude;
    let below = rest + 2.0 * magnitude * u;
    let a = (2.0 * u - rest) / below;
    let cosine = a + 0.5 * magnitude * (1.0 - a) * (1.0 + a);
    if g < 0.0 { -cosine } else { cosine }
}

fn cosines(largest: f32, sample: impl Fn(f32, f32) -> f32) -> Worst {
    let mut worst = Worst::default();
    for g in mean_cosines(largest) {
        for u in uniforms() {
            let found = sample(u, g);
            let inside = (-1.0..=1.0).contains(&found);
            let error = if inside {
                (f64::from(found) - exact_cosine(u, g)).abs()
            } else {
                f64::INFINITY
            };
            worst.see(error, || format!("g {g:e}, u {u:e}: {found:e}"));
        }
    }
    worst
}

#[test]
fn henyey_greenstein_is_sampled_at_every_g() {
    const BOUND: f64 = 2.5e-7;
    cosines(0.9999, henyey_greenstein::sample).within("cosines up to 0.9999", BOUND, 100_000);
    cosines(1.0, henyey_greenstein::sample).within("cosines up to 1 - 2^-24", 3e-7, 100_000);
    let textbook = |u: f32, g: f32| {
        if g.abs() < 1e-6 {
            return 2.0 * u - 1.0;
        }
        let root = (1.0 - g * g) / (1.0 - g + 2.0 * g * u);
        (1.0 + g * g - root * root) / (2.0 * g)
    };
    cosines(0.9999, textbook).must_fail("a division by 2g", BOUND);
}

/// The density, relative, where a cosine is a number of `f32` exactly.
fn densities(eval: impl Fn(f32, f32) -> f32) -> Worst {
    let mut worst = Worst::default();
    let near_one = (0..200_u32).map(|i| f32::from_bits(1.0_f32.to_bits() - i));
    let even = (0..=200).map(|i| (f64::from(i) / 100.0 - 1.0) as f32);
    let cosines: Vec<f32> = near_one.flat_map(|c| [c, -c]).chain(even).collect();
    for g in mean_cosines(1.0) {
        for &c in &cosines {
            let (c64, g64) = (f64::from(c), f64::from(g));
            let forward = if g < 0.0 { -c64 } else { c64 };
            let rest = 1.0 - g64.abs();
            let base = rest * rest + 2.0 * g64.abs() * (1.0 - forward);
            let exact = rest * (1.0 + g64.abs()) / base.powf(1.5) / (4.0 * std::f64::consts::PI);
            worst.see(relative(eval(c, g), exact), || {
                format!("g {g:e}, cosine {c}")
            });
        }
    }
    worst
}

#[test]
fn the_peak_of_henyey_greenstein_is_that_of_its_formula() {
    const BOUND: f64 = 6e-7;
    densities(henyey_greenstein::eval).within("densities", BOUND, 100_000);
    let textbook = |c: f32, g: f32| {
        let base = 1.0 + g * g - 2.0 * g * c;
        0.079_577_47 * (1.0 - g * g) / (base * base.sqrt())
    };
    densities(textbook).must_fail("1 + g² - 2gc", BOUND);
}

#[test]
fn rayleigh_and_isotropic_cosines_are_right_at_both_ends() {
    const BOUND: f64 = 6e-7;
    for u in uniforms() {
        let exact = 2.0 * f64::from(u) - 1.0;
        assert_eq!(isotropic::sample(u), exact as f32);
    }
    roots(rayleigh::sample).within("Rayleigh's cosines, relative", BOUND, 2000);
    // Cube roots of the two halves, as tables have it: they cancel in the middle.
    let cardano = |u: f32| {
        let q = 4.0 * u - 2.0;
        let cbrt = |x: f32| x.signum() * Real::exp(Real::ln(x.abs().max(1e-30)) / 3.0);
        let root = (q * q + 1.0).sqrt();
        (cbrt(q + root) + cbrt(q - root)).clamp(-1.0, 1.0)
    };
    roots(cardano).must_fail("Cardano's formula", BOUND);
}

/// Relative errors of the root of μ³ + 3μ = 8u − 4.
fn roots(sample: impl Fn(f32) -> f32) -> Worst {
    let mut worst = Worst::default();
    for u in uniforms() {
        let target = 8.0 * f64::from(u) - 4.0;
        let (mut low, mut high) = (-1.0_f64, 1.0_f64);
        for _ in 0..100 {
            let middle = 0.5 * (low + high);
            if middle * (middle * middle + 3.0) < target {
                low = middle;
            } else {
                high = middle;
            }
        }
        let exact = if target == 0.0 { 0.0 } else { low };
        let found = sample(u);
        assert!((-1.0..=1.0).contains(&found), "u {u:e}: {found}");
        worst.see(relative(found, exact), || {
            format!("u {u:e}: {found:e}, {exact:e}")
        });
    }
    worst
}

/// Length less one and cosine less the one asked for, the larger.
fn deflections(deflect: impl Fn(Vec3<f32>, f32, f32) -> Vec3<f32>) -> Worst {
    let mut worst = Worst::default();
    let mut rng = SplitMix::new(31);
    let mut axes: Vec<[f64; 3]> = Vec::new();
    for z in [1.0, -1.0] {
        for off in [0.0, -0.0, 1e-40, 1e-30, 1e-10, 1e-7, 3e-4, 0.01] {
            axes.extend([[off, 0.0, z], [-off, off, z], [0.0, -off, z]]);
        }
        axes.extend([[z, 0.0, -0.0], [0.0, z, 0.0], [z, 1e-30, -1e-30]]);
    }
    axes.extend((0..200).map(|_| [rng.normal(), rng.normal(), rng.normal()]));
    let cosines = [
        1.0,
        -1.0,
        1.0_f32.next_down(),
        -1.0_f32.next_down(),
        0.0,
        -0.0,
        1e-30,
        -1e-30,
        0.3,
        -0.7,
        0.9998,
        0.999_999,
    ];
    for axis in axes {
        let axis = woodcock_tests::grids::unit(axis).map(|v| v as f32);
        for cosine in cosines {
            for turn in [0.0_f32, 0.125, 0.25, 0.37, 0.5, 0.75, 1.0_f32.next_down()] {
                let found = deflect(Vec3::splat(axis), cosine, turn)
                    .lane(0)
                    .map(f64::from);
                let length = found.iter().map(|v| v * v).sum::<f64>().sqrt();
                let unit = woodcock_tests::grids::unit(axis.map(f64::from));
                let got = (0..3).map(|a| unit[a] * found[a]).sum::<f64>();
                let error = (length - 1.0).abs() + (got - f64::from(cosine)).abs();
                worst.see(error, || {
                    format!("{axis:?} by {cosine} at {turn}: {found:?}")
                });
            }
        }
    }
    worst
}

#[test]
fn deflections_have_their_angle_about_every_axis() {
    const BOUND: f64 = 4e-7;
    deflections(Vec3::deflected).within("deflections", BOUND, 10_000);
    // The frame without its sign has a pole.
    let with_a_pole = |d: Vec3<f32>, cosine: f32, turn: f32| {
        let sine = (1.0 - cosine * cosine).max(0.0).sqrt();
        let (sin_phi, cos_phi) = turn.sin_cos_turn();
        let a = -1.0 / (1.0 + d.z);
        let b = d.x * d.y * a;
        let tangent = Vec3::new(1.0 + d.x * d.x * a, b, -d.x);
        let bitangent = Vec3::new(b, 1.0 + d.y * d.y * a, -d.y);
        tangent * (sine * cos_phi) + bitangent * (sine * sin_phi) + d * cosine
    };
    deflections(with_a_pole).must_fail("a frame with a pole", BOUND);
}

/// A million deflections of one direction: it keeps its length.
#[test]
fn a_long_chain_of_deflections_keeps_unit_length() {
    let mut rng = SplitMix::new(12);
    let mut direction = Vec3::new(0.0_f32, 0.0, 1.0);
    let mut worst = Worst::default();
    for i in 0..1_000_000 {
        let cosine = henyey_greenstein::sample(rng.uniform() as f32, 0.99);
        direction = direction.deflected(cosine, rng.uniform() as f32);
        let length = f64::from(direction.dot(direction)).sqrt();
        worst.see((length - 1.0).abs(), || format!("deflection {i}"));
    }
    worst.within("lengths after a million deflections", 3e-7, 1_000_000);
}
