//! The film: for each pixel the mean of its samples and the variance of that mean.
//!
//! Pixels live in square tiles, so that threads may own disjoint parts of the picture:
//!
//! ```text
//! film.tiles_mut().par_iter_mut().for_each(|tile| … tile.add(x, y, sample, radiance, alpha) …)
//! ```
//!
//! Sums are exact ([`sum`]), so the image depends on the *set* of samples alone: not on threads, tiles, passes,
//! order, or on how shards are merged. Memory: 200 bytes a pixel, 288 where samples come in [`replicates`].
//!
//! Paths that are not finite are dropped and counted with the place that reproduces them ([`NonfinitePaths`]).

mod allotment;
mod estimate;
mod layers;
mod moments;
pub mod replicates;
pub mod sum;

pub use allotment::{Allotment, Places};
pub use layers::{LayerMeans, LayerSample};
pub use moments::PixelMoments;
pub use replicates::{Landing, Pixel, Place};

use layers::PixelLayers;
use replicates::ReplicateSums;
use woodcock_core::path::PathSample;

/// Side of a tile in pixels. Fixed, because the order of work may be recorded but never chosen by a machine's size.
pub const TILE_SIDE: u32 = 16;

/// A half-open rectangle of pixels, `x0 ≤ x < x1`, `y0 ≤ y < y1`; y grows downwards.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Window {
    /// First column.
    pub x0: u32,
    /// First row.
    pub y0: u32,
    /// One beyond the last column.
    pub x1: u32,
    /// One beyond the last row.
    pub y1: u32,
}

impl Window {
    /// The whole picture of `width × height` pixels.
    pub const fn full([width, height]: [u32; 2]) -> Self {
        Self {
            x0: 0,
            y0: 0,
            x1: width,
            y1: height,
        }
    }

    /// pbrt's crop window: fractions `[x0, x1, y0, y1]` of the picture, pixel bounds rounded up.
    ///
    /// May be empty where the fractions fall between two pixel edges.
    pub fn crop(resolution: [u32; 2], [x0, x1, y0, y1]: [f64; 4]) -> Self {
        let edge = |size: u32, fraction: f64| {
            // Decimal fractions are rounded: 0.07 of 100 pixels is 7.000000000000001, and means 7.
            let edge = f64::from(size) * fraction;
            (edge * (1.0 - 1e-12)).ceil().max(0.0) as u32
        };
        let [width, height] = resolution;
        Self {
            x0: edge(width, x0).min(width),
            y0: edge(height, y0).min(height),
            x1: edge(width, x1).min(width),
            y1: edge(height, y1).min(height),
        }
    }

    /// Columns and rows.
    pub const fn size(&self) -> [u32; 2] {
        [
            self.x1.saturating_sub(self.x0),
            self.y1.saturating_sub(self.y0),
        ]
    }

    /// Number of pixels.
    pub const fn pixels(&self) -> u64 {
        let [w, h] = self.size();
        w as u64 * h as u64
    }

    /// Whether no pixel is inside.
    pub const fn is_empty(&self) -> bool {
        self.pixels() == 0
    }

    /// Row-major position of a pixel inside the window.
    pub const fn index(&self, x: u32, y: u32) -> usize {
        (y - self.y0) as usize * (self.x1 - self.x0) as usize + (x - self.x0) as usize
    }

    /// Whether `(x, y)` is inside.
    pub const fn contains(&self, x: u32, y: u32) -> bool {
        self.x0 <= x && x < self.x1 && self.y0 <= y && y < self.y1
    }
}

/// A camera path: its pixel and the index of its sample. `--replay x,y,sample` traces it again.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct PathId {
    /// Row of the pixel in the whole picture.
    pub y: u32,
    /// Column of the pixel in the whole picture.
    pub x: u32,
    /// Index of the sample in the pixel, from 0.
    pub sample: u32,
}

/// Paths that came out NaN or infinite and were dropped.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct NonfinitePaths {
    /// How many.
    pub count: u64,
    /// The first in reading order (row, column, sample), whatever thread met it first.
    pub first: Option<PathId>,
}

impl NonfinitePaths {
    fn record(&mut self, path: PathId) {
        self.merge(&Self {
            count: 1,
            first: Some(path),
        });
    }

    fn merge(&mut self, other: &Self) {
        self.count += other.count;
        self.first = self.first.into_iter().chain(other.first).min();
    }
}

/// A part of the film that one thread owns while it adds samples.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Tile {
    window: Window,
    /// Row-major.
    pixels: Vec<PixelMoments>,
    /// Samples of a replicate.
    replicate: u32,
    /// Whole replicates of the pixels; empty where each sample is one.
    replicates: Vec<ReplicateSums>,
    /// Further layers of the pixels; empty unless asked for.
    layers: Vec<PixelLayers>,
    nonfinite: NonfinitePaths,
}

