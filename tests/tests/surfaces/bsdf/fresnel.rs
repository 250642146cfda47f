//! Fresnel's laws against tables that were computed elsewhere, alone and through materials.

use super::subject::{at, dielectric, direction, metal};
use glam::DVec3;
use woodcock_host::bsdf::{Transport, fresnel};
use woodcock_host::scene::MaterialKind;
use woodcock_tests::refs::quadrature::{close, integrate};
use woodcock_tests::refs::surfaces;

type Law = fn(f64, f64) -> f64;

/// The largest distance of a law from the table of boundaries.
fn distance(law: Law) -> f64 {
    let rows = surfaces::load().dielectric;
    rows.iter().fold(0.0, |worst: f64, row| {
        worst.max((law(row.cos_i, row.n2 / row.n1) - row.reflectance).abs())
    })
}

#[test]
fn boundaries_reflect_what_tables_say() {
    assert!(distance(fresnel::dielectric) < 2e-13);
    let mistakes: [(&str, Law); 3] = [
        ("Schlick's approximation", |c, eta| {
            let f0 = ((eta - 1.0) / (eta + 1.0)).powi(2);
            f0 + (1.0 - f0) * (1.0 - c).powi(5)
        }),
        ("indices exchanged", |c, eta| {
            fresnel::dielectric(c, 1.0 / eta)
        }),
        ("one polarisation", |c, eta| {
            let Some(t) = fresnel::refracted_cosine(c, eta) else {
                return 1.0;
            };
            ((c - eta * t) / (c + eta * t)).powi(2)
        }),
    ];
    for (name, law) in mistakes {
        assert!(distance(law) > 1e-3, "{name} passes");
    }
    for row in surfaces::load().dielectric {
        let cosine = fresnel::refracted_cosine(row.cos_i, row.n2 / row.n1).unwrap_or(0.0);
        close("cosine of refraction", cosine, row.cos_t, 1e-13);
    }
}

#[test]
fn metals_reflect_what_tables_say() {
    for row in surfaces::load().conductor {
        let got = fresnel::conductor(row.cos_i, row.eta, row.k);
        close("metal", got, row.reflectance, 2e-13);
        let swapped = fresnel::conductor(row.cos_i, row.k, row.eta);
        assert!((swapped - row.reflectance).abs() > 1e-3 || row.reflectance == 1.0);
        let bsdf = at(metal(row.eta, row.k, [0.0; 2]), 0.0);
        let from = direction(row.cos_i, 1.0);
        if let Some(sample) = bsdf.sample(from, [0.5; 3], Transport::Radiance) {
            close("mirror", sample.weight[0], row.reflectance, 1e-12);
        }
    }
    // Without absorption a metal is a dielectric, also beyond the critical angle.
    for eta in [0.5, 0.8, 1.3, 2.4] {
        for i in 0..=100 {
            let c = f64::from(i) / 100.0;
            let (a, b) = (fresnel::conductor(c, eta, 0.0), fresnel::dielectric(c, eta));
            // At the critical angle both are roots of rounding errors.
            let critical = (1.0 - c * c - eta * eta).abs() < 1e-9;
            let tolerance = if critical { 1e-6 } else { 1e-12 };
            close("a metal without absorption", a, b, tolerance);
        }
    }
}

#[test]
fn uniform_light_is_reflected_as_tables_say() {
    for row in surfaces::load().diffuse_average {
        let mean = |eta: f64, from: f64, to: f64| {
            // The root at the critical angle is smooth in x, c = from + (to − from) x².
            integrate(0.0, 1.0, 8, |x| {
                let c = from + (to - from) * x * x;
                2.0 * c * fresnel::dielectric(c, eta) * 2.0 * (to - from) * x
            })
        };
        close("from outside", mean(row.n, 0.0, 1.0), row.external, 1e-11);
        let critical = (1.0 - 1.0 / (row.n * row.n)).sqrt();
        let inside = critical * critical + mean(1.0 / row.n, critical, 1.0);
        close("from inside", inside, row.internal, 1e-11);
    }
}

#[test]
fn panes_reflect_as_plates_without_absorption() {
    let plates = surfaces::load().plate;
    let clear: Vec<_> = plates.iter().filter(|plate| plate.tau == 0.0).collect();
    assert!(!clear.is_empty());
    for plate in clear {
        close(
            "pane",
            fresnel::pane(plate.mu0, plate.n),
            plate.reflectance,
            1e-12,
        );
        let bsdf = at(MaterialKind::ThinDielectric { eta: plate.n }, 0.0);
        let from = direction(plate.mu0, 0.3);
        let reflected = bsdf
            .sample(from, [0.0; 3], Transport::Radiance)
            .expect("mirrored");
        let passed = bsdf
            .sample(from, [0.999; 3], Transport::Radiance)
            .expect("passed");
        close("R", reflected.pdf, plate.reflectance, 1e-12);
        close("T", passed.pdf, plate.transmittance, 1e-12);
        assert_eq!((reflected.weight, passed.weight), ([1.0; 3], [1.0; 3]));
        assert_eq!(passed.direction, -from);
    }
    // The series itself, term by term.
    for (c, eta) in [(1.0, 1.5), (0.3, 1.5), (0.05, 1.33), (0.4, 0.7)] {
        let r = fresnel::dielectric(c, eta);
        let bounces = (0..400).map(|i| (1.0 - r).powi(2) * r.powi(2 * i + 1));
        close(
            "series",
            fresnel::pane(c, eta),
            r + bounces.sum::<f64>(),
            1e-12,
        );
    }
}

#[test]
fn smooth_boundaries_obey_snell_and_fresnel() {
    for row in surfaces::load().dielectric {
        // Light may come from either side: the normal points outside, where the index is n1, or n2.
        for (eta, z) in [(row.n2 / row.n1, 1.0), (row.n1 / row.n2, -1.0)] {
            let bsdf = at(dielectric(eta, [0.0; 2]), 0.0);
            let from = direction(z * row.cos_i, 2.0);
            let reflected = bsdf.sample(from, [0.0; 3], Transport::Importance);
            let Some(reflected) = reflected else {
                assert!(row.cos_i == 0.0, "{row:?}");
                continue;
            };
            close("F", reflected.pdf, row.reflectance, 1e-12);
            assert!((reflected.direction - DVec3::new(-from.x, -from.y, from.z)).length() < 1e-15);
            let passed = bsdf.sample(from, [1.0 - f64::EPSILON; 3], Transport::Importance);
            if row.cos_t == 0.0 {
                assert_eq!(passed.expect("total reflection").pdf, 1.0);
                continue;
            }
            let passed = passed.expect("refraction");
            close("1 − F", passed.pdf, 1.0 - row.reflectance, 1e-12);
            close("cos θt", -z * passed.direction.z, row.cos_t, 1e-12);
            // n1 sin θ = n2 sin θt, in one plane: what is along the surface is scaled and turned around.
            let along = passed.direction * (row.n2 / row.n1) + from;
            assert!(along.x.abs() < 1e-14 && along.y.abs() < 1e-14, "{row:?}");
        }
    }
}
