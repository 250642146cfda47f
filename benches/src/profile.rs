//! Three rays that separate estimators of transmittance: smooth, rough and mostly empty.
//!
//! Each is a grid that varies along x only, 256 voxel cells in 32 majorant blocks, with the largest extinction at
//! eight mean free paths a ray: σ̄L = 8 under one bound for the whole ray.

use woodcock_core::majorant::{
    ControlledGrid, MajorantError, MajorantGrid, fill_controls, fill_majorants, majorant_count,
};
use woodcock_core::medium::{Grid, IDENTITY};
use woodcock_core::stream::{Key, PathStream, Stream};

/// Samples along the ray.
const SAMPLES: u32 = 257;
/// Samples of the grid; what varies, varies along x.
const DIMS: [u32; 3] = [SAMPLES, 2, 2];
/// Length of the ray, in voxel cells.
pub const LENGTH: f32 = (SAMPLES - 1) as f32;
/// The largest extinction times the length.
const MAJORANT_DEPTH: f32 = 8.0;

/// A density along a ray, as a grid with bounds and controls.
#[derive(Clone, Debug)]
pub struct Profile {
    /// What it is like.
    pub name: &'static str,
    samples: Vec<f32>,
    local: Vec<f32>,
    global: Vec<f32>,
    minima: Vec<f32>,
    means: Vec<f32>,
    none: Vec<f32>,
}

impl Profile {
    fn new(name: &'static str, value: impl FnMut(u32) -> f32) -> Result<Self, MajorantError> {
        let raw: Vec<f32> = (0..SAMPLES).map(value).collect();
        let largest = raw.iter().fold(0.0_f32, |a, b| a.max(*b));
        let line: Vec<f32> = raw.iter().map(|v| v / largest).collect();
        let samples = line.repeat(4);
        let count = majorant_count(DIMS).ok_or(MajorantError::Dimensions(DIMS))?;
        let mut local = vec![0.0; count];
        fill_majorants(&samples, DIMS, &mut local)?;
        let most = local.iter().fold(0.0_f32, |a, b| a.max(*b));
        let (mut minima, mut means) = (vec![0.0; count], vec![0.0; count]);
        fill_controls(&samples, DIMS, &mut minima, &mut means)?;
        Ok(Self {
            name,
            samples,
            global: local_to_global(&local, most),
            local,
            minima,
            means,
            none: vec![0.0; count],
        })
    }

    /// The three of them.
    ///
    /// # Errors
    /// None that these formulas give.
    pub fn all() -> Result<[Self; 3], MajorantError> {
        let mut noise = PathStream::new(Key {
            seed: 29,
            pixel: 0,
            sample: 0,
        });
        let mut grain = move || -> f32 { noise.uniform(true) };
        let share = |i: u32| i as f32 / LENGTH;
        let smooth = |i: u32| {
            let x = share(i);
            0.05 + (-30.0 * (x - 0.4) * (x - 0.4)).exp() + 0.1 * (7.0 * x).sin().powi(2)
        };
        let rough = |i: u32| 0.55 * grain() + 0.35 * (1.0 + (40.0 * share(i)).sin()) * 0.5;
        let empty = |i: u32| {
            let hump = |centre: f32| (1.0 - ((share(i) - centre) / 0.05).powi(2)).max(0.0);
            hump(0.3).max(0.7 * hump(0.71))
        };
        Ok([
            Self::new("smooth", smooth)?,
            Self::new("rough", rough)?,
            Self::new("90 % empty", empty)?,
        ])
    }

    /// The exact optical depth: the samples' interpolant is linear between them.
    pub fn optical_depth(&self) -> f64 {
        let line = &self.samples[..SAMPLES as usize];
        let sum: f64 = line
            .windows(2)
            .map(|w| 0.5 * (f64::from(w[0]) + f64::from(w[1])))
            .sum();
        sum * f64::from(scale())
    }

    fn grid<'a>(
        &'a self,
        majorants: &'a [f32],
        minima: &'a [f32],
        means: &'a [f32],
    ) -> Option<Grid<'a>> {
        let bounds = MajorantGrid::new(&self.samples, DIMS, majorants).ok()?;
        let bounds: ControlledGrid<'_> = bounds.with_controls(minima, means).ok()?;
        Grid::new(bounds, IDENTITY, scale())
    }

    /// Under the bounds of its 32 blocks, and with their controls.
    pub fn local(&self) -> Option<Grid<'_>> {
        self.grid(&self.local, &self.minima, &self.means)
    }

    /// Under one bound for the whole ray, without controls.
    pub fn global(&self) -> Option<Grid<'_>> {
        self.grid(&self.global, &self.none, &self.none)
    }
}

/// One bound everywhere but in the rim, which is the first and the last entry along each axis.
fn local_to_global(local: &[f32], most: f32) -> Vec<f32> {
    let blocks = (SAMPLES as usize - 1).div_ceil(8) + 2;
    let inner = |i: usize| {
        let (x, y, z) = (i % blocks, i / blocks % 3, i / blocks / 3);
        0 < x && x < blocks - 1 && y == 1 && z == 1
    };
    (0..local.len())
        .map(|i| if inner(i) { most } else { 0.0 })
        .collect()
}

/// Extinction of a sample of one [1/length].
fn scale() -> f32 {
    MAJORANT_DEPTH / LENGTH
}
