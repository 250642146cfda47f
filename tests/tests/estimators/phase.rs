//! Phase functions: every row normalised, sampled with its own density, and inverted by its own inverse.
//!
//! Quadrature, tables and round trips first; then a histogram of sampled cosines. The checks must reject every
//! planted mistake.

use std::f64::consts::PI;
use woodcock_core::for_each_phase;
use woodcock_core::phase;
use woodcock_core::real::Real;
use woodcock_core::stream::{PathStream, Stream};
use woodcock_packet::lanes::{LANES, Lanes};
use woodcock_tests::refs::phase_functions::{Kind, load};
use woodcock_tests::refs::quadrature::integrate;
use woodcock_tests::stats::{
    ChiSquare, Mutants, Sample, Verdict, assert_verdict, judge_within, samples, seed,
};
use woodcock_tests::widths::{collect, everyone};

mod rows;
use rows::Trio;

/// ∫ f over [−1, 1], on panels that shrink towards both ends, where narrow lobes sit.
fn over_cosines(mut f: impl FnMut(f64) -> f64) -> f64 {
    let mut edges: Vec<f64> = (1..48).map(|k| 1.0 - 0.5_f64.powi(k)).collect();
    edges.extend([0.0, 1.0]);
    edges.sort_by(f64::total_cmp);
    edges
        .windows(2)
        .map(|w| integrate(w[0], w[1], 1, &mut f) + integrate(-w[1], -w[0], 1, &mut f))
        .sum()
}

fn integrals<T: Trio>() {
    for (g, kind) in T::parameters() {
        let double = |c: f64| 2.0 * PI * T::eval(c, f64::from(g));
        let close = |what: &str, got: f64, expected: f64, by: f64| {
            assert!(
                (got - expected).abs() <= by,
                "{what} at {kind:?}: {got} for {expected}"
            );
        };
        // 1/4π is a constant of `f32`, good to 5e-8.
        close("norm", over_cosines(double), 1.0, 1e-7);
        close(
            "mean cosine",
            over_cosines(|c| c * double(c)),
            f64::from(g),
            1e-7,
        );
        // The density of `f32` against that of `f64`, everywhere.
        for i in -4000..=4000 {
            let c = i as f32 / 4000.0;
            let (one, exact) = (f64::from(T::eval(c, g)), kind.eval(f64::from(c)));
            assert!(
                (one / exact - 1.0).abs() < 2e-6,
                "p({c}) at {kind:?}: {one} for {exact}"
            );
        }
    }
}

fn tables<T: Trio>() {
    let table = load();
    let mut compared = 0;
    for (g, kind) in T::parameters() {
        let near = |other: &Kind| match (kind, other) {
            (Kind::Hg { g }, Kind::Hg { g: other }) => (g - other).abs() < 1e-6,
            (kind, other) => kind == *other,
        };
        for function in table.functions.iter().filter(|f| near(&f.kind)) {
            let exact_g = match function.kind {
                Kind::Hg { g } => g,
                _ => f64::from(g),
            };
            compared += 1;
            for (i, &c) in table.cos.iter().enumerate() {
                let p = T::eval(c, exact_g);
                assert!((p / function.p[i] - 1.0).abs() < 1e-7, "p({c}) at {kind:?}");
                let u = T::invert(c, exact_g);
                let u = if exact_g < 0.0 { 1.0 - u } else { u };
                assert!(
                    (u - function.cdf[i]).abs() < 1e-12,
                    "cdf({c}) at {kind:?}: {u}"
                );
            }
            for (i, &xi) in table.xi.iter().enumerate() {
                // Core counts from the back of the lobe, the table from the cosine −1.
                let xi = if exact_g < 0.0 { 1.0 - xi } else { xi };
                let exact = function.inv_cdf[i];
                let c = T::sample(xi, exact_g);
                assert!(
                    (c - exact).abs() < 1e-7,
                    "cosine at {xi} of {kind:?}: {c} for {exact}"
                );
                let c = f64::from(T::sample(xi as f32, exact_g as f32));
                assert!(
                    (c - exact).abs() < 1e-6,
                    "cosine at {xi} of {kind:?} in f32: {c} for {exact}"
                );
            }
        }
    }
    assert!(compared > 0, "the table has none of these");
}

