//! Media with more than a density: what they are at a place, against formulas written down again, and that nothing exceeds its bound.

use glam::{DAffine3, DVec3};
use std::path::{Path, PathBuf};
use woodcock_core::majorant::{GridWalk, majorant_count};
use woodcock_core::medium::Medium as _;
use woodcock_core::path::{OneGrid, RecordKind};
use woodcock_core::ray::Ray;
use woodcock_core::real::Word32;
use woodcock_core::stream::{Key, PathStream};
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

#[test]
fn a_homogeneous_medium_shines_everywhere_alike() {
    let world = world_of(|m| {
        m.emission = Some(Emission {
            scale: 3.0,
            le: [1.0, 2.0, 0.0],
            ..Emission::default()
        });
    });
    let medium = &world.media[0];
    assert!(!medium.is_plain() && medium.is_emissive());
    let local = medium.local(&world.tables, None, DVec3::ONE);
    // σ_a is 0.5, 1.5, 0.75.
    near(
        "source",
        local.emission,
        [0.5 * 6.0, 1.5 * 12.0, 0.0],
        1e-12,
    );
    assert!(medium.emissive_voxels(&world.tables).is_empty());
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

#[test]
fn what_does_not_absorb_sends_out_no_light() {
    let grid = rgb(true);
    let world = world_of(|m| {
        m.kind = MediumKind::RgbGrid(grid);
        m.sigma_a = [0.0; 3];
        m.medium_to_world = turned();
    });
    for p in places(P0, P1, 100) {
        let local = world.media[0].local(&world.tables, None, rendered(p));
        assert_eq!(local.emission, [0.0; 3]);
    }
    assert!(world.media[0].emissive_voxels(&world.tables).is_empty());
}

fn fire() -> (Vec<f32>, Vec<f32>, Emission) {
    let temperatures: Vec<f32> = (0..120)
        .map(|n| 300.0 + 2000.0 * scramble(n + 500))
        .collect();
    let scales: Vec<f32> = (0..120).map(|n| scramble(n + 900)).collect();
    let emission = Emission {
        scale: 1.5,
        le: [7.0; 3],
        scale_grid: Some(scales.clone()),
        temperature: Some(Temperature {
            values: TemperatureValues::Listed(temperatures.clone()),
            offset: 100.0,
            scale: 1.25,
        }),
    };
    (temperatures, scales, emission)
}

#[test]
fn fire_has_the_colour_of_its_interpolated_temperature() {
    let (temperatures, scales, emission) = fire();
    let world = world_of(|m| {
        m.kind = uniform(scramble);
        m.emission = Some(emission);
        m.medium_to_world = turned();
    });
    let medium = &world.media[0];
    let (mut lit, mut blackest) = (0, f64::INFINITY);
    for p in places(P0, P1, 300) {
        let cells = in_cells(p);
        let of = |list: &dyn Fn(usize) -> f32| hats(SIZE, |i| f64::from(list(at(i))), cells);
        let density = of(&scramble);
        let kelvin = (of(&|n| temperatures[n]) - 100.0) * 1.25;
        let le = blackbody_peak_one(kelvin);
        let factor = of(&|n| scales[n]) * 1.5 * EXPOSURE;
        let source = std::array::from_fn(|c| [0.5, 1.5, 0.75][c] * density * factor * le[c]);
        let local = medium.local(&world.tables, None, rendered(p));
        near("source", local.emission, source, 3e-5);
        lit += u32::from(kelvin > 900.0);
        blackest = blackest.min(kelvin);
    }
    assert!(lit > 100 && blackest < 700.0, "{lit} {blackest}");
}

#[test]
fn fire_of_a_file_lies_where_its_grids_lie() {
    let bytes = file("vdb/fire_160.vdb");
    let fire = vdb::read(&bytes, &Limits::default()).expect("a file");
    let grid = |name: &str| fire.grid(name).expect("a grid");
    let map = DAffine3::from_scale_rotation_translation(
        DVec3::splat(0.5),
        glam::DQuat::from_rotation_y(0.4),
        ORIGIN,
    );
    let world = world_with(MemoryFiles::new().with("fire.vdb", bytes.clone()), |m| {
        m.kind = MediumKind::OpenVdb(OpenVdb {
            filename: "fire.vdb".into(),
            gridname: "density".to_owned(),
        });
        m.emission = Some(Emission {
            scale: 1.0,
            temperature: Some(Temperature {
                values: TemperatureValues::Grid("temperature".to_owned()),
                offset: 0.0,
                scale: 1.0,
            }),
            ..Emission::default()
        });
        m.medium_to_world = map;
    });
    let medium = &world.media[0];
    let density = grid("density");
    let (low, high) = density
        .statistics()
        .expect("statistics")
        .active_bbox
        .expect("a box");
    let corner = |i: [i64; 3]| {
        density
            .transform
            .to_world(DVec3::from_array(i.map(|v| v as f64)))
    };
    let mut lit = 0;
    for p in places(corner(low), corner(high), 2000) {
        let [d, kelvin] =
            ["density", "temperature"].map(|name| grid(name).trilinear(0, p).expect("a value"));
        let le = blackbody_peak_one(if kelvin > 100.0 { kelvin } else { 0.0 });
        let source: [f64; 3] = std::array::from_fn(|c| [0.5, 1.5, 0.75][c] * d * le[c] * EXPOSURE);
        let local = medium.local(&world.tables, None, map.transform_point3(p) - ORIGIN);
        let scale = source.into_iter().fold(0.0, f64::max);
        // Places in single precision move densities by as much as they change in a thousandth of a voxel.
        if d > 0.05 && scale > 1e-9 {
            near("extinction", local.sigma_t, [d, 2.0 * d, 3.0 * d], 1e-3);
            near("source", local.emission, source, 1e-2);
            lit += 1;
        }
    }
    assert!(lit > 200, "{lit}");
    assert!(!medium.emissive_voxels(&world.tables).is_empty());
}

/// The places of the medium's space that shine and lie in no voxel of a list.
fn missed(medium: &Medium, world: &World, voxels: &[EmissiveVoxel]) -> usize {
    let to_grid = medium.world_to_grid().expect("a grid");
    places(P0, P1, 4000)
        .filter(|p| {
            let place = rendered(*p);
            let shines = medium.local(&world.tables, None, place).emission != [0.0; 3];
            let grid = to_grid.transform_point3(place);
            let within = |v: &EmissiveVoxel| {
                let slack = 1e-4;
                grid.cmpge(v.low - slack).all()
                    && grid.cmple(v.high + slack).all()
                    && v.source.iter().any(|s| *s > 0.0)
            };
            shines && !voxels.iter().any(within)
        })
        .count()
}

#[test]
fn voxels_that_shine_hold_all_light() {
    // A few voxels with matter, in a corner too, and fire that is dark at most samples.
    let density = |n: usize| {
        if [0, 33, 34, 77, 119].contains(&n) {
            1.0
        } else {
            0.0
        }
    };
    let (_, _, emission) = fire();
    let constant = Emission {
        scale: 2.0,
        le: [1.0, 0.5, 0.25],
        ..Emission::default()
    };
    for (name, emission) in [("constant", constant), ("fire", emission)] {
        let world = world_of(|m| {
            m.kind = uniform(density);
            m.emission = Some(emission);
            m.medium_to_world = turned();
        });
        let medium = &world.media[0];
        let voxels = medium.emissive_voxels(&world.tables);
        assert_eq!(missed(medium, &world, &voxels), 0, "{name}");
        // Without the voxels whose own sample is empty some light would have no voxel.
        let RecordKind::Grid { samples, .. } = medium.record.kind else {
            panic!("a grid");
        };
        let own = |v: &&EmissiveVoxel| world.tables.samples[(samples + v.index) as usize] > 0.0;
        let fewer: Vec<_> = voxels.iter().filter(own).copied().collect();
        assert!(missed(medium, &world, &fewer) > 50, "{name}");
        // Boxes do not overlap, and lie within the medium.
        for (i, a) in voxels.iter().enumerate() {
            for b in &voxels[..i] {
                let apart = a.low.cmpge(b.high).any() || b.low.cmpge(a.high).any();
                assert!(apart, "{name}: {a:?} {b:?}");
            }
        }
        // Their light together is that of the medium: of the box, by midpoints.
        const N: u32 = 40;
        let mut whole = [0.0; 3];
        let volume = turned().matrix3.determinant().abs() * (P1 - P0).element_product();
        for i in 0..N * N * N {
            let u = [i % N, i / N % N, i / N / N].map(|i| (f64::from(i) + 0.5) / f64::from(N));
            let p = P0 + (P1 - P0) * DVec3::from_array(u);
            let source = medium.local(&world.tables, None, rendered(p)).emission;
            for c in 0..3 {
                whole[c] += source[c] * volume / f64::from(N * N * N);
            }
        }
        let voxel = medium
            .grid_to_world()
            .expect("a grid")
            .matrix3
            .determinant()
            .abs();
        let of = |c: usize| -> f64 {
            let light =
                |v: &EmissiveVoxel| v.source[c] * (v.high - v.low).element_product() * voxel;
            voxels.iter().map(light).sum()
        };
        // Exact for densities; a black body is no linear function, and this fire changes by half from voxel to voxel.
        let bound = if name == "constant" { 2e-3 } else { 0.3 };
        near(name, [of(0), of(1), of(2)], whole, bound);
    }
}

/// The density of pbrt's cloud at places, by a program of its own in another language, from pbrt's description: place,
/// (density, wispiness, frequency), value.
const CLOUDS: [([f64; 3], [f64; 3], f64); 14] = [
    (
        [0.651593, 0.952106, -0.087368],
        [1.0, 1.0, 5.0],
        0.000000000000000,
    ),
    (
        [0.762280, 0.401474, 0.334465],
        [1.0, 1.0, 5.0],
        0.277096220764104,
    ),
    (
        [0.762280, 0.401474, 0.334465],
        [0.4, 0.0, 7.5],
        0.360215225864899,
    ),
    (
        [0.762280, 0.401474, 0.334465],
        [2.0, 0.5, 3.0],
        0.355909458182979,
    ),
    (
        [0.721540, 0.560134, 0.934325],
        [1.0, 1.0, 5.0],
        0.415257587680951,
    ),
    (
        [0.721540, 0.560134, 0.934325],
        [0.4, 0.0, 7.5],
        0.133310374192572,
    ),
    (
        [0.721540, 0.560134, 0.934325],
        [2.0, 0.5, 3.0],
        0.313923869550941,
    ),
    (
        [0.901427, 0.421413, -0.169465],
        [1.0, 1.0, 5.0],
        0.157174000000000,
    ),
    (
        [0.901427, 0.421413, -0.169465],
        [0.4, 0.0, 7.5],
        0.266594646154478,
    ),
    (
        [0.901427, 0.421413, -0.169465],
        [2.0, 0.5, 3.0],
        0.352127968809232,
    ),
    (
        [0.541412, 1.057404, 0.257445],
        [2.0, 0.5, 3.0],
        0.000000000000000,
    ),
    (
        [0.221692, 0.706521, 0.394975],
        [1.0, 1.0, 5.0],
        0.393630210390610,
    ),
    (
        [0.221692, 0.706521, 0.394975],
        [0.4, 0.0, 7.5],
        0.101541915898365,
    ),
    (
        [0.221692, 0.706521, 0.394975],
        [2.0, 0.5, 3.0],
        0.465306140254330,
    ),
];

fn cloud([density, wispiness, frequency]: [f64; 3]) -> World {
    world_of(|m| {
        m.kind = MediumKind::Cloud(Cloud {
            density,
            wispiness,
            frequency,
            p0: DVec3::splat(-0.25),
            p1: DVec3::splat(1.125),
        });
        m.medium_to_world = turned();
    })
}

#[test]
fn clouds_are_pbrts() {
    for (p, parameters, expected) in CLOUDS {
        let world = cloud(parameters);
        let medium = &world.media[0];
        assert!(!medium.is_plain() && !medium.has_samples());
        let local = medium.local(&world.tables, None, rendered(DVec3::from_array(p)));
        near(
            "cloud",
            local.sigma_t,
            [expected, 2.0 * expected, 3.0 * expected],
            1e-6,
        );
        near("albedo", local.albedo, [0.5, 0.25, 0.75], 1e-6);
    }
}

/// Walks rays through a medium's blocks; the largest of its extinction by the bound that was given for it, in millionths,
/// and how many look-ups there were.
fn largest_share(
    world: &World,
    shrink: f32,
    sigma_t: impl Fn(&GridWalk<f32>, f32, DVec3) -> f64,
) -> (f64, u32) {
    let medium = &world.media[0];
    let majorants: Vec<f32> = world.tables.majorants.iter().map(|m| m * shrink).collect();
    let walker = OneGrid::new(&medium.record, &world.tables.samples, &majorants);
    let support = medium.support.as_ref().expect("a box");
    let from_local = support.to_local.inverse();
    let ends: Vec<DVec3> = places(DVec3::ZERO, support.size, 400)
        .map(|p| from_local.transform_point3(p))
        .collect();
    let (mut share, mut looked_up) = (0.0_f64, 0);
    for pair in ends.windows(2) {
        let (from, to) = (pair[0].as_vec3(), pair[1].as_vec3());
        let length = (to - from).length();
        let direction = (to - from) / length;
        let ray: Ray<f32> = Ray {
            origin: Vec3::splat(from.to_array()),
            direction: Vec3::splat(direction.to_array()),
        };
        let mut walk = GridWalk::idle();
        walker.begin(&mut walk, &ray, true);
        let mut t = 0.0_f32;
        while t < length {
            let segment = walk.segment();
            let end = segment.t_exit.min(length);
            for i in 0..8_u8 {
                let s = t + (end - t) * f32::from(i) / 7.0;
                let place = from.as_dvec3() + direction.as_dvec3() * f64::from(s);
                let found = sigma_t(&walk, s, place);
                looked_up += 1;
                if found > 0.0 {
                    share = share.max(found / f64::from(segment.majorant));
                }
            }
            t = segment.t_exit;
            walk.next_segment(&majorants, true);
        }
    }
    (share, looked_up)
}

#[test]
fn clouds_stay_within_their_bounds() {
    let mut saved = false;
    for parameters in [[1.0, 1.0, 5.0], [0.4, 0.0, 7.5], [0.1, 0.3, 11.0]] {
        let world = cloud(parameters);
        let medium = &world.media[0];
        let field = medium.cloud_field(&world.tables).expect("a cloud");
        let look_up = |walk: &GridWalk<f32>, t: f32, place: DVec3| {
            let mut none = PathStream::new(Key::default());
            let walked = f64::from(field.sigma_t(walk, t, &mut none, true));
            let [.., local] = medium.local(&world.tables, None, place).sigma_t;
            // Both are the density of about one place.
            assert!((walked - local).abs() < 2e-3, "{walked} {local}");
            walked.max(local)
        };
        let (share, looked_up) = largest_share(&world, 1.0, look_up);
        assert!(
            share <= 1.0 && looked_up > 10_000,
            "{parameters:?}: {share}, {looked_up}"
        );
        assert!(share > 0.5, "the bounds are far too high: {share}");
        // Bounds half as high are exceeded: the check sees.
        let (share, _) = largest_share(&world, 0.5, look_up);
        assert!(share > 1.0, "{share}");
        let RecordKind::Grid {
            dims, majorants, ..
        } = medium.record.kind
        else {
            panic!("a grid of layers");
        };
        let first = majorants as usize;
        let bounds = &world.tables.majorants[first..first + majorant_count(dims).expect("few")];
        assert!(bounds.iter().all(|b| (0.0..=1.0).contains(b)));
        saved |= bounds.iter().any(|b| 0.0 < *b && *b < 0.5);
    }
    assert!(saved, "no layer is thinner than another");
}

#[test]
fn no_colour_of_a_voxel_exceeds_its_bound() {
    let world = world_of(|m| {
        m.kind = MediumKind::RgbGrid(rgb(true));
        m.medium_to_world = turned();
    });
    let medium = &world.media[0];
    let stream = std::cell::RefCell::new(PathStream::new(Key::default()));
    let look_up = |walk: &GridWalk<f32>, t: f32, place: DVec3| {
        let Word32(tap) = walk.tap(t, &mut *stream.borrow_mut(), true);
        let largest = |tap| {
            let local = medium.local(&world.tables, tap, place);
            local.sigma_t.into_iter().fold(0.0, f64::max)
        };
        largest(Some(tap)).max(largest(None))
    };
    let (share, looked_up) = largest_share(&world, 1.0, look_up);
    assert!(
        share <= 1.0 && share > 0.9 && looked_up > 3000,
        "{share} {looked_up}"
    );
    let (share, _) = largest_share(&world, 0.9, look_up);
    assert!(share > 1.0, "{share}");
}

fn mitsuba(density: &str, albedo: Option<&str>) -> (MemoryFiles, MediumKind) {
    let mut files = MemoryFiles::new();
    for name in [Some(density), albedo].into_iter().flatten() {
        files = files.with(name, file(&format!("vol/{name}")));
    }
    let kind = MediumKind::Vol(Vol {
        filename: density.into(),
        albedo: albedo.map(PathBuf::from),
    });
    (files, kind)
}

#[test]
fn mitsubas_grids_fill_the_unit_cube() {
    let (files, kind) = mitsuba("density_f32.vol", Some("albedo_rgb_f32.vol"));
    let grid =
        |name: &str| vol::read(&file(&format!("vol/{name}")), &Limits::default()).expect("a grid");
    let (density, albedo) = (grid("density_f32.vol"), grid("albedo_rgb_f32.vol"));
    let world = world_with(files, |m| {
        m.kind = kind;
        m.medium_to_world = turned();
        m.emission = Some(Emission {
            scale: 1.0,
            le: [1.0, 2.0, 3.0],
            ..Emission::default()
        });
    });
    let medium = &world.media[0];
    assert!(!medium.is_plain());
    for p in places(DVec3::ZERO, DVec3::ONE, 500) {
        let p = p.clamp(DVec3::splat(1e-4), DVec3::splat(1.0 - 1e-4));
        let local = medium.local(&world.tables, None, rendered(p));
        let d = density.trilinear(0, p.to_array());
        near("extinction", local.sigma_t, [d, 2.0 * d, 3.0 * d], 2e-5);
        let colour: [f64; 3] = std::array::from_fn(|c| albedo.trilinear(c, p.to_array()));
        near("albedo", local.albedo, colour, 1e-9);
        let source = std::array::from_fn(|c| {
            let weight = (c + 1) as f64;
            weight * d * (1.0 - colour[c]) * weight * EXPOSURE
        });
        near("source", local.emission, source, 1e-4);
    }
    // Without an albedo of its own it is a plain grid.
    let (files, kind) = mitsuba("density_u8.vol", None);
    let world = world_with(files, |m| m.kind = kind);
    assert!(world.media[0].is_plain());
}

#[test]
fn nanovdb_is_openvdb_to_the_bit() {
    let open = world_with(
        MemoryFiles::new().with("c.vdb", file("vdb/quantised_blosc.vdb")),
        |m| {
            m.kind = MediumKind::OpenVdb(OpenVdb {
                filename: "c.vdb".into(),
                gridname: "density".to_owned(),
            });
        },
    );
    let nano = world_with(
        MemoryFiles::new().with("c.nvdb", file("nvdb/multi.nvdb")),
        |m| {
            m.kind = MediumKind::NanoVdb(NanoVdb {
                filename: "c.nvdb".into(),
                gridname: "density".to_owned(),
            });
            m.emission = Some(Emission {
                scale: 1.0,
                temperature: Some(Temperature {
                    values: TemperatureValues::Grid("temperature".to_owned()),
                    offset: 0.0,
                    scale: 5.0,
                }),
                ..Emission::default()
            });
        },
    );
    assert_eq!(open.tables.samples, nano.tables.samples);
    assert_eq!(open.tables.majorants, nano.tables.majorants);
    assert!(open.media[0].is_plain() && !nano.media[0].is_plain());
    // Its temperature is 300 plus its density where there is any: about 1503 K.
    let lit = nano.media[0].emissive_voxels(&nano.tables);
    assert!(lit.len() > 5000, "{}", lit.len());
}

#[test]
fn what_is_wrong_is_refused_where_it_is() {
    let none = MemoryFiles::new;
    let wrong = |change: &dyn Fn(&mut RgbGrid)| {
        let mut grid = rgb(true);
        change(&mut grid);
        MediumKind::RgbGrid(grid)
    };
    let negative = wrong(&|g| {
        if let Some(list) = &mut g.sigma_a {
            list[17][1] = -1.0;
        }
    });
    assert_refused(&["sigma_a", "voxel 17", "not negative"], none(), |m| {
        m.kind = negative
    });
    let short = wrong(&|g| {
        if let Some(list) = &mut g.sigma_s {
            list.pop();
        }
    });
    assert_refused(&["too few values of sigma_s"], none(), |m| m.kind = short);
    let dark = wrong(&|g| {
        if let Some(list) = &mut g.le {
            list[3][2] = f32::NAN;
        }
    });
    assert_refused(&["Le is NaN"], none(), |m| m.kind = dark);
    let heat = |values: Vec<f32>| Emission {
        scale: 1.0,
        temperature: Some(Temperature {
            values: TemperatureValues::Listed(values),
            offset: 0.0,
            scale: 1.0,
        }),
        ..Emission::default()
    };
    assert_refused(&["119 values", "5 x 4 x 6"], none(), |m| {
        m.kind = uniform(scramble);
        m.emission = Some(heat(vec![900.0; 119]));
    });
    assert_refused(&["temperature is inf"], none(), |m| {
        m.kind = uniform(scramble);
        m.emission = Some(heat(vec![f32::INFINITY; 120]));
    });
    assert_refused(&["by voxel need a grid"], none(), |m| {
        m.emission = Some(heat(vec![900.0]))
    });
    assert_refused(&["scale of emission is -2"], none(), |m| {
        m.emission = Some(Emission {
            scale: -1.0,
            le: [1.0; 3],
            ..Emission::default()
        });
    });
    let c = Cloud {
        density: 1.0,
        wispiness: 1.0,
        frequency: 5.0,
        p0: DVec3::ZERO,
        p1: DVec3::ONE,
    };
    let clouds: [(&[&str], Cloud); 2] = [
        (
            &["wispiness is NaN"],
            Cloud {
                wispiness: f64::NAN,
                ..c
            },
        ),
        (
            &["no inside"],
            Cloud {
                p1: DVec3::ZERO,
                ..c
            },
        ),
    ];
    for (words, cloud) in clouds {
        assert_refused(words, none(), |m| m.kind = MediumKind::Cloud(cloud));
    }
    for (density, albedo, words) in [
        ("albedo_rgb_f32.vol", None, &["3 channel(s) where 1"][..]),
        (
            "density_f32.vol",
            Some("density_f32.vol"),
            &["1 channel(s) where 3"],
        ),
        (
            "bad_value.vol",
            None,
            &["bad_value.vol", "(3, 0, 0)", "NaN"],
        ),
        ("bad_truncated.vol", None, &["bad_truncated.vol", "908"]),
    ] {
        let (files, kind) = mitsuba(density, albedo);
        assert_refused(words, files, |m| m.kind = kind);
    }
    let nano = |grid: &str| {
        MediumKind::NanoVdb(NanoVdb {
            filename: "m.nvdb".into(),
            gridname: grid.to_owned(),
        })
    };
    let multi = || MemoryFiles::new().with("m.nvdb", file("nvdb/multi.nvdb"));
    assert_refused(&["no grid \"smoke\"", "\"temperature\""], multi(), |m| {
        m.kind = nano("smoke")
    });
    assert_refused(&["no grid \"heat\""], multi(), |m| {
        m.kind = nano("density");
        let mut emission = heat(Vec::new());
        if let Some(temperature) = &mut emission.temperature {
            temperature.values = TemperatureValues::Grid("heat".to_owned());
        }
        m.emission = Some(emission);
    });
    let cut = MemoryFiles::new().with("m.nvdb", &file("nvdb/multi.nvdb")[..30_000]);
    assert_refused(&["m.nvdb", "truncated"], cut, |m| {
        m.kind = nano("temperature")
    });
}

#[test]
fn memory_is_counted_for_every_number_of_a_voxel() {
    // 336 voxels with the rim: 1344 bytes as densities, seven times as many by colour.
    let limits = Limits { max_memory: 9000 };
    assert!(try_world(MemoryFiles::new(), limits, |m| m.kind = uniform(scramble)).is_ok());
    let error = try_world(MemoryFiles::new(), limits, |m| {
        m.kind = MediumKind::RgbGrid(rgb(false))
    });
    assert!(error.expect_err("a limit").report().contains("limit"));
}
