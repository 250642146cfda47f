//! Lights of all kinds: pbrt's scalings, and where they are in the world.

use std::f64::consts::PI;
use std::path::Path;

use glam::DVec3;
use woodcock_host::scene::{Light, Shape};

use super::{near, world, world_with};

#[test]
fn lights_shine_from_from_to_to() {
    let scene = world(
        r#"AttributeBegin Rotate 90 0 0 1
        LightSource "distant" "point3 from" [5 0 0] "point3 to" [2 0 0] "rgb L" [1 2 3] "float scale" 2
        AttributeEnd
        LightSource "distant" "float illuminance" 10
        LightSource "infinite" "rgb L" [.5 .25 1] "float scale" 4
        LightSource "infinite" "float illuminance" 3.14159265358979
        LightSource "infinite" "spectrum L" "stdillum-D65" "float scale" 3
        LightSource "infinite" "blackbody L" 6504"#,
    );
    let Light::Distant(sun) = &scene.lights[0] else {
        panic!("distant");
    };
    assert!(near(sun.direction_to_light, [0.0, 1.0, 0.0]));
    assert_eq!(sun.irradiance, [2.0, 4.0, 6.0]);
    let Light::Distant(plain) = &scene.lights[1] else {
        panic!("distant");
    };
    assert_eq!(
        plain.direction_to_light,
        DVec3::NEG_Z,
        "from the origin to +z"
    );
    assert_eq!(plain.irradiance, [10.0; 3]);
    let radiance = |i: usize| match &scene.lights[i] {
        Light::Constant(light) => light.radiance,
        other => panic!("not constant: {other:?}"),
    };
    assert_eq!(radiance(2), [2.0, 1.0, 4.0]);
    assert!(radiance(3).iter().all(|c| (c - 1.0).abs() < 1e-9));
    assert_eq!(radiance(4), [3.0; 3]);
    assert!(radiance(5).iter().all(|c| (c - 1.0).abs() < 0.1));
    assert_eq!(scene.warnings.len(), 1, "the black body is projected");
}

#[test]
fn points_have_intensity_or_power() {
    let scene = world(
        r#"Translate 1 2 3 LightSource "point" LightSource "point" "rgb I" [1 2 3] "float scale" 2 "point3 from" [1 0 0]
        LightSource "point" "float power" 100 "rgb I" [1 .5 0] "float scale" 3
        LightSource "point" "spectrum I" [400 7 700 7] "float power" -1"#,
    );
    let point = |i: usize| match &scene.lights[i] {
        Light::Point(light) => (light.position, light.intensity),
        other => panic!("{other:?}"),
    };
    assert_eq!(point(0), (DVec3::new(1.0, 2.0, 3.0), [1.0; 3]));
    assert_eq!(point(1), (DVec3::new(2.0, 2.0, 3.0), [2.0, 4.0, 6.0]));
    // Over the sphere the intensity of the first channel sums to three times the power.
    let (_, [r, g, b]) = point(2);
    assert!((4.0 * PI * r - 300.0).abs() < 1e-9 && (g - r / 2.0).abs() < 1e-12 && b == 0.0);
    // A spectrum is brought to luminance one, whatever its level.
    let (_, [r, g, b]) = point(3);
    assert!((0.2126729 * r + 0.7151522 * g + 0.0721750 * b - 1.0).abs() < 1e-5);
}

#[test]
fn spots_have_cones() {
    let scene = world(
        r#"LightSource "spot" Rotate 90 0 1 0 Translate 0 0 1
        LightSource "spot" "point3 from" [0 1 0] "point3 to" [0 1 5] "float coneangle" 60 "float conedeltaangle" 15
            "float power" 10"#,
    );
    let Light::Spot(plain) = &scene.lights[0] else {
        panic!("spot")
    };
    assert_eq!((plain.position, plain.axis), (DVec3::ZERO, DVec3::Z));
    assert_eq!(plain.intensity, [1.0; 3]);
    assert!((plain.cos_total_width - 30.0_f64.to_radians().cos()).abs() < 1e-15);
    assert!((plain.cos_falloff_start - 25.0_f64.to_radians().cos()).abs() < 1e-15);
    let Light::Spot(spot) = &scene.lights[1] else {
        panic!("spot")
    };
    assert!(near(spot.position, [1.0, 1.0, 0.0]) && near(spot.axis, [1.0, 0.0, 0.0]));
    // The power by quadrature over the cosine (midpoints): full intensity, then the smoothstep.
    let (start, end) = (spot.cos_falloff_start, spot.cos_total_width);
    let steps = 100_000;
    let width = (1.0 - end) / f64::from(steps);
    let power: f64 = (0..steps)
        .map(|i| {
            let cosine = end + (f64::from(i) + 0.5) * width;
            let x = ((cosine - end) / (start - end)).min(1.0);
            2.0 * PI * width * spot.intensity[0] * x * x * (3.0 - 2.0 * x)
        })
        .sum();
    assert!((power - 10.0).abs() < 1e-6, "{power}");
}

