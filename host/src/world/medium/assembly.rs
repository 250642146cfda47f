//! A scene's medium, read, checked and placed.

use std::path::Path;

use glam::{DAffine3, DVec3};
use woodcock_core::majorant::BLOCK;
use woodcock_core::path::{MediumRecord, RecordKind};

use super::blackbody::DARK;
use super::cells::{self, field};
use super::cloud::CloudDensity;
use super::details::{Details, Share};
use super::emission::{Emission, Radiance, Temperatures};
use super::field::{Beyond, Field};
use super::samples::{self, Samples};
use super::sources::{self, FileGrids, Room};
use super::{Medium, PhaseFunction, Support, Tables};
use crate::scene::{
    self, Cloud, Files, MediumKind, NamedMedium, SceneError, TemperatureValues, Warning,
};
use crate::volume::{CellBox, Limits};

/// What assembly is told besides the medium.
pub(in crate::world) struct Surroundings<'a> {
    /// The place of the world that becomes the origin of rendering.
    pub(in crate::world) origin: DVec3,
    /// The film's factor on all light.
    pub(in crate::world) exposure: f64,
    /// Where volumes are read from.
    pub(in crate::world) files: &'a dyn Files,
    /// What reading may cost.
    pub(in crate::world) limits: &'a Limits,
    /// From how many samples on a grid goes to bricks at once; `None` where it is not the scene's only medium.
    pub(in crate::world) bricks_from: Option<usize>,
}

impl Surroundings<'_> {
    /// What `parse` makes of a file and remarks on it; errors and remarks begin with the file's name.
    fn read<T>(
        &self,
        name: &Path,
        remarks: &mut Vec<String>,
        parse: impl FnOnce(&[u8], &mut dyn FnMut(String)) -> Result<T, String>,
    ) -> Result<T, String> {
        let named = |why: String| format!("{}: {why}", name.display());
        let bytes = self
            .files
            .read(name)
            .map_err(|error| named(format!("cannot be read: {error}")))?;
        parse(&bytes, &mut |remark| remarks.push(named(remark))).map_err(named)
    }

    /// The map from the rendered world to a space of a medium.
    fn world_to(&self, medium: &NamedMedium, to_medium: DAffine3) -> Result<DAffine3, String> {
        samples::inverse(medium, to_medium, self.origin)
            .ok_or_else(|| "the medium's transform is singular".to_owned())
    }
}

/// What fills a medium.
enum Filling {
    Homogeneous,
    Grid(Samples),
    Cloud(CloudDensity),
}

/// What reading a medium's kind found.
struct Found {
    filling: Filling,
    albedo: Option<Field<3>>,
    temperature: Option<(Field<1>, DAffine3)>,
}

impl From<Filling> for Found {
    fn from(filling: Filling) -> Self {
        Self {
            filling,
            albedo: None,
            temperature: None,
        }
    }
}

/// Reads and checks a medium. `None` where nothing of it can be seen: no extinction, or no voxel.
///
/// # Errors
/// What is wrong with its file or values, at the medium's place in the scene.
pub(in crate::world) fn assemble(
    medium: &NamedMedium,
    around: &Surroundings<'_>,
    tables: &mut Tables,
    warnings: &mut Vec<Warning>,
) -> Result<Option<Medium>, SceneError> {
    let wrong = |why: String| SceneError::at(&medium.place, why);
    let sigma_t: [f64; 3] = std::array::from_fn(|c| medium.sigma_a[c] + medium.sigma_s[c]);
    let scale = sigma_t.into_iter().fold(0.0, f64::max);
    if scale == 0.0 {
        return Ok(None);
    }
    if scale as f32 == f32::INFINITY || (scale as f32) < f32::MIN_POSITIVE {
        let message = format!("extinction {scale:e} is beyond the range of 32-bit numbers");
        return Err(wrong(message).help("change the unit of length"));
    }
    let phase = PhaseFunction::new(&medium.phase).map_err(wrong)?;
    let mut record = record(medium, sigma_t, scale, &phase);
    let mut remarks = Vec::new();
    let found = fill(medium, around, (scale, phase.is_plain()), &mut remarks).map_err(wrong)?;
    warnings.extend(
        remarks
            .into_iter()
            .map(|remark| SceneError::at(&medium.place, remark).into_warning()),
    );
    let Some(found) = found else {
        return Ok(None);
    };
    let emission = emission(medium, found.temperature, around).map_err(wrong)?;
    let mut details = Details {
        albedo: found.albedo,
        emission,
        ..Details::default()
    };
    if let Some(field) = &details.albedo {
        record.albedo = field.range().1;
    }
    let singular = || SceneError::at(&medium.place, "the medium's transform is singular");
    let named = |why: String| wrong(format!("medium \"{}\": {why}", medium.name));
    let support = match found.filling {
        Filling::Homogeneous => None,
        Filling::Grid(grid) => {
            let Some(grid) = samples::trimmed(grid) else {
                return Ok(None);
            };
            let (map, support) =
                samples::place(medium, &grid, around.origin).ok_or_else(singular)?;
            if let Some(shares) = &grid.shares {
                bounding(&mut record, shares);
                details.chromatic = shares.iter().any(Share::is_chromatic);
            }
            details.shares = grid.shares;
            record.kind = samples::append(grid.values, grid.dims, map, record.scale, tables)
                .map_err(named)?;
            Some(support)
        }
        Filling::Cloud(cloud) => {
            let to_medium = cloud.grid_to_medium();
            let to_grid =
                samples::inverse(medium, to_medium, around.origin).ok_or_else(singular)?;
            let majorants = cloud
                .majorants()
                .map_err(|error| named(error.to_string()))?;
            record.kind = RecordKind::Grid {
                world_to_grid: super::rows(&to_grid),
                dims: CloudDensity::DIMS,
                samples: 0,
                majorants: tables.majorants.len() as u32,
                edge: BLOCK,
            };
            tables.majorants.extend(majorants);
            details.cloud = Some(cloud);
            Some(Support {
                to_local: to_grid,
                size: DVec3::from_array(CloudDensity::DIMS.map(|n| f64::from(n - 1))),
            })
        }
    };
    Ok(Some(Medium {
        record,
        support,
        phase,
        absorption: medium.sigma_a,
        details: (!details.is_empty()).then(|| Box::new(details)),
    }))
}

