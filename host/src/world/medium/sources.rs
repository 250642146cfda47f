//! Grids from what scenes list and files hold.

use std::cell::RefCell;

use glam::{DAffine3, DMat3, DVec3};

use super::details::Share;
use super::field::{Beyond, Field};
use super::samples::{Samples, padded};
use crate::scene::{RgbGrid, UniformGrid};
use crate::volume::vol::{self, VolGrid};
use crate::volume::{Limits, nvdb, vdb};

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
    fn samples(
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
            values,
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

/// The grids of a medium's file: the density, and the temperature where one is asked for.
pub(super) struct FileGrids {
    /// `None` where no voxel is stored.
    pub(super) density: Option<Samples>,
    /// Temperatures, and from their grid to the medium's space.
    pub(super) temperature: Option<(Field<1>, DAffine3)>,
}

/// Grids of an OpenVDB file.
///
/// * `remark`: told what a user may not expect.
pub(super) fn openvdb(
    bytes: &[u8],
    density: &str,
    temperature: Option<&str>,
    limits: &Limits,
    remark: impl FnMut(String),
) -> Result<FileGrids, String> {
    let seen = RefCell::new(Vec::new());
    let wanted = |grid: &str| {
        seen.borrow_mut().push(format!("\"{grid}\""));
        grid == density || Some(grid) == temperature
    };
    let file = vdb::read_grids(bytes, limits, wanted).map_err(|error| error.to_string())?;
    let names = seen.into_inner();
    of_file(&file.grids, names, density, temperature, limits, remark)
}

/// Grids of a NanoVDB file.
///
/// * `remark`: told what a user may not expect.
pub(super) fn nanovdb(
    bytes: &[u8],
    density: &str,
    temperature: Option<&str>,
    limits: &Limits,
    remark: impl FnMut(String),
) -> Result<FileGrids, String> {
    let seen = RefCell::new(Vec::new());
    let wanted = |grid: &str| {
        seen.borrow_mut().push(format!("\"{grid}\""));
        grid == density || Some(grid) == temperature
    };
    let file = nvdb::read_grids(bytes, limits, wanted).map_err(|error| error.to_string())?;
    let names = seen.into_inner();
    of_file(&file.grids, names, density, temperature, limits, remark)
}

impl From<&VolGrid> for CellBox {
    /// Mitsuba's grids fill the unit cube.
    fn from(grid: &VolGrid) -> Self {
        Self {
            resolution: grid.size,
            p0: DVec3::ZERO,
            p1: DVec3::ONE,
        }
    }
}

/// Reads a grid of Mitsuba's, of so many channels and with values up to a largest.
fn mitsuba(
    bytes: &[u8],
    channels: usize,
    largest: f32,
    limits: &Limits,
) -> Result<VolGrid, String> {
    let grid = vol::read(bytes, limits).map_err(|error| error.to_string())?;
    if grid.channels != channels {
        return Err(format!(
            "it has {} channel(s) where {channels} are needed",
            grid.channels
        ));
    }
    if let Some(n) = grid
        .values
        .iter()
        .position(|v| !(0.0..=largest).contains(v))
    {
        let (voxel, value) = (n / channels, grid.values[n]);
        let [nx, ny, _] = grid.size;
        let (x, y, z) = (voxel % nx, voxel / nx % ny, voxel / nx / ny);
        return Err(format!(
            "voxel ({x}, {y}, {z}) is {value}: it must lie between 0 and {largest:e}"
        ));
    }
    Ok(grid)
}

/// The density of a Mitsuba file: constant between the outermost samples and the faces of its box.
pub(super) fn vol_density(bytes: &[u8], limits: &Limits) -> Result<Samples, String> {
    let grid = mitsuba(bytes, 1, f32::MAX, limits)?;
    CellBox::from(&grid).samples(limits, true, |index| {
        Ok(index
            .and_then(|i| grid.values.get(i))
            .copied()
            .unwrap_or(0.0))
    })
}

/// Albedos by colour of a Mitsuba file.
///
/// * `world_to`: the map from the rendered world to a space of the medium.
pub(super) fn vol_albedo(
    bytes: &[u8],
    limits: &Limits,
    world_to: impl FnOnce(DAffine3) -> Result<DAffine3, String>,
) -> Result<Field<3>, String> {
    let grid = mitsuba(bytes, 3, 1.0, limits)?;
    let (colours, _) = grid.values.as_chunks::<3>();
    CellBox::from(&grid).field(colours.to_vec(), Beyond::Nearest, world_to)
}

/// Density and temperature among the grids of a file that has grids of these names.
fn of_file(
    grids: &[vdb::Grid],
    names: Vec<String>,
    density: &str,
    temperature: Option<&str>,
    limits: &Limits,
    remark: impl FnMut(String),
) -> Result<FileGrids, String> {
    let density = dense(scalar(grids, &names, density)?, limits, remark)?;
    let temperature = match temperature {
        Some(name) => Some(temperatures(scalar(grids, &names, name)?, limits)?),
        None => None,
    };
    Ok(FileGrids {
        density,
        temperature,
    })
}

/// A grid with one number a voxel, and its transform.
struct Scalar<'a> {
    name: &'a str,
    voxels: &'a vdb::Voxels,
    to_medium: DAffine3,
}

