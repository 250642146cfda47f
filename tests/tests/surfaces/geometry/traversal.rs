//! Trees find what brute force finds, and instances are the mesh that they transform.

use super::*;
use woodcock_host::surface::Hit;
use woodcock_tests::stats::{samples, seed};

/// Pieces of all kinds and sizes, some far away, some tiny.
fn clutter(rng: &mut SplitMix, count: usize) -> Vec<Surface> {
    (0..count)
        .map(|i| {
            let size = 10_f64.powf(uniform(rng, -3.0, 0.0));
            let centre = within(rng, if i % 10 == 0 { 300.0 } else { 1.0 });
            let mut corner = || centre + within(rng, size);
            let corners = [corner(), corner(), corner(), corner()];
            let placed = DAffine3::from_translation(centre) * skewed(rng);
            matter(match i % 4 {
                0 | 1 => triangle([corners[0], corners[1], corners[2]]),
                2 => bilinear(corners),
                _ if i % 8 == 3 => sphere(size, placed),
                _ => disk(size, 0.3 * size, 0.1 * size, placed),
            })
        })
        .collect()
}

fn probes(rng: &mut SplitMix, count: usize) -> Vec<Ray> {
    (0..count)
        .map(|i| {
            let reach = if i % 3 == 0 { 1e4 } else { 1.5 };
            let origin = within(rng, reach);
            let target = within(rng, 1.0);
            match i % 5 {
                // Along an axis, exactly.
                0 => Ray {
                    origin: DVec3::new(target.x, target.y, -reach),
                    direction: DVec3::Z,
                },
                1 => Ray {
                    origin: DVec3::new(reach, target.y, target.z),
                    direction: DVec3::NEG_X,
                },
                _ => towards(origin, target),
            }
        })
        .collect()
}

#[test]
fn the_tree_finds_what_brute_force_finds() {
    let mut rng = SplitMix::new(seed(21));
    let mut clutter = clutter(&mut rng, 400);
    let mut singles: Vec<_> = clutter.iter().map(|s| ready(vec![s.clone()])).collect();
    // A mesh has a tree of its own within the tree.
    let corners: Vec<_> = (0..300)
        .map(|i| DVec3::splat(0.01 * f64::from(i / 3)) + within(&mut rng, 0.3))
        .collect();
    let indices = (0..100).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    singles.extend(
        corners
            .chunks(3)
            .map(|c| ready(vec![matter(triangle([c[0], c[1], c[2]]))])),
    );
    clutter.push(matter(triangles(corners, indices)));
    let tree = ready(clutter);
    let (mut met, mut forgetful) = (0, 0);
    for ray in probes(&mut rng, samples(1500)) {
        let brute = |lost: fn(usize) -> bool| {
            singles
                .iter()
                .enumerate()
                .filter(|(i, _)| !lost(*i))
                .filter_map(|(_, s)| s.intersect(&ray, f64::INFINITY))
                .min_by(|a, b| a.t.total_cmp(&b.t))
        };
        let (found, truth) = (tree.intersect(&ray, f64::INFINITY), brute(|_| false));
        assert_eq!(found.map(|h| h.t), truth.map(|h| h.t), "{ray:?}");
        assert_eq!(
            found.map(|h| h.anchor.point),
            truth.map(|h| h.anchor.point),
            "{ray:?}"
        );
        assert_eq!(tree.occluded(&ray, f64::INFINITY), truth.is_some());
        if let Some(truth) = truth {
            met += 1;
            assert!(!tree.occluded(&ray, truth.t) && tree.occluded(&ray, truth.t.next_up()));
        }
        // The planted mistake: a few pieces are lost.
        forgetful += u32::from(brute(|i| i % 20 == 1).map(|h| h.t) != found.map(|h| h.t));
    }
    assert!(met > 500, "{met}");
    assert!(forgetful > 0);
}

