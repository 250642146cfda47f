//! Rendering a world: the kernel that its needs pick, over tiles and passes.

use std::ops::Range;

use woodcock_core::medium::Controlled;
use woodcock_core::path::{
    Atlas, Counts, Geometry, OneGrid, OneHomogeneous, PathSample, RecordKind, Scene, Settings,
    ShadowEstimator, Tapped,
};
use woodcock_core::points::REPLICATE;
use woodcock_core::stream::Key;
use woodcock_packet::lanes::Lanes;
use woodcock_packet::trace::{self, PathRequest};

use crate::drive::Progress;
use crate::film::{Film, Landing, Place, Tile};
use crate::integrator::{self, Integrator};
use crate::world::{Feature, Location, World};

/// Eight lanes or one. Both give the same bits.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
pub enum Kernel {
    /// Eight lanes with refill
    #[default]
    Packet,
    /// One lane: the same code, the same bits
    Scalar,
}

/// How to trace paths through a world.
#[derive(Clone, Copy, Debug)]
pub struct Plan {
    /// Lanes.
    pub kernel: Kernel,
    /// Which paths are traced.
    pub integrator: Integrator,
    /// Bound on 1/r² of connections between subpaths, for the bidirectional integrators [1/length²].
    pub connection_bound: Option<f64>,
    /// Into how many paths a camera ray splits in media; at least one.
    pub split: u32,
    /// Whether further layers of the picture are wanted, which packets do not keep.
    pub layers: bool,
    /// Seed of all random numbers.
    pub seed: u64,
    /// Samples of a pixel whose points depend on each other, a power of two; one where all are independent. The samples `k N` to
    /// `(k + 1) N − 1` are one replicate of N.
    pub replicate: u32,
    /// Shadow rays and depth.
    pub settings: Settings,
}

impl Kernel {
    /// Its name on the command line and in reports.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Packet => "packet",
            Self::Scalar => "scalar",
        }
    }
}

impl Plan {
    /// The plan of a world under choices of the user.
    pub fn new(
        world: &World,
        kernel: Kernel,
        integrator: Integrator,
        seed: u64,
        shadow: ShadowEstimator,
        max_depth: Option<u32>,
    ) -> Self {
        let max_depth = max_depth.or(world.max_depth).unwrap_or(u32::MAX);
        let max_depth = match integrator {
            Integrator::Single => max_depth.min(1),
            _ => max_depth,
        };
        let settings = world.settings();
        let in_replicates =
            settings.points && matches!(integrator, Integrator::Path | Integrator::Single);
        Self {
            kernel,
            integrator,
            connection_bound: None,
            split: 1,
            layers: false,
            seed,
            replicate: if in_replicates { REPLICATE } else { 1 },
            settings: Settings {
                max_depth,
                shadow,
                ..settings
            },
        }
    }

    /// An empty film for what the plan brings of a world.
    pub fn film(&self, world: &World) -> Film {
        let mut film = Film::of_replicates(world.resolution, world.window, self.replicate);
        if self.layers {
            film.keep_layers();
        }
        film
    }

    /// Whether paths are their camera rays, whose transmittance is all that is to be known.
    fn absorbs(&self, world: &World) -> bool {
        !world.needs.runs(Feature::Scattering) && self.settings.shadow != ShadowEstimator::Delta
    }

    /// Whether the kernels of core and packet do it all; otherwise the scalar integrators do.
    pub fn in_packets(&self, world: &World) -> bool {
        let plain = world.is_plain() && !self.layers && self.split == 1;
        plain && matches!(self.integrator, Integrator::Path | Integrator::Single)
    }
}

impl Plan {
    /// Whether core's kernel of rooms does it all.
    pub fn in_room(&self, world: &World) -> bool {
        integrator::room::of(world, self).is_some()
    }
}

/// Something to be done with the kernel of a world: Rust has no generic closures.
trait Job {
    type Output;
    fn run<M, G, const CHROMATIC: bool, const RAYLEIGH: bool>(
        self,
        scene: &Scene<'_, M, G>,
    ) -> Self::Output
    where
        M: AnyMedium,
        G: Geometry<f32> + Geometry<Lanes> + Sync + ?Sized;
}

