//! Radiance of light that scattered exactly once, on a ray and in a slab.
//!
//! Henyey–Greenstein; the light, emission and background themselves are excluded. Uncertainty: 10⁻¹¹ relative.

use serde::Deserialize;

/// The medium of an airlight integral, and its light.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(untagged)]
pub enum Setting {
    /// A light travelling along `light_dir` with irradiance 1 across it, on a ball at the origin.
    DirectionalOnSphere {
        /// Radius of the ball; vacuum beyond.
        #[serde(rename = "R")]
        radius: f64,
        /// Unit direction of travel of the light.
        light_dir: [f64; 3],
        /// Extinction [1/length].
        sigma_t: f64,
        /// Scattering [1/length].
        sigma_s: f64,
    },
    /// An isotropic point of power 1 in extinction A e^(−|x − c|²/2s²) that fills all space.
    PointInGaussian {
        /// Position of the light.
        light: [f64; 3],
        /// Peak extinction [1/length].
        #[serde(rename = "A")]
        peak: f64,
        /// Centre.
        c: [f64; 3],
        /// Standard deviation \[length\].
        s: f64,
        /// Scattering over extinction.
        albedo: f64,
    },
    /// An isotropic point of power 1 in a homogeneous medium that fills all space.
    PointInHomogeneous {
        /// Position of the light.
        light: [f64; 3],
        /// Extinction [1/length].
        sigma_t: f64,
        /// Scattering [1/length].
        sigma_s: f64,
    },
}

/// A ray and the once-scattered radiance that arrives at its origin.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
pub struct Case {
    /// Where the ray starts: the camera, or its entry into the ball.
    pub origin: [f64; 3],
    /// Unit direction of the ray, away from the camera.
    pub dir: [f64; 3],
    /// How far it goes \[length\].
    #[serde(rename = "L")]
    pub t_max: f64,
    /// Mean cosine.
    pub g: f64,
    /// Medium and light.
    #[serde(flatten)]
    pub setting: Setting,
    /// L₁, the radiance.
    #[serde(rename = "L1")]
    pub radiance: f64,
}

/// A slab under a beam of irradiance 1 across it.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
pub struct Slab {
    /// Optical thickness.
    pub tau: f64,
    /// Single-scattering albedo.
    pub albedo: f64,
    /// Mean cosine.
    pub g: f64,
    /// Cosine of incidence.
    pub mu0: f64,
    /// Cosine of the way out to the outward normal.
    pub mu: f64,
    /// Azimuth between the directions of travel, degrees; 0 goes on forward.
    pub phi_deg: f64,
    /// Radiance leaving the lit face.
    #[serde(rename = "L1_reflected")]
    pub reflected: f64,
    /// Radiance leaving the far face, scattered part only.
    #[serde(rename = "L1_transmitted")]
    pub transmitted: f64,
}

/// The whole file.
#[derive(Clone, Debug, PartialEq, Deserialize)]
pub struct Table {
    /// Rays.
    pub cases: Vec<Case>,
    /// Slabs.
    pub slab: Vec<Slab>,
}