/// A closed mesh whose triangles share their edges: no ray slips in, wherever it aims.
#[test]
fn meshes_are_watertight_along_edges_and_through_vertices() {
    let n = 24_u32;
    let mut positions = Vec::new();
    for i in 0..=n {
        for j in 0..n {
            let (theta, phi) = (
                std::f64::consts::PI * f64::from(i) / f64::from(n),
                std::f64::consts::TAU * f64::from(j) / f64::from(n),
            );
            // Poles must be one point.
            let sin = if i == 0 || i == n { 0.0 } else { theta.sin() };
            positions.push(DVec3::new(sin * phi.cos(), sin * phi.sin(), theta.cos()));
        }
    }
    let mut indices = Vec::new();
    for i in 0..n {
        for j in 0..n {
            let at = |i: u32, j: u32| i * n + j % n;
            indices.push([at(i, j), at(i + 1, j), at(i + 1, j + 1)]);
            indices.push([at(i, j), at(i + 1, j + 1), at(i, j + 1)]);
        }
    }
    let mut rng = SplitMix::new(seed(22));
    for shift in [DVec3::ZERO, DVec3::new(1e5, 2e5, -1e5)] {
        let moved: Vec<_> = positions.iter().map(|p| *p + shift).collect();
        let surfaces = ready(vec![matter(triangles(moved.clone(), indices.clone()))]);
        for _ in 0..samples(4000) {
            let [a, b, _] = indices[(rng.bits() % indices.len() as u64) as usize];
            let (a, b) = (moved[a as usize], moved[b as usize]);
            let weight = [0.0, 0.5, uniform(&mut rng, 0.0, 1.0)][(rng.bits() % 3) as usize];
            let target = a + (b - a) * weight;
            // From inside, through an edge or a vertex.
            let ray = towards(shift + within(&mut rng, 0.5), target);
            assert!(surfaces.intersect(&ray, f64::INFINITY).is_some(), "{ray:?}");
            assert!(surfaces.occluded(&ray, f64::INFINITY));
        }
    }
}

/// Patches that share edges.
#[test]
fn patches_leave_no_gaps() {
    let n = 8_u32;
    let mut rng = SplitMix::new(seed(23));
    for scale in [1.0, 1e4] {
        let positions: Vec<_> = (0..=n)
            .flat_map(|i| (0..=n).map(move |j| (i, j)))
            .map(|(i, j)| {
                DVec3::new(f64::from(i), f64::from(j), uniform(&mut rng, 0.0, 1.0)) * scale
            })
            .collect();
        let indices = (0..n)
            .flat_map(|i| (0..n).map(move |j| (i, j)))
            .map(|(i, j)| {
                let at = |i: u32, j: u32| i * (n + 1) + j;
                [at(i, j), at(i + 1, j), at(i, j + 1), at(i + 1, j + 1)]
            })
            .collect();
        let surfaces = ready(vec![matter(Shape::BilinearMesh(Arc::new(BilinearMesh {
            positions: positions.clone(),
            indices,
            ..BilinearMesh::default()
        })))]);
        for k in 0..samples(4000) {
            let (i, j) = (
                1 + rng.bits() as u32 % (n - 2),
                1 + rng.bits() as u32 % (n - 2),
            );
            let a = positions[(i * (n + 1) + j) as usize];
            let b = positions[(i * (n + 1) + j + 1) as usize];
            let target = a + (b - a) * [0.0, 0.5, rng.uniform()][k % 3];
            let height = [3.0, 1e3, 1e6][k % 3] * scale;
            let origin = target + (within(&mut rng, 0.3) + DVec3::Z) * height;
            let ray = towards(origin, target);
            assert!(
                surfaces.intersect(&ray, f64::INFINITY).is_some(),
                "{scale} {k} {ray:?}"
            );
        }
    }
}