fn scalar<'a>(grids: &'a [vdb::Grid], names: &[String], name: &str) -> Result<Scalar<'a>, String> {
    let Some(grid) = grids.iter().find(|grid| grid.name == name) else {
        let mut names = names.to_vec();
        names.sort();
        names.dedup();
        return Err(match names.is_empty() {
            true => format!("there is no grid \"{name}\": the file has no grids"),
            false => format!("there is no grid \"{name}\", only {}", names.join(", ")),
        });
    };
    if let Some(reason) = grid.unreadable() {
        return Err(format!("grid \"{name}\" cannot be rendered: {reason}"));
    }
    let voxels = grid.voxels().map_err(|error| error.to_string())?;
    if voxels.components() != 1 {
        return Err(format!(
            "grid \"{name}\" has vectors; a density is one number a voxel"
        ));
    }
    let Some(to_medium) = grid.transform.affine() else {
        return Err(format!(
            "grid \"{name}\" lies in a frustum, which cannot be rendered"
        ));
    };
    Ok(Scalar {
        name: &grid.name,
        voxels,
        to_medium,
    })
}

/// The density of a grid, dense.
fn dense(
    grid: Scalar<'_>,
    limits: &Limits,
    mut remark: impl FnMut(String),
) -> Result<Option<Samples>, String> {
    let Scalar {
        name,
        voxels,
        to_medium,
    } = grid;
    if let Some(invalid) = voxels.first_invalid() {
        return Err(format!(
            "grid \"{name}\": {invalid}; a density is finite and not negative"
        ));
    }
    let background = voxels.background();
    if background != 0.0 {
        remark(format!(
            "grid \"{name}\" has the background {background}: it ends one voxel beyond the stored values"
        ));
    }
    let Some((min, max)) = voxels.statistics().stored_bbox else {
        return Ok(None);
    };
    let size = [0, 1, 2].map(|i| (max[i] - min[i] + 1).unsigned_abs());
    let dims = padded(size, limits)?;
    let (low, high) = (min.map(|i| i - 1), max.map(|i| i + 1));
    let values = voxels
        .to_dense(low, high, limits)
        .map_err(|error| error.to_string())?;
    let corner = DVec3::from_array(low.map(|i| i as f64));
    Ok(Some(Samples {
        values,
        shares: None,
        dims,
        to_medium: to_medium * DAffine3::from_translation(corner),
        low: DVec3::ZERO,
        high: DVec3::from_array(dims.map(|d| f64::from(d - 1))),
    }))
}

/// Temperatures of a grid: its background lies beyond what it stores. The field's own map is not yet set.
fn temperatures(grid: Scalar<'_>, limits: &Limits) -> Result<(Field<1>, DAffine3), String> {
    let background = grid.voxels.background() as f32;
    let (min, max) = grid
        .voxels
        .statistics()
        .stored_bbox
        .unwrap_or(([0; 3], [0; 3]));
    let size = [0, 1, 2].map(|i| (max[i] - min[i] + 1).unsigned_abs());
    padded(size, limits)?;
    let values = grid
        .voxels
        .to_dense(min, max, limits)
        .map_err(|error| error.to_string())?;
    if let Some(wrong) = values.iter().chain([&background]).find(|v| !v.is_finite()) {
        return Err(format!(
            "grid \"{}\" has the value {wrong}; a temperature is finite",
            grid.name
        ));
    }
    let corner = DVec3::from_array(min.map(|i| i as f64));
    let field = Field {
        values: values.into_iter().map(|v| [v]).collect(),
        dims: size.map(|n| n as usize),
        world_to_grid: DAffine3::IDENTITY,
        beyond: Beyond::Value([background]),
    };
    Ok((field, grid.to_medium * DAffine3::from_translation(corner)))
}
