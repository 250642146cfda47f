//! Colour that varies over a surface.

use std::path::PathBuf;

use super::Place;

/// A colour at each point of a surface, linear Rec. 709.
#[derive(Clone, Debug)]
pub enum Texture {
    /// The same everywhere.
    Constant([f64; 3]),
    /// The product of two.
    Scale(Box<Texture>, Box<Texture>),
    /// A picture.
    Image(ImageMap),
}

/// A picture laid onto a surface by its (u, v) parameters.
#[derive(Clone, Debug)]
pub struct ImageMap {
    /// The file (.exr or .png), resolved against the scene's directory; it existed when the scene was read.
    pub filename: PathBuf,
    /// Between pixels.
    pub filter: Filter,
    /// Beyond the edges.
    pub wrap: Wrap,
    /// How stored numbers become light; `None` is by kind of file: sRGB for 8-bit PNG, else linear.
    pub encoding: Option<Encoding>,
    /// Factor on every value.
    pub scale: f64,
    /// One minus the value, after `scale`, not below zero.
    pub invert: bool,
    /// (s, t) = (su u + du, sv v + dv): su, sv, du, dv.
    pub mapping: [f64; 4],
    /// Where it is described.
    pub place: Place,
}

/// What is seen between the centres of pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Filter {
    /// The nearest pixel.
    Point,
    /// Linear in both directions.
    Bilinear,
}

/// What is seen beyond the edges.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wrap {
    /// The picture again.
    Repeat,
    /// Black.
    Black,
    /// The nearest pixel of the edge.
    Clamp,
}

/// How stored numbers become light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Encoding {
    /// As they are.
    Linear,
    /// IEC 61966-2-1.
    Srgb,
    /// A power.
    Gamma(f64),
}