/// Reads the table.
///
/// # Panics
/// When the file does not match these types.
pub fn load() -> Table {
    super::parse(
        "single_scatter",
        include_str!("../../refs/single_scatter.json"),
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::refs::phase_functions::Kind;
    use crate::refs::quadrature::{close, integrate};
    use statrs::function::erf::erf;
    use std::f64::consts::{FRAC_PI_2, PI, SQRT_2};

    fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
        a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
    }

    fn along(origin: [f64; 3], dir: [f64; 3], t: f64) -> [f64; 3] {
        std::array::from_fn(|i| origin[i] + t * dir[i])
    }

    fn minus(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
        std::array::from_fn(|i| a[i] - b[i])
    }

    /// Optical depth from `a` to `b` of a Gaussian, by the error function.
    fn gaussian_depth(a: [f64; 3], b: [f64; 3], peak: f64, c: [f64; 3], s: f64) -> f64 {
        let step = minus(b, a);
        let length = dot(step, step).sqrt();
        let from_centre = minus(a, c);
        let along = dot(from_centre, step) / length;
        let aside = dot(from_centre, from_centre) - along * along;
        let end = |t: f64| erf(t / (s * SQRT_2));
        peak * (-aside / (2.0 * s * s)).exp()
            * s
            * FRAC_PI_2.sqrt()
            * (end(along + length) - end(along))
    }

    /// Extinction times density, attenuated from the light to `x` and from `x` to the camera.
    fn integrand(case: &Case, t: f64) -> f64 {
        let x = along(case.origin, case.dir, t);
        let phase = Kind::Hg { g: case.g };
        let from_point = |light: [f64; 3]| {
            let step = minus(x, light);
            let squared = dot(step, step);
            let cos = -dot(step, case.dir) / squared.sqrt();
            (squared.sqrt(), phase.eval(cos) / (4.0 * PI * squared))
        };
        match case.setting {
            Setting::PointInHomogeneous {
                light,
                sigma_t,
                sigma_s,
            } => {
                let (distance, incident) = from_point(light);
                sigma_s * incident * (-sigma_t * (t + distance)).exp()
            }
            Setting::PointInGaussian {
                light,
                peak,
                c,
                s,
                albedo,
            } => {
                let offset = minus(x, c);
                let sigma_t = peak * (-dot(offset, offset) / (2.0 * s * s)).exp();
                let depth = gaussian_depth(case.origin, x, peak, c, s)
                    + gaussian_depth(light, x, peak, c, s);
                albedo * sigma_t * from_point(light).1 * (-depth).exp()
            }
            Setting::DirectionalOnSphere {
                radius,
                light_dir,
                sigma_t,
                sigma_s,
            } => {
                // Back towards the light, to where it entered the ball.
                let towards = -dot(x, light_dir);
                let inside = radius * radius - dot(x, x) + towards * towards;
                let entered = inside.max(0.0).sqrt() - towards;
                let cos = -dot(light_dir, case.dir);
                sigma_s * phase.eval(cos) * (-sigma_t * (t + entered)).exp()
            }
        }
    }

    #[test]
    fn airlight_integrals_follow_from_their_definition() {
        let table = load();
        assert_eq!(table.cases.len(), 7);
        for case in &table.cases {
            let name = format!("{:?}", case.setting);
            // A light 0.01 off the ray needs panels of that size.
            let radiance = integrate(0.0, case.t_max, 2000, |t| integrand(case, t));
            close(&name, radiance / case.radiance, 1.0, 1e-9);
        }
    }

    #[test]
    fn each_setting_is_recognised() {
        let cases = load().cases;
        let count = |f: fn(&Setting) -> bool| cases.iter().filter(|c| f(&c.setting)).count();
        assert_eq!(
            count(|s| matches!(s, Setting::PointInHomogeneous { .. })),
            3
        );
        assert_eq!(count(|s| matches!(s, Setting::PointInGaussian { .. })), 2);
        assert_eq!(
            count(|s| matches!(s, Setting::DirectionalOnSphere { .. })),
            2
        );
    }

    #[test]
    fn slabs_follow_from_their_definition() {
        for slab in load().slab {
            let phase = Kind::Hg { g: slab.g };
            let sines = ((1.0 - slab.mu * slab.mu) * (1.0 - slab.mu0 * slab.mu0)).sqrt();
            let across = sines * slab.phi_deg.to_radians().cos();
            let (mu, mu0) = (slab.mu, slab.mu0);
            // Depth t: attenuated on the way in, scattered per unit depth 1/μ, attenuated on the way out.
            let back = integrate(0.0, slab.tau, 8, |t| (-t / mu0 - t / mu).exp() / mu);
            let on = integrate(0.0, slab.tau, 8, |t| {
                (-t / mu0 - (slab.tau - t) / mu).exp() / mu
            });
            let reflected = slab.albedo * phase.eval(across - mu * mu0) * back;
            let transmitted = slab.albedo * phase.eval(across + mu * mu0) * on;
            close("reflected", reflected / slab.reflected, 1.0, 1e-11);
            close("transmitted", transmitted / slab.transmitted, 1.0, 1e-11);
        }
    }
}
