//! Scenes that are rooms (a few diffuse pieces and lamps, perhaps in fog), rendered eight rays at a time by core's
//! [`room`](woodcock_core::room).

mod blueprint;
mod flats;

use std::ops::Range;

use woodcock_core::path::{Counts, PathSample};
use woodcock_packet::room;

pub(crate) use blueprint::Blueprint;

use super::Integrator;
use crate::film::{Landing, Place, Tile};
use crate::render::{Kernel, Plan};
use crate::world::{Feature, World};

/// The tables of a world that a plan renders as a room; `None` where other code does.
pub(crate) fn of<'w>(world: &'w World, plan: &Plan) -> Option<&'w Blueprint> {
    let plain = !world.needs.runs(Feature::DetailedSurfaces) && !plan.layers && plan.split == 1;
    let paths = matches!(plan.integrator, Integrator::Path | Integrator::Single);
    world.room.as_ref().filter(|_| plain && paths)
}

/// Adds samples to every pixel of a tile.
pub(super) fn render_tile(
    blueprint: &Blueprint,
    world: &World,
    plan: &Plan,
    tile: &mut Tile,
    samples: Range<u32>,
) -> Counts {
    let walls = blueprint.room(world, plan);
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
        crate::render::request(world, plan.seed, x, y, sample)
    });
    let mut landing = Landing::default();
    let mut land = |index: usize, path| landing.land(tile, place(index), path);
    match plan.kernel {
        Kernel::Packet => room::trace(&walls, requests, land),
        Kernel::Scalar => {
            let mut counts = Counts::default();
            for (index, request) in requests.enumerate() {
                land(index, room::trace_scalar(&walls, request, &mut counts));
            }
            counts
        }
    }
}

/// One path again: what it brings, and what it met.
pub(super) fn replay(
    blueprint: &Blueprint,
    world: &World,
    plan: &Plan,
    [x, y]: [u32; 2],
    sample: u32,
) -> (PathSample, Counts) {
    let request = crate::render::request(world, plan.seed, x, y, sample);
    let mut counts = Counts::default();
    let path = room::trace_scalar(&blueprint.room(world, plan), request, &mut counts);
    (path, counts)
}
