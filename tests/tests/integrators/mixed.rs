//! Surfaces among media in packets, met through a queue: the pictures of the scalar path tracer and of bidirectional paths, the bits of
//! scalar code, furnaces, and what is left to scalar code.

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
    Replicates::of(exhibit.name, &studio, SAMPLES * 4)
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
