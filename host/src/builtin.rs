//! The scene that renders without a file: a cumulus under sun and sky.
//!
//! Camera and lights are a scene in the usual language; the cloud's density is computed (`builtin/cumulus.rs`).

mod cumulus;

use std::path::Path;

use crate::scene::{MediumKind, MemoryFiles, Options, Scene, SceneError, read};

/// The scene but for the cloud, for which one voxel stands in.
const TEXT: &str = include_str!("builtin.pbrt");

/// Voxels along x.
const RESOLUTION: usize = 192;

/// The built-in scene.
///
/// # Errors
/// None, unless the text in this crate is damaged.
pub fn scene() -> Result<Scene, SceneError> {
    let name = Path::new("built-in.pbrt");
    let files = MemoryFiles::new().with(name, TEXT.as_bytes());
    let mut scene = read(name, &files, &Options::default())?;
    for medium in &mut scene.media {
        if let MediumKind::UniformGrid(grid) = &mut medium.kind {
            (grid.resolution, grid.density) = cumulus::cumulus(RESOLUTION);
        }
    }
    Ok(scene)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_cloud_lies_within_its_box() {
        let scene = scene().expect("the built-in scene reads");
        let MediumKind::UniformGrid(grid) = &scene.media[0].kind else {
            panic!("no grid");
        };
        let [nx, ny, nz] = grid.resolution;
        let at = |x: usize, y: usize, z: usize| grid.density[(z * ny + y) * nx + x];
        let full = grid.density.iter().filter(|&&d| d > 0.0).count();
        assert!((0.05..0.5).contains(&(full as f64 / grid.density.len() as f64)));
        assert!(grid.density.iter().all(|d| (0.0..=1.0).contains(d)));
        for y in 0..ny {
            for x in 0..nx {
                assert_eq!(
                    at(x, y, 0).max(at(x, y, nz - 1)),
                    0.0,
                    "cut off at {x}, {y}"
                );
            }
            for z in 0..nz {
                assert_eq!(
                    at(0, y, z).max(at(nx - 1, y, z)),
                    0.0,
                    "cut off at {y}, {z}"
                );
            }
        }
    }
}
