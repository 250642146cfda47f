//! What a scene comes to before a path is traced: needs, places, refusals, and what lies outside of media.

use super::{assert_near, volume, volume_bytes};
use woodcock_host::scene::{MemoryFiles, SceneError};
use woodcock_host::volume::Limits;
use woodcock_host::world::{self, Feature, Location, World};
use woodcock_tests::pictures::*;

const UNIT: [Xyz; 2] = [[-1.0; 3], [1.0; 3]];

fn view(world: &str) -> String {
    let camera = perspective([0.2, 0.1, -4.0], [0.0, 0.0, 1.0], 45.0);
    scene(&camera, [32, 32], &(sky(1.0) + world))
}

fn running(world: &World) -> Vec<String> {
    world.needs.running()
}

fn refuse(text: &str, files: MemoryFiles, limits: Limits) -> SceneError {
    let options = world::Options {
        limits,
        ..world::Options::default()
    };
    match try_stage(text, files, &options) {
        Ok(_) => panic!("this was to be refused: {text}"),
        Err(error) => error,
    }
}

#[track_caller]
fn assert_refused(text: &str, files: MemoryFiles, words: &[&str]) {
    let error = refuse(text, files, Limits::default());
    let report = error.report();
    assert!(error.place().is_some(), "a refusal has a place: {report}");
    for word in words {
        assert!(report.contains(word), "no {word:?} in {report}");
    }
}

#[test]
fn scenes_need_what_they_have() {
    let ball_of = |matter: &Matter| homogeneous("m", matter) + &ball("m", "", [0.0; 3], 1.0);
    let needs: [(&str, String, &[&str]); 8] = [
        ("sky alone", String::new(), &[]),
        ("a ball", ball_of(&grey(1.0, 0.5, 0.0)), &["scattering"]),
        ("a ball that absorbs", ball_of(&grey(1.0, 0.0, 0.0)), &[]),
        (
            "in colours nearly alike",
            ball_of(&coloured([1.0, 1.1, 1.2], [1.0; 3], 0.0)),
            &["chromatic", "scattering", "shared-paths", "free-passage"],
        ),
        (
            "in colour",
            ball_of(&coloured([1.0, 2.0, 3.0], [1.0; 3], 0.0)),
            &["chromatic", "scattering"],
        ),
        (
            "colour of the albedo alone",
            ball_of(&coloured([1.0, 2.0, 3.0], [3.0, 2.0, 1.0], 0.0)),
            &["scattering"],
        ),
        (
            "rayleigh",
            ball_of(&rayleigh(1.0, 0.5)),
            &["rayleigh", "scattering"],
        ),
        (
            "a grid cut by its ball, and a sun",
            sun([0.0, 1.0, 0.0], [1.0; 3])
                + &uniform_grid("m", [4; 3], UNIT, |_| 1.0, &grey(1.0, 0.5, 0.0))
                + &ball("m", "", [0.0; 3], 1.0),
            &[
                "tracking",
                "boundaries",
                "next-event",
                "scattering",
                "free-passage",
                "dense-grid",
            ],
        ),
    ];
    for (name, world, expected) in needs {
        let world = stage(&view(&world)).world;
        assert_eq!(running(&world), expected, "{name}");
        assert_eq!(
            running(&world).len() + world.needs.skipped().len(),
            Feature::ALL.len()
        );
    }
}

#[test]
fn media_that_cannot_be_seen_cost_nothing() {
    let unused = homogeneous("unused", &rayleigh(1.0, 0.5));
    let world = stage(&view(&unused)).world;
    assert!(world.media.is_empty() && matches!(world.place, Location::Nowhere));
    // Neither absorbing nor scattering, and a grid of nothing.
    let nothing = homogeneous("n", &grey(0.0, 0.0, 0.0)) + &ball("n", "", [0.0; 3], 1.0);
    stage(&view(&nothing))
        .shoot_range(0..2)
        .assert_constant("nothing", 1.0, 0.0);
    let zero =
        uniform_grid("z", [3; 3], UNIT, |_| 0.0, &grey(1.0, 0.5, 0.0)) + &block("z", "", UNIT);
    stage(&view(&zero))
        .shoot_range(0..2)
        .assert_sound("zero")
        .assert_constant("zero", 1.0, 0.0);
    // A damaged file of an unused medium is nobody's business.
    let unused = openvdb("unused", "bad_values.vdb", &grey(1.0, 0.5, 0.0));
    stage_with(&view(&unused), volume("bad_values.vdb"), &[]);
    let empty = openvdb("m", "empty_grid.vdb", &grey(1.0, 0.5, 0.0)) + &block("m", "", UNIT);
    stage_with(&view(&empty), volume("empty_grid.vdb"), &[])
        .shoot_range(0..2)
        .assert_constant("empty", 1.0, 0.0);
}

