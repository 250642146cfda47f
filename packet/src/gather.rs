//! Table look-ups by lane.
//!
//! Indices beyond a table read its last entry, as finished lanes may ask for anything; an empty table
//! gives zero.

use wide::u32x8;

use crate::lanes::{LANES, LaneWords, Lanes};

#[inline(always)]
fn gather<T: Copy + Default>(table: &[T], index: LaneWords) -> [T; LANES] {
    let last = table.len().saturating_sub(1).min(u32::MAX as usize) as u32;
    let index = index.0.min(u32x8::splat(last)).to_array();
    index.map(|i| table.get(i as usize).copied().unwrap_or_default())
}

/// Numbers of a table.
#[inline(always)]
pub(crate) fn numbers(table: &[f32], index: LaneWords) -> Lanes {
    Lanes::new(gather(table, index))
}

/// Words of a table.
#[inline(always)]
pub(crate) fn words(table: &[u32], index: LaneWords) -> LaneWords {
    LaneWords::new(gather(table, index))
}