/// Uniform numbers at both ends and between.
fn uniforms() -> Vec<f32> {
    let below_one = 1.0_f32.next_down();
    let mut all = vec![
        0.0,
        f32::MIN_POSITIVE,
        2.0_f32.powi(-32),
        2.0_f32.powi(-24),
        0.5,
        below_one,
    ];
    all.extend((0..4096).map(|i| (i as f32 + 0.5) / 4096.0));
    all.extend((1..200).map(|i| 1.0 - i as f32 * 2.0_f32.powi(-24)));
    all.extend((1..200).map(|i| i as f32 * 2.0_f32.powi(-24)));
    all
}

fn round_trips<T: Trio>() {
    for (g, kind) in T::parameters() {
        let mut before = -1.0;
        let mut sorted = uniforms();
        sorted.sort_by(f32::total_cmp);
        for &u in &sorted {
            let cosine = T::sample(u, g);
            assert!(
                (-1.0..=1.0).contains(&cosine),
                "cosine {cosine} at {u:e} of {kind:?}"
            );
            // A lobe of negative g is turned around: its cosines fall.
            let rising = if g < 0.0 || g.is_sign_negative() && g != 0.0 {
                -cosine
            } else {
                cosine
            };
            assert!(
                rising >= before - 4e-7,
                "cosines of {kind:?} turn back at {u:e}"
            );
            before = rising.max(before);
            // In double precision the trip is exact; in f32 within what one digit of the cosine is worth.
            let (u, g) = (f64::from(u), f64::from(g));
            let back = T::invert(T::sample(u, g), g);
            assert!(
                (back - u).abs() < 1e-7,
                "{u:e} comes back as {back:e} at {kind:?}"
            );
            let back = f64::from(T::invert(cosine, g as f32));
            let density = 2.0 * PI * kind.eval(f64::from(cosine));
            assert!(
                (back - u).abs() < 2e-6 + 3e-7 * density,
                "{u:e} comes back as {back:e} at {kind:?} in f32"
            );
        }
    }
}

/// Error of sampled cosines against double precision; parameters beyond what the tables cover.
fn extremes<T: Trio>() {
    let magnitudes = [1e-7_f32, 1e-6, 1e-5, 0.9999, 0.99999, 0.999_999, 1.0 - 1e-7];
    for g in magnitudes.into_iter().flat_map(|g| [g, -g]) {
        for u in uniforms() {
            let cosine = T::sample(u, g);
            assert!((-1.0..=1.0).contains(&cosine), "{cosine} at {u:e}, g {g}");
            let exact = T::sample(f64::from(u), f64::from(g));
            let allowed = if g.abs() <= 0.9999 { 2e-7 } else { 1e-6 };
            assert!(
                (f64::from(cosine) - exact).abs() <= allowed,
                "{cosine} for {exact} at {u:e}, g {g}"
            );
            let density = T::eval(cosine, g);
            assert!(
                density > 0.0 && density.is_finite(),
                "p = {density} at {u:e}, g {g}"
            );
            let back = T::invert(cosine, g);
            assert!(
                (0.0..=1.0 + 1e-6).contains(&back),
                "u = {back} at {u:e}, g {g}"
            );
        }
    }
}

