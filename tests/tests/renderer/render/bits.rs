//! What must not matter, to the last bit: lanes, threads, passes, and what else is in the picture.

use super::{volume, volume_bytes};
use woodcock_host::film::Film;
use woodcock_host::render::{Kernel, replay};
use woodcock_host::scene::MemoryFiles;
use woodcock_host::world::{self, Feature};
use woodcock_tests::pictures::*;

struct Case {
    name: &'static str,
    camera: String,
    world: String,
    keep: &'static [Feature],
}

fn lumps([x, y, z]: Xyz) -> f64 {
    ((4.0 * x).sin() + (5.0 * y).cos() + (3.0 * z + 1.0).sin()).max(0.0)
}

/// One scene for each kernel, and for each kind of place.
fn cases() -> Vec<Case> {
    let lights = sky(0.3) + &sun([1.0, 2.0, -1.0], [3.0, 2.5, 2.0]);
    let tinted = || coloured([0.1, 0.3, 0.9], [3.0, 2.0, 1.0], 0.5);
    let far = perspective([0.2, 0.5, -3.5], [0.0, -0.1, 1.0], 50.0);
    let inside = perspective([0.1, 0.2, 0.0], [1.0, 0.3, 0.5], 80.0);
    let unit = [[-1.0; 3], [1.0; 3]];
    let case = |name, camera: &String, world: String, keep| Case {
        name,
        camera: camera.clone(),
        world: lights.clone() + &world,
        keep,
    };
    let fog = homogeneous("fog", &grey(0.4, 0.9, 0.0));
    vec![
        case(
            "homogeneous ball",
            &far,
            homogeneous("m", &grey(4.0, 0.95, 0.7)) + &ball("m", "", [0.0; 3], 1.0),
            &[],
        ),
        case(
            "homogeneous block in colour",
            &inside,
            homogeneous("m", &tinted()) + &block("m", "", unit),
            &[Feature::EnvironmentNextEvent],
        ),
        case(
            "rayleigh",
            &far,
            homogeneous("m", &rayleigh(2.0, 0.9)) + &ball("m", "", [0.0; 3], 1.0),
            &[],
        ),
        case(
            "grid",
            &far,
            uniform_grid("m", [19, 8, 13], unit, lumps, &grey(9.0, 0.97, 0.6))
                + &block("m", "", unit),
            &[],
        ),
        case(
            "grid in colour",
            &inside,
            uniform_grid("m", [19, 8, 13], unit, lumps, &tinted()) + &block("m", "", unit),
            &[Feature::EnvironmentNextEvent],
        ),
        case(
            "several that overlap",
            &inside,
            fog.clone()
                + &uniform_grid("m", [9; 3], unit, lumps, &grey(5.0, 0.9, 0.3))
                + &ball("fog", "", [0.4, 0.0, 0.2], 1.1)
                + &block("m", "", unit),
            &[],
        ),
        case(
            "nested in colour",
            &far,
            fog + &homogeneous("m", &tinted())
                + &ball("fog", "", [0.0; 3], 1.3)
                + &block("m", "fog", [[-0.5; 3], [0.6; 3]]),
            &[],
        ),
    ]
}

fn studio(case: &Case, size: [u32; 2]) -> Studio {
    stage_keeping(&scene(&case.camera, size, &case.world), case.keep)
}

#[test]
fn eight_lanes_and_one_give_the_same_bits() {
    for case in cases() {
        let mut studio = studio(&case, [33, 17]);
        let packet = studio.shoot_range(0..3);
        studio.plan.kernel = Kernel::Scalar;
        let scalar = studio.shoot_range(0..3);
        packet.assert_sound(case.name);
        assert!(packet.film == scalar.film, "{}", case.name);
        let work = |p: &Picture| {
            let c = p.counts;
            [
                c.paths,
                c.tentative_collisions,
                c.real_collisions,
                c.null_collisions,
                c.majorant_cells,
            ]
        };
        assert_eq!(work(&packet), work(&scalar), "{}", case.name);
    }
}