/// The constants of a medium, homogeneous for now.
fn record(
    medium: &NamedMedium,
    sigma_t: [f64; 3],
    scale: f64,
    phase: &PhaseFunction,
) -> MediumRecord {
    let ratio = |part: f64, whole: f64| {
        if whole > 0.0 {
            (part / whole) as f32
        } else {
            0.0
        }
    };
    let (g, rayleigh) = match phase {
        PhaseFunction::HenyeyGreenstein { g } => (*g, false),
        PhaseFunction::Rayleigh => (0.0, true),
        _ => (0.0, false),
    };
    MediumRecord {
        kind: RecordKind::Homogeneous,
        scale: scale as f32,
        colour: sigma_t.map(|s| ratio(s, scale)),
        albedo: std::array::from_fn(|c| ratio(medium.sigma_s[c], sigma_t[c])),
        g,
        rayleigh,
    }
}

/// Puts the largest colours and albedos of any voxel into the record.
fn bounding(record: &mut MediumRecord, shares: &[Share]) {
    let (mut colour, mut albedo) = ([0.0_f32; 3], [0.0_f32; 3]);
    for share in shares {
        let (extinction, scattered) = (share.extinction(), share.albedo());
        for c in 0..3 {
            colour[c] = colour[c].max(extinction[c] as f32);
            albedo[c] = albedo[c].max(scattered[c] as f32);
        }
    }
    (record.colour, record.albedo) = (colour, albedo);
}

/// Reads what a medium is made of; `None` where it stores nothing.
fn fill(
    medium: &NamedMedium,
    around: &Surroundings<'_>,
    (scale, plain_phase): (f64, bool),
    remarks: &mut Vec<String>,
) -> Result<Option<Found>, String> {
    let limits = around.limits;
    // Whatever scalar code keeps beside samples counts them in one table.
    let plain = plain_phase && medium.emission.is_none();
    let room = match around.bricks_from {
        Some(from) if plain => Room::Bricks { from },
        _ => Room::Table,
    };
    Ok(Some(match &medium.kind {
        MediumKind::Homogeneous => Filling::Homogeneous.into(),
        MediumKind::UniformGrid(grid) => Filling::Grid(cells::uniform(grid, limits)?).into(),
        MediumKind::RgbGrid(grid) => {
            let (sigma_a, sigma_s) = (medium.sigma_a, medium.sigma_s);
            Filling::Grid(cells::rgb(grid, sigma_a, sigma_s, scale, limits)?).into()
        }
        MediumKind::Cloud(cloud) => {
            check_cloud(cloud)?;
            let to_medium = around.world_to(medium, DAffine3::IDENTITY)?;
            Filling::Cloud(CloudDensity::new(*cloud, to_medium)).into()
        }
        MediumKind::OpenVdb(vdb) => {
            let temperature = temperature_grid(medium);
            let grids = around.read(&vdb.filename, remarks, |bytes, remark| {
                sources::openvdb(bytes, (&vdb.gridname, room), temperature, limits, remark)
            })?;
            return Ok(of_file(grids));
        }
        MediumKind::NanoVdb(nano) => {
            let temperature = temperature_grid(medium);
            let grids = around.read(&nano.filename, remarks, |bytes, remark| {
                sources::nanovdb(bytes, (&nano.gridname, room), temperature, limits, remark)
            })?;
            return Ok(of_file(grids));
        }
        MediumKind::Vol(vol) => {
            let density = around.read(&vol.filename, remarks, |bytes, _| {
                sources::vol_density(bytes, limits)
            })?;
            let mut found = Found::from(Filling::Grid(density));
            if let Some(name) = &vol.albedo {
                let albedo = around.read(name, remarks, |bytes, _| {
                    sources::vol_albedo(bytes, limits, |to_medium| {
                        around.world_to(medium, to_medium)
                    })
                })?;
                found.albedo = Some(albedo);
            }
            found
        }
    }))
}

