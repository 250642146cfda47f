//! Lateral spread of a thin beam that hits a slab or half-space at the origin, along the inward normal.
//!
//! σ_t = 1, so radii are in mean free paths; Henyey–Greenstein. Monte Carlo: standard errors are given.

use serde::Deserialize;

/// One medium.
#[derive(Clone, Debug, PartialEq, Deserialize)]
pub struct Case {
    /// Optical thickness; none is semi-infinite.
    pub tau: Option<f64>,
    /// Single-scattering albedo.
    pub albedo: f64,
    /// Mean cosine.
    pub g: f64,
    /// Refractive index within (1 without); smooth Fresnel faces where it is not 1.
    pub n: f64,
    /// Power leaving the lit face within each radius of [`Table::rho`], without the direct reflection.
    #[serde(rename = "R_within")]
    pub reflected_within: Vec<f64>,
    /// Its standard errors.
    #[serde(rename = "R_stderr")]
    pub reflected_error: Vec<f64>,
    /// The same without limit.
    #[serde(rename = "R_total")]
    pub reflected: f64,
    /// Power leaving the far face within each radius, the unscattered beam included; none if there is no far face.
    #[serde(rename = "T_within")]
    pub transmitted_within: Option<Vec<f64>>,
    /// Its standard errors.
    #[serde(rename = "T_stderr")]
    pub transmitted_error: Option<Vec<f64>>,
}

/// The whole file.
#[derive(Clone, Debug, PartialEq, Deserialize)]
pub struct Table {
    /// Lateral distances from the beam.
    pub rho: Vec<f64>,
    /// Media.
    pub cases: Vec<Case>,
}

/// Reads the table.
///
/// # Panics
/// When the file does not match these types.
pub fn load() -> Table {
    super::parse("pencil_beam", include_str!("../../refs/pencil_beam.json"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_grow_with_the_radius_up_to_the_total() {
        let table = load();
        assert_eq!(table.cases.len(), 3);
        for case in &table.cases {
            assert_eq!(case.reflected_within.len(), table.rho.len());
            assert!(case.reflected_within.is_sorted());
            assert!(case.reflected_within.last() <= Some(&case.reflected));
            assert_eq!(case.tau.is_some(), case.transmitted_within.is_some());
            if let (Some(tau), Some(shares)) = (case.tau, &case.transmitted_within) {
                assert!(shares.is_sorted() && shares[0] > (-tau).exp());
            }
        }
    }
}
