//! Rooms, which packets render in single precision: the pictures of the scalar path tracer and of bidirectional paths, the
//! bits of scalar code, furnaces, and what is refused.

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

/// A parallelogram at a corner; its normal is the product of its edges.
fn quad(corner: Xyz, e: Xyz, f: Xyz) -> String {
    let add = |a: Xyz, b: Xyz| [0, 1, 2].map(|i| a[i] + b[i]);
    let corners = [
        corner,
        add(corner, e),
        add(add(corner, e), f),
        add(corner, f),
    ];
    let text: Vec<String> = corners.iter().flatten().map(f64::to_string).collect();
    format!(
        "Shape \"trianglemesh\" \"integer indices\" [ 0 1 2 0 2 3 ] \"point3 P\" [ {} ]\n",
        text.join(" ")
    )
}

fn triangle(corners: [Xyz; 3]) -> String {
    let text: Vec<String> = corners.iter().flatten().map(f64::to_string).collect();
    format!(
        "Shape \"trianglemesh\" \"integer indices\" [ 0 1 2 ] \"point3 P\" [ {} ]\n",
        text.join(" ")
    )
}

/// Six walls around the origin, 2 wide, and a ball.
fn walls() -> String {
    let white = diffuse([0.7; 3]);
    let [x, y, z] = [[2.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 2.0]];
    let low = [-1.0; 3];
    let wall = |material: &str, shape: String| with_material(material, &shape);
    wall(
        &white,
        quad(low, z, x) + &quad([-1.0, 1.0, -1.0], x, z) + &quad(low, x, y),
    ) + &wall(&white, quad([-1.0, -1.0, 1.0], y, x))
        + &wall(&diffuse([0.7, 0.15, 0.1]), quad(low, y, z))
        + &wall(&diffuse([0.1, 0.6, 0.15]), quad([1.0, -1.0, -1.0], z, y))
        + &sphere(&diffuse([0.5, 0.5, 0.8]), [-0.35, -0.55, 0.3], 0.45)
}

fn inside() -> String {
    perspective([0.0, 0.0, -0.9], [0.0, -0.1, 0.9], 80.0)
}

/// A medium that fills all that there is.
fn filled(matter: &Matter) -> String {
    homogeneous("air", matter) + &ball("air", "", [0.0; 3], 6.0)
}

/// A window that shines downwards.
fn ceiling_lamp() -> String {
    lamp(
        [9.0, 8.0, 7.0],
        &quad([-0.4, 0.8, -0.4], [0.8, 0.0, 0.0], [0.0, 0.0, 0.8]),
    )
}

fn rooms() -> Vec<Exhibit> {
    let slanted = quad([-0.9, 0.9, -0.2], [0.5, 0.2, 0.1], [0.1, 0.1, 0.9]);
    let corner = triangle([[0.8, 0.9, 0.9], [0.9, 0.1, 0.9], [0.2, 0.9, 0.9]]);
    let open = || {
        floor(&diffuse([0.6, 0.5, 0.4]))
            + &sphere(&diffuse([0.3, 0.6, 0.7]), [0.4, -0.4, 0.3], 0.5)
            + &with_material(
                &diffuse([0.6; 3]),
                &triangle([[-1.6, -1.0, 0.8], [-0.2, -1.0, 1.2], [-0.9, 0.6, 0.9]]),
            )
    };
    let suns = || point([-0.8, 0.4, -0.5], 1.5) + &sun([1.0, 1.5, -1.0], [1.0, 0.9, 0.8]);
    let outside = || perspective([0.0, 0.9, -4.5], [0.0, -0.2, 1.0], 40.0);
    vec![
        Exhibit::new(
            "box in fog",
            inside(),
            walls() + &ceiling_lamp() + &filled(&grey(0.5, 0.9, 0.4)),
        ),
        Exhibit::new("box in vacuum", inside(), walls() + &ceiling_lamp()),
        Exhibit::new(
            "box by slanted and three-cornered lamps",
            inside(),
            walls()
                + &lamp([6.0, 5.0, 7.0], &slanted)
                + &lamp([3.0, 4.0, 2.0], &corner)
                + &filled(&grey(0.8, 0.8, -0.5)),
        ),
        // Near a point in fog pictures have heavy tails, whoever samples them: this one is outside.
        Exhibit::new(
            "a ball of haze by a point and the sun",
            outside(),
            suns()
                + &open()
                + &homogeneous("air", &grey(1.2, 0.9, 0.7))
                + &ball("air", "", [0.6, 0.3, 0.0], 0.9),
        ),
        Exhibit::new(
            "open under the sky with a lamp of two sides",
            outside(),
            sky(0.4)
                + &open()
                + &with_material(
                    &(diffuse([0.4; 3])
                        + "\nAreaLightSource \"diffuse\" \"rgb L\" [ 4 3 2 ] \"bool twosided\" true"),
                    &quad([-1.2, 0.6, 0.2], [0.9, 0.3, 0.0], [0.2, -0.3, 0.7]),
                ),
        ),
        Exhibit::new(
            "a ball of fog with a lamp in it and a lens",
            outside() + " \"float lensradius\" 0.15 \"float focaldistance\" 4.5",
            sky(0.2)
                + &open()
                + &lamp(
                    [5.0, 6.0, 8.0],
                    &quad([-0.6, 0.5, -0.4], [0.4, 0.0, 0.1], [0.0, 0.3, 0.4]),
                )
                + &homogeneous("air", &coloured([0.0; 3], [1.5; 3], 0.3))
                + &ball("air", "", [-0.5, 0.4, 0.0], 0.8),
        ),
        Exhibit::new(
            "thick haze cut off",
            inside(),
            walls() + &ceiling_lamp() + &filled(&grey(3.0, 0.95, 0.6)),
        )
        .limited(3),
    ]
}

