//! Distances, places, normals and coordinates against numbers of twice the precision and closed forms.

use std::f64::consts::TAU;

use super::dd::{Dd, Dd3};
use super::*;

/// Half of the distance between 1 and the next double.
const ROUNDING: f64 = f64::EPSILON / 2.0;

fn rays(rng: &mut SplitMix, count: usize, size: f64, mut each: impl FnMut(Ray)) {
    for _ in 0..count {
        let distance = size * 10_f64.powf(uniform(rng, -0.5, 6.0));
        let origin = direction(rng) * distance;
        each(towards(origin, within(rng, 0.7 * size)));
    }
}

/// t of the plane through three corners.
fn plane(corners: [DVec3; 3], ray: &Ray) -> f64 {
    let [a, b, c] = corners.map(Dd3::from);
    let normal = b.minus(a).cross(c.minus(a));
    let height = a.minus(ray.origin.into()).dot(normal);
    (height / normal.dot(ray.direction.into())).value()
}

#[test]
fn triangles_are_met_where_their_plane_is() {
    let mut rng = SplitMix::new(11);
    let mut met = 0;
    for _ in 0..40 {
        let corners = [(); 3].map(|()| within(&mut rng, 1.0));
        let surfaces = ready(vec![matter(triangle(corners))]);
        let normal = (corners[1] - corners[0])
            .cross(corners[2] - corners[0])
            .normalize();
        rays(&mut rng, 300, 1.0, |ray| {
            let Some(hit) = surfaces.intersect(&ray, f64::INFINITY) else {
                return;
            };
            met += 1;
            let truth = plane(corners, &ray);
            let slope = normal.dot(ray.direction).abs();
            let bound = 24.0 * ROUNDING * (ray.origin.length() + 2.0) / slope;
            assert!((hit.t - truth).abs() <= bound, "{} {truth} {bound}", hit.t);
            // The place is in the plane to within its bound.
            let a = Dd3::from(corners[0]);
            let exact = Dd3::from(corners[1])
                .minus(a)
                .cross(Dd3::from(corners[2]).minus(a));
            let off = Dd3::from(hit.anchor.point).minus(a).dot(exact) / exact.length();
            assert!(off.value().abs() <= 0.25 * hit.anchor.error, "{hit:?}");
            assert!((hit.anchor.normal - normal).length() < 1e-13);
            // And on the ray, but for what the ray itself is off.
            let lateral = (hit.anchor.point - ray.at(hit.t)).length();
            assert!(
                lateral <= bound + 16.0 * ROUNDING * ray.origin.length(),
                "{lateral} {bound}"
            );
        });
    }
    assert!(met > 1000, "{met}");
}

#[test]
fn spheres_are_met_where_the_quadratic_says() {
    let mut rng = SplitMix::new(12);
    let mut met = 0;
    for shift in [DVec3::ZERO, DVec3::new(3.0, -400.0, 20.0)] {
        for radius in [1.0, 0.3, 7.0] {
            let map = DAffine3::from_translation(shift) * rotation(&mut rng);
            let surfaces = ready(vec![matter(sphere(radius, map))]);
            rays(&mut rng, 800, radius, |ray| {
                let ray = Ray {
                    origin: ray.origin + shift,
                    ..ray
                };
                let Some(hit) = surfaces.intersect(&ray, f64::INFINITY) else {
                    return;
                };
                met += 1;
                let (o, d) = (
                    Dd3::from(ray.origin).minus(shift.into()),
                    Dd3::from(ray.direction),
                );
                let a = d.dot(d);
                let b = -o.dot(d);
                let c = o.dot(o) - Dd::from(radius) * Dd::from(radius);
                let root = (b * b - a * c).sqrt();
                let near = (b - root) / a;
                let far = (b + root) / a;
                let truth = if near.value() > 0.0 { near } else { far }.value();
                let slope = hit.anchor.normal.dot(ray.direction).abs();
                let bound = 64.0 * ROUNDING * (ray.origin.length() + radius) / slope;
                assert!((hit.t - truth).abs() <= bound, "{} {truth} {bound}", hit.t);
                let distance = Dd3::from(hit.anchor.point).minus(shift.into()).length();
                let off = (distance - Dd::from(radius)).value();
                assert!(off.abs() <= hit.anchor.error, "{off} {hit:?}");
                let outwards = (hit.anchor.point - shift) / radius;
                assert!((hit.anchor.normal - outwards).length() < 1e-12);
            });
        }
    }
    assert!(met > 3000, "{met}");
}

