//! Points and directions: exact, sample by sample.

use super::*;

const NOWHERE: [f64; 3] = [0.5; 3];

fn only(lights: &Lights, surfaces: &Surfaces, from: DVec3) -> Option<LightSample> {
    let sample = lights.sample(surfaces, from, DVec3::ZERO, NOWHERE)?;
    assert_eq!((sample.light, sample.choice, sample.pdf), (0, 1.0, 1.0));
    assert!(sample.delta);
    Some(sample)
}

fn close(a: f64, b: f64) -> bool {
    (a - b).abs() <= 1e-12 * b.abs()
}

#[test]
fn a_point_shines_by_the_inverse_square() {
    let setting = Setting::new([point(DVec3::new(1.0, 2.0, 3.0), [4.0, 8.0, 0.0])]);
    let (lights, surfaces) = (setting.lights(), setting.surfaces());
    let from = DVec3::new(1.0, 2.0, 1.0);
    let sample = only(&lights, &surfaces, from).expect("lit");
    assert_eq!(sample.direction, DVec3::Z);
    assert_eq!(sample.radiance, [1.0, 2.0, 0.0]);
    let anchor = sample.anchor.expect("a place");
    assert!((anchor.point - DVec3::new(1.0, 2.0, 3.0)).length() < 1e-12);
    assert_eq!((anchor.normal, anchor.error), (DVec3::ZERO, 0.0));
    // On the light itself there is no direction to it, and nothing breaks.
    assert!(only(&lights, &surfaces, anchor.point).is_none());
    assert!(lights.escape_radiance(DVec3::Z) == [0.0; 3] && lights.escapes(DVec3::Z).count() == 0);
}

#[test]
fn a_distant_light_is_the_same_everywhere_and_the_film_scales_it() {
    let towards = DVec3::new(1.0, 2.0, -2.0);
    let mut setting = Setting::new([distant(towards, [3.0, 1.0, 0.5])]);
    setting.scene.film.imaging_ratio = 0.5;
    let (lights, surfaces) = (setting.lights(), setting.surfaces());
    for from in [DVec3::ZERO, DVec3::new(3.0, -2.0, 1.0)] {
        let sample = only(&lights, &surfaces, from).expect("lit");
        assert_eq!(sample.radiance, [1.5, 0.5, 0.25]);
        assert_eq!(sample.direction, towards.normalize());
        assert!(sample.anchor.is_none());
    }
    // Nothing but sampling finds it.
    assert_eq!(lights.escape_radiance(towards.normalize()), [0.0; 3]);
}

#[test]
fn a_spot_has_pbrts_edge() {
    let axis = DVec3::new(0.0, -1.0, 0.0);
    let setting = Setting::new([spot(DVec3::ZERO, axis, [0.9, 0.5], [9.0; 3])]);
    let (lights, surfaces) = (setting.lights(), setting.surfaces());
    let at = |cos: f64| DVec3::new((1.0_f64 - cos * cos).sqrt(), -cos, 0.0) * 3.0;
    let seen = |cos: f64| only(&lights, &surfaces, at(cos)).map_or(0.0, |s| s.radiance[1]);
    assert!(close(seen(1.0), 1.0) && close(seen(0.901), 1.0));
    assert!(close(seen(0.7), 0.5));
    // 3/16 − 2/64 at a quarter, and its complement at three.
    assert!(close(seen(0.6), 10.0 / 64.0) && close(seen(0.8), 54.0 / 64.0));
    assert!(seen(0.499) == 0.0 && seen(-1.0) == 0.0);
}

#[test]
fn what_a_spot_sends_in_all_directions_is_its_closed_form() {
    for [full, dark] in [[0.9, 0.5], [0.3, -0.8], [0.6, 0.6]] {
        let setting = Setting::new([spot(DVec3::ZERO, DVec3::Z, [full, dark], [2.0; 3])]);
        let (lights, surfaces) = (setting.lights(), setting.surfaces());
        let n = 20_000;
        let mut sum = 0.0;
        for i in 0..n {
            let away = sphere([(f64::from(i) + 0.5) / f64::from(n), 0.3]);
            sum += only(&lights, &surfaces, away * 2.0).map_or(0.0, |s| 4.0 * s.radiance[2]);
        }
        let power = sum / f64::from(n) * 4.0 * PI;
        // 2π I ((1 − c₀) + (c₀ − c₁) / 2).
        let expected = 2.0 * PI * 2.0 * ((1.0 - full) + 0.5 * (full - dark));
        assert!((power / expected - 1.0).abs() < 2e-4, "{power} {expected}");
    }
}

#[test]
fn a_goniometric_light_follows_its_picture_and_its_power() {
    // A quadrant of the octahedron's upper half: x, y and z positive, where the picture's lower right quarter is.
    let n = 64;
    let quarter = |x: u32, y: u32| {
        let (u, v) = (
            (f64::from(x) + 0.5) / 32.0 - 1.0,
            (f64::from(y) + 0.5) / 32.0 - 1.0,
        );
        if u > 0.0 && v > 0.0 { 2.0 } else { 0.0 }
    };
    let transform = turned();
    for power in [None, Some(7.0)] {
        let setting = Setting::new([goniometric("lamp.exr", transform, power)])
            .file("lamp.exr", picture([n, n], quarter));
        let (lights, surfaces) = (setting.lights(), setting.surfaces());
        let position = transform.translation;
        let steps = 200;
        let (mut sum, mut lit) = (0.0, 0);
        for i in 0..steps * steps {
            let u = [i / steps, i % steps].map(|i| (f64::from(i) + 0.5) / f64::from(steps));
            let local = sphere(u);
            let world = transform.transform_vector3(local) / 2.0;
            let sample = only(&lights, &surfaces, position + world * 3.0);
            // The quarter of the square holds the octants of positive x and y, above and below.
            assert_eq!(sample.is_some(), local.x > 0.0 && local.y > 0.0, "{local}");
            if let Some(sample) = sample {
                assert!(close(sample.radiance[2], 3.0 * sample.radiance[0]));
                sum += 9.0 * sample.radiance[0];
                lit += 1;
            }
        }
        let got = sum / f64::from(steps * steps) * 4.0 * PI;
        // A quarter of the sphere at twice the tint; or, by the share of one colour, the power itself.
        let expected = power.unwrap_or(PI * 2.0 * TINT);
        assert!(
            lit > 0 && (got / expected - 1.0).abs() < 1e-6,
            "{got} {expected}"
        );
    }
}
