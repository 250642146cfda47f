//! Metropolis light transport in primary sample space [Kelemen 2002], over bidirectional paths [Raab, Seibert, Keller 2006].
//!
//! A state is what one call of bidirectional path tracing makes of its random numbers: light on the film, mostly in
//! one pixel and some splats. Its *brightness* f is the mean of all of that. Chains walk so that states come in
//! proportion to f, and each leaves its light over f.
//!
//! *No start-up bias.* A set of n independent states is drawn; chains start at members chosen in proportion to f, and
//! everything is weighted by the set's mean brightness:
//!
//! ```text
//! E[ f̄ · h(X₀)/f(X₀) ] = E[ Σᵢ fᵢ/n · hᵢ/fᵢ ] = ∫ h
//! ```
//!
//! exactly, for every n, since Σᵢ fᵢ cancels; steps of the chain leave the law of states as it is ([Veach 1997], section
//! 11.3). Sets are drawn anew for each sample of the picture: samples are independent replicates, and their spread is the
//! true variance.

mod primary;

use glam::DVec3;
use woodcock_core::path::Counts;
use woodcock_core::stream::{Key, PathStream};

use self::primary::Primaries;
use super::bdpt::{self, Splat, Workspace};
use super::canvas::Canvas;
use super::tracer::{End, Tracer, Unseen};
use super::{Draws, Settings, Subpath, camera};
use crate::film::{Film, Window};
use crate::light::discrete::Discrete;
use crate::render::{Plan, map_all};
use crate::world::World;

/// Steps of a chain, about.
const STEPS: u32 = 4096;
/// States drawn for each chain to start from.
const CANDIDATES: u32 = 1024;
/// How often a step is large.
const LARGE: f64 = 0.3;
/// Tells the keys of candidates and chains from those of pixels.
const CANDIDATE: u64 = 0x6a09_e667_f3bc_c908;
const CHAIN: u64 = 0xbb67_ae85_84ca_a73b;

/// What a state brings to the picture.
#[derive(Debug, Default)]
struct State {
    splats: Vec<Splat>,
    brightness: f64,
}

/// The tools of one chain.
struct Walker<'a> {
    tracer: Tracer<'a>,
    room: Workspace,
    settings: Settings,
    window: Window,
    /// Splats are for as many light paths as the whole picture has pixels.
    factor: f64,
    /// Pixels of paths that were not finite.
    broken: Vec<[u32; 2]>,
}

impl<'a> Walker<'a> {
    fn new(world: &'a World, plan: &Plan, window: Window) -> Self {
        let [width, height] = world.resolution.map(f64::from);
        Self {
            tracer: Tracer::new(world),
            room: Workspace::default(),
            settings: super::pass::settings(plan),
            window,
            factor: width * height / window.pixels() as f64,
            broken: Vec::new(),
        }
    }

    /// Traces the paths of a state.
    fn evaluate(&mut self, draws: &mut Primaries, state: &mut State) {
        // Numbers that nothing else asks for: the camera's own first vertex is a place on its lens.
        draws.vertex(Subpath::Join, 1);
        let [width, height] = self.window.size().map(f64::from);
        let film = [
            f64::from(self.window.x0) + draws.one() * width,
            f64::from(self.window.y0) + draws.one() * height,
        ];
        state.splats.clear();
        let tracer = &mut self.tracer;
        let splats = &mut state.splats;
        let sample = bdpt::trace(tracer, &self.settings, film, draws, &mut self.room, splats);
        tracer.counts.paths += 1;
        splats.retain(|splat| {
            let [x, y] = splat.film;
            x >= 0.0 && y >= 0.0 && self.window.contains(x as u32, y as u32)
        });
        for splat in &mut *splats {
            splat.radiance *= self.factor;
        }
        splats.push(Splat {
            film,
            radiance: sample.radiance,
        });
        let sum: f64 = splats.iter().map(|s| s.radiance.element_sum()).sum();
        if sum.is_finite() {
            state.brightness = sum;
        } else {
            // Never stepped on.
            self.broken.push(film.map(|at| at as u32));
            state.brightness = 0.0;
        }
    }
}

/// The state that a key stands for.
fn candidate(plan: &Plan, number: u32, sample: u32) -> Primaries {
    let place = |salt: u64| Key {
        seed: plan.seed ^ salt,
        pixel: number,
        sample,
    };
    Primaries::new(
        place(CANDIDATE).hash(),
        PathStream::new(place(CANDIDATE ^ CHAIN)),
    )
}

