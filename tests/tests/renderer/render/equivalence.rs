//! One scene said in several ways: the pictures have the same mean.

use super::{assert_same_picture, volume};
use woodcock_core::path::ShadowEstimator;
use woodcock_host::scene::MemoryFiles;
use woodcock_host::world::Feature;
use woodcock_tests::pictures::*;

const UNIT: [Xyz; 2] = [[-1.0; 3], [1.0; 3]];

fn lights() -> String {
    sky(0.2) + &sun([1.0, 1.5, -1.0], [4.0, 4.0, 4.0])
}

fn view() -> String {
    perspective([0.4, 0.6, -4.0], [-0.1, -0.15, 1.0], 40.0)
}

fn picture(world: &str, keep: &[Feature], seed: u64, n: u32) -> Picture {
    picture_with(world, MemoryFiles::new(), keep, seed, n)
}

fn picture_with(world: &str, files: MemoryFiles, keep: &[Feature], seed: u64, n: u32) -> Picture {
    let text = scene(&view(), [32, 32], &(lights() + world));
    stage_with(&text, files, keep).seeded(seed).shoot(n)
}

fn lumps([x, y, z]: Xyz) -> f64 {
    ((4.0 * x).sin() + (5.0 * y).cos() + (3.0 * z + 1.0).sin()).max(0.0)
}

#[test]
fn a_constant_grid_is_a_homogeneous_medium() {
    let matter = grey(2.5, 0.95, 0.6);
    let reference = homogeneous("m", &matter) + &block("m", "", UNIT);
    let reference = picture(&reference, &[], 31, 96);
    // Constant wherever the block is, so that its fading rim is cut off.
    let grid = uniform_grid("m", [10, 9, 8], [[-1.5; 3], [1.5; 3]], |_| 1.0, &matter)
        + &block("m", "", UNIT);
    assert_same_picture("grid", &picture(&grid, &[], 32, 96), &reference, 0.01);
}

#[test]
fn a_block_may_be_cut_into_blocks() {
    let matter = grey(2.5, 0.95, 0.6);
    let m = homogeneous("m", &matter);
    let reference = picture(&(m.clone() + &block("m", "", UNIT)), &[], 33, 96);
    let halves = m.clone()
        + &block("m", "", [[-1.0; 3], [0.2, 1.0, 1.0]])
        + &block("m", "", [[0.2, -1.0, -1.0], [1.0; 3]]);
    assert_same_picture("halves", &picture(&halves, &[], 34, 96), &reference, 0.01);
    // Of two media with the same parameters.
    let halves = m
        + &homogeneous("n", &matter)
        + &block("m", "", [[-1.0; 3], [0.2, 1.0, 1.0]])
        + &block("n", "", [[0.2, -1.0, -1.0], [1.0; 3]]);
    assert_same_picture(
        "two media",
        &picture(&halves, &[], 35, 96),
        &reference,
        0.01,
    );
    // Of half the coefficients, twice over the same place.
    let half = grey(1.25, 0.95, 0.6);
    let twice = homogeneous("m", &half)
        + &homogeneous("n", &half)
        + &block("m", "", UNIT)
        + &block("n", "", [[-1.0; 3], [1.0, 1.0, 1.0]]);
    assert_same_picture(
        "twice a half",
        &picture(&twice, &[], 36, 96),
        &reference,
        0.01,
    );
}

#[test]
fn surfaces_turned_inside_out_enclose_the_same() {
    let m = homogeneous("m", &grey(2.5, 0.95, 0.6));
    let reference = picture(
        &(m.clone() + &block("m", "", UNIT)),
        &[Feature::Boundaries],
        37,
        64,
    );
    let turned = |sides: &str, reverse: &str| {
        format!(
            "{m}AttributeBegin Material \"interface\" MediumInterface {sides} {reverse}\n{}\nAttributeEnd\n",
            block_mesh(UNIT)
        )
    };
    let reversed = picture(&turned("\"\" \"m\"", "ReverseOrientation"), &[], 38, 64);
    assert_same_picture("reversed", &reversed, &reference, 0.02);
    // Normals that point inwards in the mesh itself: a mirror image does that to a mesh read as it stands.
    let inwards = block_mesh(UNIT).replace(
        BLOCK_TRIANGLES,
        "[ 0 1 2 0 2 3  4 6 5 4 7 6  0 5 1 0 4 5  3 6 7 3 2 6  0 7 4 0 3 7  1 6 2 1 5 6 ]",
    );
    let text = format!(
        "{m}AttributeBegin Material \"interface\" MediumInterface \"\" \"m\"\n{inwards}\nAttributeEnd\n"
    );
    assert_same_picture("inwards", &picture(&text, &[], 39, 64), &reference, 0.02);
    let mirrored = format!(
        "{m}AttributeBegin Scale -1 1 1\nMaterial \"interface\" MediumInterface \"m\" \"\"\n{}\nAttributeEnd\n",
        block_mesh(UNIT)
    );
    assert_same_picture(
        "mirrored",
        &picture(&mirrored, &[], 40, 64),
        &reference,
        0.02,
    );
}

