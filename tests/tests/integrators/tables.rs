//! Reference tables of media without surfaces, through the scalar integrators.
//!
//! A slab is a block of 1 × 400 × 400, seen in its middle. The tables' slabs have no rim, which is 200 lengths off: of a
//! flight of 100 lengths, half of that way, e^−100 τ is left, 5·10⁻⁵ for the thinnest slab here (τ = 0.1), and light that
//! scatters often walks no further than a few thicknesses. Half of the environment is a square of half edge 10⁴ at a
//! distance of 10: all but 10⁻⁶ of a hemisphere's irradiance.

use crate::closed_forms::measure::*;
use std::f64::consts::PI;
use woodcock_host::integrator::Integrator;
use woodcock_tests::pictures::*;
use woodcock_tests::refs::single_scatter::{self, Case, Setting};
use woodcock_tests::refs::{halfspace, scenes3d, slab_matched, slab_radiance};

const ONCE: [Integrator; 3] = [Single, Path, Bdpt];
const SLAB: [Xyz; 2] = [[-200.0, -200.0, 0.0], [200.0, 200.0, 1.0]];

fn point_of_power_one(at: Xyz) -> String {
    point_light(at, [1.0 / (4.0 * PI); 3])
}

/// Direction of a beam with cosine `mu` to +z, turned by an azimuth in degrees.
fn direction(mu: f64, phi: f64) -> Xyz {
    let across = (1.0 - mu * mu).max(0.0).sqrt();
    let (sin, cos) = phi.to_radians().sin_cos();
    [across * cos, across * sin, mu]
}

/// A black square that ends a ray.
fn end_of(case: &Case) -> String {
    let end = std::array::from_fn(|i| case.origin[i] + case.t_max * case.dir[i]);
    // Two directions across the ray, which leads along z, roughly.
    let [x, y, z] = case.dir;
    made_of(&black(), &quad(end, [z, 0.0, -x], [0.0, z, -y]))
}

/// A Gaussian that trilinear interpolation turns into the one asked for: it widens by h² / 6 along each axis.
fn gaussian_grid(c: Xyz, s: f64, peak: f64, albedo: f64, g: f64) -> String {
    const CELLS: usize = 50;
    let half = 4.2 * s;
    let h = 2.0 * half / CELLS as f64;
    let narrow = (s * s - h * h / 6.0).sqrt();
    let bounds = [c.map(|x| x - half), c.map(|x| x + half)];
    let density = |place: Xyz| {
        let squared: f64 = (0..3).map(|i| (place[i] - c[i]).powi(2)).sum();
        (s / narrow).powi(3) * (-squared / (2.0 * narrow * narrow)).exp()
    };
    uniform_grid("m", [CELLS; 3], bounds, density, &grey(peak, albedo, g)) + &block("m", "", bounds)
}

#[test]
fn airlight_of_points() {
    for (i, case) in single_scatter::load().cases.iter().enumerate() {
        let camera = single_ray(case.origin, case.dir);
        let (text, replicates, truth_error) = match case.setting {
            Setting::PointInHomogeneous {
                light,
                sigma_t,
                sigma_s,
            } => {
                let fog = homogeneous("fog", &grey(sigma_t, sigma_s / sigma_t, case.g));
                let world = point_of_power_one(light) + &end_of(case);
                let text = scene(&in_fog(&fog, "fog", &camera), [32, 32], &world);
                // The third passes the light at a hundredth.
                (text, if i == 2 { 256 } else { 96 }, 0.0)
            }
            Setting::PointInGaussian {
                light,
                peak,
                c,
                s,
                albedo,
            } => {
                let world = point_of_power_one(light) + &gaussian_grid(c, s, peak, albedo, case.g);
                // Ripples of the grid, and what lies beyond it.
                (scene(&camera, [32, 32], &world), 160, 5e-4)
            }
            Setting::DirectionalOnSphere { .. } => continue,
        };
        Trial {
            by: &ONCE,
            depth: Some(1),
            replicates,
            truth_error,
            resolution: 0.03,
            wrong: &[
                ("4π forgotten", times([case.radiance; 3], 12.566_37)),
                ("half as much light again", times([case.radiance; 3], 1.5)),
            ],
            ..Trial::new(&format!("airlight {i}"), &text, [case.radiance; 3])
        }
        .run();
    }
}

#[test]
fn airlight_of_a_sun() {
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
        let text = scene(&single_ray(case.origin, case.dir), [32, 32], &world);
        let truth = [case.radiance; 3];
        Trial {
            by: &ONCE,
            depth: Some(1),
            replicates: 128,
            resolution: 0.02,
            wrong: &[("half as much light again", times(truth, 1.5))],
            ..Trial::new(&format!("sun on a ball {seen}"), &text, truth)
        }
        .run();
        seen += 1;
    }
    assert_eq!(seen, 2);
}

