//! Where the density of media comes from: grids in the scene, pbrt's cloud, volume files.

use std::path::PathBuf;

use glam::DVec3;

use super::super::SceneError;
use super::super::medium::{Cloud, MediumKind, NanoVdb, OpenVdb, RgbGrid, UniformGrid, Vol};
use super::param::{Param, Type};
use super::params::Params;
use super::reader::Reader;

impl Reader<'_> {
    pub(super) fn uniform_grid(&mut self, params: &Params) -> Result<MediumKind, SceneError> {
        let resolution = self.resolution(params, 4)?;
        let Some((values, param)) = params.list("density", Type::Float)? else {
            let message = "this uniformgrid has no \"float density\"";
            return Err(SceneError::at(params.place(), message));
        };
        let density = voxels(values, param, resolution, "density value")?;
        let (p0, p1) = region(params)?;
        Ok(MediumKind::UniformGrid(UniformGrid {
            resolution,
            density,
            p0,
            p1,
        }))
    }

    pub(super) fn rgb_grid(&mut self, params: &Params) -> Result<MediumKind, SceneError> {
        let resolution = self.resolution(params, 36)?;
        let grid = |name: &'static str| -> Result<Option<Vec<[f32; 3]>>, SceneError> {
            let Some((values, param)) = params.list(name, Type::Rgb)? else {
                return Ok(None);
            };
            let [nx, ny, nz] = resolution;
            let found = values.len() / 3;
            if found as u128 != count(resolution) {
                let message = format!(
                    "{found} values of {name}, but nx * ny * nz = {nx} * {ny} * {nz} = {}",
                    count(resolution)
                );
                return Err(SceneError::at(&param.valued, message));
            }
            let values = checked(values, param, name, |i| position(i / 3, resolution))?;
            let (triples, _) = values.as_chunks::<3>();
            Ok(Some(triples.to_vec()))
        };
        let sigma_a = grid("sigma_a")?;
        let sigma_s = grid("sigma_s")?;
        let mut le = grid("Le")?;
        if sigma_a.is_none() && sigma_s.is_none() {
            let message = "this rgbgrid has neither \"rgb sigma_a\" nor \"rgb sigma_s\"";
            return Err(SceneError::at(params.place(), message));
        }
        if le.is_some() && sigma_a.is_none() {
            let message = "an rgbgrid with \"Le\" needs \"rgb sigma_a\", as in pbrt";
            return Err(SceneError::at(params.place(), message));
        }
        if le.iter().flatten().flatten().all(|c| *c == 0.0) {
            le = None;
        }
        let (p0, p1) = region(params)?;
        Ok(MediumKind::RgbGrid(RgbGrid {
            resolution,
            sigma_a,
            sigma_s,
            le,
            p0,
            p1,
        }))
    }

    pub(super) fn openvdb(&mut self, params: &Params) -> Result<MediumKind, SceneError> {
        let (filename, gridname) = self.grid_of_file(params, "this openvdb medium")?;
        Ok(MediumKind::OpenVdb(OpenVdb { filename, gridname }))
    }

    pub(super) fn nanovdb(&mut self, params: &Params) -> Result<MediumKind, SceneError> {
        let (filename, gridname) = self.grid_of_file(params, "this nanovdb medium")?;
        Ok(MediumKind::NanoVdb(NanoVdb { filename, gridname }))
    }

    fn grid_of_file(
        &mut self,
        params: &Params,
        what: &str,
    ) -> Result<(PathBuf, String), SceneError> {
        let filename = self.existing_file(params, "filename", what)?;
        let gridname = params.string("gridname")?;
        let gridname = gridname.map_or("density", |text| &text.text).to_owned();
        Ok((filename, gridname))
    }

    pub(super) fn vol(&mut self, params: &Params) -> Result<MediumKind, SceneError> {
        let filename = self.existing_file(params, "filename", "this vol medium")?;
        let albedo = match params.string("albedofilename")? {
            Some(_) => Some(self.existing_file(params, "albedofilename", "this vol medium")?),
            None => None,
        };
        Ok(MediumKind::Vol(Vol { filename, albedo }))
    }

    /// `nx`, `ny`, `nz`, refused where voxels of so many bytes would exceed the memory limit.
    fn resolution(&self, params: &Params, bytes: u128) -> Result<[usize; 3], SceneError> {
        let size = |name| -> Result<usize, SceneError> {
            let size = params.integer(name, "at least 1", |n| n >= 1)?;
            Ok(size.unwrap_or(1) as usize)
        };
        let resolution = [size("nx")?, size("ny")?, size("nz")?];
        let [nx, ny, nz] = resolution;
        let bytes = count(resolution) * bytes;
        if bytes > u128::from(self.limits.max_memory) {
            let message = format!("a grid of {nx} x {ny} x {nz} voxels takes {bytes} bytes");
            let limit = format!("the limit is {} bytes", self.limits.max_memory);
            return Err(SceneError::at(params.place(), message).help(limit));
        }
        Ok(resolution)
    }
}

