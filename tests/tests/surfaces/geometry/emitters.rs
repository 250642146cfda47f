//! Points on what shines: densities, areas, bounds, and irradiances in closed form.

use std::f64::consts::PI;

use super::quadrature::mean;
use super::*;
use woodcock_host::surface::EmitterPoint;
use woodcock_tests::refs::surfaces::{Emitter, load};
use woodcock_tests::stats::{ChiSquare, Moments, Mutants, judge, seed};

/// A shape that shines, with references that see it: in front, behind, near, far, inside and grazing.
struct Case {
    name: &'static str,
    surfaces: Surfaces,
    references: Vec<DVec3>,
}

fn cases() -> Vec<Case> {
    let mut rng = SplitMix::new(31);
    let place = DAffine3::from_translation(DVec3::new(1.0, -2.0, 0.5)) * skewed(&mut rng);
    let rigid = DAffine3::from_translation(DVec3::new(0.3, 0.2, -0.1)) * rotation(&mut rng);
    let case = |name, shape, references: &[[f64; 3]]| Case {
        name,
        surfaces: ready(vec![lamp(shape)]),
        references: references.iter().map(|r| DVec3::from_array(*r)).collect(),
    };
    let corners = [
        DVec3::new(-0.5, -0.4, 0.2),
        DVec3::new(0.7, -0.3, -0.1),
        DVec3::new(0.1, 0.9, 0.3),
    ];
    let flat = [
        DVec3::new(-0.5, -0.3, 0.0),
        DVec3::new(1.0, -0.3, 0.2),
        DVec3::new(-0.5, 0.7, 0.1),
        DVec3::new(1.0, 0.7, 0.3),
    ];
    let trapezoid = [
        DVec3::new(-0.5, -0.3, 0.0),
        DVec3::new(1.0, -0.3, 0.0),
        DVec3::new(-0.1, 0.7, 0.0),
        DVec3::new(0.3, 0.7, 0.0),
    ];
    let bent = [
        DVec3::new(-1.0, -1.0, 0.5),
        DVec3::new(1.0, -0.8, -0.4),
        DVec3::new(-0.9, 1.0, -0.3),
        DVec3::new(0.8, 0.7, 0.6),
    ];
    vec![
        case(
            "triangle",
            triangle(corners),
            &[
                [0.1, 0.0, 1.2],
                [0.3, 0.2, -0.9],
                [2.0, -1.0, 0.3],
                [0.1, 0.1, 0.35],
            ],
        ),
        case(
            "small triangle",
            triangle(corners.map(|c| c * 1e-4)),
            &[[0.1, 0.0, 1.2], [0.3, 2.0, -0.9]],
        ),
        case(
            "rectangle",
            bilinear(flat),
            &[[0.1, 0.0, 1.2], [0.3, 0.2, -0.9], [5.0, 3.0, 2.0]],
        ),
        case(
            "trapezoid",
            bilinear(trapezoid),
            &[[0.1, 0.0, 1.2], [0.3, 0.2, -0.9]],
        ),
        case(
            "bent patch",
            bilinear(bent),
            &[[0.1, 0.0, 3.0], [0.3, 0.2, -4.0]],
        ),
        case(
            "ring",
            disk(0.8, 0.3, 0.1, place),
            &[[1.0, 0.0, 3.0], [3.0, -2.0, -2.0], [1.0, -2.0, 9.0]],
        ),
        case(
            "sphere",
            sphere(0.7, rigid),
            &[
                [2.0, 0.1, 0.4],
                [0.9, 0.7, 0.4],
                [0.3, 0.2, -0.05],
                [40.0, 3.0, -2.0],
            ],
        ),
        case(
            "ellipsoid",
            sphere(0.8, place),
            &[[3.0, 0.1, 0.4], [1.1, -2.0, 0.45], [-2.0, 5.0, 3.0]],
        ),
    ]
}

/// cos θ / d² at the emitter: solid angle per area.
fn angle_per_area(point: &EmitterPoint, reference: DVec3) -> f64 {
    let away = reference - point.anchor.point;
    let squared = away.length_squared();
    point.anchor.normal.dot(away).abs() / (squared * squared.sqrt())
}

