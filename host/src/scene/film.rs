//! The film: resolution, the part of it to render, the image's name.

use super::Place;

/// What the image is.
#[derive(Clone, Debug)]
pub struct Film {
    /// Pixels from left to right, at least 1.
    pub width: u32,
    /// Pixels from top to bottom, at least 1.
    pub height: u32,
    /// The pixels to render; never empty.
    pub crop: PixelBounds,
    /// File name that the scene suggests, as written there.
    pub filename: String,
    /// Factor on every pixel: shutter time × ISO / 100, as pbrt's plain sensor has it; 1 by default.
    pub imaging_ratio: f64,
    /// Where the film is described, if it is.
    pub place: Option<Place>,
}

/// A rectangle of pixels, ends excluded; (0, 0) is the upper left pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PixelBounds {
    /// First column.
    pub x0: u32,
    /// One past the last column.
    pub x1: u32,
    /// First row.
    pub y0: u32,
    /// One past the last row.
    pub y1: u32,
}
