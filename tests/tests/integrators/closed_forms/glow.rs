//! Media that shine and absorb: L = Lₑ (1 − e^−τ), and what they do to a floor.

use super::measure::*;
use super::{ALL, LIT, PI};
use woodcock_tests::pictures::*;

const SIGMA: Xyz = [0.3, 0.6, 1.2];
const GLOW: Xyz = [3.0, 2.0, 1.0];

fn shining(sigma: Xyz, more: &str) -> Matter {
    Matter {
        more: format!("\"rgb Le\" {} {more}", list(&GLOW)),
        ..coloured(sigma, [0.0; 3], 0.0)
    }
}

fn glow(depth: f64) -> Xyz {
    std::array::from_fn(|i| GLOW[i] * -(-SIGMA[i] * depth).exp_m1())
}

#[test]
fn rays_through_matter_that_shines() {
    let block = block("m", "", [[-1.0; 3], [1.0; 3]]);
    let matter = shining(SIGMA, "");
    // Density 1 + z/2 within the block: a mean of one.
    let rising = |[_, _, z]: Xyz| 1.0 + 0.5 * z;
    for (name, medium) in [
        ("a shining block", homogeneous("m", &matter)),
        (
            "a shining grid",
            uniform_grid("m", [7; 3], [[-1.5; 3], [1.5; 3]], rising, &matter),
        ),
    ] {
        let world = medium + &block;
        let text = scene(
            &single_ray([0.2, 0.3, -3.0], [0.0, 0.0, 1.0]),
            [32, 32],
            &world,
        );
        Trial {
            by: &ALL,
            wrong: &[
                (
                    "emission not absorbed",
                    std::array::from_fn(|i| 2.0 * GLOW[i] * SIGMA[i]),
                ),
                ("25 % more matter", glow(2.0 * 1.25)),
            ],
            ..Trial::new(name, &text, glow(2.0))
        }
        .run();
    }
}

#[test]
fn a_grid_whose_glow_rises_along_the_ray() {
    // Scale 1 + z / 2 on the ray through the middle, density 1: ∫ σ e^−σt (1 + (t − 1) / 2) dt over [0, 2].
    let cells = [1, 1, 6];
    let scales: Vec<_> = (0..6)
        .map(|k| 1.0 + 0.5 * (-1.25 + 0.5 * f64::from(k)))
        .collect();
    let more = format!("\"float Lescale\" {}", list(&scales));
    let matter = shining(SIGMA, &more);
    let world = uniform_grid("m", cells, [[-1.5; 3], [1.5; 3]], |_| 1.0, &matter)
        + &block("m", "", [[-1.0; 3], [1.0; 3]]);
    let text = scene(
        &single_ray([0.0, 0.0, -3.0], [0.0, 0.0, 1.0]),
        [32, 32],
        &world,
    );
    let truth = std::array::from_fn(|i| {
        let (sigma, lost) = (SIGMA[i], (-2.0 * SIGMA[i]).exp());
        // ∫ t σ e^−σt = (1 − e^−2σ (1 + 2σ)) / σ.
        let first = (1.0 - lost * (1.0 + 2.0 * sigma)) / sigma;
        GLOW[i] * (0.5 * (1.0 - lost) + 0.5 * first)
    });
    Trial {
        by: &ALL,
        wrong: &[("glow of the mean", glow(2.0))],
        ..Trial::new("a rising glow", &text, truth)
    }
    .run();
}

#[test]
fn a_floor_lit_by_a_ball_of_fire() {
    // Radiance Lₑ (1 − e^−2σ√(R² − b²)) within the cone of the ball, b = d sin α:
    // E = 2π Lₑ cos θ / d² (R² / 2 − (1 − (1 + x) e^−x) / 4σ²), x = 2σR.
    let (d, radius, cos) = (2.5, 1.0, 0.8);
    let reflectance = 0.7;
    let irradiance = |scale: f64| {
        std::array::from_fn(|i| {
            let sigma = SIGMA[i] * scale;
            let x = 2.0 * sigma * radius;
            let dark = (1.0 - (1.0 + x) * (-x).exp()) / (4.0 * sigma * sigma);
            let bright = radius * radius / 2.0 - dark;
            reflectance / PI * 2.0 * PI * GLOW[i] * cos / (d * d) * bright
        })
    };
    let ball = ball("m", "", [0.0, 0.6 * d, cos * d], radius);
    let floor = made_of(&matte([reflectance; 3]), &level(0.0, 0.5, true));
    let camera = ray_to([0.0; 3], [-0.98, 0.0, -0.198_997_487], 3.0);
    let matter = shining(SIGMA, "");
    for (name, medium) in [
        ("a ball of fire", homogeneous("m", &matter)),
        (
            "a ball of fire in a grid",
            uniform_grid(
                "m",
                [3; 3],
                [[-3.0, -1.5, -1.0], [3.0, 4.5, 5.0]],
                |_| 1.0,
                &matter,
            ),
        ),
    ] {
        let text = scene(&camera, [32, 32], &(medium + &ball + &floor));
        let truth = irradiance(1.0);
        Trial {
            by: &LIT,
            depth: Some(1),
            replicates: 256,
            wrong: &[
                ("the cosine forgotten", times(truth, 1.0 / cos)),
                ("40 % more matter", irradiance(1.4)),
            ],
            ..Trial::new(name, &text, truth)
        }
        .run();
    }
}
