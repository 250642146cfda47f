//! Kernels as an embedder compiles them, for `.ci/run no-panic` to look into: no path through their
//! machine code may lead to a panic.
//!
//! Everything here is an ordinary function of one lane, so that the generic code of core is compiled in
//! this crate. Media are built by the caller: constructors check, and may say no; what runs per path may not.
#![no_std]
#![forbid(unsafe_code)]

use woodcock_core::collision::roulette;
use woodcock_core::free_flight::weighted::WeightedFlight;
use woodcock_core::free_flight::{self, Flight};
use woodcock_core::line_integral;
use woodcock_core::majorant::{GridLayout, GridWalk};
use woodcock_core::medium::{
    Exponential, Grid, Homogeneous, Linear, Overlap, Placed, Procedural, ProceduralGrid, Voxels,
    Within,
};
use woodcock_core::path::{Atlas, OneGrid, OneHomogeneous};
use woodcock_core::phase::{Phase, henyey_greenstein, isotropic, rayleigh};
use woodcock_core::ray::{Interval, Ray};
use woodcock_core::stream::{Key, PathStream, Stream};
use woodcock_core::transmittance;
use woodcock_core::transmittance::power_series::{self, Depth, Distance};
use woodcock_core::transmittance::residual_ratio::{self, Mean, Minimum};
use woodcock_core::vec3::Vec3;

/// Extinction as an embedder's own function.
pub type Field = fn(Vec3<f32>) -> f32;

/// A ray's stream from the beginning.
#[inline(never)]
pub fn stream(key: Key) -> PathStream {
    PathStream::new(key)
}

macro_rules! closed_forms {
    ($($medium:ty: $flight:ident $weight:ident;)*) => {$(
        /// Free flight in closed form.
        #[inline(never)]
        pub fn $flight(medium: &$medium, ray: &Ray<f32>, t_max: f32, rng: &mut PathStream) -> Flight<f32> {
            free_flight::analytic::sample(medium, ray, t_max, rng, true)
        }
        /// Transmittance in closed form.
        #[inline(never)]
        pub fn $weight(medium: &$medium, ray: &Ray<f32>, t_max: f32) -> f32 {
            transmittance::analytic::estimate(medium, ray, t_max)
        }
    )*};
}
closed_forms! {
    Homogeneous: closed_flight_in_fog closed_weight_in_fog;
    Linear: closed_flight_in_ramp closed_weight_in_ramp;
    Exponential: closed_flight_in_air closed_weight_in_air;
}

macro_rules! piecewise_constant {
    ($($medium:ty: $flight:ident $weight:ident;)*) => {$(
        /// Free flight from cell to cell.
        #[inline(never)]
        pub fn $flight(medium: &$medium, ray: &Ray<f32>, t_max: f32, rng: &mut PathStream) -> Flight<f32> {
            free_flight::regular::sample(medium, ray, t_max, rng, true)
        }
        /// Transmittance from cell to cell.
        #[inline(never)]
        pub fn $weight(medium: &$medium, ray: &Ray<f32>, t_max: f32) -> f32 {
            transmittance::regular::estimate(medium, ray, t_max, true)
        }
    )*};
}
piecewise_constant! {
    Voxels<'_>: regular_flight_in_voxels regular_weight_in_voxels;
}

macro_rules! controlled {
    ($($medium:ty: $decomposed:ident $weighted:ident $mean:ident $minimum:ident $distance:ident $depth:ident $comb:ident $collisions:ident $tentative:ident;)*) => {$(
        /// Free flight by decomposition tracking.
        #[inline(never)]
        pub fn $decomposed(medium: &$medium, ray: &Ray<f32>, t_max: f32, rng: &mut PathStream) -> Flight<f32> {
            free_flight::decomposition::sample(medium, ray, t_max, rng, true)
        }
        /// Free flight by weighted tracking.
        #[inline(never)]
        pub fn $weighted(medium: &$medium, ray: &Ray<f32>, t_max: f32, rng: &mut PathStream) -> WeightedFlight<f32> {
            free_flight::weighted::sample(medium, ray, t_max, rng, true)
        }
        /// Transmittance by residual ratio tracking under the mean.
        #[inline(never)]
        pub fn $mean(medium: &$medium, ray: &Ray<f32>, t_max: f32, rng: &mut PathStream) -> f32 {
            residual_ratio::estimate::<Mean, f32, _>(medium, ray, t_max, rng, true)
        }
        /// Transmittance by residual ratio tracking under the minimum.
        #[inline(never)]
        pub fn $minimum(medium: &$medium, ray: &Ray<f32>, t_max: f32, rng: &mut PathStream) -> f32 {
            residual_ratio::estimate::<Minimum, f32, _>(medium, ray, t_max, rng, true)
        }
        /// Transmittance by a power series over points equidistant on the ray.
        #[inline(never)]
        pub fn $distance(medium: &$medium, ray: &Ray<f32>, t_max: f32, rng: &mut PathStream) -> f32 {
            power_series::estimate::<Distance, f32, _>(medium, ray, t_max, rng, true)
        }
        /// Transmittance by a power series over points equidistant in majorant depth.
        #[inline(never)]
        pub fn $depth(medium: &$medium, ray: &Ray<f32>, t_max: f32, rng: &mut PathStream) -> f32 {
            power_series::estimate::<Depth, f32, _>(medium, ray, t_max, rng, true)
        }
        /// Transmittance by a comb of walks.
        #[inline(never)]
        pub fn $comb(medium: &$medium, ray: &Ray<f32>, t_max: f32, walks: u32, rng: &mut PathStream) -> f32 {
            transmittance::comb::estimate(medium, ray, t_max, walks, rng, true)
        }
        /// A line integral scored at real collisions.
        #[inline(never)]
        pub fn $collisions(medium: &$medium, ray: &Ray<f32>, t_max: f32, walks: u32, rng: &mut PathStream) -> f32 {
            line_integral::collisions(medium, ray, t_max, walks, |t, _| 1.0 + t, 0.5, rng, true)
        }
        /// A line integral scored at tentative points.
        #[inline(never)]
        pub fn $tentative(medium: &$medium, ray: &Ray<f32>, t_max: f32, walks: u32, rng: &mut PathStream) -> f32 {
            line_integral::tentative(medium, ray, t_max, walks, |t, _| 1.0 + t, 0.5, 0.1, rng, true)
        }
    )*};
}
controlled! {
    Grid<'_>: decomposed_in_grid weighted_in_grid mean_in_grid minimum_in_grid distance_in_grid depth_in_grid
        comb_in_grid collisions_in_grid tentative_in_grid;
    Procedural<Field>: decomposed_in_field weighted_in_field mean_in_field minimum_in_field distance_in_field
        depth_in_field comb_in_field collisions_in_field tentative_in_field;
    Overlap<Within<Grid<'_>>, Placed<Exponential>>: decomposed_in_sum weighted_in_sum mean_in_sum minimum_in_sum
        distance_in_sum depth_in_sum comb_in_sum collisions_in_sum tentative_in_sum;
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