#[test]
fn densities_per_area_are_exact() {
    for case in cases() {
        let surfaces = &case.surfaces;
        let area = mean(80, |u| 1.0 / surfaces.sample_emitter_area(0, u).pdf);
        assert!(
            (area / surfaces.area(0) - 1.0).abs() < 1e-6,
            "{}: {area} {}",
            case.name,
            surfaces.area(0)
        );
        let mut rng = SplitMix::new(32);
        for _ in 0..100 {
            let u = [uniform(&mut rng, 0.01, 0.99), uniform(&mut rng, 0.01, 0.99)];
            let point = surfaces.sample_emitter_area(0, u);
            let pdf = surfaces.emitter_area_pdf(0, &point.anchor);
            assert!(
                (pdf / point.pdf - 1.0).abs() < 1e-9,
                "{} {pdf} {point:?}",
                case.name
            );
            // The map stretches area by the reciprocal of the density.
            let h = 1e-5;
            let at = |u0: f64, u1: f64| surfaces.sample_emitter_area(0, [u0, u1]).anchor.point;
            let by_0 = (at(u[0] + h, u[1]) - at(u[0] - h, u[1])) / (2.0 * h);
            let by_1 = (at(u[0], u[1] + h) - at(u[0], u[1] - h)) / (2.0 * h);
            let stretch = by_0.cross(by_1).length();
            assert!(
                (stretch * point.pdf - 1.0).abs() < 1e-4,
                "{} {u:?}: {}",
                case.name,
                stretch * point.pdf
            );
        }
    }
}

#[test]
fn densities_per_solid_angle_are_exact() {
    for case in cases() {
        let surfaces = &case.surfaces;
        for &reference in &case.references {
            let mut rng = SplitMix::new(33);
            for _ in 0..100 {
                let u = [uniform(&mut rng, 0.02, 0.98), uniform(&mut rng, 0.02, 0.98)];
                let point = surfaces.sample_emitter(0, reference, u).expect("seen");
                let pdf = surfaces.emitter_pdf(0, reference, &point.anchor);
                assert!(
                    (pdf / point.pdf - 1.0).abs() < 1e-7,
                    "{} {reference} {pdf} {point:?}",
                    case.name
                );
                // The map to directions stretches by the reciprocal of the density.
                let h = 1e-5;
                let at = |u0: f64, u1: f64| {
                    let point = surfaces
                        .sample_emitter(0, reference, [u0, u1])
                        .expect("seen");
                    (point.anchor.point - reference).normalize()
                };
                let by_0 = (at(u[0] + h, u[1]) - at(u[0] - h, u[1])) / (2.0 * h);
                let by_1 = (at(u[0], u[1] + h) - at(u[0], u[1] - h)) / (2.0 * h);
                let stretch = by_0.cross(by_1).length();
                assert!(
                    (stretch * point.pdf - 1.0).abs() < 3e-3,
                    "{} {reference} {u:?}: {}",
                    case.name,
                    stretch * point.pdf
                );
            }
        }
    }
}

/// ∫ pdf dω over the emitter, the place of each direction found through the density per area.
#[test]
fn densities_per_solid_angle_sum_to_one() {
    for case in cases() {
        let surfaces = &case.surfaces;
        for &reference in &case.references {
            let sum = mean(100, |u| {
                let point = surfaces.sample_emitter_area(0, u);
                surfaces.emitter_pdf(0, reference, &point.anchor)
                    * angle_per_area(&point, reference)
                    / point.pdf
            });
            assert!((sum - 1.0).abs() < 4e-3, "{} {reference}: {sum}", case.name);
        }
    }
}

