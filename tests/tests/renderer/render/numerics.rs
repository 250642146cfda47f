//! Scenes that single precision finds hard: far away, tiny, huge, edge on, and exactly on a boundary.

use super::assert_near;
use woodcock_host::world::Feature;
use woodcock_tests::pictures::*;

fn absorbing(sigma: f64) -> Matter {
    grey(sigma, 0.0, 0.0)
}

#[track_caller]
fn assert_depth(name: &str, text: &str, keep: &[Feature], depth: f64) {
    let picture = stage_keeping(text, keep).shoot(64);
    picture.assert_sound(name);
    assert_near(name, &picture.moments(0), (-depth).exp(), 0.0, 0.02);
}

/// A cube of this half edge about a centre, homogeneous or on a grid that is constant within it.
fn cube(centre: Xyz, half: f64, sigma: f64, grid: bool) -> String {
    let corners = |h: f64| [centre.map(|c| c - h), centre.map(|c| c + h)];
    let medium = if grid {
        uniform_grid("m", [8; 3], corners(1.5 * half), |_| 1.0, &absorbing(sigma))
    } else {
        homogeneous("m", &absorbing(sigma))
    };
    medium + &block("m", "", corners(half))
}

#[test]
fn far_from_the_origin_of_the_world() {
    for offset in [1e4, 1e6, -3e8] {
        let centre = [offset, -0.7 * offset, 0.3 * offset];
        for grid in [false, true] {
            for keep in [&[][..], &[Feature::Boundaries]] {
                let from = [centre[0] + 0.25, centre[1], centre[2] - 3.0];
                let world = sky(1.0) + &cube(centre, 1.0, 0.6, grid);
                let text = scene(&single_ray(from, [0.0, 0.0, 1.0]), [32, 32], &world);
                assert_depth(&format!("at {offset}, grid {grid}"), &text, keep, 1.2);
            }
        }
    }
}

#[test]
fn tiny_and_huge_scenes() {
    for unit in [1e-9, 1e-6, 1e6, 1e9] {
        for grid in [false, true] {
            for keep in [&[][..], &[Feature::Boundaries]] {
                let camera = format!(
                    "LookAt {} 0 {} {} 0 0 0 1 0\nCamera \"orthographic\" \"float screenwindow\" [ {h} {m} {h} {m} ]",
                    0.25 * unit,
                    -3.0 * unit,
                    0.25 * unit,
                    h = -1e-7 * unit,
                    m = 1e-7 * unit,
                );
                let world = sky(1.0) + &cube([0.0; 3], unit, 0.6 / unit, grid);
                let text = scene(&camera, [32, 32], &world);
                assert_depth(&format!("unit {unit}, grid {grid}"), &text, keep, 1.2);
            }
        }
    }
}

#[test]
fn scattering_does_not_depend_on_the_unit_of_length() {
    // Powers of two scale all of single precision exactly, so even the bits stay.
    let shoot = |unit: f64, grid: bool| {
        let corners = [[-unit; 3], [unit; 3]];
        let matter = grey(3.0 / unit, 0.9, 0.4);
        let medium = if grid {
            uniform_grid(
                "m",
                [8; 3],
                corners,
                |[x, ..]| 1.0 + 0.5 * x / unit,
                &matter,
            )
        } else {
            homogeneous("m", &matter)
        };
        let world =
            sky(0.5) + &sun([1.0, 1.0, -1.0], [1.0; 3]) + &medium + &block("m", "", corners);
        let camera = perspective([0.0, unit, -4.0 * unit], [0.0, -0.25, 1.0], 45.0);
        stage(&scene(&camera, [16, 16], &world))
            .shoot_range(0..4)
            .film
    };
    for grid in [false, true] {
        let unit = shoot(1.0, grid);
        assert!(unit == shoot(1024.0, grid), "grid {grid}");
        assert!(unit == shoot(1.0 / 1_048_576.0, grid), "grid {grid}");
    }
}

#[test]
fn rays_along_axes_edges_and_diagonals() {
    // A face's diagonal lies on x = y for rays along z, and its edges at ±1: the rays run exactly in them.
    let world = |grid| sky(1.0) + &cube([0.0; 3], 1.0, 0.6, grid);
    for grid in [false, true] {
        for keep in [&[][..], &[Feature::Boundaries]] {
            for (from, towards, length) in [
                ([0.0, 0.0, -3.0], [0.0, 0.0, 1.0], 2.0),
                ([0.5, 0.5, -3.0], [0.0, 0.0, 1.0], 2.0),
                ([-0.5, 0.5, 3.0], [0.0, 0.0, -1.0], 2.0),
                ([3.0, 0.25, 0.25], [-1.0, 0.0, 0.0], 2.0),
                ([0.25, 3.0, -0.25], [0.0, -1.0, 0.0], 2.0),
                // Through two opposite edges, and two opposite corners.
                ([-3.0, -3.0, 0.0], [1.0, 1.0, 0.0], 8.0_f64.sqrt()),
                ([-3.0, -3.0, -3.0], [1.0, 1.0, 1.0], 12.0_f64.sqrt()),
            ] {
                // A window of no width would be refused; this one is below the rounding of the place.
                let camera = orthographic(from, towards, 1e-12);
                let name = format!("{from:?} {towards:?}, grid {grid}");
                assert_depth(
                    &name,
                    &scene(&camera, [32, 32], &world(grid)),
                    keep,
                    0.6 * length,
                );
            }
        }
    }
}

