//! What an image says about how it was made: the attributes of DESIGN's *Images*.
//!
//! | attribute | type | meaning |
//! |---|---|---|
//! | `samplesPerPixel` | int | samples of every pixel, or their mean where pixels differ: then the channel `Samples` has them |
//! | `renderTimeSeconds` | float | wall-clock seconds of rendering, without loading |
//! | `woodcock.version` | string | version of the program |
//! | `woodcock.seed` | string | seed, decimal (64 bits; OpenEXR has no such integer) |
//! | `woodcock.sceneHash` | string | hash of the scene, 16 hexadecimal digits |
//! | `woodcock.integrator`, `.kernel` | string | names as on the command line |
//! | `woodcock.samples` | string | half-open range of sample indices, as `0..64` |
//! | `woodcock.replicate` | string | how many consecutive samples depend on each other; 1 if none do |
//! | `woodcock.targetError` | string | the relative error asked for, if one was |
//! | `woodcock.majorantViolations` | string | count, decimal; not 0 means a biased image |
//! | `woodcock.stopping` | string | `samples`, `target`, `time` or `signal`: what ended the render |

use super::{AttributeValue, Image};
use crate::drive::Stopping;
use std::ops::Range;
use std::time::Duration;

/// The run that made an image.
#[derive(Clone, Debug, PartialEq)]
pub struct RenderMetadata {
    /// Seed of the streams.
    pub seed: u64,
    /// Hash of everything the scene's pixels depend on.
    pub scene_hash: u64,
    /// Name of the integrator.
    pub integrator: String,
    /// Name of the kernel.
    pub kernel: String,
    /// Indices of the samples traced, in every pixel or in that with the most.
    pub samples: Range<u32>,
    /// Samples per pixel, the mean where they differ.
    pub samples_per_pixel: f64,
    /// Samples of a replicate; one where samples are independent.
    pub replicate: u32,
    /// The relative error that was asked for.
    pub target_error: Option<f64>,
    /// Look-ups that exceeded their majorant.
    pub majorant_violations: u64,
    /// What ended the render.
    pub stopping: Stopping,
    /// Wall-clock time of rendering.
    pub render_time: Duration,
}

impl RenderMetadata {
    /// Writes the attributes into an image.
    pub fn apply(&self, image: &mut Image) {
        let spp = self.samples_per_pixel.round() as i32; // saturates
        image.set("samplesPerPixel", AttributeValue::Int(spp));
        let seconds = self.render_time.as_secs_f32();
        image.set("renderTimeSeconds", AttributeValue::Float(seconds));
        let mut text = |name: &str, value: String| {
            image.set(&format!("woodcock.{name}"), AttributeValue::Text(value));
        };
        text("version", env!("CARGO_PKG_VERSION").to_owned());
        text("seed", self.seed.to_string());
        text("sceneHash", format!("{:016x}", self.scene_hash));
        text("integrator", self.integrator.clone());
        text("kernel", self.kernel.clone());
        text(
            "samples",
            format!("{}..{}", self.samples.start, self.samples.end),
        );
        text("replicate", self.replicate.to_string());
        if let Some(target) = self.target_error {
            text("targetError", target.to_string());
        }
        text("majorantViolations", self.majorant_violations.to_string());
        text("stopping", self.stopping.name().to_owned());
    }
}
