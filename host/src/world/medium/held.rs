//! What rendering would hold of a grid, for those who ask before they render.

use super::bounds::Bounds;
use super::brick_bounds;
use super::bricks::BrickTables;
use super::samples::Values;
use super::sources::Room;
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
    let room = Room::Bricks { from: BRICKS_FROM };
    let samples = samples::trimmed(sources::density(grid, room, limits)?)?;
    let dims = samples.dims;
    let box_samples = dims.iter().map(|n| u64::from(*n)).product();
    // The extinction is the scene's matter. In a thick medium blocks are smallest, and bounds take most room.
    let of_bounds = |bounds: &Bounds| 3 * 4 * bounds.majorants.len() as u64;
    let bricks = match samples.values {
        Values::Dense(values) => {
            let of_bounds = of_bounds(&Bounds::new(&values, dims, 1.0).ok()?);
            if values.len() < BRICKS_FROM {
                return Some(Held {
                    box_samples,
                    samples: box_samples,
                    bytes: 4 * box_samples + of_bounds,
                    bricks: false,
                    half: false,
                });
            }
            (BrickTables::of_dense(&values, dims)?, of_bounds)
        }
        Values::Bricks(bricks) => {
            let of_bounds = of_bounds(&brick_bounds::bounds(&bricks, 1.0).ok()?);
            (*bricks, of_bounds)
        }
    };
    let (bricks, of_bounds) = bricks;
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
