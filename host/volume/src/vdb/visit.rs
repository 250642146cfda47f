//! Walks over everything a tree stores: statistics, unusable values, dense boxes.

use super::bytes::filled;
use super::tree::{LEAF_VOXELS, LOWER, ROOT, RootEntry, Tree, UPPER, entry_origin, root_origin};
use super::values::{Voxel, bit};
use super::{InvalidValue, Statistics, VdbError};
use crate::Limits;
use std::ops::ControlFlow;

/// A stored part of a tree. Inactive tiles of the background's value are not stored.
pub(super) enum Region<'a, T> {
    Tile { log2: u32, value: T, active: bool },
    Leaf { mask: &'a [u64; 8], values: &'a [T] },
}

pub(super) type Visit<'v, 't, T> = dyn FnMut([i64; 3], Region<'t, T>) -> ControlFlow<()> + 'v;

pub(super) fn visit<'t, T: Voxel>(tree: &'t Tree<T>, f: &mut Visit<'_, 't, T>) -> ControlFlow<()> {
    for (key, entry) in &tree.root {
        let origin = root_origin(*key);
        match *entry {
            RootEntry::Tile { value, active } => tile(tree, origin, ROOT, value, active, f)?,
            RootEntry::Child(child) => visit_upper(tree, child, origin, f)?,
        }
    }
    ControlFlow::Continue(())
}

fn tile<'t, T: Voxel>(
    tree: &'t Tree<T>,
    origin: [i64; 3],
    log2: u32,
    value: T,
    active: bool,
    f: &mut Visit<'_, 't, T>,
) -> ControlFlow<()> {
    if !active && value.same(tree.background) {
        return ControlFlow::Continue(());
    }
    let region = Region::Tile {
        log2,
        value,
        active,
    };
    f(origin, region)
}

fn visit_upper<'t, T: Voxel>(
    tree: &'t Tree<T>,
    upper: usize,
    origin: [i64; 3],
    f: &mut Visit<'_, 't, T>,
) -> ControlFlow<()> {
    let node = &tree.upper[upper];
    for n in 0..1 << 15 {
        let origin = entry_origin(origin, n, UPPER, 5);
        match node.child(n) {
            Some(child) => visit_lower(tree, child, origin, f)?,
            None => tile(tree, origin, UPPER, node.tile(n), bit(&node.active, n), f)?,
        }
    }
    ControlFlow::Continue(())
}

fn visit_lower<'t, T: Voxel>(
    tree: &'t Tree<T>,
    lower: usize,
    origin: [i64; 3],
    f: &mut Visit<'_, 't, T>,
) -> ControlFlow<()> {
    let node = &tree.lower[lower];
    for n in 0..1 << 12 {
        let origin = entry_origin(origin, n, LOWER, 4);
        let Some(child) = node.child(n) else {
            tile(tree, origin, LOWER, node.tile(n), bit(&node.active, n), f)?;
            continue;
        };
        let leaf = Region::Leaf {
            mask: &tree.leaf_masks[child],
            values: tree.leaf(child),
        };
        f(origin, leaf)?;
    }
    ControlFlow::Continue(())
}

/// A box of voxels that grows, both ends inclusive.
pub(super) fn grow(bounds: &mut Option<([i64; 3], [i64; 3])>, min: [i64; 3], max: [i64; 3]) {
    let (low, high) = bounds.get_or_insert((min, max));
    for a in 0..3 {
        low[a] = low[a].min(min[a]);
        high[a] = high[a].max(max[a]);
    }
}

pub(super) fn statistics<T: Voxel>(tree: &Tree<T>) -> Statistics {
    let mut s = Statistics {
        active_voxels: 0,
        active_tiles: 0,
        leaf_nodes: tree.leaf_masks.len() as u64,
        active_bbox: None,
        stored_bbox: None,
        min: [f64::INFINITY; 3],
        max: [f64::NEG_INFINITY; 3],
        sum: [0.0; 3],
    };
    let add = |s: &mut Statistics, value: T, voxels: u64| {
        s.active_voxels = s.active_voxels.saturating_add(voxels);
        for n in 0..T::COMPONENTS {
            let v = value.component(n);
            s.min[n] = s.min[n].min(v);
            s.max[n] = s.max[n].max(v);
            s.sum[n] += v * voxels as f64;
        }
    };
    // The visitor never breaks, so neither does the visit.
    let _ = visit(tree, &mut |origin, region| {
        match region {
            Region::Tile {
                log2,
                value,
                active,
            } => {
                let max = origin.map(|v| v + (1 << log2) - 1);
                if active {
                    s.active_tiles += 1;
                    add(&mut s, value, 1 << (3 * log2));
                    grow(&mut s.active_bbox, origin, max);
                }
                if !value.same(tree.background) {
                    grow(&mut s.stored_bbox, origin, max);
                }
            }
            Region::Leaf { mask, values } => {
                for (n, &value) in values.iter().enumerate() {
                    let at = entry_origin(origin, n, 0, 3);
                    if bit(mask, n) {
                        add(&mut s, value, 1);
                        grow(&mut s.active_bbox, at, at);
                    }
                    if !value.same(tree.background) {
                        grow(&mut s.stored_bbox, at, at);
                    }
                }
            }
        }
        ControlFlow::Continue(())
    });
    // A scalar speaks for all three components.
    for n in T::COMPONENTS..3 {
        (s.min[n], s.max[n], s.sum[n]) = (s.min[0], s.max[0], s.sum[0]);
    }
    s
}

