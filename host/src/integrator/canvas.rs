//! A picture in the making that light may land on anywhere: one sample of every pixel.
//!
//! Sums are exact, so that neither threads nor the order of light paths change a bit.

use woodcock_core::path::PathSample;

use super::bdpt::Splat;
use crate::film::sum::BinnedSum;
use crate::film::{Film, Tile, Window};

/// Sums of radiance over the pixels of a window.
#[derive(Debug)]
pub(super) struct Canvas {
    window: Window,
    pixels: Vec<[BinnedSum; 3]>,
    alpha: Vec<f32>,
}

impl Canvas {
    /// Black.
    pub(super) fn new(window: Window) -> Self {
        let count = window.pixels() as usize;
        Self {
            window,
            pixels: vec![[BinnedSum::new(); 3]; count],
            alpha: vec![0.0; count],
        }
    }

    /// Adds light to a pixel of the window.
    pub(super) fn add(&mut self, [x, y]: [u32; 2], radiance: [f32; 3]) {
        if !self.window.contains(x, y) {
            return;
        }
        let index = self.window.index(x, y);
        if radiance.iter().all(|c| c.is_finite()) {
            for (sum, c) in self.pixels[index].iter_mut().zip(radiance) {
                sum.add(c);
            }
        } else {
            self.spoil([x, y]);
        }
    }

    /// The path of a pixel was not finite: the film is to drop this sample and count it.
    pub(super) fn spoil(&mut self, [x, y]: [u32; 2]) {
        if self.window.contains(x, y) {
            let index = self.window.index(x, y);
            self.alpha[index] = f32::NAN;
        }
    }

    /// Says how much of a pixel's sample is covered.
    pub(super) fn cover(&mut self, [x, y]: [u32; 2], alpha: f32) {
        if self.window.contains(x, y) {
            let index = self.window.index(x, y);
            self.alpha[index] += alpha;
        }
    }

    /// Adds light that landed, times a factor.
    pub(super) fn splat(&mut self, splat: &Splat, factor: f64) {
        let [x, y] = splat.film;
        if x >= 0.0 && y >= 0.0 {
            let radiance = (splat.radiance * factor).as_vec3().to_array();
            self.add([x as u32, y as u32], radiance);
        }
    }

    /// Hands all pixels to the film as its sample of this index.
    pub(super) fn hand_over(&self, film: &mut Film, sample: u32) {
        for tile in film.tiles_mut() {
            let Window { x0, y0, x1, y1 } = tile.window();
            for (y, x) in (y0..y1).flat_map(|y| (x0..x1).map(move |x| (y, x))) {
                let PathSample { radiance, alpha } = self.pixel(x, y);
                Tile::add(tile, x, y, sample, radiance, alpha);
            }
        }
    }

    fn pixel(&self, x: u32, y: u32) -> PathSample {
        let index = self.window.index(x, y);
        PathSample {
            radiance: self.pixels[index].map(|sum| sum.value() as f32),
            alpha: self.alpha[index],
        }
    }
}
