//! One scene said in several ways, to scalar integrators; and scenes that packets render, rendered by the scalar path tracer.

use glam::DVec3;
use woodcock_host::integrator::Integrator;
use woodcock_host::scene::MemoryFiles;
use woodcock_host::volume::{Limits, vdb};
use woodcock_host::world::Feature;
use woodcock_tests::gallery::*;
use woodcock_tests::pictures::*;
use woodcock_tests::replicates::Replicates;

/// Samples, which the limits on scatterings let suffice.
const fn depth(integrator: Integrator) -> u32 {
    match integrator {
        Integrator::Bdpt => 128,
        Integrator::Mlt => 128,
        _ => 192,
    }
}

/// Relative standard error that each comparison must reach.
const RESOLUTION: f64 = 0.015;

fn view() -> String {
    perspective([0.0, 0.4, -4.0], [0.0, -0.12, 1.0], 32.0)
}

/// So much wider than the block that the fading rim of a grid lies outside of it.
const WIDE: [Xyz; 2] = [[-2.0; 3], [2.0; 3]];

/// Lamps and a floor around a medium.
fn around(medium: &str) -> String {
    disk_above([5.0, 4.0, 3.0]) + &sky(0.3) + &floor(&diffuse([0.6, 0.5, 0.4])) + medium
}

/// One value everywhere, in Mitsuba's format.
fn constant_vol() -> Vec<u8> {
    let (size, cells) = ([3_i32, 2, 4], 24);
    let mut bytes = b"VOL\x03".to_vec();
    for n in [1].into_iter().chain(size).chain([1]) {
        bytes.extend(n.to_le_bytes());
    }
    for bound in [0.0_f32, 0.0, 0.0, 1.0, 1.0, 1.0] {
        bytes.extend(bound.to_le_bytes());
    }
    for _ in 0..cells {
        bytes.extend(1.0_f32.to_le_bytes());
    }
    bytes
}

/// Grey in extinction, coloured in albedo.
const GREY: [Xyz; 2] = [[0.3, 0.5, 0.9], [1.5, 1.3, 0.9]];
/// Coloured in both.
const COLOURED: [Xyz; 2] = [[0.3, 0.5, 1.1], [1.5, 1.2, 0.7]];

fn matter([absorption, scattering]: [Xyz; 2], scale: f64) -> Matter {
    let scaled = |c: Xyz| c.map(|c| scale * c);
    coloured(scaled(absorption), scaled(scattering), 0.4)
}

/// The same medium in a block, in four more ways than one.
fn sayings(colours: [Xyz; 2]) -> Vec<Exhibit> {
    let cube = block("m", "", UNIT);
    let plain =
        |name, medium: String| Exhibit::new(name, view(), around(&(medium + &cube))).limited(8);
    let Matter {
        absorption,
        scattering,
        more,
    } = matter(colours, 1.0);
    let list = |c: Xyz| format!("[ {} {} {} ]", c[0], c[1], c[2]);
    let vol = format!(
        "AttributeBegin Translate -1 -1 -1 Scale 2 2 2\nMakeNamedMedium \"m\" \"string type\" \"vol\" \
         \"string filename\" \"one.vol\" \"rgb sigma_a\" {} \"rgb sigma_s\" {} {more}\nAttributeEnd\n",
        list(absorption),
        list(scattering)
    );
    let repeated = |c: Xyz| format!("[ {} ]", [list(c).trim_matches(['[', ']']); 8].concat());
    let rgb = format!(
        "MakeNamedMedium \"m\" \"string type\" \"rgbgrid\" \"integer nx\" 2 \"integer ny\" 2 \"integer nz\" 2 \
         \"point3 p0\" [ -2 -2 -2 ] \"point3 p1\" [ 2 2 2 ] \"rgb sigma_a\" {} \"rgb sigma_s\" {} {more}\n",
        repeated(absorption),
        repeated(scattering)
    );
    let half = matter(colours, 0.5);
    let halves = homogeneous("m", &half)
        + &uniform_grid("n", [3, 4, 5], WIDE, |_| 1.0, &half)
        + &block("n", "", UNIT);
    vec![
        plain("homogeneous", homogeneous("m", &matter(colours, 1.0))),
        plain(
            "a grid of ones",
            uniform_grid("m", [4, 3, 5], WIDE, |_| 1.0, &matter(colours, 1.0)),
        ),
        plain("a grid of colours", rgb),
        Exhibit {
            files: MemoryFiles::new().with("one.vol", constant_vol()),
            ..plain("a file of ones", vol)
        },
        plain("two halves that overlap", halves),
    ]
}

