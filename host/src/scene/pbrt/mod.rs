//! pbrt-v4's scene language, read by recursive descent without the recursion.
//!
//! [`lexer`] cuts bytes into tokens, [`param`] reads parameter lists, [`reader`] keeps the stack of
//! files, [`directive`] the grammar, [`state`] what attributes save; [`options`], [`camera`],
//! [`media`], [`lights`] and [`shapes`] turn parameters into the parts of a scene. Facts about the language are
//! pbrt.org's "pbrt-v4 input file format", and where that is silent pbrt's own behaviour.

mod camera;
mod color;
mod diagnostics;
mod directive;
mod lexer;
mod lights;
mod media;
mod options;
mod param;
mod params;
mod reader;
mod shapes;
mod state;
mod suggest;
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
