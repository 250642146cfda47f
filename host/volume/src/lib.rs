//! # woodcock-volume
//!
//! Volume files: OpenVDB ([`vdb`]), NanoVDB ([`nvdb`]) and Mitsuba's grids ([`vol`]), and the [`Density`] that each of them is to a
//! renderer.
//!
//! Readers take `&[u8]` and owe their caller one promise: whatever the bytes are, they end in a value or in an
//! error that says what is wrong and where. Sizes are checked against the bytes that are left before anything is
//! allocated, and [`Limits`] bounds what a file may unfold to.

#![forbid(unsafe_code)]

mod density;
#[cfg(feature = "nvdb")]
pub mod nvdb;
pub mod vdb;
pub mod vol;

pub use density::{CellBox, Density, Scalar, Stored, padded, rows};

/// What a volume file may cost.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Limits {
    /// Memory that one reading call may hold at once \[bytes\]; the file's own bytes are not counted.
    pub max_memory: u64,
}

impl Default for Limits {
    /// 8 GiB: more than any production volume we met, less than what makes a workstation swap.
    fn default() -> Self {
        Self {
            max_memory: 8 << 30,
        }
    }
}
