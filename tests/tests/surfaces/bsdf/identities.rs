//! What holds for each pair of directions: the textbook's value, reciprocity, and the same value from either end.

use super::subject::{
    Mistake, Mistaken, Scatter, TRANSPORTS, any_direction, at, dielectric, diffuse, direction,
    metal, uniforms, white_metal,
};
use super::textbook;
use glam::DVec3;
use std::f64::consts::{PI, TAU};
use woodcock_host::bsdf::{Bsdf, Transport};
use woodcock_host::scene::MaterialKind;
use woodcock_tests::stats::independent::SplitMix;

const ALPHAS: [[f64; 2]; 4] = [[0.3, 0.3], [0.1, 0.5], [1.0, 1.0], [0.02, 0.05]];
const ETAS: [f64; 3] = [1.5, 0.7, 1.01];

/// Pairs of directions that a material knows: most by its own choice, for narrow ones are rarely met by chance.
fn pairs(bsdf: &Bsdf, seed: u64) -> Vec<[DVec3; 2]> {
    let mut rng = SplitMix::new(seed);
    let mut pairs = Vec::new();
    for i in 0..4000 {
        let a = any_direction(&mut rng);
        let b = if i % 4 == 0 {
            Some(any_direction(&mut rng))
        } else {
            bsdf.sample(a, uniforms(&mut rng), Transport::Radiance)
                .map(|sample| sample.direction)
        };
        pairs.extend(b.map(|b| [a, b]));
    }
    pairs
}

/// The largest relative difference of two numbers over pairs.
fn worst(pairs: &[[DVec3; 2]], both: impl Fn(DVec3, DVec3) -> (f64, f64)) -> f64 {
    pairs.iter().fold(0.0, |worst: f64, &[a, b]| {
        let (x, y) = both(a, b);
        let scale = x.abs().max(y.abs());
        if scale == 0.0 {
            worst
        } else {
            worst.max((x - y).abs() / scale)
        }
    })
}

#[test]
fn rough_values_are_the_textbooks() {
    let distance =
        |subject: &dyn Scatter, pairs: &[[DVec3; 2]], f: &dyn Fn(DVec3, DVec3) -> f64| {
            worst(pairs, |o, i| {
                (subject.eval(o, i, Transport::Radiance), f(o, i) * i.z.abs())
            })
        };
    for alpha in ALPHAS {
        for eta in ETAS {
            let bsdf = at(dielectric(eta, alpha), 0.0);
            let pairs = pairs(&bsdf, 11);
            let f = |o: DVec3, i: DVec3| textbook::dielectric(eta, alpha, o, i);
            let got = distance(&bsdf, &pairs, &f);
            // Half vectors and tangents of grazing angles lose digits in the textbook's form.
            assert!(got < 1e-6, "eta {eta}, alpha {alpha:?}: {got:e}");
            for mistake in [Mistake::EtaSquaredForgotten, Mistake::NothingMasked(alpha)] {
                let wrong = Mistaken {
                    bsdf,
                    eta,
                    tilt: 0.0,
                    mistake,
                };
                let got = distance(&wrong, &pairs, &f);
                assert!(got > 1e-2, "{mistake:?} passes: {got}");
            }
        }
        let bsdf = at(white_metal(alpha), 0.0);
        let f = |o: DVec3, i: DVec3| textbook::white_metal(alpha, o, i);
        let got = distance(&bsdf, &pairs(&bsdf, 12), &f);
        assert!(got < 1e-6, "metal, alpha {alpha:?}: {got:e}");
    }
    let bsdf = at(diffuse(0.8), 0.0);
    let lambert = |o: DVec3, i: DVec3| if o.z * i.z > 0.0 { 0.8 / PI } else { 0.0 };
    assert!(distance(&bsdf, &pairs(&bsdf, 13), &lambert) < 1e-14);
}

/// f(a, b) = f(b, a) where light stays on its side, f(a, b) / n_a² = f(b, a) / n_b² where it passes.
fn reciprocity(subject: &dyn Scatter, eta: f64, pairs: &[[DVec3; 2]]) -> f64 {
    let index = |w: DVec3| if w.z > 0.0 { 1.0 } else { eta };
    let f =
        |o: DVec3, i: DVec3| subject.eval(o, i, Transport::Radiance) / i.z.abs() / index(o).powi(2);
    worst(pairs, |a, b| (f(a, b), f(b, a)))
}

