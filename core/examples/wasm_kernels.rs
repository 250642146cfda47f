//! The least that a web page needs of the core: free flights and transmittance in a grid of its own samples, and
//! Henyey–Greenstein scattering, as a WebAssembly module whose size `.ci/run wasm` watches.
//!
//! The page writes samples into the module's memory, from `__heap_base` on, and leaves room for the majorants behind them.
#![cfg_attr(target_family = "wasm", no_std)]
#![allow(
    unsafe_code,
    reason = "names for other languages, and memory that they wrote"
)]

use woodcock_core::free_flight::delta;
use woodcock_core::majorant::{MajorantGrid, fill_majorants, majorant_count};
use woodcock_core::medium::{Grid, IDENTITY};
use woodcock_core::phase::henyey_greenstein;
use woodcock_core::ray::Ray;
use woodcock_core::stream::{Key, PathStream};
use woodcock_core::transmittance::ratio;
use woodcock_core::vec3::Vec3;

/// A grid that the page has opened, and the random numbers that it draws from.
#[derive(Debug)]
pub struct Opened {
    grid: Grid<'static>,
    rng: PathStream,
}

/// Makes and proves the majorants of samples in the module's memory. Whether that went well.
///
/// # Safety
/// There are x · y · z samples, room for [`majorant_count`] bounds behind them, and for an [`Opened`] at `opened`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn open(
    opened: *mut Opened,
    samples: *mut f32,
    x: u32,
    y: u32,
    z: u32,
) -> bool {
    let dims = [x, y, z];
    let count = x as usize * y as usize * z as usize;
    let made = majorant_count(dims).and_then(|bounds| {
        // SAFETY: the page's word.
        let (samples, majorants) = unsafe {
            let behind = samples.wrapping_add(count);
            (
                core::slice::from_raw_parts(samples, count),
                core::slice::from_raw_parts_mut(behind, bounds),
            )
        };
        fill_majorants(samples, dims, majorants).ok()?;
        let bounds = MajorantGrid::new(samples, dims, majorants).ok()?;
        Grid::new(bounds, IDENTITY, 1.0)
    });
    let Some(grid) = made else { return false };
    let rng = PathStream::new(Key::default());
    // SAFETY: the page's word.
    unsafe { opened.write(Opened { grid, rng }) };
    true
}

/// Begins the random numbers of a path.
#[unsafe(no_mangle)]
pub extern "C" fn key(opened: &mut Opened, seed: u64, pixel: u32, sample: u32) {
    opened.rng = PathStream::new(Key {
        seed,
        pixel,
        sample,
    });
}

/// The ray that the page has written, within the grid.
type Page = [[f32; 3]; 2];

fn ray(&[origin, direction]: &Page) -> Ray<f32> {
    Ray {
        origin: Vec3::splat(origin),
        direction: Vec3::splat(direction),
    }
}

/// The distance to a collision, infinite without one.
#[unsafe(no_mangle)]
pub extern "C" fn flight(opened: &mut Opened, page: &Page, t_max: f32) -> f32 {
    delta::sample(&opened.grid, &ray(page), t_max, &mut opened.rng, true).or_infinite()
}

/// An estimate of transmittance.
#[unsafe(no_mangle)]
pub extern "C" fn transmittance(opened: &mut Opened, page: &Page, t_max: f32) -> f32 {
    ratio::estimate(&opened.grid, &ray(page), t_max, &mut opened.rng, true)
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
