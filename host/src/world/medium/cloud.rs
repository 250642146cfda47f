//! pbrt's cloud: noise that thins out with height, over a layer that is full.
//!
//! ```text
//! p' = f p + Σᵢ vᵢ D(lᵢ p'),      v = 0.05 w, 0.025 w;  l = 10, 19.9     (torn wisps)
//! n  = Σᵢ 2⁻ⁱ N(1.99ⁱ⁻¹ p'),       i = 1 … 5
//! d  = [ [4.5 ρ (1 − y) n] + 2 max(0, ½ − y) ],   [x] = min(max(x, 0), 1)
//! ```
//!
//! with Perlin's noise N and its forward differences D. All of it in the medium's own space: the box only cuts out
//! what is seen. Since |N| is bounded, so is d at a height; layers of the box get that bound, raised beyond rounding,
//! and are walked as the blocks of a grid are. Source: [Pharr, Jakob, Humphreys 2023], `CloudMedium`.

use glam::{DAffine3, DVec3};
use woodcock_core::enclosure::Enclosure;
use woodcock_core::majorant::{BLOCK, CellError, Cells, GridWalk, Segment};
use woodcock_core::medium::Medium;
use woodcock_core::path::{MediumRecord, OneGrid, Optics, PathMedium};
use woodcock_core::ray::Ray;
use woodcock_core::real::Word32;
use woodcock_core::stream::Stream;

use super::noise::{BOUND, noise, slope};
use crate::scene::Cloud;

/// Layers of the box, each with its bound.
const LAYERS: u32 = 64;
/// Octaves of the noise; the first has weight 1/2, each further one half of the one before.
const OCTAVES: i32 = 5;
/// Sum of the octaves' weights.
const WEIGHTS: f64 = 1.0 - 1.0 / 32.0;
/// Frequency of an octave by that of the one before.
const LACUNARITY: f64 = 1.99;
/// Density in the middle of the height by the noise.
const CONTRAST: f64 = 4.5;

/// A cloud's density as a function of place.
#[derive(Clone, Copy, Debug)]
pub struct CloudDensity {
    cloud: Cloud,
    world_to_medium: DAffine3,
}

impl CloudDensity {
    /// * `world_to_medium`: from the rendered world.
    pub(super) fn new(cloud: Cloud, world_to_medium: DAffine3) -> Self {
        Self {
            cloud,
            world_to_medium,
        }
    }

    /// The density in [0, 1] at a place of the rendered world; beyond the box, that of the nearest place in it.
    pub fn value(&self, place: DVec3) -> f64 {
        self.within(self.world_to_medium.transform_point3(place))
    }

    /// The density at a place of the medium's space.
    fn within(&self, p: DVec3) -> f64 {
        let Cloud {
            density,
            wispiness,
            frequency,
            p0,
            p1,
        } = self.cloud;
        let p = p.max(p0).min(p1);
        let mut place = p * frequency;
        if wispiness > 0.0 {
            let (mut reach, mut scale) = (0.05 * wispiness, 10.0);
            for _ in 0..2 {
                place += slope(place * scale) * reach;
                reach *= 0.5;
                scale *= LACUNARITY;
            }
        }
        let (mut sum, mut weight, mut scale) = (0.0, 0.5, 1.0);
        for _ in 0..OCTAVES {
            sum += weight * noise(place * scale);
            weight *= 0.5;
            scale *= LACUNARITY;
        }
        let thinned = ((1.0 - p.y) * CONTRAST * density * sum).clamp(0.0, 1.0);
        (thinned + 2.0 * (0.5 - p.y).max(0.0)).clamp(0.0, 1.0)
    }

    /// A bound on the density between two heights of the medium's space.
    fn bound(&self, low: f64, high: f64) -> f64 {
        let reach = (1.0 - low).abs().max((1.0 - high).abs());
        let thinned = (reach * CONTRAST * self.cloud.density * WEIGHTS * BOUND).min(1.0);
        let bound = thinned + 2.0 * (0.5 - low).max(0.0);
        // As those of grids: more than rounding. One is exact.
        (bound * (1.0 + 1.0 / 1_048_576.0)).min(1.0)
    }

