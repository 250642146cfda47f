//! What must not matter, to the last bit: lanes, threads, passes, and what else is in the picture.

use super::{volume, volume_bytes};
use woodcock_core::majorant::GridWalk;
use woodcock_core::medium::Medium;
use woodcock_core::path::{Bricks, OneGrid, Store, Tapped};
use woodcock_core::ray::Ray;
use woodcock_core::stream::{Key, PathStream};
use woodcock_core::vec3::Vec3;
use woodcock_host::film::Film;
use woodcock_host::integrator::Integrator;
use woodcock_host::render::{Kernel, replay};
use woodcock_host::scene::MemoryFiles;
use woodcock_host::world::{self, Feature};
use woodcock_tests::pictures::*;

/// The same medium, sending out light.
fn shining(medium: &str) -> String {
    medium.replace(
        "\"uniformgrid\"",
        "\"uniformgrid\" \"rgb Le\" [ 0.9 0.5 0.2 ] \"float Lescale\" 1.5",
    )
}

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
            "grid of nearly grey colours",
            &far,
            uniform_grid(
                "m",
                [19, 8, 13],
                unit,
                lumps,
                &coloured([0.1, 0.2, 0.3], [3.0, 2.9, 2.8], 0.5),
            ) + &block("m", "", unit),
            &[],
        ),
        case(
            "grid that absorbs",
            &far,
            uniform_grid("m", [19, 8, 13], unit, lumps, &grey(3.0, 0.0, 0.0))
                + &block("m", "", unit),
            &[],
        ),
        case(
            "ball that absorbs in colour",
            &far,
            homogeneous("m", &coloured([0.3, 0.9, 2.0], [0.0; 3], 0.0))
                + &ball("m", "", [0.0; 3], 1.0),
            &[],
        ),
        case(
            "grid that shines",
            &far,
            shining(&uniform_grid(
                "m",
                [19, 8, 13],
                unit,
                lumps,
                &grey(4.0, 0.5, 0.3),
            )) + &block("m", "", unit),
            &[],
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
    let ways = cases().into_iter().zip(cases());
    let ways = ways.flat_map(|(a, b)| [(a, false), (b, true)]);
    for (case, pointed) in ways {
        let mut studio = studio(&case, [33, 17]);
        if pointed {
            studio = studio.pointed();
        }
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

/// A grid that is mostly empty, larger than a brick along each axis, and of no brick's size.
fn sparse([x, y, z]: Xyz) -> f64 {
    let lump = |cx: f64, cy: f64, cz: f64| {
        let squares = (x - cx).powi(2) + (y - cy).powi(2) + (z - cz).powi(2);
        (0.09 - squares).max(0.0) * 12.0
    };
    let rough = 0.6 + 0.4 * (37.0 * x + 51.0 * y * z).sin();
    rough * (lump(-0.5, 0.3, 0.1) + lump(0.4, -0.4, -0.5) + lump(0.6, 0.6, 0.7))
}

/// Samples in one table and in bricks, read whole or settled by a byte: paths cannot tell.
#[test]
fn bricks_change_no_bit() {
    let unit = [[-1.0; 3], [1.0; 3]];
    let lights = sky(0.3) + &sun([1.0, 2.0, -1.0], [3.0, 2.5, 2.0]);
    let far = perspective([0.2, 0.5, -3.5], [0.0, -0.1, 1.0], 50.0);
    let tinted = coloured([0.1, 0.3, 0.9], [3.0, 2.0, 1.0], 0.5);
    for (name, matter, function, size) in [
        (
            "lumps",
            grey(9.0, 0.97, 0.6),
            lumps as fn(Xyz) -> f64,
            [19, 8, 13],
        ),
        ("sparse", grey(40.0, 0.99, 0.8), sparse, [45, 38, 51]),
        ("sparse in colour", tinted, sparse, [45, 38, 51]),
    ] {
        let world = lights.clone()
            + &uniform_grid("m", size, unit, function, &matter)
            + &block("m", "", unit);
        let text = scene(&far, [33, 17], &world);
        let dense = stage_keeping(&text, &[Feature::DenseGrid]);
        let mut bricks = stage_keeping(&text, &[Feature::Bricks]);
        assert!(dense.world.tables.bricks.is_none() && bricks.world.tables.bricks.is_some());
        assert!(bricks.world.tables.samples.is_empty());
        let expected = dense.shoot_range(0..4);
        expected.assert_sound(name);
        let packet = bricks.shoot_range(0..4);
        assert!(packet.film == expected.film, "{name}");
        bricks.plan.kernel = Kernel::Scalar;
        let scalar = bricks.shoot_range(0..4);
        assert!(scalar.film == expected.film, "{name}: one lane");
        let read = |p: &Picture| p.counts.exact_lookups as f64 / p.counts.lookups as f64;
        assert_eq!(read(&packet), read(&scalar));
        assert_eq!(read(&expected), 1.0);
        if name == "sparse" {
            assert!(read(&packet) < 0.6, "{name}: {} are read", read(&packet));
        }
        // Scalar integrators of other kinds read samples one by one.
        for integrator in [Integrator::Bdpt, Integrator::Transmittance] {
            let [mut dense, mut bricks] =
                [&[Feature::DenseGrid], &[Feature::Bricks]].map(|keep| stage_keeping(&text, keep));
            dense.plan.integrator = integrator;
            bricks.plan.integrator = integrator;
            let [dense, bricks] = [dense, bricks].map(|s| s.shoot_range(0..1).film);
            assert!(dense == bricks, "{name}: {integrator:?}");
        }
    }
}

/// A volume whose leaves become bricks without a table in between, and one that goes through the table: the same bounds and pictures.
#[test]
fn leaves_in_bricks_change_no_bit() {
    let unit = [[-1.0; 3], [1.0; 3]];
    for (file, scale) in [
        ("cloud_blosc.vdb", 1.0),
        ("fire_160.vdb", 2.0),
        ("quantised_zip.vdb", 2.0),
    ] {
        let world = sky(0.3)
            + &sun([1.0, 2.0, -1.0], [3.0, 2.5, 2.0])
            + &openvdb("m", file, &grey(scale, 0.95, 0.6))
            + &block("m", "", unit.map(|corner| corner.map(|c| 100.0 * c)));
        let far = perspective([1.0, 1.5, -5.0], [0.0, 0.0, 1.0], 70.0);
        let text = scene(&far, [33, 17], &world);
        let staged = |keep: Feature| {
            let options = world::Options {
                keep: vec![keep],
                ..world::Options::default()
            };
            try_stage(&text, volume(file), &options).expect("a scene")
        };
        let (dense, bricks) = (staged(Feature::DenseGrid), staged(Feature::Bricks));
        let (table, direct) = (&dense.world.tables, &bricks.world.tables);
        assert!(table.bricks.is_none() && direct.bricks.is_some(), "{file}");
        assert_eq!(table.box_samples(), direct.box_samples(), "{file}");
        assert!(table.majorants == direct.majorants, "{file}: bounds differ");
        assert!(table.controls == direct.controls, "{file}: controls differ");
        let expected = dense.shoot_range(0..4);
        expected.assert_sound(file);
        assert!(expected.counts.real_collisions > 0, "{file} is not seen");
        assert!(bricks.shoot_range(0..4).film == expected.film, "{file}");
    }
}

/// A planted mistake: with the bytes of the voxels beside, decisions differ, so the test above would see them.
#[test]
fn wrong_bytes_are_seen() {
    let unit = [[-1.0; 3], [1.0; 3]];
    let world = sky(0.3)
        + &uniform_grid("m", [45, 38, 51], unit, sparse, &grey(40.0, 0.99, 0.8))
        + &block("m", "", unit);
    let far = perspective([0.2, 0.5, -3.5], [0.0, -0.1, 1.0], 50.0);
    let studio = stage_keeping(&scene(&far, [9, 9], &world), &[Feature::Bricks]);
    let tables = &studio.world.tables;
    let bricks = tables.bricks.as_ref().expect("bricks").borrow();
    let moved: Vec<u32> = bricks.codes.iter().map(|w| w.rotate_left(8)).collect();
    let record = &studio.world.media[0].record;
    let grid = |codes| {
        let bricks = Bricks { codes, ..bricks };
        OneGrid::stored(record, Store::Bricks(bricks), &tables.majorants)
    };
    let (right, wrong) = (grid(bricks.codes), grid(&moved));
    let ray = Ray {
        origin: Vec3::splat([-1.0, 0.25, 0.1]),
        direction: Vec3::splat([1.0, 0.0, 0.0]),
    };
    let mut walk: GridWalk<f32> = right.idle();
    right.begin(&mut walk, &ray, true);
    let (mut looked_up, mut differ) = (0, 0);
    while walk.segment().t_exit < 2.0 {
        let majorant = walk.segment().majorant;
        let t = walk.segment().t_exit;
        for sample in 0..200 {
            let decide = |grid: &OneGrid<'_>| {
                let mut rng = PathStream::new(Key {
                    sample,
                    ..Key::default()
                });
                let tap = grid.tap(&walk, t * 0.999, &mut rng, true);
                grid.decide(&walk, tap, majorant, &mut rng, true).real
            };
            looked_up += 1;
            differ += u32::from(decide(&right) != decide(&wrong));
        }
        right.next_segment(&mut walk, true);
    }
    assert!(looked_up > 200 && differ > 20, "{differ} of {looked_up}");
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
