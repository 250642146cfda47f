//! From a scene's media to the tables that kernels walk.
//!
//! What packet kernels render is a [`MediumRecord`] and its part of the [`Tables`]: a density times constants. All
//! else a medium can have (colours by voxel, light from within, a density by formula, further phase functions) is for
//! scalar code, and lies in [`Medium::details`] and [`Medium::phase`]. Every medium is walked alike, by its record:
//! at a tentative collision scalar code draws a [tap](woodcock_core::majorant::GridWalk::tap) where
//! [`Medium::has_samples`], and asks [`Medium::local`] what is there.

mod assembly;
mod blackbody;
mod bounds;
mod brick_bounds;
mod brick_leaves;
mod bricks;
mod cells;
mod cloud;
mod details;
mod emission;
mod field;
mod held;
mod local;
mod noise;
mod packets;
mod phase;
mod samples;
mod sources;
mod voxels;

pub(super) use crate::volume::rows;
pub(super) use assembly::{Surroundings, assemble};
pub use bricks::BrickTables;
pub use cloud::{CloudDensity, CloudField};
pub use details::Details;
pub use emission::Emission;
pub use field::{Beyond, Field};
pub use held::{Held, held};
pub use local::Local;
pub(crate) use packets::PacketSource;
pub use phase::PhaseFunction;
pub use voxels::EmissiveVoxel;

use glam::{DAffine3, DMat3, DVec3};
use woodcock_core::path::{MediumRecord, OneGrid, RecordKind, Store};

/// Samples and bounds of all grids of a scene, one after the other.
#[derive(Clone, Debug, Default)]
pub struct Tables {
    /// Samples; none where they are in bricks.
    pub samples: Vec<f32>,
    /// Majorants of blocks.
    pub majorants: Vec<f32>,
    /// The samples of a scene's only grid, instead of `samples`.
    pub bricks: Option<Box<BrickTables>>,
    /// Minorants and means of blocks, in the layout of the majorants, or nothing.
    pub controls: [Vec<f32>; 2],
}

/// From how many samples without empty margins on a grid is better kept in bricks.
///
/// CPU time of whole pictures in one table over that in bricks, medians of 11 interleaved pairs, one thread of a busy machine with
/// 2 MiB of second-level cache; the yardsticks of the benches, `cloud` resampled:
///
/// | samples | scene | table / bricks |
/// |---|---|---|
/// | 0.10 M | `cloud` of 64³ | 0.97 |
/// | 0.33 M | `cloud` of 96³ | 1.01 |
/// | 0.79 M | `cloud` of 128³ | 1.03 |
/// | 1.5 M | `cloud` of 160³ | 1.06 |
/// | 1.7 M | `smoke` | 1.08 |
/// | 1.7 M | `absorption` | 1.01 |
/// | 2.7 M | `cloud` of 192³ | 1.09 |
/// | 6.3 M | `cloud` of 256³ | 1.11 |
///
/// The bench `grids` compares flights alone.
pub(super) const BRICKS_FROM: usize = 1 << 19;

impl Tables {
    /// The sample of a tap; zero beyond the last.
    pub fn sample(&self, tap: u32) -> f32 {
        match &self.bricks {
            Some(bricks) => bricks.sample(tap),
            None => self.samples.get(tap as usize).copied().unwrap_or(0.0),
        }
    }

    /// The tap of the sample at coordinates of a grid, whose first sample and dimensions are those of its record.
    pub fn tap(&self, first: u32, dims: [u32; 3], [x, y, z]: [u32; 3]) -> u32 {
        match &self.bricks {
            Some(bricks) => bricks.index([x, y, z]),
            None => first + (z * dims[1] + y) * dims[0] + x,
        }
    }

    /// Computes what is known of the blocks of the only grid besides their bounds.
    ///
    /// * `record`: the grid's.
    pub fn fill_controls(&mut self, record: &MediumRecord) {
        if let RecordKind::Grid { dims, edge, .. } = record.kind {
            let controls = match &self.bricks {
                Some(bricks) => brick_bounds::controls(bricks, edge),
                None => bounds::controls(&self.samples, dims, edge),
            };
            if let Ok(controls) = controls {
                self.controls = controls;
            }
        }
    }

    /// Puts the samples of the only grid into bricks; nothing happens where they are there.
    ///
    /// * `record`: the grid's.
    pub fn into_bricks(&mut self, record: &MediumRecord) {
        if let RecordKind::Grid { dims, .. } = record.kind
            && self.bricks.is_none()
            && let Some(bricks) = BrickTables::of_dense(&self.samples, dims)
        {
            self.samples = Vec::new();
            self.bricks = Some(Box::new(bricks));
        }
    }

