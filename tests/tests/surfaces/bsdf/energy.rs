//! White furnaces: what comes back of uniform light.

use super::subject::{
    Mistake, Mistaken, Scatter, TRANSPORTS, any_direction, at, dielectric, diffuse, direction,
    metal, uniforms, white_metal,
};
use glam::DVec3;
use std::f64::consts::TAU;
use woodcock_host::bsdf::Transport;
use woodcock_host::scene::MaterialKind;
use woodcock_tests::refs::quadrature::{close, integrate};
use woodcock_tests::stats::independent::SplitMix;
use woodcock_tests::stats::{Moments, assert_mean_agrees, judge, must_kill, samples};

/// ∫ eval over directions above (`sign` 1) or below (−1) the plane, of a smooth function.
fn above(subject: &dyn Scatter, from: DVec3, sign: f64, transport: Transport) -> f64 {
    in_panels(subject, from, sign, transport, 6)
}

/// The same in so many panels per axis: more where bent normals cut the function off.
fn in_panels(
    subject: &dyn Scatter,
    from: DVec3,
    sign: f64,
    transport: Transport,
    panels: usize,
) -> f64 {
    // Azimuths from that of the mirror; heights are dense near the plane.
    let mirror = (-from.y).atan2(-from.x);
    integrate(0.0, 1.0, panels, |x| {
        let ring = integrate(0.0, TAU, panels, |phi| {
            subject.eval(from, direction(sign * x * x, mirror + phi), transport)
        });
        ring * 2.0 * x
    })
}

/// The part of light from one direction that goes on, as power.
fn albedo(subject: &dyn Scatter, from: DVec3) -> f64 {
    above(subject, from, 1.0, Transport::Importance)
        + above(subject, from, -1.0, Transport::Importance)
}

#[test]
fn the_roughest_metal_reflects_by_a_closed_form() {
    // α = 1: D = 1/π, s = 1, so f = 1 / (2π (vz + wz)), which integrates to 1 − vz ln(1 + 1/vz).
    let bsdf = at(white_metal([1.0; 2]), 0.0);
    for z in [1.0, 0.7, 0.3, 0.05, 0.001] {
        let from = direction(z, 0.4);
        let expected = 1.0 - z * (1.0 + 1.0 / z).ln();
        close("albedo", albedo(&bsdf, from), expected, 1e-9);
        close("from behind", albedo(&bsdf, -from), expected, 1e-9);
        let mistake = Mistake::NothingMasked([1.0; 2]);
        let wrong = Mistaken {
            bsdf,
            eta: 1.0,
            tilt: 0.0,
            mistake,
        };
        assert!((albedo(&wrong, from) - expected).abs() > 0.05);
    }
}

/// What a rough white surface loses of light that comes evenly from above.
fn loss(subject: &dyn Scatter) -> f64 {
    1.0 - integrate(0.0, 1.0, 2, |x| {
        // Light evenly spread has the density 2 z dz of heights.
        4.0 * x.powi(3) * albedo(subject, direction(x * x, 0.2))
    })
}

#[test]
fn losses_between_facets_are_those_documented() {
    // The documentation of `ggx`.
    for (alpha, metal, glass) in [
        (0.25, 0.118, 0.029),
        (0.5, 0.300, 0.079),
        (1.0, 0.591, 0.201),
    ] {
        let got = loss(&at(white_metal([alpha; 2]), 0.0));
        assert!((got - metal).abs() < 6e-4, "metal, alpha {alpha}: {got}");
        let got = loss(&at(dielectric(1.5, [alpha; 2]), 0.0));
        assert!((got - glass).abs() < 6e-4, "glass, alpha {alpha}: {got}");
    }
    // 1 − 2 ∫ (1 − z ln(1 + 1/z)) z dz
    close(
        "α = 1",
        loss(&at(white_metal([1.0; 2]), 0.0)),
        (4.0 * 2.0_f64.ln() - 1.0) / 3.0,
        1e-6,
    );
}

#[test]
fn nothing_gains_energy() {
    for alpha in [[0.2, 0.2], [0.15, 0.6], [1.0, 1.0]] {
        for eta in [1.5, 0.6, 1.25] {
            let bsdf = at(dielectric(eta, alpha), 0.0);
            for z in [1.0, 0.8, 0.4, 0.1, -0.05, -0.5, -0.9] {
                let from = direction(z, 1.1);
                let kept = albedo(&bsdf, from);
                assert!(
                    kept <= 1.0 + 1e-4,
                    "eta {eta}, alpha {alpha:?}, z {z}: {kept}"
                );
            }
            // Without masking a hemisphere would shine brighter than it is lit.
            let mistake = Mistake::NothingMasked(alpha);
            let wrong = Mistaken {
                bsdf,
                eta,
                tilt: 0.0,
                mistake,
            };
            assert!(albedo(&wrong, direction(0.1, 1.1)) > 1.05);
        }
    }
}

