//! Do two images show the same, each being a mean with a variance?
//!
//! For sums of pixels, by Welch's test: the difference over its standard error, both variances counting [Welch 1947; Jung, Hanika,
//! Dachsbacher 2020]:
//!
//! ```text
//! t = Σ (aᵢ − bᵢ) / √Σ (vᵢ + wᵢ),    ν = (Σ (vᵢ + wᵢ))² / Σ (vᵢ² / (nᵢ − 1) + wᵢ² / (mᵢ − 1))
//! ```
//!
//! with v, w the variances of the means and n, m the independent samples (or replicates) behind them. Two tests, of each colour
//! of the whole picture and of each of its blocks, share a stated rate of false alarms evenly, each of their parts by
//! [Bonferroni]: images of the same expectation differ no more often than that, as far as sums of pixels are normal.
//!
//! Pixels must be independent. Those of bidirectional integrators are not (light lands anywhere): there single pixels take the place of
//! the sums. *Blind to:* differences below [`Comparison::resolution`], and in pixels where light is so rare that neither image has
//! seen it.
//!
//! [Bonferroni]: https://en.wikipedia.org/wiki/Bonferroni_correction

pub mod deviates;

use crate::film::Window;
use crate::image::{AttributeValue, Image};

/// Side of a block of pixels.
pub const BLOCK: u32 = 16;
/// As in relMSE.
const FLOOR: f64 = 1e-2;
/// What `f32` rounds away, with some room: relative to a pixel.
const ROUNDING: f64 = 1.0 / 4_194_304.0;

/// Why images cannot be compared.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CompareError {
    /// A channel is not there.
    #[error("there is no channel {0}; `woodcock render` writes R, G, B and Variance.R, .G, .B")]
    Channel(String),
    /// Sizes or crop windows differ.
    #[error("the images differ in size or crop window")]
    Shape,
    /// The variance layer of so few samples is no estimate.
    #[error("a variance needs two independent samples per pixel or more, and there are {0}")]
    Samples(u64),
    /// A number that is none.
    #[error("pixel ({x}, {y}) of channel {channel} is {value}")]
    Value {
        /// Name of the channel.
        channel: String,
        /// Column of the whole picture.
        x: u32,
        /// Row of the whole picture.
        y: u32,
        /// What is there.
        value: f32,
    },
}

/// An image as the mean of samples.
#[derive(Clone, Debug)]
pub struct Estimate {
    resolution: [u32; 2],
    window: Window,
    means: [Vec<f32>; 3],
    variances: [Vec<f32>; 3],
    /// Independent samples of each pixel; one number if all have the same.
    samples: Vec<f64>,
    /// Whether light of one path may land in several pixels.
    pub entangled: bool,
}

const COLOURS: [&str; 3] = ["R", "G", "B"];

fn number(image: &Image, name: &str) -> Option<f64> {
    match image.attributes.get(name)? {
        AttributeValue::Int(value) => Some(f64::from(*value)),
        AttributeValue::Float(value) => Some(f64::from(*value)),
        AttributeValue::Text(text) => text.parse().ok(),
    }
}

impl Estimate {
    /// Of an image with `R G B` and `Variance.R/G/B`. How many samples there are is taken from the channel `Samples`, else the attribute
    /// `samplesPerPixel`; without either the variances count as exact.
    ///
    /// # Errors
    /// A missing channel, a value that is not finite, a negative variance, and fewer than two samples.
    pub fn of(image: &Image) -> Result<Self, CompareError> {
        let channel = |name: String| -> Result<Vec<f32>, CompareError> {
            let values = image.channel(&name);
            let values = values.ok_or_else(|| CompareError::Channel(name.clone()))?;
            let negative = name.starts_with("Variance");
            let wrong = |v: &f32| !v.is_finite() || (negative && *v < 0.0);
            if let Some(at) = values.iter().position(wrong) {
                let width = image.window.size()[0].max(1);
                return Err(CompareError::Value {
                    channel: name,
                    x: image.window.x0 + at as u32 % width,
                    y: image.window.y0 + at as u32 / width,
                    value: values[at],
                });
            }
            Ok(values.to_vec())
        };
        let [r, g, b] = COLOURS;
        let means = [channel(r.into())?, channel(g.into())?, channel(b.into())?];
        let variance = |colour: &str| channel(format!("Variance.{colour}"));
        let variances = [variance(r)?, variance(g)?, variance(b)?];
        let replicate = number(image, "woodcock.replicate").map_or(1.0, |n| n.max(1.0));
        let samples: Vec<f64> = match image.channel("Samples") {
            Some(values) => values
                .iter()
                .map(|&v| (f64::from(v) / replicate).floor())
                .collect(),
            None => {
                let all = number(image, "samplesPerPixel");
                vec![all.map_or(f64::INFINITY, |n| (n / replicate).floor())]
            }
        };
        let least = samples.iter().copied().fold(f64::INFINITY, f64::min);
        if least < 2.0 {
            return Err(CompareError::Samples(least as u64));
        }
        let integrator = image.attributes.get("woodcock.integrator");
        let entangled = matches!(integrator, Some(AttributeValue::Text(name)) if name == "bdpt" || name == "mlt");
        Ok(Self {
            resolution: image.resolution,
            window: image.window,
            means,
            variances,
            samples,
            entangled,
        })
    }