    /// The scene's only medium, a grid, for kernels.
    pub fn one_grid<'a>(&'a self, record: &MediumRecord) -> OneGrid<'a> {
        let store = match &self.bricks {
            Some(bricks) => Store::Bricks(bricks.borrow()),
            None => Store::Dense(&self.samples),
        };
        let [minorants, means] = &self.controls;
        OneGrid::stored(record, store, &self.majorants).with_controls(minorants, means)
    }

    /// Samples in the boxes of all grids.
    pub fn box_samples(&self) -> u64 {
        let of_bricks =
            |bricks: &BrickTables| bricks.dims().iter().map(|n| u64::from(*n)).product();
        let in_bricks = self.bricks.as_deref().map_or(0, of_bricks);
        in_bricks + self.samples.len() as u64
    }

    /// How many samples, and how many bytes hold all tables.
    pub fn size(&self) -> (u64, u64) {
        let samples = match &self.bricks {
            Some(bricks) => bricks.samples(),
            None => self.samples.len() as u64,
        };
        let numbers = self.samples.len()
            + self.majorants.len()
            + self.controls.iter().map(Vec::len).sum::<usize>();
        let bricks = self.bricks.as_ref().map_or(0, |bricks| bricks.bytes());
        (samples, 4 * numbers as u64 + bricks)
    }
}

/// The box outside of which a medium has no extinction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Support {
    /// World (as rendered) to the space where the box is [0, size].
    pub to_local: DAffine3,
    /// The far corner.
    pub size: DVec3,
}

impl Support {
    /// The box's corners in the world.
    pub fn corners(&self) -> [DVec3; 8] {
        let from_local = self.to_local.inverse();
        std::array::from_fn(|i| {
            let pick = |bit: usize| f64::from(u8::from(i >> bit & 1 == 1));
            from_local.transform_point3(self.size * DVec3::new(pick(0), pick(1), pick(2)))
        })
    }
}

/// A medium, assembled.
#[derive(Clone, Debug)]
pub struct Medium {
    /// What kernels read. Grids index the scene's [`Tables`]. Where there are details, colours and albedos are the
    /// largest of any place.
    pub record: MediumRecord,
    /// Where a grid lies; a homogeneous medium has no bound of its own.
    pub support: Option<Support>,
    /// Where it scatters to.
    pub phase: PhaseFunction,
    /// What packet kernels cannot do.
    pub details: Option<Box<Details>>,
    /// Absorption by colour of a sample of one [1/length], where it is the same for all samples.
    absorption: [f64; 3],
}

impl Medium {
    /// Whether extinction differs between colours.
    pub fn is_chromatic(&self) -> bool {
        match &self.details {
            Some(details) if details.shares.is_some() => details.chromatic,
            _ => {
                let [r, g, b] = self.record.colour;
                r != g || g != b
            }
        }
    }

    /// Whether packet kernels render it as it is.
    pub fn is_plain(&self) -> bool {
        self.details.is_none() && self.phase.is_plain()
    }

    /// Whether it shines.
    pub fn is_emissive(&self) -> bool {
        self.emission().is_some()
    }

    /// Light from within, if there is.
    pub fn emission(&self) -> Option<&Emission> {
        self.details.as_ref().and_then(|d| d.emission())
    }

    /// Whether its extinction is looked up among samples: a grid's, and not a formula's.
    pub fn has_samples(&self) -> bool {
        let is_grid = matches!(self.record.kind, RecordKind::Grid { .. });
        is_grid && self.cloud().is_none()
    }

    fn cloud(&self) -> Option<&CloudDensity> {
        self.details.as_ref().and_then(|d| d.cloud.as_ref())
    }

    /// The cloud for rays to walk through, if it is one.
    pub fn cloud_field<'a>(&'a self, tables: &'a Tables) -> Option<CloudField<'a>> {
        let density = self.cloud()?;
        Some(CloudField::new(&self.record, density, &tables.majorants))
    }

    /// From the rendered world to grid space, as kernels have it; `None` for a homogeneous medium.
    pub fn world_to_grid(&self) -> Option<DAffine3> {
        let RecordKind::Grid { world_to_grid, .. } = self.record.kind else {
            return None;
        };
        let [x, y, z] = world_to_grid.map(|row| row.map(f64::from));
        let column = |i: usize| DVec3::new(x[i], y[i], z[i]);
        Some(DAffine3 {
            matrix3: DMat3::from_cols(column(0), column(1), column(2)),
            translation: column(3),
        })
    }
}
