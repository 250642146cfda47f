//! Surfaces as lights: irradiances in closed form, and the same light sampled, hit, and sent.

use super::adjoint::{Receiver, both_ways};
use super::*;
use woodcock_host::light::Departure;
use woodcock_host::ray::{Anchor, Ray};
use woodcock_host::scene::{BilinearMesh, Disk};
use woodcock_host::surface::Hit;
use woodcock_tests::refs::surfaces::{Emitter, load};
use woodcock_tests::stats::{Mutants, Sample, Verdict, assert_agrees, judge, samples, seed};

const N: usize = 1 << 17;

const WHITE: [f64; 3] = [1.0; 3];

fn irradiance(setting: &Setting, from: DVec3, normal: DVec3, base: u64) -> Sample {
    let (lights, surfaces) = (setting.lights(), setting.surfaces());
    let mut rng = SplitMix::new(seed(base));
    Sample::collect(samples(N), |_| {
        let sample = lights.sample(&surfaces, from, normal, uniforms(&mut rng));
        sample.map_or(0.0, |sample| weight(&sample, normal))
    })
}

fn disk(height: f64, radius: f64) -> Shape {
    Shape::Disk(Disk {
        height: 0.0,
        radius,
        inner_radius: 0.0,
        // Turned over, so that it faces down.
        object_to_world: DAffine3::from_translation(ORIGIN + DVec3::Z * height)
            * DAffine3::from_rotation_x(PI),
    })
}

fn rectangle([x0, x1, y0, y1, h]: [f64; 5]) -> [[DVec3; 3]; 2] {
    let [a, b, c, d] = [[x0, y0], [x0, y1], [x1, y1], [x1, y0]].map(|[x, y]| DVec3::new(x, y, h));
    [[a, b, c], [a, c, d]]
}

#[test]
fn emitters_give_the_irradiance_of_the_tables() {
    for (index, row) in load().irradiance.into_iter().enumerate() {
        let shape = match row.emitter {
            Emitter::Sphere {
                radius,
                distance,
                angle_deg,
            } => {
                let (sin, cos) = angle_deg.to_radians().sin_cos();
                ball(DVec3::new(0.0, sin, cos) * distance, radius)
            }
            Emitter::Disk { radius, height } => disk(height, radius),
            Emitter::Rectangle { extent } => triangles(&rectangle(extent)),
        };
        let mut setting = Setting::new([]).with([shining(shape, [2.0, 1.0, 3.0], false)]);
        setting.scene.film.imaging_ratio = 0.5;
        let got = irradiance(&setting, DVec3::ZERO, DVec3::Z, 0x5511 + index as u64);
        assert_agrees("table", &got, row.irradiance, 0.003);
    }
}

/// One of each shape, in view of the origin and apart from each other; some shine to both sides.
fn shapes() -> [Surface; 4] {
    // Nearly level, so that it does not hide itself.
    let patch = [
        [-2.0, 1.0, 1.5],
        [-1.0, 1.0, 1.6],
        [-2.0, 2.0, 1.4],
        [-1.0, 2.0, 1.8],
    ];
    let patch = Shape::BilinearMesh(Arc::new(BilinearMesh {
        positions: patch.iter().map(|p| ORIGIN + DVec3::from(*p)).collect(),
        indices: vec![[0, 1, 2, 3]],
        ..BilinearMesh::default()
    }));
    let rectangle = rectangle([0.5, 1.5, 0.5, 2.0, 1.0]);
    [
        shining(triangles(&rectangle), [2.0, 1.0, 0.5], false),
        shining(ball(DVec3::new(0.5, -2.0, 0.5), 0.7), [1.0; 3], false),
        shining(disk(2.5, 0.5), [3.0, 0.0, 0.0], true),
        shining(patch, [0.5, 1.0, 1.5], true),
    ]
}

const PLACES: [(DVec3, DVec3); 3] = [
    (DVec3::ZERO, DVec3::Z),
    (DVec3::new(0.3, 0.2, -1.0), DVec3::ZERO),
    (DVec3::new(-0.2, -0.4, 0.1), DVec3::new(0.0, 0.6, 0.8)),
];

