//! Grids that volume files hold.

use std::cell::RefCell;

use glam::{DAffine3, DVec3};

use super::bricks::BrickTables;
use super::cells::field;
use super::field::{Beyond, Field};
use super::samples::{Samples, Trim, Values};
use crate::volume::vol::VolGrid;
use crate::volume::{Density, Limits, Scalar, nvdb, padded, vdb};

/// The grids of a medium's file: the density, and the temperature where one is asked for.
pub(super) struct FileGrids {
    /// `None` where no voxel is stored.
    pub(super) density: Option<Samples>,
    /// Temperatures, and from their grid to the medium's space.
    pub(super) temperature: Option<(Field<1>, DAffine3)>,
}

/// Where the density of a file may go.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Room {
    /// Into one table.
    Table,
    /// Into bricks, if it has so many samples without empty margins.
    Bricks {
        /// That many.
        from: usize,
    },
}

/// Grids of an OpenVDB file.
///
/// * `remark`: told what a user may not expect.
pub(super) fn openvdb(
    bytes: &[u8],
    density: (&str, Room),
    temperature: Option<&str>,
    limits: &Limits,
    remark: impl FnMut(String),
) -> Result<FileGrids, String> {
    let read = |wanted: &Wanted<'_>| Ok(vdb::read_grids(bytes, limits, wanted)?.grids);
    of_file(read, density, temperature, limits, remark)
}

/// Grids of a NanoVDB file.
///
/// * `remark`: told what a user may not expect.
pub(super) fn nanovdb(
    bytes: &[u8],
    density: (&str, Room),
    temperature: Option<&str>,
    limits: &Limits,
    remark: impl FnMut(String),
) -> Result<FileGrids, String> {
    let read = |wanted: &Wanted<'_>| Ok(nvdb::read_grids(bytes, limits, wanted)?.grids);
    of_file(read, density, temperature, limits, remark)
}

/// The density of a Mitsuba file: constant between the outermost samples and the faces of its box.
pub(super) fn vol_density(bytes: &[u8], limits: &Limits) -> Result<Samples, String> {
    Density::of_vol(bytes, limits).map(Samples::from)
}

/// Albedos by colour of a Mitsuba file.
///
/// * `world_to`: the map from the rendered world to a space of the medium.
pub(super) fn vol_albedo(
    bytes: &[u8],
    limits: &Limits,
    world_to: impl FnOnce(DAffine3) -> Result<DAffine3, String>,
) -> Result<Field<3>, String> {
    let grid = VolGrid::within(bytes, 3, 1.0, limits)?;
    let (colours, _) = grid.values.as_chunks::<3>();
    field((&grid).into(), colours.to_vec(), Beyond::Nearest, world_to)
}

/// Whether a grid of a name is to be read.
type Wanted<'a> = dyn Fn(&str) -> bool + 'a;

/// Density and temperature among the grids of a file.
///
/// * `read`: asks of each grid whether it is wanted, and gives those.
fn of_file(
    read: impl FnOnce(&Wanted<'_>) -> Result<Vec<vdb::Grid>, vdb::VdbError>,
    (density, room): (&str, Room),
    temperature: Option<&str>,
    limits: &Limits,
    remark: impl FnMut(String),
) -> Result<FileGrids, String> {
    let seen = RefCell::new(Vec::new());
    let wanted = |grid: &str| {
        seen.borrow_mut().push(format!("\"{grid}\""));
        grid == density || Some(grid) == temperature
    };
    let grids = read(&wanted).map_err(|error| error.to_string())?;
    let names = seen.into_inner();
    let density = samples(scalar(&grids, &names, density)?, room, limits, remark)?;
    let temperature = match temperature {
        Some(name) => Some(temperatures(scalar(&grids, &names, name)?, limits)?),
        None => None,
    };
    Ok(FileGrids {
        density,
        temperature,
    })
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
    Scalar::of(grid)
}

/// The density of a grid; `None` where it cannot be one, or takes too much memory.
pub(super) fn density(grid: &vdb::Grid, room: Room, limits: &Limits) -> Option<Samples> {
    samples(Scalar::of(grid).ok()?, room, limits, |_| ()).ok()?
}

/// The density of a grid.
fn samples(
    grid: Scalar<'_>,
    room: Room,
    limits: &Limits,
    remark: impl FnMut(String),
) -> Result<Option<Samples>, String> {
    let Some(stored) = grid.stored(remark)? else {
        return Ok(None);
    };
    let voxels = grid.voxels;
    if let Room::Bricks { from } = room
        && voxels.background() as f32 == 0.0
    {
        let Some((min, max)) = voxels.visible_box() else {
            return Ok(None);
        };
        let trim = Trim {
            low: [0, 1, 2].map(|a| (min[a] - 1 - stored.low[a]) as usize),
            high: [0, 1, 2].map(|a| (max[a] + 1 - stored.low[a]) as usize),
        };
        let dims = trim.dims().map(|n| n as u64);
        let count = dims.iter().fold(1, |n: u64, d| n.saturating_mul(*d));
        if count >= from as u64 {
            let bricks = BrickTables::of_voxels(voxels, min.map(|i| i - 1), dims, limits)?;
            let [low, high] = stored.matter();
            return Ok(Some(trim.samples(
                Values::Bricks(Box::new(bricks)),
                None,
                (stored.to_volume(), low, high),
            )));
        }
    }
    Ok(Some(stored.dense(limits)?.into()))
}

/// Temperatures of a grid: its background lies beyond what it stores. The field's own map is not yet set.
fn temperatures(grid: Scalar<'_>, limits: &Limits) -> Result<(Field<1>, DAffine3), String> {
    let background = grid.voxels.background() as f32;
    let (min, max) = grid.voxels.stored_box().unwrap_or(([0; 3], [0; 3]));
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
    Ok((field, grid.to_volume * DAffine3::from_translation(corner)))
}