#[test]
fn ellipsoids_have_the_normals_of_their_gradient() {
    let mut rng = SplitMix::new(13);
    for _ in 0..20 {
        let map = skewed(&mut rng);
        let surfaces = ready(vec![matter(sphere(1.0, map))]);
        let back = map.inverse();
        rays(&mut rng, 50, 0.3, |ray| {
            let hit = surfaces
                .intersect(&ray, f64::INFINITY)
                .expect("through the middle");
            let local = back.transform_point3(hit.anchor.point);
            assert!((local.length() - 1.0).abs() < 1e-13);
            let gradient = (back.matrix3.transpose() * local).normalize();
            assert!((hit.anchor.normal - gradient).length() < 1e-12);
            assert!(
                hit.anchor.normal.dot(hit.anchor.point) > 0.0,
                "outwards, though mirrored"
            );
            assert!(
                (ray.at(hit.t) - hit.anchor.point).length() < 1e-9 * (1.0 + ray.origin.length())
            );
        });
    }
}

#[test]
fn saddles_are_met_where_the_quadratic_says() {
    // z = x y over [-1, 1]².
    let surfaces = ready(vec![matter(bilinear([
        DVec3::new(-1.0, -1.0, 1.0),
        DVec3::new(1.0, -1.0, -1.0),
        DVec3::new(-1.0, 1.0, -1.0),
        DVec3::new(1.0, 1.0, 1.0),
    ]))]);
    let mut rng = SplitMix::new(14);
    let (mut met, mut missed, mut twice) = (0, 0, 0);
    rays(&mut rng, 20_000, 1.0, |ray| {
        let [ox, oy, oz] = ray.origin.to_array().map(Dd::from);
        let [dx, dy, dz] = ray.direction.to_array().map(Dd::from);
        // (ox + t dx)(oy + t dy) = oz + t dz.
        let (a, b, c) = (dx * dy, ox * dy + oy * dx - dz, ox * oy - oz);
        let discriminant = b * b - Dd::from(4.0) * a * c;
        let mut truth = Vec::new();
        let mut near_edge = discriminant.value().abs() < 1e-9;
        if discriminant.value() > 0.0 {
            let root = discriminant.sqrt();
            for root in [root, -root] {
                let t = (root - b) / (Dd::from(2.0) * a);
                let (x, y) = ((ox + t * dx).value(), (oy + t * dy).value());
                near_edge |= (x.abs() - 1.0).abs() < 1e-8 || (y.abs() - 1.0).abs() < 1e-8;
                if t.value() > 0.0 && x.abs() < 1.0 && y.abs() < 1.0 {
                    truth.push(t.value());
                }
            }
        }
        if near_edge {
            return;
        }
        truth.sort_by(f64::total_cmp);
        let hit = surfaces.intersect(&ray, f64::INFINITY);
        twice += usize::from(truth.len() == 2);
        match (hit, truth.first()) {
            (None, None) => missed += 1,
            (Some(hit), Some(&t)) => {
                met += 1;
                let slope = hit.anchor.normal.dot(ray.direction).abs();
                let bound = 64.0 * ROUNDING * (ray.origin.length() + 2.0) / slope;
                assert!((hit.t - t).abs() <= bound, "{} {t} {bound}", hit.t);
                let p = hit.anchor.point;
                assert!((p.z - p.x * p.y).abs() <= 0.25 * hit.anchor.error);
                // cross(∂p/∂u, ∂p/∂v) of x = 2u − 1, y = 2v − 1.
                let normal = DVec3::new(-p.y, -p.x, 1.0).normalize();
                assert!((hit.anchor.normal - normal).length() < 1e-12);
                assert!((hit.uv - (p.truncate() + 1.0) * 0.5).length() < 1e-12);
            }
            other => panic!("{ray:?}: {other:?}"),
        }
    });
    assert!(
        met > 3000 && missed > 1000 && twice > 100,
        "{met} {missed} {twice}"
    );
}