fn agree(a: &Hit, b: &Hit, what: &str) {
    assert!((a.t - b.t).abs() < 1e-9 * b.t, "{what}: {a:?} {b:?}");
    let size = b.anchor.point.length() + 1.0;
    let slope = 1e-11 * size;
    assert!(
        (a.anchor.point - b.anchor.point).length() < slope,
        "{what}: {a:?} {b:?}"
    );
    assert!(
        (a.anchor.normal - b.anchor.normal).length() < 1e-9,
        "{what}: {a:?} {b:?}"
    );
    assert!(
        (a.shading_normal - b.shading_normal).length() < 1e-9,
        "{what}: {a:?} {b:?}"
    );
    assert!(
        (a.tangent - b.tangent).length() < 1e-8,
        "{what}: {a:?} {b:?}"
    );
    assert!((a.uv - b.uv).length() < 1e-9, "{what}");
}

#[test]
fn instances_are_the_mesh_that_they_transform() {
    let mut rng = SplitMix::new(24);
    let mut seen = 0;
    let mut naive = 0;
    for k in 0..30 {
        let count = 60;
        let positions: Vec<_> = (0..3 * count).map(|_| within(&mut rng, 1.0)).collect();
        let indices: Vec<_> = (0..count).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
        let side = |c: [u32; 3]| {
            let [a, b, c] = c.map(|i| positions[i as usize]);
            (b - a).cross(c - a).normalize()
        };
        let normals: Vec<_> = (0..3 * count)
            .map(|i| side(indices[i as usize / 3]) + within(&mut rng, 0.2))
            .collect();
        let uv: Vec<_> = (0..3 * count)
            .map(|_| DVec2::new(rng.uniform(), rng.uniform()))
            .collect();
        let map = DAffine3::from_translation(within(&mut rng, 50.0))
            * skewed(&mut rng)
            * DAffine3::from_scale(DVec3::new(1.0, if k % 2 == 0 { 1.0 } else { -1.0 }, 1.0));
        let inverse_transpose = map.inverse().matrix3.transpose();
        let mirrored = map.matrix3.determinant() < 0.0;
        let mesh = TriangleMesh {
            positions: positions.clone(),
            indices: indices.clone(),
            normals: normals.clone(),
            uv,
        };
        // The normal keeps its side, so a mirror changes the order of the vertices, and with it nothing else.
        let moved = TriangleMesh {
            positions: positions.iter().map(|p| map.transform_point3(*p)).collect(),
            normals: normals
                .iter()
                .zip(positions.iter())
                .map(|(n, _)| inverse_transpose * *n)
                .collect(),
            indices: indices
                .iter()
                .map(|&[a, b, c]| if mirrored { [a, c, b] } else { [a, b, c] })
                .collect(),
            ..mesh.clone()
        };
        let object = vec![
            matter(Shape::TriangleMesh(Arc::new(mesh))),
            matter(sphere(0.3, rotation(&mut rng))),
        ];
        let Shape::Sphere(ball) = object[1].shape else {
            panic!("a sphere");
        };
        let direct = vec![
            matter(Shape::TriangleMesh(Arc::new(moved))),
            matter(sphere(0.3, map * ball.object_to_world)),
        ];
        let instance = instanced(vec![object], &[(0, map)], Vec::new());
        let direct = ready(direct);
        let [a, b] = instance.bounds().expect("some");
        let [c, d] = direct.bounds().expect("some");
        assert!(a.cmple(c + 1e-9).all() && b.cmpge(d - 1e-9).all());
        for _ in 0..200 {
            let target = map.transform_point3(within(&mut rng, 0.6));
            let ray = towards(
                target + direction(&mut rng) * uniform(&mut rng, 1.0, 90.0),
                target,
            );
            let (found, truth) = (
                instance.intersect(&ray, f64::INFINITY),
                direct.intersect(&ray, f64::INFINITY),
            );
            assert_eq!(found.is_some(), truth.is_some(), "{ray:?}");
            assert_eq!(found.is_some(), instance.occluded(&ray, f64::INFINITY));
            if let (Some(found), Some(truth)) = (found, truth) {
                // At a shallow angle all digits go to t.
                if truth.anchor.normal.dot(ray.direction).abs() > 1e-3 {
                    agree(&found, &truth, "instance");
                    seen += 1;
                    // The planted mistake: normals that go the way of directions.
                    let own = inverse_transpose.inverse() * truth.anchor.normal;
                    let wrong = (map.matrix3 * own).normalize();
                    naive += u32::from((found.anchor.normal - wrong).length() > 1e-9);
                    // And what leaves does not come back.
                    let away = truth.anchor.normal;
                    for out in [away, -away] {
                        let again = instance.intersect(&found.anchor.ray(out), f64::INFINITY);
                        assert!(again.is_none_or(|h| h.t > 1e-9), "{found:?} {again:?}");
                    }
                }
            }
        }
    }
    assert!(seen > 2000 && naive > 1000, "{seen} {naive}");
}

