//! Participating media by name: coefficients, phase function, and where the density comes from.

use std::path::PathBuf;

use glam::{DAffine3, DVec3};

use super::Place;

/// Index of a medium in [`Scene::media`](super::Scene::media).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct MediumId(pub usize);

/// A medium that surfaces and the camera refer to.
#[derive(Clone, Debug)]
pub struct NamedMedium {
    /// The scene's name for it.
    pub name: String,
    /// Where the density comes from.
    pub kind: MediumKind,
    /// Absorption coefficient per channel, `scale` applied \[1/length of world space\]; finite, not
    /// negative. A grid's density multiplies it.
    pub sigma_a: [f64; 3],
    /// Scattering coefficient per channel, like `sigma_a`.
    pub sigma_s: [f64; 3],
    /// The phase function.
    pub phase: Phase,
    /// From the medium's space to the world; invertible. It places grids; as in pbrt it does not
    /// rescale coefficients, which count per unit of world length.
    pub medium_to_world: DAffine3,
    /// Where it is described.
    pub place: Place,
}

/// Where a medium's density comes from.
#[derive(Clone, Debug)]
pub enum MediumKind {
    /// Density 1 everywhere.
    Homogeneous,
    /// Values written in the scene.
    UniformGrid(UniformGrid),
    /// A grid of an OpenVDB file.
    OpenVdb(OpenVdb),
}

/// Density samples at the cell centres of a box, interpolated trilinearly; nothing outside of it.
#[derive(Clone, Debug, PartialEq)]
pub struct UniformGrid {
    /// Samples along x, y, z; each at least 1.
    pub resolution: [usize; 3],
    /// `density[(z * ny + y) * nx + x]`, finite and not negative. Sample x is at
    /// `p0.x + (x + 1/2) / nx * (p1.x - p0.x)`.
    pub density: Vec<f32>,
    /// Lower corner of the box, in the medium's space.
    pub p0: DVec3,
    /// Upper corner, greater in every coordinate.
    pub p1: DVec3,
}

/// One grid of an OpenVDB file; its transform maps indices to the medium's space.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct OpenVdb {
    /// The file, resolved against the scene's directory; it existed when the scene was read.
    pub filename: PathBuf,
    /// Name of the density grid.
    pub gridname: String,
}

/// A phase function with its parameters. Forward is cos θ = +1, so positive `g` scatters onwards.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Phase {
    /// 1 / 4π.
    Isotropic,
    /// Henyey–Greenstein.
    HenyeyGreenstein {
        /// Mean cosine, in (-1, 1), not 0.
        g: f64,
    },
    /// Rayleigh: 3 (1 + cos² θ) / 16π.
    Rayleigh,
}