/// A medium for both widths.
trait AnyMedium: Tapped<f32> + Controlled<f32> + Tapped<Lanes> + Controlled<Lanes> + Sync {}
impl<M> AnyMedium for M where
    M: Tapped<f32> + Controlled<f32> + Tapped<Lanes> + Controlled<Lanes> + Sync
{
}

/// Geometry for both widths, behind one pointer: a call a ray, not a call a step.
trait AnyGeometry: Geometry<f32> + Geometry<Lanes> + Sync {}
impl<G: Geometry<f32> + Geometry<Lanes> + Sync> AnyGeometry for G {}

/// A ray that meets nothing.
#[derive(Debug)]
struct Nothing;

impl<R: woodcock_core::real::Real> Geometry<R> for Nothing {
    fn overlaps(&self) -> bool {
        false
    }
    fn stretch(
        &self,
        _: &woodcock_core::ray::Ray<R>,
        _: R::Word,
        _: R::Mask,
    ) -> woodcock_core::path::Stretch<R> {
        use woodcock_core::real::{Mask, Word};
        woodcock_core::path::Stretch {
            interval: woodcock_core::ray::Interval {
                t0: R::zero(),
                t1: R::zero(),
            },
            medium: R::Word::splat(0),
            found: R::Mask::splat(false),
        }
    }
}

/// The medium that a world's kernel is made for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Homogeneous,
    Grid,
    Several,
}

fn kind(world: &World) -> Kind {
    match world.media.as_slice() {
        _ if world.needs.runs(Feature::SeveralMedia) => Kind::Several,
        [medium] => match medium.record.kind {
            RecordKind::Homogeneous if !world.needs.runs(Feature::Tracking) => Kind::Homogeneous,
            RecordKind::Homogeneous => Kind::Several,
            RecordKind::Grid { .. } => Kind::Grid,
        },
        [] => Kind::Homogeneous,
        _ => Kind::Several,
    }
}

/// The name of the kernel that runs, for `explain` and the statistics.
pub fn kernel_name(world: &World, kernel: Kernel) -> String {
    if world.room.is_some() && !world.needs.runs(Feature::DetailedSurfaces) {
        return format!("{}: a room, met piece by piece", kernel.name());
    }
    if !world.is_plain() {
        return "scalar: surfaces, lights and media of all kinds".to_owned();
    }
    let medium = match kind(world) {
        Kind::Homogeneous => "homogeneous",
        Kind::Grid => "grid",
        Kind::Several => "several media",
    };
    let colour = if world.needs.runs(Feature::Chromatic) {
        "chromatic"
    } else {
        "grey"
    };
    format!("{}: {medium}, {colour}", kernel.name())
}

/// Runs a job with the kernel of a world.
fn with_kernel<J: Job>(world: &World, plan: &Plan, job: J) -> J::Output {
    let geometry: &dyn AnyGeometry = match &world.place {
        Location::Nowhere => &Nothing,
        Location::Convex(convex) => convex,
        Location::Boundaries(boundaries) => boundaries,
    };
    let chromatic = world.needs.runs(Feature::Chromatic);
    let rayleigh = world.needs.runs(Feature::Rayleigh);
    match kind(world) {
        Kind::Homogeneous => {
            let vacuum = || woodcock_core::path::MediumRecord {
                kind: RecordKind::Homogeneous,
                scale: 0.0,
                colour: [1.0; 3],
                albedo: [0.0; 3],
                g: 0.0,
                rayleigh: false,
            };
            let record = world.media.first().map_or_else(vacuum, |m| m.record);
            let medium = OneHomogeneous::new(&record);
            pick(world, plan, &medium, geometry, chromatic, rayleigh, job)
        }
        Kind::Grid => {
            let medium = OneGrid::new(
                &world.media[0].record,
                &world.tables.samples,
                &world.tables.majorants,
            );
            pick(world, plan, &medium, geometry, chromatic, rayleigh, job)
        }
        Kind::Several => {
            let medium = Atlas {
                records: &world.records,
                samples: &world.tables.samples,
                majorants: &world.tables.majorants,
            };
            // Rare enough that Rayleigh's branch need not be compiled away.
            pick(world, plan, &medium, geometry, chromatic, true, job)
        }
    }
}

