//! Grids that fill boxes: what scenes list, with samples at the centres of cells.

use glam::DAffine3;

use super::details::Share;
use super::field::{Beyond, Field};
use super::samples::Samples;
use crate::scene::{RgbGrid, UniformGrid};
use crate::volume::{CellBox, Limits};

/// A field of values in a box.
///
/// * `world_to`: the map from the rendered world to a space of this box's medium.
///
/// # Errors
/// The wrong number of values.
pub(super) fn field<const N: usize>(
    cells: CellBox,
    values: Vec<[f32; N]>,
    beyond: Beyond<N>,
    world_to: impl FnOnce(DAffine3) -> Result<DAffine3, String>,
) -> Result<Field<N>, String> {
    let expected: usize = cells.resolution.iter().product();
    if values.len() != expected {
        let [x, y, z] = cells.resolution;
        return Err(format!(
            "{} values where {x} x {y} x {z} are needed",
            values.len()
        ));
    }
    Ok(Field {
        values,
        dims: cells.resolution,
        world_to_grid: world_to(cells.to_volume(0.0))?,
        beyond,
    })
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
    let density = CellBox::from(grid).samples(limits, false, |index| {
        Ok(index
            .and_then(|i| grid.density.get(i))
            .copied()
            .unwrap_or(0.0))
    });
    density.map(Samples::from)
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
    let density = CellBox::from(grid).samples(&limits, false, |index| {
        let a = coefficient("sigma_a", &grid.sigma_a, index)?;
        let s = coefficient("sigma_s", &grid.sigma_s, index)?;
        let (largest, share) = Share::of(
            std::array::from_fn(|c| sigma_a[c] * a[c]),
            std::array::from_fn(|c| sigma_s[c] * s[c]),
        );
        shares.push(share);
        Ok((largest / scale) as f32)
    })?;
    Ok(Samples {
        shares: Some(shares),
        ..density.into()
    })
}
