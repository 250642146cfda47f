//! Small scenes in code: every kind of medium, geometry and light that a path can meet, none of it from a file.
//!
//! They exist to be traced twice, by scalar code and by packets, and compared bit by bit; so they are chosen to reach
//! every branch of the state machine, not to look good.

use crate::grids::TestGrid;
use woodcock_core::camera::{Camera, Projection};
use woodcock_core::light::{Distant, Lights};
use woodcock_core::majorant::BLOCK;
use woodcock_core::medium::Affine;
use woodcock_core::path::{
    Atlas, Convex, Counts, Field, Geometry, MediumRecord, OneGrid, OneHomogeneous, PathSample,
    Radiance, RecordKind, Scene, Settings, ShadowEstimator, Shining, Source, Stretch, Tapped,
};
use woodcock_core::ray::{Interval, Ray};
use woodcock_core::real::{Mask, Real, Word};
use woodcock_packet::both::Wide;
use woodcock_packet::lanes::Lanes;
use woodcock_packet::trace::{PathRequest, trace, trace_scalar};

/// Pixels along each side of a film.
pub const SIDE: u32 = 16;

/// A scene, however it is traced. Packets and scalar code are stamped out here and nowhere else: they take long to compile.
pub trait Traced {
    /// Traces requests in packets.
    ///
    /// * `land`: is given the place of each request and what came of it.
    fn in_packets(
        &self,
        requests: &[PathRequest],
        land: &mut dyn FnMut(usize, PathSample),
    ) -> Counts;

    /// Traces one path in scalar code.
    fn in_scalars(&self, request: PathRequest, counts: &mut Counts) -> PathSample;

    /// The radiance of its sky.
    fn environment(&self) -> [f32; 3];
}

/// A scene, and what it needs of the tracer.
struct Needing<'a, M, G, const CHROMATIC: bool, const ANY_RAYLEIGH: bool>(&'a Scene<'a, M, G>);

impl<M, G, const CHROMATIC: bool, const ANY_RAYLEIGH: bool> Traced
    for Needing<'_, M, G, CHROMATIC, ANY_RAYLEIGH>
where
    M: Tapped<f32> + Tapped<Lanes> + Tapped<Wide>,
    G: Geometry<f32> + Geometry<Lanes> + Geometry<Wide>,
{
    fn in_packets(
        &self,
        requests: &[PathRequest],
        land: &mut dyn FnMut(usize, PathSample),
    ) -> Counts {
        trace::<M, G, CHROMATIC, ANY_RAYLEIGH>(self.0, requests.iter().copied(), land)
    }

    fn in_scalars(&self, request: PathRequest, counts: &mut Counts) -> PathSample {
        trace_scalar::<M, G, CHROMATIC, ANY_RAYLEIGH>(self.0, request, counts)
    }

    fn environment(&self) -> [f32; 3] {
        self.0.lights.environment
    }
}

/// Shapes that may overlap, each with a medium of its own number.
#[derive(Clone, Debug)]
pub struct Several(pub Vec<(Convex, u32)>);

impl<R: Real> Geometry<R> for Several {
    fn overlaps(&self) -> bool {
        true
    }

    fn stretch(&self, ray: &Ray<R>, cursor: R::Word, active: R::Mask) -> Stretch<R> {
        let mut stretch = Stretch {
            interval: Interval {
                t0: R::zero(),
                t1: R::zero(),
            },
            medium: R::Word::splat(0),
            found: R::Mask::splat(false),
        };
        for (number, (shape, medium)) in (0..).zip(&self.0) {
            let here = cursor.eq(R::Word::splat(number)) & active;
            let interval = shape.clip(ray);
            stretch.interval.t0 = R::select(here, interval.t0, stretch.interval.t0);
            stretch.interval.t1 = R::select(here, interval.t1, stretch.interval.t1);
            stretch.medium = R::Word::select(here, R::Word::splat(*medium), stretch.medium);
            stretch.found = stretch.found | here;
        }
        stretch
    }
}

fn fog(sigma_t: f32, colour: [f32; 3], albedo: [f32; 3], g: f32, rayleigh: bool) -> MediumRecord {
    MediumRecord {
        kind: RecordKind::Homogeneous,
        scale: sigma_t,
        colour,
        albedo,
        g,
        rayleigh,
    }
}

/// Grid space of a grid that fills the box of half edge `half` about `centre`.
fn fitted(dims: [u32; 3], centre: [f32; 3], half: f32) -> Affine {
    let mut map = [[0.0; 4]; 3];
    for axis in 0..3 {
        let scale = (dims[axis] - 1) as f32 / (2.0 * half);
        map[axis][axis] = scale;
        map[axis][3] = (half - centre[axis]) * scale;
    }
    map
}