/// Emitters as the table describes them, from shapes of several kinds.
fn irradiated(emitter: &Emitter) -> Vec<(&'static str, Shape)> {
    match *emitter {
        Emitter::Sphere {
            radius,
            distance,
            angle_deg,
        } => {
            let angle = angle_deg.to_radians();
            let centre = DVec3::new(angle.sin(), 0.0, angle.cos()) * distance;
            vec![("sphere", sphere(radius, DAffine3::from_translation(centre)))]
        }
        Emitter::Disk { radius, height } => {
            let down = DAffine3::from_rotation_x(PI);
            vec![
                ("disk", disk(radius, 0.0, -height, down)),
                (
                    "stretched disk",
                    disk(
                        1.0,
                        0.0,
                        -1.0,
                        DAffine3::from_scale(DVec3::new(radius, radius, -height)),
                    ),
                ),
            ]
        }
        Emitter::Rectangle {
            extent: [x0, x1, y0, y1, h],
        } => {
            let [a, b, c, d] =
                [(x0, y0), (x1, y0), (x0, y1), (x1, y1)].map(|(x, y)| DVec3::new(x, y, h));
            vec![
                ("patch", bilinear([a, c, b, d])),
                (
                    "triangles",
                    triangles(vec![a, b, c, d], vec![[0, 2, 1], [2, 3, 1]]),
                ),
            ]
        }
    }
}

#[test]
fn irradiances_have_their_closed_forms() {
    for row in load().irradiance {
        for (name, shape) in irradiated(&row.emitter) {
            let surfaces = ready(vec![lamp(shape)]);
            let emitters = surfaces.emitters();
            let seen: f64 = (0..emitters)
                .map(|emitter| {
                    // Squares take the roots out of the maps.
                    mean(40, |[s, t]| {
                        let point = surfaces
                            .sample_emitter(emitter, DVec3::ZERO, [s * s, t * t])
                            .expect("seen");
                        let direction = point.anchor.point.normalize();
                        // One-sided: it shines to the side of its normal.
                        assert!(point.anchor.normal.dot(direction) < 1e-7, "{name}");
                        4.0 * s * t * direction.z / point.pdf
                    })
                })
                .sum();
            assert!(
                (seen - row.irradiance).abs() < 1e-9,
                "{name}: {seen} {}",
                row.irradiance
            );
            let by_area: f64 = (0..emitters)
                .map(|emitter| {
                    mean(200, |u| {
                        let point = surfaces.sample_emitter_area(emitter, u);
                        let direction = point.anchor.point.normalize();
                        if point.anchor.normal.dot(direction) > 0.0 {
                            return 0.0;
                        }
                        direction.z * angle_per_area(&point, DVec3::ZERO) / point.pdf
                    })
                })
                .sum();
            assert!(
                (by_area - row.irradiance).abs() < 1e-5,
                "{name}: {by_area} {}",
                row.irradiance
            );
            // What rays meet has the same density as what is chosen.
            let mut rng = SplitMix::new(34);
            for _ in 0..200 {
                let emitter = rng.bits() as u32 % emitters;
                let u = [rng.uniform(), rng.uniform()];
                let point = surfaces
                    .sample_emitter(emitter, DVec3::ZERO, u)
                    .expect("seen");
                let ray = towards(DVec3::ZERO, point.anchor.point);
                let Some(hit) = surfaces.intersect(&ray, f64::INFINITY) else {
                    // At an edge the ray may pass.
                    continue;
                };
                let found = hit.emitter.expect("shines");
                let pdf = surfaces.emitter_pdf(found, DVec3::ZERO, &hit.anchor);
                if found == emitter && (hit.anchor.point - point.anchor.point).length() < 1e-9 {
                    assert!(
                        (pdf / point.pdf - 1.0).abs() < 1e-6,
                        "{name} {pdf} {point:?}"
                    );
                }
            }
        }
    }
}

/// A planted mistake: a point and the density claimed for it.
type Mistake = fn(&Surfaces, DVec3, [f64; 2]) -> Option<EmitterPoint>;

const MISTAKES: [(&str, Mistake); 4] = [
    ("density per area without the slope", |s, r, u| {
        let point = s.sample_emitter_area(0, u);
        let pdf = point.pdf * (point.anchor.point - r).length_squared();
        Some(EmitterPoint { pdf, ..point })
    }),
    ("even points, density of solid angle", |s, r, u| {
        let point = s.sample_emitter_area(0, u);
        let pdf = s.emitter_pdf(0, r, &point.anchor);
        Some(EmitterPoint { pdf, ..point })
    }),
    ("both numbers the same", |s, r, u| {
        s.sample_emitter(0, r, [u[0], u[0]])
    }),
    ("linear instead of the root", |s, r, u| {
        s.sample_emitter(0, r, [u[0] * u[0], u[1]])
    }),
];

