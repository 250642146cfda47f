//! # woodcock-c
//!
//! `woodcock-core` behind the C interface of `include/woodcock.h`, which documents every function for those who call it:
//! free flights, transmittance, phase functions, and majorant grids over the caller's memory. No heap, no operating system.
//!
//! Every function checks what it is given (null, alignment, lengths, ranges, whether a grid was opened), answers with a
//! [`Status`], and writes its results only where that is [`Status::Ok`]. None can panic, which `.ci/run no-panic` reads in
//! the machine code, so nothing can unwind into the caller. Results are those of the core, bit by bit.
#![no_std]
#![allow(
    unsafe_code,
    reason = "callers of C hand over pointers, which somebody has to believe"
)]

mod field;
mod grid;
mod phase;
mod pointer;
mod status;
mod stream;

pub use field::{Extinction, woodcock_field_flight, woodcock_field_transmittance};
pub use field::{woodcock_fog_flight, woodcock_fog_transmittance};
pub use grid::{OpaqueGrid, OpaqueWalk, Segment};
pub use grid::{woodcock_fill_majorants, woodcock_majorant_count, woodcock_open_grid};
pub use grid::{woodcock_grid_flight, woodcock_grid_transmittance};
pub use grid::{woodcock_walk_begin, woodcock_walk_extinction, woodcock_walk_next};
pub use phase::{Scattered, woodcock_phase_eval, woodcock_phase_sample};
pub use status::{Status, woodcock_error_text};
pub use stream::{Key, OpaqueStream};
pub use stream::{woodcock_exponential, woodcock_stream_begin, woodcock_uniform};

use woodcock_core::majorant::WORK_LIMIT;
use woodcock_core::ray;
use woodcock_core::vec3::Vec3;

/// `woodcock_ray`: a part of a half-line.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Ray {
    /// Where it begins \[length\].
    pub origin: [f32; 3],
    /// Unit direction.
    pub direction: [f32; 3],
    /// How long it is \[length\]; may be infinite.
    pub t_max: f32,
}

/// `woodcock_flight`: how far a flight went.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Flight {
    /// The distance to the collision, or the ray's length \[length\].
    pub t: f32,
    /// One where it ended in a collision, else zero.
    pub collided: u32,
}

impl Ray {
    /// The ray as the core knows it, if it is one.
    fn checked(&self) -> Result<ray::Ray<f32>, Status> {
        let (origin, direction) = (Vec3::splat(self.origin), unit(self.direction)?);
        let finite = self.origin.iter().all(|x| x.is_finite());
        if finite && self.t_max >= 0.0 {
            Ok(ray::Ray { origin, direction })
        } else {
            Err(Status::Ray)
        }
    }
}

/// A direction of unit length, to a part in ten thousand.
fn unit(direction: [f32; 3]) -> Result<Vec3<f32>, Status> {
    let direction = Vec3::splat(direction);
    let square: f32 = direction.dot(direction);
    if (square - 1.0).abs() <= 2e-4 {
        Ok(direction)
    } else {
        Err(Status::Ray)
    }
}

/// Whether so many tentative collisions can be waited for; not, where the number is none.
fn affordable(expected: f32) -> Result<(), Status> {
    if expected <= WORK_LIMIT {
        Ok(())
    } else {
        Err(Status::Work)
    }
}

/// Without an operating system somebody has to say what a panic does. Nothing here can, so this is never linked.
#[cfg(all(panic = "abort", not(test)))]
#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    loop {}
}