#[test]
fn no_light_is_black_and_no_medium_is_sky() {
    let fog = homogeneous("m", &grey(1.0, 0.9, 0.0)) + &ball("m", "", [0.0; 3], 1.0);
    let camera = perspective([0.0, 0.0, -3.0], [0.0, 0.0, 1.0], 40.0);
    stage(&scene(&camera, [9, 9], &fog))
        .shoot_range(0..3)
        .assert_constant("dark", 0.0, 0.0);
    stage(&scene(&camera, [9, 9], &sky(0.75)))
        .shoot_range(0..3)
        .assert_constant("sky", 0.75, 0.0);
    stage(&scene(&camera, [9, 9], ""))
        .shoot_range(0..3)
        .assert_constant("void", 0.0, 0.0);
    // A sun without matter lights nothing.
    let world = sun([0.0, 1.0, 0.0], [5.0; 3]);
    stage(&scene(&camera, [9, 9], &world))
        .shoot_range(0..3)
        .assert_constant("void", 0.0, 0.0);
}

#[test]
fn boxes_leave_no_outline() {
    // One voxel in the middle of nine: what does not pass within a cell of it is sky, bit by bit.
    let grid = uniform_grid(
        "m",
        [9; 3],
        UNIT,
        |[x, y, z]| {
            if x.abs() + y.abs() + z.abs() < 1e-9 {
                1.0
            } else {
                0.0
            }
        },
        &grey(30.0, 0.3, 0.0),
    );
    let camera = orthographic([0.0, 0.0, -3.0], [0.0, 0.0, 1.0], 1.125);
    for keep in [
        &[][..],
        &[Feature::Boundaries],
        &[Feature::SeveralMedia],
        &[Feature::Chromatic],
    ] {
        let text = scene(
            &camera,
            [72, 72],
            &(sky(1.0) + &grid + &block("m", "", UNIT)),
        );
        let picture = stage_keeping(&text, keep).shoot_range(0..8);
        picture.assert_sound("voxel");
        // Two cells of 2/9 in width are seen by 72 pixels over 2.25: 14.2.
        let (mut clear, mut dim) = (0, 0);
        for (x, y, pixel) in picture.film.pixels() {
            let away = |i: u32| (f64::from(i) + 0.5 - 36.0).abs() > 8.0;
            if away(x) || away(y) {
                assert_eq!(pixel.mean(), [1.0; 3], "({x}, {y})");
                assert_eq!(
                    (pixel.alpha(), pixel.variance_of_mean()),
                    (0.0, Some([0.0; 3]))
                );
                clear += 1;
            } else {
                dim += u32::from(pixel.mean()[0] < 1.0);
            }
        }
        assert!(clear > 4800 && dim > 100, "{clear} {dim}");
    }
}

#[test]
fn no_pixel_of_a_cloud_is_black() {
    let world = openvdb("m", "cloud_zip.vdb", &grey(20.0, 0.99, 0.8))
        + &block("m", "", [[-2.0; 3], [2.0; 3]]);
    let camera = perspective([0.0, 0.6, -5.0], [0.0, 0.0, 1.0], 35.0);
    let text = scene(
        &camera,
        [48, 48],
        &(sky(0.5) + &sun([0.0, 1.0, -0.5], [3.0; 3]) + &world),
    );
    let picture = stage_with(&text, volume("cloud_zip.vdb"), &[]).shoot(8);
    picture.assert_sound("cloud");
    let covered = picture
        .film
        .pixels()
        .filter(|(.., p)| p.alpha() > 0.0)
        .count();
    assert!(covered > 200, "{covered}");
    for (x, y, pixel) in picture.film.pixels() {
        assert!(pixel.mean().iter().all(|&c| c > 0.0), "({x}, {y}) is black");
    }
}