#[test]
fn disks_and_rings_have_their_edges_and_coordinates() {
    let mut rng = SplitMix::new(15);
    let map = DAffine3::from_translation(DVec3::new(5.0, 6.0, -7.0)) * skewed(&mut rng);
    let ring = ready(vec![matter(disk(2.0, 0.5, 0.25, map))]);
    let normal = (map.inverse().matrix3.transpose() * DVec3::Z).normalize();
    for _ in 0..4000 {
        let (radius, phi) = (uniform(&mut rng, 0.0, 2.5), uniform(&mut rng, 0.0, TAU));
        let local = DVec3::new(radius * phi.cos(), radius * phi.sin(), 0.25);
        let target = map.transform_point3(local);
        let ray = towards(target + direction(&mut rng) * 9.0, target);
        let hit = ring.intersect(&ray, f64::INFINITY);
        let edge = (radius - 2.0).abs().min((radius - 0.5).abs());
        if edge < 1e-9 {
            continue;
        }
        assert_eq!(hit.is_some(), radius > 0.5 && radius < 2.0, "{radius}");
        if let Some(hit) = hit {
            let slope = normal.dot(ray.direction).abs();
            assert!((hit.anchor.point - target).length() < 1e-13 / slope);
            assert!(
                (hit.anchor.normal - normal).length() < 1e-13,
                "a mirror keeps the side"
            );
            let uv = DVec2::new(phi / TAU, (2.0 - radius) / 1.5);
            assert!((hit.uv - uv).length() < 1e-12 / slope, "{} {uv}", hit.uv);
            let along = map.matrix3 * DVec3::new(-phi.sin(), phi.cos(), 0.0);
            assert!((hit.tangent - along.normalize()).length() < 1e-9 / slope);
        }
    }
}

#[test]
fn spheres_have_the_coordinates_of_pbrt() {
    let mut rng = SplitMix::new(16);
    let surfaces = ready(vec![matter(sphere(2.0, DAffine3::IDENTITY))]);
    for _ in 0..1000 {
        let ray = towards(direction(&mut rng) * 9.0, within(&mut rng, 0.5));
        let hit = surfaces.intersect(&ray, f64::INFINITY).expect("hit");
        let (phi, theta) = (hit.uv.x * TAU, (1.0 - hit.uv.y) * TAU / 2.0);
        let point = DVec3::new(
            theta.sin() * phi.cos(),
            theta.sin() * phi.sin(),
            theta.cos(),
        ) * 2.0;
        assert!(
            (point - hit.anchor.point).length() < 1e-7,
            "{point} {hit:?}"
        );
        let along = DVec3::new(-phi.sin(), phi.cos(), 0.0);
        assert!((hit.tangent - along).length() < 1e-6);
    }
}

#[test]
fn vertices_say_normals_and_coordinates() {
    let positions = vec![DVec3::ZERO, DVec3::X * 2.0, DVec3::Y * 3.0];
    // All on the side of the geometric one, of any length, but for one.
    let normals = vec![
        DVec3::new(0.3, 0.0, 1.0),
        DVec3::new(0.0, 4.0, 8.0),
        DVec3::Z,
    ];
    let uv = vec![
        DVec2::new(0.2, 0.1),
        DVec2::new(0.2, 0.9),
        DVec2::new(0.7, 0.1),
    ];
    let mesh = TriangleMesh {
        positions,
        indices: vec![[0, 1, 2]],
        normals: normals.clone(),
        uv: uv.clone(),
    };
    let shape = Shape::TriangleMesh(Arc::new(mesh.clone()));
    let plain = ready(vec![matter(shape.clone())]);
    let flipped = ready(vec![Surface {
        flipped: true,
        ..matter(shape)
    }]);
    let ray = towards(DVec3::new(0.5, 0.75, 4.0), DVec3::new(0.5, 0.75, 0.0));
    let weights = [0.5, 0.25, 0.25];
    let shading: DVec3 = (0..3).map(|i| normals[i] * weights[i]).sum();
    for (surfaces, sign) in [(plain, 1.0), (flipped, -1.0)] {
        let hit = surfaces.intersect(&ray, 9.0).expect("hit");
        assert_eq!(hit.anchor.normal, DVec3::Z * sign);
        assert!((hit.shading_normal - shading.normalize() * sign).length() < 1e-15);
        let expected: DVec2 = (0..3).map(|i| uv[i] * weights[i]).sum();
        assert!((hit.uv - expected).length() < 1e-15);
        // u grows along y only; made orthogonal to the shading normal.
        let n = hit.shading_normal;
        let along = (DVec3::Y - n * n.y).normalize();
        assert!((hit.tangent - along).length() < 1e-14, "{}", hit.tangent);
    }
    // Normals on the other side, none at all, and ones that cancel.
    for (normals, expected) in [
        (vec![-DVec3::Z; 3], DVec3::Z),
        (Vec::new(), DVec3::Z),
        (vec![DVec3::ZERO; 3], DVec3::Z),
        (vec![DVec3::NAN; 3], DVec3::Z),
    ] {
        let mesh = TriangleMesh {
            normals,
            uv: Vec::new(),
            ..mesh.clone()
        };
        let surfaces = ready(vec![matter(Shape::TriangleMesh(Arc::new(mesh)))]);
        let hit = surfaces.intersect(&ray, 9.0).expect("hit");
        assert_eq!(hit.shading_normal, expected);
        // pbrt's corners (0, 0), (1, 0), (1, 1).
        assert!((hit.uv - DVec2::new(0.5, 0.25)).length() < 1e-15);
        assert!((hit.tangent - DVec3::X).length() < 1e-15);
    }
}