/// One sample of every pixel: a replicate of the picture, with as many steps as it has pixels.
pub(super) fn replicate(world: &World, plan: &Plan, film: &mut Film, sample: u32) -> Counts {
    let window = film.window();
    let steps = u32::try_from(window.pixels()).unwrap_or(u32::MAX).max(1);
    let chains = steps.div_ceil(STEPS);
    let mut counts = Counts::default();
    let mut canvas = Canvas::new(window);

    let candidates = chains.saturating_mul(CANDIDATES);
    let groups = map_all(chains, |chain| {
        let mut walker = Walker::new(world, plan, window);
        let mut state = State::default();
        let brightness: Vec<f64> = (chain * CANDIDATES..(chain + 1) * CANDIDATES)
            .map(|number| {
                let mut primaries = candidate(plan, number, sample);
                walker.evaluate(&mut primaries, &mut state);
                state.brightness
            })
            .collect();
        (brightness, walker.tracer.counts, walker.broken)
    });
    for (_, group, broken) in &groups {
        counts.add(group);
        broken.iter().for_each(|pixel| canvas.spoil(*pixel));
    }
    let candidates_by_brightness =
        Discrete::new(groups.into_iter().flat_map(|(brightness, ..)| brightness));
    let mean = candidates_by_brightness.total() / f64::from(candidates);

    let light = map_all(chains, |chain| {
        let mut start = PathStream::new(Key {
            seed: plan.seed ^ CHAIN,
            pixel: chain,
            sample,
        });
        // Even strata of the candidates.
        let u = (f64::from(chain) + start.one()) / f64::from(chains);
        let Some((number, _)) = candidates_by_brightness.choose(u) else {
            return Walk::default();
        };
        let length = steps.div_ceil(chains);
        // Light for as many states as there are pixels, from as many as there are steps.
        let weight = mean * f64::from(steps) / (f64::from(length) * f64::from(chains));
        let mut walker = Walker::new(world, plan, window);
        let mut primaries = candidate(plan, number as u32, sample);
        walk(&mut walker, &mut primaries, &mut start, length, weight)
    });
    for walk in light {
        counts.add(&walk.counts);
        walk.broken.iter().for_each(|pixel| canvas.spoil(*pixel));
        for (pixel, radiance) in walk.light {
            canvas.add(pixel, radiance);
        }
    }
    for (pixel, alpha) in covered(world, plan, film, sample) {
        canvas.cover(pixel, alpha);
    }
    canvas.hand_over(film, sample);
    counts
}

/// What a chain leaves.
#[derive(Debug, Default)]
struct Walk {
    light: Vec<([u32; 2], [f32; 3])>,
    counts: Counts,
    broken: Vec<[u32; 2]>,
}

/// Steps of a chain from a state. Each leaves the light of both the state it came from and the one it tried, by the
/// chances of either.
fn walk(
    walker: &mut Walker<'_>,
    primaries: &mut Primaries,
    choices: &mut PathStream,
    length: u32,
    weight: f64,
) -> Walk {
    let mut here = State::default();
    let mut there = State::default();
    walker.evaluate(primaries, &mut here);
    let mut light = Vec::new();
    let mut leave = |state: &State, share: f64| {
        if share > 0.0 && state.brightness > 0.0 {
            let factor = weight * share / state.brightness;
            light.extend(state.splats.iter().map(|splat| {
                let [x, y] = splat.film;
                let radiance = (splat.radiance * factor).as_vec3().to_array();
                ([x as u32, y as u32], radiance)
            }));
        }
    };
    // A state that is stayed at leaves its light once, when it is left.
    let mut stayed = 0.0;
    for _ in 0..length {
        primaries.propose(choices.one() < LARGE);
        walker.evaluate(primaries, &mut there);
        let chance = (there.brightness / here.brightness).min(1.0);
        let chance = if chance.is_nan() { 0.0 } else { chance };
        stayed += 1.0 - chance;
        if choices.one() < chance {
            leave(&here, stayed);
            stayed = chance;
            primaries.accept();
            std::mem::swap(&mut here, &mut there);
        } else {
            leave(&there, chance);
            primaries.reject();
        }
    }
    leave(&here, stayed);
    Walk {
        light,
        counts: walker.tracer.counts,
        broken: std::mem::take(&mut walker.broken),
    }
}

/// How much of each pixel is covered: by one camera ray each.
fn covered(world: &World, plan: &Plan, film: &Film, sample: u32) -> Vec<([u32; 2], f32)> {
    let tiles = crate::render::map_tiles(film, |tile| {
        let mut tracer = Tracer::new(world);
        let Window { x0, y0, x1, y1 } = tile.window();
        let pixels = (y0..y1).flat_map(|y| (x0..x1).map(move |x| [x, y]));
        let alpha = pixels.map(|pixel| {
            let mut draws = super::pass::stream(world, plan, pixel, sample);
            let film = pixel.map(|at| f64::from(at) + draws.one());
            let ray = camera::ray(world, film, &mut draws);
            let mut throughput = DVec3::ONE;
            let flight = tracer.fly(&ray, &mut throughput, &mut draws, &mut Unseen);
            let covered = !matches!(flight.end, End::Escape);
            (pixel, f32::from(u8::from(covered)))
        });
        alpha.collect::<Vec<_>>()
    });
    tiles.into_iter().flatten().collect()
}