impl Tile {
    /// Whether further layers are kept.
    pub fn keeps_layers(&self) -> bool {
        !self.layers.is_empty()
    }

    /// Adds what a sample says besides its radiance, if layers are kept. The pixel must lie in the window.
    pub fn add_layers(&mut self, x: u32, y: u32, sample: &LayerSample) {
        let index = self.window.index(x, y);
        if let Some(pixel) = self.layers.get_mut(index) {
            pixel.add(sample);
        }
    }

    /// The pixels of this tile, in coordinates of the whole picture.
    pub fn window(&self) -> Window {
        self.window
    }

    /// Samples of a replicate; one where samples are independent.
    pub fn replicate(&self) -> u32 {
        self.replicate
    }

    /// Adds the path of sample `sample` in pixel `(x, y)` of the whole picture.
    ///
    /// The pixel must lie in [`window`](Self::window) (panics otherwise). A value that is not finite is dropped and counted.
    /// Where samples come in replicates, one alone enters the mean and says nothing of its variance.
    #[inline]
    pub fn add(&mut self, x: u32, y: u32, sample: u32, radiance: [f32; 3], alpha: f32) {
        assert!(self.window.contains(x, y), "pixel outside its tile");
        let index = self.window.index(x, y);
        let pixel = &mut self.pixels[index];
        let finite = if self.replicate == 1 {
            pixel.add(radiance, alpha)
        } else {
            pixel.add_to_mean(radiance, alpha)
        };
        if !finite {
            self.nonfinite.record(PathId { y, x, sample });
        }
    }

    /// Adds samples of pixel `(x, y)` that lie in one replicate, the first of them with index `first`, in their order.
    ///
    /// As [`add`](Self::add). If they are the whole replicate, and finite, they say what its mean is.
    pub fn add_replicate(&mut self, x: u32, y: u32, first: u32, samples: &[PathSample]) {
        if self.replicate == 1 {
            for (path, sample) in samples.iter().zip(first..) {
                self.add(x, y, sample, path.radiance, path.alpha);
            }
            return;
        }
        let whole =
            first.is_multiple_of(self.replicate) && samples.len() == self.replicate as usize;
        let channels = samples.iter().map(|path| {
            let [r, g, b] = path.radiance;
            [r, g, b, path.alpha]
        });
        let channel = |c: usize| samples.iter().map(move |path| path.radiance[c]);
        let sums = if let Some([r, g, b, alpha]) = sum::exact_sums(channels) {
            assert!(self.window.contains(x, y), "pixel outside its tile");
            let index = self.window.index(x, y);
            self.pixels[index].add_sums(samples.len() as u32, [r, g, b], alpha);
            [r, g, b]
        } else {
            for (path, sample) in samples.iter().zip(first..) {
                self.add(x, y, sample, path.radiance, path.alpha);
            }
            [0, 1, 2].map(|c| channel(c).map(f64::from).sum())
        };
        // What is not finite leaves its mark on the sums.
        let finite = |path: &PathSample| path.alpha.is_finite();
        if !(whole && sums.iter().all(|s| s.is_finite()) && samples.iter().all(finite)) {
            return;
        }
        let index = self.window.index(x, y);
        if let Some(replicates) = self.replicates.get_mut(index) {
            let mean = sums.map(|sum| (sum / f64::from(self.replicate)) as f32);
            replicates.add(mean);
            self.pixels[index].add_squares(mean);
        }
    }
}

/// Why two films cannot be merged.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum MergeError {
    /// They are of different pictures or different crop windows.
    #[error("the pictures differ in size or crop window")]
    Shape,
    /// A pixel would hold more than [`sum::CAPACITY`] samples.
    #[error("a pixel would hold more than 2^31 - 1 samples")]
    Capacity,
    /// Their samples come in replicates of different sizes.
    #[error("the samples come in replicates of different sizes")]
    Replicates,
}

/// The picture being rendered (module documentation).
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Film {
    resolution: [u32; 2],
    window: Window,
    replicate: u32,
    tiles: Vec<Tile>,
}

impl Film {
    /// Most bytes per pixel, further layers aside, for checks against a memory limit before allocating.
    pub const BYTES_PER_PIXEL: u64 =
        size_of::<PixelMoments>() as u64 + size_of::<ReplicateSums>() as u64;

    /// An empty film for the pixels of `window` (clipped to the picture) of a picture of `resolution`, of independent samples.
    pub fn new(resolution: [u32; 2], window: Window) -> Self {
        Self::of_replicates(resolution, window, 1)
    }

