//! Surfaces among media in packets, met through a queue: the pictures of the scalar path tracer, the bits of scalar code,
//! furnaces, and what is left to scalar code.

use woodcock_host::film::Film;
use woodcock_host::integrator::Integrator;
use woodcock_host::render::Kernel;
use woodcock_host::world::Feature;
use woodcock_tests::gallery::*;
use woodcock_tests::pictures::*;
use woodcock_tests::replicates::Replicates;
use woodcock_tests::stats::must_kill;

/// Relative standard error that comparisons must reach.
const RESOLUTION: f64 = 0.02;
/// Of scalar code.
const SAMPLES: u32 = 512;

const GLASS: &str = "Material \"dielectric\" \"float eta\" 1.5";
const METAL: &str = "Material \"conductor\" \"float roughness\" 0.2";

fn ground() -> String {
    floor(&diffuse([0.6, 0.5, 0.4]))
}

/// A sun and a sky.
fn day() -> String {
    sun([1.0, 1.5, -1.0], [1.6, 1.4, 1.2]) + &sky(0.4)
}

/// A cloud of structure within the unit block.
fn cloud(matter: &Matter) -> String {
    uniform_grid("cloud", [9, 8, 7], UNIT, lumps, matter) + &block("cloud", "", UNIT)
}

/// A mesh that is no room's: a tent of a rough metal, with more pieces than are told apart.
fn tent() -> String {
    with_material(METAL, &block_mesh([[0.5, -1.0, -1.6], [1.1, -0.3, -1.1]]))
}

fn scenes() -> Vec<Exhibit> {
    let smoke = coloured([0.2, 0.5, 1.2], [2.0, 1.2, 0.6], 0.4);
    let tinted = coloured([0.2, 0.2, 0.25], [1.5, 1.4, 1.5], 0.3);
    let through = perspective([0.0, 0.4, -3.0], [0.0, -0.1, 1.0], 40.0);
    vec![
        Exhibit::new(
            "a cloud above a ground",
            front(),
            day() + &ground() + &cloud(&grey(3.0, 0.95, 0.6)),
        ),
        Exhibit::new(
            "coloured smoke around glass and metal",
            front(),
            day()
                + &ground()
                + &sphere(GLASS, [-0.4, -0.2, -0.2], 0.45)
                + &sphere(METAL, [0.5, -0.5, 0.1], 0.4)
                + &cloud(&smoke),
        )
        .limited(12),
        Exhibit::new(
            "tinted smoke in one path",
            front(),
            day() + &ground() + &sphere(&diffuse([0.2, 0.6, 0.7]), [0.2, 0.1, 0.0], 0.4) + &cloud(&tinted),
        ),
        Exhibit::new(
            "a box of fog with things half inside",
            front(),
            day()
                + &ground()
                + &sphere(METAL, [-0.9, 0.0, -0.2], 0.5)
                + &tent()
                + &sphere(&diffuse([0.7, 0.2, 0.2]), [0.3, 0.9, 0.0], 0.4)
                + &homogeneous("fog", &grey(1.2, 0.9, 0.3))
                + &block("fog", "", [[-1.0, -1.0, -1.2], [1.0, 1.0, 1.0]]),
        ),
        Exhibit::new(
            "a ball seen through haze that fills space",
            format!("MediumInterface \"\" \"haze\"\n{through}"),
            "MediumInterface \"\" \"\"\n".to_owned()
                + &sky(0.8)
                + &sun([0.5, 1.0, -0.6], [1.0; 3])
                + &homogeneous("haze", &coloured([0.05, 0.06, 0.08], [0.12; 3], 0.5))
                + &sphere(METAL, [0.0; 3], 0.7)
                + &ball("haze", "", [0.0; 3], 9.0),
        ),
        Exhibit::new(
            "media that overlap around a mesh and in glass",
            front() + " \"float lensradius\" 0.1 \"float focaldistance\" 4",
            day()
                + &ground()
                + &tent()
                + &homogeneous("fog", &grey(0.4, 0.8, 0.3))
                + &homogeneous("milk", &coloured([0.1; 3], [4.0; 3], 0.2))
                + &uniform_grid("cloud", [9, 8, 7], UNIT, lumps, &grey(2.0, 0.9, 0.5))
                + &ball("fog", "", [0.0, 0.1, 0.0], 1.6)
                + &block("cloud", "", UNIT)
                + &in_glass("milk", "", [-1.2, -0.5, -1.0], 0.4),
        )
        .limited(16),
        Exhibit::new(
            "instances and a texture in a cloud under two suns",
            front(),
            sun([1.0, 1.5, -1.0], [1.0, 0.9, 0.8])
                + &sun([-1.0, 0.8, -0.4], [0.3, 0.5, 0.9])
                + "Texture \"tiles\" \"spectrum\" \"imagemap\" \"string filename\" \"tiles.exr\" \"float uscale\" 2\n"
                + &floor("Material \"diffuse\" \"texture reflectance\" \"tiles\"")
                + "ObjectBegin \"two\"\n"
                + &sphere(&diffuse([0.7, 0.3, 0.2]), [0.0; 3], 0.3)
                + &with_material(METAL, &block_mesh([[-0.2, 0.3, -0.2], [0.3, 0.7, 0.2]]))
                + "ObjectEnd\nAttributeBegin Translate -0.5 -0.3 0 ObjectInstance \"two\" AttributeEnd\n\
                   AttributeBegin Translate 0.6 0 0.2 Rotate 40 0 1 0 Scale 1.2 0.8 1 ObjectInstance \"two\" AttributeEnd\n"
                + &cloud(&rayleigh(1.5, 0.9)),
        )
        .with_pictures(),
    ]
}