#[test]
fn a_constant_medium_may_be_said_in_many_ways() {
    said_in_many_ways(&sayings(GREY), Integrator::Bdpt, 6000);
    said_in_many_ways(&sayings(COLOURED), Integrator::Mlt, 6050);
}

#[track_caller]
fn said_in_many_ways(sayings: &[Exhibit], light_paths: Integrator, seed: u64) {
    let shoot = |exhibit: &Exhibit, integrator, seed: u64| {
        Replicates::of(
            exhibit.name,
            &exhibit.stage(integrator, seed),
            depth(integrator),
        )
    };
    for (integrator, seed) in [
        (Integrator::Path, seed),
        (Integrator::Transmittance, seed + 10),
        (light_paths, seed + 20),
    ] {
        let reference = shoot(&sayings[0], integrator, seed);
        for (exhibit, seed) in sayings[1..].iter().zip(seed + 1..) {
            let name = format!("{}, {}", exhibit.name, integrator.name());
            shoot(exhibit, integrator, seed).assert_same(&name, &reference, RESOLUTION);
        }
    }
}

fn cloud_bytes() -> Vec<u8> {
    let path = std::path::PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("data/vdb/cloud_zip.vdb");
    std::fs::read(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

#[test]
fn a_volume_file_is_the_grid_of_its_voxels() {
    let matter = coloured([0.5, 1.0, 2.0], [3.0, 2.0, 1.5], 0.3);
    let cube = block("m", "", [[-2.0; 3], [2.0, 1.9, 2.0]]);
    let from_above = perspective([0.2, 2.5, -3.5], [-0.03, -0.48, 1.0], 34.0);
    let file = Exhibit {
        files: MemoryFiles::new().with("cloud_zip.vdb", cloud_bytes()),
        ..Exhibit::new(
            "file",
            from_above.clone(),
            around(&(openvdb("m", "cloud_zip.vdb", &matter) + &cube)),
        )
        .limited(8)
    };
    let read = vdb::read(&cloud_bytes(), &Limits::default()).expect("a volume");
    let cloud = read.grid("density").expect("its grid");
    // Its voxels and one beyond on each side, their values at the centres of cells: 0.05 apart, the first at (−1.2, 0, −1.3).
    let (first, cells) = ([-1.0, 1.0, 0.0], [50, 27, 53]);
    let low: Xyz = std::array::from_fn(|i| [-1.2, 0.0, -1.3][i] + 0.05 * (first[i] - 0.5));
    let high: Xyz = std::array::from_fn(|i| low[i] + 0.05 * cells[i] as f64);
    let value = |p: Xyz| {
        cloud
            .trilinear(0, DVec3::from_array(p))
            .expect("a value")
            .max(0.0)
    };
    let listed = uniform_grid("m", cells, [low, high], value, &matter);
    let listed = Exhibit::new("listed", from_above, around(&(listed + &cube))).limited(8);
    for (integrator, seed) in [(Integrator::Path, 6100), (Integrator::Bdpt, 6110)] {
        let [a, b] = [(&file, seed), (&listed, seed + 1)].map(|(exhibit, seed)| {
            Replicates::of(
                exhibit.name,
                &exhibit.stage(integrator, seed),
                depth(integrator),
            )
        });
        a.assert_same(integrator.name(), &b, RESOLUTION);
    }
}

/// Scenes that packets render: every kernel of theirs.
fn media_only() -> Vec<Exhibit> {
    let lights = sky(0.3) + &sun([1.0, 1.5, -1.0], [3.0, 2.5, 2.0]);
    let view = || perspective([0.4, 0.6, -4.0], [-0.1, -0.15, 1.0], 30.0);
    let tinted = || coloured([0.1, 0.3, 0.9], [2.5, 1.5, 0.8], 0.5);
    let inside = perspective([0.1, 0.2, 0.0], [1.0, 0.3, 0.5], 80.0);
    let exhibit =
        |name, camera: String, media: String| Exhibit::new(name, camera, lights.clone() + &media);
    let fog = homogeneous("fog", &grey(0.4, 0.9, 0.0));
    vec![
        exhibit(
            "homogeneous",
            view(),
            homogeneous("m", &grey(3.0, 0.9, 0.6)) + &ball("m", "", [0.0; 3], 1.0),
        ),
        exhibit(
            "homogeneous in colour",
            view(),
            homogeneous("m", &tinted()) + &block("m", "", UNIT),
        ),
        exhibit(
            "rayleigh from inside",
            inside,
            homogeneous("m", &rayleigh(2.0, 0.9)) + &block("m", "", UNIT),
        ),
        exhibit(
            "grid",
            view(),
            uniform_grid("m", [9, 8, 7], UNIT, lumps, &grey(4.0, 0.9, 0.3)) + &block("m", "", UNIT),
        ),
        exhibit(
            "grid in colour",
            view(),
            uniform_grid("m", [9, 8, 7], UNIT, lumps, &tinted()) + &block("m", "", UNIT),
        ),
        exhibit(
            "several that overlap",
            view(),
            fog.clone()
                + &uniform_grid("m", [9; 3], UNIT, lumps, &grey(3.0, 0.9, 0.3))
                + &ball("fog", "", [0.4, 0.0, 0.2], 1.1)
                + &block("m", "", UNIT),
        ),
        exhibit(
            "nested in colour",
            view(),
            fog + &homogeneous("m", &tinted())
                + &ball("fog", "", [0.0; 3], 1.3)
                + &block("m", "fog", [[-0.5; 3], [0.6; 3]]),
        ),
    ]
}

#[test]
fn scalar_paths_and_packets_make_one_picture() {
    for (exhibit, seed) in media_only().iter().zip((6200..).step_by(10)) {
        for limit in [None, Some(2)] {
            let packets = stage(&exhibit.text());
            let packets = replan(packets, Integrator::Path, seed, limit);
            assert!(packets.plan.in_packets(&packets.world), "{}", exhibit.name);
            let scalar = stage_keeping(&exhibit.text(), &[Feature::Surfaces]);
            let scalar = replan(scalar, Integrator::Path, seed + 1, limit);
            assert!(!scalar.plan.in_packets(&scalar.world), "{}", exhibit.name);
            let [scalar, packets] =
                [scalar, packets].map(|s| Replicates::of(exhibit.name, &s, 192));
            scalar.assert_same(
                &format!("{}, limit {limit:?}", exhibit.name),
                &packets,
                RESOLUTION,
            );
        }
    }
}

#[test]
fn light_paths_agree_with_packets() {
    for (exhibit, seed) in media_only().iter().zip((6300..).step_by(10)) {
        let packets = replan(stage(&exhibit.text()), Integrator::Path, seed, None);
        let packets = Replicates::of(exhibit.name, &packets, 384);
        for (integrator, seed) in [(Integrator::Bdpt, seed + 1), (Integrator::Mlt, seed + 2)] {
            let other = exhibit.stage(integrator, seed);
            let other = Replicates::of(exhibit.name, &other, depth(integrator));
            let name = format!("{}, {}", exhibit.name, integrator.name());
            other.assert_same(&name, &packets, 0.02);
        }
    }
}

#[test]
fn an_unneeded_medium_of_no_density_changes_nothing() {
    // Vacuum that is tracked all the same.
    let world = around("");
    let nothing =
        uniform_grid("m", [2; 3], UNIT, |_| 1.0, &grey(1e-9, 0.5, 0.0)) + &block("m", "", UNIT);
    let pair = [world.clone(), world + &nothing].map(|world| Exhibit::new("vacuum", view(), world));
    for (integrator, seed) in [(Integrator::Path, 6400), (Integrator::Bdpt, 6410)] {
        let [a, b] = [(&pair[0], seed), (&pair[1], seed + 1)].map(|(exhibit, seed)| {
            Replicates::of(
                exhibit.name,
                &exhibit.stage(integrator, seed),
                depth(integrator),
            )
        });
        b.assert_same(integrator.name(), &a, RESOLUTION);
    }
}
