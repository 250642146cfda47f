//! What cannot be a light is refused at its place.

use super::*;

fn refused(setting: &Setting) -> String {
    let error = setting.try_lights().expect_err("refused");
    assert!(error.place().is_some(), "{error}");
    error.to_string()
}

fn sky_of(bytes: Vec<u8>) -> Setting {
    Setting::new([image("sky.exr", DAffine3::IDENTITY)]).file("sky.exr", bytes)
}

#[test]
fn pictures_that_are_no_maps_are_refused() {
    let message = refused(&sky_of(picture([6, 4], |_, _| 1.0)));
    assert!(message.contains("sky.exr has 6 × 4 pixels"), "{message}");
    let message = refused(&sky_of(picture([4, 2], |x, _| 1.0 - f64::from(x))));
    assert!(message.contains("pixel (2, 0)"), "{message}");
    let message = refused(&sky_of(b"no picture".to_vec()));
    assert!(message.contains("sky.exr is neither"), "{message}");
    let message = refused(&Setting::new([image("gone.exr", DAffine3::IDENTITY)]));
    assert!(message.contains("gone.exr cannot be read"), "{message}");
    let lamp = Setting::new([goniometric("lamp.exr", DAffine3::IDENTITY, None)]);
    let message = refused(&lamp.file("lamp.exr", picture([4, 2], |_, _| 1.0)));
    assert!(message.contains("square"), "{message}");
}

#[test]
fn what_no_factor_can_scale_is_refused() {
    // Light from below only.
    let mut light = image("sky.exr", DAffine3::IDENTITY);
    if let Light::Image(light) = &mut light {
        light.illuminance = Some(1.0);
    }
    let below = picture([4, 2], |_, y| f64::from(y));
    let message = refused(&Setting::new([light]).file("sky.exr", below));
    assert!(message.contains("upper half"), "{message}");
    let lamp = Setting::new([goniometric("lamp.exr", DAffine3::IDENTITY, Some(1.0))]);
    let message = refused(&lamp.file("lamp.exr", picture([2, 2], |_, _| 0.0)));
    assert!(message.contains("black"), "{message}");
}

#[test]
fn transforms_that_bend_directions_are_refused() {
    for scale in [
        DVec3::new(1.0, 1.0, 1.1),
        DVec3::new(1.0, 1.0, 0.0),
        DVec3::ZERO,
    ] {
        let setting = Setting::new([image("sky.exr", DAffine3::from_scale(scale))]);
        let message = refused(&setting.file("sky.exr", picture([4, 2], |_, _| 1.0)));
        assert!(message.contains("rotation"), "{message}");
    }
    let mut shear = DAffine3::IDENTITY;
    shear.matrix3.x_axis.y = 1e-3;
    let setting = Setting::new([image("sky.exr", shear)]);
    refused(&setting.file("sky.exr", picture([4, 2], |_, _| 1.0)));
}

#[test]
fn strengths_and_places_beyond_single_precision_are_refused() {
    let beyond = "beyond the range";
    for light in [
        point(DVec3::ZERO, [1e30; 3]),
        spot(DVec3::ZERO, DVec3::X, [0.9, 0.5], [0.0, 1e30, 0.0]),
        distant(DVec3::X, [1e30; 3]),
        constant([1e30; 3]),
    ] {
        let mut setting = Setting::new([light]);
        assert!(setting.try_lights().is_ok());
        setting.scene.film.imaging_ratio = 1e10;
        assert!(refused(&setting).contains(beyond));
    }
    let mut setting = sky_of(picture([4, 2], |_, _| 1e30));
    assert!(setting.try_lights().is_ok());
    setting.scene.film.imaging_ratio = 1e10;
    assert!(refused(&setting).contains(beyond));
    assert!(refused(&Setting::new([point(DVec3::X * 1e39, [1.0; 3])])).contains(beyond));
}

#[test]
fn memory_is_limited() {
    let setting = Setting::new((0..1000).map(|_| point(DVec3::X, [1.0; 3])));
    let limits = Limits {
        max_memory: 100_000,
    };
    let surfaces = setting.surfaces();
    let lights = |limits: &Limits| {
        Lights::new(
            &setting.scene,
            &surfaces,
            BOUNDS,
            ORIGIN,
            &setting.files,
            limits,
        )
    };
    let error = lights(&limits).expect_err("refused");
    assert!(error.message().contains("1000 lights need"), "{error}");
    assert!(lights(&Limits::default()).is_ok());
    let nothing = Bounds {
        radius: 0.0,
        ..BOUNDS
    };
    let limits = Limits::default();
    let made = Lights::new(
        &setting.scene,
        &surfaces,
        nothing,
        ORIGIN,
        &setting.files,
        &limits,
    );
    assert!(made.is_err());
}

#[test]
fn surfaces_that_shine_too_brightly_are_refused_at_their_place() {
    let corners = [DVec3::ZERO, DVec3::X, DVec3::Y];
    let surface = shining(triangles(&[corners]), [1e30; 3], false);
    let mut setting = Setting::new([]).with([surface]);
    assert!(setting.try_lights().is_ok());
    setting.scene.film.imaging_ratio = 1e10;
    assert!(refused(&setting).contains("beyond the range"));
}
