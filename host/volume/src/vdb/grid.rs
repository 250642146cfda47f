//! One grid of a file.

use super::{Metadata, Statistics, Transform, VdbError, Voxels};
use glam::DVec3;
use std::sync::Arc;

/// A grid: its name and type, how it lies in the world, and its values where they could be read.
#[derive(Debug, Clone)]
pub struct Grid {
    /// Name; several grids of a file may share one.
    pub name: String,
    /// Name that no other grid of the file has: duplicates carry a suffix of U+001E and a number.
    pub unique_name: String,
    /// Type as OpenVDB names it, without the mark of half floats, for instance `Tree_float_5_4_3`.
    pub type_name: String,
    /// Unique name of the grid whose values this one shares, if any.
    pub instance_of: Option<String>,
    /// Whether the values were saved as half floats.
    pub half: bool,
    /// The grid's own metadata.
    pub metadata: Metadata,
    /// Place in the world.
    pub transform: Transform,
    pub(crate) voxels: Option<Arc<Voxels>>,
    pub(crate) reason: Option<String>,
}

impl Grid {
    /// `fog volume`, `level set`, `staggered`, or `unknown`.
    #[must_use]
    pub fn class(&self) -> &'static str {
        let class = self.metadata.get("class").map(|entry| &entry.value);
        let named =
            |name: &str| matches!(class, Some(super::MetaValue::Text(text)) if text == name);
        ["fog volume", "level set", "staggered"]
            .into_iter()
            .find(|&name| named(name))
            .unwrap_or("unknown")
    }

    /// Why this grid cannot be rendered; `None` if it can.
    #[must_use]
    pub fn unreadable(&self) -> Option<&str> {
        self.reason.as_deref()
    }

    /// The values.
    ///
    /// # Errors
    /// [`VdbError::InGrid`] for a kind of grid that is only listed. A grid in a frustum has values but cannot be
    /// rendered: see [`unreadable`](Self::unreadable).
    pub fn voxels(&self) -> Result<&Voxels, VdbError> {
        self.voxels.as_deref().ok_or_else(|| {
            let reason = self.reason.clone().unwrap_or_default();
            VdbError::Unreadable(reason).in_grid(&self.name)
        })
    }

    /// [`Voxels::statistics`].
    ///
    /// # Errors
    /// As [`voxels`](Self::voxels).
    pub fn statistics(&self) -> Result<Statistics, VdbError> {
        Ok(self.voxels()?.statistics())
    }

    /// Trilinear value of component `n` at a point of the world; the background far outside, NaN where the point is not
    /// finite.
    ///
    /// # Errors
    /// As [`voxels`](Self::voxels).
    pub fn trilinear(&self, n: usize, world: DVec3) -> Result<f64, VdbError> {
        Ok(self.voxels()?.trilinear(n, self.transform.to_index(world)))
    }

    /// Line integral \[value · world length\] of the trilinear interpolant of component `n` along a segment of the world:
    /// the optical depth where the values are extinction. Exact up to rounding.
    ///
    /// # Errors
    /// As [`voxels`](Self::voxels), and for a frustum, in which segments are not straight in index space.
    pub fn line_integral(&self, n: usize, from: DVec3, to: DVec3) -> Result<f64, VdbError> {
        let voxels = self.voxels()?;
        if self.transform.affine().is_none() {
            let reason = "a line integral in a frustum transform is not supported".to_owned();
            return Err(VdbError::Unreadable(reason).in_grid(&self.name));
        }
        let mean = voxels.mean_along(
            n,
            self.transform.to_index(from),
            self.transform.to_index(to),
        );
        Ok(mean * (to - from).length())
    }
}