    /// The dimensions of a grid whose blocks are the layers.
    pub(super) const DIMS: [u32; 3] = [BLOCK + 1, LAYERS * BLOCK + 1, BLOCK + 1];

    /// Grid units in the medium's space: the box is `DIMS − 1` units wide.
    pub(super) fn grid_to_medium(&self) -> DAffine3 {
        let units = DVec3::from_array(Self::DIMS.map(|n| f64::from(n - 1)));
        let unit = (self.cloud.p1 - self.cloud.p0) / units;
        DAffine3::from_translation(self.cloud.p0) * DAffine3::from_scale(unit)
    }

    /// The bounds of the layers, in the layout of a grid's, rim included.
    ///
    /// Each holds a sixty-fourth of a layer beyond its faces, too: places known in other precision than the walk's are
    /// within it.
    ///
    /// # Errors
    /// A box that single precision cannot cut.
    pub(super) fn majorants(&self) -> Result<Vec<f32>, CellError> {
        let counts = Self::DIMS.map(|n| (n - 1) / BLOCK);
        let units = Self::DIMS.map(|n| (n - 1) as f32);
        let cells = Cells::new([0.0; 3], units, counts)?;
        let to_medium = self.grid_to_medium();
        let margin = f64::from(BLOCK) / 64.0;
        let extension = |[_, y, _]: [Enclosure; 3]| {
            let height = |units: f64| to_medium.transform_point3(DVec3::new(0.0, units, 0.0)).y;
            let low = height(f64::from(y.low()) - margin);
            let high = height(f64::from(y.high()) + margin);
            let bound = self.bound(low, high);
            let rounded = bound as f32;
            let above = f64::from(rounded) < bound;
            Enclosure::new(0.0, if above { rounded.next_up() } else { rounded })
        };
        let mut majorants = vec![0.0; cells.majorant_count()];
        cells.fill_majorants(extension, &mut majorants)?;
        Ok(majorants)
    }
}

/// A cloud that rays of the rendered world walk through, as scalar code asks for it.
#[derive(Clone, Copy, Debug)]
pub struct CloudField<'a> {
    layers: OneGrid<'a>,
    density: &'a CloudDensity,
    to_medium: DAffine3,
    scale: f32,
}

impl<'a> CloudField<'a> {
    /// * `record`: the cloud's, whose bounds lie in the table `majorants`.
    pub(super) fn new(
        record: &MediumRecord,
        density: &'a CloudDensity,
        majorants: &'a [f32],
    ) -> Self {
        Self {
            layers: OneGrid::new(record, &[], majorants),
            density,
            to_medium: density.grid_to_medium(),
            scale: record.scale,
        }
    }
}

impl Medium<f32> for CloudField<'_> {
    type Walk = GridWalk<f32>;
    const ONE_SEGMENT: bool = false;
    const TIGHT: bool = false;

    fn idle(&self) -> GridWalk<f32> {
        GridWalk::idle()
    }
    fn begin(&self, walk: &mut GridWalk<f32>, ray: &Ray<f32>, active: bool) {
        self.layers.begin(walk, ray, active);
    }
    fn segment(&self, walk: &GridWalk<f32>) -> Segment<f32> {
        walk.segment()
    }
    fn next_segment(&self, walk: &mut GridWalk<f32>, active: bool) {
        Medium::<f32>::next_segment(&self.layers, walk, active);
    }
    fn sigma_t(&self, walk: &GridWalk<f32>, t: f32, _: &mut impl Stream<f32>, _: bool) -> f32 {
        let units = walk.place(t);
        let units = DVec3::new(f64::from(units.x), f64::from(units.y), f64::from(units.z));
        let place = self.to_medium.transform_point3(units);
        self.density.within(place) as f32 * self.scale
    }
}

impl PathMedium<f32> for CloudField<'_> {
    fn enter(&self, walk: &mut GridWalk<f32>, ray: &Ray<f32>, id: Word32, active: bool) {
        self.layers.enter(walk, ray, id, active);
    }
    fn optics(&self, walk: &GridWalk<f32>) -> Optics<f32> {
        self.layers.optics(walk)
    }
}