    /// The same of samples that come in [`replicates`] of `replicate`, clamped to 1 … [`replicates::LARGEST`].
    pub fn of_replicates(resolution: [u32; 2], window: Window, replicate: u32) -> Self {
        let replicate = replicate.clamp(1, replicates::LARGEST);
        let [width, height] = resolution;
        let window = Window {
            x0: window.x0.min(width),
            y0: window.y0.min(height),
            x1: window.x1.min(width),
            y1: window.y1.min(height),
        };
        let mut tiles = Vec::new();
        let side = TILE_SIDE as usize;
        for y0 in (window.y0..window.y1).step_by(side) {
            for x0 in (window.x0..window.x1).step_by(side) {
                let window = Window {
                    x0,
                    y0,
                    x1: x0.saturating_add(TILE_SIDE).min(window.x1),
                    y1: y0.saturating_add(TILE_SIDE).min(window.y1),
                };
                let pixels = window.pixels() as usize;
                let grouped = if replicate == 1 { 0 } else { pixels };
                tiles.push(Tile {
                    window,
                    pixels: vec![PixelMoments::default(); pixels],
                    replicate,
                    replicates: vec![ReplicateSums::default(); grouped],
                    layers: Vec::new(),
                    nonfinite: NonfinitePaths::default(),
                });
            }
        }
        Self {
            resolution,
            window,
            replicate,
            tiles,
        }
    }

    /// Samples of a replicate; one where samples are independent.
    pub fn replicate(&self) -> u32 {
        self.replicate
    }

    /// Keeps further layers from here on.
    pub fn keep_layers(&mut self) {
        for tile in &mut self.tiles {
            tile.layers = vec![PixelLayers::default(); tile.pixels.len()];
        }
    }

    /// The layers of all pixels of the window, row by row; empty unless they are kept.
    pub fn layers(&self) -> Vec<LayerMeans> {
        if !self.tiles.iter().any(Tile::keeps_layers) {
            return Vec::new();
        }
        let mut all = vec![LayerMeans::default(); self.window.pixels() as usize];
        for tile in &self.tiles {
            let width = tile.window.size()[0];
            for (pixel, i) in tile.layers.iter().zip(0_u32..) {
                let (x, y) = (tile.window.x0 + i % width, tile.window.y0 + i / width);
                all[self.window.index(x, y)] = pixel.means();
            }
        }
        all
    }

    /// Width and height of the whole picture.
    pub fn resolution(&self) -> [u32; 2] {
        self.resolution
    }

    /// The pixels this film has, in coordinates of the whole picture.
    pub fn window(&self) -> Window {
        self.window
    }

    /// The tiles in reading order.
    pub fn tiles(&self) -> &[Tile] {
        &self.tiles
    }

    /// The tiles in reading order, disjoint: hand them to as many threads as you like.
    pub fn tiles_mut(&mut self) -> &mut [Tile] {
        &mut self.tiles
    }

    /// Visits the pixels tile by tile: `(column, row, pixel)` in coordinates of the whole picture.
    pub fn pixels(&self) -> impl Iterator<Item = (u32, u32, Pixel<'_>)> + Clone {
        self.tiles.iter().flat_map(|tile| {
            let width = tile.window.size()[0];
            tile.pixels.iter().zip(0_u32..).map(move |(moments, i)| {
                let sums = tile.replicates.get(i as usize);
                let pixel = Pixel {
                    moments,
                    replicates: sums.map(|sums| (sums, tile.replicate)),
                };
                let (x, y) = (tile.window.x0 + i % width, tile.window.y0 + i / width);
                (x, y, pixel)
            })
        })
    }

    /// Adds the samples of another film of the same picture and window: the bits of having rendered all in one, if no replicate
    /// was torn.
    pub fn merge(&mut self, other: &Self) -> Result<(), MergeError> {
        if self.resolution != other.resolution || self.window != other.window {
            return Err(MergeError::Shape);
        }
        if self.replicate != other.replicate {
            return Err(MergeError::Replicates);
        }
        let full = |(a, b): (Pixel<'_>, Pixel<'_>)| {
            u64::from(a.samples()) + u64::from(b.samples()) > u64::from(sum::CAPACITY)
        };
        let pairs = self.pixels().zip(other.pixels());
        if pairs.map(|((.., a), (.., b))| (a, b)).any(full) {
            return Err(MergeError::Capacity);
        }
        for (tile, part) in self.tiles.iter_mut().zip(&other.tiles) {
            tile.nonfinite.merge(&part.nonfinite);
            for (pixel, part) in tile.pixels.iter_mut().zip(&part.pixels) {
                let fits = pixel.merge(part);
                debug_assert!(fits, "checked above");
            }
            for (sums, part) in tile.replicates.iter_mut().zip(&part.replicates) {
                sums.merge(part);
            }
            for (pixel, part) in tile.layers.iter_mut().zip(&part.layers) {
                pixel.merge(part);
            }
        }
        Ok(())
    }