fn is_room(studio: &Studio) -> bool {
    !studio.world.needs.runs(Feature::DetailedSurfaces)
}

fn staged(exhibit: &Exhibit, keep: &[Feature], integrator: Integrator, seed: u64) -> Studio {
    let studio = stage_keeping(&exhibit.text(), keep);
    replan(studio, integrator, seed, exhibit.max_depth)
}

/// By the scalar integrators.
fn scalar(exhibit: &Exhibit, integrator: Integrator, seed: u64) -> Replicates {
    let studio = staged(exhibit, &[Feature::DetailedSurfaces], integrator, seed);
    assert!(!is_room(&studio), "{}", exhibit.name);
    let n = if integrator == Integrator::Bdpt {
        SAMPLES / 2
    } else {
        SAMPLES
    };
    Replicates::of(exhibit.name, &studio, n)
}

/// By packets.
fn room(exhibit: &Exhibit, keep: &[Feature], seed: u64) -> Replicates {
    let studio = staged(exhibit, keep, Integrator::Path, seed);
    assert!(
        is_room(&studio),
        "{}:\n{}",
        exhibit.name,
        studio.world.needs
    );
    Replicates::of(exhibit.name, &studio, SAMPLES * 2)
}

#[test]
fn rooms_look_as_to_scalar_integrators() {
    for (exhibit, seed) in rooms().iter().zip((8000..).step_by(10)) {
        let path = scalar(exhibit, Integrator::Path, seed);
        let packets = room(exhibit, &[], seed + 1);
        packets.assert_same(exhibit.name, &path, RESOLUTION);
        let apart = room(exhibit, &[Feature::IndependentSamples], seed + 2);
        apart.assert_same(exhibit.name, &path, RESOLUTION);
        let light_paths = scalar(exhibit, Integrator::Bdpt, seed + 3);
        packets.assert_same(exhibit.name, &light_paths, RESOLUTION);
    }
}

#[test]
fn scalar_code_has_the_bits_of_packets() {
    for (exhibit, seed) in rooms().iter().zip(8100..) {
        for keep in [&[][..], &[Feature::IndependentSamples]] {
            let film = |kernel: Kernel, passes: &[std::ops::Range<u32>]| -> Film {
                let mut studio = staged(exhibit, keep, Integrator::Path, seed);
                studio.plan.kernel = kernel;
                studio.shoot_passes(passes).film
            };
            let whole = film(Kernel::Packet, std::slice::from_ref(&(0..32)));
            assert!(
                whole.pixels().any(|(.., p)| p.mean()[1] > 0.0),
                "{}",
                exhibit.name
            );
            assert!(
                whole == film(Kernel::Scalar, std::slice::from_ref(&(0..32))),
                "{}",
                exhibit.name
            );
            assert!(
                whole == film(Kernel::Packet, &[16..32, 0..16]),
                "{}",
                exhibit.name
            );
            assert!(
                whole != film(Kernel::Packet, std::slice::from_ref(&(32..64))),
                "{}",
                exhibit.name
            );
        }
    }
}

