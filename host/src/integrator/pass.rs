//! Passes of the scalar integrators over the film.

use std::ops::Range;

use woodcock_core::path::{Counts, PathSample};
use woodcock_core::stream::PathStream;

use super::bdpt::{self, Splat, Workspace};
use super::canvas::Canvas;
use super::mlt;
use super::tracer::Tracer;
use super::{Draws, Sample, Settings, path, room, transmittance};
use crate::drive::Progress;
use crate::film::{Allotment, Film, Landing, LayerSample, Places, Tile};
use crate::render::Plan;
use crate::world::World;

/// Which way light is transported.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
pub enum Integrator {
    /// Path tracing
    #[default]
    Path,
    /// Bidirectional path tracing
    Bdpt,
    /// Metropolis light transport over bidirectional paths
    Mlt,
    /// Light that is scattered at most once
    Single,
    /// Light that is not scattered
    Transmittance,
}

impl Integrator {
    /// All of them.
    pub const ALL: [Self; 5] = [
        Self::Path,
        Self::Bdpt,
        Self::Mlt,
        Self::Single,
        Self::Transmittance,
    ];

    /// The one of a name.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|i| i.name() == name)
    }

    /// Its name on the command line and in scenes.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Path => "path",
            Self::Bdpt => "bdpt",
            Self::Mlt => "mlt",
            Self::Single => "single",
            Self::Transmittance => "transmittance",
        }
    }
}

/// What a plan says to scalar integrators.
pub(super) fn settings(plan: &Plan) -> Settings {
    Settings {
        max_depth: plan.settings.max_depth,
        connection_bound: plan.connection_bound,
        split: plan.split,
    }
}

/// One sample of a pixel, without what lands elsewhere.
pub(crate) fn sample<D: Draws>(
    tracer: &mut Tracer<'_>,
    plan: &Plan,
    [x, y]: [u32; 2],
    draws: &mut D,
) -> Sample {
    let film = [f64::from(x) + draws.one(), f64::from(y) + draws.one()];
    let settings = settings(plan);
    match plan.integrator {
        Integrator::Transmittance => transmittance::trace(tracer, film, draws),
        Integrator::Bdpt | Integrator::Mlt => {
            let mut room = Workspace::default();
            bdpt::trace(tracer, &settings, film, draws, &mut room, &mut Vec::new())
        }
        Integrator::Single | Integrator::Path => path::trace(tracer, &settings, film, draws),
    }
}

/// Adds the samples with these indices to every pixel of a film over the world's window, or those of them that an allotment grants;
/// bidirectional integrators give every pixel the same.
pub fn render_pass(
    world: &World,
    plan: &Plan,
    film: &mut Film,
    samples: Range<u32>,
    allotment: Option<&Allotment>,
    progress: &dyn Progress,
) -> Counts {
    if matches!(plan.integrator, Integrator::Bdpt | Integrator::Mlt) {
        let mut counts = Counts::default();
        for sample in samples {
            let pass = match plan.integrator {
                Integrator::Mlt => mlt::replicate(world, plan, film, sample),
                _ => bidirectional(world, plan, film, sample),
            };
            progress.advance(pass.paths);
            counts.add(&pass);
        }
        return counts;
    }
    let tile = |tile: &mut Tile| {
        let places = Places::new(tile.window(), samples.clone(), allotment);
        let counts = render_tile(world, plan, tile, &places);
        progress.advance(counts.paths);
        counts
    };
    crate::render::over_tiles(film, tile)
}

/// What the paths of a tile bring.
struct Harvest {
    pixels: Vec<([u32; 2], Sample)>,
    splats: Vec<Splat>,
    spoilt: Vec<[u32; 2]>,
    counts: Counts,
}