fn on_grid(
    dims: [u32; 3],
    world_to_grid: Affine,
    tables: [u32; 2],
    medium: MediumRecord,
) -> MediumRecord {
    let [samples, majorants] = tables;
    let kind = RecordKind::Grid {
        world_to_grid,
        dims,
        samples,
        majorants,
        edge: BLOCK,
    };
    MediumRecord { kind, ..medium }
}

fn boxed(dims: [u32; 3], to_local: Affine) -> Convex {
    Convex::Box {
        to_local,
        size: dims.map(|n| (n - 1) as f32),
    }
}

fn ball(centre: [f32; 3], radius: f32) -> Convex {
    let mut to_local = [[0.0; 4]; 3];
    for axis in 0..3 {
        to_local[axis][axis] = 1.0 / radius;
        to_local[axis][3] = -centre[axis] / radius;
    }
    Convex::Sphere { to_local }
}

fn camera(projection: Projection, lens_radius: f32) -> Camera {
    let half = match projection {
        Projection::Perspective => 0.55,
        Projection::Orthographic => 1.1,
    };
    let step = 2.0 * half / SIDE as f32;
    Camera {
        projection,
        screen: [[-half, step], [half, -step]],
        camera_to_world: [
            [1.0, 0.0, 0.0, 0.1],
            [0.0, 1.0, 0.0, -0.05],
            [0.0, 0.0, 1.0, -2.5],
        ],
        lens_radius,
        focal_distance: 2.5,
    }
}

/// Grey, and colours that differ.
const GREY: [f32; 3] = [1.0; 3];
const REDDISH: [f32; 3] = [1.0, 0.55, 0.2];
const WHITE: [f32; 3] = [1.0; 3];
const SILVER: [f32; 3] = [0.95, 0.9, 0.8];

