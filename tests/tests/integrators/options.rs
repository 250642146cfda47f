//! What may be asked of integrators besides the picture: splitting, bounds on connections, layers. None changes a mean.

use woodcock_host::drive::Silent;
use woodcock_host::film::{Film, LayerMeans};
use woodcock_host::image::Layers;
use woodcock_host::integrator::Integrator;
use woodcock_host::render::render_pass;
use woodcock_tests::gallery::{self, Exhibit, diffuse, lamp};
use woodcock_tests::pictures::{Studio, grey, homogeneous, orthographic, scene, stage};
use woodcock_tests::replicates::Replicates;

use super::pairwise::depth;

fn exhibit(name: &str) -> Exhibit {
    let all = gallery::all();
    let found = all.into_iter().find(|exhibit| exhibit.name == name);
    found.expect("an exhibit of this name")
}

/// The picture, and the same with something else asked for.
#[track_caller]
fn changes_nothing(name: &str, integrator: Integrator, change: impl Fn(&mut Studio)) {
    let exhibit = exhibit(name);
    let shoot = |seed: u64, change: &dyn Fn(&mut Studio)| {
        let mut studio = exhibit.stage(integrator, seed);
        change(&mut studio);
        Replicates::of(name, &studio, depth(integrator))
    };
    let plain = shoot(7000, &|_| {});
    let changed = shoot(7001, &change);
    changed.assert_same(name, &plain, 0.012);
}

#[test]
fn split_camera_rays_have_the_same_mean() {
    for name in [
        "a ball of fog by a point",
        "coloured smoke under a disk",
        "a camera in fog",
    ] {
        changes_nothing(name, Integrator::Path, |studio| studio.plan.split = 3);
    }
}

#[test]
fn bounded_connections_lose_nothing() {
    for (name, bound) in [
        ("a caustic of glass in fog", 0.5),
        ("milk in a glass ball", 2.0),
        ("coloured smoke under a disk", 0.1),
    ] {
        changes_nothing(name, Integrator::Bdpt, |studio| {
            studio.plan.connection_bound = Some(bound);
        });
    }
}

/// The layers and the picture of a scene.
fn layers(world: &str, integrator: Integrator) -> (Film, Vec<LayerMeans>) {
    let camera = orthographic([0.0, 0.0, -3.0], [0.0, 0.0, 1.0], 0.5);
    let mut studio = stage(&scene(&camera, [4, 4], world));
    studio.plan.integrator = integrator;
    studio.plan.layers = true;
    let mut film = Film::new(studio.world.resolution, studio.world.window);
    film.keep_layers();
    render_pass(&studio.world, &studio.plan, &mut film, 0..64, &Silent);
    let layers = film.layers();
    assert_eq!(layers.len(), 16);
    (film, layers)
}

/// A wall across the view at z = 1 that faces the camera.
const WALL: &str = "Shape \"trianglemesh\" \"point3 P\" [ -9 -9 1  9 -9 1  9 9 1  -9 9 1 ] \
    \"integer indices\" [ 0 2 1 0 3 2 ]";

#[test]
fn a_wall_is_seen_where_it_is() {
    let world = gallery::with_material(&diffuse([0.2, 0.4, 0.8]), WALL)
        + "LightSource \"infinite\" \"rgb L\" [ 1 1 1 ]\n";
    for integrator in [Integrator::Path, Integrator::Bdpt] {
        for pixel in layers(&world, integrator).1 {
            assert!((pixel.depth - 4.0).abs() < 1e-5, "{pixel:?}");
            assert!((pixel.normal[2] + 1.0).abs() < 1e-6, "{pixel:?}");
            for (found, given) in pixel.albedo.iter().zip([0.2, 0.4, 0.8]) {
                assert!((found - given).abs() < 1e-6, "{pixel:?}");
            }
            assert_eq!(pixel.volume, [0.0; 3]);
        }
    }
}

#[test]
fn parts_of_the_light_are_told_apart() {
    // A lamp behind fog that absorbs: unscattered light of a surface, and none of the medium.
    let absorbing = homogeneous("fog", &grey(0.5, 0.0, 0.0));
    let ball = "AttributeBegin\nMediumInterface \"fog\" \"\"\nMaterial \"interface\"\nShape \"sphere\"\nAttributeEnd\n";
    let world = absorbing + ball + &lamp([2.0; 3], WALL);
    let (film, found) = layers(&world, Integrator::Path);
    for ((.., pixel), layer) in film.pixels().zip(&found) {
        assert_eq!(layer.volume, [0.0; 3]);
        assert_eq!(
            layer.direct.map(f64::from),
            pixel.mean().map(|c| f64::from(c as f32))
        );
        assert!(pixel.mean()[0] > 0.0);
    }
    // Fog that scatters before a black wall: nothing but the medium's, some of it scattered twice and more.
    let world = homogeneous("fog", &grey(6.0, 0.9, 0.0))
        + ball
        + &gallery::with_material(&diffuse([0.0; 3]), WALL)
        + "LightSource \"distant\" \"point3 from\" [ 0 0 -1 ] \"rgb L\" [ 1 1 1 ]\n";
    let (film, found) = layers(&world, Integrator::Path);
    let sum = |of: &dyn Fn(&LayerMeans) -> f32| found.iter().map(of).sum::<f32>();
    let all: f64 = film.pixels().map(|(.., pixel)| pixel.mean()[1]).sum();
    let volume = f64::from(sum(&|layer| layer.volume[1]));
    let direct = f64::from(sum(&|layer| layer.direct[1]));
    assert!((volume / all - 1.0).abs() < 1e-5, "{volume} of {all}");
    assert!(
        direct > 0.2 * all && direct < 0.8 * all,
        "{direct} of {all}"
    );
    let channels = Layers {
        albedo: true,
        normal: true,
        depth: true,
        matter: true,
        order: true,
    }
    .channels(&film);
    let names: Vec<_> = channels
        .iter()
        .map(|channel| channel.name.as_str())
        .collect();
    assert_eq!(names.len(), 3 + 3 + 1 + 6 + 6);
    assert!(names.contains(&"N.X") && names.contains(&"Indirect.B") && names.contains(&"Z"));
}