/// Cells of direction that just cover an emitter as seen from a reference.
struct Grid {
    x: DVec3,
    y: DVec3,
    low: DVec2,
    size: DVec2,
}

const CELLS: usize = 10;

impl Grid {
    fn new(surfaces: &Surfaces, reference: DVec3) -> Self {
        let mut middle = DVec3::ZERO;
        let towards = |u| (surfaces.sample_emitter_area(0, u).anchor.point - reference).normalize();
        mean(20, |u| {
            middle += towards(u);
            0.0
        });
        let (x, y) = middle.normalize().any_orthonormal_pair();
        let (mut low, mut high) = (DVec2::INFINITY, DVec2::NEG_INFINITY);
        mean(20, |u| {
            let at = DVec2::new(towards(u).dot(x), towards(u).dot(y));
            low = low.min(at);
            high = high.max(at);
            0.0
        });
        Self {
            x,
            y,
            low,
            size: high - low,
        }
    }

    fn cell(&self, direction: DVec3) -> usize {
        let at = (DVec2::new(direction.dot(self.x), direction.dot(self.y)) - self.low) / self.size;
        let index = |s: f64| ((s * CELLS as f64) as usize).min(CELLS - 1);
        index(at.x) * CELLS + index(at.y)
    }
}

/// What an estimator of irradiance on a surface across `axis` says, and in which cells its points fall.
fn trial(
    (surfaces, reference, axis, grid): (&Surfaces, DVec3, DVec3, &Grid),
    n: usize,
    choose: Mistake,
) -> (Moments, Vec<u64>) {
    let mut rng = SplitMix::new(seed(35));
    let mut moments = Moments::default();
    let mut counts = vec![0; CELLS * CELLS];
    for _ in 0..n {
        let u = [rng.uniform(), rng.uniform()];
        let Some(point) = choose(surfaces, reference, u).filter(|p| p.pdf > 0.0) else {
            moments.push(0.0);
            continue;
        };
        let direction = (point.anchor.point - reference).normalize();
        moments.push(direction.dot(axis).abs() / point.pdf);
        counts[grid.cell(direction)] += 1;
    }
    (moments, counts)
}

#[test]
fn points_follow_their_density_and_mistakes_are_found() {
    let mut suite = Mutants::new("emitters", &MISTAKES.map(|(name, _)| name));
    // More would see the edges of cells between the nodes of the quadrature; with four times as many nodes an axis,
    // thirty times as many points agree.
    let n = 20_000;
    for case in cases() {
        let surfaces = &case.surfaces;
        for &reference in &case.references {
            let axis = DVec3::new(0.6, 0.64, -0.48);
            let grid = Grid::new(surfaces, reference);
            let mut probabilities = vec![0.0; CELLS * CELLS];
            let truth = mean(150, |u| {
                let point = surfaces.sample_emitter_area(0, u);
                let direction = (point.anchor.point - reference).normalize();
                let pdf = surfaces.emitter_pdf(0, reference, &point.anchor);
                let angle = angle_per_area(&point, reference) / point.pdf;
                probabilities[grid.cell(direction)] += pdf * angle;
                if pdf > 0.0 {
                    direction.dot(axis).abs() * angle
                } else {
                    0.0
                }
            });
            // Slivers of cells that no node fell in are not impossible.
            probabilities.iter_mut().for_each(|p| *p = p.max(1e-7));
            let sum: f64 = probabilities.iter().sum();
            probabilities.iter_mut().for_each(|p| *p /= sum);
            let law = |counts: &[u64]| ChiSquare::new(counts, &probabilities).verdict(0.15);
            let seen = (surfaces, reference, axis, &grid);
            let (moments, counts) = trial(seen, n, |s, r, u| s.sample_emitter(0, r, u));
            suite.check("mean", judge(&moments, truth, 0.02));
            suite.check("law", law(&counts));
            for (name, mistake) in MISTAKES {
                let (moments, counts) = trial(seen, n, mistake);
                suite.trial("mean", name, judge(&moments, truth, 0.02));
                suite.trial("law", name, law(&counts));
            }
        }
    }
    suite.finish();
}

