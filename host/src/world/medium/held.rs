//! What rendering would hold of a grid, for those who ask before they render.

use super::bounds::Bounds;
use super::bricks::BrickTables;
use super::{BRICKS_FROM, samples, sources};
use crate::volume::Limits;
use crate::volume::vdb::Grid;

/// Memory that a scene with this grid as its only medium would hold for it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Held {
    /// Samples in the box of what can be seen.
    pub box_samples: u64,
    /// Samples that are kept: all of the box, or those of bricks with matter.
    pub samples: u64,
    /// Bytes of samples, their bytes to decide by, the places of bricks, and bounds.
    pub bytes: u64,
    /// Whether they lie in bricks.
    pub bricks: bool,
    /// Whether samples are in half precision.
    pub half: bool,
}

/// What rendering would hold; `None` for what cannot be rendered as a density, or not within the limits.
pub fn held(grid: &Grid, limits: &Limits) -> Option<Held> {
    let samples = samples::trimmed(sources::density(grid, limits)?)?;
    let (values, dims) = (samples.values, samples.dims);
    // The extinction is the scene's matter. In a thick medium blocks are smallest, and bounds take most room.
    let bounds = Bounds::new(&values, dims, 1.0).ok()?;
    let of_bounds = 3 * 4 * bounds.majorants.len() as u64;
    let box_samples = values.len() as u64;
    if values.len() < BRICKS_FROM {
        return Some(Held {
            box_samples,
            samples: box_samples,
            bytes: 4 * box_samples + of_bounds,
            bricks: false,
            half: false,
        });
    }
    let bricks = BrickTables::of_dense(&values, dims)?;
    Some(Held {
        box_samples,
        samples: bricks.samples(),
        bytes: bricks.bytes() + of_bounds,
        bricks: true,
        half: bricks.is_half(),
    })
}

impl Held {
    /// Bytes for each sample that is kept.
    pub fn bytes_per_sample(&self) -> f64 {
        self.bytes as f64 / self.samples.max(1) as f64
    }
}
