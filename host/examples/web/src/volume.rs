//! The volume that the page shows.

use std::fmt;
use std::ops::Range;

use glam::{DAffine3, DVec3};
use woodcock_core::majorant::{BLOCK, MajorantGrid, fill_majorants, majorant_count};
use woodcock_core::medium::Affine;
use woodcock_core::path::{
    Convex, Counts, MediumRecord, OneGrid, OneHomogeneous, RecordKind, Scene, Settings, Tapped,
};
use woodcock_core::stream::Key;
use woodcock_packet::lanes::Lanes;
use woodcock_packet::trace::{self, PathLanes, PathRequest};
use woodcock_volume::{CellBox, Density, Limits, rows, vdb};

use crate::cumulus::{self, cumulus};
use crate::view::{Controls, MOST_DENSITY};

/// Voxels of the cloud along x.
const CUMULUS: usize = 96;
/// What reading a file may take \[bytes\]: a page has four gibibytes at most.
const LIMITS: Limits = Limits {
    max_memory: 1 << 30,
};

const EMPTY: &str = "it is empty: no voxel differs from zero";

/// What is in front of the camera, about the origin.
#[derive(Debug)]
pub(crate) enum Volume {
    /// A ball of fog with radius one, everywhere the same.
    Fog,
    /// A grid whose longest side goes from −1 to 1.
    Grid(Box<Placed>),
}

/// Where a grid is from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Source {
    /// The cloud that the page begins with.
    Cumulus,
    /// A file of this kind, as scenes call it.
    File(&'static str),
}

/// A grid and its place.
#[derive(Debug)]
pub(crate) struct Placed {
    pub(crate) density: Density,
    pub(crate) source: Source,
    /// The grid's own space to the page's.
    pub(crate) to_page: DAffine3,
    majorants: Vec<f32>,
    peak: f32,
    world_to_grid: Affine,
    place: Convex,
    remarks: String,
}

impl Volume {
    pub(crate) fn cumulus() -> Result<Self, String> {
        let (resolution, values) = cumulus(CUMULUS);
        let cells = CellBox {
            resolution,
            p0: DVec3::ZERO,
            p1: DVec3::from_array(cumulus::SIZE.map(f64::from)),
        };
        let density = cells.samples(&LIMITS, false, |index| {
            Ok(index.and_then(|i| values.get(i)).copied().unwrap_or(0.0))
        })?;
        Placed::new(density, String::new(), Source::Cumulus)
    }

    pub(crate) fn of_file(bytes: &[u8]) -> Result<Self, String> {
        let mut remarks = String::new();
        let read = Density::of_file(bytes, &LIMITS, |remark| {
            remarks.push_str("; ");
            remarks.push_str(&remark);
        });
        // What the command line can do about it, visitors cannot.
        let told = |why: String| why.replace("; raise --max-memory or use a smaller volume", "");
        let density = read.map_err(told)?.ok_or(EMPTY)?;
        let kind = if bytes.starts_with(&vdb::MAGIC) {
            "openvdb"
        } else {
            "vol"
        };
        Placed::new(density, remarks, Source::File(kind))
    }

    /// Traces one path through each pixel of some rows.
    pub(crate) fn trace(
        &self,
        controls: &Controls,
        rows: Range<u32>,
        sample: u32,
        pixels: &mut [[f32; 3]],
    ) {
        let settings = controls.settings();
        let mut job = Job {
            controls,
            settings,
            rows,
            sample,
            pixels,
        };
        match self {
            Self::Fog => {
                let record = controls.record(RecordKind::Homogeneous, controls.density);
                // What passes is scored as it goes.
                job.settings.forced = true;
                job.run(&OneHomogeneous::new(&record), &BALL);
            }
            Self::Grid(grid) => {
                let record = grid.record(controls);
                let medium = OneGrid::new(&record, &grid.density.samples, &grid.majorants);
                job.run(&medium.within(&grid.place), &grid.place);
            }
        }
    }
}

/// The unit sphere.
const BALL: Convex = Convex::Sphere {
    to_local: [
        [1.0, 0.0, 0.0, 0.0],
        [0.0, 1.0, 0.0, 0.0],
        [0.0, 0.0, 1.0, 0.0],
    ],
};