#[test]
fn smooth_surfaces_keep_all_power_exactly() {
    let mut rng = SplitMix::new(31);
    for (kind, eta) in [
        (dielectric(1.5, [0.0; 2]), 1.5),
        (dielectric(0.7, [0.0; 2]), 0.7),
        (MaterialKind::ThinDielectric { eta: 1.5 }, 1.0),
        (white_metal([0.0; 2]), 1.0),
        (dielectric(1.5, [9e-4; 2]), 1.5),
    ] {
        let bsdf = at(kind, 0.0);
        assert!(bsdf.is_specular());
        for _ in 0..1000 {
            let from = any_direction(&mut rng);
            let mut power = 0.0;
            let mut radiance = 0.0;
            // In a furnace radiance over n² is the same everywhere.
            let squared = |w: DVec3| if w.z > 0.0 { 1.0 } else { eta * eta };
            let mut last = f64::NAN;
            for u in [0.0, 1.0 - f64::EPSILON] {
                let choose = |transport| bsdf.sample(from, [u; 3], transport).expect("goes on");
                let [r, i] = TRANSPORTS.map(choose);
                if i.pdf == last && i.pdf == 1.0 {
                    continue; // there is one kind only
                }
                last = i.pdf;
                assert_eq!(i.weight, [1.0; 3]);
                power += i.pdf * i.weight[0];
                radiance += r.pdf * r.weight[0] * squared(r.direction) / squared(from);
            }
            assert!((power - 1.0).abs() < 1e-15 && (radiance - 1.0).abs() < 1e-14);
        }
    }
}

#[test]
fn diffuse_surfaces_keep_their_reflectance_under_bent_normals() {
    let mut rng = SplitMix::new(32);
    for tilt in [0.0, 0.3, 1.2] {
        let bsdf = at(diffuse(0.75), tilt);
        assert_eq!(bsdf.albedo(), [0.75; 3]);
        for _ in 0..1000 {
            let from = any_direction(&mut rng);
            let sample = bsdf.sample(from, uniforms(&mut rng), Transport::Radiance);
            assert_eq!(sample.expect("reflected").weight, [0.75; 3]);
        }
        for z in [0.9, 0.1, -0.4] {
            let from = direction(z, 0.9);
            let side = f64::signum(z);
            // Polynomials but for the |cosine| of the shading normal, whose kink costs digits.
            let got = above(&bsdf, from, side, Transport::Radiance);
            close("diffuse", got, 0.75, if tilt == 0.0 { 1e-12 } else { 2e-3 });
        }
    }
}

#[test]
fn weights_average_to_the_integral_of_values() {
    let n = samples(1 << 17);
    let mut rng = SplitMix::new(33);
    for (kind, tilt) in [
        (white_metal([0.3, 0.7]), 0.0),
        (metal(0.2, 3.0, [0.5, 0.5]), 0.2),
        (dielectric(1.5, [0.3, 0.3]), 0.0),
        (dielectric(0.7, [0.6, 0.25]), 0.2),
        (diffuse(0.5), 0.4),
    ] {
        let alpha = match kind {
            MaterialKind::Dielectric { alpha, .. } | MaterialKind::Conductor { alpha, .. } => alpha,
            _ => [1.0; 2],
        };
        let bsdf = at(kind.clone(), tilt);
        for z in [0.9, 0.3, -0.6] {
            let from = direction(z, 0.5);
            for transport in TRANSPORTS {
                let panels = if tilt == 0.0 { 6 } else { 30 };
                let half = |sign| in_panels(&bsdf, from, sign, transport, panels);
                let truth = half(1.0) + half(-1.0);
                let weights = |subject: &dyn Scatter, rng: &mut SplitMix| -> Moments {
                    let weight = |choice: super::subject::Choice| choice.weight;
                    (0..n)
                        .map(|_| {
                            subject
                                .sample(from, uniforms(rng), transport)
                                .map_or(0.0, weight)
                        })
                        .collect()
                };
                let name = format!("{kind:?}, tilt {tilt}, z {z}, {transport:?}");
                assert_mean_agrees(&name, &weights(&bsdf, &mut rng), truth, 0.005);
                if matches!(kind, MaterialKind::Diffuse { .. }) || tilt > 0.0 {
                    continue;
                }
                let mistake = Mistake::NothingMasked(alpha);
                let wrong = Mistaken {
                    bsdf,
                    eta: 1.0,
                    tilt,
                    mistake,
                };
                if z == 0.9 {
                    must_kill(&name, judge(&weights(&wrong, &mut rng), truth, 0.05));
                }
            }
        }
    }
}
