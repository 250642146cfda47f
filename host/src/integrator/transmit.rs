//! How much light passes along a part of a ray.

use glam::DVec3;

use super::walk::{Next, Stretch, walk};
use super::{Draws, Tentative};
use crate::ray::Ray;
use crate::world::World;
use woodcock_core::collision;
use woodcock_core::path::Counts;

/// An estimate of transmittance.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Transmission {
    /// By colour; right in expectation.
    pub(crate) weight: DVec3,
    /// The *passage* of the segment: what the density of an analog flight through it has over that of a
    /// connection ([`Passage`]).
    pub(crate) passage: f64,
}

/// Below this weight a shadow ray plays roulette, and survives with it.
const ROULETTE: f64 = 0.125;

/// The mean over colours: the extinction that densities go by where it is coloured. (Any fixed rule would do: densities
/// only share out a path between strategies.)
pub(crate) fn mean(colour: [f64; 3]) -> f64 {
    let [r, g, b] = colour;
    if r == g && g == b {
        r
    } else {
        (r + g + b) / 3.0
    }
}

/// The chance that an analog flight passes everything on a segment without a collision, given the tentative
/// collisions there: for each on grids 1 − σ/σ̄, for homogeneous stretches e^−τ.
///
/// Tentative collisions have the same Poisson density whichever strategy places them, from either end, so
/// that this ratio is all by which an analog flight differs from a connection.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Passage {
    /// Product over the tentative collisions passed so far.
    nulls: f64,
}

impl Passage {
    pub(crate) fn new() -> Self {
        Self { nulls: 1.0 }
    }

    /// A tentative collision is passed.
    pub(crate) fn pass(&mut self, world: &World, tentative: &Tentative) {
        if !is_closed(world, tentative.medium) {
            self.nulls *= 1.0 - mean(tentative.local.sigma_t) / tentative.majorant;
        }
    }

    /// The chance for the part of the ray up to `t`.
    pub(crate) fn up_to(&self, world: &World, stretches: &[Stretch], t: f64) -> f64 {
        let mut depth = 0.0;
        for &(from, to, medium) in stretches {
            if from < t && is_closed(world, medium) {
                depth += mean(extinction(world, medium)) * (to.min(t) - from);
            }
        }
        if depth == 0.0 {
            self.nulls
        } else {
            self.nulls * libm::exp(-depth)
        }
    }
}

/// Whether a medium's transmittance has a closed form.
fn is_closed(world: &World, medium: usize) -> bool {
    world.media.get(medium).is_some_and(|m| m.support.is_none())
}

/// Extinction of a homogeneous medium by colour.
fn extinction(world: &World, medium: usize) -> [f64; 3] {
    world.media.get(medium).map_or([0.0; 3], |m| {
        m.local(&world.tables, None, DVec3::ZERO).sigma_t
    })
}

/// Estimates the transmittance of stretches: homogeneous ones in closed form, others by ratio tracking.
///
/// * `open`: room for the stretches that are tracked.
/// * `roulette`: whether small weights may end; densities need their passage to the end, and do not mind.
pub(crate) fn transmit<D: Draws>(
    world: &World,
    ray: &Ray,
    stretches: &[Stretch],
    open: &mut Vec<Stretch>,
    draws: &mut D,
    counts: &mut Counts,
) -> Transmission {
    let mut depth = DVec3::ZERO;
    open.clear();
    for &stretch in stretches {
        let (from, to, medium) = stretch;
        if is_closed(world, medium) {
            depth += DVec3::from(extinction(world, medium)) * (to - from);
        } else {
            open.push(stretch);
        }
    }
    let grey = depth.x == depth.y && depth.y == depth.z;
    let mut weight = match depth {
        DVec3::ZERO => DVec3::ONE,
        _ if grey => DVec3::splat(libm::exp(-depth.x)),
        _ => DVec3::from(depth.to_array().map(|d| libm::exp(-d))),
    };
    let mut passage = Passage::new();
    if !open.is_empty() {
        draws.begin_nulls();
        walk(world, ray, open, draws, counts, |draws, tentative| {
            passage.pass(world, tentative);
            let sigma_t = DVec3::from(tentative.local.sigma_t);
            weight *= DVec3::ONE - sigma_t / tentative.majorant;
            let largest = weight.max_element();
            let factor = collision::roulette(largest, ROULETTE, draws, true);
            weight *= factor;
            if largest * factor == 0.0 {
                Next::Stop
            } else {
                Next::On
            }
        });
    }
    Transmission {
        weight,
        passage: passage.up_to(world, stretches, f64::INFINITY),
    }
}