#[test]
fn light_may_be_reversed() {
    for alpha in ALPHAS {
        for eta in ETAS {
            let bsdf = at(dielectric(eta, alpha), 0.0);
            let pairs = pairs(&bsdf, 14);
            let got = reciprocity(&bsdf, eta, &pairs);
            assert!(got < 1e-6, "eta {eta}, alpha {alpha:?}: {got:e}");
            let mistake = Mistake::EtaSquaredForgotten;
            let wrong = Mistaken {
                bsdf,
                eta,
                tilt: 0.0,
                mistake,
            };
            assert!(reciprocity(&wrong, eta, &pairs) > 1e-2);
        }
        let bsdf = at(metal(0.2, 3.0, alpha), 0.0);
        assert!(reciprocity(&bsdf, 1.0, &pairs(&bsdf, 15)) < 1e-6);
    }
}

/// eval(a, b, Radiance) |a·ng| = eval(b, a, Importance) |b·ng|.
fn adjointness(subject: &dyn Scatter, pairs: &[[DVec3; 2]]) -> f64 {
    worst(pairs, |a, b| {
        (
            subject.eval(a, b, Transport::Radiance) * a.z.abs(),
            subject.eval(b, a, Transport::Importance) * b.z.abs(),
        )
    })
}

#[test]
fn paths_have_one_value_from_either_end() {
    for tilt in [0.0, 0.1, 0.6] {
        for alpha in ALPHAS {
            for eta in ETAS {
                let bsdf = at(dielectric(eta, alpha), tilt);
                let pairs = pairs(&bsdf, 16);
                let got = adjointness(&bsdf, &pairs);
                assert!(
                    got < 1e-6,
                    "tilt {tilt}, eta {eta}, alpha {alpha:?}: {got:e}"
                );
                let mut mistakes = vec![Mistake::EtaSquaredForgotten];
                if tilt > 0.0 {
                    mistakes.push(Mistake::NormalsUncorrected);
                }
                for mistake in mistakes {
                    let wrong = Mistaken {
                        bsdf,
                        eta,
                        tilt,
                        mistake,
                    };
                    let got = adjointness(&wrong, &pairs);
                    assert!(got > 1e-2, "{mistake:?} passes: {got}");
                }
            }
            let bsdf = at(metal(0.2, 3.0, alpha), tilt);
            assert!(adjointness(&bsdf, &pairs(&bsdf, 17)) < 1e-6);
        }
        let bsdf = at(diffuse(0.8), tilt);
        let pairs = pairs(&bsdf, 18);
        assert!(adjointness(&bsdf, &pairs) < 1e-12);
        if tilt > 0.0 {
            let mistake = Mistake::NormalsUncorrected;
            let wrong = Mistaken {
                bsdf,
                eta: 1.0,
                tilt,
                mistake,
            };
            assert!(adjointness(&wrong, &pairs) > 1e-2);
        }
    }
}

/// ∫ g(a) h(b) over all light that a specular surface sends from b to a, by paths from a and by paths from b; measures
/// are those of the geometric normal.
fn exchange(subject: &dyn Scatter, tests: [fn(DVec3) -> f64; 2], transport: Transport) -> f64 {
    const STEPS: u32 = 500;
    let [here, there] = match transport {
        Transport::Radiance => tests,
        Transport::Importance => [tests[1], tests[0]],
    };
    let mut sum = 0.0;
    for i in 0..STEPS {
        for j in 0..STEPS {
            let z = (2.0 * f64::from(i) + 1.0) / f64::from(STEPS) - 1.0;
            let a = direction(z, TAU * (f64::from(j) + 0.5) / f64::from(STEPS));
            let mut at = here(a) * z.abs();
            let kinds = [0.0, 1.0 - f64::EPSILON].map(|u| subject.sample(a, [u; 3], transport));
            let kinds = kinds.iter().flatten();
            at *= kinds
                .map(|choice| {
                    // Where one kind is all there is, both choices find it.
                    let share = if choice.pdf == 1.0 { 0.5 } else { choice.pdf };
                    share * choice.weight * there(choice.direction)
                })
                .sum::<f64>();
            sum += at;
        }
    }
    sum * 2.0 * TAU / f64::from(STEPS * STEPS)
}