#[test]
fn objects_stand_among_other_surfaces_and_do_not_shine() {
    let ball = |radius| sphere(radius, DAffine3::IDENTITY);
    let at = |x: f64| DAffine3::from_translation(DVec3::X * x);
    let both = Surface {
        material: Some(MaterialId(2)),
        ..lamp(ball(0.5))
    };
    let surfaces = instanced(
        vec![vec![both.clone()], vec![lamp(ball(0.5))], Vec::new()],
        &[(0, at(3.0)), (0, at(6.0)), (1, at(9.0)), (2, at(12.0))],
        vec![Surface {
            emission: both.emission,
            ..matter(sphere(0.5, at(15.0)))
        }],
    );
    assert_eq!(surfaces.emitters(), 1);
    let mut met = Vec::new();
    let mut ray = towards(DVec3::ZERO, DVec3::X);
    while let Some(hit) = surfaces.intersect(&ray, f64::INFINITY) {
        met.push((hit.anchor.point.x, hit.material.map(|m| m.0), hit.emitter));
        ray = hit.anchor.ray(DVec3::X);
    }
    let expected = [2.5, 3.5, 5.5, 6.5, 14.5, 15.5];
    assert_eq!(met.len(), expected.len(), "{met:?}");
    for ((x, material, emitter), expected) in met.into_iter().zip(expected) {
        assert!((x - expected).abs() < 1e-12);
        let lamp = expected > 14.0;
        assert_eq!(
            (material, emitter),
            (Some(if lamp { 0 } else { 2 }), lamp.then_some(0))
        );
    }
}

/// Tiny things beside huge ones: boxes of single precision must not lose them.
#[test]
fn scales_may_differ_by_ten_orders() {
    let mut rng = SplitMix::new(25);
    let mut surfaces = vec![matter(disk(1e6, 0.0, 0.0, DAffine3::IDENTITY))];
    let centre = DVec3::new(1e3, -2e3, 1.0);
    let balls: Vec<_> = (0..300).map(|_| centre + within(&mut rng, 0.1)).collect();
    surfaces.extend(
        balls
            .iter()
            .map(|&c| matter(sphere(1e-4, DAffine3::from_translation(c)))),
    );
    let all = ready(surfaces);
    for &ball in &balls {
        let ray = towards(centre + direction(&mut rng) * 0.9, ball);
        let hit = all.intersect(&ray, f64::INFINITY).expect("a ball at least");
        assert!(hit.t <= (ball - ray.origin).length());
        assert!((hit.anchor.point - centre).length() < 0.3, "{hit:?}");
    }
}

#[test]
fn instances_that_doubles_cannot_hold_are_refused() {
    for (map, what) in [
        (DAffine3::from_scale(DVec3::new(1.0, 0.0, 1.0)), "singular"),
        (DAffine3::from_translation(DVec3::X * 1e40), "farther than"),
        (DAffine3::from_scale(DVec3::splat(1e60)), "farther than"),
        (DAffine3::from_scale(DVec3::splat(f64::NAN)), "singular"),
    ] {
        let scene = Scene {
            objects: vec![Object {
                name: "o".into(),
                surfaces: vec![matter(triangle([DVec3::ZERO, DVec3::X, DVec3::Y]))],
            }],
            instances: vec![Instance {
                object: 0,
                object_to_world: map,
                place: place(),
            }],
            ..empty()
        };
        let error = Surfaces::new(&scene, DVec3::ZERO).expect_err("refused");
        assert!(error.to_string().contains(what), "{error}");
    }
}