#[test]
fn what_is_kept_changes_no_mean() {
    let worlds = [
        (
            "ball",
            homogeneous("m", &grey(3.0, 0.9, 0.5)) + &ball("m", "", [0.0; 3], 1.0),
            MemoryFiles::new(),
        ),
        (
            "grid",
            uniform_grid("m", [9, 8, 7], UNIT, lumps, &grey(4.0, 0.9, -0.3))
                + &block("m", "", UNIT),
            MemoryFiles::new(),
        ),
        (
            "cloud",
            openvdb("m", "cloud_zip.vdb", &grey(8.0, 0.95, 0.7))
                + &block("m", "", [[-2.0; 3], [2.0; 3]]),
            volume("cloud_zip.vdb"),
        ),
        (
            "grid in colour",
            uniform_grid(
                "m",
                [9, 8, 7],
                UNIT,
                lumps,
                &coloured([0.2, 0.3, 0.5], [1.5, 2.0, 2.5], 0.3),
            ) + &block("m", "", UNIT),
            MemoryFiles::new(),
        ),
        (
            "grid that shines",
            uniform_grid("m", [9, 8, 7], UNIT, lumps, &grey(1.5, 0.5, 0.3)).replace(
                "\"uniformgrid\"",
                "\"uniformgrid\" \"rgb Le\" [ 0.9 0.5 0.2 ] \"float Lescale\" 1.5",
            ) + &block("m", "", UNIT),
            MemoryFiles::new(),
        ),
    ];
    for (name, world, files) in worlds {
        let reference = picture_with(&world, files.clone(), &[], 41, 96);
        for (seed, feature) in (42..).zip(super::keepable()) {
            let kept = picture_with(&world, files.clone(), &[feature], seed, 64);
            let name = format!("{name}, keeping {}", feature.name());
            assert_same_picture(&name, &kept, &reference, 0.01);
        }
        // As users get it: variance is that of replicates.
        let text = scene(&view(), [32, 32], &(lights() + &world));
        let pointed = stage_with(&text, files.clone(), &[]).seeded(49).pointed();
        let name_of_points = format!("{name}, with points");
        assert_same_picture(&name_of_points, &pointed.shoot(512), &reference, 0.01);
        let all: Vec<_> = super::keepable().collect();
        let kept = picture_with(&world, files, &all, 50, 64);
        assert_same_picture(&format!("{name}, keeping all"), &kept, &reference, 0.01);
    }
}

/// Transmittance by power series, by flights that are absorbed or not, and by scalar code. A pixel that hardly any flight fails
/// to pass misjudges its variance, so pixels are not asked one by one.
#[test]
fn what_only_absorbs_hides_what_flights_do() {
    let test = woodcock_tests::stats::ImageTest {
        resolution: 0.005,
        allowance: f64::MAX,
    };
    let tinted = coloured([0.5, 1.0, 1.5], [0.0; 3], 0.0);
    for (name, matter) in [("grey", grey(1.5, 0.0, 0.0)), ("tinted", tinted)] {
        let world = uniform_grid("m", [9, 8, 7], UNIT, lumps, &matter) + &block("m", "", UNIT);
        let series = picture(&world, &[], 81, 96);
        for (seed, feature) in (82..).zip([Feature::Scattering, Feature::Surfaces]) {
            let flights = picture(&world, &[feature], seed, 256);
            for channel in 0..3 {
                let (flown, known) = (flights.image(channel), series.image(channel));
                let found = test.compare(&flown, &known);
                let name = format!("{name}, {}, channel {channel}", feature.name());
                assert!(found.verdict.agrees(), "{name}: {:?}", found.verdict);
            }
        }
        // A medium a tenth denser would be seen.
        let denser = world.replace("\"rgb sigma_a\"", "\"float scale\" 1.1 \"rgb sigma_a\"");
        assert_ne!(denser, world);
        let planted = picture(&denser, &[], 85, 96);
        let found = test.compare(&planted.image(1), &series.image(1));
        assert!(found.whole < -10.0, "{name}: {}", found.whole);
    }
}

