//! Scenes that are rooms (a few diffuse pieces and lamps, perhaps in fog), rendered eight rays at a time by core's
//! [`room`](woodcock_core::room).

mod blueprint;
mod flats;

use woodcock_core::path::{Counts, PathSample};
use woodcock_packet::room;

pub(crate) use blueprint::Blueprint;

use super::Integrator;
use crate::film::{Places, Tile};
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
    places: &Places,
) -> Counts {
    let walls = blueprint.room(world, plan);
    crate::render::trace_tile(world, plan, places, tile, |requests, paths| {
        let requests = requests.iter();
        match plan.kernel {
            Kernel::Packet => room::trace(&walls, requests, |index, path| paths[index] = path),
            Kernel::Scalar => {
                let mut counts = Counts::default();
                for (path, request) in paths.iter_mut().zip(requests) {
                    *path = room::trace_scalar(&walls, request, &mut counts);
                }
                counts
            }
        }
    })
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