/// The first component that is no extinction: NaN, infinite or negative.
pub(super) fn invalid<T: Voxel>(value: T) -> Option<f64> {
    (0..T::COMPONENTS)
        .map(|n| value.component(n))
        .find(|v| !v.is_finite() || *v < 0.0)
}

pub(super) fn first_invalid<T: Voxel>(tree: &Tree<T>) -> Option<InvalidValue> {
    if let Some(value) = invalid(tree.background) {
        return Some(InvalidValue { voxel: None, value });
    }
    let mut found = None;
    let _ = visit(tree, &mut |origin, region| {
        let hit = match region {
            Region::Tile { value, .. } => invalid(value).map(|value| (origin, value)),
            Region::Leaf { values, .. } => values.iter().enumerate().find_map(|(n, value)| {
                invalid(*value).map(|value| (entry_origin(origin, n, 0, 3), value))
            }),
        };
        let Some((at, value)) = hit else {
            return ControlFlow::Continue(());
        };
        found = Some(InvalidValue {
            voxel: Some(at),
            value,
        });
        ControlFlow::Break(())
    });
    found
}

/// The values in the box from `min` to `max` (inclusive), x fastest.
pub(super) fn dense<T: Voxel, U: Copy>(
    tree: &Tree<T>,
    min: [i64; 3],
    max: [i64; 3],
    limits: &Limits,
    convert: impl Fn(T) -> U,
) -> Result<Vec<U>, VdbError> {
    let size: [u128; 3] = std::array::from_fn(|a| {
        u128::try_from(i128::from(max[a]) - i128::from(min[a]) + 1).unwrap_or(0)
    });
    // Below 2^65 each, so the first product fits; the rest saturates.
    let voxels = (size[0] * size[1].min(1 << 62)).saturating_mul(size[2]);
    let needed = voxels.saturating_mul(size_of::<U>() as u128);
    const WHAT: &str = "a dense copy of the grid";
    if needed > u128::from(limits.max_memory) {
        return Err(VdbError::Memory {
            what: WHAT,
            needed: u64::try_from(needed).unwrap_or(u64::MAX),
            limit: limits.max_memory,
        });
    }
    // At most `needed`, which fits the limit.
    let mut out = filled(convert(tree.background), voxels as u64, WHAT)?;
    if out.is_empty() {
        return Ok(out);
    }
    let [width, height] = [size[0] as usize, size[1] as usize];
    let index = |at: [i64; 3]| {
        let [x, y, z] = [0, 1, 2].map(|a| (at[a] - min[a]) as usize);
        (z * height + y) * width + x
    };
    let _ = visit(tree, &mut |origin, region| {
        let side = match &region {
            Region::Tile { log2, .. } => 1_i64 << log2,
            Region::Leaf { .. } => 8,
        };
        let low: [i64; 3] = std::array::from_fn(|a| origin[a].max(min[a]));
        let high: [i64; 3] = std::array::from_fn(|a| (origin[a] + side - 1).min(max[a]));
        if (0..3).any(|a| low[a] > high[a]) {
            return ControlFlow::Continue(());
        }
        for z in low[2]..=high[2] {
            for y in low[1]..=high[1] {
                let start = index([low[0], y, z]);
                let row = &mut out[start..=start + (high[0] - low[0]) as usize];
                match &region {
                    Region::Tile { value, .. } => row.fill(convert(*value)),
                    Region::Leaf { values, .. } => {
                        let n = ((y - origin[1]) << 3 | (z - origin[2])) as usize;
                        let x = ((low[0] - origin[0]) << 6) as usize;
                        let column = values[..LEAF_VOXELS].iter().skip(n + x).step_by(64);
                        for (slot, value) in row.iter_mut().zip(column) {
                            *slot = convert(*value);
                        }
                    }
                }
            }
        }
        ControlFlow::Continue(())
    });
    Ok(out)
}