fn staged(exhibit: &Exhibit, keep: &[Feature], integrator: Integrator, seed: u64) -> Studio {
    let studio = stage_with(&exhibit.text(), exhibit.files.clone(), keep);
    replan(studio, integrator, seed, exhibit.max_depth)
}

fn is_queued(studio: &Studio) -> bool {
    let queued = studio.world.needs.runs(Feature::SurfaceQueue);
    assert_eq!(queued, studio.plan.in_packets(&studio.world));
    queued
}

/// By the scalar integrators.
fn scalar(exhibit: &Exhibit, integrator: Integrator, seed: u64) -> Replicates {
    let studio = staged(exhibit, &[Feature::DetailedSurfaces], integrator, seed);
    assert!(!studio.plan.in_packets(&studio.world), "{}", exhibit.name);
    Replicates::of(exhibit.name, &studio, SAMPLES)
}

/// By packets.
fn packets(exhibit: &Exhibit, keep: &[Feature], seed: u64) -> Replicates {
    let studio = staged(exhibit, keep, Integrator::Path, seed);
    assert!(
        is_queued(&studio),
        "{}:\n{}",
        exhibit.name,
        studio.world.needs
    );
    Replicates::of(exhibit.name, &studio, SAMPLES * 2)
}

#[test]
fn packets_see_what_scalar_integrators_see() {
    for (exhibit, seed) in scenes().iter().zip((9000..).step_by(10)) {
        let path = scalar(exhibit, Integrator::Path, seed);
        for (keep, seed) in [
            &[][..],
            &[Feature::IndependentSamples],
            &[Feature::EnvironmentNextEvent, Feature::FaintShadowRays],
        ]
        .into_iter()
        .zip(seed + 1..)
        {
            let queued = packets(exhibit, keep, seed);
            queued.assert_same(exhibit.name, &path, RESOLUTION);
        }
    }
}

#[test]
fn scalar_code_has_the_bits_of_packets() {
    for (exhibit, seed) in scenes().iter().zip(9100..) {
        for keep in [
            &[][..],
            &[Feature::IndependentSamples],
            &[Feature::EnvironmentNextEvent],
        ] {
            let film = |kernel: Kernel, passes: &[std::ops::Range<u32>]| -> Film {
                let mut studio = staged(exhibit, keep, Integrator::Path, seed);
                assert!(is_queued(&studio), "{}", exhibit.name);
                studio.plan.kernel = kernel;
                studio.shoot_passes(passes).film
            };
            let whole = film(Kernel::Packet, std::slice::from_ref(&(0..32)));
            let same = |other: Film| assert!(whole == other, "{}, {keep:?}", exhibit.name);
            assert!(whole.pixels().any(|(.., p)| p.mean()[1] > 0.0));
            same(film(Kernel::Scalar, std::slice::from_ref(&(0..32))));
            same(film(Kernel::Packet, &[16..32, 0..16]));
            assert!(whole != film(Kernel::Packet, std::slice::from_ref(&(32..64))));
        }
    }
}

