//! Cubes under a parallel light or a point: what a camera ray sees, by two independent renderers.
//!
//! Index-matched, in [0, 1]³, Henyey–Greenstein, black background. The table has further scenes with surfaces, which
//! are left out here. Uncertainty: the standard errors given.

use serde::Deserialize;
use serde::de::DeserializeOwned;

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

/// A cube, an isotropic point of power 1 outside of it, and a ray into it.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
pub struct PointLit {
    /// Position of the light.
    pub light_pos: [f64; 3],
    /// All else, but for the direction of the light.
    #[serde(flatten)]
    pub rest: Lit,
}

/// What a cube and its ray are, whatever lights them.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
pub struct Lit {
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

impl From<Cube> for Lit {
    fn from(cube: Cube) -> Self {
        Self {
            p: cube.p,
            albedo: cube.albedo,
            g: cube.g,
            ray_origin: cube.ray_origin,
            ray_dir: cube.ray_dir,
            radiance: cube.radiance,
            radiance_error: cube.radiance_error,
            once: cube.once,
            once_error: cube.once_error,
        }
    }
}

/// Reads the cubes under parallel light.
///
/// # Panics
/// When the file does not match these types.
pub fn load() -> Vec<Cube> {
    cubes("directional")
}

/// Reads the cubes lit by a point.
///
/// # Panics
/// When the file does not match these types.
pub fn load_point_lit() -> Vec<PointLit> {
    cubes("point")
}

fn cubes<T: DeserializeOwned>(light: &str) -> Vec<T> {
    #[derive(Deserialize)]
    struct File {
        cases: Vec<serde_json::Value>,
    }
    let file: File = super::parse("scenes3d", include_str!("../../refs/scenes3d.json"));
    let ours = |case: &serde_json::Value| case["case"] == "cube" && case["light"] == light;
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
        let cubes = load_point_lit();
        assert_eq!(cubes.len(), 2);
        for PointLit { light_pos, rest } in cubes {
            assert!(rest.once > 0.0 && rest.radiance > rest.once, "{rest:?}");
            assert!(light_pos.iter().any(|c| !(0.0..=1.0).contains(c)));
        }
    }
}
