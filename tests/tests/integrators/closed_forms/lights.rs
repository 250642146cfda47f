//! Irradiance of each kind of light, seen by the reflection of a matte floor.

use super::measure::*;
use super::{LIT, PI};
use woodcock_tests::pictures::*;
use woodcock_tests::refs::surfaces::{self, Emitter};

const FLOOR: Xyz = [0.8, 0.5, 0.3];

fn floor() -> String {
    made_of(&matte(FLOOR), &level(0.0, 0.5, true))
}

fn reflected(irradiance: f64) -> Xyz {
    FLOOR.map(|rho| rho * irradiance / PI)
}

#[test]
fn the_profile_of_a_spot() {
    let (height, cone, soft) = (3.0, 40.0_f64, 15.0);
    let [full, dark] = [cone - soft, cone].map(|angle: f64| angle.to_radians().cos());
    for (name, angle) in [
        ("in the cone", 10.0_f64),
        ("in its edge", 28.0),
        ("near its end", 37.0),
    ] {
        let cos = angle.to_radians().cos();
        let x = height * angle.to_radians().tan();
        let place = quad([x, 0.0, 0.0], [0.5, 0.0, 0.0], [0.0, 0.5, 0.0]);
        let world = made_of(&matte(FLOOR), &place)
            + "LightSource \"spot\" \"point3 from\" [ 0 0 3 ] \"point3 to\" [ 0 0 0 ] \
               \"float coneangle\" 40 \"float conedeltaangle\" 15 \"rgb I\" [ 9 9 9 ]\n";
        let text = scene(
            &ray_to([x, 0.0, 0.0], [0.6, 0.0, -0.8], 2.0),
            [16, 16],
            &world,
        );
        // What an edge of another shape, or of angles in place of cosines, would give.
        let share = ((cos - dark) / (full - dark)).clamp(0.0, 1.0);
        let by_angle = ((cone - angle) / soft).min(1.0);
        let smooth = |x: f64| x * x * (3.0 - 2.0 * x);
        let light = |profile: f64| reflected(9.0 * profile * cos.powi(3) / (height * height));
        let truth = light(smooth(share));
        let mut wrong = vec![("the cosine forgotten", times(truth, 1.0 / cos.powi(2)))];
        if share < 1.0 {
            wrong.push(("a linear edge", light(share)));
            wrong.push(("an edge by angle", light(smooth(by_angle))));
        }
        Trial {
            by: &LIT,
            depth: Some(1),
            resolution: 1e-3,
            wrong: &wrong,
            ..Trial::new(name, &text, truth)
        }
        .run();
    }
}

#[test]
fn lamps_over_a_floor() {
    for row in surfaces::load().irradiance {
        let (name, shape, without_cosine) = match row.emitter {
            Emitter::Sphere {
                radius,
                distance,
                angle_deg,
            } => {
                let (sin, cos) = angle_deg.to_radians().sin_cos();
                let shape = format!(
                    "Translate 0 {} {}\nShape \"sphere\" \"float radius\" {radius}",
                    distance * sin,
                    distance * cos
                );
                ("a ball", shape, row.irradiance / cos)
            }
            Emitter::Disk { radius, height } => {
                let shape = format!(
                    "ReverseOrientation\nShape \"disk\" \"float radius\" {radius} \"float height\" {height}"
                );
                let omega = 2.0 * PI * (1.0 - height / radius.hypot(height));
                ("a disk", shape, omega)
            }
            Emitter::Rectangle {
                extent: [x0, x1, y0, y1, h],
            } => {
                let shape = quad(
                    [0.5 * (x0 + x1), 0.5 * (y0 + y1), h],
                    [0.5 * (x0 - x1), 0.0, 0.0],
                    [0.0, 0.5 * (y1 - y0), 0.0],
                );
                // Corner by corner, all four around the foot.
                let corner = |a: f64, b: f64| (a * b / (h * (a * a + b * b + h * h).sqrt())).atan();
                let omega = corner(x1, y1) + corner(-x0, y1) + corner(x1, -y0) + corner(-x0, -y0);
                ("a rectangle", shape, omega)
            }
        };
        let world = floor() + &lamp([1.0; 3], &shape);
        // Below the lamps.
        let text = scene(
            &ray_to([0.0; 3], [-0.98, 0.0, -0.198_997_487], 3.0),
            [32, 32],
            &world,
        );
        let truth = reflected(row.irradiance);
        Trial {
            by: &LIT,
            depth: Some(1),
            replicates: 128,
            resolution: 0.004,
            wrong: &[
                ("the cosine forgotten", reflected(without_cosine)),
                ("5 % more light", times(truth, 1.05)),
            ],
            ..Trial::new(name, &text, truth)
        }
        .run();
    }
}

#[test]
fn a_floor_under_skies() {
    // A whole sky gives π; the cone of a ball around the zenith is what a black ball takes away: π (R / d)².
    let open = floor() + &sky(1.0);
    let covered = open.clone()
        + &made_of(
            &black(),
            "Translate 0 0 2\nShape \"sphere\" \"float radius\" 1",
        );
    let camera = ray_to([0.0; 3], [-0.98, 0.0, -0.198_997_487], 3.0);
    for (name, world, irradiance) in [
        ("an open sky", open, PI),
        ("a covered sky", covered, PI * (1.0 - 0.25)),
    ] {
        let truth = reflected(irradiance);
        Trial {
            by: &LIT,
            depth: Some(1),
            replicates: 96,
            resolution: 0.003,
            wrong: &[("4 % more light", times(truth, 1.04))],
            ..Trial::new(name, &scene(&camera, [32, 32], &world), truth)
        }
        .run();
    }
}
