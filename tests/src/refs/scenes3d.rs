//! Cubes under a parallel light: what a camera ray sees, by two independent renderers.
//!
//! Index-matched, in [0, 1]³, Henyey–Greenstein, black background. The table has further scenes with surfaces and
//! point lights, which are left out here. Uncertainty: the standard errors given.

use serde::Deserialize;

/// A cube, its light, and a ray into it.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
pub struct Cube {
    /// Direction of travel of light of irradiance 1 across it.
    pub light_dir: [f64; 3],
    /// Extinction p₀ + p₁x + p₂y + p₃z [1/length].
    pub p: [f64; 4],
    /// Single-scattering albedo.
    pub albedo: f64,
    /// Mean cosine.
    pub g: f64,
    /// Entry point.
    pub ray_origin: [f64; 3],
    /// Unit direction.
    pub ray_dir: [f64; 3],
    /// Radiance of all orders of scattering.
    #[serde(rename = "L")]
    pub radiance: f64,
    /// Its standard error.
    #[serde(rename = "stderr")]
    pub radiance_error: f64,
    /// Radiance of exactly one scattering.
    #[serde(rename = "L1")]
    pub once: f64,
    /// Its standard error.
    #[serde(rename = "L1_stderr")]
    pub once_error: f64,
}

/// Reads the cubes under parallel light.
///
/// # Panics
/// When the file does not match these types.
pub fn load() -> Vec<Cube> {
    #[derive(Deserialize)]
    struct File {
        cases: Vec<serde_json::Value>,
    }
    let file: File = super::parse("scenes3d", include_str!("../../refs/scenes3d.json"));
    let ours = |case: &serde_json::Value| case["case"] == "cube" && case["light"] == "directional";
    file.cases
        .into_iter()
        .filter(ours)
        .map(|case| super::parse("scenes3d", &case.to_string()))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn further_orders_only_add() {
        let cubes = load();
        assert_eq!(cubes.len(), 2);
        for cube in cubes {
            assert!(cube.once > 0.0 && cube.radiance > cube.once, "{cube:?}");
            let length: f64 = cube.light_dir.iter().map(|x| x * x).sum();
            assert!((length - 1.0).abs() < 1e-12);
        }
    }
}
