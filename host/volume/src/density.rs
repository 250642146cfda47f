//! What a volume is to a renderer: samples of a density, and where they lie.

use crate::vdb::{self, Voxels};
use crate::vol::VolGrid;
use crate::{Limits, vol};
use glam::{DAffine3, DMat3, DVec3};
use std::cell::RefCell;

/// Samples at the integer places of a grid space, with a rim that interpolation to the outside needs.
#[derive(Clone, Debug)]
pub struct Density {
    /// Name of the grid in its file, where grids have names.
    pub name: Option<String>,
    /// x fastest.
    pub samples: Vec<f32>,
    /// Samples along x, y, z; each at least 3.
    pub dims: [u32; 3],
    /// Grid space to the volume's own.
    pub to_volume: DAffine3,
    /// Lower and upper corner of the part of grid space that has matter. There it is interpolated trilinearly, beyond it there is
    /// nothing.
    pub matter: [DVec3; 2],
}

impl Density {
    /// The density of an OpenVDB, NanoVDB or Mitsuba file, which their first bytes tell apart: of several grids the one named
    /// `density`, or else the first. Nowhere negative, and finite but for doubles beyond single precision. `None` where nothing is stored.
    ///
    /// * `remark`: told what a user may not expect.
    ///
    /// # Errors
    /// What is wrong with the file, in words. Never panics.
    pub fn of_file(
        bytes: &[u8],
        limits: &Limits,
        remark: impl FnMut(String),
    ) -> Result<Option<Self>, String> {
        if bytes.starts_with(&vol::MAGIC) {
            return Self::of_vol(bytes, limits).map(Some);
        }
        let read = |wanted: &dyn Fn(&str) -> bool| {
            let grids = if bytes.starts_with(&vdb::MAGIC) {
                vdb::read_grids(bytes, limits, wanted).map(|file| file.grids)
            } else {
                nano(bytes, limits, wanted)?
            };
            grids.map_err(|error| error.to_string())
        };
        let names = RefCell::new(Vec::new());
        read(&|name| {
            names.borrow_mut().push(name.to_owned());
            false
        })?;
        let names = names.into_inner();
        let usual = names.iter().find(|name| *name == "density");
        let Some(name) = usual.or(names.first()) else {
            return Err("it has no grids".to_owned());
        };
        let grids = read(&|grid| grid == name)?;
        let Some(grid) = grids.iter().find(|grid| grid.name == *name) else {
            return Err(format!("its grid \"{name}\" cannot be read"));
        };
        let stored = Scalar::of(grid)?.stored(remark)?;
        stored.map(|stored| stored.dense(limits)).transpose()
    }

    /// The density of a Mitsuba file: constant between the outermost samples and the faces of the unit cube.
    ///
    /// # Errors
    /// What is wrong with the file, in words; colours and negative values.
    pub fn of_vol(bytes: &[u8], limits: &Limits) -> Result<Self, String> {
        let grid = VolGrid::within(bytes, 1, f32::MAX, limits)?;
        CellBox::from(&grid).samples(limits, true, |index| {
            Ok(index
                .and_then(|i| grid.values.get(i))
                .copied()
                .unwrap_or(0.0))
        })
    }
}

/// The grids of a NanoVDB file.
///
/// # Errors
/// It is none.
fn nano(
    bytes: &[u8],
    limits: &Limits,
    wanted: &dyn Fn(&str) -> bool,
) -> Result<Result<Vec<vdb::Grid>, vdb::VdbError>, String> {
    #[cfg(feature = "nvdb")]
    if bytes.starts_with(&crate::nvdb::MAGIC) {
        return Ok(crate::nvdb::read_grids(bytes, limits, wanted).map(|file| file.grids));
    }
    let _ = (bytes, limits, wanted);
    Err("it is no volume that can be read here".to_owned())
}

impl VolGrid {
    /// Reads a grid of so many channels with values from zero to a largest.
    ///
    /// # Errors
    /// What is wrong with the file, in words.
    pub fn within(
        bytes: &[u8],
        channels: usize,
        largest: f32,
        limits: &Limits,
    ) -> Result<Self, String> {
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
}

/// A grid with one number a voxel.
#[derive(Clone, Copy, Debug)]
pub struct Scalar<'a> {
    /// Its name.
    pub name: &'a str,
    /// Its values.
    pub voxels: &'a Voxels,
    /// Index space to the volume's own.
    pub to_volume: DAffine3,
}

impl<'a> Scalar<'a> {
    /// A grid of a file.
    ///
    /// # Errors
    /// Why it is none, in words: vectors, a frustum, a kind of grid that cannot be read.
    pub fn of(grid: &'a vdb::Grid) -> Result<Self, String> {
        let name = &grid.name;
        if let Some(reason) = grid.unreadable() {
            return Err(format!("grid \"{name}\" cannot be rendered: {reason}"));
        }
        let voxels = grid.voxels().map_err(|error| error.to_string())?;
        if voxels.components() != 1 {
            return Err(format!(
                "grid \"{name}\" has vectors; a density is one number a voxel"
            ));
        }
        let Some(to_volume) = grid.transform.affine() else {
            return Err(format!(
                "grid \"{name}\" lies in a frustum, which cannot be rendered"
            ));
        };
        Ok(Self {
            name,
            voxels,
            to_volume,
        })
    }