    /// The paths that were dropped.
    pub fn nonfinite(&self) -> NonfinitePaths {
        let mut all = NonfinitePaths::default();
        for tile in &self.tiles {
            all.merge(&tile.nonfinite);
        }
        all
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A film in which pixel (x, y) got sample `s` for `s` of the range, visited in some order of tiles.
    fn filled(samples: std::ops::Range<u32>, reverse: bool) -> Film {
        let mut film = Film::new([40, 20], Window::full([40, 20]));
        let add = |tile: &mut Tile| {
            let w = tile.window();
            for s in samples.clone() {
                for (y, x) in (w.y0..w.y1).flat_map(|y| (w.x0..w.x1).map(move |x| (y, x))) {
                    let value = 1.0 / (1.0 + x as f32 + 40.0 * y as f32 + 7.3 * s as f32);
                    tile.add(x, y, s, [value, 1.0e6 * value, 0.25], 1.0);
                }
            }
        };
        if reverse {
            film.tiles_mut().iter_mut().rev().for_each(add);
        } else {
            film.tiles_mut().iter_mut().for_each(add);
        }
        film
    }

    #[test]
    fn shards_merge_to_the_same_bits() {
        let whole = filled(0..16, false);
        let mut merged = filled(9..16, true);
        merged.merge(&filled(0..4, false)).expect("same shape");
        merged.merge(&filled(4..9, true)).expect("same shape");
        assert_eq!(merged, whole);
        let other = Film::new([40, 21], Window::full([40, 21]));
        assert_eq!(merged.merge(&other), Err(MergeError::Shape));
    }

    #[test]
    fn tiles_cover_the_window_once() {
        for window in [
            Window::full([100, 33]),
            Window {
                x0: 7,
                y0: 1,
                x1: 100,
                y1: 31,
            },
            Window {
                x0: 7,
                y0: 1,
                x1: 8,
                y1: 2,
            },
            Window {
                x0: 7,
                y0: 7,
                x1: 7,
                y1: 9,
            },
        ] {
            let film = Film::new([100, 33], window);
            let mut seen: Vec<_> = film.pixels().map(|(x, y, _)| (y, x)).collect();
            seen.sort_unstable();
            let expected: Vec<_> = (window.y0..window.y1)
                .flat_map(|y| (window.x0..window.x1).map(move |x| (y, x)))
                .collect();
            assert_eq!(seen, expected);
        }
        assert_eq!(
            Film::new([3, 3], Window::full([9, 9])).window(),
            Window::full([3, 3])
        );
    }

    #[test]
    fn dropped_paths_are_counted_and_the_first_is_kept() {
        let mut film = Film::new([40, 40], Window::full([40, 40]));
        for tile in film.tiles_mut().iter_mut().rev() {
            let w = tile.window();
            tile.add(w.x0, w.y1 - 1, 5, [f32::NAN, 0.0, 0.0], 1.0);
            tile.add(w.x0, w.y1 - 1, 3, [0.0, f32::INFINITY, 0.0], 1.0);
            tile.add(w.x0, w.y1 - 1, 4, [1.0; 3], 1.0);
        }
        let nonfinite = film.nonfinite();
        assert_eq!(nonfinite.count, 18);
        assert_eq!(
            nonfinite.first,
            Some(PathId {
                y: 15,
                x: 0,
                sample: 3
            })
        );
        assert!(film.pixels().all(|(.., p)| p.samples() <= 1));
    }

    #[test]
    fn crop_windows_round_as_pbrt_does() {
        let crop = |c| Window::crop([100, 50], c);
        assert_eq!(crop([0.0, 1.0, 0.0, 1.0]), Window::full([100, 50]));
        assert_eq!(
            crop([0.25, 0.5, 0.1, 0.9]),
            Window {
                x0: 25,
                y0: 5,
                x1: 50,
                y1: 45
            }
        );
        // As written, not as rounded to binary.
        assert_eq!(crop([0.07, 0.29, 0.0, 1.0]).size()[0], 22);
        assert!(crop([0.501, 0.502, 0.0, 1.0]).is_empty());
        // Halves that share an edge share no pixel.
        assert_eq!(
            crop([0.0, 0.333, 0.0, 1.0]).x1,
            crop([0.333, 1.0, 0.0, 1.0]).x0
        );
    }
}
