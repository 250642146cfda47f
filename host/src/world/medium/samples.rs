//! Grids on their way into the tables.

use glam::{DAffine3, DMat3, DVec3};
use woodcock_core::medium::Affine;
use woodcock_core::path::RecordKind;

use super::bounds::Bounds;
use super::brick_bounds;
use super::bricks::BrickTables;
use super::details::Share;
use super::{Support, Tables, rows};
use crate::scene::NamedMedium;
use crate::volume::Density;

/// A grid as a file or a scene gives it: samples at integer places of grid space, with a rim that
/// interpolation to the outside needs.
pub(super) struct Samples {
    pub(super) values: Values,
    /// What each sample does by colour, where that differs between samples.
    pub(super) shares: Option<Vec<Share>>,
    pub(super) dims: [u32; 3],
    /// Grid space to the medium's space.
    pub(super) to_medium: DAffine3,
    /// The part of grid space that has extinction.
    pub(super) low: DVec3,
    pub(super) high: DVec3,
}

impl From<Density> for Samples {
    fn from(density: Density) -> Self {
        let [low, high] = density.matter;
        Self {
            values: Values::Dense(density.samples),
            shares: None,
            dims: density.dims,
            to_medium: density.to_volume,
            low,
            high,
        }
    }
}

/// How samples come.
pub(super) enum Values {
    /// x fastest.
    Dense(Vec<f32>),
    /// In bricks, without empty margins, for a scene whose only medium this is.
    Bricks(Box<BrickTables>),
}

/// The part of the space of some samples that can be seen.
pub(super) struct Trim {
    /// First and last sample along each axis, the rim included.
    pub(super) low: [usize; 3],
    pub(super) high: [usize; 3],
}

impl Trim {
    pub(super) fn dims(&self) -> [usize; 3] {
        std::array::from_fn(|i| self.high[i] - self.low[i] + 1)
    }

    /// These samples of a grid whose own dimensions and place are given.
    pub(super) fn samples(
        &self,
        values: Values,
        shares: Option<Vec<Share>>,
        (to_medium, low, high): (DAffine3, DVec3, DVec3),
    ) -> Samples {
        let size = self.dims();
        let corner = DVec3::from_array(self.low.map(|i| i as f64));
        let extent = DVec3::from_array(size.map(|n| (n - 1) as f64));
        Samples {
            values,
            shares,
            dims: size.map(|n| n as u32),
            to_medium: to_medium * DAffine3::from_translation(corner),
            low: (low - corner).max(DVec3::ZERO),
            high: (high - corner).min(extent),
        }
    }
}

/// The samples without the empty margins that files carry around what can be seen, but with the rim that
/// interpolation fades out in. `None` where every sample is zero.
pub(super) fn trimmed(samples: Samples) -> Option<Samples> {
    let table = match &samples.values {
        Values::Bricks(_) => return Some(samples),
        Values::Dense(table) => table,
    };
    let [nx, ny, nz] = samples.dims.map(|d| d as usize);
    let (mut low, mut high) = ([usize::MAX; 3], [0; 3]);
    for (row, values) in table.chunks_exact(nx).enumerate() {
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
    let values = cropped(table, [nx, ny], low, high);
    let shares = samples
        .shares
        .map(|shares| cropped(&shares, [nx, ny], low, high));
    let place = (samples.to_medium, samples.low, samples.high);
    Some(Trim { low, high }.samples(Values::Dense(values), shares, place))
}

/// The part from `low` to `high`, both included, of a table with rows and slices of `size`.
fn cropped<T: Copy>(table: &[T], size: [usize; 2], low: [usize; 3], high: [usize; 3]) -> Vec<T> {
    let mut part = Vec::with_capacity((0..3).map(|i| high[i] - low[i] + 1).product());
    for z in low[2]..=high[2] {
        for y in low[1]..=high[1] {
            let row = (z * size[1] + y) * size[0];
            part.extend_from_slice(table.get(row + low[0]..=row + high[0]).unwrap_or_default());
        }
    }
    part
}

/// The map from the rendered world to a grid space; `None` where it is singular.
///
/// * `to_medium`: from a grid space to the medium's.
pub(super) fn inverse(
    medium: &NamedMedium,
    to_medium: DAffine3,
    origin: DVec3,
) -> Option<DAffine3> {
    let to_world = DAffine3::from_translation(-origin) * medium.medium_to_world * to_medium;
    let to_grid = to_world.inverse();
    let finite = |m: &DAffine3| m.is_finite() && m.matrix3 != DMat3::ZERO;
    (finite(&to_world) && finite(&to_grid)).then_some(to_grid)
}

/// The map from the rendered world to grid space in single precision, and the box.
pub(super) fn place(
    medium: &NamedMedium,
    samples: &Samples,
    origin: DVec3,
) -> Option<(Affine, Support)> {
    inverse(medium, samples.to_medium, origin).map(|to_grid| {
        let to_local = DAffine3::from_translation(-samples.low) * to_grid;
        let size = samples.high - samples.low;
        (rows(&to_grid), Support { to_local, size })
    })
}

/// Adds a grid to the tables, with its bounds.
pub(super) fn append(
    values: Values,
    dims: [u32; 3],
    world_to_grid: Affine,
    scale: f32,
    tables: &mut Tables,
) -> Result<RecordKind, String> {
    let (first, first_bound) = (tables.samples.len(), tables.majorants.len());
    let depth = f64::from(scale) * voxel_edge(&world_to_grid);
    let bounds = match &values {
        Values::Dense(values) => {
            if first + values.len() > i32::MAX as usize {
                return Err("the scene's grids have more than 2^31 voxels".into());
            }
            Bounds::new(values, dims, depth)
        }
        Values::Bricks(bricks) => brick_bounds::bounds(bricks, depth),
    };
    let bounds = bounds.map_err(|error| error.to_string())?;
    // An infinite bound would leave paths where they are, for ever.
    let peak = bounds.majorants.iter().copied().fold(0.0, f32::max);
    if !(peak * scale).is_finite() {
        return Err(format!(
            "density {peak:e} times {scale:e} is beyond the range of 32-bit numbers"
        ));
    }
    if first_bound + bounds.majorants.len() > i32::MAX as usize {
        return Err("its grid has too many voxels".into());
    }
    if first_bound == 0 {
        tables.majorants = bounds.majorants;
    } else {
        tables.majorants.extend_from_slice(&bounds.majorants);
    }
    match values {
        Values::Dense(values) if first == 0 => tables.samples = values,
        Values::Dense(values) => tables.samples.extend_from_slice(&values),
        Values::Bricks(bricks) => tables.bricks = Some(bricks),
    }
    Ok(RecordKind::Grid {
        world_to_grid,
        dims,
        samples: first as u32,
        majorants: first_bound as u32,
        edge: bounds.edge,
    })
}

/// The edge of a cube as large as a voxel \[length\].
fn voxel_edge(world_to_grid: &Affine) -> f64 {
    let [x, y, z] =
        world_to_grid.map(|[a, b, c, _]| DVec3::new(f64::from(a), f64::from(b), f64::from(c)));
    libm::cbrt(x.dot(y.cross(z)).abs()).recip().min(f64::MAX)
}