fn lanes<T: Trio>() {
    let cosines: Vec<f32> = (-1000..=1000).map(|i| i as f32 / 1000.0).collect();
    let uniforms = uniforms();
    for (at, (g, kind)) in T::parameters().into_iter().enumerate() {
        let parameters = T::parameters();
        // Neighbouring lanes have other parameters.
        let g_of = |lane: usize| parameters[(at + lane) % parameters.len()].0;
        let gs: [f32; LANES] = std::array::from_fn(g_of);
        let same = |values: &[f32], one: fn(f32, f32) -> f32, eight: fn(Lanes, Lanes) -> Lanes| {
            for chunk in values.chunks_exact(LANES) {
                let x: [f32; LANES] = chunk.try_into().expect("eight");
                let wide = eight(Lanes::new(x), Lanes::new(gs)).to_array();
                for lane in 0..LANES {
                    assert_eq!(
                        wide[lane].to_bits(),
                        one(x[lane], gs[lane]).to_bits(),
                        "{kind:?} at {}",
                        x[lane]
                    );
                }
            }
        };
        let _ = g;
        same(&cosines, T::eval::<f32>, T::eval::<Lanes>);
        same(&cosines, T::invert::<f32>, T::invert::<Lanes>);
        same(&uniforms, T::sample::<f32>, T::sample::<Lanes>);
    }
}

const CELLS: usize = 64;

/// Histogram over cells of equal probability under `inverse`, the exact distribution function.
fn histogram(cosines: &[f64], inverse: impl Fn(f64) -> f64) -> Verdict {
    let mut counts = [0_u64; CELLS];
    for &c in cosines {
        let cell = (inverse(c) * CELLS as f64) as usize;
        counts[cell.min(CELLS - 1)] += 1;
    }
    ChiSquare::new(&counts, &[1.0 / CELLS as f64; CELLS]).verdict(0.02)
}

/// P(cosine < c), from the formula in another arrangement than core's.
fn cumulative(kind: Kind, c: f64) -> f64 {
    match kind {
        Kind::Hg { g } if g.abs() < 1e-5 => 0.5 * (1.0 + c) + 0.75 * g * (c * c - 1.0),
        Kind::Hg { g } => {
            let s = ((1.0 - g).powi(2) + 2.0 * g * (1.0 - c)).sqrt();
            (1.0 - g * g) / (2.0 * g) * (1.0 / s - 1.0 / (1.0 + g))
        }
        _ => (c.powi(3) + 3.0 * c + 4.0) / 8.0,
    }
}

fn draws(pixel: u32, sample: impl Fn(f32) -> f32) -> Vec<f64> {
    collect::<f32, PathStream>(seed(61), pixel, samples(1 << 18), |rng| {
        sample(Stream::<f32>::uniform(rng, everyone::<f32>()))
    })
}

fn sampled<T: Trio>() {
    for (pixel, (g, kind)) in (0..).zip(T::parameters()) {
        let cosines = draws(pixel, |u| T::sample(u, g));
        let name = format!("{kind:?}");
        if g.abs() <= 0.99 {
            assert_verdict(&name, histogram(&cosines, |c| cumulative(kind, c)));
        }
        let mean: Sample = cosines.into_iter().collect();
        assert_verdict(&name, judge_within(mean.moments(), f64::from(g), 0.0015));
    }
}

#[test]
fn mutants_die() {
    type Sampler = fn(f32) -> f32;
    let mutants: [(&str, Sampler); 6] = [
        ("sign of g", |u| phase::henyey_greenstein::sample(u, -0.6)),
        ("g off by one percent", |u| {
            phase::henyey_greenstein::sample(u, 0.606)
        }),
        ("uniform angle instead of cosine", |u| {
            (std::f32::consts::PI * u).cos()
        }),
        ("backward half lost", |u| {
            phase::henyey_greenstein::sample(0.2 + 0.8 * u, 0.6)
        }),
        ("g squared forgotten", |u| {
            let a = (1.0 - 0.6 * 0.6) / (1.0 - 0.6 + 2.0 * 0.6 * u);
            ((1.0 - a * a) / 1.2).clamp(-1.0, 1.0)
        }),
        ("Schlick's approximation", |u| {
            let k = 1.55 * 0.6 - 0.55 * 0.216;
            (2.0 * u + k - 1.0) / (2.0 * k * u - k + 1.0)
        }),
    ];
    let kind = Kind::Hg {
        g: f64::from(0.6_f32),
    };
    let mut suite = Mutants::new("phase", &mutants.map(|(name, _)| name));
    let verdicts = |sampler: &dyn Fn(f32) -> f32| {
        let cosines = collect::<f32, PathStream>(seed(62), 0, samples(1 << 20), |rng| {
            sampler(Stream::<f32>::uniform(rng, true))
        });
        let law = histogram(&cosines, |c| cumulative(kind, c));
        let mean: Sample = cosines.into_iter().collect();
        (law, judge_within(mean.moments(), f64::from(0.6_f32), 0.001))
    };
    let (law, mean) = verdicts(&|u| phase::henyey_greenstein::sample(u, 0.6));
    suite.check("histogram", law);
    suite.check("mean cosine", mean);
    for (name, sampler) in mutants {
        let (law, mean) = verdicts(&sampler);
        suite.trial("histogram", name, law);
        suite.trial("mean cosine", name, mean);
    }
    suite.finish();
}

