//! Rays of the camera, eight at a time.

use wide::f32x8;

use super::media::Medium;
use super::{Stream, V, dot};
use crate::yardstick::{RESOLUTION, Yardstick};

/// Rays of the camera that meet the matter, eight at a time.
pub(super) struct Bank {
    /// Samples a pixel, and every how many pixels along an axis there is one.
    samples: u32,
    stride: u32,
    /// The next sample, in the order of pixels.
    pixel: u32,
    sample: u32,
    rays: Vec<([f32; 3], [f32; 3], usize, usize)>,
    /// Along x and y of the screen, and to its middle.
    frame: [V; 3],
    eye: V,
}

impl Bank {
    pub(super) fn new(scene: &Yardstick, [samples, stride]: [u32; 2]) -> Self {
        let unit = |v: [f32; 3]| {
            let length = v.iter().map(|c| c * c).sum::<f32>().sqrt();
            v.map(|c| c / length)
        };
        let cross = |[a, b, c]: [f32; 3], [x, y, z]: [f32; 3]| {
            [b * z - c * y, c * x - a * z, a * y - b * x]
        };
        let ahead = unit(scene.eye.map(|c| -c));
        let right = unit(cross(ahead, [0.0, 1.0, 0.0]));
        let half = (0.5 * scene.fov.to_radians()).tan();
        let frame = [
            right.map(|c| c * half),
            cross(right, ahead).map(|c| c * half),
            ahead,
        ];
        Self {
            samples,
            stride,
            pixel: 0,
            sample: 0,
            rays: Vec::new(),
            frame: frame.map(|v| v.map(f32x8::splat)),
            eye: scene.eye.map(f32x8::splat),
        }
    }

    /// The next ray at its entry: place, direction, pixel, colour.
    pub(super) fn next<M: Medium>(
        &mut self,
        medium: &M,
        rng: &mut Stream,
        mut missed: impl FnMut(usize, usize),
    ) -> Option<([f32; 3], [f32; 3], usize, usize)> {
        let edge = RESOLUTION as u32;
        let across = edge / self.stride;
        let pixels = across * across;
        while self.rays.is_empty() {
            if self.pixel >= pixels {
                return None;
            }
            let mut owners = [(0, 0); 8];
            for owner in &mut owners {
                *owner = (self.pixel, self.sample);
                self.sample += 1;
                if self.sample == self.samples {
                    (self.pixel, self.sample) = (self.pixel + 1, 0);
                }
            }
            let axis = |numbers: [u32; 8], rng: &mut Stream| {
                let at = f32x8::new(numbers.map(|n| (n * self.stride) as f32)) + rng.next();
                at * f32x8::splat(2.0 / edge as f32) - 1.0
            };
            let (x, y) = (
                axis(owners.map(|(pixel, _)| pixel % across), rng),
                -axis(owners.map(|(pixel, _)| pixel / across), rng),
            );
            let [right, up, ahead] = self.frame;
            let way: V = std::array::from_fn(|a| right[a] * x + up[a] * y + ahead[a]);
            let inverse = f32x8::ONE / dot(way, way).sqrt();
            let way = way.map(|c| c * inverse);
            let (t, met) = medium.enter(self.eye, way);
            let entry: V = std::array::from_fn(|a| self.eye[a] + way[a] * t);
            let (entry, way, met) = (
                entry.map(|c| c.to_array()),
                way.map(|c| c.to_array()),
                met.to_bitmask(),
            );
            let owners = owners.into_iter().enumerate().rev();
            for (lane, (pixel, sample)) in owners.filter(|(_, (pixel, _))| *pixel < pixels) {
                let colour = sample as usize % 3;
                let at = (pixel / across * edge + pixel % across) * self.stride;
                if met >> lane & 1 == 1 {
                    let (from, along) = (entry.map(|c| c[lane]), way.map(|c| c[lane]));
                    self.rays.push((from, along, at as usize, colour));
                } else {
                    missed(at as usize, colour);
                }
            }
        }
        self.rays.pop()
    }
}
