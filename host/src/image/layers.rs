//! Further layers of a film as channels of an image.

use super::Channel;
use crate::film::Film;

const COLOURS: [&str; 3] = [".R", ".G", ".B"];

/// Which further layers an image has.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Layers {
    /// `Albedo.R/G/B`: the part of light that what is seen first sends on.
    pub albedo: bool,
    /// `N.X/Y/Z`: shading normal of what is seen first.
    pub normal: bool,
    /// `Z`: distance of what is seen first.
    pub depth: bool,
    /// `Volume.R/G/B` and `Surface.R/G/B`: light that media sent or scattered towards the camera, and all other.
    pub matter: bool,
    /// `Direct.R/G/B` and `Indirect.R/G/B`: light scattered at most once, and all other.
    pub order: bool,
}

impl Layers {
    /// Whether there is any.
    pub const fn any(self) -> bool {
        self.albedo || self.normal || self.depth || self.matter || self.order
    }

    /// Whether parts of the light are among them.
    pub const fn parts(self) -> bool {
        self.matter || self.order
    }

    /// The channels of a film that keeps layers, in the order of the fields.
    pub fn channels(self, film: &Film) -> Vec<Channel> {
        let means = film.layers();
        if means.is_empty() {
            return Vec::new();
        }
        let mut beauty = vec![[0.0_f32; 3]; means.len()];
        let window = film.window();
        for (x, y, pixel) in film.pixels() {
            if let Some(entry) = beauty.get_mut(window.index(x, y)) {
                *entry = pixel.mean().map(|c| c as f32);
            }
        }
        let mut channels = Vec::new();
        let mut add = |name: &str, axes: &[&str], value: &dyn Fn(usize, usize) -> f32| {
            for (c, axis) in axes.iter().enumerate() {
                channels.push(Channel {
                    name: format!("{name}{axis}"),
                    values: (0..means.len()).map(|i| value(i, c)).collect(),
                });
            }
        };
        if self.albedo {
            add("Albedo", &COLOURS, &|i, c| means[i].albedo[c]);
        }
        if self.normal {
            add("N", &[".X", ".Y", ".Z"], &|i, c| means[i].normal[c]);
        }
        if self.depth {
            add("Z", &[""], &|i, _| means[i].depth);
        }
        if self.matter {
            add("Volume", &COLOURS, &|i, c| means[i].volume[c]);
            add("Surface", &COLOURS, &|i, c| {
                beauty[i][c] - means[i].volume[c]
            });
        }
        if self.order {
            add("Direct", &COLOURS, &|i, c| means[i].direct[c]);
            add("Indirect", &COLOURS, &|i, c| {
                beauty[i][c] - means[i].direct[c]
            });
        }
        channels
    }
}