#[test]
fn pictures_shine() {
    let scene = world_with(
        &["sky.exr", "lamp.exr"],
        r#"LightSource "infinite" "string filename" "sky.exr" "float scale" 3 "float illuminance" 7
        Translate 1 2 3 LightSource "goniometric" "string filename" "lamp.exr" "rgb I" [1 2 3] "float scale" 2
            "float power" 5"#,
    );
    let Light::Image(sky) = &scene.lights[0] else {
        panic!("sky")
    };
    assert_eq!(sky.filename, Path::new("sky.exr"));
    assert_eq!((sky.scale, sky.illuminance), (3.0, Some(7.0)));
    let Light::Goniometric(lamp) = &scene.lights[1] else {
        panic!("lamp")
    };
    assert_eq!((lamp.intensity, lamp.power), ([2.0, 4.0, 6.0], Some(5.0)));
    assert_eq!(lamp.light_to_world.translation, DVec3::new(1.0, 2.0, 3.0));
    // As in pbrt, the picture's z is the lamp's y.
    assert_eq!(lamp.light_to_world.transform_vector3(DVec3::Z), DVec3::Y);
}

#[test]
fn shapes_shine_with_radiance_or_power() {
    let scene = world(
        r#"AttributeBegin AreaLightSource "diffuse" "rgb L" [1 2 3] "float scale" 2 "bool twosided" true
        Shape "sphere" AttributeEnd Shape "sphere" AreaLightSource "diffuse" "float power" 10 Scale 2 2 2
        Shape "sphere" "float radius" 3 Shape "disk" "float radius" 2 "float innerradius" 1
        Shape "trianglemesh" "point3 P" [0 0 0 1 0 0 0 1 0 1 1 0] "integer indices" [0 1 2 1 3 2]
        Shape "bilinearmesh" "point3 P" [0 0 0 1 0 0 0 1 0 1 1 0]
        AreaLightSource "diffuse" "float power" 10 "bool twosided" true "rgb L" [1 0 0]
        Scale 1 1 3 Shape "disk""#,
    );
    let emission = |i: usize| scene.surfaces[i].emission;
    let first = emission(0).expect("light");
    assert_eq!((first.radiance, first.two_sided), ([2.0, 4.0, 6.0], true));
    assert!(emission(1).is_none());
    // Lambert: the power is π times area times radiance, in the world.
    let areas = [
        4.0 * PI * 36.0,
        PI * (4.0 - 1.0) * 4.0,
        4.0,
        4.0,
        2.0 * PI * 4.0,
    ];
    for (i, area) in areas.into_iter().enumerate() {
        let radiance = emission(i + 2).expect("light").radiance;
        assert!((PI * area * radiance[0] - 10.0).abs() < 1e-9, "{i}");
    }
    assert_eq!(emission(6).expect("light").radiance[1], 0.0);
    assert!(matches!(scene.surfaces[6].shape, Shape::Disk(_)));
    assert_eq!(
        scene.warnings.len(),
        1,
        "pbrt gives each triangle the power"
    );
}

#[test]
fn bent_patches_have_their_area() {
    // z = u v over the unit square: ∫∫ √(1 + u² + v²) du dv, here by midpoints.
    let scene = world(
        r#"AreaLightSource "diffuse" "float power" 1 Shape "bilinearmesh" "point3 P" [0 0 0 1 0 0 0 1 0 1 1 1]"#,
    );
    let steps = 1000;
    let at = |i: i32| (f64::from(i) + 0.5) / f64::from(steps);
    let area: f64 = (0..steps * steps)
        .map(|i| (1.0 + at(i % steps).powi(2) + at(i / steps).powi(2)).sqrt())
        .sum::<f64>()
        / f64::from(steps * steps);
    let radiance = scene.surfaces[0].emission.expect("light").radiance[0];
    assert!((PI * area * radiance - 1.0).abs() < 1e-6);
}