/// Visits every scene.
///
/// # Panics
/// Where core refuses what the scenes are made of.
pub fn each(visit: &mut dyn FnMut(&str, &dyn Traced)) {
    let sun = Distant::new([0.3, 0.8, -0.5], [3.0, 2.5, 2.0]).expect("a valid light");
    let moon = Distant::new([-1.0, 0.1, 0.2], [0.1, 0.2, 0.4]).expect("a valid light");
    let sky = Lights {
        distant: &[],
        environment: [0.5, 0.7, 1.0],
        sample_environment: false,
    };
    let both = [sun, moon];
    let day = Lights {
        distant: &both,
        sample_environment: true,
        ..sky
    };
    let noon = Lights {
        distant: &both[..1],
        environment: [0.0; 3],
        ..sky
    };
    let pinhole = camera(Projection::Perspective, 0.0);
    let lens = camera(Projection::Perspective, 0.2);
    let parallel = camera(Projection::Orthographic, 0.0);
    let mut aside = parallel;
    aside.camera_to_world[0][3] = 0.7;
    let settings = Settings::default();
    let by_delta = Settings {
        shadow: ShadowEstimator::Delta,
        ..settings
    };
    let bright = Settings {
        bright: 0.02,
        ..settings
    };
    let short = Settings {
        max_depth: 3,
        ..settings
    };

    let medium = OneHomogeneous::new(&fog(4.0, GREY, WHITE, 0.6, false));
    let geometry = ball([0.0; 3], 1.0);
    let scene = Scene {
        medium: &medium,
        geometry: &geometry,
        lights: sky,
        camera: &pinhole,
        settings,
    };
    visit("white furnace ball", &Needing::<_, _, false, false>(&scene));
    let scene = Scene {
        lights: day,
        camera: &lens,
        ..scene
    };
    visit(
        "ball by day, through a lens",
        &Needing::<_, _, false, false>(&scene),
    );

    let medium = OneHomogeneous::new(&fog(3.0, REDDISH, SILVER, 0.0, true));
    let geometry = boxed([3, 3, 3], fitted([3; 3], [0.1, 0.0, 0.2], 0.8));
    let scene = Scene {
        medium: &medium,
        geometry: &geometry,
        lights: day,
        camera: &parallel,
        settings,
    };
    visit(
        "coloured Rayleigh box",
        &Needing::<_, _, true, true>(&scene),
    );

    // Light has infinitely far to come: black, and finite all the same.
    let medium = OneHomogeneous::new(&fog(0.4, GREY, SILVER, -0.3, false));
    let scene = Scene {
        medium: &medium,
        geometry: &Convex::Everywhere,
        lights: sky,
        camera: &pinhole,
        settings: short,
    };
    visit("fog without an end", &Needing::<_, _, false, false>(&scene));

    let cloud = TestGrid::cloud([33, 26, 25], 95);
    let to_grid = fitted(cloud.dims, [0.0; 3], 1.0);
    let grey = on_grid(
        cloud.dims,
        to_grid,
        [0, 0],
        fog(40.0, GREY, SILVER, 0.85, false),
    );
    let medium = OneGrid::new(&grey, &cloud.samples, &cloud.majorants);
    let geometry = boxed(cloud.dims, to_grid);
    let scene = Scene {
        medium: &medium,
        geometry: &geometry,
        lights: noon,
        camera: &pinhole,
        settings,
    };
    visit("cloud at noon", &Needing::<_, _, false, false>(&scene));
    let alone = medium.within(&geometry);
    let scene = Scene {
        medium: &alone,
        ..scene
    };
    visit(
        "cloud at noon, known to be alone",
        &Needing::<_, _, false, false>(&scene),
    );
    // Whose edges many rays miss.
    let scene = Scene {
        camera: &aside,
        ..scene
    };
    visit(
        "cloud alone, seen from aside",
        &Needing::<_, _, false, false>(&scene),
    );
    let scene = Scene {
        camera: &pinhole,
        ..scene
    };
    let scene = Scene {
        settings: bright,
        ..scene
    };
    visit(
        "cloud alone, bright shadow rays estimated several times",
        &Needing::<_, _, false, false>(&scene),
    );

    let scene = Scene {
        medium: &medium,
        lights: day,
        settings: by_delta,
        ..scene
    };
    visit(
        "cloud by day, shadows by delta tracking",
        &Needing::<_, _, false, false>(&scene),
    );
    let coloured = MediumRecord {
        colour: REDDISH,
        ..grey
    };
    let medium = OneGrid::new(&coloured, &cloud.samples, &cloud.majorants);
    let scene = Scene {
        medium: &medium,
        geometry: &geometry,
        lights: day,
        camera: &lens,
        settings,
    };
    visit("coloured cloud", &Needing::<_, _, true, false>(&scene));
    let scene = Scene {
        settings: by_delta,
        ..scene
    };
    visit(
        "coloured cloud, shadows by delta tracking",
        &Needing::<_, _, true, false>(&scene),
    );

    // A cloud that glows, brighter on one side: combs find what its camera rays see.
    let light: Vec<f32> = (0..8).flat_map(|i| [0.2 + (i % 2) as f32; 3]).collect();
    let source = Source {
        absorbed: [0.3, 0.2, 0.1],
        factor: None,
        radiance: Radiance::Field(Field {
            values: &light,
            dims: [2; 3],
            world_to_grid: fitted([2; 3], [0.0; 3], 1.0),
        }),
    };
    let burning = MediumRecord {
        scale: 12.0,
        ..grey
    };
    let placed = OneGrid::new(&burning, &cloud.samples, &cloud.majorants);
    let combed = Settings {
        combed: true,
        ..settings
    };
    for (name, settings) in [("combed", combed), ("flown", settings)] {
        for (place, medium) in [
            ("", placed),
            (", known to be alone", placed.within(&geometry)),
        ] {
            let scene = Scene {
                medium: &Shining { medium, source },
                geometry: &geometry,
                lights: sky,
                camera: &pinhole,
                settings,
            };
            let name = format!("glowing cloud, {name}{place}");
            visit(&name, &Needing::<_, _, false, true>(&scene));
        }
    }

    // Two grids in common tables, and two fogs; shapes that overlap in pairs and all together.
    let rough = TestGrid::random([9, 10, 17], 96, 0.5);
    let to_rough = fitted(rough.dims, [0.3, -0.2, 0.1], 0.6);
    let samples = [&cloud.samples[..], &rough.samples].concat();
    let majorants = [&cloud.majorants[..], &rough.majorants].concat();
    let tables = [cloud.samples.len() as u32, cloud.majorants.len() as u32];
    let records = [
        fog(1.5, GREY, WHITE, 0.2, false),
        coloured,
        on_grid(
            rough.dims,
            to_rough,
            tables,
            fog(3.0, GREY, SILVER, -0.5, false),
        ),
        fog(0.8, [0.1, 0.4, 1.0], WHITE, 0.0, true),
    ];
    let words: Vec<u32> = records.iter().flat_map(MediumRecord::to_words).collect();
    let atlas = Atlas {
        records: &words,
        samples: &samples,
        majorants: &majorants,
    };
    let geometry = Several(vec![
        (boxed(cloud.dims, to_grid), 1),
        (ball([0.5, 0.4, 0.0], 0.5), 0),
        (boxed(rough.dims, to_rough), 2),
        (ball([-0.4, 0.0, -0.2], 0.9), 3),
        (ball([9.0, 0.0, 0.0], 0.1), 0),
    ]);
    let scene = Scene {
        medium: &atlas,
        geometry: &geometry,
        lights: day,
        camera: &pinhole,
        settings,
    };
    visit(
        "four media that overlap",
        &Needing::<_, _, true, true>(&scene),
    );
    let scene = Scene {
        settings: bright,
        ..scene
    };
    visit(
        "four media that overlap, shadow rays estimated several times",
        &Needing::<_, _, true, true>(&scene),
    );
}
