//! From a scene's media to the tables that kernels walk.

use std::cell::RefCell;

use glam::{DAffine3, DMat3, DVec3};
use woodcock_core::majorant::{fill_majorants, majorant_count};
use woodcock_core::medium::Affine;
use woodcock_core::path::{MediumRecord, RecordKind};

use crate::scene::{Files, MediumKind, NamedMedium, Phase, SceneError, UniformGrid, Warning};
use crate::volume::{Limits, vdb};

/// Samples and bounds of all grids of a scene, one after the other.
#[derive(Clone, Debug, Default)]
pub struct Tables {
    /// Samples.
    pub samples: Vec<f32>,
    /// Majorants of blocks.
    pub majorants: Vec<f32>,
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
    /// What kernels read. Grids index the scene's [`Tables`].
    pub record: MediumRecord,
    /// Where a grid lies; a homogeneous medium has no bound of its own.
    pub support: Option<Support>,
}

impl Medium {
    /// Whether extinction differs between colours.
    pub fn is_chromatic(&self) -> bool {
        let [r, g, b] = self.record.colour;
        r != g || g != b
    }
}

/// A grid as a file or a scene gives it: samples at integer places of grid space, with a rim that
/// interpolation to the outside needs.
struct Samples {
    values: Vec<f32>,
    dims: [u32; 3],
    /// Grid space to the medium's space.
    to_medium: DAffine3,
    /// The part of grid space that has extinction.
    low: DVec3,
    high: DVec3,
}

/// Reads and checks a medium. `None` where nothing of it can be seen: no extinction, or no voxel.
///
/// * `origin`: the place of the world that becomes the origin of rendering.
///
/// # Errors
/// What is wrong with its file or values, at the medium's place in the scene.
pub(super) fn assemble(
    medium: &NamedMedium,
    origin: DVec3,
    files: &dyn Files,
    limits: &Limits,
    tables: &mut Tables,
    warnings: &mut Vec<Warning>,
) -> Result<Option<Medium>, SceneError> {
    let sigma_t: [f64; 3] = std::array::from_fn(|c| medium.sigma_a[c] + medium.sigma_s[c]);
    let scale = sigma_t.into_iter().fold(0.0, f64::max);
    if scale == 0.0 {
        return Ok(None);
    }
    if scale as f32 == f32::INFINITY || (scale as f32) < f32::MIN_POSITIVE {
        let message = format!("extinction {scale:e} is beyond the range of 32-bit numbers");
        return Err(SceneError::at(&medium.place, message).help("change the unit of length"));
    }
    let ratio = |part: f64, whole: f64| {
        if whole > 0.0 {
            (part / whole) as f32
        } else {
            0.0
        }
    };
    let (g, rayleigh) = match medium.phase {
        Phase::Isotropic => (0.0, false),
        Phase::HenyeyGreenstein { g } => (g as f32, false),
        Phase::Rayleigh => (0.0, true),
        Phase::Draine { .. } | Phase::TwoLobe { .. } | Phase::Droplets { .. } => (0.0, false),
    };
    if g.abs() >= 1.0 {
        let message = format!("mean cosine {g} rounds to one: scattering would be no scattering");
        return Err(SceneError::at(&medium.place, message));
    }
    let mut record = MediumRecord {
        kind: RecordKind::Homogeneous,
        scale: scale as f32,
        colour: sigma_t.map(|s| ratio(s, scale)),
        albedo: std::array::from_fn(|c| ratio(medium.sigma_s[c], sigma_t[c])),
        g,
        rayleigh,
    };
    let samples = match &medium.kind {
        MediumKind::Homogeneous => {
            return Ok(Some(Medium {
                record,
                support: None,
            }));
        }
        MediumKind::UniformGrid(grid) => uniform(grid, limits),
        MediumKind::RgbGrid(_)
        | MediumKind::Cloud(_)
        | MediumKind::NanoVdb(_)
        | MediumKind::Vol(_) => {
            let message = "this kind of medium is not yet supported";
            return Err(SceneError::at(&medium.place, message));
        }
        MediumKind::OpenVdb(vdb) => {
            let mut read = || -> Result<_, String> {
                let bytes = files
                    .read(&vdb.filename)
                    .map_err(|error| format!("cannot be read: {error}"))?;
                openvdb(&bytes, &vdb.gridname, limits, |remark| {
                    let remark = format!("{}: {remark}", vdb.filename.display());
                    warnings.push(SceneError::at(&medium.place, remark).into_warning());
                })
            };
            read().map_err(|why| format!("{}: {why}", vdb.filename.display()))
        }
    };
    let samples = samples.map_err(|why| SceneError::at(&medium.place, why))?;
    let Some(samples) = samples.and_then(trimmed) else {
        return Ok(None);
    };
    let placed = place(medium, &samples, origin)
        .ok_or_else(|| SceneError::at(&medium.place, "the medium's transform is singular"))?;
    record.kind = append(samples, placed.0, record.scale, tables).map_err(|why| {
        SceneError::at(&medium.place, format!("medium \"{}\": {why}", medium.name))
    })?;
    Ok(Some(Medium {
        record,
        support: Some(placed.1),
    }))
}