#[test]
fn what_is_sampled_is_hit_with_the_same_density_and_radiance() {
    let setting = Setting::new([point(DVec3::X, WHITE), constant(WHITE)]).with(shapes());
    let (lights, surfaces) = (setting.lights(), setting.surfaces());
    assert_eq!((lights.first_emitter(), surfaces.emitters()), (2, 5));
    let mut rng = SplitMix::new(0x5521);
    let mut seen = [0; 7];
    for (from, normal) in PLACES {
        for _ in 0..20_000 {
            let Some(s) = lights.sample(&surfaces, from, normal, uniforms(&mut rng)) else {
                continue;
            };
            seen[s.light as usize] += 1;
            if s.light < 2 {
                continue;
            }
            let ray = Ray {
                origin: from,
                direction: s.direction,
            };
            let to = s.anchor.expect("a place").point;
            assert!(((to - from).normalize() - s.direction).length() < 1e-12);
            let hit = surfaces.intersect(&ray, f64::INFINITY).expect("a surface");
            if hit.emitter != Some(s.light - 2) || (ray.at(hit.t) - to).length() > 1e-6 {
                // Something is before it, or it is the edge.
                continue;
            }
            assert_eq!(lights.hit_radiance(&hit, s.direction), s.radiance);
            let found = lights.hit_pdf(&surfaces, from, normal, &hit);
            let expected = s.pdf * s.choice;
            assert!(
                (found / expected - 1.0).abs() < 1e-6,
                "{s:?}: {found} {expected}"
            );
        }
    }
    assert!(seen.iter().all(|count| *count > 100), "{seen:?}");
}

#[test]
fn rays_meet_the_light_that_samples_bring() {
    let setting = Setting::new([]).with(shapes());
    let (lights, surfaces) = (setting.lights(), setting.surfaces());
    let mut suite = Mutants::new(
        "hits",
        &[
            "choice forgotten",
            "the back shines",
            "other side of the ray",
        ],
    );
    let mut rng = SplitMix::new(seed(0x5531));
    // From below no emitter hides another from here: all densities of hits together are those of all samples.
    let (from, normal) = (DVec3::ZERO, DVec3::Z);
    let n = samples(4 * N);
    let mut hits = |of: &dyn Fn(&Hit, DVec3) -> f64| {
        Sample::collect(n, |_| {
            let direction = sphere(uniforms(&mut rng));
            let origin = from;
            let hit = surfaces.intersect(&Ray { origin, direction }, f64::INFINITY);
            hit.map_or(0.0, |hit| 4.0 * PI * of(&hit, direction))
        })
    };
    let pdf = |hit: &Hit| lights.hit_pdf(&surfaces, from, normal, hit);
    let density = hits(&|hit, _| pdf(hit));
    suite.check("density", judge(density.moments(), 1.0, 0.02));
    let density = hits(&|hit, _| {
        let light = lights.first_emitter() + hit.emitter.unwrap_or(0);
        match lights.choice(light, from, normal) {
            0.0 => 0.0,
            choice => pdf(hit) / choice,
        }
    });
    suite.trial(
        "density",
        "choice forgotten",
        judge(density.moments(), 1.0, 0.2),
    );

    let truth = irradiance(&setting, from, normal, 0x5532).moments().mean();
    let seen = |hit: &Hit, d: DVec3| mean(lights.hit_radiance(hit, d)) * d.z.max(0.0);
    let found = hits(&seen);
    suite.check("irradiance", judge(found.moments(), truth, 0.01));
    let both = hits(&|hit, d| seen(hit, d) + mean(lights.hit_radiance(hit, -d)) * d.z.max(0.0));
    suite.trial(
        "irradiance",
        "the back shines",
        judge(both.moments(), truth, 0.01),
    );
    let wrong = hits(&|hit, d| mean(lights.hit_radiance(hit, -d)) * d.z.max(0.0));
    suite.trial(
        "irradiance",
        "other side of the ray",
        judge(wrong.moments(), truth, 0.01),
    );
    suite.finish();
}

