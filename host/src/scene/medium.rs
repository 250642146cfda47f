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
    /// Light that it sends out by itself.
    pub emission: Option<Emission>,
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
    /// Coefficients by colour written in the scene.
    RgbGrid(RgbGrid),
    /// pbrt's noise.
    Cloud(Cloud),
    /// A grid of an OpenVDB file.
    OpenVdb(OpenVdb),
    /// A grid of a NanoVDB file.
    NanoVdb(NanoVdb),
    /// A grid in Mitsuba's format.
    Vol(Vol),
}

/// Light that a medium sends out: the source of radiance is σ_a · Le per length, Le being a factor times a colour.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Emission {
    /// Factor on all radiance, not negative.
    pub scale: f64,
    /// Radiance by colour, where no temperature decides \[W/(m² sr)\].
    pub le: [f64; 3],
    /// Further factor per voxel of a [`UniformGrid`], in its layout; or nothing.
    pub scale_grid: Option<Vec<f32>>,
    /// The colour is that of a black body.
    pub temperature: Option<Temperature>,
}

/// Temperatures in space: kelvin = (value − offset) · scale. At 100 K or less there is no light; else the black body's
/// spectrum, as in pbrt brought to one at its peak, gives the colour.
#[derive(Clone, Debug, PartialEq)]
pub struct Temperature {
    /// Values of a [`UniformGrid`] in its layout, or the name of a grid in the medium's file.
    pub values: TemperatureValues,
    /// Subtracted first.
    pub offset: f64,
    /// Factor then.
    pub scale: f64,
}

/// Where temperatures come from.
#[derive(Clone, Debug, PartialEq)]
pub enum TemperatureValues {
    /// Written in the scene.
    Listed(Vec<f32>),
    /// A grid of the medium's own file, with its own transform.
    Grid(String),
}

/// Coefficients by colour at the cell centres of a box, interpolated trilinearly; nothing outside of it.
/// They are multiplied by the medium's `sigma_a` and `sigma_s`, which hold the common scale.
#[derive(Clone, Debug, PartialEq)]
pub struct RgbGrid {
    /// Samples along x, y, z; each at least 1.
    pub resolution: [usize; 3],
    /// Absorption, in the layout of [`UniformGrid::density`]; `None` is 1 everywhere.
    pub sigma_a: Option<Vec<[f32; 3]>>,
    /// Scattering, likewise.
    pub sigma_s: Option<Vec<[f32; 3]>>,
    /// Emitted radiance, times [`Emission::scale`]; `None` is no light.
    pub le: Option<Vec<[f32; 3]>>,
    /// Lower corner of the box, in the medium's space.
    pub p0: DVec3,
    /// Upper corner, greater in every coordinate.
    pub p1: DVec3,
}

/// pbrt's cloud: Perlin noise that thins out with height.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cloud {
    /// Density where the noise is one.
    pub density: f64,
    /// How far wisps are torn.
    pub wispiness: f64,
    /// Of the noise \[1/length of the unit box\].
    pub frequency: f64,
    /// Lower corner of the box, in the medium's space.
    pub p0: DVec3,
    /// Upper corner, greater in every coordinate.
    pub p1: DVec3,
}

/// One grid of a NanoVDB file; its transform maps indices to the medium's space.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NanoVdb {
    /// The file, resolved against the scene's directory; it existed when the scene was read.
    pub filename: PathBuf,
    /// Name of the density grid.
    pub gridname: String,
}

/// A density in Mitsuba's grid format; its box maps to the medium's space.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Vol {
    /// The file, resolved against the scene's directory; it existed when the scene was read.
    pub filename: PathBuf,
    /// Single-scattering albedo by colour in another such file of three channels, in place of the coefficients'.
    pub albedo: Option<PathBuf>,
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
    /// Draine: Henyey–Greenstein times 1 + α cos² θ, normalised.
    Draine {
        /// In (-1, 1); the mean cosine only if `alpha` is 0.
        g: f64,
        /// 0 or more.
        alpha: f64,
    },
    /// Two Henyey–Greenstein lobes.
    TwoLobe {
        /// Mean cosine of the first, in (-1, 1).
        forward: f64,
        /// Mean cosine of the second, in (-1, 1).
        backward: f64,
        /// Share of the first, in [0, 1].
        share: f64,
    },
    /// The fit to Mie scattering by water droplets [Jendersie, d'Eon 2023].
    Droplets {
        /// \[µm\], in (0, 50].
        diameter: f64,
    },
}
