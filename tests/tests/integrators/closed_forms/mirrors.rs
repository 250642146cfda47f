//! Smooth surfaces: Fresnel's reflectances, plates, and light that only paths from the lamp can find.

use super::PI;
use super::measure::*;
use woodcock_tests::pictures::*;
use woodcock_tests::refs::surfaces::{self, Plate};

fn direction(cos: f64) -> Xyz {
    [(1.0 - cos * cos).sqrt(), 0.0, cos]
}

/// Reflectance after Schlick, near Fresnel's and not the same.
fn schlick(head_on: f64, cos: f64) -> f64 {
    head_on + (1.0 - head_on) * (1.0 - cos).powi(5)
}

#[test]
fn glass_reflects_as_fresnel_says() {
    // Light that passes ends on black; from either side of the surface.
    for (i, row) in surfaces::load().dielectric.iter().enumerate() {
        for from_below in [false, true] {
            let eta = if from_below {
                row.n1 / row.n2
            } else {
                row.n2 / row.n1
            };
            let side = if from_below { 1.0 } else { -1.0 };
            let towards = direction(row.cos_i).map(|x| side * x);
            let world = sky(1.0)
                + &made_of(&glass(eta), &level(0.0, 5.0, true))
                + &made_of(&black(), &level(side * 0.5, 1e4, !from_below));
            let text = scene(&ray_to([0.0; 3], towards, 2.0), [32, 32], &world);
            let truth = [row.reflectance; 3];
            let head_on = ((row.n1 - row.n2) / (row.n1 + row.n2)).powi(2);
            let guess = schlick(head_on, row.cos_i);
            let mut wrong = Vec::new();
            if (guess / row.reflectance - 1.0).abs() > 0.3 {
                wrong.push(("Schlick's approximation", [guess; 3]));
            }
            if row.reflectance < 0.5 {
                wrong.push(("only one polarisation", [row.perpendicular * 1.5; 3]));
            }
            Trial {
                by: if i % 4 == 0 {
                    &[Path, Bdpt, Mlt]
                } else {
                    &[Path, Bdpt]
                },
                resolution: 0.03,
                wrong: &wrong,
                ..Trial::new(&format!("glass {i}, below {from_below}"), &text, truth)
            }
            .run();
        }
    }
}

#[test]
fn metals_reflect_as_fresnel_says() {
    // Two metals, one for red and one for the others: colours are apart.
    let rows = surfaces::load().conductor;
    for row in &rows[..3] {
        let other = rows[3..].iter().find(|r| r.cos_i == row.cos_i);
        let other = other.expect("the same angle for both metals");
        let metal = format!(
            "\"conductor\" \"rgb eta\" {} \"rgb k\" {}",
            list(&[row.eta, other.eta, other.eta]),
            list(&[row.k, other.k, other.k])
        );
        let world = sky(1.0) + &made_of(&metal, &level(0.0, 5.0, true));
        let towards = direction(row.cos_i).map(|x| -x);
        let text = scene(&ray_to([0.0; 3], towards, 2.0), [8, 8], &world);
        Trial {
            by: &[Path, Bdpt, Mlt],
            resolution: 1e-3,
            wrong: &[
                (
                    "the metals exchanged",
                    [other.reflectance, row.reflectance, row.reflectance],
                ),
                ("only one polarisation", [row.perpendicular, 1.0, 1.0]),
            ][..if row.cos_i == 1.0 { 1 } else { 2 }],
            ..Trial::new(
                &format!("metals at {}", row.cos_i),
                &text,
                [row.reflectance, other.reflectance, other.reflectance],
            )
        }
        .run();
    }
}

/// Light on the camera's side, below the plate, or on the other.
const NEAR: f64 = -10.0;
const FAR: f64 = 12.0;

fn uniform(z: f64) -> String {
    lamp([1.0; 3], &level(z, 1e4, z < 0.0))
}

fn plate(row: &Plate, z: [f64; 2], half: f64) -> String {
    let medium = homogeneous("m", &grey(row.tau / (z[1] - z[0]), 0.0, 0.0));
    let shape = block_mesh([[-half, -half, z[0]], [half, half, z[1]]]);
    if row.tau == 0.0 {
        made_of(&glass(row.n), &shape)
    } else {
        medium + &within("m", "", &glass(row.n), &shape)
    }
}

