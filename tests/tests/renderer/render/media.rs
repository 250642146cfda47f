//! Media with more than a density: what they are at a place, against formulas written down again, and that nothing exceeds its bound.

mod bounds;
mod emission;
mod files;
mod refusals;

use glam::{DAffine3, DVec3};
use std::path::{Path, PathBuf};
use woodcock_core::majorant::{GridWalk, majorant_count};
use woodcock_core::medium::Medium as _;
use woodcock_core::path::{OneGrid, RecordKind};
use woodcock_core::ray::Ray;
use woodcock_core::real::Word32;
use woodcock_core::stream::{Key, PathStream, Stream};
use woodcock_core::vec3::Vec3;
use woodcock_host::scene::{
    self, Cloud, Emission, MediumKind, MemoryFiles, NamedMedium, NanoVdb, OpenVdb, Phase, RgbGrid,
    SceneError, Temperature, TemperatureValues, UniformGrid, Vol, blackbody_peak_one,
};
use woodcock_host::volume::{Limits, vdb, vol};
use woodcock_host::world::{self, EmissiveVoxel, Medium, PhaseFunction, World};
use woodcock_tests::pictures::*;

/// Where rendering has its origin.
const ORIGIN: DVec3 = DVec3::new(3.0, 1.0, -2.0);
const EXPOSURE: f64 = 2.0;