#[test]
fn the_cameras_fog_fills_what_is_left() {
    // Between the camera and a ball of vacuum that names the fog as its outside.
    let fog = homogeneous("fog", &grey(0.5, 0.0, 0.0));
    let thick = homogeneous("m", &grey(1.0, 0.0, 0.0));
    let camera =
        "MediumInterface \"\" \"fog\"\n".to_owned() + &single_ray([0.0; 3], [0.0, 0.0, 1.0]);
    // A camera within a ball of its own fog, named on both sides.
    let world = sky(1.0) + &ball("fog", "", [0.0; 3], 2.0);
    let text = format!("{fog}{}", scene(&camera, [32, 32], &world));
    let m = stage(&text).shoot(64).moments(0);
    assert_near("fog ball", &m, (-1.0_f64).exp(), 0.0, 0.02);
    // No boundary mentions the fog: it reaches on for ever, through and beyond other media.
    let world = sky(1.0) + &thick + &ball("m", "", [0.0, 0.0, 4.0], 1.0);
    let studio = stage(&format!("{fog}{}", scene(&camera, [8, 8], &world)));
    assert_eq!(studio.world.media.len(), 2);
    studio
        .shoot_range(0..4)
        .assert_sound("fog")
        .assert_constant("fog", 0.0, 0.0);
    assert!(studio.world.warnings.is_empty());
}

#[test]
fn fog_without_bounds_scatters_a_sun() {
    // Single scattering in a fog of all space: a sun's light never arrives through infinitely much of it.
    let fog = homogeneous("fog", &grey(0.5, 0.5, 0.0));
    let camera =
        "MediumInterface \"\" \"fog\"\n".to_owned() + &single_ray([0.0; 3], [0.0, 0.0, 1.0]);
    let world = sun([0.0, 1.0, 0.0], [1.0; 3]) + &sky(1.0);
    let studio = stage(&format!("{fog}{}", scene(&camera, [8, 8], &world)));
    studio
        .shoot_range(0..4)
        .assert_sound("fog")
        .assert_constant("fog", 0.0, 0.0);
    assert!(!studio.world.is_endless());
    let white = homogeneous("fog", &grey(0.5, 1.0, 0.0));
    assert!(
        stage(&format!("{white}{}", scene(&camera, [8, 8], &world)))
            .world
            .is_endless()
    );
}

#[test]
fn open_surfaces_are_warned_about() {
    let sheet = "Shape \"trianglemesh\" \"point3 P\" [ -1 -1 0 1 -1 0 0 1 0 ]";
    let m = homogeneous("m", &grey(1.0, 0.5, 0.0));
    let text = format!(
        "{m}AttributeBegin Material \"interface\" MediumInterface \"m\" \"\" {sheet} AttributeEnd\n"
    );
    let studio = stage(&view(&text));
    let [warning] = studio.world.warnings.as_slice() else {
        panic!("one warning: {:?}", studio.world.warnings);
    };
    assert!(
        warning.message().contains("not closed"),
        "{}",
        warning.message()
    );
    studio.shoot_range(0..2).assert_sound("sheet");
}

#[test]
fn volumes_that_are_no_densities_are_refused() {
    let with = |file: &str, name: &str| {
        let matter = Matter {
            more: format!("\"string gridname\" \"{name}\""),
            ..grey(1.0, 0.5, 0.0)
        };
        view(&(openvdb("m", file, &matter) + &block("m", "", UNIT)))
    };
    assert_refused(
        &with("bad_values.vdb", "density"),
        volume("bad_values.vdb"),
        &["bad_values.vdb", "density", "test.pbrt:"],
    );
    assert_refused(
        &with("levelset.vdb", "ls_sphere"),
        volume("levelset.vdb"),
        &["ls_sphere", "negative"],
    );
    assert_refused(
        &with("cloud_zip.vdb", "smoke"),
        volume("cloud_zip.vdb"),
        &["no grid \"smoke\"", "density"],
    );
    assert_refused(
        &with("no_grids.vdb", "density"),
        volume("no_grids.vdb"),
        &["no grids"],
    );
    let cut = volume_bytes("cloud_zip.vdb")[..5000].to_vec();
    let files = MemoryFiles::new().with("cut.vdb", cut);
    assert_refused(&with("cut.vdb", "density"), files, &["cut.vdb"]);
    let files = MemoryFiles::new().with("text.vdb", "no volume at all");
    assert_refused(&with("text.vdb", "density"), files, &["text.vdb"]);
}

