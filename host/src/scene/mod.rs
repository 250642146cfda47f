//! Scenes: what a file describes, free of the format it was written in.
//!
//! Everything is in world space, in double precision, in linear Rec. 709; transforms are column
//! vectors on the right, `p_world = m * p_object`. The axes are pbrt's, left-handed: a camera looks
//! along +z with x to the right and y up. Nothing here computes an optical depth or opens a volume
//! file: a scene says which file and which grid, and the assembly that follows does the rest.
//!
//! [`read`] takes a pbrt-v4 file. What is not understood is a [`SceneError`] that points at its place,
//! or, with [`Options::lenient`], a [`Warning`] in [`Scene::warnings`]; never silence.

mod boundary;
mod camera;
mod color;
mod error;
mod files;
mod film;
mod light;
mod medium;
mod pbrt;
mod ply;
mod source;
mod surface;
mod texture;

use std::path::Path;

pub use boundary::{BilinearMesh, Boundary, Disk, Enclosure, Shape, Sphere, TriangleMesh};
pub use camera::{Camera, Projection, ScreenWindow};
pub use color::blackbody_peak_one;
pub use error::{SceneError, Warning};
pub use files::{DiskFiles, Files, MemoryFiles};
pub use film::{Film, PixelBounds};
pub use light::{
    ConstantLight, DistantLight, GoniometricLight, ImageLight, Light, PointLight, SpotLight,
};
pub use medium::{
    Cloud, Emission, MediumId, MediumKind, NamedMedium, NanoVdb, OpenVdb, Phase, RgbGrid,
    Temperature, TemperatureValues, UniformGrid, Vol,
};
pub use source::{Place, Source};
pub use surface::{AreaEmission, Instance, Material, MaterialId, MaterialKind, Object, Surface};
pub use texture::{Encoding, Filter, ImageMap, Texture, Wrap};

/// A scene: the camera, the film, and what fills the world between them.
#[derive(Clone, Debug)]
pub struct Scene {
    /// What the image is.
    pub film: Film,
    /// Where it is seen from.
    pub camera: Camera,
    /// Samples per pixel that the file asks for, at least 1.
    pub samples_per_pixel: Option<u32>,
    /// Seed that the file asks for.
    pub seed: Option<u64>,
    /// How light is to be transported.
    pub integrator: Integrator,
    /// All media; [`MediumId`] indexes this list.
    pub media: Vec<NamedMedium>,
    /// The medium that surrounds the camera; `None` is vacuum.
    pub camera_medium: Option<MediumId>,
    /// Surfaces at which the medium changes, in file order.
    pub boundaries: Vec<Boundary>,
    /// Surfaces with matter or light, in file order. One that also separates media is among the boundaries too.
    pub surfaces: Vec<Surface>,
    /// All materials; [`MaterialId`] indexes this list.
    pub materials: Vec<Material>,
    /// Surfaces to be placed by instances.
    pub objects: Vec<Object>,
    /// Objects placed in the world.
    pub instances: Vec<Instance>,
    /// Lights in file order.
    pub lights: Vec<Light>,
    /// What was ignored or approximated, in file order.
    pub warnings: Vec<Warning>,
    /// FNV-1a over every byte of text and mesh that was read, in the order of reading. Volume files
    /// and pictures are not included: they are named here, and read later.
    pub source_hash: u64,
}

impl Scene {
    /// The medium that an id of this scene names.
    pub fn medium(&self, id: MediumId) -> Option<&NamedMedium> {
        self.media.get(id.0)
    }
}

/// How light is to be transported.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Integrator {
    /// Our name of it: `path`, `bdpt`, `mlt`, `single` or `transmittance`.
    pub name: String,
    /// Most scattering events of a path. `None` is no limit, unlike pbrt, whose default of 5 truncates
    /// clouds.
    pub max_depth: Option<u32>,
}

/// How to read a scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Options {
    /// What is unknown or not yet supported becomes a warning. Damaged files stay errors.
    pub lenient: bool,
    /// Most bytes that one grid, mesh, film, or the text of all files together may take.
    pub max_memory: u64,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            lenient: false,
            max_memory: 8 << 30,
        }
    }
}

/// Reads a scene in pbrt-v4's language.
///
/// `path` names the main file; every path inside is relative to its directory, also in included files,
/// as in pbrt. Files whose names end in `.gz` are decompressed.
///
/// # Errors
/// The first thing that cannot be read or is not supported, with file, line and column.
pub fn read(path: &Path, files: &dyn Files, options: &Options) -> Result<Scene, SceneError> {
    pbrt::read(path, files, options)
}