/// pbrt's procedural cloud.
pub(super) fn cloud(params: &Params) -> Result<MediumKind, SceneError> {
    let number = |name, default| -> Result<f64, SceneError> {
        let fine = |v: f64| v >= 0.0 && (v as f32).is_finite();
        Ok(params.float(name, "0 or more", fine)?.unwrap_or(default))
    };
    let (p0, p1) = region(params)?;
    Ok(MediumKind::Cloud(Cloud {
        density: number("density", 1.0)?,
        wispiness: number("wispiness", 1.0)?,
        frequency: number("frequency", 5.0)?,
        p0,
        p1,
    }))
}

fn count([nx, ny, nz]: [usize; 3]) -> u128 {
    nx as u128 * ny as u128 * nz as u128
}

fn position(i: usize, [nx, ny, _]: [usize; 3]) -> (usize, usize, usize) {
    (i % nx, i / nx % ny, i / nx / ny)
}

/// One number per voxel, x fastest.
pub(super) fn voxels(
    values: &[f64],
    param: &Param,
    resolution: [usize; 3],
    what: &str,
) -> Result<Vec<f32>, SceneError> {
    let [nx, ny, nz] = resolution;
    let expected = count(resolution);
    if values.len() as u128 != expected {
        let message = format!(
            "{} {what}s, but nx * ny * nz = {nx} * {ny} * {nz} = {expected}",
            values.len()
        );
        return Err(SceneError::at(&param.valued, message));
    }
    checked(values, param, what, |i| position(i, resolution))
}

/// Not negative, and finite in the precision that we render in.
fn checked(
    values: &[f64],
    param: &Param,
    what: &str,
    position: impl Fn(usize) -> (usize, usize, usize),
) -> Result<Vec<f32>, SceneError> {
    let mut rounded = Vec::with_capacity(values.len());
    for (i, &value) in values.iter().enumerate() {
        let single = value as f32;
        if !(single.is_finite() && value >= 0.0) {
            let (x, y, z) = position(i);
            let fault = if value < 0.0 {
                "negative"
            } else {
                "too large for f32"
            };
            let message = format!("{what} {i} is {fault}: {value} at voxel ({x}, {y}, {z})");
            return Err(SceneError::at(&param.nth(i), message));
        }
        rounded.push(single);
    }
    Ok(rounded)
}

/// The box from `p0` to `p1`, the unit cube by default.
fn region(params: &Params) -> Result<(DVec3, DVec3), SceneError> {
    let (p0, p1) = (params.point("p0")?, params.point("p1")?);
    let (a, b) = (p0.unwrap_or(DVec3::ZERO), p1.unwrap_or(DVec3::ONE));
    let (p0, p1) = (a.min(b), a.max(b));
    if !(p1 - p0).is_finite() || (p1 - p0).min_element() <= 0.0 {
        let message = "the box from p0 to p1 has no volume";
        return Err(SceneError::at(params.place(), message));
    }
    Ok((p0, p1))
}