fn file(name: &str) -> Vec<u8> {
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR"))
        .join("data")
        .join(name);
    std::fs::read(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// A scene whose only medium is made otherwise, and what it comes to.
fn try_world(
    files: MemoryFiles,
    limits: Limits,
    change: impl FnOnce(&mut NamedMedium),
) -> Result<World, SceneError> {
    let camera = perspective([0.2, 0.1, -40.0], [0.0, 0.0, 1.0], 45.0);
    let body = homogeneous("m", &coloured([0.5, 1.5, 0.75], [0.5, 0.5, 2.25], 0.3))
        + &ball("m", "", ORIGIN.to_array(), 30.0);
    let text = scene(&camera, [2, 2], &(sky(1.0) + &body));
    let files = files.with("media.pbrt", text);
    let mut scene = scene::read(Path::new("media.pbrt"), &files, &scene::Options::default())?;
    scene.film.imaging_ratio = EXPOSURE;
    change(&mut scene.media[0]);
    let options = world::Options {
        limits,
        ..world::Options::default()
    };
    world::assemble(&scene, &files, &options)
}

#[track_caller]
fn world_with(files: MemoryFiles, change: impl FnOnce(&mut NamedMedium)) -> World {
    match try_world(files, Limits::default(), change) {
        Ok(world) => world,
        Err(error) => panic!("{}", error.report()),
    }
}

#[track_caller]
fn world_of(change: impl FnOnce(&mut NamedMedium)) -> World {
    world_with(MemoryFiles::new(), change)
}

#[track_caller]
fn assert_refused(words: &[&str], files: MemoryFiles, change: impl FnOnce(&mut NamedMedium)) {
    let error = match try_world(files, Limits::default(), change) {
        Ok(_) => panic!("this was to be refused: {words:?}"),
        Err(error) => error,
    };
    let report = error.report();
    assert!(error.place().is_some(), "a refusal has a place: {report}");
    for word in words {
        assert!(report.contains(word), "no {word:?} in {report}");
    }
}

#[track_caller]
fn near(name: &str, found: [f64; 3], expected: [f64; 3], relative: f64) {
    let scale = expected.into_iter().fold(1e-30, |a: f64, b| a.max(b.abs()));
    for c in 0..3 {
        assert!(
            (found[c] - expected[c]).abs() <= relative * scale,
            "{name}: {found:?}, expected {expected:?}"
        );
    }
}

/// Places spread over a box: an additive recurrence by the plastic number.
fn places(low: DVec3, high: DVec3, count: u32) -> impl Iterator<Item = DVec3> {
    (1..=count).map(move |n| {
        let u = DVec3::new(0.819_172_513_4, 0.671_043_606_7, 0.549_700_477_9) * f64::from(n);
        low + (high - low) * u.fract()
    })
}

/// Trilinear interpolation of values at integers, written down once more: products of hats.
fn hats(dims: [usize; 3], value: impl Fn([usize; 3]) -> f64, p: DVec3) -> f64 {
    let hat = |x: f64| (1.0 - x.abs()).max(0.0);
    let mut sum = 0.0;
    for z in 0..dims[2] {
        for y in 0..dims[1] {
            for x in 0..dims[0] {
                let d = p - DVec3::new(x as f64, y as f64, z as f64);
                sum += hat(d.x) * hat(d.y) * hat(d.z) * value([x, y, z]);
            }
        }
    }
    sum
}

/// Some numbers in [0, 1), told by their index.
fn scramble(n: usize) -> f32 {
    ((n.wrapping_mul(2_654_435_761) >> 7) % 1000) as f32 / 1000.0
}

const SIZE: [usize; 3] = [5, 4, 6];
const P0: DVec3 = DVec3::new(-1.0, 0.0, 2.0);
const P1: DVec3 = DVec3::new(1.5, 2.0, 3.0);

fn turned() -> DAffine3 {
    DAffine3::from_translation(DVec3::new(2.0, 1.5, -4.0))
        * DAffine3::from_axis_angle(DVec3::new(1.0, 2.0, 0.5).normalize(), 0.8)
        * DAffine3::from_scale(DVec3::new(2.0, 1.0, 1.5))
}

/// Where a place of the medium's space is in the rendered world.
fn rendered(p: DVec3) -> DVec3 {
    turned().transform_point3(p) - ORIGIN
}

/// Indices of the cells of the box, of which integers are centres.
fn in_cells(p: DVec3) -> DVec3 {
    (p - P0) / (P1 - P0) * DVec3::from_array(SIZE.map(|n| n as f64)) - 0.5
}

fn at([x, y, z]: [usize; 3]) -> usize {
    (z * SIZE[1] + y) * SIZE[0] + x
}

fn uniform(density: impl Fn(usize) -> f32) -> MediumKind {
    MediumKind::UniformGrid(UniformGrid {
        resolution: SIZE,
        density: (0..120).map(density).collect(),
        p0: P0,
        p1: P1,
    })
}

#[test]
fn what_packets_can_do_is_plain() {
    let world = world_of(|_| ());
    let medium = &world.media[0];
    assert!(medium.is_plain() && !medium.is_emissive() && !medium.has_samples());
    let local = medium.local(&world.tables, None, DVec3::ZERO);
    near("extinction", local.sigma_t, [1.0, 2.0, 3.0], 1e-6);
    near("albedo", local.albedo, [0.5, 0.25, 0.75], 1e-6);
    assert_eq!(local.emission, [0.0; 3]);
    let grid = world_of(|m| m.kind = uniform(scramble));
    assert!(grid.media[0].is_plain() && grid.media[0].has_samples());
    for (phase, plain) in [
        (Phase::Isotropic, true),
        (Phase::Rayleigh, true),
        (Phase::Draine { g: 0.3, alpha: 2.0 }, false),
        (Phase::Droplets { diameter: 9.0 }, false),
    ] {
        let world = world_of(|m| m.phase = phase);
        assert_eq!(world.media[0].is_plain(), plain, "{phase:?}");
        let same = PhaseFunction::new(&phase).expect("valid");
        assert_eq!(world.media[0].phase.eval(0.3), same.eval(0.3));
    }
    assert_refused(&["mean cosine"], MemoryFiles::new(), |m| {
        m.phase = Phase::TwoLobe {
            forward: 0.999_999_999_9,
            backward: 0.0,
            share: 0.5,
        };
    });
    // No light is no detail.
    let dark = world_of(|m| m.emission = Some(Emission::default()));
    assert!(dark.media[0].is_plain());
}

fn rgb(le: bool) -> RgbGrid {
    let list = |shift: usize| -> Vec<[f32; 3]> {
        (0..120)
            .map(|n| std::array::from_fn(|c| scramble(3 * n + c + shift)))
            .collect()
    };
    RgbGrid {
        resolution: SIZE,
        sigma_a: Some(list(0)),
        sigma_s: Some(list(1000)),
        le: le.then(|| list(2000)),
        p0: P0,
        p1: P1,
    }
}

#[test]
fn colours_by_voxel_are_interpolated_each() {
    let grid = rgb(true);
    let world = world_of(|m| {
        m.kind = MediumKind::RgbGrid(grid.clone());
        m.medium_to_world = turned();
    });
    let medium = &world.media[0];
    assert!(!medium.is_plain() && medium.is_chromatic() && medium.is_emissive());
    // The scene's coefficients are 0.5, 1.5, 0.75 and 0.5, 0.5, 2.25.
    let (a, s) = ([0.5, 1.5, 0.75], [0.5, 0.5, 2.25]);
    for p in places(P0, P1, 300) {
        let cells = in_cells(p);
        let of = |list: &Option<Vec<[f32; 3]>>| -> [f64; 3] {
            let list = list.as_ref().expect("a list");
            std::array::from_fn(|c| hats(SIZE, |i| f64::from(list[at(i)][c]), cells))
        };
        let (absorbed, scattered, le) = (of(&grid.sigma_a), of(&grid.sigma_s), of(&grid.le));
        let sigma_a: [f64; 3] = std::array::from_fn(|c| a[c] * absorbed[c]);
        let sigma_s: [f64; 3] = std::array::from_fn(|c| s[c] * scattered[c]);
        let local = medium.local(&world.tables, None, rendered(p));
        let sigma_t = std::array::from_fn(|c| sigma_a[c] + sigma_s[c]);
        near("extinction", local.sigma_t, sigma_t, 1e-5);
        let albedo = std::array::from_fn(|c| sigma_s[c] / (sigma_a[c] + sigma_s[c]));
        near("albedo", local.albedo, albedo, 1e-5);
        let source = std::array::from_fn(|c| sigma_a[c] * le[c] * EXPOSURE);
        near("source", local.emission, source, 1e-5);
    }
    // One sample tells all of a voxel; the rim has none of either.
    let RecordKind::Grid { dims, samples, .. } = medium.record.kind else {
        panic!("a grid");
    };
    assert_eq!(dims, [7, 6, 8]);
    for n in 0..dims.iter().product() {
        let [x, y, z] = [n % 7, n / 7 % 6, n / 42].map(|i| (i as usize).wrapping_sub(1));
        let local = medium.local(&world.tables, Some(samples + n), DVec3::ZERO);
        let inside = x < SIZE[0] && y < SIZE[1] && z < SIZE[2];
        let value = |list: &Option<Vec<[f32; 3]>>, c: usize| match (list, inside) {
            (Some(list), true) => f64::from(list[at([x, y, z])][c]),
            _ => 0.0,
        };
        let sigma_a: [f64; 3] = std::array::from_fn(|c| a[c] * value(&grid.sigma_a, c));
        let sigma_s: [f64; 3] = std::array::from_fn(|c| s[c] * value(&grid.sigma_s, c));
        near(
            "a tap",
            local.sigma_t,
            std::array::from_fn(|c| sigma_a[c] + sigma_s[c]),
            1e-6,
        );
        let product = std::array::from_fn(|c| local.sigma_t[c] * local.albedo[c]);
        near("a tap's scattering", product, sigma_s, 1e-6);
    }
}

#[test]
fn coefficients_that_are_not_listed_are_one_up_to_the_faces() {
    let grid = RgbGrid {
        sigma_s: None,
        ..rgb(false)
    };
    let world = world_of(|m| {
        m.kind = MediumKind::RgbGrid(grid);
        m.sigma_a = [0.0; 3];
        m.sigma_s = [1.0, 2.0, 4.0];
        m.medium_to_world = turned();
    });
    for p in places(P0, P1, 100) {
        let local = world.media[0].local(&world.tables, None, rendered(p));
        near("extinction", local.sigma_t, [1.0, 2.0, 4.0], 1e-6);
        assert_eq!(local.albedo, [1.0; 3]);
    }
}