/// Combs and flights along camera rays: of what only absorbs, of what scatters too, and of two blocks with a gap between them.
#[test]
fn combs_see_what_flights_do() {
    let test = woodcock_tests::stats::ImageTest {
        resolution: 0.01,
        allowance: f64::MAX,
    };
    let shining = |albedo: f64, glow: f64| {
        uniform_grid("m", [9, 8, 7], UNIT, lumps, &grey(2.5, albedo, 0.3)).replace(
            "\"uniformgrid\"",
            &format!("\"uniformgrid\" \"rgb Le\" [ 0.9 0.5 0.2 ] \"float Lescale\" {glow}"),
        )
    };
    let whole = block("m", "", UNIT);
    let [low, high] = UNIT;
    let apart =
        block("m", "", [low, [1.0, 1.0, -0.3]]) + &block("m", "", [[-1.0, -1.0, 0.2], high]);
    for (name, albedo, shapes) in [
        ("absorbing", 0.0, &whole),
        ("scattering", 0.6, &whole),
        ("two blocks", 0.3, &apart),
    ] {
        let world = shining(albedo, 1.5) + shapes;
        let text = scene(&view(), [32, 32], &(lights() + &world));
        let studio = stage_with(&text, MemoryFiles::new(), &[]);
        assert!(!studio.world.needs.runs(Feature::FlownEmission), "{name}");
        let combed = studio.seeded(91).pointed().shoot(96);
        let flown = picture(&world, &[Feature::FlownEmission], 92, 256);
        let brighter = picture(&(shining(albedo, 1.6) + shapes), &[], 93, 96);
        for channel in 0..3 {
            let [combed, flown] = [&combed, &flown].map(|picture| picture.image(channel));
            let found = test.compare(&combed, &flown);
            let name = format!("{name}, channel {channel}");
            assert!(found.verdict.agrees(), "{name}: {:?}", found.verdict);
        }
        // Light a fifteenth brighter would be seen.
        let found = test.compare(&brighter.image(0), &flown.image(0));
        assert!(found.whole > 10.0, "{name}: {}", found.whole);
    }
}

#[test]
fn delta_and_ratio_shadows_agree() {
    for (name, world, files) in [
        (
            "grid",
            uniform_grid("m", [9, 8, 7], UNIT, lumps, &grey(6.0, 0.9, 0.4)) + &block("m", "", UNIT),
            MemoryFiles::new(),
        ),
        (
            "cloud in fog",
            openvdb("m", "cloud_zip.vdb", &grey(8.0, 0.95, 0.7))
                + &homogeneous("fog", &grey(0.2, 0.9, 0.0))
                + &block("m", "", [[-2.0; 3], [2.0; 3]])
                + &ball("fog", "", [0.0; 3], 1.5),
            volume("cloud_zip.vdb"),
        ),
    ] {
        let text = scene(&view(), [32, 32], &(lights() + &world));
        let ratio = stage_with(&text, files.clone(), &[]).seeded(51).shoot(96);
        let mut studio = stage_with(&text, files, &[]).seeded(52);
        studio.plan.settings.shadow = ShadowEstimator::Delta;
        assert_same_picture(name, &studio.shoot(96), &ratio, 0.01);
    }
}