fn of_file(grids: FileGrids) -> Option<Found> {
    Some(Found {
        filling: Filling::Grid(grids.density?),
        albedo: None,
        temperature: grids.temperature,
    })
}

/// The name of the grid of temperatures in the medium's file, if it has one.
fn temperature_grid(medium: &NamedMedium) -> Option<&str> {
    match &medium.emission.as_ref()?.temperature.as_ref()?.values {
        TemperatureValues::Grid(name) => Some(name),
        TemperatureValues::Listed(_) => None,
    }
}

fn check_cloud(cloud: &Cloud) -> Result<(), String> {
    let Cloud {
        density,
        wispiness,
        frequency,
        p0,
        p1,
    } = cloud;
    for (name, value) in [
        ("density", *density),
        ("wispiness", *wispiness),
        ("frequency", *frequency),
    ] {
        if !(value >= 0.0 && value.is_finite()) {
            return Err(format!(
                "a cloud's {name} is {value}: it is finite and not negative"
            ));
        }
    }
    if !(p0.cmplt(*p1).all() && (*p1 - *p0).is_finite()) {
        return Err(format!("a cloud's box from {p0} to {p1} has no inside"));
    }
    Ok(())
}

/// The light of a medium; `None` where there is none.
fn emission(
    medium: &NamedMedium,
    temperature: Option<(Field<1>, DAffine3)>,
    around: &Surroundings<'_>,
) -> Result<Option<Emission>, String> {
    let world_to = |to_medium: DAffine3| around.world_to(medium, to_medium);
    let listed = |values: &[f32], beyond: f32| -> Result<Field<1>, String> {
        let cells = match &medium.kind {
            MediumKind::UniformGrid(grid) => CellBox::from(grid),
            MediumKind::RgbGrid(grid) => CellBox::from(grid),
            _ => return Err("values of emission by voxel need a grid in the scene".to_owned()),
        };
        let values = values.iter().map(|v| [*v]).collect();
        field(cells, values, Beyond::Value([beyond]), world_to)
    };
    let le = match &medium.kind {
        MediumKind::RgbGrid(grid) => grid.le.as_ref().map(|le| (CellBox::from(grid), le)),
        _ => None,
    };
    let Some(told) = medium.emission.clone().or_else(|| {
        le.map(|_| scene::Emission {
            scale: 1.0,
            ..Default::default()
        })
    }) else {
        return Ok(None);
    };
    let radiance = if let Some(told) = &told.temperature {
        let field = match (&told.values, temperature) {
            (TemperatureValues::Listed(values), _) => {
                check("a temperature", values, |v| v.is_finite())?;
                listed(values, 0.0)?
            }
            (TemperatureValues::Grid(_), Some((field, to_medium))) => Field {
                world_to_grid: world_to(to_medium)?,
                ..field
            },
            (TemperatureValues::Grid(name), None) => {
                return Err(format!(
                    "a grid of temperatures \"{name}\" needs a file of grids"
                ));
            }
        };
        check("the offset of temperatures", &[told.offset], f64::is_finite)?;
        check("the scale of temperatures", &[told.scale], |v| {
            v >= 0.0 && v.is_finite()
        })?;
        let temperatures = Temperatures::new(field, told.offset, told.scale);
        if temperatures.hottest() <= DARK {
            return Ok(None);
        }
        Radiance::Temperature(Box::new(temperatures))
    } else if let Some((cells, le)) = le {
        check("Le", le.as_flattened(), |v| v >= 0.0 && v.is_finite())?;
        Radiance::Field(field(cells, le.clone(), Beyond::Value([0.0; 3]), world_to)?)
    } else {
        check("Le", &told.le, |v| v >= 0.0 && v.is_finite())?;
        Radiance::Constant(told.le)
    };
    let factor = match &told.scale_grid {
        Some(values) => {
            check("a factor of emission", values, |v| {
                v >= 0.0 && v.is_finite()
            })?;
            Some(listed(values, 0.0)?)
        }
        None => None,
    };
    let scale = told.scale * around.exposure;
    check("the scale of emission", &[scale], |v| {
        v >= 0.0 && v.is_finite()
    })?;
    let dark = scale == 0.0
        || factor.as_ref().is_some_and(|f| f.range().1 == [0.0])
        || matches!(&radiance, Radiance::Constant(le) if *le == [0.0; 3])
        || matches!(&radiance, Radiance::Field(le) if le.range().1 == [0.0; 3]);
    Ok((!dark).then_some(Emission {
        scale,
        factor,
        radiance,
    }))
}

/// Refuses values that break a rule, by the first of them.
fn check<T: Copy + std::fmt::Display>(
    what: &str,
    values: &[T],
    rule: impl Fn(T) -> bool,
) -> Result<(), String> {
    match values.iter().position(|v| !rule(*v)) {
        Some(at) => Err(format!("{what} is {} (value {at})", values[at])),
        None => Ok(()),
    }
}