/// Nothing absorbs, and light of radiance 1 comes from everywhere: every picture is 1. Paths that only the sky ends bring exactly that,
/// but for the rounding of what surfaces reflect.
#[test]
fn furnaces_are_white() {
    let white = |sigma_s: f64| coloured([0.0; 3], [sigma_s; 3], 0.4);
    let things = floor(&diffuse([1.0; 3]))
        + &sphere(&diffuse([1.0; 3]), [-0.6, 0.3, 0.0], 0.5)
        + &sphere(GLASS, [0.4, 0.1, -0.6], 0.5)
        + &in_glass("grid", "", [0.9, -0.4, 0.3], 0.4);
    let grid = uniform_grid("grid", [9, 8, 7], UNIT, lumps, &white(2.0));
    let exhibits = [
        Exhibit::new(
            "white things in a white cloud",
            front(),
            sky(1.0) + &grid + &things + &block("grid", "", [[-1.0; 3], [1.0, 0.5, 1.0]]),
        ),
        Exhibit::new(
            "white things in white media that overlap",
            front(),
            sky(1.0)
                + &grid
                + &things
                + &homogeneous("fog", &white(0.7))
                + &block("grid", "", [[-1.0, -1.0, -1.0], [1.0, 0.5, 1.0]])
                + &ball("fog", "", [0.0; 3], 1.2),
        ),
    ];
    for (exhibit, seed) in exhibits.iter().zip((9200..).step_by(10)) {
        let studio = staged(exhibit, &[], Integrator::Path, seed);
        assert!(is_queued(&studio), "{}", exhibit.name);
        let picture = studio.shoot_range(0..64);
        picture.assert_sound(exhibit.name);
        for (x, y, pixel) in picture.film.pixels() {
            for value in pixel.mean() {
                let off = (value - 1.0).abs();
                assert!(off < 1e-5, "{}: {value} at ({x}, {y})", exhibit.name);
            }
        }
        // Where the sky is sampled, too, each path brings 1 on average only.
        let sampled = packets(exhibit, &[Feature::EnvironmentNextEvent], seed + 1);
        sampled.assert_same(exhibit.name, &sampled.known(1.0), 0.005);
        must_kill(exhibit.name, sampled.strongest(&sampled.known(1.02), 0.005));
    }
}

/// White walls around everything, from which no path escapes: all end.
#[test]
fn paths_that_lose_nothing_end() {
    let world = sky(1.0)
        + &homogeneous("fog", &coloured([0.0; 3], [0.5; 3], 0.0))
        + &sphere(&diffuse([1.0; 3]), [0.0; 3], 2.0)
        + &sphere(METAL, [9.0, 0.0, 0.0], 1.0)
        + &ball("fog", "", [0.0; 3], 1.0);
    let view = perspective([0.0, 0.0, -1.5], [0.0, 0.0, 1.0], 60.0);
    let exhibit = Exhibit::new("a white ball from within", view, world);
    let mut studio = staged(&exhibit, &[], Integrator::Path, 9300);
    assert!(is_queued(&studio));
    studio.world.window.x1 = 1;
    studio.world.window.y1 = 1;
    let picture = studio.shoot_range(0..4);
    assert_eq!(picture.counts.paths, 4);
    for (.., pixel) in picture.film.pixels() {
        assert_eq!(pixel.mean(), [0.0; 3], "a leak");
    }
}

/// A closed box in fog that is lit from everywhere without: no path that begins within comes out, however near to a wall it collides, and
/// no shadow ray does.
#[test]
fn walls_do_not_leak() {
    let walls = with_material(
        &diffuse([0.8; 3]),
        &format!(
            "Rotate 20 1 1 0\nTranslate 0.1 0.2 0.3\n{}",
            block_mesh([[-1.0; 3], [1.0; 3]])
        ),
    );
    let world = "MediumInterface \"\" \"\"\n".to_owned()
        + &day()
        + &walls
        + &sphere(METAL, [0.0, -0.3, 0.8], 0.3)
        + &homogeneous("haze", &grey(2.0, 0.9, 0.8))
        + &ball("haze", "", [0.1, 0.2, 0.3], 1.8);
    let view = perspective([0.0, 0.0, -0.3], [0.0, 0.0, 1.0], 90.0);
    let camera = format!("MediumInterface \"\" \"haze\"\n{view}");
    let exhibit = Exhibit::new("a closed box", camera, world);
    let studio = staged(&exhibit, &[], Integrator::Path, 9400);
    assert!(is_queued(&studio));
    let picture = studio.shoot_range(0..256);
    assert!(picture.counts.real_collisions > 100_000);
    for (x, y, pixel) in picture.film.pixels() {
        assert_eq!(pixel.mean(), [0.0; 3], "light at ({x}, {y})");
        assert_eq!(pixel.alpha(), 1.0, "a hole at ({x}, {y})");
    }
}