#[test]
fn mirrors_and_lenses_are_adjoint_under_the_integral() {
    let tests: [fn(DVec3) -> f64; 2] = [
        |a| (1.0 + a.x).powi(2) * (1.3 + a.z) * (0.5 + a.y * a.y),
        |b| (1.2 - b.y).powi(2) * (1.7 - b.z) * (1.0 + 0.3 * b.x),
    ];
    let gap = |subject: &dyn Scatter| {
        let [radiance, importance] =
            TRANSPORTS.map(|transport| exchange(subject, tests, transport));
        assert!(radiance > 0.1);
        (radiance / importance - 1.0).abs()
    };
    for tilt in [0.0, 0.3] {
        let pane = MaterialKind::ThinDielectric { eta: 1.5 };
        for (kind, eta) in [
            (dielectric(1.5, [0.0; 2]), 1.5),
            (dielectric(0.6, [0.0; 2]), 0.6),
            (pane, 1.0),
            (metal(0.2, 3.0, [0.0; 2]), 1.0),
        ] {
            let bsdf = at(kind.clone(), tilt);
            // Rims of the region where both normals agree cost a part of a cell each.
            let got = gap(&bsdf);
            assert!(got < 3e-3, "{kind:?}, tilt {tilt}: {got:e}");
            let wrong = |mistake| Mistaken {
                bsdf,
                eta,
                tilt,
                mistake,
            };
            if eta != 1.0 {
                assert!(gap(&wrong(Mistake::EtaSquaredForgotten)) > 0.05);
            }
            if tilt > 0.0 {
                let got = gap(&wrong(Mistake::NormalsUncorrected));
                assert!(got > 0.015, "{kind:?}: normals uncorrected pass: {got}");
            }
        }
    }
}

#[test]
fn nothing_leaks_through_bent_normals() {
    let mut rng = SplitMix::new(19);
    let tilt = 0.5;
    let normal = direction(f64::cos(tilt), 0.7);
    let kinds = [
        diffuse(1.0),
        metal(0.2, 3.0, [0.4, 0.4]),
        metal(0.2, 3.0, [0.0; 2]),
        dielectric(1.5, [0.4, 0.4]),
        dielectric(1.5, [0.0; 2]),
    ];
    for kind in kinds {
        let transparent = matches!(kind, MaterialKind::Dielectric { .. });
        let is_diffuse = matches!(kind, MaterialKind::Diffuse { .. });
        let bsdf = at(kind, tilt);
        let mut seen = [0_u32; 2];
        for _ in 0..20_000 {
            let from = any_direction(&mut rng);
            for transport in TRANSPORTS {
                let chosen = bsdf.sample(from, uniforms(&mut rng), transport);
                let chance = any_direction(&mut rng);
                let candidates = [
                    (chosen.map(|sample| sample.direction), true),
                    (Some(chance), bsdf.pdf(from, chance, transport) > 0.0),
                    (Some(chance), bsdf.eval(from, chance, transport) != [0.0; 3]),
                ];
                for (to, is_lit) in candidates {
                    let (Some(to), true) = (to, is_lit) else {
                        continue;
                    };
                    let passes = from.z * to.z < 0.0;
                    let shaded = from.dot(normal) * to.dot(normal) < 0.0;
                    assert!(!passes || transparent, "light passes an opaque surface");
                    assert!(is_diffuse || passes == shaded, "normals disagree");
                    seen[usize::from(passes)] += 1;
                }
            }
        }
        assert!(
            seen[0] > 1000 && (!transparent || seen[1] > 1000),
            "{seen:?}"
        );
    }
}

#[test]
fn matched_indices_and_no_material_let_light_pass() {
    let mut rng = SplitMix::new(20);
    for alpha in [[0.0; 2], [0.5, 0.5]] {
        let bsdf = at(dielectric(1.0, alpha), 0.4);
        assert!(bsdf.is_specular());
        for _ in 0..100 {
            let from = any_direction(&mut rng);
            for transport in TRANSPORTS {
                let sample = bsdf.sample(from, uniforms(&mut rng), transport);
                let sample = sample.expect("always passes");
                assert_eq!(
                    (sample.direction, sample.weight, sample.pdf),
                    (-from, [1.0; 3], 1.0)
                );
                assert!(sample.specular);
            }
        }
    }
    // Nearly matched ones bend nearly nothing, but are boundaries.
    let sample = at(dielectric(1.001, [0.0; 2]), 0.0)
        .sample(direction(0.5, 0.0), [0.9; 3], Transport::Importance)
        .expect("refraction");
    let bend = (sample.direction + direction(0.5, 0.0)).length();
    // Δθ = (η − 1) tan θ to first order.
    assert!((bend - 0.001 * 3.0_f64.sqrt()).abs() < 1e-5, "{bend}");
}