impl Placed {
    #[expect(
        clippy::new_ret_no_self,
        reason = "one kind of volume, made from what is read"
    )]
    fn new(density: Density, remarks: String, source: Source) -> Result<Volume, String> {
        let peak = density.samples.iter().copied().fold(0.0, f32::max);
        if peak == 0.0 {
            return Err(EMPTY.to_owned());
        }
        if !(MOST_DENSITY / peak).is_finite() {
            return Err(format!("its values, up to {peak:e}, are too small"));
        }
        let [low, high] = density.matter;
        let corners = [0, 1, 2, 3, 4, 5, 6, 7].map(|bits: u32| {
            let at = |axis: usize| [low, high][(bits >> axis & 1) as usize][axis];
            let corner = DVec3::new(at(0), at(1), at(2));
            density.to_volume.transform_point3(corner)
        });
        let [first, rest @ ..] = corners;
        let least = rest.iter().fold(first, |a, b| a.min(*b));
        let most = rest.iter().fold(first, |a, b| a.max(*b));
        let scale = 2.0 / (most - least).max_element();
        let to_page = DAffine3::from_scale(DVec3::splat(scale))
            * DAffine3::from_translation(-0.5 * (least + most));
        let to_grid = (to_page * density.to_volume).inverse();
        let to_local = DAffine3::from_translation(-low) * to_grid;
        let (world_to_grid, to_local) = (rows(&to_grid), rows(&to_local));
        let mut entries = world_to_grid.iter().chain(&to_local).flatten();
        if !entries.all(|x| x.is_finite()) {
            return Err("its transform has no inverse in single precision".to_owned());
        }
        let count = majorant_count(density.dims).ok_or("it has too many voxels")?;
        let mut majorants = vec![0.0; count];
        fill_majorants(&density.samples, density.dims, &mut majorants)
            .and_then(|()| MajorantGrid::new(&density.samples, density.dims, &majorants))
            .map_err(|error| error.to_string())?;
        Ok(Volume::Grid(Box::new(Self {
            peak,
            place: Convex::Box {
                to_local,
                size: (high - low).as_vec3().to_array(),
            },
            world_to_grid,
            majorants,
            to_page,
            density,
            remarks,
            source,
        })))
    }

    /// The medium, whose densest sample has the density of the controls.
    pub(crate) fn record(&self, controls: &Controls) -> MediumRecord {
        let kind = RecordKind::Grid {
            world_to_grid: self.world_to_grid,
            dims: self.density.dims,
            samples: 0,
            majorants: 0,
            edge: BLOCK,
        };
        controls.record(kind, controls.density / self.peak)
    }
}

/// Rows of pixels to trace paths through.
struct Job<'a> {
    controls: &'a Controls,
    settings: Settings,
    rows: Range<u32>,
    sample: u32,
    pixels: &'a mut [[f32; 3]],
}

impl Job<'_> {
    fn run<M>(self, medium: &M, place: &Convex)
    where
        M: Tapped<f32> + Tapped<Lanes> + Tapped<PathLanes>,
    {
        let Self {
            controls,
            settings,
            rows,
            sample,
            pixels,
        } = self;
        let sun = controls.distant();
        let scene = Scene {
            medium,
            geometry: place,
            lights: controls.lights(sun.as_slice()),
            camera: &controls.camera(),
            settings,
        };
        let width = controls.width;
        let requests = rows.flat_map(|y| (0..width).map(move |x| (x, y)));
        let requests = requests.map(|(x, y)| PathRequest {
            x,
            y,
            key: Key {
                seed: 0,
                pixel: y * width + x,
                sample,
            },
        });
        if controls.packets != 0 {
            trace::trace::<_, _, false, false>(&scene, requests, |index, path| {
                if let Some(pixel) = pixels.get_mut(index) {
                    *pixel = path.radiance;
                }
            });
        } else {
            let mut counts = Counts::default();
            for (pixel, request) in pixels.iter_mut().zip(requests) {
                let path = trace::trace_scalar::<_, _, false, false>(&scene, request, &mut counts);
                *pixel = path.radiance;
            }
        }
    }
}

impl fmt::Display for Volume {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Fog => write!(f, "everywhere the same"),
            Self::Grid(grid) => {
                let [x, y, z] = grid.density.dims;
                write!(f, "{x} × {y} × {z} voxels{}", grid.remarks)
            }
        }
    }
}
