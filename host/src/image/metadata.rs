//! What an image says about how it was made: the attributes of DESIGN's *Images*.
//!
//! | attribute | type | meaning |
//! |---|---|---|
//! | `samplesPerPixel` | int | samples asked of every pixel and traced |
//! | `renderTimeSeconds` | float | wall-clock seconds of rendering, without loading |
//! | `woodcock.version` | string | version of the program |
//! | `woodcock.seed` | string | seed, decimal (64 bits; OpenEXR has no such integer) |
//! | `woodcock.sceneHash` | string | hash of the scene, 16 hexadecimal digits |
//! | `woodcock.integrator`, `.kernel` | string | names as on the command line |
//! | `woodcock.samples` | string | half-open range of sample indices, as `0..64` |
//! | `woodcock.majorantViolations` | string | count, decimal; not 0 means a biased image |
//! | `woodcock.stopping` | string | `samples`, `time` or `signal`: what ended the render |

use super::{AttributeValue, Image};
use crate::drive::Stopping;
use std::ops::Range;
use std::time::Duration;

/// The run that made an image.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RenderMetadata {
    /// Seed of the streams.
    pub seed: u64,
    /// Hash of everything the scene's pixels depend on.
    pub scene_hash: u64,
    /// Name of the integrator.
    pub integrator: String,
    /// Name of the kernel.
    pub kernel: String,
    /// Indices of the samples traced in every pixel.
    pub samples: Range<u32>,
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
        let spp = self.samples.end.saturating_sub(self.samples.start);
        let spp = i32::try_from(spp).unwrap_or(i32::MAX);
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
        text("majorantViolations", self.majorant_violations.to_string());
        text("stopping", self.stopping.name().to_owned());
    }
}