/// The samples without the empty margins that files carry around what can be seen, but with the rim that
/// interpolation fades out in. `None` where every sample is zero.
fn trimmed(samples: Samples) -> Option<Samples> {
    let [nx, ny, nz] = samples.dims.map(|d| d as usize);
    let (mut low, mut high) = ([usize::MAX; 3], [0; 3]);
    for (row, values) in samples.values.chunks_exact(nx).enumerate() {
        // Not `!= 0`: a NaN must stay, to be reported.
        let first = values.iter().position(|v| !(*v == 0.0));
        let last = values.iter().rposition(|v| !(*v == 0.0));
        if let Some((first, last)) = first.zip(last) {
            for (axis, (from, to)) in [(first, last), (row % ny, row % ny), (row / ny, row / ny)]
                .into_iter()
                .enumerate()
            {
                low[axis] = low[axis].min(from);
                high[axis] = high[axis].max(to);
            }
        }
    }
    if low[0] == usize::MAX {
        return None;
    }
    let low = low.map(|i| i.saturating_sub(1));
    let high: [usize; 3] = std::array::from_fn(|i| (high[i] + 1).min([nx, ny, nz][i] - 1));
    let size: [usize; 3] = std::array::from_fn(|i| high[i] - low[i] + 1);
    let mut values = Vec::with_capacity(size.iter().product());
    for z in low[2]..=high[2] {
        for y in low[1]..=high[1] {
            let row = (z * ny + y) * nx;
            values.extend_from_slice(samples.values.get(row + low[0]..=row + high[0])?);
        }
    }
    let corner = DVec3::from_array(low.map(|i| i as f64));
    let extent = DVec3::from_array(size.map(|n| (n - 1) as f64));
    Some(Samples {
        values,
        dims: size.map(|n| n as u32),
        to_medium: samples.to_medium * DAffine3::from_translation(corner),
        low: (samples.low - corner).max(DVec3::ZERO),
        high: (samples.high - corner).min(extent),
    })
}

/// The map from the rendered world to grid space, and the box.
fn place(medium: &NamedMedium, samples: &Samples, origin: DVec3) -> Option<(Affine, Support)> {
    let to_world = DAffine3::from_translation(-origin) * medium.medium_to_world * samples.to_medium;
    let to_grid = to_world.inverse();
    let finite = |m: &DAffine3| m.is_finite() && m.matrix3 != DMat3::ZERO;
    (finite(&to_world) && finite(&to_grid)).then(|| {
        let to_local = DAffine3::from_translation(-samples.low) * to_grid;
        let size = samples.high - samples.low;
        (rows(&to_grid), Support { to_local, size })
    })
}

/// The rows of an affine map in single precision.
pub(super) fn rows(map: &DAffine3) -> Affine {
    let (m, t) = (map.matrix3, map.translation);
    [0, 1, 2].map(|r| [m.x_axis[r], m.y_axis[r], m.z_axis[r], t[r]].map(|x| x as f32))
}