    /// Mean over pixels, by colour.
    pub fn mean(&self) -> [f64; 3] {
        self.means.each_ref().map(|values| {
            values.iter().map(|&v| f64::from(v)).sum::<f64>() / values.len().max(1) as f64
        })
    }

    fn samples(&self, at: usize) -> f64 {
        let all = self.samples.first().copied().unwrap_or(f64::INFINITY);
        self.samples.get(at).copied().unwrap_or(all)
    }
}

/// A difference of sums over pixels.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Difference {
    /// In normal deviates.
    pub z: f64,
    /// Standard error of the difference, per pixel.
    pub standard_error: f64,
}

/// Sums for Welch's test.
#[derive(Clone, Copy, Default)]
struct Welch {
    pixels: f64,
    difference: f64,
    variance: f64,
    /// Σ v² / ν
    freedom: f64,
    /// As if all pixels were rounded one way.
    rounding: f64,
}

impl Welch {
    fn add(&mut self, a: &Estimate, b: &Estimate, colour: usize, at: usize) {
        let mut size = 0.0;
        for image in [a, b] {
            let v = f64::from(image.variances[colour][at]);
            self.variance += v;
            self.freedom += v * v / (image.samples(at) - 1.0);
            size += f64::from(image.means[colour][at]).abs();
        }
        self.pixels += 1.0;
        self.difference += f64::from(a.means[colour][at]) - f64::from(b.means[colour][at]);
        self.rounding += ROUNDING * size;
    }

    fn finish(&self) -> Difference {
        let error = (self.variance + self.rounding * self.rounding).sqrt();
        let t = if self.difference == 0.0 {
            0.0
        } else {
            self.difference / error
        };
        let freedom = if self.variance > 0.0 {
            self.variance * self.variance / self.freedom
        } else {
            f64::INFINITY
        };
        Difference {
            z: deviates::of_student(t, freedom),
            standard_error: error / self.pixels,
        }
    }
}

/// The greatest difference of its kind.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Worst {
    /// In normal deviates.
    pub z: f64,
    /// First column and row of the whole picture.
    pub at: [u32; 2],
    /// 0, 1, 2 for red, green, blue.
    pub colour: usize,
}

/// What a comparison finds. Differences are those of the first image from the second.
#[derive(Clone, Debug, PartialEq)]
pub struct Comparison {
    /// Of the whole pictures, by colour; not judged where pixels are entangled.
    pub whole: [Difference; 3],
    /// The worst block, or pixel where pixels are entangled.
    pub worst: Worst,
    /// Side of what `worst` is: [`BLOCK`], or 1.
    pub side: u32,
    /// Beyond this size a deviate of the whole is significant.
    pub whole_limit: f64,
    /// Beyond this size that of a part is.
    pub part_limit: f64,
    /// Mean over pixels and colours of (a − b)² / (b² + 10⁻² mean(b)²).
    pub relative_mse: f64,
    /// What it should be if only noise differs.
    pub relative_noise: f64,
    /// The least difference of the whole, relative to the second image, that would have been found nearly always: the limit and three
    /// standard errors.
    pub resolution: f64,
}

impl Comparison {
    /// Whether the images differ more than chance explains at the stated rate of false alarms.
    pub fn differ(&self) -> bool {
        let whole = self.side > 1 && self.whole.iter().any(|d| d.z.abs() > self.whole_limit);
        whole || self.worst.z.abs() > self.part_limit
    }
}