fn slab(tau: f64, albedo: f64, g: f64) -> String {
    homogeneous("m", &grey(tau, albedo, g)) + &block("m", "", SLAB)
}

/// A density of 1/2 + z across the block of a slab, which must not matter.
fn graded(tau: f64, albedo: f64, g: f64) -> String {
    let bounds = [[-300.0, -300.0, -0.125], [300.0, 300.0, 1.125]];
    uniform_grid(
        "m",
        [1, 1, 10],
        bounds,
        |[_, _, z]| 0.5 + z,
        &grey(tau, albedo, g),
    ) + &block("m", "", SLAB)
}

#[test]
fn slabs_under_a_sun_after_one_scattering() {
    for (i, row) in single_scatter::load().slab.iter().enumerate() {
        let world =
            sun(direction(row.mu0, 0.0).map(|x| -x), [1.0; 3]) + &slab(row.tau, row.albedo, row.g);
        for (name, leaving, z, truth) in [
            (
                "reflects",
                direction(-row.mu, row.phi_deg),
                0.0,
                row.reflected,
            ),
            (
                "transmits",
                direction(row.mu, row.phi_deg),
                1.0,
                row.transmitted,
            ),
        ] {
            let camera = ray_to([0.0, 0.0, z], leaving.map(|x| -x), 1.0);
            Trial {
                by: &ONCE,
                depth: Some(1),
                wrong: &[
                    ("20 % less light", times([truth; 3], 0.8)),
                    ("20 % more light", times([truth; 3], 1.2)),
                ],
                ..Trial::new(
                    &format!("slab {i} {name} once"),
                    &scene(&camera, [32, 32], &world),
                    [truth; 3],
                )
            }
            .run();
        }
    }
}

/// Radiance 1 from all directions with z below zero, by a lamp.
fn near_half() -> String {
    lamp([1.0; 3], &level(-10.0, 1e4, true))
}

/// The same by a sky whose other half is covered.
fn near_half_of_sky() -> String {
    sky(1.0) + &made_of(&black(), &level(11.0, 1e4, false))
}

fn far_half() -> String {
    lamp([1.0; 3], &level(11.0, 1e4, false))
}

fn far_half_of_sky() -> String {
    sky(1.0) + &made_of(&black(), &level(-10.0, 1e4, true))
}

#[test]
fn slabs_reflect_and_transmit() {
    let slabs = slab_matched::load().slabs;
    let moderate = slabs.iter().filter(|s| s.tau >= 0.1 && s.tau <= 4.0);
    let mut seen = 0;
    for (i, row) in moderate.enumerate().filter(|(i, _)| i % 4 == 1) {
        let (mu, fluxes) = row.beams[seen % 2];
        let matter = if seen % 2 == 0 { slab } else { graded }(row.tau, row.albedo, row.g);
        let (near, far) = if seen % 3 == 0 {
            (near_half_of_sky(), far_half_of_sky())
        } else {
            (near_half(), far_half())
        };
        let camera = ray_to([0.0; 3], direction(mu, 20.0), 1.0);
        for (name, light, truth) in [
            ("R", near, fluxes.reflectance),
            ("T", far, fluxes.transmittance),
        ] {
            let mistaken = match name {
                "R" => fluxes.transmittance,
                _ => (-row.tau / mu).exp(),
            };
            let wrong = [(
                "light on the other side, or none that scattered",
                [mistaken; 3],
            )];
            let apart = (mistaken / truth - 1.0).abs() > 0.5 && mistaken > 0.01;
            let ways: &[(&[Integrator], u32)] = if seen % 2 == 0 {
                &[(&[Path], 128), (&[Bdpt], 32)]
            } else {
                &[(&[Path], 128)]
            };
            for &(by, replicates) in ways {
                Trial {
                    by,
                    replicates,
                    resolution: 0.03,
                    wrong: &wrong[..usize::from(apart)],
                    ..Trial::new(
                        &format!("slab {i}, {name}"),
                        &scene(&camera, [32, 32], &(light.clone() + &matter)),
                        [truth; 3],
                    )
                }
                .run();
            }
        }
        seen += 1;
    }
    assert!(seen >= 6, "{seen}");
}