/// The same with walls of two flat triangles each, so far from the origin that single precision ends at 10⁻⁴: flights that have just left
/// a wall, for which no surface is ahead, collide nearer to it than that.
#[test]
fn flat_walls_do_not_leak() {
    const FAR: f64 = 1024.5;
    let wall = |axis: usize, level: f64| {
        let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
        let mut points = String::new();
        for [u, v] in corners {
            let mut corner = [0.0; 3];
            corner[axis] = level;
            corner[(axis + 1) % 3] = u * FAR;
            corner[(axis + 2) % 3] = v * FAR;
            let [x, y, z] = corner;
            points += &format!(" {x} {y} {z}");
        }
        with_material(
            &diffuse([0.8; 3]),
            &format!(
                "Shape \"trianglemesh\" \"point3 P\" [{points}] \"integer indices\" [ 0 1 2 0 2 3 ]"
            ),
        )
    };
    let walls: String = (0..3)
        .flat_map(|axis| [wall(axis, -FAR), wall(axis, FAR)])
        .collect();
    let world = "MediumInterface \"\" \"\"\n".to_owned()
        + &day()
        + &walls
        + &sphere(METAL, [0.0, -0.3, 0.0], 0.3)
        + &homogeneous("haze", &grey(30.0, 0.9, 0.0))
        // Of which little is without, so that what leaks is seen.
        + &block("haze", "", [[-FAR - 0.03; 3], [FAR + 0.03; 3]]);
    let view = perspective([0.0, 0.0, 1024.48], [0.0, 0.3, 1.0], 90.0);
    let camera = format!("MediumInterface \"\" \"haze\"\n{view}");
    let exhibit = Exhibit::new("a closed hall", camera, world);
    let studio = staged(&exhibit, &[], Integrator::Path, 9410);
    assert!(is_queued(&studio));
    let picture = studio.shoot_range(0..256);
    assert!(picture.counts.real_collisions > 100_000);
    for (x, y, pixel) in picture.film.pixels() {
        assert_eq!(pixel.mean(), [0.0; 3], "light at ({x}, {y})");
    }
}

/// Of each kind of mistake the comparisons see one.
#[test]
fn mistakes_among_surfaces_are_seen() {
    let right = &scenes()[1];
    let reference = packets(right, &[], 9500);
    let changed = |from: &str, to: &str| {
        assert!(right.world.contains(from), "{from}");
        let world = right.world.replacen(from, to, 1);
        Exhibit {
            world,
            ..right.clone()
        }
    };
    for (name, wrong) in [
        ("reflectance", changed("0.6 0.5 0.4", "0.56 0.46 0.37")),
        ("sun", changed("1.6 1.4 1.2", "1.52 1.32 1.14")),
        ("sky", changed("0.4 0.4 0.4", "0.37 0.37 0.37")),
        ("index", changed("\"float eta\" 1.5", "\"float eta\" 1.2")),
        (
            "roughness",
            changed("\"float roughness\" 0.2", "\"float roughness\" 0.6"),
        ),
        (
            "ball",
            changed("\"float radius\" 0.45", "\"float radius\" 0.52"),
        ),
        (
            "mean cosine",
            changed("\"float g\" 0.4", "\"float g\" 0.75"),
        ),
    ] {
        let picture = packets(&wrong, &[], 9501);
        must_kill(name, picture.strongest(&reference, RESOLUTION));
    }
}

#[test]
fn what_packets_do_not_queue_is_left_to_scalar_code() {
    let base = day() + &ground() + &cloud(&grey(3.0, 0.95, 0.6));
    let queued = |world: String, keep: &[Feature], integrator: Integrator| {
        is_queued(&staged(
            &Exhibit::new("perhaps", front(), world),
            keep,
            integrator,
            1,
        ))
    };
    let path = Integrator::Path;
    assert!(queued(base.clone(), &[], path));
    assert!(!queued(base.clone(), &[Feature::DetailedSurfaces], path));
    assert!(
        !queued(base.clone() + &disk_above([1.0; 3]), &[], path),
        "a lamp"
    );
    assert!(
        !queued(base.clone() + &point([0.0, 3.0, 0.0], 1.0), &[], path),
        "a point"
    );
    assert!(
        !queued(day() + &ground() + &sphere(METAL, [0.0; 3], 0.5), &[], path),
        "no medium"
    );
    let shining = day() + &ground() + &fire(1.0) + &block("fire", "", UNIT);
    assert!(!queued(shining, &[], path), "a medium that shines");
    let room =
        day() + &ground() + &homogeneous("m", &grey(1.5, 0.8, 0.4)) + &ball("m", "", [0.0; 3], 0.9);
    assert!(!queued(room, &[], path), "a room");
}
