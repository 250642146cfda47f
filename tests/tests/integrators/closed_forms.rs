//! Scenes whose radiance is a formula, through the renderer, by every integrator that can see it.

use std::f64::consts::PI;
use woodcock_tests::pictures::*;

mod glow;
mod lights;
pub(crate) mod measure;
mod mirrors;

use measure::*;

const ALL: [woodcock_host::integrator::Integrator; 5] = [Path, Bdpt, Mlt, Single, Transmittance];
const LIT: [woodcock_host::integrator::Integrator; 4] = [Path, Bdpt, Mlt, Single];

const FOG: Xyz = [0.2, 0.5, 0.8];

fn absorbed(depth_per_density: Xyz, by: f64) -> Xyz {
    depth_per_density.map(|sigma| (-sigma * by).exp())
}

#[test]
fn what_fog_leaves_of_a_sky() {
    let matter = coloured(FOG, [0.0; 3], 0.0);
    let cube = [[-1.0; 3], [1.0; 3]];
    let truth = absorbed(FOG, 2.0);
    let wrong = [
        ("3 % more extinction", absorbed(FOG, 2.0 * 1.03)),
        ("8 % more extinction", absorbed(FOG, 2.0 * 1.08)),
    ];
    for (name, medium) in [
        ("a block before the sky", homogeneous("m", &matter)),
        (
            "a constant grid before the sky",
            uniform_grid("m", [5; 3], [[-2.0; 3], [2.0; 3]], |_| 1.0, &matter),
        ),
    ] {
        let world = sky(1.0) + &medium + &block("m", "", cube);
        let text = scene(
            &single_ray([0.3, 0.1, -4.0], [0.0, 0.0, 1.0]),
            [64, 64],
            &world,
        );
        Trial {
            by: &ALL,
            replicates: 96,
            resolution: 0.004,
            wrong: &wrong,
            ..Trial::new(name, &text, truth)
        }
        .run();
    }
}

#[test]
fn a_lamp_seen_through_fog_that_fills_space() {
    let camera = single_ray([0.0; 3], [0.0, 0.6, 0.8]);
    let fog = homogeneous("fog", &coloured(FOG, [0.0; 3], 0.0));
    let radiance = [2.0, 1.0, 0.5];
    // Five lengths down the ray, oblique to it.
    let shape = quad([0.0, 1.2, 1.6], [1.0, 0.0, 0.0], [0.0, -1.0, 0.0]);
    let text = scene(
        &in_fog(&fog, "fog", &camera),
        [64, 64],
        &lamp(radiance, &shape),
    );
    let truth = |by: f64| std::array::from_fn(|i| radiance[i] * (-FOG[i] * by).exp());
    Trial {
        by: &ALL,
        wrong: &[
            ("8 % more extinction", truth(2.0 * 1.08)),
            ("a cosine at the lamp", times(truth(2.0), 0.8)),
        ],
        ..Trial::new("a lamp in fog", &text, truth(2.0))
    }
    .run();
}

#[test]
fn a_wall_lit_by_a_point_through_fog() {
    let light = [0.8, -0.4, 1.0];
    let intensity = [5.0, 4.0, 3.0];
    let reflectance = [0.8, 0.5, 0.3];
    let direction = [0.6, 0.0, -0.8];
    let camera = ray_to([0.0; 3], direction, 1.0);
    let (r, sigma) = (length(light), FOG);
    let wall = made_of(&matte(reflectance), &level(0.0, 3.0, true));
    let fog = homogeneous("fog", &coloured(sigma, [0.0; 3], 0.0));
    let text = scene(
        &in_fog(&fog, "fog", &camera),
        [48, 48],
        &(wall + &point_light(light, intensity)),
    );
    let truth = |cos: f64, way: f64| {
        std::array::from_fn(|i| {
            reflectance[i] / PI * intensity[i] * cos / (r * r) * (-sigma[i] * way).exp()
        })
    };
    let cos = light[2] / r;
    Trial {
        by: &LIT,
        depth: Some(1),
        wrong: &[
            ("the cosine forgotten", truth(1.0, r + 1.0)),
            ("no fog before the light", truth(cos, 1.0)),
            ("10 % more extinction", truth(cos, (r + 1.0) * 1.1)),
        ],
        ..Trial::new("a point in fog over a wall", &text, truth(cos, r + 1.0))
    }
    .run();
}

