//! Radiance leaving a slab by direction, and fluence by depth, under a beam of irradiance 1 across it.
//!
//! Geometry as in [`super::slab_matched`]; black behind. Uncertainty: 10⁻⁸ absolute.

use serde::Deserialize;

/// One slab.
#[derive(Clone, Debug, PartialEq, Deserialize)]
pub struct Case {
    /// Single-scattering albedo.
    pub albedo: f64,
    /// Optical thickness.
    pub tau: f64,
    /// Mean cosine (Henyey–Greenstein).
    pub g: f64,
    /// Cosine of incidence.
    pub mu0: f64,
    /// Cosines of the way out to the outward normal of its face.
    pub mu: Vec<f64>,
    /// Azimuths between the directions of travel, degrees; 0 goes on forward.
    pub phi_deg: Vec<f64>,
    /// Radiance leaving the lit face, `[mu][phi]` [1/sr].
    #[serde(rename = "L_reflected")]
    pub reflected: Vec<Vec<f64>>,
    /// Scattered radiance leaving the far face, `[mu][phi]` [1/sr].
    #[serde(rename = "L_transmitted")]
    pub transmitted: Vec<Vec<f64>>,
    /// Optical depths below the lit face.
    #[serde(rename = "fluence_depth_t")]
    pub depth: Vec<f64>,
    /// ∫ L dω there, the beam included: collisions per unit optical depth and area.
    pub fluence: Vec<f64>,
}

/// Reads the table.
///
/// # Panics
/// When the file does not match these types.
pub fn load() -> Vec<Case> {
    #[derive(Deserialize)]
    struct File {
        cases: Vec<Case>,
    }
    let file: File = super::parse(
        "slab_radiance",
        include_str!("../../refs/slab_radiance.json"),
    );
    file.cases
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::refs::phase_functions::Kind;

    #[test]
    fn radiances_exceed_their_single_scattering_part() {
        for case in load() {
            let phase = Kind::Hg { g: case.g };
            assert_eq!(case.depth.len(), case.fluence.len());
            for (i, &mu) in case.mu.iter().enumerate() {
                for (j, phi) in case.phi_deg.iter().enumerate() {
                    let sines = ((1.0 - mu * mu) * (1.0 - case.mu0 * case.mu0)).sqrt();
                    let cos = sines * phi.to_radians().cos() - mu * case.mu0;
                    let rate = 1.0 / mu + 1.0 / case.mu0;
                    let first =
                        case.albedo * phase.eval(cos) * -(-case.tau * rate).exp_m1() / (rate * mu);
                    assert!(case.reflected[i][j] > first, "{case:?} {mu} {phi}");
                    assert!(case.reflected[i][j] < 6.0 * first.max(0.05));
                }
            }
        }
    }
}
