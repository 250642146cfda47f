//! Reference tables through the renderer: what camera rays see of balls, cubes and slabs.

use super::assert_near;
use woodcock_host::world::Feature;
use woodcock_tests::pictures::*;
use woodcock_tests::refs::furnace::{self, Density};
use woodcock_tests::refs::single_scatter::{self, Setting};
use woodcock_tests::refs::{scenes3d, slab_matched, slab_radiance};

const CUBE: [Xyz; 2] = [[0.0; 3], [1.0; 3]];

fn moments(studio: &Studio, name: &str, n: u32) -> woodcock_tests::stats::Moments {
    let picture = studio.shoot(n);
    picture.assert_sound(name).moments(1)
}

fn back(from: Xyz, dir: Xyz, by: f64) -> Xyz {
    std::array::from_fn(|i| from[i] - by * dir[i])
}

#[test]
fn balls_in_a_uniform_sky() {
    let table = furnace::load();
    let isotropic = table.isotropic.iter().flat_map(|s| {
        s.b_over_rho
            .iter()
            .zip(&s.radiance)
            .map(move |(b, l)| (s.t, s.albedo, 0.0, *b, *l, 0.0))
    });
    let hg = table.hg.iter().flat_map(|s| {
        s.b_over_rho
            .iter()
            .zip(s.radiance.iter().zip(&s.radiance_error))
            .map(move |(b, (l, e))| (s.t, s.albedo, s.g, *b, *l, *e))
    });
    for (i, (t, albedo, g, b, radiance, error)) in isotropic.chain(hg).enumerate() {
        // The same ball as closed form, as mesh search, with shadow rays, larger, and elsewhere.
        let keep: &[Feature] = match i % 4 {
            0 => &[],
            1 => &[Feature::Boundaries],
            2 => &[Feature::EnvironmentNextEvent],
            _ => &[Feature::Tracking, Feature::Chromatic],
        };
        let scale = if i % 3 == 0 { 50.0 } else { 1.0 };
        let world = sky(1.0)
            + &homogeneous("m", &grey(t / scale, albedo, g))
            + &ball("m", "", [3.0, 0.0, 0.0], scale);
        let camera = single_ray([3.0 + b * scale, 0.0, -2.0 * scale], [0.0, 0.0, 1.0]);
        let studio = stage_keeping(&scene(&camera, [32, 32], &world), keep).seeded(100 + i as u64);
        let name = format!("ball t {t} albedo {albedo} g {g} b {b}");
        assert_near(&name, &moments(&studio, &name, 64), radiance, error, 0.01);
    }
}

/// The world of a unit cube of a density, cut out of a grid where it is not constant.
fn cube(density: Density, albedo: f64, g: f64) -> Option<String> {
    let medium = match density {
        Density::Homogeneous(sigma_t) => homogeneous("m", &grey(sigma_t, albedo, g)),
        // Linear between samples, which begin a sixteenth outside of the cube.
        Density::Linear(_) => uniform_grid(
            "m",
            [10; 3],
            [[-0.125; 3], [1.125; 3]],
            |[x, y, z]| density.sigma_t(x, y, z),
            &grey(1.0, albedo, g),
        ),
        // Jumps are no trilinear grid.
        Density::Checkerboard(_) => return None,
    };
    Some(medium + &block("m", "", CUBE))
}

#[test]
fn cubes_in_a_uniform_sky() {
    let mut seen = 0;
    for (i, table) in furnace::load().cubes.iter().enumerate() {
        let Some(world) = cube(table.density, table.albedo, table.g) else {
            continue;
        };
        for ray in &table.rays {
            let camera = single_ray(back(ray.ray_origin, ray.ray_dir, 1.5), ray.ray_dir);
            let text = scene(&camera, [32, 32], &(sky(1.0) + &world));
            let studio = stage(&text).seeded(200 + i as u64);
            let name = format!("cube {:?} {ray:?}", table.density);
            let m = moments(&studio, &name, 64);
            assert_near(&name, &m, ray.radiance, ray.radiance_error, 0.01);
            seen += 1;
        }
    }
    assert!(seen >= 4, "{seen}");
}

#[test]
fn cubes_under_a_sun() {
    for (i, case) in scenes3d::load().iter().enumerate() {
        let towards = case.light_dir.map(|x| -x);
        let [p0, rest @ ..] = case.p;
        let density = if rest == [0.0; 3] {
            Density::Homogeneous(p0)
        } else {
            Density::Linear(case.p)
        };
        let world = cube(density, case.albedo, case.g).expect("no checkerboard");
        let camera = single_ray(back(case.ray_origin, case.ray_dir, 1.5), case.ray_dir);
        let text = scene(&camera, [32, 32], &(sun(towards, [1.0; 3]) + &world));
        for (keep, depth) in [
            (&[][..], None),
            (&[Feature::Boundaries], None),
            (&[], Some(1)),
        ] {
            let mut studio = stage_keeping(&text, keep).seeded(300 + i as u64);
            studio.plan.settings.max_depth = depth.unwrap_or(u32::MAX);
            let (radiance, error) = match depth {
                None => (case.radiance, case.radiance_error),
                Some(_) => (case.once, case.once_error),
            };
            let name = format!("cube {i} under a sun, depth {depth:?}");
            assert_near(&name, &moments(&studio, &name, 256), radiance, error, 0.01);
        }
    }
}