fn pick<M, J: Job>(
    world: &World,
    plan: &Plan,
    medium: &M,
    geometry: &dyn AnyGeometry,
    chromatic: bool,
    rayleigh: bool,
    job: J,
) -> J::Output
where
    M: AnyMedium,
{
    let scene = Scene {
        medium,
        geometry,
        lights: world.lights(),
        camera: &world.camera,
        settings: plan.settings,
    };
    match (chromatic, rayleigh) {
        (false, false) => job.run::<_, _, false, false>(&scene),
        (false, true) => job.run::<_, _, false, true>(&scene),
        (true, _) => job.run::<_, _, true, true>(&scene),
    }
}

/// A pass over all tiles of a film.
struct Pass<'a> {
    world: &'a World,
    plan: &'a Plan,
    film: &'a mut Film,
    samples: Range<u32>,
    progress: &'a dyn Progress,
}

impl Job for Pass<'_> {
    type Output = Counts;
    fn run<M, G, const CHROMATIC: bool, const RAYLEIGH: bool>(
        self,
        scene: &Scene<'_, M, G>,
    ) -> Counts
    where
        M: AnyMedium,
        G: Geometry<f32> + Geometry<Lanes> + Sync + ?Sized,
    {
        let tile = |tile: &mut Tile| {
            let counts = trace_tile::<M, G, CHROMATIC, RAYLEIGH>(
                scene,
                self.world,
                self.plan,
                self.samples.clone(),
                tile,
            );
            self.progress.advance(counts.paths);
            counts
        };
        over_tiles(self.film, tile)
    }
}

/// What a function makes of each number below `count`, in their order, on as many threads as there are.
pub(crate) fn map_all<T: Send>(count: u32, make: impl Fn(u32) -> T + Send + Sync) -> Vec<T> {
    #[cfg(feature = "rayon")]
    {
        use rayon::prelude::*;
        (0..count).into_par_iter().map(make).collect()
    }
    #[cfg(not(feature = "rayon"))]
    (0..count).map(make).collect()
}

/// What a function makes of each tile of a film, in their order, on as many threads as there are.
pub(crate) fn map_tiles<T: Send>(film: &Film, make: impl Fn(&Tile) -> T + Send + Sync) -> Vec<T> {
    #[cfg(feature = "rayon")]
    {
        use rayon::prelude::*;
        film.tiles().par_iter().map(make).collect()
    }
    #[cfg(not(feature = "rayon"))]
    film.tiles().iter().map(make).collect()
}

/// Works on all tiles of a film, on as many threads as there are, and adds up what was counted.
pub(crate) fn over_tiles(
    film: &mut Film,
    tile: impl Fn(&mut Tile) -> Counts + Send + Sync,
) -> Counts {
    let sum = |mut a: Counts, b: Counts| {
        a.add(&b);
        a
    };
    let tiles = film.tiles_mut();
    #[cfg(feature = "rayon")]
    {
        use rayon::prelude::*;
        tiles.par_iter_mut().map(tile).reduce(Counts::default, sum)
    }
    #[cfg(not(feature = "rayon"))]
    tiles.iter_mut().map(tile).fold(Counts::default(), sum)
}

/// The path of a pixel's sample.
pub(crate) fn request(world: &World, seed: u64, x: u32, y: u32, sample: u32) -> PathRequest {
    let pixel = y.wrapping_mul(world.resolution[0]).wrapping_add(x);
    PathRequest {
        x,
        y,
        key: Key {
            seed,
            pixel,
            sample,
        },
    }
}