/// Solid angle of a square of half edge `a`, seen from a height `h` over its middle.
fn square(a: f64, h: f64) -> f64 {
    4.0 * (a * a / (a * a + h * h)).asin()
}

#[test]
fn a_wide_wall_under_a_point() {
    // E dA = I dω: the mean over the film is I times the solid angle over the area.
    let camera = orthographic([0.0, 0.0, 4.0], [0.0, 0.0, -1.0], 1.5);
    let wall = made_of(&matte([0.6, 0.4, 0.2]), &level(0.0, 2.0, true));
    let text = scene(
        &camera,
        [32, 32],
        &(wall + &point_light([0.0, 0.0, 1.0], [3.0; 3])),
    );
    let mean = 3.0 * square(1.5, 1.0) / (9.0 * PI);
    let truth = [0.6, 0.4, 0.2].map(|rho| rho * mean);
    Trial {
        by: &LIT,
        depth: Some(1),
        resolution: 0.004,
        wrong: &[("5 % more light", times(truth, 1.05))],
        ..Trial::new("a point over a wide wall", &text, truth)
    }
    .run();
}

#[test]
fn a_wall_in_the_sun_by_every_camera() {
    let towards = [0.48, 0.36, 0.8];
    let strength = [2.0, 1.5, 1.0];
    let wall = made_of(&matte([0.5, 0.6, 0.7]), &level(0.0, 50.0, true));
    let world = wall + &sun(towards, strength);
    let truth = [0.5 * 2.0, 0.6 * 1.5, 0.7].map(|e| e * 0.8 / PI);
    let down = [0.3, 0.1, -1.0];
    let from = [0.0, 0.0, 2.0];
    let lens =
        perspective(from, down, 60.0) + " \"float lensradius\" 0.3 \"float focaldistance\" 1.5";
    for (name, camera) in [
        ("parallel", orthographic(from, down, 0.7)),
        ("pinhole", perspective(from, down, 60.0)),
        ("lens", lens),
    ] {
        Trial {
            by: &LIT,
            depth: Some(1),
            resolution: 0.0025,
            wrong: &[
                ("the cosine forgotten", times(truth, 1.0 / 0.8)),
                ("3 % more light", times(truth, 1.03)),
            ],
            ..Trial::new(name, &scene(&camera, [32, 32], &world), truth)
        }
        .run();
    }
}

#[test]
fn every_ray_in_a_closed_cavity() {
    // Walls that emit e and reflect rho: e / (1 − rho) on every ray, whatever white matter is within.
    for (i, cavity) in woodcock_tests::refs::furnace::load()
        .cavities
        .iter()
        .enumerate()
    {
        let (rho, e) = (cavity.rho_wall, cavity.emission);
        let light = format!("AreaLightSource \"diffuse\" \"rgb L\" {}\n", list(&[e; 3]));
        let shape = light + "ReverseOrientation\nShape \"sphere\" \"float radius\" 2";
        let world = made_of(&matte([rho; 3]), &shape)
            + &homogeneous("m", &grey(1.5, 1.0, 0.4))
            + &ball("m", "", [0.3, 0.0, 0.0], 1.0);
        let camera = perspective([-1.2, 0.1, 0.0], [1.0, 0.2, 0.1], 70.0);
        let text = scene(&camera, [12, 12], &world);
        let truth = [cavity.radiance; 3];
        // Long paths from both ends have many pairs of places; a chain begins with a thousand states.
        let (name, by, replicates) = [
            ("a dark cavity", &[Path, Bdpt, Mlt][..], 12),
            ("a bright cavity", &[Path, Bdpt], 24),
        ][i];
        Trial {
            by,
            replicates,
            wrong: &[
                ("walls that reflect nothing", [e; 3]),
                ("20 % more light", times(truth, 1.2)),
            ],
            ..Trial::new(name, &text, truth)
        }
        .run();
    }
}