/// Adds a grid to the tables, with its bounds.
fn append(
    samples: Samples,
    world_to_grid: Affine,
    scale: f32,
    tables: &mut Tables,
) -> Result<RecordKind, String> {
    let dims = samples.dims;
    let bounds = majorant_count(dims).ok_or("its grid has too many voxels")?;
    let (first, first_bound) = (tables.samples.len(), tables.majorants.len());
    if first + samples.values.len() > i32::MAX as usize {
        return Err("the scene's grids have more than 2^31 voxels".into());
    }
    tables.majorants.resize(first_bound + bounds, 0.0);
    let space = tables.majorants.get_mut(first_bound..).unwrap_or_default();
    fill_majorants(&samples.values, dims, space).map_err(|error| error.to_string())?;
    // An infinite bound would leave paths where they are, for ever.
    let peak = space.iter().copied().fold(0.0, f32::max);
    if !(peak * scale).is_finite() {
        return Err(format!(
            "density {peak:e} times {scale:e} is beyond the range of 32-bit numbers"
        ));
    }
    if first == 0 {
        tables.samples = samples.values;
    } else {
        tables.samples.extend_from_slice(&samples.values);
    }
    Ok(RecordKind::Grid {
        world_to_grid,
        dims,
        samples: first as u32,
        majorants: first_bound as u32,
    })
}

/// Samples at the cell centres of a box, nothing beyond them.
fn uniform(grid: &UniformGrid, limits: &Limits) -> Result<Option<Samples>, String> {
    let [nx, ny, nz] = grid.resolution;
    let dims = padded([nx as u64, ny as u64, nz as u64], limits)?;
    let mut values = vec![0.0; dims.iter().map(|&d| d as usize).product()];
    let (row, slice) = (dims[0] as usize, dims[0] as usize * dims[1] as usize);
    for (i, from) in grid.density.chunks_exact(nx).enumerate() {
        let at = (i / ny + 1) * slice + (i % ny + 1) * row + 1;
        if let Some(to) = values.get_mut(at..at + nx) {
            to.copy_from_slice(from);
        }
    }
    let n = DVec3::new(nx as f64, ny as f64, nz as f64);
    let cell = (grid.p1 - grid.p0) / n;
    // Sample i of the padded grid lies at p0 + (i − 1/2) cells.
    let to_medium = DAffine3 {
        matrix3: DMat3::from_diagonal(cell),
        translation: grid.p0 - cell * 0.5,
    };
    let half = DVec3::splat(0.5);
    Ok(Some(Samples {
        values,
        dims,
        to_medium,
        low: half,
        high: n + half,
    }))
}

/// The dimensions of a grid with a rim of one sample, if memory has room for it.
fn padded(dims: [u64; 3], limits: &Limits) -> Result<[u32; 3], String> {
    let padded = dims.map(|d| d.saturating_add(2));
    let voxels = padded.iter().fold(1_u64, |n, &d| n.saturating_mul(d));
    let bytes = voxels.saturating_mul(4);
    if bytes > limits.max_memory || voxels > i32::MAX as u64 {
        let [x, y, z] = dims;
        return Err(format!(
            "a dense grid of {x} x {y} x {z} voxels needs {bytes} bytes, the limit is {} (and 2^31 voxels); \
             raise --max-memory or use a smaller volume",
            limits.max_memory
        ));
    }
    Ok(padded.map(|d| d as u32))
}

/// One grid of an OpenVDB file.
///
/// * `remark`: told what a user may not expect.
fn openvdb(
    bytes: &[u8],
    name: &str,
    limits: &Limits,
    mut remark: impl FnMut(String),
) -> Result<Option<Samples>, String> {
    let text = |error: vdb::VdbError| error.to_string();
    let seen = RefCell::new(Vec::new());
    let wanted = |grid: &str| {
        seen.borrow_mut().push(format!("\"{grid}\""));
        grid == name
    };
    let file = vdb::read_grids(bytes, limits, wanted).map_err(text)?;
    let Some(grid) = file.grid(name) else {
        let mut names = seen.into_inner();
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
    let voxels = grid.voxels().map_err(text)?;
    if voxels.components() != 1 {
        return Err(format!(
            "grid \"{name}\" has vectors; a density is one number a voxel"
        ));
    }
    if let Some(invalid) = voxels.first_invalid() {
        return Err(format!(
            "grid \"{name}\": {invalid}; a density is finite and not negative"
        ));
    }
    let Some(to_medium) = grid.transform.affine() else {
        return Err(format!(
            "grid \"{name}\" lies in a frustum, which cannot be rendered"
        ));
    };
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
    let values = voxels.to_dense(low, high, limits).map_err(text)?;
    let corner = DVec3::from_array(low.map(|i| i as f64));
    Ok(Some(Samples {
        values,
        dims,
        to_medium: to_medium * DAffine3::from_translation(corner),
        low: DVec3::ZERO,
        high: DVec3::from_array(dims.map(|d| f64::from(d - 1))),
    }))
}