#[test]
fn the_dark_side_is_dark() {
    let down = rectangle([-1.0, 1.0, -1.0, 1.0, 0.0]);
    for two_sided in [false, true] {
        let setting = Setting::new([]).with([shining(triangles(&down), WHITE, two_sided)]);
        let (lights, surfaces) = (setting.lights(), setting.surfaces());
        let mut rng = SplitMix::new(0x5541);
        for (height, lit) in [(-1.0, true), (1.0, two_sided)] {
            let from = DVec3::new(0.1, -0.2, height);
            for _ in 0..100 {
                let sample = lights.sample(&surfaces, from, DVec3::ZERO, uniforms(&mut rng));
                assert_eq!(sample.is_some(), lit);
            }
            let ray = Ray {
                origin: from,
                direction: DVec3::new(0.0, 0.0, -height),
            };
            let hit = surfaces.intersect(&ray, f64::INFINITY).expect("the lamp");
            let radiance = lights.hit_radiance(&hit, ray.direction);
            assert_eq!(radiance == WHITE, lit);
            assert_eq!(radiance == [0.0; 3], !lit);
            let sent = lights.emission_pdf(&surfaces, 0, &hit.anchor, -ray.direction);
            assert_eq!(sent.1 > 0.0, lit);
        }
    }
}

/// Lambert's formula for a polygon above the horizon, of radiance one: half the sum over edges of the angle that the
/// edge fills times the cosine between its plane's normal and the receiver's.
fn lambert(corners: [DVec3; 3], from: DVec3, normal: DVec3) -> f64 {
    let r = corners.map(|c| (c - from).normalize());
    let mut sum = 0.0;
    for i in 0..3 {
        let (a, b) = (r[i], r[(i + 1) % 3]);
        sum += a.dot(b).clamp(-1.0, 1.0).acos() * a.cross(b).normalize().dot(normal);
    }
    0.5 * sum.abs()
}

#[test]
fn a_thousand_emitters_sum_to_their_irradiance() {
    let mut rng = SplitMix::new(0x5551);
    let mut corners = Vec::new();
    for i in 0..1000 {
        let at = DVec3::from(uniforms::<3>(&mut rng)) * DVec3::new(6.0, 6.0, 2.0)
            + DVec3::new(-3.0, -3.0, 0.6);
        let size = if i % 50 == 0 { 0.5 } else { 0.08 };
        corners.push([0, 1, 2].map(|_| at + sphere(uniforms(&mut rng)) * size));
    }
    // One mesh that shines to its front, one to both sides.
    let (one, two) = corners.split_at(600);
    let setting = Setting::new([]).with([
        shining(triangles(one), [2.0; 3], false),
        shining(triangles(two), [1.0; 3], true),
    ]);
    let (lights, surfaces) = (setting.lights(), setting.surfaces());
    let (from, normal) = (DVec3::new(0.2, -0.1, -0.05), DVec3::Z);
    let mut truth = 0.0;
    let mut sum = 0.0;
    let mut brightest = (0, 0.0);
    for (i, c) in corners.iter().enumerate() {
        let front = (c[1] - c[0]).cross(c[2] - c[0]).dot(from - c[0]) > 0.0;
        let radiance = if i >= 600 {
            1.0
        } else {
            2.0 * f64::from(front)
        };
        let light = i as u32;
        let choice = lights.choice(light, from, normal);
        sum += choice;
        assert!(radiance == 0.0 || choice > 0.0, "{i}");
        let brings = radiance * lambert(*c, from, normal);
        truth += brings;
        if brings > brightest.1 {
            brightest = (i, brings);
        }
    }
    assert!((sum - 1.0).abs() < 1e-12, "{sum}");
    let mut suite = Mutants::new(
        "emitters",
        &["choice forgotten", "the brightest never chosen"],
    );
    let run = |mutate: &dyn Fn(&LightSample) -> f64, resolution: f64, base: u64| {
        let mut rng = SplitMix::new(seed(base));
        let sample = Sample::collect(samples(N), |_| {
            let sample = lights.sample(&surfaces, from, normal, uniforms(&mut rng));
            sample.map_or(0.0, |s| mutate(&s) * weight(&s, normal))
        });
        judge(sample.moments(), truth, resolution)
    };
    suite.check("irradiance", run(&|_| 1.0, 0.01, 0x5552));
    suite.trial(
        "irradiance",
        "choice forgotten",
        run(&|s| 1000.0 * s.choice, 0.5, 0x5553),
    );
    let never = |s: &LightSample| f64::from(s.light as usize != brightest.0);
    suite.trial(
        "irradiance",
        "the brightest never chosen",
        run(&never, 0.01, 0x5554),
    );
    suite.finish();
}

