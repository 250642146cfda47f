//! Images as files know them: named `f32` channels over a window, with attributes.
//!
//! Radiance is linear, Rec. 709 primaries, never tone-mapped; [`png`] alone shapes tones. [`exr`] holds the names.

pub mod exr;
pub mod layers;
pub mod metadata;
mod part;
pub mod png;
pub mod read;
#[cfg(test)]
mod read_tests;
mod tone;

use crate::film::{Film, Window};
use std::collections::BTreeMap;

pub use layers::Layers;
pub use metadata::RenderMetadata;
pub use read::{Picture, read_picture};

/// The value of an attribute.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum AttributeValue {
    /// A 32-bit integer, the widest that OpenEXR has.
    Int(i32),
    /// A 32-bit float.
    Float(f32),
    /// Text; wider integers are written as decimal text. In a file: ISO 8859-1.
    Text(String),
}

/// One channel, row-major over the image's window.
#[derive(Clone, Debug, PartialEq)]
pub struct Channel {
    /// Name as in the file, layers by dots: `R`, `Variance.R`, `N.X`.
    pub name: String,
    /// One value per pixel of the window.
    pub values: Vec<f32>,
}

/// An image with named channels.
#[derive(Clone, Debug, PartialEq)]
pub struct Image {
    /// Width and height of the whole picture, of which the window is a part.
    pub resolution: [u32; 2],
    /// The pixels that the channels have.
    pub window: Window,
    /// Channels; a file sorts them by name.
    pub channels: Vec<Channel>,
    /// Attributes by name, standard ones (windows, compression) aside.
    pub attributes: BTreeMap<String, AttributeValue>,
}

impl Image {
    /// An image without channels.
    pub fn new(resolution: [u32; 2], window: Window) -> Self {
        Self {
            resolution,
            window,
            channels: Vec::new(),
            attributes: BTreeMap::new(),
        }
    }

    /// `R G B A` and `Variance.R/G/B` of a film, each rounded once to `f32`.
    ///
    /// Means beyond `f32` saturate to its largest value. `Variance` is that of the pixel *mean*. A pixel with a single sample cannot know its
    /// variance: there the layer holds the square of the sample, which exceeds the variance in expectation
    /// (BIASED upwards, never a false zero). A pixel without samples is zero in all channels.
    pub fn from_film(film: &Film) -> Self {
        const NAMES: [&str; 7] = ["R", "G", "B", "A", "Variance.R", "Variance.G", "Variance.B"];
        let window = film.window();
        let mut image = Self::new(film.resolution(), window);
        let size = window.pixels() as usize;
        image.channels.extend(NAMES.map(|name| Channel {
            name: name.to_owned(),
            values: vec![0.0; size],
        }));
        for (x, y, pixel) in film.pixels() {
            let [r, g, b] = pixel.mean();
            let [vr, vg, vb] = pixel
                .variance_of_mean()
                .unwrap_or_else(|| pixel.mean().map(|m| m * m));
            let values = [r, g, b, pixel.alpha(), vr, vg, vb];
            let index = window.index(x, y);
            for (channel, value) in image.channels.iter_mut().zip(values) {
                channel.values[index] = saturate(value);
            }
        }
        image
    }

    /// The values of a channel.
    pub fn channel(&self, name: &str) -> Option<&[f32]> {
        let channel = self.channels.iter().find(|channel| channel.name == name)?;
        Some(&channel.values)
    }

    /// Sets an attribute.
    pub fn set(&mut self, name: &str, value: AttributeValue) {
        self.attributes.insert(name.to_owned(), value);
    }
}

/// The nearest finite `f32`: squares of large radiance exceed it.
fn saturate(x: f64) -> f32 {
    (x as f32).clamp(f32::MIN, f32::MAX)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_film_becomes_seven_channels_in_reading_order() {
        let window = Window {
            x0: 3,
            y0: 2,
            x1: 40,
            y1: 21,
        };
        let mut film = Film::new([64, 32], window);
        for tile in film.tiles_mut() {
            let w = tile.window();
            for (x, y) in (w.y0..w.y1).flat_map(|y| (w.x0..w.x1).map(move |x| (x, y))) {
                tile.add(x, y, 0, [x as f32, y as f32, 3.0e30], 1.0);
                if x != 3 {
                    tile.add(x, y, 1, [x as f32 + 2.0, y as f32, -3.0e30], 0.0);
                }
            }
        }
        let image = Image::from_film(&film);
        let at = |name: &str, x: u32, y: u32| {
            image.channel(name).expect("a channel")[window.index(x, y)]
        };
        assert_eq!((at("R", 39, 20), at("G", 39, 20)), (40.0, 20.0));
        assert_eq!((at("A", 39, 20), at("Variance.R", 39, 20)), (0.5, 1.0));
        assert_eq!(
            (at("Variance.G", 7, 5), at("Variance.B", 7, 5)),
            (0.0, f32::MAX)
        );
        assert_eq!((at("A", 3, 2), at("Variance.R", 3, 2)), (1.0, 9.0));
        assert_eq!(image.channel("Z"), None);
    }
}
