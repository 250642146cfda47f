//! Pictures read back: for textures and environments.

use std::path::Path;

use crate::scene::{Encoding, Files};
use crate::volume::Limits;

/// A picture in memory.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// Pixels from left to right, at least 1.
    pub width: u32,
    /// Pixels from top to bottom, at least 1.
    pub height: u32,
    /// Linear Rec. 709, row by row from the top; finite.
    pub pixels: Vec<[f32; 3]>,
}

/// Reads a picture: .exr (any compression; channels R, G, B, or Y, or a single one) or .png.
///
/// * `encoding`: how stored numbers become light; `None` is by kind of file: sRGB for 8-bit PNG, else linear.
///
/// # Errors
/// What is wrong with the file, in a sentence without its name.
pub fn read_picture(
    files: &dyn Files,
    path: &Path,
    encoding: Option<Encoding>,
    limits: &Limits,
) -> Result<Picture, String> {
    let _ = (files, path, encoding, limits);
    Err("pictures cannot be read yet".into())
}
