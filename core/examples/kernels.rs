//! Kernels as an embedder compiles them, for `.ci/run no-panic` to look into: no path through their
//! machine code may lead to a panic.
//!
//! Everything here is an ordinary function of one lane, so that the generic code of core is compiled in
//! this crate. Media are built by the caller: constructors check, and may say no; what runs per path may not.
#![no_std]
#![forbid(unsafe_code)]

use woodcock_core::collision::roulette;
use woodcock_core::free_flight::{self, Flight};
use woodcock_core::majorant::{GridLayout, GridWalk};
use woodcock_core::medium::{Grid, Homogeneous, Procedural, ProceduralGrid};
use woodcock_core::path::{Atlas, OneGrid, OneHomogeneous};
use woodcock_core::phase::{Phase, henyey_greenstein, isotropic, rayleigh};
use woodcock_core::ray::{Interval, Ray};
use woodcock_core::stream::{Key, PathStream, Stream};
use woodcock_core::transmittance;
use woodcock_core::vec3::Vec3;

/// Extinction as an embedder's own function.
pub type Field = fn(Vec3<f32>) -> f32;

/// A ray's stream from the beginning.
#[inline(never)]
pub fn stream(key: Key) -> PathStream {
    PathStream::new(key)
}

/// Free flight in closed form.
#[inline(never)]
pub fn free_flight_analytic(fog: &Homogeneous, t_max: f32, rng: &mut PathStream) -> Flight<f32> {
    free_flight::analytic::sample(fog, t_max, rng, true)
}

/// Transmittance in closed form.
#[inline(never)]
pub fn transmittance_analytic(fog: &Homogeneous, t_max: f32) -> f32 {
    transmittance::analytic::estimate(fog, t_max)
}

macro_rules! tracked {
    ($($medium:ty: $flight:ident $delta:ident $ratio:ident;)*) => {$(
        /// Free flight by delta tracking.
        #[inline(never)]
        pub fn $flight(medium: &$medium, ray: &Ray<f32>, t_max: f32, rng: &mut PathStream) -> Flight<f32> {
            free_flight::delta::sample(medium, ray, t_max, rng, true)
        }
        /// Transmittance by delta tracking.
        #[inline(never)]
        pub fn $delta(medium: &$medium, ray: &Ray<f32>, t_max: f32, rng: &mut PathStream) -> f32 {
            transmittance::delta::estimate(medium, ray, t_max, rng, true)
        }
        /// Transmittance by ratio tracking.
        #[inline(never)]
        pub fn $ratio(medium: &$medium, ray: &Ray<f32>, t_max: f32, rng: &mut PathStream) -> f32 {
            transmittance::ratio::estimate(medium, ray, t_max, rng, true)
        }
    )*};
}
tracked! {
    Homogeneous: flight_in_fog delta_in_fog ratio_in_fog;
    Grid<'_>: flight_in_grid delta_in_grid ratio_in_grid;
    Procedural<Field>: flight_in_field delta_in_field ratio_in_field;
    ProceduralGrid<'_, Field>: flight_in_cells delta_in_cells ratio_in_cells;
    OneHomogeneous: flight_in_one_fog delta_in_one_fog ratio_in_one_fog;
    OneGrid<'_>: flight_in_one_grid delta_in_one_grid ratio_in_one_grid;
    Atlas<'_>: flight_in_atlas delta_in_atlas ratio_in_atlas;
}

/// Where a ray crosses a grid's domain.
#[inline(never)]
pub fn clip(grid: &Grid<'_>, ray: &Ray<f32>) -> Interval<f32> {
    grid.clip(ray)
}

/// The full interpolant of samples under a walk.
#[inline(never)]
pub fn interpolant(layout: &GridLayout<f32>, ray: &Ray<f32>, tables: [&[f32]; 2], t: f32) -> f32 {
    let [samples, majorants] = tables;
    let mut walk = GridWalk::idle();
    walk.begin(layout, ray, majorants, true);
    walk.trilinear(samples, t)
}

/// A new direction by any phase function, and its density.
#[inline(never)]
pub fn scatter(phase: &Phase<f32>, towards: Vec3<f32>, rng: &mut PathStream) -> (Vec3<f32>, f32) {
    let cosine = phase.sample::<true>(rng.uniform(true));
    let turn = rng.uniform(true);
    (towards.deflected(cosine, turn), phase.eval::<true>(cosine))
}

/// Every phase function by itself, there and back.
#[inline(never)]
pub fn round_trips(u: f32, g: f32) -> [f32; 3] {
    [
        isotropic::invert(isotropic::sample(u)),
        henyey_greenstein::invert(henyey_greenstein::sample(u, g), g),
        rayleigh::invert(rayleigh::sample(u)),
    ]
}

/// Russian roulette.
#[inline(never)]
pub fn survive(weight: f32, threshold: f32, rng: &mut PathStream) -> f32 {
    roulette(weight, threshold, rng, true)
}