#[test]
fn areas_have_their_closed_forms() {
    let area = |shape| ready(vec![lamp(shape)]).area(0);
    let close = |a: f64, b: f64| assert!((a / b - 1.0).abs() < 1e-9, "{a} {b}");
    close(area(sphere(2.0, DAffine3::IDENTITY)), 16.0 * PI);
    // Ellipsoid of semi-axes 1, 2, 3: 48.88214 [DLMF 19.33.1 by quadrature].
    let mut rng = SplitMix::new(36);
    let turned =
        rotation(&mut rng) * DAffine3::from_scale(DVec3::new(1.0, -2.0, 3.0)) * rotation(&mut rng);
    assert!(
        (area(sphere(1.0, turned)) - 48.882_146_3).abs() < 1e-6,
        "{}",
        area(sphere(1.0, turned))
    );
    close(
        area(disk(
            2.0,
            1.0,
            7.0,
            DAffine3::from_scale(DVec3::new(3.0, 1.0, 9.0)),
        )),
        9.0 * PI,
    );
    close(area(triangle([DVec3::ZERO, DVec3::X, DVec3::Y])), 0.5);
    // z = x y over [-1, 1]²: ∫∫ √(1 + x² + y²).
    let saddle = bilinear([
        DVec3::new(-1.0, -1.0, 1.0),
        DVec3::new(1.0, -1.0, -1.0),
        DVec3::new(-1.0, 1.0, -1.0),
        DVec3::new(1.0, 1.0, 1.0),
    ]);
    let expected = mean(60, |[x, y]| {
        4.0 * (1.0 + (2.0 * x - 1.0).powi(2) + (2.0 * y - 1.0).powi(2)).sqrt()
    });
    close(area(saddle), expected);
    // A plane patch that folds over itself: two triangles of area 1/4.
    let bow_tie = bilinear([DVec3::ZERO, DVec3::X, DVec3::new(1.0, 1.0, 0.0), DVec3::Y]);
    assert!((area(bow_tie) - 0.5).abs() < 1e-6);
}

#[test]
fn bounds_hold_every_point_and_normal() {
    for mut case in cases() {
        for flipped in [false, true] {
            if flipped {
                let scene_surface = Surface {
                    flipped,
                    ..lamp(bilinear([
                        DVec3::ZERO,
                        DVec3::X,
                        DVec3::Y,
                        DVec3::new(1.0, 1.0, 0.4),
                    ]))
                };
                case.surfaces = ready(vec![scene_surface]);
            }
            let ([low, high], axis, cosine) = case.surfaces.emitter_bounds(0);
            assert!((axis.length() - 1.0).abs() < 1e-12);
            let (mut reach, mut narrowest) = (0.0_f64, 1.0_f64);
            mean(12, |u| {
                let point = case.surfaces.sample_emitter_area(0, u).anchor;
                let room = 1e-12;
                assert!(
                    point.point.cmpge(low - room).all() && point.point.cmple(high + room).all()
                );
                let along = point.normal.dot(axis);
                assert!(along >= cosine - 1e-12, "{}: {along} {cosine}", case.name);
                narrowest = narrowest.min(along);
                reach = reach.max((point.point - low).max_element());
                0.0
            });
            // And not much more than that.
            assert!(reach > 0.8 * (high - low).max_element(), "{}", case.name);
            assert!(
                narrowest - cosine < 0.1,
                "{} {narrowest} {cosine}",
                case.name
            );
        }
    }
}

