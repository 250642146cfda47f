//! White furnaces with everything at once: where nothing is absorbed and light of radiance 1 comes from everywhere, every
//! picture is 1; and in a closed cavity whose walls shine with L and reflect ρ, every picture is L / (1 − ρ).
//!
//! Means are tested, since lights are sampled; where all that is met is smooth no light can be, and each path of the path
//! tracer brings 1 but for rounding.

use woodcock_host::integrator::Integrator;
use woodcock_host::world::Feature;
use woodcock_tests::gallery::*;
use woodcock_tests::pictures::*;
use woodcock_tests::replicates::Replicates;
use woodcock_tests::stats::must_kill;

/// Relative standard error that each comparison must reach; chains have few independent states.
const fn resolution(integrator: Integrator) -> f64 {
    match integrator {
        Integrator::Mlt => 0.02,
        _ => 0.01,
    }
}

const INTEGRATORS: [Integrator; 3] = [Integrator::Path, Integrator::Bdpt, Integrator::Mlt];

/// Samples, since light at the same place everywhere makes little noise.
const fn depth(integrator: Integrator) -> u32 {
    match integrator {
        Integrator::Bdpt => 96,
        Integrator::Mlt => 64,
        _ => 320,
    }
}

fn replicates(exhibit: &Exhibit, integrator: Integrator, seed: u64) -> Replicates {
    // What packets track among surfaces has furnaces of its own.
    let keep = [Feature::DetailedSurfaces];
    let studio = stage_with(&exhibit.text(), exhibit.files.clone(), &keep);
    let studio = replan(studio, integrator, seed, exhibit.max_depth);
    assert!(!studio.plan.in_packets(&studio.world), "{}", exhibit.name);
    Replicates::of(exhibit.name, &studio, depth(integrator))
}

#[track_caller]
fn assert_white(exhibit: &Exhibit, seed: u64, value: f64) {
    for (integrator, seed) in INTEGRATORS.into_iter().zip(seed..) {
        let picture = replicates(exhibit, integrator, seed);
        let name = format!("{}, {}", exhibit.name, integrator.name());
        picture.assert_same(&name, &picture.known(value), resolution(integrator));
    }
}

const GLASS: &str = "Material \"dielectric\"";

/// Surfaces that absorb nothing, whatever is between them. (A conductor "of reflectance 1" is taken as 0.9999 head-on and
/// less at other angles, which shows; an extinction of 10⁶ leaves 1 − 4·10⁻¹² of the light.)
fn surfaces() -> String {
    sphere(&diffuse([1.0; 3]), [-0.9, 0.3, 0.0], 0.4)
        + &sphere(GLASS, [0.1, 0.4, -0.6], 0.4)
        + &sphere(
            "Material \"conductor\" \"rgb eta\" [ 1 1 1 ] \"rgb k\" [ 1e6 1e6 1e6 ]",
            [0.9, 0.4, 0.3],
            0.4,
        )
        + &with_material(
            "Material \"thindielectric\"",
            "Translate 0 0 -1.2\nShape \"disk\" \"float radius\" 0.7",
        )
        + &floor(&diffuse([1.0; 3]))
}

fn white(sigma_s: Xyz, g: f64) -> Matter {
    coloured([0.0; 3], sigma_s, g)
}

fn with_phase(sigma_s: f64, phase: &str) -> Matter {
    Matter {
        more: format!("\"string phase\" {phase}"),
        ..white([sigma_s; 3], 0.0)
    }
}

/// Grey media of albedo 1 that overlap, of different phase functions.
fn overlapping() -> String {
    homogeneous("grey", &white([0.8; 3], 0.5))
        + &uniform_grid(
            "grid",
            [8; 3],
            UNIT,
            lumps,
            &with_phase(1.5, "\"rayleigh\""),
        )
        + &homogeneous(
            "draine",
            &with_phase(1.0, "\"draine\" \"float alpha\" 2 \"float g\" 0.4"),
        )
        + &homogeneous(
            "lobes",
            &with_phase(
                1.0,
                "\"twolobe\" \"float g\" 0.7 \"float g2\" -0.4 \"float share\" 0.6",
            ),
        )
        + &homogeneous(
            "drops",
            &with_phase(1.0, "\"droplets\" \"float diameter\" 8"),
        )
        + &ball("grey", "", [0.0; 3], 1.3)
        + &block("grid", "", UNIT)
        + &ball("draine", "", [-0.7, 0.6, 0.0], 0.6)
        + &ball("lobes", "", [0.6, 0.8, 0.0], 0.5)
        + &ball("drops", "", [-0.3, -0.4, -0.5], 0.5)
}

/// Media of albedo 1 whose extinction differs between colours: one in another, and one beside them.
fn in_colour() -> String {
    homogeneous("coloured", &white([0.3, 0.8, 2.0], -0.3))
        + &uniform_grid("grid", [8; 3], UNIT, lumps, &white([2.0, 1.0, 0.3], 0.6))
        + &homogeneous("clear", &white([0.0, 0.5, 1.5], 0.0))
        + &ball("coloured", "", [-0.3, 0.0, 0.0], 0.9)
        + &block("grid", "coloured", [[-0.7, -0.4, -0.5], [0.1, 0.5, 0.4]])
        + &ball("clear", "", [1.1, 0.1, 0.4], 0.4)
}

#[test]
fn surfaces_that_absorb_nothing_are_white() {
    let exhibit = Exhibit::new("surfaces", front(), sky(1.0) + &surfaces());
    assert_white(&exhibit, 3000, 1.0);
}

