//! White furnaces: with albedo 1 in a uniform sky of radiance 1, every picture is 1, whatever fills it.
//!
//! Grey media whose paths meet the sky only by escaping bring exactly 1 on every path: throughput is multiplied by
//! an albedo of exactly 1 and never changes. With shadow rays, or in colour, the mean is 1.

use super::{assert_near, keepable, volume};
use woodcock_core::path::ShadowEstimator;
use woodcock_host::scene::MemoryFiles;
use woodcock_host::world::Feature;
use woodcock_tests::pictures::*;

const UNIT: [Xyz; 2] = [[-1.0; 3], [1.0; 3]];

struct Furnace {
    name: &'static str,
    world: String,
    files: MemoryFiles,
}

fn blob([x, y, z]: Xyz) -> f64 {
    (1.0 - x * x - y * y - z * z).max(0.0) + 0.2 * (5.0 * x).sin().max(0.0)
}

/// Media of grey extinction and albedo 1.
fn grey_furnaces() -> Vec<Furnace> {
    let plain = |name, world: String| Furnace {
        name,
        world,
        files: MemoryFiles::new(),
    };
    let white = |sigma_t, g| grey(sigma_t, 1.0, g);
    let mut furnaces = vec![
        plain(
            "ball",
            homogeneous("m", &white(3.0, 0.0)) + &ball("m", "", [0.1, 0.0, 0.0], 1.0),
        ),
        plain(
            "block",
            homogeneous("m", &white(2.0, 0.0)) + &block("m", "", UNIT),
        ),
        plain(
            "forward",
            homogeneous("m", &white(8.0, 0.9)) + &ball("m", "", [0.0; 3], 1.0),
        ),
        plain(
            "backward",
            homogeneous("m", &white(2.0, -0.7)) + &ball("m", "", [0.0; 3], 1.0),
        ),
        plain(
            "rayleigh",
            homogeneous("m", &rayleigh(2.0, 1.0)) + &block("m", "", UNIT),
        ),
        plain(
            "grid",
            uniform_grid("m", [12, 9, 11], UNIT, blob, &white(6.0, 0.3)) + &block("m", "", UNIT),
        ),
        plain(
            "grid cut by a ball",
            uniform_grid("m", [12, 9, 11], UNIT, blob, &white(6.0, 0.3))
                + &ball("m", "", [0.3; 3], 0.9),
        ),
        plain(
            "two that overlap",
            homogeneous("a", &white(2.0, 0.5))
                + &uniform_grid("b", [8; 3], UNIT, blob, &white(4.0, -0.3))
                + &ball("a", "", [0.5, 0.0, 0.0], 0.8)
                + &block("b", "", UNIT),
        ),
        plain(
            "nested",
            homogeneous("fog", &white(0.5, 0.0))
                + &homogeneous("core", &white(5.0, 0.6))
                + &ball("fog", "", [0.0; 3], 1.2)
                + &block("core", "fog", [[-0.4; 3], [0.3; 3]]),
        ),
        plain(
            "three that overlap",
            homogeneous("a", &white(2.0, 0.5))
                + &homogeneous("b", &white(1.0, 0.0))
                + &homogeneous("c", &rayleigh(3.0, 1.0))
                + &ball("a", "", [0.5, 0.0, 0.0], 0.8)
                + &ball("b", "", [0.0, 0.5, 0.0], 0.8)
                + &ball("c", "", [0.0, 0.0, 0.5], 0.8),
        ),
    ];
    // The cloud spans about 2.4 x 1.3 x 2.6.
    furnaces.push(Furnace {
        name: "openvdb",
        world: openvdb("m", "cloud_zip.vdb", &white(12.0, 0.5))
            + &block("m", "", [[-2.0; 3], [2.0; 3]]),
        files: volume("cloud_zip.vdb"),
    });
    furnaces
}

/// From far outside, and from a place that lies in all of the media.
fn cameras() -> [String; 3] {
    [
        perspective([0.3, 0.4, -4.0], [-0.05, -0.1, 1.0], 45.0),
        perspective([0.1, 0.1, 0.1], [0.2, 0.4, 1.0], 90.0),
        orthographic([5.0, 0.0, 0.0], [-1.0, 0.0, 0.0], 1.5),
    ]
}