/// Estimates of bright shadow rays are means of several: the picture is the same, but for its noise.
#[test]
fn several_estimates_are_as_right_as_one_and_less_noisy() {
    let test = woodcock_tests::stats::ImageTest {
        resolution: 0.01,
        allowance: f64::MAX,
    };
    let cloud = openvdb("m", "cloud_zip.vdb", &grey(12.0, 0.95, 0.7))
        + &block("m", "", [[-2.0; 3], [2.0; 3]]);
    let shoot = |irradiance: f64, bright: f32, seed| {
        let lights = sun([1.0, 1.5, -1.0], [irradiance; 3]);
        let text = scene(&view(), [32, 32], &(lights + &cloud));
        let mut studio = stage_with(&text, volume("cloud_zip.vdb"), &[]).seeded(seed);
        assert!(studio.plan.settings.bright.is_finite());
        studio.plan.settings.bright = bright;
        studio.shoot(512)
    };
    let single = shoot(4.0, f32::INFINITY, 53);
    let several = shoot(4.0, 0.01, 54);
    let found = test.compare(&several.image(0), &single.image(0));
    assert!(
        found.verdict.agrees(),
        "{:?} {:+.2}",
        found.verdict,
        found.whole
    );
    let brighter = test.compare(&shoot(4.4, 0.01, 55).image(0), &single.image(0));
    assert!(
        brighter.whole > 10.0,
        "a sun brighter by a tenth: {:+.2}",
        brighter.whole
    );
    let noise = |picture: &Picture| -> f64 {
        let variances = picture
            .film
            .pixels()
            .filter_map(|(_, _, pixel)| pixel.variance_of_mean());
        variances.map(|variance| variance[0]).sum()
    };
    let ratio = noise(&several) / noise(&single);
    assert!(ratio < 0.95, "{ratio}");
}

#[test]
fn colours_are_as_if_rendered_one_by_one() {
    let (absorption, scattering) = ([0.1, 0.4, 1.2], [4.0, 2.0, 0.5]);
    type Made = fn(&Matter) -> String;
    let worlds: [(&str, Made); 2] = [
        ("ball", |m| {
            homogeneous("m", m) + &ball("m", "", [0.0; 3], 1.0)
        }),
        ("grid", |m| {
            uniform_grid("m", [9, 8, 7], UNIT, |p| 0.3 + lumps(p), m) + &block("m", "", UNIT)
        }),
    ];
    // Close, so that every pixel sees much of the medium: a pixel that hardly ever meets it misjudges its variance.
    let picture = |world: &str, seed, n| {
        let camera = perspective([0.4, 0.6, -4.0], [-0.1, -0.15, 1.0], 14.0);
        let text = scene(&camera, [32, 32], &(lights() + world));
        stage(&text).seeded(seed).shoot(n)
    };
    for (name, world) in worlds {
        let together = picture(&world(&coloured(absorption, scattering, 0.5)), 61, 192);
        for channel in 0..3 {
            let alone = coloured([absorption[channel]; 3], [scattering[channel]; 3], 0.5);
            let alone = picture(&world(&alone), 62 + channel as u64, 96);
            let test = woodcock_tests::stats::ImageTest {
                resolution: 0.01,
                allowance: 0.2,
            };
            let comparison = test.compare(&together.image(channel), &alone.image(channel));
            assert!(
                comparison.verdict.agrees(),
                "{name}, channel {channel}: {:?} {:+.2} {:?} {:.3}",
                comparison.verdict,
                comparison.whole,
                comparison.worst_tile,
                comparison.mean_square
            );
        }
    }
}

#[test]
fn several_suns_are_the_sum_of_each() {
    let world = homogeneous("m", &grey(3.0, 0.9, 0.5)) + &ball("m", "", [0.0; 3], 1.0);
    let suns = [
        sun([1.0, 1.0, 0.0], [2.0; 3]),
        sun([-1.0, 0.2, -1.0], [3.0; 3]),
        sky(0.3),
    ];
    let shoot = |lights: &str, seed, keep: &[Feature]| {
        stage_keeping(
            &scene(&view(), [24, 24], &(lights.to_owned() + &world)),
            keep,
        )
        .seeded(seed)
        .shoot(128)
        .moments(0)
    };
    let parts = [0, 1, 2].map(|i| shoot(&suns[i], 71 + i as u64, &[]));
    let sum: f64 = parts.iter().map(|m| m.mean()).sum();
    // Pixels differ, but the picture's mean is a mean; its error comes from far fewer than the spread shows.
    for (seed, keep) in [(75, &[][..]), (76, &[Feature::EnvironmentNextEvent])] {
        let all = shoot(&suns.concat(), seed, keep).mean();
        assert!((all / sum - 1.0).abs() < 0.02, "{all} {sum}");
    }
}
