//! Sweeps over what directions and uniforms can be at worst.

use super::subject::{TRANSPORTS, at, dielectric, diffuse, direction, metal, white_metal};
use glam::DVec3;
use woodcock_host::bsdf::{Materials, Transport};
use woodcock_host::scene::{Material, MaterialKind, MemoryFiles, Place, Source, Texture};
use woodcock_host::volume::Limits;

/// Heights over the plane, and what the rounding of the world leaves of them.
const HEIGHTS: [f64; 14] = [
    1.0,
    1.0 - 1e-16,
    0.9,
    0.5,
    1e-1,
    1e-3,
    1e-6,
    1e-9,
    1.1e-12,
    1e-12,
    1e-15,
    1e-17,
    1e-300,
    0.0,
];

fn directions() -> Vec<DVec3> {
    let mut all = vec![
        DVec3::X,
        -DVec3::X,
        DVec3::Y,
        -DVec3::Y,
        DVec3::Z,
        -DVec3::Z,
    ];
    for z in HEIGHTS {
        for phi in [0.0, 0.7, 2.0, 3.841_592_653_589_793, 5.0] {
            all.extend([direction(z, phi), direction(-z, phi)]);
        }
    }
    all
}

fn kinds() -> Vec<MaterialKind> {
    let mut kinds = vec![
        diffuse(0.0),
        diffuse(1.0),
        MaterialKind::ThinDielectric { eta: 1.5 },
        MaterialKind::ThinDielectric { eta: 0.3 },
        MaterialKind::ThinDielectric { eta: 1.0 },
    ];
    for alpha in [
        [0.0, 0.0],
        [1e-3, 1e-3],
        [0.0, 1.0],
        [0.3, 0.3],
        [1.0, 1.0],
        [50.0, 1e-3],
        [1e6, 1e6],
    ] {
        for eta in [1.5, 0.4, 1.0, 1.0 + 1e-7, 1e-3, 1e3] {
            kinds.push(dielectric(eta, alpha));
        }
        kinds.push(white_metal(alpha));
        kinds.push(metal(0.0, 0.0, alpha));
        kinds.push(metal(1.0, 0.0, alpha));
        kinds.push(metal(1e3, 1e3, alpha));
    }
    kinds
}

#[test]
fn no_direction_makes_nonsense() {
    let last = 1.0 - f64::EPSILON / 2.0;
    let uniforms = [0.0, 1e-300, 1e-9, 0.5, 1.0 - 1e-9, last];
    let directions = directions();
    for kind in kinds() {
        for tilt in [0.0, 1e-9, 0.3, 1.5] {
            let bsdf = at(kind.clone(), tilt);
            assert!(bsdf.albedo().iter().all(|a| (0.0..=1.0).contains(a)));
            for &from in &directions {
                for transport in TRANSPORTS {
                    for (i, u) in uniforms.into_iter().enumerate() {
                        let v = uniforms[(i * 5 + 1) % 6];
                        let w = uniforms[(i + 3) % 6];
                        let Some(sample) = bsdf.sample(from, [u, v, w], transport) else {
                            continue;
                        };
                        let name =
                            || format!("{kind:?}, tilt {tilt}, {from}, {u} {v} {w}: {sample:?}");
                        assert!(
                            (sample.direction.length() - 1.0).abs() < 1e-12,
                            "{}",
                            name()
                        );
                        assert!(
                            sample.weight.iter().all(|w| w.is_finite() && *w >= 0.0),
                            "{}",
                            name()
                        );
                        assert!(sample.pdf.is_finite() && sample.pdf > 0.0, "{}", name());
                        if transport == Transport::Radiance && !sample.specular {
                            assert!(sample.weight[0] <= 1e6 + 1.0, "{}", name());
                        }
                        check(&bsdf, from, sample.direction, transport);
                    }
                    for &to in directions.iter().step_by(3) {
                        check(&bsdf, from, to, transport);
                    }
                    check(&bsdf, from, -from, transport);
                    check(&bsdf, from, DVec3::new(-from.x, -from.y, from.z), transport);
                }
            }
        }
    }
}

fn check(bsdf: &woodcock_host::bsdf::Bsdf, from: DVec3, to: DVec3, transport: Transport) {
    let pdf = bsdf.pdf(from, to, transport);
    let value = bsdf.eval(from, to, transport);
    assert!(pdf.is_finite() && pdf >= 0.0, "{bsdf:?} {from} {to}: {pdf}");
    assert!(
        value.iter().all(|x| x.is_finite() && *x >= 0.0),
        "{bsdf:?} {from} {to}: {value:?}"
    );
    assert!(!bsdf.is_specular() || (pdf == 0.0 && value == [0.0; 3]));
}

#[test]
fn rough_surfaces_become_smooth_ones() {
    // Just above what counts as smooth: the share that is reflected is Fresnel's, and it goes where mirrors send it.
    let smooth = at(dielectric(1.5, [9.9e-4; 2]), 0.0);
    let rough = at(dielectric(1.5, [1e-3; 2]), 0.0);
    assert!(smooth.is_specular() && !rough.is_specular());
    for z in [0.9, 0.4, -0.9] {
        let from = direction(z, 0.2);
        for u in [0.0, 1.0 - f64::EPSILON] {
            let u = [u, 0.3, 0.4];
            let a = smooth
                .sample(from, u, Transport::Radiance)
                .expect("goes on");
            let b = rough.sample(from, u, Transport::Radiance).expect("goes on");
            assert!((a.direction - b.direction).length() < 0.01);
            assert!((a.weight[0] - b.weight[0]).abs() < 1e-3 * a.weight[0]);
        }
    }
    // One narrow width does not make a surface smooth.
    assert!(!at(dielectric(1.5, [0.0, 0.5]), 0.0).is_specular());
}

#[test]
fn black_surfaces_end_light() {
    let bsdf = at(diffuse(0.0), 0.0);
    assert!(
        bsdf.sample(DVec3::Z, [0.5; 3], Transport::Radiance)
            .is_none()
    );
    assert_eq!(bsdf.pdf(DVec3::Z, DVec3::Z, Transport::Radiance), 0.0);
    assert_eq!(bsdf.albedo(), [0.0; 3]);
}

#[test]
fn materials_out_of_range_are_refused_at_their_place() {
    let source = Source::new("scene.pbrt", b"\nMaterial \"glass\"".to_vec());
    let refused = |kind: MaterialKind| {
        let place = Place::new(&source, 1, 9);
        let material = Material { kind, place };
        let error = Materials::new(&[material], &MemoryFiles::new(), &Limits::default())
            .expect_err("refused");
        assert!(error.to_string().starts_with("scene.pbrt:2:1: "), "{error}");
    };
    for eta in [0.0, -1.5, f64::NAN, f64::INFINITY] {
        refused(dielectric(eta, [0.0; 2]));
        refused(MaterialKind::ThinDielectric { eta });
    }
    for x in [-0.1, f64::NAN, f64::INFINITY] {
        refused(dielectric(1.5, [0.1, x]));
        refused(metal(x, 1.0, [0.0; 2]));
        refused(metal(1.0, x, [0.0; 2]));
        refused(metal(1.0, 1.0, [x, 0.0]));
        refused(diffuse(x));
    }
    refused(diffuse(1.1));
    let pair = |a: f64, b: f64| MaterialKind::Diffuse {
        reflectance: Texture::Scale(
            Box::new(Texture::Constant([a; 3])),
            Box::new(Texture::Constant([b; 3])),
        ),
    };
    refused(pair(2.0, 0.6));
    let _ = at(pair(2.0, 0.5), 0.0); // one in all
}
