//! Media that shine, as lights: a place of one is chosen by how much it sends out.
//!
//! A voxel is chosen by its mean source, and a place by the trilinear weight that belongs to its sample (a tent over the
//! neighbouring cells). A look-up by one tap picks, at a given place, a sample with the same weight. So with place and
//! sample taken together the weight cancels, and the density left is P(voxel) / volume(voxel) wherever the sample is the
//! same: what the share between flying to a place and choosing it needs.

use glam::DVec3;

use super::Draws;
use crate::world::{Local, World};

/// The emissive voxels of all grids.
#[derive(Clone, Debug)]
pub(crate) struct Glow {
    /// Sum of the sources up to and with each voxel, times its volume.
    cumulative: Vec<f64>,
    /// Which medium, and which sample.
    voxels: Vec<(u32, u32)>,
    /// For each medium: the first sample of its grid, the sources by sample, and the volume of a voxel.
    fields: Vec<Option<Field>>,
    choice: f64,
}

/// What one medium sends out.
#[derive(Clone, Debug)]
struct Field {
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
    /// Probability with which light sampling chooses media that shine rather than other lights.
    pub(crate) fn choice(&self) -> f64 {
        self.choice
    }

    /// Density per volume of choosing a place by this sample [1/length³].
    pub(crate) fn pdf(&self, medium: usize, tap: Option<u32>) -> f64 {
        let Some(Some(field)) = self.fields.get(medium) else {
            return 0.0;
        };
        let density = tap.and_then(|tap| field.density.get(tap.checked_sub(field.first)? as usize));
        density.map_or(0.0, |density| f64::from(*density))
    }

    /// Chooses a place. Four numbers.
    pub(crate) fn sample(&self, _world: &World, _draws: &mut impl Draws) -> Option<Spot> {
        None
    }
}