#[test]
fn far_and_near_spheres_keep_their_digits() {
    let surfaces = ready(vec![lamp(sphere(1.0, DAffine3::IDENTITY))]);
    let mut rng = SplitMix::new(37);
    for distance in [1.0 + 1e-9, 1.0 + 1e-3, 2.0, 1e4, 1e9] {
        let reference = direction(&mut rng) * distance;
        // 1 − cos of the cone, from the sine, where the cosine keeps it.
        let sin = 1.0 / distance;
        let cos = ((distance - 1.0) / distance * (1.0 + sin)).sqrt();
        let expected = (1.0 + cos) / (2.0 * PI * sin * sin);
        for _ in 0..200 {
            let u = [rng.uniform(), rng.uniform()];
            let point = surfaces.sample_emitter(0, reference, u).expect("seen");
            assert!(
                (point.pdf / expected - 1.0).abs() < 1e-6,
                "{distance} {}",
                point.pdf / expected
            );
            assert!((point.anchor.point.length() - 1.0).abs() < 1e-15);
            let pdf = surfaces.emitter_pdf(0, reference, &point.anchor);
            assert!(
                (pdf / expected - 1.0).abs() < 1e-6 || u[0] > 0.999,
                "{distance} {u:?} {pdf}"
            );
            // The far side is never chosen.
            let behind = woodcock_host::ray::Anchor {
                point: -point.anchor.point,
                normal: -point.anchor.normal,
                ..point.anchor
            };
            assert_eq!(surfaces.emitter_pdf(0, reference, &behind), 0.0);
            // It is where the ray to it meets the sphere.
            let ray = towards(reference, point.anchor.point);
            if u[0] < 0.99 && distance < 1e8 {
                let hit = surfaces.intersect(&ray, f64::INFINITY).expect("met");
                let apart = (hit.anchor.point - point.anchor.point).length();
                assert!(
                    apart < 1e-14 * (1.0 + distance) / (1.0 - u[0]),
                    "{distance} {apart}"
                );
            }
        }
    }
}

#[test]
fn triangles_seen_under_any_angle_keep_their_density() {
    let corners = [
        DVec3::new(-1.0, -1.0, 0.0),
        DVec3::new(2.0, -1.0, 0.0),
        DVec3::new(0.0, 1.5, 0.0),
    ];
    let surfaces = ready(vec![lamp(triangle(corners))]);
    let mut rng = SplitMix::new(38);
    for height in [1e-9, 1e-6, 1e-4, 0.1, 3.0, 100.0, 2e3, 1e4, 1e7] {
        let reference = DVec3::new(0.1, 0.2, height);
        // Solid angle by the angles of its dihedrals, as Girard has it.
        let [a, b, c] = corners.map(|p| (p - reference).normalize());
        let dihedral = |a: DVec3, b: DVec3, c: DVec3| {
            let (x, y) = (a.cross(b).normalize(), a.cross(c).normalize());
            x.cross(y).length().atan2(x.dot(y))
        };
        let girard = dihedral(a, b, c) + dihedral(b, c, a) + dihedral(c, a, b) - PI;
        for _ in 0..100 {
            let u = [rng.uniform(), rng.uniform()];
            let point = surfaces.sample_emitter(0, reference, u).expect("seen");
            let pdf = surfaces.emitter_pdf(0, reference, &point.anchor);
            assert!((pdf / point.pdf - 1.0).abs() < 1e-9);
            if girard > 1.1e-5 && girard < 2.0 * PI - 1.1e-5 {
                assert!((pdf * girard - 1.0).abs() < 1e-9, "{height} {pdf} {girard}");
            } else if girard < 1e-5 {
                let slope = height / (point.anchor.point - reference).length();
                let area = surfaces.area(0);
                let expected = (point.anchor.point - reference).length_squared() / (area * slope);
                assert!((pdf / expected - 1.0).abs() < 1e-9);
            }
        }
    }
    // In the plane nothing is seen.
    let beside = DVec3::new(5.0, 0.0, 0.0);
    assert!(surfaces.sample_emitter(0, beside, [0.3, 0.4]).is_none());
    let point = surfaces.sample_emitter_area(0, [0.3, 0.4]);
    assert_eq!(surfaces.emitter_pdf(0, beside, &point.anchor), 0.0);
    // At a corner and at the point itself nothing breaks.
    for reference in [corners[0], point.anchor.point] {
        let pdf = surfaces.emitter_pdf(0, reference, &point.anchor);
        assert!(pdf >= 0.0 && pdf.is_finite(), "{pdf}");
    }
}