#[test]
fn paths_that_escape_bring_exactly_one() {
    for furnace in grey_furnaces() {
        for camera in cameras() {
            let world = sky(1.0) + &furnace.world;
            let text = scene(&camera, [24, 24], &world);
            let picture = stage_with(&text, furnace.files.clone(), &[]).shoot(4);
            picture
                .assert_sound(furnace.name)
                // Where flights are made to collide, what passes adds up to one, each part rounded.
                .assert_constant(furnace.name, 1.0, 1e-6);
        }
    }
}

#[test]
fn what_is_kept_unneeded_leaves_the_furnace_white() {
    for furnace in grey_furnaces() {
        let text = scene(&cameras()[0], [24, 24], &(sky(1.0) + &furnace.world));
        for feature in keepable() {
            let name = format!("{}, keeping {}", furnace.name, feature.name());
            let picture = stage_with(&text, furnace.files.clone(), &[feature]).shoot(16);
            picture.assert_sound(&name);
            // Scalar code, which coloured media that overlap need too, looks for the sky's light at each vertex.
            let scalar = matches!(feature, Feature::Surfaces | Feature::EquiAngular)
                || feature == Feature::Chromatic && furnace.name.contains("overlap");
            if scalar || feature == Feature::EnvironmentNextEvent {
                for channel in 0..3 {
                    assert_near(&name, &picture.moments(channel), 1.0, 0.0, 0.01);
                }
            } else if feature == Feature::Chromatic {
                // Weights of equal colours divide and multiply by the same numbers, rounded.
                picture.assert_constant(&name, 1.0, 1e-4);
            } else {
                picture.assert_constant(&name, 1.0, 1e-6);
            }
        }
    }
}

#[test]
fn shadow_rays_to_the_sky_keep_the_mean() {
    for furnace in grey_furnaces() {
        let world = sky(1.0) + &furnace.world;
        for (camera, shadow) in [(1, ShadowEstimator::Delta), (2, ShadowEstimator::Ratio)] {
            let text = scene(&cameras()[camera], [16, 16], &world);
            let mut studio = stage_with(
                &text,
                furnace.files.clone(),
                &[Feature::EnvironmentNextEvent],
            );
            studio.plan.settings.shadow = shadow;
            let picture = studio.shoot(64);
            picture.assert_sound(furnace.name);
            let moments = picture.moments(1);
            assert_near(furnace.name, &moments, 1.0, 0.0, 0.01);
        }
    }
}

#[test]
fn colours_of_different_extinction_stay_white() {
    let white = |sigma_s, g| coloured([0.0; 3], sigma_s, g);
    let strong = [1.0, 4.0, 12.0];
    // One colour does not see the medium at all.
    let clear = [0.0, 2.0, 5.0];
    let furnaces = [
        (
            "ball",
            homogeneous("m", &white(strong, 0.4)) + &ball("m", "", [0.0; 3], 1.0),
        ),
        (
            "clear in red",
            homogeneous("m", &white(clear, 0.0)) + &block("m", "", UNIT),
        ),
        (
            "grid",
            uniform_grid("m", [10; 3], UNIT, blob, &white(strong, 0.4)) + &block("m", "", UNIT),
        ),
        (
            "nested",
            homogeneous("fog", &white([0.5, 0.2, 0.1], 0.0))
                + &homogeneous("core", &white(strong, 0.6))
                + &ball("fog", "", [0.0; 3], 1.2)
                + &block("core", "fog", [[-0.4; 3], [0.3; 3]]),
        ),
    ];
    for (name, world) in furnaces {
        for keep in [&[][..], &[Feature::EnvironmentNextEvent]] {
            let text = scene(&cameras()[0], [24, 24], &(sky(1.0) + &world));
            let picture = stage_keeping(&text, keep).shoot(128);
            picture.assert_sound(name);
            for channel in 0..3 {
                assert_near(name, &picture.moments(channel), 1.0, 0.0, 0.01);
            }
        }
    }
}

#[test]
fn an_albedo_just_below_one_is_seen() {
    // The furnace must be able to fail: 0.1 % of absorption shows on paths of a few scatterings.
    let world =
        sky(1.0) + &homogeneous("m", &grey(5.0, 0.999, 0.0)) + &ball("m", "", [0.0; 3], 1.0);
    let picture = stage(&scene(
        &single_ray([0.0, 0.0, -3.0], [0.0, 0.0, 1.0]),
        [16, 16],
        &world,
    ))
    .shoot(64);
    let m = picture.moments(0);
    let z = (m.mean() - 1.0) / m.standard_error();
    assert!(z < -10.0, "{z}");
}
