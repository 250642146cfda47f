//! Rendering a world: the kernel that its needs pick, over tiles and passes.

use std::ops::Range;

use woodcock_core::path::{Counts, PathSample, Settings, ShadowEstimator};
use woodcock_core::points::REPLICATE;
use woodcock_core::stream::Key;
use woodcock_packet::trace::PathRequest;

use crate::drive::Progress;
use crate::film::{Allotment, Film, Places, Tile};
use crate::integrator::{self, Integrator};
use crate::kernel;
pub use crate::kernel::kernel_name;
use crate::world::{Feature, World};

/// Many lanes or one. Both give the same bits.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
pub enum Kernel {
    /// Sixteen lanes with refill
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
    pub(crate) fn absorbs(&self, world: &World) -> bool {
        !world.needs.runs(Feature::Scattering) && self.settings.shadow == ShadowEstimator::ByNeed
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

/// Adds to a tile what `trace` makes of the paths of its places.
///
/// * `trace(requests, paths)` writes the sample of each request to its place.
pub(crate) fn trace_tile(
    world: &World,
    plan: &Plan,
    places: &Places,
    tile: &mut Tile,
    trace: impl FnOnce(Requests<'_>, &mut [PathSample]) -> Counts,
) -> Counts {
    let requests = Requests {
        world,
        seed: plan.seed,
        places,
    };
    let mut paths = vec![PathSample::default(); places.len()];
    let counts = trace(requests, &mut paths);
    let mut rest = paths.as_slice();
    for (x, y, samples) in places.pixels() {
        let mut first = samples.start;
        while first < samples.end {
            let end = (first - first % plan.replicate).saturating_add(plan.replicate);
            let (replicate, others) = rest.split_at((end.min(samples.end) - first) as usize);
            tile.add_replicate(x, y, first, replicate);
            rest = others;
            first = end;
        }
    }
    counts
}

/// The paths that a tile asks for in a pass.
#[derive(Clone, Copy)]
pub(crate) struct Requests<'a> {
    world: &'a World,
    seed: u64,
    places: &'a Places,
}

impl Requests<'_> {
    /// The same with other random numbers.
    pub(crate) fn seeded(self, seed: u64) -> Self {
        Self { seed, ..self }
    }

    /// Pixel by pixel, each pixel's samples in order.
    pub(crate) fn iter(self) -> impl Iterator<Item = PathRequest> {
        let mut pixels = self.places.pixels();
        let (mut x, mut y, mut samples) = (0, 0, 0..0);
        std::iter::from_fn(move || {
            loop {
                if let Some(sample) = samples.next() {
                    return Some(request(self.world, self.seed, x, y, sample));
                }
                (x, y, samples) = pixels.next()?;
            }
        })
    }
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
    render_allotted(world, plan, film, samples, None, progress)
}

/// The same, of each pixel only those samples that an allotment grants.
///
/// Where light lands in other pixels (`bdpt`, `mlt`) all pixels get the same samples: an allotment is to be uniform.
pub fn render_allotted(
    world: &World,
    plan: &Plan,
    film: &mut Film,
    samples: Range<u32>,
    allotment: Option<&Allotment>,
    progress: &dyn Progress,
) -> Counts {
    debug_assert_eq!(film.replicate(), plan.replicate, "a film for this plan");
    if !plan.in_packets(world) {
        return integrator::render_pass(world, plan, film, samples, allotment, progress);
    }
    let tile = |tile: &mut Tile| {
        let places = Places::new(tile.window(), samples.clone(), allotment);
        let counts = trace_tile(world, plan, &places, tile, |requests, paths| {
            kernel::trace(world, plan, requests, paths)
        });
        progress.advance(places.len() as u64);
        counts
    };
    over_tiles(film, tile)
}

/// Traces one path in scalar code: what it brings, and what it met.
///
/// * `x`, `y`: a pixel of the whole picture. `sample`: which of its paths.
pub fn replay(world: &World, plan: &Plan, x: u32, y: u32, sample: u32) -> (PathSample, Counts) {
    if !plan.in_packets(world) {
        return integrator::replay(world, plan, [x, y], sample);
    }
    kernel::replay(world, plan, request(world, plan.seed, x, y, sample))
}