#[test]
fn a_ball_under_a_sun_after_one_scattering() {
    let mut seen = 0;
    for case in single_scatter::load().cases {
        let Setting::DirectionalOnSphere {
            radius,
            light_dir,
            sigma_t,
            sigma_s,
        } = case.setting
        else {
            continue;
        };
        let world = sun(light_dir.map(|x| -x), [1.0; 3])
            + &homogeneous("m", &grey(sigma_t, sigma_s / sigma_t, case.g))
            + &ball("m", "", [0.0; 3], radius);
        let mut studio = stage(&scene(&single_ray(case.origin, case.dir), [32, 32], &world));
        studio.plan.settings.max_depth = 1;
        let name = format!("single scattering {seen}");
        // The second is backscattering of a peaked lobe, which few samples make up.
        let m = moments(&studio, &name, 256);
        assert_near(&name, &m, case.radiance, 0.0, 0.02);
        seen += 1;
    }
    assert_eq!(seen, 2);
}

/// A slab from z = 0 to 1, so wide that its rim is far: 400 lengths.
const SLAB: [Xyz; 2] = [[-200.0, -200.0, 0.0], [200.0, 200.0, 1.0]];

/// A slab of optical thickness `tau`, homogeneous or `graded` with depth, which must not matter.
fn slab(graded: bool, tau: f64, albedo: f64, g: f64) -> String {
    let matter = grey(tau, albedo, g);
    let medium = if graded {
        // Density 1/2 + z: linear between samples on either side of the block, and constant across it.
        let around = [[-600.0, -600.0, -0.125], [600.0, 600.0, 1.125]];
        uniform_grid("m", [3, 3, 10], around, |[_, _, z]| 0.5 + z, &matter)
    } else {
        homogeneous("m", &matter)
    };
    medium + &block("m", "", SLAB)
}

/// A direction of travel with cosine `mu` to z, turned by `phi` degrees.
fn direction(mu: f64, phi: f64) -> Xyz {
    let (sin, cos) = phi.to_radians().sin_cos();
    let across = (1.0 - mu * mu).sqrt();
    [across * cos, across * sin, mu]
}

#[test]
fn slabs_in_a_uniform_sky_lose_what_they_absorb() {
    // By reciprocity a ray sees R + T of a beam along it.
    let slabs = slab_matched::load().slabs;
    let thin = slabs.iter().filter(|s| s.albedo < 1.0 && s.tau <= 16.0);
    for (i, slab_row) in thin.enumerate() {
        let graded = i % 2 == 1;
        let (mu, fluxes) = slab_row.beams[i % 3];
        let world = sky(1.0) + &slab(graded, slab_row.tau, slab_row.albedo, slab_row.g);
        let camera = single_ray(
            back([0.0; 3], direction(mu, 20.0), 1.0),
            direction(mu, 20.0),
        );
        let studio = stage(&scene(&camera, [32, 32], &world)).seeded(400 + i as u64);
        let name = format!("{slab_row:?} mu {mu} graded {graded}");
        let truth = fluxes.reflectance + fluxes.transmittance;
        assert_near(&name, &moments(&studio, &name, 16), truth, 0.0, 0.02);
    }
}

#[test]
fn slabs_under_a_sun() {
    for (i, case) in slab_radiance::load().iter().enumerate() {
        // The sun shines along +z, cosine mu0; what leaves is seen against its direction of travel.
        let beam = direction(case.mu0, 0.0);
        let world =
            sun(beam.map(|x| -x), [1.0; 3]) + &slab(i % 2 == 1, case.tau, case.albedo, case.g);
        for (j, &mu) in case.mu.iter().enumerate() {
            let k = (i + j) % case.phi_deg.len();
            let phi = case.phi_deg[k];
            for (leaving, at, truth) in [
                (direction(-mu, phi), [0.0; 3], case.reflected[j][k]),
                (direction(mu, phi), [0.0, 0.0, 1.0], case.transmitted[j][k]),
            ] {
                if truth < 1e-4 {
                    continue;
                }
                let dir = leaving.map(|x| -x);
                let camera = single_ray(back(at, dir, 1.0), dir);
                let studio = stage(&scene(&camera, [16, 16], &world)).seeded(500 + j as u64);
                let name = format!("slab {i} under a sun, mu {mu} phi {phi}, {leaving:?}");
                assert_near(&name, &moments(&studio, &name, 64), truth, 0.0, 0.1);
            }
        }
    }
}

#[test]
fn planted_mistakes_are_told_apart() {
    // Each is a plausible slip of a few per cent; the comparisons above must see it at ten standard errors.
    let case = slab_radiance::load()[0].clone();
    let (mu, phi) = (case.mu[0], case.phi_deg[0]);
    let beam = direction(case.mu0, 0.0);
    let dir = direction(-mu, phi).map(|x| -x);
    let look = |albedo: f64, tau: f64, g: f64, strength: f64, sky_too: f64| {
        let world =
            sky(sky_too) + &sun(beam.map(|x| -x), [strength; 3]) + &slab(false, tau, albedo, g);
        let text = scene(&single_ray(back([0.0; 3], dir, 1.0), dir), [32, 32], &world);
        moments(&stage(&text).seeded(600), "planted", 1024)
    };
    let (albedo, tau, g) = (case.albedo, case.tau, case.g);
    let truth = case.reflected[0][0];
    for (name, m) in [
        ("albedo", look(0.95 * albedo, tau, g, 1.0, 0.0)),
        ("phase", look(albedo, tau, g + 0.05, 1.0, 0.0)),
        ("sun", look(albedo, tau, g, 1.05, 0.0)),
        ("sky", look(albedo, tau, g, 1.0, 0.05 * truth)),
    ] {
        let verdict = woodcock_tests::stats::judge(&m, truth, 0.01);
        woodcock_tests::stats::must_kill(name, verdict);
    }
}