/// Reflectance of a face and cosine within.
fn face(row: &Plate) -> (f64, f64) {
    let inner = (1.0 - (1.0 - row.mu0 * row.mu0) / (row.n * row.n)).sqrt();
    let across = (row.mu0 - row.n * inner) / (row.mu0 + row.n * inner);
    let along = (row.n * row.mu0 - inner) / (row.n * row.mu0 + inner);
    (0.5 * (across * across + along * along), inner)
}

#[test]
fn plates_that_absorb() {
    for (i, row) in surfaces::load().plate.iter().enumerate() {
        let (reflected, inner) = face(row);
        let camera = ray_to([0.0; 3], direction(row.mu0), 1.0);
        let body = plate(row, [0.0, 1.0], 50.0);
        let both = row.reflectance + row.transmittance;
        let bare = (-row.tau / inner).exp();
        let straight = (1.0 - reflected).powi(2) * (-row.tau / row.mu0).exp();
        for (name, light, truth, mistaken) in [
            ("R", uniform(NEAR), row.reflectance, 0.5 * row.reflectance),
            ("T", uniform(FAR), row.transmittance, bare),
            ("R + T", sky(1.0), both, 1.0),
        ] {
            let mut wrong = Vec::new();
            if (mistaken / truth - 1.0).abs() > if name == "R" { 0.44 } else { 0.055 } {
                wrong.push(("faces that do not reflect", [mistaken; 3]));
            }
            if name == "T" && row.mu0 < 1.0 {
                wrong.push(("a ray that is not refracted", [straight; 3]));
            }
            Trial {
                by: &[Path, Bdpt, Mlt],
                resolution: if name == "R" { 0.04 } else { 0.005 },
                wrong: &wrong,
                ..Trial::new(
                    &format!("plate {i}, {name}"),
                    &scene(&camera, [32, 32], &(light + &body)),
                    [truth; 3],
                )
            }
            .run();
        }
    }
}

#[test]
fn a_thin_sheet_is_a_plate_without_thickness() {
    let row = surfaces::load().plate[0];
    assert_eq!(row.tau, 0.0);
    let sheet = made_of(
        "\"thindielectric\" \"float eta\" 1.5",
        &level(0.0, 5.0, true),
    );
    for (name, light, truth) in [
        ("sheet, R", uniform(NEAR), row.reflectance),
        ("sheet, T", uniform(FAR), row.transmittance),
    ] {
        let text = scene(
            &ray_to([0.0; 3], direction(1.0), 1.0),
            [32, 32],
            &(light + &sheet),
        );
        let (one_face, _) = face(&row);
        let mistaken = if name == "sheet, R" { one_face } else { 1.0 };
        Trial {
            by: &[Path, Bdpt, Mlt],
            resolution: 0.03,
            wrong: &[("one face", [mistaken; 3])][..usize::from(name == "sheet, R")],
            ..Trial::new(name, &text, [truth; 3])
        }
        .run();
    }
}

#[test]
fn sunlight_through_a_pane() {
    // Only paths from the sun pass two smooth faces to the floor; depth 4 leaves out all further reflections, so that
    // the floor gets E cos θ (1 − F)² e^(−τ / cos θ').
    let row = surfaces::load().plate[2];
    let (reflected, inner) = face(&row);
    let pane = plate(&row, [0.3, 0.5], 2.0);
    let floor = made_of(&matte([0.6; 3]), &level(0.0, 0.5, true));
    let towards = direction(row.mu0);
    let camera = orthographic([0.0, 0.0, 0.25], [0.0, 0.0, -1.0], 0.5);
    let text = scene(
        &camera,
        [64, 64],
        &(floor + &pane + &sun(towards, [4.0; 3])),
    );
    let bare = 0.6 / PI * 4.0;
    let truth = bare * row.mu0 * (1.0 - reflected).powi(2) * (-row.tau / inner).exp();
    Trial {
        by: &[Bdpt, Mlt],
        depth: Some(4),
        replicates: 96,
        resolution: 0.015,
        wrong: &[
            ("the cosine forgotten", [truth / row.mu0; 3]),
            ("the pane forgotten", [bare * row.mu0; 3]),
            ("radiance scaled by n²", [truth * row.n * row.n; 3]),
        ],
        ..Trial::new("sun through a pane", &text, [truth; 3])
    }
    .run();
}
