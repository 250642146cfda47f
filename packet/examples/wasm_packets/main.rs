//! The kernels of core's example `wasm_kernels` for eight rays at a time, as a WebAssembly module whose size
//! `.ci/run wasm` watches.
#![cfg_attr(target_family = "wasm", no_std)]
#![allow(
    unsafe_code,
    reason = "names for other languages, and memory that they wrote"
)]

use woodcock_core::free_flight::delta;
use woodcock_core::phase::henyey_greenstein;
use woodcock_core::ray::Ray;
use woodcock_core::real::{Mask, Real};
use woodcock_core::stream::{Key, KeyedStream};
use woodcock_core::transmittance::ratio;
use woodcock_core::vec3::Vec3;
use woodcock_packet::bits::LaneStream;
use woodcock_packet::lanes::Lanes;

#[cfg(target_family = "wasm")]
#[path = "../wasm_bits/bare.rs"]
mod bare;
#[path = "../../../core/examples/wasm_kernels/page.rs"]
mod page;
use page::Page;

/// Eight numbers, one a ray.
type Eight = [f32; 8];

/// What the page writes: rays within its grid and their keys; and what it reads.
#[repr(C)]
#[derive(Debug)]
pub struct Rays {
    seed: u64,
    pixels: [u32; 8],
    samples: [u32; 8],
    origins: [Eight; 3],
    directions: [Eight; 3],
    t_max: Eight,
    results: Eight,
}

impl Rays {
    #[inline(never)]
    fn rays(&self) -> Ray<Lanes> {
        let vector =
            |[x, y, z]: &[Eight; 3]| Vec3::new(Lanes::new(*x), Lanes::new(*y), Lanes::new(*z));
        Ray {
            origin: vector(&self.origins),
            direction: vector(&self.directions),
        }
    }
    #[inline(never)]
    fn streams(&self) -> LaneStream {
        let mut streams = LaneStream::idle();
        let seed = self.seed;
        for (lane, (&pixel, &sample)) in self.pixels.iter().zip(&self.samples).enumerate() {
            streams.set_key(
                lane,
                Key {
                    seed,
                    pixel,
                    sample,
                },
            );
        }
        streams
    }
}

/// The distances to collisions, infinite without.
#[unsafe(no_mangle)]
pub extern "C" fn flights(page: &Page, rays: &mut Rays) {
    let (all, t_max) = (Mask::splat(true), Lanes::new(rays.t_max));
    let flight = delta::sample(
        &page.grid::<Lanes>(),
        &rays.rays(),
        t_max,
        &mut rays.streams(),
        all,
    );
    rays.results = flight.or_infinite().to_array();
}

/// Estimates of transmittance.
#[unsafe(no_mangle)]
pub extern "C" fn transmittances(page: &Page, rays: &mut Rays) {
    let (all, t_max) = (Mask::splat(true), Lanes::new(rays.t_max));
    let weights = ratio::estimate(
        &page.grid::<Lanes>(),
        &rays.rays(),
        t_max,
        &mut rays.streams(),
        all,
    );
    rays.results = weights.to_array();
}

/// The cosines of scatterings at uniform numbers, in their place.
#[unsafe(no_mangle)]
pub extern "C" fn scatter(numbers: &mut Eight, g: f32) {
    let cosines = henyey_greenstein::sample(Lanes::new(*numbers), Lanes::splat(g));
    *numbers = cosines.to_array();
}

/// The densities of cosines, in their place.
#[unsafe(no_mangle)]
pub extern "C" fn density(numbers: &mut Eight, g: f32) {
    let densities = henyey_greenstein::eval(Lanes::new(*numbers), Lanes::splat(g));
    *numbers = densities.to_array();
}
