//! The least that a web page needs of the core: free flights and transmittance in a grid that the page has written,
//! and Henyey–Greenstein scattering, as a WebAssembly module whose size `.ci/run wasm` watches.
//!
//! The majorants of the grid come with it, computed and proved where
//! the page was made: here nothing is proved. Wrong ones bias, but no look-up leaves its table.
#![cfg_attr(target_family = "wasm", no_std)]
#![allow(
    unsafe_code,
    reason = "names for other languages, and memory that they wrote"
)]

use woodcock_core::free_flight::delta;
use woodcock_core::phase::henyey_greenstein;
use woodcock_core::ray::Ray;
use woodcock_core::stream::{Key, PathStream};
use woodcock_core::transmittance::ratio;
use woodcock_core::vec3::Vec3;

mod page;
use page::Page;

fn ray(page: &Page) -> Ray<f32> {
    Ray {
        origin: Vec3::splat(page.origin),
        direction: Vec3::splat(page.direction),
    }
}

/// Puts a stream at the beginning of its key.
#[unsafe(no_mangle)]
pub extern "C" fn key(rng: &mut PathStream, seed: u64, pixel: u32, sample: u32) {
    *rng = PathStream::new(Key {
        seed,
        pixel,
        sample,
    });
}

/// The distance to a collision, infinite without one.
#[unsafe(no_mangle)]
pub extern "C" fn flight(page: &Page, rng: &mut PathStream) -> f32 {
    delta::sample(&page.grid::<f32>(), &ray(page), page.t_max, rng, true).or_infinite()
}

/// An estimate of transmittance.
#[unsafe(no_mangle)]
pub extern "C" fn transmittance(page: &Page, rng: &mut PathStream) -> f32 {
    ratio::estimate(&page.grid::<f32>(), &ray(page), page.t_max, rng, true)
}

/// The cosine of a scattering at a uniform number.
#[unsafe(no_mangle)]
pub extern "C" fn scatter(u: f32, g: f32) -> f32 {
    henyey_greenstein::sample(u, g)
}

/// The density of a cosine.
#[unsafe(no_mangle)]
pub extern "C" fn density(cos_theta: f32, g: f32) -> f32 {
    henyey_greenstein::eval(cos_theta, g)
}

#[cfg(target_family = "wasm")]
#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    core::arch::wasm32::unreachable()
}
