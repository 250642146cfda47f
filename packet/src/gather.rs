//! Table look-ups by lane: the one module with `unsafe`, for AVX2's gather.
//!
//! Indices beyond a table read its last entry, as finished lanes may ask for anything; an empty table
//! gives zero.
//!
//! Against eight bounds-checked loads the instruction saved a tenth of a cloud's rendering time (1015 and 915 ns
//! a path, medians of five interleaved runs on one thread of a noisy machine).
#![cfg_attr(
    all(target_arch = "x86_64", target_feature = "avx2"),
    expect(
        unsafe_code,
        reason = "the gather instruction takes a pointer; see `vector`"
    )
)]

use wide::u32x8;

use crate::lanes::{LaneWords, Lanes};

/// The index of the last entry, or `None` of an empty table.
#[inline(always)]
fn last<T>(table: &[T]) -> Option<u32> {
    let last = table.len().checked_sub(1)?;
    // Gathers read indices as signed.
    Some(last.min(i32::MAX as usize) as u32)
}

/// Numbers of a table.
#[inline(always)]
pub(crate) fn numbers(table: &[f32], index: LaneWords) -> Lanes {
    let Some(last) = last(table) else {
        return Lanes::default();
    };
    Lanes(vector::numbers(table, index.0.min(u32x8::splat(last))))
}

/// Words of a table.
#[inline(always)]
pub(crate) fn words(table: &[u32], index: LaneWords) -> LaneWords {
    let Some(last) = last(table) else {
        return LaneWords::default();
    };
    LaneWords(bytemuck::cast(vector::numbers(
        bytemuck::cast_slice(table),
        index.0.min(u32x8::splat(last)),
    )))
}

#[cfg(all(target_arch = "x86_64", target_feature = "avx2"))]
mod vector {
    use core::arch::x86_64::_mm256_i32gather_ps;
    use wide::{f32x8, u32x8};

    /// Every index must lie within the table, and below 2³¹.
    #[inline(always)]
    pub(super) fn numbers(table: &[f32], index: u32x8) -> f32x8 {
        // SAFETY: both callers clamp each index to that of the table's last entry, at most i32::MAX, so
        // each lane reads four bytes within `table`. The instruction needs AVX2, which this module is
        // compiled for only where the target has it.
        unsafe {
            bytemuck::cast(_mm256_i32gather_ps::<4>(
                table.as_ptr(),
                bytemuck::cast(index),
            ))
        }
    }
}

#[cfg(not(all(target_arch = "x86_64", target_feature = "avx2")))]
mod vector {
    use wide::{f32x8, u32x8};

    /// Every index must lie within the table.
    #[inline(always)]
    pub(super) fn numbers(table: &[f32], index: u32x8) -> f32x8 {
        let at = |i: u32| table.get(i as usize).copied().unwrap_or(0.0);
        f32x8::new(index.to_array().map(at))
    }
}
