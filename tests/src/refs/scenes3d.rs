//! Cubes under a parallel light or a point, and balls with surfaces: what a camera ray sees, by two independent renderers.
//!
//! Cubes are index-matched, in [0, 1]³, over a black background; balls have radius 1 about the origin, in a uniform
//! environment of radiance 1. Henyey–Greenstein. Uncertainty: the standard errors given.

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

/// What is special about a ball.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(tag = "case", rename_all = "snake_case")]
pub enum Inlay {
    /// A smooth dielectric surface.
    DielectricSphere {
        /// Refractive index inside.
        n: f64,
    },
    /// Index-matched, with an opaque Lambertian ball in its middle.
    CoreSphere {
        /// Radius of that ball.
        rc: f64,
        /// Its albedo.
        rho: f64,
    },
}

/// A ball of a homogeneous medium, and a ray into it.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
pub struct Ball {
    /// Surfaces.
    #[serde(flatten)]
    pub inlay: Inlay,
    /// Optical radius: extinction, since the radius is 1.
    pub t: f64,
    /// Single-scattering albedo.
    pub albedo: f64,
    /// Mean cosine.
    pub g: f64,
    /// Distance of the ray from the centre.
    pub b: f64,
    /// Radiance of all orders of scattering.
    #[serde(rename = "L")]
    pub radiance: f64,
    /// Its standard error.
    #[serde(rename = "stderr")]
    pub radiance_error: f64,
}

/// Reads the cubes under parallel light.
///
/// # Panics
/// When the file does not match these types.
pub fn load() -> Vec<Cube> {
    cases(|case| case["case"] == "cube" && case["light"] == "directional")
}

/// Reads the cubes lit by a point.
///
/// # Panics
/// When the file does not match these types.
pub fn load_point_lit() -> Vec<PointLit> {
    cases(|case| case["case"] == "cube" && case["light"] == "point")
}

/// Reads the balls with surfaces.
///
/// # Panics
/// When the file does not match these types.
pub fn load_balls() -> Vec<Ball> {
    cases(|case| case["case"] != "cube")
}

fn cases<T: DeserializeOwned>(ours: impl Fn(&serde_json::Value) -> bool) -> Vec<T> {
    #[derive(Deserialize)]
    struct File {
        cases: Vec<serde_json::Value>,
    }
    let file: File = super::parse("scenes3d", include_str!("../../refs/scenes3d.json"));
    file.cases
        .into_iter()
        .filter(|case| ours(case))
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

    #[test]
    fn balls_absorb_some_light() {
        let balls = load_balls();
        assert_eq!(balls.len(), 5);
        let glass = |b: &&Ball| matches!(b.inlay, Inlay::DielectricSphere { .. });
        assert_eq!(balls.iter().filter(glass).count(), 3);
        for ball in balls {
            assert!(
                ball.radiance < 1.0 && ball.radiance > 0.0 && ball.b < 1.0,
                "{ball:?}"
            );
        }
    }
}
