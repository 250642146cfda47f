//! The table of results as a WebAssembly module: its hash in scalar code, in eight lanes and in sixteen.
//!
//! `.ci/run wasm` builds it with and without simd128, and `run.mjs` beside this file runs it under Node.
#![cfg_attr(target_family = "wasm", no_std)]
#![allow(
    unsafe_code,
    reason = "names for other languages, and an allocator where there is no system"
)]

use woodcock_core::stream::PathStream;
use woodcock_packet::bits::LaneStream;
use woodcock_packet::both::{Both, Wide};
use woodcock_packet::lanes::Lanes;

#[cfg(target_family = "wasm")]
mod bare;
#[allow(dead_code, reason = "the rows one by one are for others")]
#[path = "../../../core/examples/same_bits/table.rs"]
mod table;

/// What the hash is.
#[unsafe(no_mangle)]
pub extern "C" fn expected() -> u64 {
    table::HASH
}

/// What it is in scalar code.
#[unsafe(no_mangle)]
pub extern "C" fn scalar() -> u64 {
    table::hash::<f32, PathStream>()
}

/// What it is in eight lanes.
#[unsafe(no_mangle)]
pub extern "C" fn eight_lanes() -> u64 {
    table::hash::<Lanes, LaneStream>()
}

/// What it is in sixteen lanes.
#[unsafe(no_mangle)]
pub extern "C" fn sixteen_lanes() -> u64 {
    table::hash::<Wide, Both<LaneStream>>()
}