#[test]
fn what_has_no_extent_is_not_met() {
    let p = DVec3::new(0.1, 0.2, 0.3);
    let flat = ready(vec![
        matter(triangle([p, p, p * 2.0])),
        matter(triangle([DVec3::ZERO, DVec3::X, DVec3::X * 3.0])),
        matter(bilinear([p; 4])),
        matter(bilinear([
            DVec3::ZERO,
            DVec3::X,
            DVec3::X * 2.0,
            DVec3::X * 3.0,
        ])),
        Surface {
            material: None,
            ..matter(sphere(1.0, DAffine3::IDENTITY))
        },
    ]);
    assert!(flat.is_empty() && flat.bounds().is_none());
    assert!(flat.intersect(&towards(DVec3::Z, p), 9.0).is_none());
    // Degenerate pieces do not hide the others, and keep their number among emitters.
    let positions = vec![p, DVec3::ZERO, DVec3::X, DVec3::Y];
    let surfaces = ready(vec![lamp(triangles(positions, vec![[0, 0, 1], [1, 2, 3]]))]);
    assert_eq!(surfaces.emitters(), 2);
    let ray = towards(DVec3::new(0.2, 0.2, 1.0), DVec3::new(0.2, 0.2, 0.0));
    assert_eq!(
        surfaces.intersect(&ray, 9.0).and_then(|h| h.emitter),
        Some(1)
    );
    assert!(!surfaces.occluded(&ray, 9.0));
    assert_eq!(surfaces.area(0), 0.0);
    assert_eq!(surfaces.sample_emitter_area(0, [0.3; 2]).pdf, 0.0);
    assert!(surfaces.sample_emitter(0, DVec3::Z, [0.3; 2]).is_none());
}

#[test]
fn what_doubles_cannot_hold_is_refused() {
    let refuse = |surface: Surface| {
        let scene = Scene {
            surfaces: vec![surface],
            ..empty()
        };
        Surfaces::new(&scene, DVec3::ZERO)
            .expect_err("refused")
            .to_string()
    };
    let huge = refuse(matter(triangle([DVec3::ZERO, DVec3::X, DVec3::Y * 1e200])));
    assert!(huge.contains("farther than"), "{huge}");
    let flat = DAffine3::from_scale(DVec3::new(1.0, 1.0, 0.0));
    let singular = refuse(matter(sphere(1.0, flat)));
    assert!(singular.contains("singular"), "{singular}");
    let singular = refuse(matter(disk(1.0, 0.0, 0.0, flat)));
    assert!(singular.contains("singular"), "{singular}");
}

/// The distance at which a hit counts is open at both ends.
#[test]
fn distances_are_open_intervals() {
    let surfaces = ready(vec![matter(triangle([
        DVec3::new(-1.0, -1.0, 2.0),
        DVec3::new(1.0, -1.0, 2.0),
        DVec3::new(0.0, 1.0, 2.0),
    ]))]);
    let ray = towards(DVec3::ZERO, DVec3::Z);
    assert!(surfaces.intersect(&ray, 2.0).is_none() && !surfaces.occluded(&ray, 2.0));
    let beyond = 2.0_f64.next_up();
    assert!(surfaces.intersect(&ray, beyond).is_some() && surfaces.occluded(&ray, beyond));
    let on_it = towards(DVec3::Z * 2.0, DVec3::Z * 3.0);
    assert!(surfaces.intersect(&on_it, 9.0).is_none() && !surfaces.occluded(&on_it, 9.0));
}