#[test]
fn what_surfaces_send_is_their_power_and_lands_where_it_is_looked_for() {
    let setting = Setting::new([]).with(shapes());
    let (lights, surfaces) = (setting.lights(), setting.surfaces());
    let sides = [1.0, 1.0, 1.0, 2.0, 2.0];
    let radiances = [3.5 / 3.0, 3.5 / 3.0, 1.0, 1.0, 1.0];
    let areas = (0..5).map(|emitter| surfaces.area(emitter));
    let powers: Vec<f64> = areas
        .zip(sides)
        .zip(radiances)
        .map(|((a, s), l)| PI * a * s * l)
        .collect();
    assert!((powers[0] + powers[1] - PI * 1.5 * 3.5 / 3.0).abs() < 1e-12);
    assert!((powers[2] - PI * 4.0 * PI * 0.49).abs() < 1e-12);
    let total: f64 = powers.iter().sum();

    let mut rng = SplitMix::new(seed(0x5561));
    let mut sides_seen = [[0_u32; 2]; 5];
    let power = Sample::collect(samples(N), |_| {
        let d: Departure = lights.emit(&surfaces, uniforms(&mut rng)).expect("lit");
        let cos = d.anchor.normal.dot(d.direction);
        assert!((cos.abs() - d.cosine).abs() < 1e-12);
        sides_seen[d.light as usize][usize::from(cos > 0.0)] += 1;
        let pdf = lights.emission_pdf(&surfaces, d.light, &d.anchor, d.direction);
        assert!((pdf.0 / d.pdf_position - 1.0).abs() < 1e-6, "{d:?} {pdf:?}");
        assert!(
            (pdf.1 / d.pdf_direction - 1.0).abs() < 1e-9,
            "{d:?} {pdf:?}"
        );
        let choice = powers[d.light as usize] / total;
        assert!((d.choice / choice - 1.0).abs() < 1e-9);
        mean(d.radiance) * d.cosine / (d.choice * d.pdf_position * d.pdf_direction)
    });
    // All but curved patches are sampled by area, and directions by the cosine: the weight is nearly constant.
    let verdict = judge(power.moments(), total, 0.001);
    assert_eq!(
        verdict,
        Verdict::Agrees,
        "{}",
        power.moments().mean() / total
    );
    for (light, [back, front]) in sides_seen.into_iter().enumerate() {
        assert!(
            front > 1000 && (back > 1000) == (sides[light] == 2.0),
            "{sides_seen:?}"
        );
    }

    let receiver = Receiver {
        centre: DVec3::new(0.0, 0.0, -0.5),
        normal: DVec3::new(0.0, 0.28, 0.96),
        radius: 0.8,
    };
    for (index, surface) in shapes().into_iter().enumerate() {
        let setting = Setting::new([]).with([surface]);
        let verdict = both_ways(&setting, &receiver, 0x5571 + index as u64, 4 * N);
        assert_eq!(verdict, Verdict::Agrees, "{index}");
    }
}

#[test]
fn what_no_surface_is_has_no_density() {
    let setting = Setting::new([point(DVec3::ZERO, WHITE)]).with(shapes());
    let (lights, surfaces) = (setting.lights(), setting.surfaces());
    let ray = Ray {
        origin: DVec3::ZERO,
        direction: DVec3::Z,
    };
    let mut hit = surfaces.intersect(&ray, f64::INFINITY).expect("the disk");
    assert!(lights.hit_pdf(&surfaces, DVec3::ZERO, DVec3::Z, &hit) > 0.0);
    for emitter in [None, Some(5), Some(u32::MAX)] {
        hit.emitter = emitter;
        assert_eq!(lights.hit_radiance(&hit, ray.direction), [0.0; 3]);
        assert_eq!(lights.hit_pdf(&surfaces, DVec3::ZERO, DVec3::Z, &hit), 0.0);
    }
    let anchor = Anchor::in_space(DVec3::ZERO);
    assert_eq!(
        lights.emission_pdf(&surfaces, 9, &anchor, DVec3::Z),
        (0.0, 0.0)
    );
}