/// A closed cavity whose walls shine with L and reflect ρ: every picture is L / (1 − ρ), whatever fog of albedo 1 fills it.
#[test]
fn cavities_are_evenly_bright() {
    let [x, y, z] = [[2.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 2.0]];
    let (low, high) = ([-1.0; 3], [1.0; 3]);
    let back = |v: Xyz| v.map(|c| -c);
    // All normals inwards.
    let sides = quad(low, y, x)
        + &quad(low, x, z)
        + &quad(low, z, y)
        + &quad(high, back(x), back(y))
        + &quad(high, back(z), back(x))
        + &quad(high, back(y), back(z));
    let shining = with_material(
        &(diffuse([0.5; 3])
            + "\nAreaLightSource \"diffuse\" \"rgb L\" [ 1 1 1 ] \"bool twosided\" true"),
        &sides,
    );
    for (name, fog, seed) in [
        ("an empty cavity", String::new(), 8200),
        (
            "a cavity of fog",
            filled(&coloured([0.0; 3], [0.8; 3], 0.6)),
            8210,
        ),
    ] {
        let exhibit = Exhibit::new(name, inside(), shining.clone() + &fog);
        let picture = room(&exhibit, &[], seed);
        picture.assert_same(name, &picture.known(2.0), 0.005);
        // Two parts in a hundred of the light are seen.
        let dim = picture.known(2.0 * 1.02);
        must_kill(name, picture.strongest(&dim, 0.005));
    }
}

/// White walls around white fog: no path ever loses anything, and all end.
#[test]
fn paths_that_lose_nothing_end() {
    let world = walls()
        .replace("0.7 0.7 0.7", "1 1 1")
        .replace("0.7 0.15 0.1", "1 1 1");
    let world = world
        .replace("0.1 0.6 0.15", "1 1 1")
        .replace("0.5 0.5 0.8", "1 1 1");
    let lamp = ceiling_lamp().replace("0 0 0", "1 1 1");
    let fog = filled(&coloured([0.0; 3], [0.5; 3], 0.0));
    let exhibit = Exhibit::new("white", inside(), world + &lamp + &fog);
    let mut studio = staged(&exhibit, &[], Integrator::Path, 8400);
    assert!(is_room(&studio));
    studio.world.window.x1 = 1;
    studio.world.window.y1 = 1;
    let picture = studio.shoot_range(0..16);
    let steps = picture.counts.busy_lanes / picture.counts.paths;
    assert!((1 << 16..1 << 18).contains(&steps), "{steps}");
}

/// Of each kind of mistake the comparisons see one.
#[test]
fn mistakes_in_a_room_are_seen() {
    let right = &rooms()[0];
    let reference = room(right, &[], 8300);
    let changed = |from: &str, to: &str| {
        assert!(right.world.contains(from), "{from}");
        Exhibit::new(right.name, inside(), right.world.replacen(from, to, 1))
    };
    let plain = |matter: &Matter| homogeneous("air", matter);
    let fog = plain(&grey(0.5, 0.9, 0.4));
    for (name, wrong) in [
        ("extinction", changed(&fog, &plain(&grey(0.58, 0.9, 0.4)))),
        ("albedo", changed(&fog, &plain(&grey(0.5, 0.84, 0.4)))),
        ("mean cosine", changed(&fog, &plain(&grey(0.5, 0.9, 0.85)))),
        ("lamp", changed("9 8 7", "9.9 8.8 7.7")),
        ("reflectance", changed("0.7 0.7 0.7", "0.65 0.65 0.65")),
        (
            "ball",
            changed("\"float radius\" 0.45", "\"float radius\" 0.55"),
        ),
    ] {
        let picture = room(&wrong, &[], 8301);
        must_kill(name, picture.strongest(&reference, RESOLUTION));
    }
}

#[test]
fn what_is_no_room_is_left_to_scalar_code() {
    let base = walls() + &ceiling_lamp();
    let refused = |more: &str| {
        let exhibit = Exhibit::new("no room", inside(), base.clone() + more);
        !is_room(&staged(&exhibit, &[], Integrator::Path, 1))
    };
    assert!(!refused(""));
    assert!(refused(&sphere(
        "Material \"dielectric\"",
        [0.3, 0.0, 0.0],
        0.3
    )));
    assert!(refused(&disk_above([1.0; 3])), "a disk");
    assert!(
        refused(&sphere(&diffuse([0.5; 3]), [0.3, 0.0, 0.0], 0.01)),
        "too small"
    );
    let over = with_material(
        &diffuse([0.5; 3]),
        &quad([-0.5, -1.0, -0.5], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]),
    );
    assert!(refused(&over), "on top of the floor");
    assert!(
        refused(&filled(&coloured([0.1, 0.2, 0.3], [0.5; 3], 0.0))),
        "coloured extinction"
    );
    let many: String = (0..40)
        .map(|i| sphere(&diffuse([0.5; 3]), [0.0, 0.0, f64::from(i) * 0.01], 0.3))
        .collect();
    assert!(refused(&many), "many");
}
