//! Further layers of the picture: what is seen, and parts of the light.
//!
//! They are kept only when asked for, 400 bytes a pixel, in exact sums like the picture itself.

use super::sum::BinnedSum;

/// Numbers of a sample.
const COUNT: usize = 14;

/// What a sample says besides its radiance.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LayerSample {
    /// The part of light that what is seen first sends on, by colour.
    pub albedo: [f32; 3],
    /// Unit shading normal of it; zero in media and where nothing is seen.
    pub normal: [f32; 3],
    /// Distance of it from the camera \[length\]; `None` where nothing is seen.
    pub depth: Option<f32>,
    /// The part of the radiance that a medium sent or scattered towards the camera.
    pub volume: [f32; 3],
    /// The part of the radiance that was scattered at most once.
    pub direct: [f32; 3],
}

/// The means of a pixel's samples.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LayerMeans {
    /// See [`LayerSample`]; by all samples.
    pub albedo: [f32; 3],
    /// By all samples: shorter than one where some see nothing.
    pub normal: [f32; 3],
    /// By the samples that see something; zero if none does.
    pub depth: f32,
    /// By all samples.
    pub volume: [f32; 3],
    /// By all samples.
    pub direct: [f32; 3],
}

/// The sums of one pixel.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct PixelLayers {
    sums: [BinnedSum; COUNT],
    samples: u32,
}

impl Default for PixelLayers {
    fn default() -> Self {
        Self {
            sums: [BinnedSum::new(); COUNT],
            samples: 0,
        }
    }
}

impl PixelLayers {
    /// Adds a sample; nothing of one that is not finite.
    pub(super) fn add(&mut self, sample: &LayerSample) {
        let [ar, ag, ab] = sample.albedo;
        let [x, y, z] = sample.normal;
        let [vr, vg, vb] = sample.volume;
        let [dr, dg, db] = sample.direct;
        let seen = f32::from(u8::from(sample.depth.is_some()));
        let depth = sample.depth.unwrap_or(0.0);
        let numbers = [ar, ag, ab, x, y, z, depth, seen, vr, vg, vb, dr, dg, db];
        if numbers.iter().all(|number| number.is_finite()) {
            for (sum, number) in self.sums.iter_mut().zip(numbers) {
                sum.add(number);
            }
            self.samples += 1;
        }
    }

    /// Adds another's samples.
    pub(super) fn merge(&mut self, other: &Self) {
        for (sum, part) in self.sums.iter_mut().zip(&other.sums) {
            sum.merge(part);
        }
        self.samples += other.samples;
    }

    /// The means; all zero without samples.
    pub(super) fn means(&self) -> LayerMeans {
        let value = |i: usize| self.sums[i].value();
        let number = f64::from(self.samples.max(1));
        let triple = |first: usize| [0, 1, 2].map(|c| (value(first + c) / number) as f32);
        let seen = value(7);
        LayerMeans {
            albedo: triple(0),
            normal: triple(3),
            depth: if seen > 0.0 {
                (value(6) / seen) as f32
            } else {
                0.0
            },
            volume: triple(8),
            direct: triple(11),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn depth_is_the_mean_of_what_is_seen() {
        let mut pixel = PixelLayers::default();
        for depth in [Some(2.0), None, Some(4.0), None] {
            pixel.add(&LayerSample {
                albedo: [0.5, 0.25, 1.0],
                depth,
                ..LayerSample::default()
            });
        }
        pixel.add(&LayerSample {
            depth: Some(f32::NAN),
            ..LayerSample::default()
        });
        let means = pixel.means();
        assert_eq!(means.depth, 3.0);
        assert_eq!(means.albedo, [0.5, 0.25, 1.0]);
        assert_eq!(PixelLayers::default().means(), LayerMeans::default());
        let mut twice = pixel.clone();
        twice.merge(&pixel);
        assert_eq!(twice.means(), means);
    }
}