/// One sample of every pixel, with as many light paths: a replicate of the picture of its own, since light paths may land
/// anywhere.
fn bidirectional(world: &World, plan: &Plan, film: &mut Film, index: u32) -> Counts {
    let window = film.window();
    let [width, height] = world.resolution.map(f64::from);
    // Splats are for as many light paths as the whole picture has pixels.
    let factor = width * height / window.pixels() as f64;
    let harvests = crate::render::map_tiles(film, |tile| harvest(world, plan, tile, index));
    let mut canvas = Canvas::new(window);
    let mut counts = Counts::default();
    for harvest in &harvests {
        counts.add(&harvest.counts);
        for (pixel, sample) in &harvest.pixels {
            let PathSample { radiance, alpha } = (*sample).into();
            canvas.add(*pixel, radiance);
            canvas.cover(*pixel, alpha);
        }
        for splat in &harvest.splats {
            canvas.splat(splat, factor);
        }
        for pixel in &harvest.spoilt {
            canvas.spoil(*pixel);
        }
    }
    canvas.hand_over(film, index);
    for (tile, harvest) in film.tiles_mut().iter_mut().zip(&harvests) {
        if !tile.keeps_layers() {
            continue;
        }
        for ([x, y], sample) in &harvest.pixels {
            tile.add_layers(*x, *y, &LayerSample::from(sample));
        }
    }
    counts
}

fn harvest(world: &World, plan: &Plan, tile: &Tile, index: u32) -> Harvest {
    let mut tracer = Tracer::new(world);
    let mut room = Workspace::default();
    let settings = settings(plan);
    let window = tile.window();
    let mut pixels = Vec::with_capacity(window.pixels() as usize);
    let mut splats = Vec::new();
    let mut spoilt = Vec::new();
    for y in window.y0..window.y1 {
        for x in window.x0..window.x1 {
            let mut draws = stream(world, plan, [x, y], index);
            let film = [f64::from(x) + draws.one(), f64::from(y) + draws.one()];
            let before = splats.len();
            let sample = bdpt::trace(
                &mut tracer,
                &settings,
                film,
                &mut draws,
                &mut room,
                &mut splats,
            );
            tracer.counts.paths += 1;
            if splats[before..]
                .iter()
                .any(|splat| !splat.radiance.is_finite())
            {
                splats.truncate(before);
                spoilt.push([x, y]);
            }
            pixels.push(([x, y], sample));
        }
    }
    Harvest {
        pixels,
        splats,
        spoilt,
        counts: tracer.counts,
    }
}

/// The random numbers of a pixel's sample.
pub(super) fn stream(world: &World, plan: &Plan, [x, y]: [u32; 2], sample: u32) -> PathStream {
    PathStream::new(crate::render::request(world, plan.seed, x, y, sample).key)
}

fn render_tile(world: &World, plan: &Plan, tile: &mut Tile, places: &Places) -> Counts {
    if let Some(blueprint) = room::of(world, plan) {
        return room::render_tile(blueprint, world, plan, tile, places);
    }
    let mut tracer = Tracer::new(world);
    let mut landing = Landing::default();
    for place in (0..places.len()).map(|number| places.place(number)) {
        let pixel = [place.x, place.y];
        let mut draws = stream(world, plan, pixel, place.sample);
        let sample = sample(&mut tracer, plan, pixel, &mut draws);
        tracer.counts.paths += 1;
        if tile.keeps_layers() {
            tile.add_layers(place.x, place.y, &LayerSample::from(&sample));
        }
        landing.land(tile, place, sample.into());
    }
    tracer.counts
}

/// One path again: what it brings, and what it met.
pub(crate) fn replay(
    world: &World,
    plan: &Plan,
    pixel: [u32; 2],
    index: u32,
) -> (PathSample, Counts) {
    if let Some(blueprint) = room::of(world, plan) {
        return room::replay(blueprint, world, plan, pixel, index);
    }
    let mut tracer = Tracer::new(world);
    let mut draws = stream(world, plan, pixel, index);
    let sample = sample(&mut tracer, plan, pixel, &mut draws);
    tracer.counts.paths += 1;
    (sample.into(), tracer.counts)
}
