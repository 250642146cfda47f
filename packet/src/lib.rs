//! # woodcock-packet
//!
//! `woodcock-core` eight lanes wide, or sixteen. The crate has no formula of its own: it supplies lanes that the
//! core's generic code runs on, streams for them, and the scheduling that keeps them full.
//!
//! - [`lanes`]: eight numbers, words and truths over `wide`.
//! - [`both`]: two vectors of eight side by side, which whole paths run in.
//! - [`bits`]: the core's random streams, one per lane.
//! - [`bundle`]: free flights and transmittance over bundles of rays, with refill.
//! - [`room`]: paths in rooms.
//! - [`trace`]: whole paths, with refill from a list of pixels and samples.
//!
//! Results have the bits of the scalar code, whatever lane a path lies in and whatever lies beside it.
#![no_std]

extern crate alloc;

pub mod bits;
pub mod both;
pub mod bundle;
mod gather;
pub mod lanes;
mod queue;
pub mod room;
pub mod trace;
