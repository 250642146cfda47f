//! What leaves a surface must not meet it again falsely, and must not miss what lies close in front.

use super::*;
use woodcock_host::ray::Anchor;
use woodcock_host::surface::Hit;
use woodcock_tests::stats::{samples, seed};

/// Sines of the angles between leaving rays and the surface.
const SINES: [f64; 9] = [0.0, 1e-18, 1e-16, 1e-14, 1e-12, 1e-9, 1e-5, 1e-2, 0.7];

/// Which second meeting a shape allows.
#[derive(Clone, Copy, Debug)]
enum Law {
    /// None at all.
    Plane,
    /// None outwards; inwards the far side of a sphere of some radius.
    Ball(f64),
    /// None nearer than where a surface of at most this curvature can rise to the ray.
    Curved(f64),
}

/// A shape, a target box around the origin that rays find it in, and its law.
struct Case {
    name: &'static str,
    shape: fn(DAffine3) -> Shape,
    law: fn(f64) -> Law,
}

fn mapped<const N: usize>(map: DAffine3, corners: [[f64; 3]; N]) -> [DVec3; N] {
    corners.map(|c| map.transform_point3(DVec3::from_array(c)))
}

const CASES: [Case; 7] = [
    Case {
        name: "triangle",
        shape: |m| {
            triangle(mapped(
                m,
                [[-1.0, -0.8, 0.1], [1.0, -0.7, -0.2], [0.1, 0.9, 0.3]],
            ))
        },
        law: |_| Law::Plane,
    },
    Case {
        name: "sliver",
        shape: |m| {
            triangle(mapped(
                m,
                [[-1.0, 0.0, 0.1], [1.0, 1e-5, -0.2], [0.1, 2e-3, -0.07]],
            ))
        },
        law: |_| Law::Plane,
    },
    Case {
        name: "rectangle",
        shape: |m| {
            bilinear(mapped(
                m,
                [
                    [-1.0, -0.8, 0.2],
                    [1.0, -0.8, 0.2],
                    [-1.0, 0.8, 0.2],
                    [1.0, 0.8, 0.2],
                ],
            ))
        },
        law: |_| Law::Plane,
    },
    Case {
        name: "saddle",
        shape: |m| {
            bilinear(mapped(
                m,
                [
                    [-1.0, -1.0, 1.0],
                    [1.0, -1.0, -1.0],
                    [-1.0, 1.0, -1.0],
                    [1.0, 1.0, 1.0],
                ],
            ))
        },
        law: |scale| Law::Curved(1.0 / scale),
    },
    Case {
        name: "ring",
        shape: |m| disk(1.0, 0.2, 0.3, m),
        law: |_| Law::Plane,
    },
    Case {
        name: "sphere",
        shape: |m| sphere(0.9, m),
        law: |scale| Law::Ball(0.9 * scale),
    },
    Case {
        name: "box",
        shape: |m| cube(m),
        law: |_| Law::Curved(0.0),
    },
];

/// A closed cube around the origin, its normals outwards.
fn cube(map: DAffine3) -> Shape {
    let mut positions = Vec::new();
    let mut indices = Vec::new();
    for axis in 0..3 {
        for sign in [-1.0, 1.0] {
            let first = positions.len() as u32;
            for (u, v) in [(-0.8, -0.8), (0.8, -0.8), (0.8, 0.8), (-0.8, 0.8)] {
                let mut p = [0.0; 3];
                p[axis] = sign * 0.8;
                p[(axis + 1) % 3] = u;
                p[(axis + 2) % 3] = v * sign;
                positions.push(map.transform_point3(DVec3::from_array(p)));
            }
            indices.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
        }
    }
    triangles(positions, indices)
}

/// Whether a second meeting obeys the law. `sine` is that of the angle with the surface, positive outwards.
fn allowed(law: Law, outside: bool, sine: f64, again: Option<f64>, error: f64) -> bool {
    match (law, again) {
        (_, None) => !matches!(law, Law::Ball(_)) || outside || sine < 1e-7,
        (Law::Plane, Some(_)) => false,
        (Law::Ball(radius), Some(t)) => {
            // A step off by e shortens a chord of sine s by about e / s; near a tangent nothing may be left of it.
            let (chord, slack) = (
                2.0 * radius * sine,
                1e-9 * radius * sine + 4.0 * error / sine,
            );
            !outside && ((t - chord).abs() <= slack || sine < 1e-7 && t < 1e-5 * radius)
        }
        (Law::Curved(curvature), Some(t)) => {
            // A cube is convex: no ray outwards meets it again.
            if curvature == 0.0 {
                !outside
            } else {
                t * curvature >= 1.9 * sine
            }
        }
    }
}