#[test]
fn media_that_absorb_nothing_are_white() {
    let ball = sphere(&diffuse([1.0; 3]), [0.0, -0.5, 0.8], 0.3);
    let exhibit = Exhibit::new("grey media", front(), sky(1.0) + &overlapping() + &ball);
    assert_white(&exhibit, 3010, 1.0);
    let exhibit = Exhibit::new("coloured media", front(), sky(1.0) + &in_colour() + &ball);
    assert_white(&exhibit, 3015, 1.0);
}

fn milk(sigma_s: Xyz) -> String {
    homogeneous("milk", &white(sigma_s, 0.3)) + &in_glass("milk", "", [-0.8, -0.6, -1.6], 0.3)
}

#[test]
fn everything_at_once_is_white() {
    let world = sky(1.0) + &surfaces() + &overlapping() + &milk([3.0; 3]);
    assert_white(&Exhibit::new("everything", front(), world), 3020, 1.0);
    let world = sky(1.0) + &surfaces() + &in_colour() + &milk([3.0, 2.0, 1.0]);
    assert_white(
        &Exhibit::new("everything in colour", front(), world),
        3025,
        1.0,
    );
}

#[test]
fn a_camera_inside_of_media_sees_white() {
    for (name, medium, media, seed) in [
        ("within grey media", "grey", overlapping(), 3030),
        ("within coloured media", "coloured", in_colour(), 3035),
    ] {
        let view = perspective([0.02, -0.1, 0.1], [0.2, 0.3, 1.0], 90.0);
        let camera =
            format!("MediumInterface \"\" \"{medium}\"\n{view}\nMediumInterface \"\" \"\"");
        let world = sky(1.0) + &media + &floor(&diffuse([1.0; 3]));
        assert_white(&Exhibit::new(name, camera, world), seed, 1.0);
    }
}

#[test]
fn a_picture_of_one_colour_is_as_good_as_none() {
    let light = "LightSource \"infinite\" \"string filename\" \"white.exr\"\n".to_owned();
    let mut exhibit = Exhibit::new("a picture", front(), light + &surfaces() + &overlapping());
    let one = picture([8, 4], |_, _| [1.0; 3]);
    exhibit.files = exhibit.files.with("white.exr", one);
    assert_white(&exhibit, 3040, 1.0);
}

#[test]
fn paths_through_glass_bring_exactly_one() {
    let world = sky(1.0)
        + &sphere(GLASS, [0.1, 0.4, -0.6], 0.6)
        + &sphere(
            "Material \"dielectric\" \"float eta\" 1.3",
            [-0.8, 0.0, 0.5],
            0.5,
        )
        + &with_material(
            "Material \"thindielectric\"",
            "Translate 0 0 -1.5\nShape \"disk\" \"float radius\" 1",
        );
    let studio = Exhibit::new("glass", front(), world).stage(Integrator::Path, 3050);
    studio
        .shoot(32)
        .assert_sound("glass")
        .assert_constant("glass", 1.0, 2e-6);
}

/// Walls that shine inwards with 0.6 and reflect 0.4, and what they enclose.
fn cavity(contents: &str, inside: &str) -> String {
    let walls = format!(
        "{}\nAreaLightSource \"diffuse\" \"rgb L\" [ 0.6 0.6 0.6 ]\nReverseOrientation\nMediumInterface \"\" \"{inside}\"",
        diffuse([0.4; 3])
    );
    contents.to_owned() + &with_material(&walls, &block_mesh([[-1.5, -1.2, -1.4], [1.5, 1.3, 1.6]]))
}

#[test]
fn a_closed_cavity_is_the_geometric_series() {
    let camera = perspective([-0.7, 0.3, -1.0], [0.4, -0.2, 1.0], 80.0);
    let exhibit = Exhibit::new("an empty cavity", camera, cavity("", ""));
    assert_white(&exhibit, 3060, 1.0);
}

#[test]
fn what_does_not_absorb_does_not_show_in_a_cavity() {
    let camera = format!(
        "MediumInterface \"\" \"fog\"\n{}",
        perspective([-0.7, 0.3, -1.0], [0.4, -0.2, 1.0], 80.0)
    );
    let contents = homogeneous("fog", &white([0.5; 3], 0.4))
        + &uniform_grid("grid", [8; 3], UNIT, lumps, &white([1.0; 3], 0.0))
        + &block("grid", "", [[-0.9; 3], [0.4, 0.9, 0.9]])
        + &sphere(&diffuse([1.0; 3]), [0.9, -0.5, 0.6], 0.4)
        + &in_glass("", "fog", [-0.3, 0.2, 0.5], 0.4);
    let exhibit = Exhibit::new("a cavity with everything", camera, cavity(&contents, "fog"));
    assert_white(&exhibit, 3070, 1.0);
}

#[test]
fn five_percent_of_absorption_are_seen() {
    let grey = sky(1.0)
        + &floor(&diffuse([0.95; 3]))
        + &homogeneous("m", &grey(2.0, 0.95, 0.0))
        + &ball("m", "", [0.0; 3], 0.9);
    let exhibit = Exhibit::new("not quite white", front(), grey);
    for (integrator, seed) in INTEGRATORS.into_iter().zip(3080..) {
        let picture = replicates(&exhibit, integrator, seed);
        let verdict = picture.strongest(&picture.known(1.0), resolution(integrator));
        must_kill(integrator.name(), verdict);
    }
}
