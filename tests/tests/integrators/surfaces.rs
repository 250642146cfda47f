//! Reference tables of media behind and around surfaces: slabs and balls of glass that scatter, a ball within a ball.
//!
//! A slab is a block of 1 × 400 × 400 that mirrors light within, also along it. Of what goes 100 lengths, half of the way
//! to its rim and back, e^−100 τ is left without having been scattered, nothing at τ ≥ 0.5; and light that scatters often
//! walks no further than a few thicknesses. Half of the environment is a square of half edge 10⁴ at a distance of 10.

use crate::closed_forms::measure::*;
use woodcock_tests::pictures::*;
use woodcock_tests::refs::scenes3d::{self, Inlay};
use woodcock_tests::refs::{slab_mismatched, surfaces};

const SLAB: [Xyz; 2] = [[-200.0, -200.0, 0.0], [200.0, 200.0, 1.0]];

/// Half-spaces are as thick as this: less than e^−25 comes back from beyond, at an albedo of 0.99 (decay 0.17 a depth,
/// both ways, and more at lower albedo).
const THICK: f64 = 80.0;

#[test]
fn slabs_of_glass_reflect_and_transmit() {
    for (i, row) in slab_mismatched::load().iter().enumerate() {
        let tau = row.tau.unwrap_or(THICK);
        let body = homogeneous("m", &grey(tau, row.albedo, row.g))
            + &within("m", "", &glass(row.n), &block_mesh(SLAB));
        let beam = row.beams[i % 2];
        let across = (1.0 - beam.mu0 * beam.mu0).sqrt();
        let camera = ray_to([0.0; 3], [across, 0.0, beam.mu0], 1.0);
        let near = lamp([1.0; 3], &level(-10.0, 1e4, true));
        let far = lamp([1.0; 3], &level(11.0, 1e4, false));
        let (r, t) = (beam.fluxes.reflectance, beam.fluxes.transmittance);
        let mut trials = vec![("R", near, r, ("the mirror image alone", beam.specular))];
        if row.tau.is_some() {
            trials.push(("T", far, t, ("light on the other side", r)));
            trials.push((
                "R + T",
                sky(1.0),
                r + t,
                ("radiance scaled by n²", (r + t) * row.n * row.n),
            ));
        }
        for (name, light, truth, (slip, mistaken)) in trials {
            // Long paths from both ends have many pairs of places: thin slabs will do.
            let by = [Path, Bdpt];
            let apart = (mistaken / truth - 1.0).abs() > 0.34;
            Trial {
                by: if tau <= 2.0 { &by } else { &by[..1] },
                replicates: if tau > 4.0 { 12 } else { 24 },
                resolution: 0.03,
                wrong: &[(slip, [mistaken; 3])][..usize::from(apart)],
                ..Trial::new(
                    &format!("slab {i} of glass, {name}"),
                    &scene(&camera, [32, 32], &(light + &body)),
                    [truth; 3],
                )
            }
            .run();
        }
    }
}

#[test]
fn balls_of_glass_and_balls_with_a_core() {
    for (i, case) in scenes3d::load_balls().iter().enumerate() {
        let medium = homogeneous("m", &grey(case.t, case.albedo, case.g));
        let sphere = |radius: f64| format!("Shape \"sphere\" \"float radius\" {radius}");
        let body = match case.inlay {
            Inlay::DielectricSphere { n } => within("m", "", &glass(n), &sphere(1.0)),
            // An opaque ball parts media or does not: nothing can tell.
            Inlay::CoreSphere { rc, rho } => {
                let outside = if i % 2 == 0 { "m" } else { "" };
                ball("m", "", [0.0; 3], 1.0) + &within("", outside, &matte([rho; 3]), &sphere(rc))
            }
        };
        let camera = single_ray([case.b, 0.0, -2.0], [0.0, 0.0, 1.0]);
        let text = scene(&camera, [32, 32], &(sky(1.0) + &medium + &body));
        let truth = [case.radiance; 3];
        Trial {
            by: &[Path, Bdpt, Mlt],
            truth_error: case.radiance_error / case.radiance,
            wrong: &[
                ("6 % brighter", times(truth, 1.06)),
                ("6 % darker", times(truth, 0.94)),
            ],
            resolution: 0.005,
            ..Trial::new(&format!("ball {i}"), &text, truth)
        }
        .run();
    }
}

#[test]
fn a_furnace_of_white_glass() {
    // Nothing absorbs: every ray has the radiance of its surroundings, whatever surface and matter it meets. Rough
    // glass loses light by design and is left out.
    let medium = homogeneous("m", &grey(3.0, 1.0, 0.6));
    let sphere = "Shape \"sphere\" \"float radius\" 1";
    for (name, body) in [
        (
            "white glass",
            medium.clone() + &within("m", "", &glass(1.5), sphere),
        ),
        ("clear glass", made_of(&glass(2.0), sphere)),
        (
            "a white core",
            medium
                + &ball("m", "", [0.0; 3], 1.0)
                + &made_of(&matte([1.0; 3]), "Shape \"sphere\" \"float radius\" 0.5"),
        ),
    ] {
        let camera = orthographic([0.1, 0.05, -3.0], [0.0, 0.0, 1.0], 1.3);
        Trial {
            by: &[Path, Bdpt, Mlt],
            resolution: 0.004,
            wrong: &[("a loss of 5 %", [0.95; 3]), ("a loss of 20 %", [0.8; 3])],
            ..Trial::new(
                name,
                &scene(&camera, [32, 32], &(sky(1.0) + &body)),
                [1.0; 3],
            )
        }
        .run();
    }
}

#[test]
fn uniform_light_on_a_face() {
    // A matte floor below a sheet of glass sees 1 − F for uniform light, as far as the sheet is concerned; light that it
    // sends up is cut off by the depth: face and floor.
    for row in surfaces::load()
        .diffuse_average
        .iter()
        .filter(|r| r.n < 1.6)
    {
        let face = made_of(&glass(row.n), &level(1.0, 1e4, true));
        let floor = made_of(&matte([0.8; 3]), &level(0.0, 0.5, true));
        let under = made_of(&black(), &level(-0.1, 1e4, true));
        let camera = ray_to([0.0; 3], [-0.8, 0.0, -0.6], 0.5);
        let text = scene(&camera, [32, 32], &(sky(1.0) + &face + &floor + &under));
        // Within, radiance is n² times what came, in a cone of all that comes: (1 − F_external) π / n² · n².
        let inside = (1.0 - row.external) * 0.8;
        Trial {
            by: &[Path, Bdpt],
            depth: Some(2),
            wrong: &[(
                "radiance that refraction does not change",
                [inside / (row.n * row.n); 3],
            )],
            ..Trial::new(&format!("under a face of {}", row.n), &text, [inside; 3])
        }
        .run();
    }
}