/// Compares two images at a rate of false alarms in (0, 1).
///
/// # Errors
/// Sizes that differ.
pub fn compare(a: &Estimate, b: &Estimate, false_alarms: f64) -> Result<Comparison, CompareError> {
    if a.resolution != b.resolution || a.window != b.window {
        return Err(CompareError::Shape);
    }
    let window = a.window;
    let [width, height] = window.size();
    let side = if a.entangled || b.entangled { 1 } else { BLOCK };
    let [columns, rows] = [width, height].map(|size| size.div_ceil(side) as usize);
    let mut whole = [Difference::default(); 3];
    let mut worst = Worst::default();
    let mean = b.mean().iter().sum::<f64>() / 3.0;
    let (mut squares, mut noise) = (0.0, 0.0);
    for (colour, of_whole) in whole.iter_mut().enumerate() {
        let mut all = Welch::default();
        let mut parts = vec![Welch::default(); columns * rows];
        for y in 0..height {
            for x in 0..width {
                let at = y as usize * width as usize + x as usize;
                all.add(a, b, colour, at);
                let part = (y / side) as usize * columns + (x / side) as usize;
                parts[part].add(a, b, colour, at);
                let value = |image: &Estimate| f64::from(image.means[colour][at]);
                let scale = value(b).powi(2) + FLOOR * mean * mean;
                if scale > 0.0 {
                    squares += (value(a) - value(b)).powi(2) / scale;
                    let variance = |image: &Estimate| f64::from(image.variances[colour][at]);
                    noise += (variance(a) + variance(b)) / scale;
                }
            }
        }
        *of_whole = all.finish();
        for (part, sums) in parts.iter().enumerate() {
            let z = sums.finish().z;
            if z.abs() > worst.z.abs() {
                let corner = [part % columns, part / columns].map(|n| n as u32 * side);
                worst = Worst {
                    z,
                    at: [window.x0 + corner[0], window.y0 + corner[1]],
                    colour,
                };
            }
        }
    }
    let parts = 3.0 * (columns * rows) as f64;
    let (for_whole, for_parts) = if side > 1 {
        (0.5 * false_alarms, 0.5 * false_alarms)
    } else {
        (0.0, false_alarms)
    };
    let whole_limit = deviates::exceeded_with(for_whole / 3.0);
    let error = whole.iter().map(|d| d.standard_error).fold(0.0, f64::max);
    let values = 3.0 * f64::from(width) * f64::from(height);
    Ok(Comparison {
        whole,
        worst,
        side,
        whole_limit,
        part_limit: deviates::exceeded_with(for_parts / parts),
        relative_mse: squares / values,
        relative_noise: noise / values,
        resolution: (whole_limit + 3.0) * error / mean.abs(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::Channel;

    const SIZE: [u32; 2] = [48, 40];

    /// Approximately normal numbers: sums of twelve uniform ones.
    fn normals(seed: u32) -> impl Iterator<Item = f64> {
        let mut state = seed.wrapping_mul(0x9e37_79b9);
        let mut uniform = move || {
            state = state.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
            let word = (state >> ((state >> 28) + 4) ^ state).wrapping_mul(277_803_737);
            f64::from(word >> 22 ^ word) / 4_294_967_296.0
        };
        std::iter::repeat_with(move || (0..12).map(|_| uniform()).sum::<f64>() - 6.0)
    }

    /// A gradient with noise of relative size `noise` per pixel, that says its variance is `claimed` times what it is.
    fn image(seed: u32, noise: f64, claimed: f64, change: impl Fn(u32, u32) -> f64) -> Image {
        let window = Window::full(SIZE);
        let mut image = Image::new(SIZE, window);
        let mut normal = normals(seed);
        let mut draw = || normal.next().unwrap_or(0.0);
        for colour in COLOURS {
            let mut values = Vec::new();
            let mut variances = Vec::new();
            for y in 0..SIZE[1] {
                for x in 0..SIZE[0] {
                    let mean = f64::from(1 + x) * change(x, y);
                    let deviation = noise * mean;
                    values.push((mean + deviation * draw()) as f32);
                    variances.push((claimed * deviation * deviation) as f32);
                }
            }
            let mut add = |name: String, values| image.channels.push(Channel { name, values });
            add(colour.to_owned(), values);
            add(format!("Variance.{colour}"), variances);
        }
        image.set("samplesPerPixel", AttributeValue::Int(64));
        image
    }

    fn same(_: u32, _: u32) -> f64 {
        1.0
    }

    fn verdict(a: &Image, b: &Image) -> Comparison {
        let estimate = |image| Estimate::of(image).expect("an estimate");
        compare(&estimate(a), &estimate(b), 1e-3).expect("of one size")
    }

    #[test]
    fn false_alarms_are_as_rare_as_said() {
        // 4000 comparisons at 5 %: 200 alarms are expected, of a binomial law with deviation 13.8; fewer, since parts overlap.
        let mut alarms = 0;
        for seed in 0..2000 {
            let [a, b] = [2 * seed, 2 * seed + 1].map(|s| image(s, 0.05, 1.0, same));
            let estimate = |image: &Image| Estimate::of(image).expect("an estimate");
            let found = compare(&estimate(&a), &estimate(&b), 0.05).expect("of one size");
            alarms += u32::from(found.differ());
            let ratio = found.relative_mse / found.relative_noise;
            assert!((ratio - 1.0).abs() < 0.15, "{ratio}");
        }
        assert!((50..148).contains(&alarms), "{alarms} of 2000");
    }

    #[test]
    fn what_differs_is_found() {
        let b = image(2, 0.2, 1.0, same);
        assert!(!verdict(&image(1, 0.2, 1.0, same), &b).differ());
        // Everywhere, by two per cent: 1920 pixels of 28 % noise resolve 0.7 %.
        let everywhere = verdict(&image(1, 0.2, 1.0, |_, _| 1.05), &b);
        assert!(everywhere.differ() && everywhere.whole[1].z > 5.0);
        // In one block only, and against another: the whole is the same.
        let swapped = |x: u32, y: u32| match (x / 16, y / 16) {
            (1, 0) => 1.2,
            (1, 1) => 0.8,
            _ => 1.0,
        };
        let found = verdict(&image(1, 0.2, 1.0, swapped), &b);
        assert!(found.differ());
        assert!(found.worst.at[0] == 16, "{:?}", found.worst);
        // Variances four times too small: single blocks stand out.
        assert!(verdict(&image(1, 0.2, 0.0625, same), &image(2, 0.2, 0.0625, same)).differ());
    }

    #[test]
    fn exact_images_may_round_and_no_more() {
        let a = image(1, 0.0, 1.0, same);
        assert!(!verdict(&a, &a).differ());
        assert!(!verdict(&a, &image(1, 0.0, 1.0, |_, _| 1.0 + 1e-7)).differ());
        assert!(verdict(&a, &image(1, 0.0, 1.0, |_, _| 1.0 + 1e-5)).differ());
    }

    #[test]
    fn entangled_pixels_are_judged_one_by_one() {
        // The same noise in all pixels, as light paths make it: sums over pixels say nothing.
        let shift = |seed: u32| {
            let common = normals(seed).next().unwrap_or(0.0);
            image(seed, 0.0, 1.0, move |_, _| 1.0 + 0.1 * common)
        };
        let claim = |mut image: Image, integrator: &str| {
            for colour in COLOURS {
                let values = image.channel(colour).expect("a colour").to_vec();
                let name = format!("Variance.{colour}");
                let layer = image.channels.iter_mut().find(|c| c.name == name);
                layer.expect("a layer").values = values.iter().map(|v| 0.01 * v * v).collect();
            }
            let name = AttributeValue::Text(integrator.to_owned());
            image.set("woodcock.integrator", name);
            image
        };
        let pair = |integrator: &str| [5, 6].map(|seed| claim(shift(seed), integrator));
        let [a, b] = pair("path");
        assert!(verdict(&a, &b).differ(), "the planted mistake");
        let [a, b] = pair("mlt");
        assert!(!verdict(&a, &b).differ());
    }

    #[test]
    fn what_cannot_be_compared_is_said() {
        let a = image(1, 0.1, 1.0, same);
        let mut few = a.clone();
        few.set("samplesPerPixel", AttributeValue::Int(16));
        assert!(Estimate::of(&few).is_ok());
        few.set("woodcock.replicate", AttributeValue::Text("16".into()));
        assert_eq!(Estimate::of(&few).err(), Some(CompareError::Samples(1)));
        let mut bare = a.clone();
        bare.channels.retain(|c| c.name != "Variance.G");
        let missing = CompareError::Channel("Variance.G".into());
        assert_eq!(Estimate::of(&bare).err(), Some(missing));
        let mut spoilt = a.clone();
        spoilt.channels[0].values[50] = f32::NAN;
        let error = Estimate::of(&spoilt).expect_err("not a number").to_string();
        assert_eq!(error, "pixel (2, 1) of channel R is NaN");
        let mut cropped = a.clone();
        cropped.resolution = [64, 64];
        let [a, cropped] = [&a, &cropped].map(|i| Estimate::of(i).expect("an estimate"));
        assert_eq!(compare(&a, &cropped, 1e-3), Err(CompareError::Shape));
    }
}
