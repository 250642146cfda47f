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

use woodcock_core::path::{Counts, PathSample};
use woodcock_core::stream::{Key, PathStream};

use self::primary::Primaries;
use super::bdpt::{self, Splat, Workspace};
use super::canvas::Canvas;
use super::tracer::Tracer;
use super::{Draws, Settings, Subpath, path};
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
    broken: u64,
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
            broken: 0,
        }
    }

    /// Traces the paths of a state.
    fn evaluate(&mut self, draws: &mut Primaries, state: &mut State) {
        draws.vertex(Subpath::Camera, 0);
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
            self.broken += 1;
            state.brightness = 0.0;
        }
    }
}

/// The state that a key stands for.
fn candidate(world: &World, plan: &Plan, number: u32, sample: u32) -> Primaries {
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