#[test]
fn rays_within_a_face_cross_it_once_or_never() {
    for grid in [false, true] {
        for keep in [&[][..], &[Feature::Boundaries]] {
            for from in [
                [1.0, 0.3, -3.0],
                [-1.0, 0.3, -3.0],
                [1.0, 1.0, -3.0],
                [0.2, -1.0, -3.0],
            ] {
                let camera = orthographic(from, [0.0, 0.0, 1.0], 1e-12);
                let world = sky(1.0) + &cube([0.0; 3], 1.0, 0.6, grid);
                let picture = stage_keeping(&scene(&camera, [32, 32], &world), keep).shoot(16);
                picture.assert_sound("in a face");
                let mean = picture.moments(0).mean();
                let (never, once) = (1.0, (-1.2_f64).exp());
                let near = |truth: f64| (mean - truth).abs() < 0.02;
                assert!(near(never) || near(once), "{from:?}: {mean}");
            }
        }
    }
}

#[test]
fn a_camera_on_the_boundary() {
    let inwards = [0.0, 0.0, 1.0];
    for grid in [false, true] {
        for keep in [&[][..], &[Feature::Boundaries]] {
            let world = sky(1.0) + &cube([0.0; 3], 1.0, 0.6, grid);
            let text = scene(&single_ray([0.25, 0.125, -1.0], inwards), [32, 32], &world);
            assert_depth("on a block, inwards", &text, keep, 1.2);
            let text = scene(&single_ray([0.25, 0.125, 1.0], inwards), [16, 16], &world);
            let picture = stage_keeping(&text, keep).shoot(4);
            picture
                .assert_sound("out")
                .assert_constant("on a block, outwards", 1.0, 1e-6);
        }
    }
    let world = sky(1.0) + &homogeneous("m", &absorbing(0.6)) + &ball("m", "", [0.0; 3], 1.0);
    for keep in [&[][..], &[Feature::Boundaries]] {
        let text = scene(&single_ray([0.0, 0.0, -1.0], inwards), [32, 32], &world);
        assert_depth("on a ball", &text, keep, 1.2);
    }
}

#[test]
fn thin_and_thick_media_end() {
    for sigma in [1e-30, 1e-12, 1e6, 1e20, 1e30] {
        for grid in [false, true] {
            let corners = [[-1.0; 3], [1.0; 3]];
            let matter = grey(sigma, 0.5, 0.0);
            let medium = if grid {
                uniform_grid("m", [8; 3], corners, |_| 1.0, &matter)
            } else {
                homogeneous("m", &matter)
            };
            let world =
                sky(1.0) + &sun([0.0, 1.0, -1.0], [1.0; 3]) + &medium + &block("m", "", corners);
            let camera = perspective([0.0, 0.0, -4.0], [0.0, 0.0, 1.0], 30.0);
            let picture = stage(&scene(&camera, [16, 16], &world)).shoot_range(0..2);
            picture.assert_sound("extreme extinction");
            for (.., pixel) in picture.film.pixels() {
                let [r, ..] = pixel.mean();
                assert!((0.0..=2.0).contains(&r), "sigma {sigma}, grid {grid}: {r}");
            }
        }
    }
}

#[test]
fn extreme_phase_functions() {
    for g in [0.999_999, -0.999_999, 0.99, -0.99, 1e-6, 1e-30] {
        let world =
            sky(1.0) + &homogeneous("m", &grey(3.0, 1.0, g)) + &ball("m", "", [0.0; 3], 1.0);
        let camera = perspective([0.0, 0.0, -3.0], [0.0, 0.0, 1.0], 40.0);
        let text = scene(&camera, [16, 16], &world);
        let name = format!("g {g}");
        stage(&text)
            .shoot_range(0..4)
            .assert_sound(&name)
            .assert_constant(&name, 1.0, 1e-6);
        if g.abs() < 0.999 {
            let picture = stage_keeping(&text, &[Feature::EnvironmentNextEvent]).shoot(64);
            picture.assert_sound(&name);
            assert_near(&name, &picture.moments(0), 1.0, 0.0, 0.01);
        }
    }
}

#[test]
fn white_and_thick_ends_in_bounded_time() {
    // As many collisions as the mean chord is thick, on average; the tail is long.
    let world = sky(1.0) + &homogeneous("m", &grey(1e3, 1.0, 0.0)) + &ball("m", "", [0.0; 3], 1.0);
    let camera = single_ray([0.3, 0.0, -3.0], [0.0, 0.0, 1.0]);
    let picture = stage(&scene(&camera, [8, 8], &world)).shoot_range(0..8);
    picture
        .assert_sound("thick")
        .assert_constant("thick", 1.0, 1e-6);
    assert!(picture.counts.real_collisions > picture.counts.paths);
}
