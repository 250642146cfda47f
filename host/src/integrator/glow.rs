//! Media that shine, as lights: a place of one is chosen by how much it sends out.
//!
//! A voxel is chosen by its mean source, and a place by the trilinear weight that belongs to its sample (a tent over the
//! neighbouring cells). A look-up by one tap picks, at a given place, a sample with the same weight. So with place and
//! sample taken together the weight cancels, and the density left is P(voxel) / volume(voxel) wherever the sample is the
//! same: what the share between flying to a place and choosing it needs.
//!
//! Memory: four bytes for each sample of a grid that shines, sixteen for each voxel that does.

use glam::DVec3;
use woodcock_core::medium::Medium as _;
use woodcock_core::path::RecordKind;

use super::Draws;
use super::walk::stand;
use crate::light::discrete::Discrete;
use crate::world::{Local, Medium, Tables, World};

/// The voxels that shine, of all grids.
#[derive(Debug)]
pub(crate) struct Glow {
    /// The voxels by power.
    powers: Discrete,
    /// Medium and sample of each.
    voxels: Vec<(u32, u32)>,
    /// What each medium sends out, if it does.
    fields: Vec<Option<Field>>,
    choice: f64,
}

/// What one medium sends out.
#[derive(Clone, Debug)]
struct Field {
    /// Index of its grid's first sample.
    first: u32,
    /// P(voxel) / volume(voxel), by sample [1/length³].
    density: Vec<f32>,
}

/// A place that was chosen.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Spot {
    pub(crate) medium: usize,
    pub(crate) place: DVec3,
    /// What the medium is there, by the sample chosen.
    pub(crate) local: Local,
    /// Density per volume, the sample's weight left out [1/length³].
    pub(crate) pdf: f64,
    /// The rate of the medium's process there [1/length].
    pub(crate) majorant: f64,
}

impl Glow {
    /// Gathers the voxels that shine; `None` if none does.
    ///
    /// * `alone`: there are no other lights to choose from.
    pub(crate) fn new(media: &[Medium], tables: &Tables, alone: bool) -> Option<Self> {
        let mut powers = Vec::new();
        let mut voxels = Vec::new();
        let mut fields = Vec::with_capacity(media.len());
        for (number, medium) in (0_u32..).zip(media) {
            let shining = medium.emissive_voxels(tables);
            let (RecordKind::Grid { dims, samples, .. }, Some(to_world), false) = (
                medium.record.kind,
                medium.grid_to_world(),
                shining.is_empty(),
            ) else {
                fields.push(None);
                continue;
            };
            let volume = to_world.matrix3.determinant().abs();
            let count = dims.iter().map(|d| *d as usize).product();
            let mut density = vec![0.0; count];
            for voxel in shining {
                let power = voxel.source.iter().sum::<f64>();
                powers.push(power * volume);
                voxels.push((number, voxel.index));
                if let Some(entry) = density.get_mut(voxel.index as usize) {
                    *entry = power as f32;
                }
            }
            fields.push(Some(Field {
                first: samples,
                density,
            }));
        }
        let powers = Discrete::new(powers.into_iter());
        let total = powers.total();
        if !(total > 0.0 && total.is_finite()) {
            return None;
        }
        // So far: power per volume.
        for entry in fields.iter_mut().flatten().flat_map(|f| &mut f.density) {
            *entry = (f64::from(*entry) / total) as f32;
        }
        Some(Self {
            powers,
            voxels,
            fields,
            choice: if alone { 1.0 } else { 0.5 },
        })
    }

    /// Probability with which light sampling chooses media that shine rather than other lights.
    pub(crate) fn choice(&self) -> f64 {
        self.choice
    }

    /// Density per volume of choosing a place by this sample [1/length³]; zero where none is chosen.
    pub(crate) fn pdf(&self, medium: usize, tap: Option<u32>) -> f64 {
        let Some(Some(field)) = self.fields.get(medium) else {
            return 0.0;
        };
        let density = tap.and_then(|tap| field.density.get(tap.checked_sub(field.first)? as usize));
        density.map_or(0.0, |density| f64::from(*density))
    }

    /// Chooses a place; the caller asks whether it lies within the medium's boundaries. Four numbers.
    pub(crate) fn sample(&self, world: &World, draws: &mut impl Draws) -> Option<Spot> {
        let (chosen, _) = self.powers.choose(draws.one())?;
        let offset = DVec3::from_array(draws.three().map(tent));
        let &(number, index) = self.voxels.get(chosen)?;
        let medium = number as usize;
        let description = world.media.get(medium)?;
        let RecordKind::Grid { dims, samples, .. } = description.record.kind else {
            return None;
        };
        let [nx, ny, _] = dims;
        let at = [index % nx, index / nx % ny, index / (nx * ny)].map(f64::from);
        let to_world = description.grid_to_world()?;
        let place = to_world.transform_point3(DVec3::from_array(at) + offset);
        let tap = Some(samples + index);
        let (grid, walk) = stand(description, &world.tables, place)?;
        Some(Spot {
            medium,
            place,
            local: description.local(&world.tables, tap, place),
            pdf: self.pdf(medium, tap),
            majorant: f64::from(grid.segment(&walk).majorant),
        })
    }
}

/// Distributed as the weight of linear interpolation about a sample: a tent over (−1, 1).
fn tent(u: f64) -> f64 {
    if u < 0.5 {
        (2.0 * u).sqrt() - 1.0
    } else {
        1.0 - (2.0 - 2.0 * u).sqrt()
    }
}
