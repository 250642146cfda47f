//! pbrt-v4's scene language, read by recursive descent without the recursion.
//!
//! [`lexer`] cuts bytes into tokens, [`param`] reads parameter lists, [`reader`] keeps the stack of
//! files, [`directive`] the grammar, [`state`] what attributes save; [`options`], [`camera`], [`media`], [`lights`],
//! [`shapes`], [`materials`], [`textures`] and [`objects`] turn parameters into the parts of a scene, and [`placing`]
//! puts those together once every name is known. Facts about the language are pbrt.org's "pbrt-v4 input file format",
//! and where that is silent pbrt's own behaviour.

mod area;
mod camera;
mod color;
mod diagnostics;
mod directive;
mod emission;
mod grids;
mod lexer;
mod lights;
mod materials;
mod media;
mod meshes;
mod objects;
mod options;
mod param;
mod params;
mod phase;
mod placing;
mod points;
mod presets;
mod reader;
mod shapes;
mod spectra;
mod state;
mod suggest;
mod textures;
mod transform;
mod world;

use std::path::Path;

use super::{Files, Options, Scene, SceneError};

/// See [`scene::read`](super::read).
pub(super) fn read(path: &Path, files: &dyn Files, options: &Options) -> Result<Scene, SceneError> {
    let mut reader = reader::Reader::new(path, files, *options);
    reader.open_main(path)?;
    reader.run()?;
    reader.finish()
}