#[test]
fn thick_matter_reflects_as_chandrasekhar_says() {
    // Forty optical depths: less than e^−40 comes back from beyond (albedo 0.9 decays by 0.525 a depth, twice).
    let table = halfspace::load();
    for case in table.cases.iter().filter(|c| c.albedo <= 0.9) {
        for i in [2, 7] {
            let mu = table.mu[i];
            let camera = ray_to([0.0; 3], direction(mu, 70.0), 1.0);
            let world = sky(1.0) + &slab(40.0, case.albedo, 0.0);
            let truth = case.plane_albedo[i];
            Trial {
                by: if i == 2 { &[Path, Bdpt] } else { &[Path] },
                replicates: 32,
                resolution: 0.02,
                wrong: &[("30 % more light", times([truth; 3], 1.3))],
                ..Trial::new(
                    &format!("half-space {} at {mu} under a sky", case.albedo),
                    &scene(&camera, [32, 32], &world),
                    [truth; 3],
                )
            }
            .run();
            for brdf in &case.brdf {
                let truth = brdf.brdf_at_mu[i] * brdf.mu0;
                let beam = direction(brdf.mu0, 0.0);
                let world = sun(beam.map(|x| -x), [1.0; 3]) + &slab(40.0, case.albedo, 0.0);
                let once = case.albedo / (4.0 * PI) / (mu + brdf.mu0) * brdf.mu0;
                Trial {
                    by: if i == 2 && brdf.mu0 == 1.0 {
                        &[Path, Bdpt]
                    } else {
                        &[Path]
                    },
                    replicates: 32,
                    resolution: 0.02,
                    wrong: &[
                        ("twice the light", times([truth; 3], 2.0)),
                        ("one scattering alone", [once; 3]),
                    ],
                    ..Trial::new(
                        &format!(
                            "half-space {} at {mu} under a sun {}",
                            case.albedo, brdf.mu0
                        ),
                        &scene(&camera, [32, 32], &world),
                        [truth; 3],
                    )
                }
                .run();
            }
        }
    }
}

#[test]
fn slabs_under_a_sun() {
    for (i, case) in slab_radiance::load().iter().enumerate() {
        let beam = direction(case.mu0, 0.0);
        let matter = if i % 2 == 0 { slab } else { graded };
        let world = sun(beam.map(|x| -x), [1.0; 3]) + &matter(case.tau, case.albedo, case.g);
        let j = (2 + i) % case.mu.len();
        let k = i % case.phi_deg.len();
        let (mu, phi) = (case.mu[j], case.phi_deg[k]);
        for (name, leaving, z, truth) in [
            ("reflects", direction(-mu, phi), 0.0, case.reflected[j][k]),
            ("transmits", direction(mu, phi), 1.0, case.transmitted[j][k]),
        ] {
            if truth < 1e-4 {
                continue;
            }
            let camera = ray_to([0.0, 0.0, z], leaving.map(|x| -x), 1.0);
            Trial {
                by: if i % 3 == 0 { &[Path, Bdpt] } else { &[Path] },
                replicates: 32,
                resolution: 0.06,
                wrong: &[("half as much light again", times([truth; 3], 1.7))],
                ..Trial::new(
                    &format!("slab {i} {name} at {mu}, {phi}"),
                    &scene(&camera, [32, 32], &world),
                    [truth; 3],
                )
            }
            .run();
        }
    }
}

#[test]
fn cubes_lit_by_points() {
    const CUBE: [Xyz; 2] = [[0.0; 3], [1.0; 3]];
    for (i, case) in scenes3d::load_point_lit().iter().enumerate() {
        let lit = case.rest;
        let [p0, p1, p2, p3] = lit.p;
        let medium = if [p1, p2, p3] == [0.0; 3] {
            homogeneous("m", &grey(p0, lit.albedo, lit.g))
        } else {
            // Linear between samples, which begin a sixteenth outside of the cube.
            uniform_grid(
                "m",
                [10; 3],
                [[-0.125; 3], [1.125; 3]],
                |[x, y, z]| p0 + p1 * x + p2 * y + p3 * z,
                &grey(1.0, lit.albedo, lit.g),
            )
        };
        let world = point_of_power_one(case.light_pos) + &medium + &block("m", "", CUBE);
        let text = scene(&ray_to(lit.ray_origin, lit.ray_dir, 1.5), [32, 32], &world);
        let all = [lit.radiance; 3];
        let once = [lit.once; 3];
        for (name, by, depth, truth, error, wrong) in [
            (
                "once",
                &ONCE[..],
                Some(1),
                once,
                lit.once_error / lit.once,
                all,
            ),
            (
                "all",
                &[Path, Bdpt],
                None,
                all,
                lit.radiance_error / lit.radiance,
                once,
            ),
        ] {
            Trial {
                by,
                depth,
                truth_error: error,
                replicates: 128,
                resolution: 0.02,
                wrong: &[
                    ("another bound on scatterings", wrong),
                    ("30 % more light", times(truth, 1.3)),
                ],
                ..Trial::new(&format!("cube {i} lit by a point, {name}"), &text, truth)
            }
            .run();
        }
    }
}