/// A table of densities in a wrong measure, or unnormalised, fails the integrals.
#[test]
fn wrong_densities_have_wrong_integrals() {
    let wrong: [fn(f64) -> f64; 3] = [
        |c| Kind::Hg { g: 0.6 }.eval(c) * (1.0 - c * c).sqrt(),
        |c| Kind::Hg { g: 0.6 }.eval(c) * 4.0 * PI,
        |c| Kind::Hg { g: 0.606 }.eval(c),
    ];
    for (i, p) in wrong.into_iter().enumerate() {
        let norm = over_cosines(|c| 2.0 * PI * p(c));
        let mean = over_cosines(|c| 2.0 * PI * c * p(c));
        assert!(
            (norm - 1.0).abs() > 1e-3 || (mean - 0.6).abs() > 1e-3,
            "mistake {i} passes"
        );
    }
}

/// The mixture of rows by mask: each lane follows its own law.
#[test]
fn lanes_of_both_laws_share_a_packet() {
    use woodcock_core::phase::Phase;
    use woodcock_packet::lanes::LaneMask;
    let g = [0.0, 0.3, -0.3, 0.9, 0.5, -0.8, 0.1, 0.99];
    for bits in [0, 0xff, 0b1010_0110] {
        let wide = Phase::<Lanes> {
            g: Lanes::new(g),
            rayleigh: LaneMask::from_bits(bits),
        };
        for i in 0..100 {
            let u = i as f32 / 100.0;
            let cosines = wide.sample::<true>(Lanes::splat(u)).to_array();
            let densities = wide.eval::<true>(Lanes::splat(u)).to_array();
            for lane in 0..LANES {
                let one = Phase::<f32> {
                    g: g[lane],
                    rayleigh: bits >> lane & 1 == 1,
                };
                assert_eq!(cosines[lane].to_bits(), one.sample::<true>(u).to_bits());
                assert_eq!(densities[lane].to_bits(), one.eval::<true>(u).to_bits());
                if !one.rayleigh {
                    assert_eq!(
                        one.sample::<false>(u).to_bits(),
                        one.sample::<true>(u).to_bits()
                    );
                }
            }
        }
    }
}

macro_rules! row {
    ($name:ident) => {
        mod $name {
            type Row = super::rows::$name;
            #[test]
            fn integrals_are_those_of_a_density() {
                super::integrals::<Row>();
            }
            #[test]
            fn tables_are_reproduced() {
                super::tables::<Row>();
            }
            #[test]
            fn sampling_and_inverting_are_one_map() {
                super::round_trips::<Row>();
            }
            #[test]
            fn extremes_stay_in_range() {
                super::extremes::<Row>();
            }
            #[test]
            fn cosines_follow_the_density() {
                super::sampled::<Row>();
            }
            #[test]
            fn lanes_have_the_bits_of_scalars() {
                super::lanes::<Row>();
            }
        }
    };
}
for_each_phase!(row);
