//! Grids that fill boxes: what scenes list, with samples at the centres of cells.

use glam::{DAffine3, DMat3, DVec3};

use super::details::Share;
use super::field::{Beyond, Field};
use super::samples::{Samples, Values, padded};
use crate::scene::{RgbGrid, UniformGrid};
use crate::volume::Limits;

/// A box cut into cells with a sample at the centre of each.
#[derive(Clone, Copy, Debug)]
pub(super) struct CellBox {
    pub(super) resolution: [usize; 3],
    pub(super) p0: DVec3,
    pub(super) p1: DVec3,
}

impl CellBox {
    fn cell(&self) -> DVec3 {
        let [nx, ny, nz] = self.resolution.map(|n| n as f64);
        (self.p1 - self.p0) / DVec3::new(nx, ny, nz)
    }

    /// From indices of samples, `rim` more of them before the first, to the medium's space.
    fn to_medium(self, rim: f64) -> DAffine3 {
        let cell = self.cell();
        DAffine3 {
            matrix3: DMat3::from_diagonal(cell),
            translation: self.p0 - cell * (rim - 0.5),
        }
    }

    /// A grid of the box with a rim around it, beyond which there is nothing.
    ///
    /// * `value`: of the sample of an index, which is `None` in the rim.
    /// * `nearest`: whether the rim repeats the outermost samples.
    pub(super) fn samples(
        self,
        limits: &Limits,
        nearest: bool,
        mut value: impl FnMut(Option<usize>) -> Result<f32, String>,
    ) -> Result<Samples, String> {
        let [nx, ny, nz] = self.resolution;
        let dims = padded([nx as u64, ny as u64, nz as u64], limits)?;
        let mut values = Vec::with_capacity(dims.iter().map(|&d| d as usize).product());
        // The index of a padded one along an axis.
        let index = |i: u32, n: usize| {
            let inside = (i as usize).wrapping_sub(1);
            if nearest {
                Some((i as usize).saturating_sub(1).min(n - 1))
            } else {
                (inside < n).then_some(inside)
            }
        };
        for z in 0..dims[2] {
            for y in 0..dims[1] {
                let row = index(z, nz)
                    .zip(index(y, ny))
                    .map(|(z, y)| (z * ny + y) * nx);
                for x in 0..dims[0] {
                    values.push(value(row.zip(index(x, nx)).map(|(row, x)| row + x))?);
                }
            }
        }
        let half = DVec3::splat(0.5);
        Ok(Samples {
            values: Values::Dense(values),
            shares: None,
            dims,
            to_medium: self.to_medium(1.0),
            low: half,
            high: DVec3::new(nx as f64, ny as f64, nz as f64) + half,
        })
    }

    /// A field of values in the box.
    ///
    /// * `world_to`: the map from the rendered world to a space of this box's medium.
    ///
    /// # Errors
    /// The wrong number of values.
    pub(super) fn field<const N: usize>(
        self,
        values: Vec<[f32; N]>,
        beyond: Beyond<N>,
        world_to: impl FnOnce(DAffine3) -> Result<DAffine3, String>,
    ) -> Result<Field<N>, String> {
        let expected: usize = self.resolution.iter().product();
        if values.len() != expected {
            let [x, y, z] = self.resolution;
            return Err(format!(
                "{} values where {x} x {y} x {z} are needed",
                values.len()
            ));
        }
        Ok(Field {
            values,
            dims: self.resolution,
            world_to_grid: world_to(self.to_medium(0.0))?,
            beyond,
        })
    }
}

impl From<&UniformGrid> for CellBox {
    fn from(grid: &UniformGrid) -> Self {
        Self {
            resolution: grid.resolution,
            p0: grid.p0,
            p1: grid.p1,
        }
    }
}

impl From<&RgbGrid> for CellBox {
    fn from(grid: &RgbGrid) -> Self {
        Self {
            resolution: grid.resolution,
            p0: grid.p0,
            p1: grid.p1,
        }
    }
}

/// Samples at the cell centres of a box, nothing beyond them.
pub(super) fn uniform(grid: &UniformGrid, limits: &Limits) -> Result<Samples, String> {
    CellBox::from(grid).samples(limits, false, |index| {
        Ok(index
            .and_then(|i| grid.density.get(i))
            .copied()
            .unwrap_or(0.0))
    })
}

/// Coefficients by colour at the cell centres of a box.
///
/// * `sigma_a`, `sigma_s`: common factors. `scale`: what a sample of one stands for [1/length].
pub(super) fn rgb(
    grid: &RgbGrid,
    sigma_a: [f64; 3],
    sigma_s: [f64; 3],
    scale: f64,
    limits: &Limits,
) -> Result<Samples, String> {
    // Seven numbers a voxel, not one.
    let limits = Limits {
        max_memory: limits.max_memory / 7,
    };
    let mut shares = Vec::new();
    let coefficient = |name: &str, list: &Option<Vec<[f32; 3]>>, index: Option<usize>| {
        let factor = match (list, index) {
            (None, _) => [1.0; 3],
            (Some(_), None) => [0.0; 3],
            (Some(list), Some(i)) => *list
                .get(i)
                .ok_or_else(|| format!("too few values of {name}"))?,
        };
        // Not `< 0`: a NaN is no coefficient.
        if factor.iter().all(|f| *f >= 0.0 && f.is_finite()) {
            Ok(factor.map(f64::from))
        } else {
            Err(format!(
                "{name} is {factor:?} at voxel {}: coefficients are finite and not negative",
                index.unwrap_or_default()
            ))
        }
    };
    let mut samples = CellBox::from(grid).samples(&limits, false, |index| {
        let a = coefficient("sigma_a", &grid.sigma_a, index)?;
        let s = coefficient("sigma_s", &grid.sigma_s, index)?;
        let (largest, share) = Share::of(
            std::array::from_fn(|c| sigma_a[c] * a[c]),
            std::array::from_fn(|c| sigma_s[c] * s[c]),
        );
        shares.push(share);
        Ok((largest / scale) as f32)
    })?;
    samples.shares = Some(shares);
    Ok(samples)
}
