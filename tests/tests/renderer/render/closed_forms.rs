//! Absorption alone: the mean over paths of a ray is e^−τ, and τ is known in closed form or cell by cell.

use super::{assert_near, volume, volume_bytes};
use glam::DVec3;
use woodcock_host::volume::{Limits, vdb};
use woodcock_host::world::Feature;
use woodcock_tests::pictures::*;

const UNIT: [Xyz; 2] = [[-1.0; 3], [1.0; 3]];

fn absorbing(sigma: f64) -> Matter {
    grey(sigma, 0.0, 0.0)
}

/// Renders one ray through absorbers under a sky of one, and compares with e^−τ by colour.
#[track_caller]
fn assert_depth(name: &str, studio: &Studio, depth: Xyz) {
    let picture = studio.shoot(64);
    picture.assert_sound(name);
    for (channel, depth) in depth.into_iter().enumerate() {
        let name = format!("{name}, channel {channel}");
        assert_near(&name, &picture.moments(channel), (-depth).exp(), 0.0, 0.02);
    }
}

fn ray(from: Xyz, towards: Xyz, world: &str) -> String {
    scene(&single_ray(from, towards), [32, 32], &(sky(1.0) + world))
}

#[test]
fn chords_of_balls_and_blocks() {
    let m = homogeneous("m", &absorbing(0.7));
    for b in [0.0, 0.3, 0.8] {
        let chord = 2.0 * (1.0_f64 - b * b).sqrt();
        let text = ray(
            [b, 0.0, -4.0],
            [0.0, 0.0, 1.0],
            &(m.clone() + &ball("m", "", [0.0; 3], 1.0)),
        );
        for keep in [
            &[][..],
            &[Feature::Boundaries],
            &[Feature::Tracking, Feature::Chromatic],
        ] {
            assert_depth("ball", &stage_keeping(&text, keep), [0.7 * chord; 3]);
        }
    }
    // Through the corner of a block: in at z = −1, out at x = 1.
    let text = ray(
        [-0.5, 0.2, -2.0],
        [1.0, 0.0, 1.0],
        &(m + &block("m", "", UNIT)),
    );
    for keep in [&[][..], &[Feature::Boundaries], &[Feature::SeveralMedia]] {
        assert_depth(
            "block",
            &stage_keeping(&text, keep),
            [0.7 * 0.5 * 2.0_f64.sqrt(); 3],
        );
    }
}

#[test]
fn each_colour_is_absorbed_by_its_own_coefficient() {
    let sigma = [0.1, 0.7, 1.2];
    let matter = coloured(sigma, [0.0; 3], 0.0);
    for world in [
        homogeneous("m", &matter) + &block("m", "", UNIT),
        // A grid that is constant wherever the block is.
        uniform_grid("m", [9; 3], [[-2.0; 3], [2.0; 3]], |_| 1.0, &matter) + &block("m", "", UNIT),
    ] {
        let text = ray([0.3, 0.1, -2.0], [0.0, 0.0, 1.0], &world);
        assert_depth("colours", &stage(&text), sigma.map(|s| 2.0 * s));
        assert_depth(
            "colours, kept",
            &stage_keeping(&text, &[Feature::Boundaries]),
            sigma.map(|s| 2.0 * s),
        );
    }
}

#[test]
fn absorption_by_colour_that_adds_up_to_grey() {
    // Extinction is grey, albedo is not: a kernel of one weight must still colour what it scatters.
    let matter = coloured([0.0, 0.5, 1.0], [1.0, 0.5, 0.0], 0.0);
    let world = homogeneous("m", &matter) + &ball("m", "", [0.0; 3], 1.0);
    let picture = stage(&ray([0.0, 0.0, -4.0], [0.0, 0.0, 1.0], &world)).shoot(64);
    picture.assert_sound("albedo by colour");
    assert_near("white", &picture.moments(0), 1.0, 0.0, 1e-6);
    assert_near("black", &picture.moments(2), (-2.0_f64).exp(), 0.0, 0.02);
    let middle = picture.moments(1).mean();
    assert!(
        middle > picture.moments(2).mean() && middle < 1.0,
        "{middle}"
    );
}

#[test]
fn grids_fade_to_nothing_over_half_a_cell() {
    // Samples lie at cell centres and nothing lies beyond: at a face the density is one half.
    for cells in [1, 2, 7, 30] {
        let h = 2.0 / cells as f64;
        let along = h * (cells as f64 - 0.25);
        let world = uniform_grid("m", [cells, 1, 1], UNIT, |_| 1.0, &absorbing(0.5))
            + &block("m", "", UNIT);
        let text = ray([-3.0, 0.0, 0.0], [1.0, 0.0, 0.0], &world);
        assert_depth("constant grid", &stage(&text), [0.5 * along; 3]);
    }
}

#[test]
fn a_linear_grid_on_an_oblique_ray() {
    // Density 1 + z/2 between the outermost samples; the block keeps to where it is linear.
    let density = |[_, _, z]: Xyz| 1.0 + 0.5 * z;
    let world = uniform_grid(
        "m",
        [5, 6, 7],
        [[-1.5; 3], [1.5; 3]],
        density,
        &absorbing(0.6),
    ) + &block("m", "", UNIT);
    // From (−1, −1/2, −1) to (1, 1/2, 1): the mean of z is 0.
    let text = ray([-2.0, -1.0, -2.0], [2.0, 1.0, 2.0], &world);
    assert_depth("linear", &stage(&text), [0.6 * 3.0; 3]);
    // Half of it, from a camera inside: z runs from 0 to 1.
    let text = ray([0.0; 3], [2.0, 1.0, 2.0], &world);
    assert_depth("from within", &stage(&text), [0.6 * 1.5 * 1.25; 3]);
}

