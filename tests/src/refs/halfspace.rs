//! The semi-infinite isotropic medium: Chandrasekhar's H function and what follows from it.
//!
//! Independent of the extinction. Uncertainty: 10⁻¹² relative.

use serde::Deserialize;

/// Reflected radiance over incident irradiance for one angle of incidence [1/sr].
#[derive(Clone, Debug, PartialEq, Deserialize)]
pub struct Brdf {
    /// Cosine of incidence.
    pub mu0: f64,
    /// At each cosine of [`Table::mu`].
    pub brdf_at_mu: Vec<f64>,
}

/// One albedo.
#[derive(Clone, Debug, PartialEq, Deserialize)]
pub struct Case {
    /// Single-scattering albedo.
    #[serde(rename = "a")]
    pub albedo: f64,
    /// H(μ) at each cosine of [`Table::mu`].
    #[serde(rename = "H")]
    pub h: Vec<f64>,
    /// Reflected share of a beam at each cosine: 1 − H(μ)√(1 − a). Also the radiance seen under uniform light.
    pub plane_albedo: Vec<f64>,
    /// Reflected share of uniform light.
    pub spherical_albedo: f64,
    /// ∫ H dμ.
    pub alpha0: f64,
    /// ∫ μ H dμ.
    pub alpha1: f64,
    /// Reflected radiance.
    pub brdf: Vec<Brdf>,
}

/// The whole file.
#[derive(Clone, Debug, PartialEq, Deserialize)]
pub struct Table {
    /// Cosines to the normal.
    pub mu: Vec<f64>,
    /// Albedos.
    pub cases: Vec<Case>,
}

/// Reads the table.
///
/// # Panics
/// When the file does not match these types.
pub fn load() -> Table {
    super::parse(
        "halfspace_isotropic",
        include_str!("../../refs/halfspace_isotropic.json"),
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::refs::quadrature::{close, integrate};
    use std::f64::consts::{FRAC_PI_2, PI};

    /// ln H(μ) = −(μ/π) ∫ ln(1 − a θ cot θ) / (cos²θ + μ² sin²θ) dθ over [0, π/2].
    fn h(albedo: f64, mu: f64) -> f64 {
        // θ = (π/2)s⁴ flattens the logarithm at 0, which is singular for a = 1.
        let integral = integrate(0.0, 1.0, 40, |s| {
            let theta = FRAC_PI_2 * s.powi(4);
            let (sin, cos) = theta.sin_cos();
            // 1 − θ cot θ = θ²/3 + θ⁴/45 + 2θ⁶/945 near 0, where the difference cancels.
            let t2 = theta * theta;
            let one_minus = if theta < 0.02 {
                t2 / 3.0 * (1.0 + t2 / 15.0 * (1.0 + 2.0 * t2 / 21.0))
            } else {
                1.0 - theta * cos / sin
            };
            let argument = (1.0 - albedo) + albedo * one_minus;
            4.0 * FRAC_PI_2 * s.powi(3) * argument.ln() / (cos * cos + mu * mu * sin * sin)
        });
        (-mu / PI * integral).exp()
    }

    #[test]
    fn h_functions_follow_from_their_integral() {
        let table = load();
        for case in &table.cases {
            let loss = (1.0 - case.albedo).sqrt();
            for (i, &mu) in table.mu.iter().enumerate() {
                let expected = h(case.albedo, mu);
                close("H", expected, case.h[i], 1e-9);
                close(
                    "plane albedo",
                    1.0 - expected * loss,
                    case.plane_albedo[i],
                    1e-9,
                );
                for brdf in &case.brdf {
                    let value = case.albedo / (4.0 * PI) * expected * h(case.albedo, brdf.mu0)
                        / (mu + brdf.mu0);
                    close("brdf", value, brdf.brdf_at_mu[i], 1e-9);
                }
            }
            let alpha1 = integrate(0.0, 1.0, 4, |mu| mu * h(case.albedo, mu));
            close("alpha1", alpha1, case.alpha1, 1e-6);
            close(
                "spherical",
                1.0 - 2.0 * loss * alpha1,
                case.spherical_albedo,
                1e-6,
            );
            close("alpha0", 2.0 / (1.0 + loss), case.alpha0, 1e-12);
        }
    }
}