#[test]
fn coefficients_beyond_single_precision_are_refused() {
    for sigma in ["[ 1e39 1 1 ]", "[ 1e-39 0 0 ]"] {
        let world = format!(
            "MakeNamedMedium \"m\" \"string type\" \"homogeneous\" \"rgb sigma_a\" {sigma} \"rgb sigma_s\" [ 0 0 0 ]\n{}",
            ball("m", "", [0.0; 3], 1.0)
        );
        assert_refused(&view(&world), MemoryFiles::new(), &["m"]);
    }
    let world =
        uniform_grid("m", [2; 3], UNIT, |_| 3e38, &grey(2.0, 0.5, 0.0)) + &block("m", "", UNIT);
    assert_refused(&view(&world), MemoryFiles::new(), &["range of 32-bit"]);
    let g = homogeneous("m", &grey(1.0, 0.5, 0.999_999_999_9)) + &ball("m", "", [0.0; 3], 1.0);
    assert_refused(&view(&g), MemoryFiles::new(), &["mean cosine"]);
}

#[test]
fn colours_that_overlap_are_for_scalar_code() {
    let tinted = coloured([0.1, 0.5, 1.0], [1.0; 3], 0.0);
    let world = homogeneous("a", &tinted)
        + &homogeneous("b", &grey(1.0, 0.5, 0.0))
        + &ball("a", "", [0.0; 3], 1.0)
        + &ball("b", "", [0.5, 0.0, 0.0], 1.0);
    let needs = stage(&view(&world)).world.needs;
    assert!(needs.runs(Feature::DetailedMedia));
    assert!(needs.to_string().contains("coloured media overlap"));
}

#[test]
fn memory_is_asked_for_before_it_is_taken() {
    for (file, limit) in [("fire_160.vdb", 1 << 20), ("far_coords.vdb", 1 << 30)] {
        let text = view(&(openvdb("m", file, &grey(1.0, 0.5, 0.0)) + &block("m", "", UNIT)));
        let error = refuse(&text, volume(file), Limits { max_memory: limit }).report();
        let named = error.contains(file) && error.contains("limit") && error.contains("test.pbrt:");
        assert!(named, "{error}");
    }
    let world = homogeneous("m", &grey(1.0, 0.5, 0.0)) + &ball("m", "", [0.0; 3], 1.0);
    let camera = perspective([0.0, 0.0, -3.0], [0.0, 0.0, 1.0], 40.0);
    let text = scene(&camera, [1000, 1000], &world);
    let error = refuse(
        &text,
        MemoryFiles::new(),
        Limits {
            max_memory: 100 << 20,
        },
    )
    .report();
    assert!(error.contains("memory"), "{error}");
}

#[test]
fn crops_keep_their_pixels_at_their_own_size() {
    let camera = "Camera \"perspective\"\nFilm \"rgb\" \"integer xresolution\" 300 \"integer yresolution\" 7 \
                  \"integer pixelbounds\" [ 100 200 1 6 ]\nWorldBegin\n";
    for (resolution, expected) in [
        (None, [100, 1, 200, 6]),
        (Some([300, 7]), [100, 1, 200, 6]),
        (Some([600, 14]), [200, 2, 400, 12]),
        (Some([30, 70]), [10, 10, 20, 60]),
    ] {
        let options = world::Options {
            resolution,
            ..world::Options::default()
        };
        let w = try_stage(camera, MemoryFiles::new(), &options)
            .expect("a crop")
            .world
            .window;
        assert_eq!([w.x0, w.y0, w.x1, w.y1], expected, "{resolution:?}");
    }
}