/// Counts the meetings that no law allows, and those that do not happen though they must.
fn stress(prepare: impl Fn(&Hit) -> Anchor) -> (usize, usize, Vec<String>) {
    let mut rng = SplitMix::new(seed(1));
    let (mut tried, mut wrong) = (0, 0);
    let mut names = Vec::new();
    for case in &CASES {
        for (scale, through) in [1e-6, 1e-2, 1.0, 1e6]
            .iter()
            .flat_map(|&scale| [(scale, false), (scale, true)])
        {
            for shift in [DVec3::ZERO, DVec3::new(1e5, -0.7e5, 0.3e5)] {
                // Where coordinates have no digits left for the shape there is nothing to ask.
                if shift != DVec3::ZERO && scale < 1e-3 {
                    continue;
                }
                let own = rotation(&mut rng) * DAffine3::from_scale(DVec3::splat(scale));
                let map = DAffine3::from_translation(shift) * own;
                let surfaces = if through {
                    // A shape of a space that is turned and large, brought back by an instance.
                    let inner = rotation(&mut rng) * DAffine3::from_scale(DVec3::splat(32.0));
                    let object = vec![matter((case.shape)(inner))];
                    instanced(vec![object], &[(0, map * inner.inverse())], Vec::new())
                } else {
                    ready(vec![matter((case.shape)(map))])
                };
                let law = (case.law)(scale);
                for _ in 0..samples(60) {
                    let ray = towards(
                        shift + direction(&mut rng) * (uniform(&mut rng, 3.0, 1e3) * scale),
                        shift + within(&mut rng, 0.5 * scale),
                    );
                    let Some(hit) = surfaces.intersect(&ray, f64::INFINITY) else {
                        continue;
                    };
                    let anchor = prepare(&hit);
                    let normal = hit.anchor.normal;
                    let (x, y) = normal.any_orthonormal_pair();
                    for sine in SINES {
                        for side in [1.0, -1.0] {
                            let (sin, cos) = uniform(&mut rng, 0.0, 6.2).sin_cos();
                            let along = x * cos + y * sin;
                            let leaving = (along * (1.0 - sine * sine).sqrt()
                                + normal * (sine * side))
                                .normalize();
                            let outside = normal.dot(leaving) >= 0.0;
                            let ray = anchor.ray(leaving);
                            let again = surfaces.intersect(&ray, 1e6 * scale).map(|h| h.t);
                            let occluded = surfaces.occluded(&ray, 1e6 * scale);
                            assert_eq!(occluded, again.is_some());
                            tried += 1;
                            if !allowed(
                                law,
                                outside,
                                normal.dot(leaving).abs(),
                                again,
                                hit.anchor.error,
                            ) {
                                wrong += 1;
                                names.push(format!(
                                    "{} scale {scale} shift {} sine {sine} outside {outside}: {again:?} {anchor:?}",
                                    case.name, shift.x
                                ));
                            }
                        }
                    }
                }
            }
        }
    }
    (tried, wrong, names)
}

#[test]
fn nothing_meets_the_surface_that_it_leaves() {
    let (tried, wrong, names) = stress(|hit| hit.anchor);
    assert!(tried > 20_000, "{tried}");
    assert_eq!(wrong, 0, "of {tried}: {:#?}", &names[..names.len().min(12)]);
}

#[test]
fn without_error_bounds_surfaces_are_met_again() {
    let (tried, wrong, _) = stress(|hit| Anchor {
        error: 0.0,
        ..hit.anchor
    });
    assert!(wrong * 100 > tried, "{wrong} of {tried}");
    // A bound that forgets how far the origin is.
    let (_, wrong, names) = stress(|hit| Anchor {
        error: 1e-15 * hit.anchor.error.min(1.0),
        ..hit.anchor
    });
    assert!(wrong > 0 && names.iter().any(|n| n.contains("shift 100000")));
}

#[test]
fn errors_stay_near_the_last_digits() {
    let mut rng = SplitMix::new(2);
    for case in &CASES {
        for shift in [0.0, 1e5] {
            let map = DAffine3::from_translation(DVec3::splat(shift)) * rotation(&mut rng);
            let surfaces = ready(vec![matter((case.shape)(map))]);
            let mut met = 0;
            for _ in 0..200 {
                let target = DVec3::splat(shift) + within(&mut rng, 0.5);
                let ray = towards(DVec3::splat(shift) + direction(&mut rng) * 5.0, target);
                if let Some(hit) = surfaces.intersect(&ray, f64::INFINITY) {
                    met += 1;
                    let bound = 1e-13 + 1e-14 * shift;
                    assert!(hit.anchor.error < bound, "{}: {hit:?}", case.name);
                }
            }
            assert!(met > 0 || case.name == "sliver", "{}", case.name);
        }
    }
}