#[test]
fn volume_files_on_rays_in_all_directions() {
    for (file, from, to) in [
        ("cloud_zip.vdb", [0.1, 0.7, -3.0], [0.0, 0.8, 3.0]),
        ("cloud_half_blosc.vdb", [-3.0, 0.2, -1.0], [3.0, 1.3, 1.2]),
        ("quantised_zip.vdb", [1.5, 5.0, 2.0], [1.4, -2.0, 1.7]),
        ("cloud_blosc.vdb", [0.05, 0.65, 0.0], [2.0, 1.5, 2.5]),
    ] {
        let read = vdb::read(&volume_bytes(file), &Limits::default()).expect("readable");
        let grid = read.grid("density").expect("a density");
        let depth = grid
            .line_integral(0, DVec3::from_array(from), DVec3::from_array(to))
            .expect("an integral");
        assert!(depth > 0.01, "{file}: the ray meets the volume, {depth}");
        // An optical depth around one is measured best.
        let sigma = 1.2 / depth;
        let towards = std::array::from_fn(|i| to[i] - from[i]);
        let world = openvdb("m", file, &absorbing(sigma)) + &block("m", "", [[-9.0; 3], [9.0; 3]]);
        let text = ray(from, towards, &world);
        assert_depth(file, &stage_with(&text, volume(file), &[]), [1.2; 3]);
        let kept = [
            Feature::Boundaries,
            Feature::SeveralMedia,
            Feature::Chromatic,
        ];
        assert_depth(file, &stage_with(&text, volume(file), &kept), [1.2; 3]);
    }
}

#[test]
fn a_transform_places_a_grid_and_keeps_its_coefficients() {
    // A rotated, sheared and stretched grid: depth counts world length.
    let grid = uniform_grid("m", [9; 3], UNIT, |_| 1.0, &absorbing(0.5));
    let place = "AttributeBegin\nTranslate 2 1 0\nRotate 30 0 0 1\nScale 3 2 0.5\n\
                 ConcatTransform [ 1 0 0 0  0.4 1 0 0  0 0 1 0  0 0 0 1 ]\n";
    let world = format!("{place}{grid}AttributeEnd\n") + &block("m", "", [[-20.0; 3], [20.0; 3]]);
    // Along z, through the middle, which shears and turns leave where it is: 9 cells of 1/9.
    let text = ray([2.0, 1.0, -5.0], [0.0, 0.0, 1.0], &world);
    assert_depth("placed", &stage(&text), [0.5 * (9.0 - 0.25) / 9.0; 3]);
}

#[test]
fn media_that_overlap_add_up() {
    let world = homogeneous("a", &absorbing(0.3))
        + &homogeneous("b", &absorbing(0.5))
        + &uniform_grid("c", [9; 3], [[-4.0; 3], [4.0; 3]], |_| 1.0, &absorbing(0.2))
        + &ball("a", "", [0.0; 3], 1.0)
        + &block("b", "", [[-0.5, -0.5, 0.0], [0.5, 0.5, 2.0]])
        + &block("c", "", [[-1.0, -1.0, -0.25], [1.0, 1.0, 0.75]]);
    let depth = 0.3 * 2.0 + 0.5 * 2.0 + 0.2;
    assert_depth(
        "overlap",
        &stage(&ray([0.0, 0.0, -3.0], [0.0, 0.0, 1.0], &world)),
        [depth; 3],
    );
    // From within all three.
    let depth = 0.3 * 0.5 + 0.5 * 1.5 + 0.2 * 0.25;
    assert_depth(
        "overlap, within",
        &stage(&ray([0.0, 0.0, 0.5], [0.0, 0.0, 1.0], &world)),
        [depth; 3],
    );
}

#[test]
fn a_named_outside_gives_way() {
    let world = homogeneous("fog", &absorbing(0.3))
        + &homogeneous("core", &absorbing(2.0))
        + &ball("fog", "", [0.0; 3], 1.0)
        + &ball("core", "fog", [0.0; 3], 0.25);
    let through = 0.3 * 1.5 + 2.0 * 0.5;
    assert_depth(
        "core",
        &stage(&ray([0.0, 0.0, -3.0], [0.0, 0.0, 1.0], &world)),
        [through; 3],
    );
    assert_depth(
        "beside",
        &stage(&ray([0.6, 0.0, -3.0], [0.0, 0.0, 1.0], &world)),
        [0.3 * 1.6; 3],
    );
    assert_depth(
        "from the core",
        &stage(&ray([0.0; 3], [0.0, 0.0, 1.0], &world)),
        [0.3 * 0.75 + 0.5; 3],
    );
    // A hole of vacuum in the core.
    let hole = world + &ball("", "core", [0.0; 3], 0.1);
    let text = ray([0.0, 0.0, -3.0], [0.0, 0.0, 1.0], &hole);
    assert_depth("hole", &stage(&text), [0.3 * 1.5 + 2.0 * 0.3; 3]);
}

#[test]
fn a_fog_without_bounds_around_the_camera() {
    // No sky reaches through it; a sun would not either. Only what scatters near the camera counts: none.
    let camera = single_ray([0.0, 0.0, -3.0], [0.0, 0.0, 1.0]);
    let fog = homogeneous("fog", &absorbing(0.3));
    let before = format!("{fog}MediumInterface \"\" \"fog\"\n{camera}");
    let picture = stage(&scene(&before, [8, 8], &sky(1.0))).shoot(16);
    picture.assert_sound("fog").assert_constant("fog", 0.0, 0.0);
}