#[test]
fn threads_and_passes_do_not_matter() {
    let pool = |threads| {
        rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .expect("threads")
    };
    for case in cases() {
        let studio = studio(&case, [40, 21]);
        let shoot = |threads: usize, passes: &[std::ops::Range<u32>]| -> Film {
            pool(threads).install(|| studio.shoot_passes(passes).film)
        };
        let all = std::slice::from_ref(&(0..8));
        let whole = shoot(1, all);
        let singles: Vec<_> = (0..8).map(|i| i..i + 1).collect();
        assert!(whole == shoot(2, all), "{}: two threads", case.name);
        assert!(whole == shoot(3, &singles), "{}: eight passes", case.name);
        let backwards = [5..8, 0..1, 1..5];
        assert!(whole == shoot(2, &backwards), "{}: other passes", case.name);
    }
}

#[test]
fn a_crop_is_part_of_the_whole() {
    for case in cases() {
        let text = scene(&case.camera, [50, 30], &case.world);
        let whole = stage_keeping(&text, case.keep).shoot_range(0..2).film;
        let options = world::Options {
            keep: case.keep.to_vec(),
            crop: Some([0.3, 0.9, 0.5, 1.0]),
            ..world::Options::default()
        };
        let part = try_stage(&text, MemoryFiles::new(), &options)
            .expect("a crop")
            .shoot_range(0..2)
            .film;
        assert_eq!(part.window().pixels(), 30 * 15);
        let window = part.window();
        let inside: Vec<_> = whole
            .pixels()
            .filter(|(x, y, _)| window.contains(*x, *y))
            .collect();
        for (x, y, pixel) in part.pixels() {
            let same = inside.iter().find(|(a, b, _)| (*a, *b) == (x, y));
            assert!(
                same.is_some_and(|(.., p)| *p == pixel),
                "{}: ({x}, {y})",
                case.name
            );
        }
    }
}

#[test]
fn a_replayed_path_is_the_one_in_the_picture() {
    for case in cases() {
        let studio = studio(&case, [20, 20]);
        let film = studio.shoot_range(0..1).film;
        for (x, y, pixel) in film.pixels().step_by(7) {
            let (path, _) = replay(&studio.world, &studio.plan, x, y, 0);
            assert_eq!(path.radiance.map(f64::from), pixel.mean(), "{}", case.name);
            assert_eq!(f64::from(path.alpha), pixel.alpha());
        }
    }
}

#[test]
fn files_of_the_same_content_give_the_same_bits() {
    let shoot = |file: &str| {
        let world = sky(1.0)
            + &openvdb("m", file, &grey(9.0, 0.8, 0.4))
            + &block("m", "", [[-2.0; 3], [2.0; 3]]);
        let text = scene(
            &perspective([0.0, 0.8, -5.0], [0.0, 0.0, 1.0], 30.0),
            [24; 2],
            &world,
        );
        stage_with(&text, volume(file), &[]).shoot_range(0..2).film
    };
    let zip = shoot("cloud_zip.vdb");
    assert!(
        zip.pixels().any(|(.., p)| p.alpha() > 0.0),
        "the cloud is seen"
    );
    assert!(zip == shoot("cloud_blosc.vdb"));
    assert!(zip == shoot("cloud_active.vdb"));
    assert!(shoot("cloud_half_zip.vdb") == shoot("cloud_half_blosc.vdb"));
    assert_ne!(
        volume_bytes("cloud_zip.vdb"),
        volume_bytes("cloud_blosc.vdb")
    );
}

#[test]
fn another_seed_is_another_picture() {
    for case in cases() {
        let size = [16, 16];
        let first = studio(&case, size).shoot_range(0..2).film;
        let other = studio(&case, size).seeded(2).shoot_range(0..2).film;
        let further = studio(&case, size).shoot_range(2..4).film;
        assert!(first != other && first != further, "{}", case.name);
    }
}