/// Two parallel faces, the second in front of the first by a billionth of their size.
#[test]
fn what_lies_close_in_front_is_met() {
    let mut rng = SplitMix::new(3);
    for case in &CASES[..6] {
        for scale in [1e-6, 1.0, 1e6] {
            for shift in [0.0, 1e5] {
                let shift = DVec3::splat(shift);
                // A billionth of all coordinates.
                let gap = 1e-9 * (scale + shift.x);
                if gap > 0.01 * scale {
                    continue;
                }
                let map = DAffine3::from_translation(shift)
                    * rotation(&mut rng)
                    * DAffine3::from_scale(DVec3::splat(scale));
                let first = ready(vec![matter((case.shape)(map))]);
                let mut met = 0;
                for _ in 0..100 {
                    let target = shift + within(&mut rng, 0.4 * scale);
                    let Some(hit) = first.intersect(
                        &towards(shift + direction(&mut rng) * (9.0 * scale), target),
                        f64::INFINITY,
                    ) else {
                        continue;
                    };
                    let normal = hit.anchor.normal;
                    let (x, y) = normal.any_orthonormal_pair();
                    // A wall parallel to the tangent plane.
                    let at = hit.anchor.point + normal * gap;
                    let wall = ready(vec![matter(bilinear([
                        at + (-x - y) * scale,
                        at + (x - y) * scale,
                        at + (-x + y) * scale,
                        at + (x + y) * scale,
                    ]))]);
                    for sine in [1e-6, 1e-3, 0.1, 1.0] {
                        let leaving = (x * (1.0_f64 - sine * sine).max(0.0).sqrt() + normal * sine)
                            .normalize();
                        let found = wall.intersect(&hit.anchor.ray(leaving), f64::INFINITY);
                        let t = found.map_or(f64::NAN, |h| h.t);
                        let expected = gap / sine;
                        if expected > 0.5 * scale {
                            continue;
                        }
                        let slack = 0.05 * expected;
                        assert!(
                            (t - expected).abs() <= slack,
                            "{} {scale} {shift}: {t} {expected}",
                            case.name
                        );
                        met += 1;
                    }
                }
                assert!(met > 40 || case.name == "sliver", "{} {met}", case.name);
            }
        }
    }
}

/// A point on one surface sees a point on another, over any distance and at any slope.
#[test]
fn places_that_see_each_other_are_not_occluded_by_themselves() {
    let mut rng = SplitMix::new(seed(4));
    let mut seen = 0;
    let mut short = 0;
    // A saddle hides behind itself in ways not told by its normals.
    for case in CASES.iter().filter(|case| case.name != "saddle") {
        for distance in [9.0, 1e3, 1e6] {
            let away = direction(&mut rng) * distance;
            let near = matter((case.shape)(rotation(&mut rng)));
            let placed = DAffine3::from_translation(away) * skewed(&mut rng);
            let far = matter((case.shape)(placed));
            let surfaces = ready(vec![near.clone(), far.clone()]);
            let (near, far) = (ready(vec![near]), ready(vec![far]));
            for _ in 0..samples(400) {
                let from = towards(direction(&mut rng) * 3.0, within(&mut rng, 0.6));
                let to = towards(
                    away + direction(&mut rng) * 3.0,
                    away + within(&mut rng, 0.6),
                );
                let (Some(a), Some(b)) = (
                    near.intersect(&from, f64::INFINITY),
                    far.intersect(&to, f64::INFINITY),
                ) else {
                    continue;
                };
                let line = (b.anchor.point - a.anchor.point).normalize();
                // Closed ones hide behind themselves, but where they face each other.
                let closed = matches!(case.name, "sphere" | "box");
                let faces = |anchor: &Anchor, centre: DVec3, line: DVec3| {
                    anchor.normal.dot(line) * anchor.normal.dot(anchor.point - centre) > 0.0
                };
                if closed && !(faces(&a.anchor, DVec3::ZERO, line) && faces(&b.anchor, away, -line))
                {
                    continue;
                }
                let (ray, length) = a.anchor.ray_to(&b.anchor).expect("apart");
                assert!(
                    !surfaces.occluded(&ray, length),
                    "{} {distance} {a:?} {b:?}",
                    case.name
                );
                assert!((length / (b.anchor.point - a.anchor.point).length() - 1.0).abs() < 1e-9);
                seen += 1;
                // The planted mistake: to end where the other place is.
                let origin = a.anchor.leave(line);
                let towards = b.anchor.point - origin;
                let ray = Ray {
                    origin,
                    direction: towards.normalize(),
                };
                short += u32::from(surfaces.occluded(&ray, towards.length()));
            }
        }
    }
    assert!(seen > 1000, "{seen}");
    assert!(short > 100, "{short}");
}