/// One path in scalar code.
fn trace_one<M, G, const CHROMATIC: bool, const RAYLEIGH: bool>(
    scene: &Scene<'_, M, G>,
    absorbs: bool,
    request: PathRequest,
    counts: &mut Counts,
) -> PathSample
where
    M: AnyMedium,
    G: Geometry<f32> + ?Sized,
{
    if absorbs {
        trace::absorb_scalar::<M, G, CHROMATIC>(scene, request, counts)
    } else {
        trace::trace_scalar::<M, G, CHROMATIC, RAYLEIGH>(scene, request, counts)
    }
}

fn trace_tile<M, G, const CHROMATIC: bool, const RAYLEIGH: bool>(
    scene: &Scene<'_, M, G>,
    world: &World,
    plan: &Plan,
    samples: Range<u32>,
    tile: &mut Tile,
) -> Counts
where
    M: AnyMedium,
    G: Geometry<f32> + Geometry<Lanes> + ?Sized,
{
    let window = tile.window();
    let [width, _] = window.size();
    let per_pixel = samples.len();
    let place = |index: usize| {
        let (pixel, sample) = (index / per_pixel, index % per_pixel);
        let (x, y) = (pixel as u32 % width, pixel as u32 / width);
        Place {
            x: window.x0 + x,
            y: window.y0 + y,
            sample: samples.start + sample as u32,
            samples: samples.clone(),
        }
    };
    let requests = (0..window.pixels() as usize * per_pixel).map(|index| {
        let Place { x, y, sample, .. } = place(index);
        request(world, plan.seed, x, y, sample)
    });
    let mut landing = Landing::default();
    let mut counts = Counts::default();
    let mut land = |index: usize, path| landing.land(tile, place(index), path);
    match (plan.kernel, plan.absorbs(world)) {
        (Kernel::Packet, false) => {
            counts = trace::trace::<M, G, CHROMATIC, RAYLEIGH>(scene, requests, land);
        }
        (Kernel::Packet, true) => {
            counts = trace::absorb::<M, G, CHROMATIC>(scene, requests, land);
        }
        (Kernel::Scalar, absorbs) => {
            for (index, request) in requests.enumerate() {
                let path =
                    trace_one::<M, G, CHROMATIC, RAYLEIGH>(scene, absorbs, request, &mut counts);
                land(index, path);
            }
        }
    }
    debug_assert!(landing.is_done(), "every path lands");
    counts
}

/// Adds the samples with these indices to every pixel of a film over the world's window.
///
/// The film is to be of the plan's replicates ([`Plan::film`]); where they are larger than one, `samples` should begin and end at their
/// multiples.
pub fn render_pass(
    world: &World,
    plan: &Plan,
    film: &mut Film,
    samples: Range<u32>,
    progress: &dyn Progress,
) -> Counts {
    debug_assert_eq!(film.replicate(), plan.replicate, "a film for this plan");
    if !plan.in_packets(world) {
        return integrator::render_pass(world, plan, film, samples, progress);
    }
    with_kernel(
        world,
        plan,
        Pass {
            world,
            plan,
            film,
            samples,
            progress,
        },
    )
}

/// One path, again.
struct Replay {
    absorbs: bool,
    request: PathRequest,
}

impl Job for Replay {
    type Output = (PathSample, Counts);
    fn run<M, G, const CHROMATIC: bool, const RAYLEIGH: bool>(
        self,
        scene: &Scene<'_, M, G>,
    ) -> Self::Output
    where
        M: AnyMedium,
        G: Geometry<f32> + Geometry<Lanes> + Sync + ?Sized,
    {
        let mut counts = Counts::default();
        let path =
            trace_one::<M, G, CHROMATIC, RAYLEIGH>(scene, self.absorbs, self.request, &mut counts);
        (path, counts)
    }
}

/// Traces one path in scalar code: what it brings, and what it met.
///
/// * `x`, `y`: a pixel of the whole picture. `sample`: which of its paths.
pub fn replay(world: &World, plan: &Plan, x: u32, y: u32, sample: u32) -> (PathSample, Counts) {
    if !plan.in_packets(world) {
        return integrator::replay(world, plan, [x, y], sample);
    }
    with_kernel(
        world,
        plan,
        Replay {
            absorbs: plan.absorbs(world),
            request: request(world, plan.seed, x, y, sample),
        },
    )
}