    /// Where it has to be sampled, as a density; `None` where nothing is stored.
    ///
    /// * `remark`: told what a user may not expect.
    ///
    /// # Errors
    /// Values that are no densities.
    pub fn stored(self, mut remark: impl FnMut(String)) -> Result<Option<Stored<'a>>, String> {
        let Self { name, voxels, .. } = self;
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
        Ok(voxels.stored_box().map(|(min, max)| Stored {
            name,
            voxels,
            low: min.map(|i| i - 1),
            high: max.map(|i| i + 1),
            to_volume: self.to_volume,
        }))
    }
}

/// The part of a grid that its density fills, with the rim.
#[derive(Clone, Copy, Debug)]
pub struct Stored<'a> {
    /// The grid's name.
    pub name: &'a str,
    /// The grid's values.
    pub voxels: &'a Voxels,
    /// First voxel.
    pub low: [i64; 3],
    /// Last voxel.
    pub high: [i64; 3],
    to_volume: DAffine3,
}

impl Stored<'_> {
    /// From samples, the first of which is at [`low`](Self::low), to the volume's own space.
    pub fn to_volume(&self) -> DAffine3 {
        let corner = DVec3::from_array(self.low.map(|i| i as f64));
        self.to_volume * DAffine3::from_translation(corner)
    }

    /// Samples along x, y, z.
    pub fn size(&self) -> [u64; 3] {
        [0, 1, 2].map(|i| (self.high[i] - self.low[i] + 1).unsigned_abs())
    }

    /// Lower and upper corner of what has matter.
    pub fn matter(&self) -> [DVec3; 2] {
        let far = self.size().map(|n| (n - 1) as f64);
        [DVec3::ZERO, DVec3::from_array(far)]
    }

    /// All its samples in one table.
    ///
    /// # Errors
    /// More memory than the limit.
    pub fn dense(&self, limits: &Limits) -> Result<Density, String> {
        let dims = padded(self.size().map(|n| n - 2), limits)?;
        let samples = self.voxels.to_dense(self.low, self.high, limits);
        Ok(Density {
            name: Some(self.name.to_owned()),
            samples: samples.map_err(|error| error.to_string())?,
            dims,
            to_volume: self.to_volume(),
            matter: self.matter(),
        })
    }
}

/// A box cut into cells with a sample at the centre of each.
#[derive(Clone, Copy, Debug)]
pub struct CellBox {
    /// Cells along x, y, z; each at least 1.
    pub resolution: [usize; 3],
    /// Lower corner, in the volume's own space.
    pub p0: DVec3,
    /// Upper corner, greater in every coordinate.
    pub p1: DVec3,
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

impl CellBox {
    fn cell(&self) -> DVec3 {
        let [nx, ny, nz] = self.resolution.map(|n| n as f64);
        (self.p1 - self.p0) / DVec3::new(nx, ny, nz)
    }

    /// From indices of samples, `rim` more of them before the first, to the volume's own space.
    pub fn to_volume(self, rim: f64) -> DAffine3 {
        let cell = self.cell();
        DAffine3 {
            matrix3: DMat3::from_diagonal(cell),
            translation: self.p0 - cell * (rim - 0.5),
        }
    }

    /// Samples with a rim around them, beyond which there is nothing.
    ///
    /// * `value`: of the sample of an index, which is `None` in the rim.
    /// * `nearest`: whether the rim repeats the outermost samples.
    ///
    /// # Errors
    /// Those of `value`, and more memory than the limit.
    pub fn samples(
        self,
        limits: &Limits,
        nearest: bool,
        mut value: impl FnMut(Option<usize>) -> Result<f32, String>,
    ) -> Result<Density, String> {
        let [nx, ny, nz] = self.resolution;
        let dims = padded([nx as u64, ny as u64, nz as u64], limits)?;
        let mut samples = Vec::with_capacity(dims.iter().map(|&d| d as usize).product());
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
                    samples.push(value(row.zip(index(x, nx)).map(|(row, x)| row + x))?);
                }
            }
        }
        let half = DVec3::splat(0.5);
        Ok(Density {
            name: None,
            samples,
            dims,
            to_volume: self.to_volume(1.0),
            matter: [half, DVec3::new(nx as f64, ny as f64, nz as f64) + half],
        })
    }
}

/// The rows of an affine map in single precision, as the core takes them.
#[must_use]
pub fn rows(map: &DAffine3) -> [[f32; 4]; 3] {
    let (m, t) = (map.matrix3, map.translation);
    [0, 1, 2].map(|r| [m.x_axis[r], m.y_axis[r], m.z_axis[r], t[r]].map(|x| x as f32))
}

/// The dimensions of a grid with a rim of one sample, if memory has room for it.
///
/// # Errors
/// How much memory is wanted, in words.
pub fn padded(dims: [u64; 3], limits: &Limits) -> Result<[u32; 3], String> {
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
