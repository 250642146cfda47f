//! Reading a tree: first the topology of all nodes, then the values of all leaves in the same order.

use super::VdbError;
use super::bytes::{Budget, Cursor, filled};
use super::tree::{Internal, LEAF_VOXELS, ROOT, RootEntry, Tiles, Tree};
use super::values::{ValueReader, Voxel, count, read_mask};

const UPPER_ENTRIES: usize = 1 << 15;
const LOWER_ENTRIES: usize = 1 << 12;

/// Reads a tree; the cursor stands behind its last leaf afterwards.
pub(crate) fn read<T: Voxel>(
    cursor: &mut Cursor<'_>,
    budget: &mut Budget,
    values: &mut ValueReader,
) -> Result<Tree<T>, VdbError> {
    let buffers = cursor.u32("the tree's buffer count")?;
    if buffers != 1 {
        return Err(cursor.damaged(format!("the tree has {buffers} buffers (1 is possible)")));
    }
    let background = T::from_le(cursor.take(T::SIZE, "the background value")?);
    let tiles = cursor.u32("the root's tile count")?;
    let children = cursor.u32("the root's child count")?;
    // A tile takes its origin, value and state; a child its origin, two masks and a byte at least.
    let tile_bytes = 12 + T::SIZE as u64 + 1;
    let child_bytes = 12 + 2 * (UPPER_ENTRIES as u64 / 8) + 1;
    let needed = u64::from(tiles) * tile_bytes + u64::from(children) * child_bytes;
    cursor.need(needed, "the root node")?;
    let entry_bytes = size_of::<([i32; 3], RootEntry<T>)>() as u64;
    let entries = u64::from(tiles) + u64::from(children);
    budget.charge(entries * entry_bytes, "the root node")?;

    let mut tree = Tree {
        background,
        root: Vec::new(),
        upper: Vec::new(),
        lower: Vec::new(),
        leaf_masks: Vec::new(),
        leaf_values: Vec::new(),
    };
    for _ in 0..tiles {
        let key = root_key(cursor)?;
        let value = T::from_le(cursor.take(T::SIZE, "a root tile")?);
        let active = cursor.u8("a root tile")? != 0;
        tree.root.push((key, RootEntry::Tile { value, active }));
    }
    for _ in 0..children {
        let key = root_key(cursor)?;
        let upper = upper(cursor, budget, values, &mut tree)?;
        tree.root.push((key, RootEntry::Child(tree.upper.len())));
        tree.upper.push(upper);
    }
    tree.root.sort_unstable_by_key(|entry| entry.0);
    if tree.root.windows(2).any(|pair| pair[0].0 == pair[1].0) {
        return Err(cursor.damaged("two root entries have the same origin"));
    }
    leaves(cursor, budget, values, &mut tree)?;
    Ok(tree)
}

fn root_key(cursor: &mut Cursor<'_>) -> Result<[i32; 3], VdbError> {
    let origin = cursor.i32x3("the origin of a root entry")?;
    if origin.iter().any(|v| v & ((1 << ROOT) - 1) != 0) {
        return Err(cursor.damaged(format!(
            "the origin {origin:?} of a root entry is not a multiple of 4096"
        )));
    }
    Ok(origin.map(|v| v >> ROOT))
}

/// The masks and tiles of a node; its children follow in the file.
fn internal<T: Voxel>(
    cursor: &mut Cursor<'_>,
    budget: &mut Budget,
    values: &mut ValueReader,
    entries: usize,
    background: T,
    first_child: usize,
) -> Result<Internal<T>, VdbError> {
    let mut children = Vec::new();
    let mut active = Vec::new();
    read_mask(cursor, entries, &mut children)?;
    read_mask(cursor, entries, &mut active)?;
    let masks = (entries / 8 * 2 + entries / 64 * 2 + size_of::<Internal<T>>()) as u64;
    budget.charge(masks, "a tree node")?;

    let mut tiles = vec![background; entries];
    values.read(cursor, &active, background, &mut tiles)?;
    node(budget, children, active, tiles, background, first_child)
}

/// A node of masks and tiles; what lies at a child's place counts neither as a tile nor as active.
pub(crate) fn node<T: Voxel>(
    budget: &mut Budget,
    children: Vec<u64>,
    mut active: Vec<u64>,
    tiles: Vec<T>,
    background: T,
    first_child: usize,
) -> Result<Internal<T>, VdbError> {
    let entries = tiles.len();
    for (active, children) in active.iter_mut().zip(&children) {
        *active &= !children;
    }
    let mut before = 0_u16;
    let rank = children.iter().map(|word: &u64| {
        let rank = before;
        // Wraps only behind the last word of a node without a single tile.
        before = before.wrapping_add(word.count_ones() as u16);
        rank
    });
    let rank = rank.collect();
    let is_child = |n: usize| children[n >> 6] >> (n & 63) & 1 != 0;
    let mut own = (0..entries).filter(|&n| !is_child(n)).map(|n| tiles[n]);
    let first = own.next().unwrap_or(background);
    let tiles = if own.all(|value| value.same(first)) {
        Tiles::Uniform(first)
    } else {
        budget.charge((entries * size_of::<T>()) as u64, "the tiles of a node")?;
        Tiles::Each(tiles.into_boxed_slice())
    };
    Ok(Internal {
        children: children.into_boxed_slice(),
        active: active.into_boxed_slice(),
        first_child,
        rank,
        tiles,
    })
}

fn upper<T: Voxel>(
    cursor: &mut Cursor<'_>,
    budget: &mut Budget,
    values: &mut ValueReader,
    tree: &mut Tree<T>,
) -> Result<Internal<T>, VdbError> {
    let background = tree.background;
    let first = tree.lower.len();
    let node = internal(cursor, budget, values, UPPER_ENTRIES, background, first)?;
    for _ in 0..count(&node.children) {
        let first = tree.leaf_masks.len();
        let lower = internal(cursor, budget, values, LOWER_ENTRIES, background, first)?;
        let leaves = count(&lower.children);
        tree.lower.push(lower);
        let mut mask = Vec::new();
        for _ in 0..leaves {
            read_mask(cursor, LEAF_VOXELS, &mut mask)?;
            budget.charge(64, "a leaf's mask")?;
            let mut leaf_mask = [0; 8];
            leaf_mask.copy_from_slice(&mask);
            tree.leaf_masks.push(leaf_mask);
        }
    }
    Ok(node)
}

/// Leaves in a row that one thread unfolds.
const RUN: usize = 64;

/// Reads the values of all leaves: finds where each run of them lies first, then unfolds runs side by side.
fn leaves<T: Voxel>(
    cursor: &mut Cursor<'_>,
    budget: &mut Budget,
    values: &mut ValueReader,
    tree: &mut Tree<T>,
) -> Result<(), VdbError> {
    let leaves = tree.leaf_masks.len();
    // Every leaf repeats its mask and has a byte on top, however well it is packed.
    cursor.need(leaves as u64 * 65, "the leaves")?;
    let total = leaves as u64 * LEAF_VOXELS as u64;
    budget.charge(total * size_of::<T>() as u64, "the leaves")?;
    let background = tree.background;
    // What is wrong with a leaf is told of the first one, whether its place or its content shows it.
    let (runs, place) = runs(cursor, values, background, leaves);
    let mut unfolded = filled(background, total, "the leaves")?;
    let work = |slots: &mut [T], masks: &mut [[u64; 8]], mut run: Cursor<'_>| {
        let mut reader = values.clone();
        let mut mask = Vec::new();
        for (slot, leaf_mask) in slots.chunks_exact_mut(LEAF_VOXELS).zip(masks) {
            read_mask(&mut run, LEAF_VOXELS, &mut mask)?;
            leaf_mask.copy_from_slice(&mask);
            T::read_leaf(&mut run, &mut reader, &mask, background, slot)?;
        }
        Ok(())
    };
    let voxels = RUN * LEAF_VOXELS;
    #[cfg(feature = "rayon")]
    let content = {
        use rayon::prelude::*;
        let slots = unfolded.par_chunks_mut(voxels);
        let pieces = slots.zip(tree.leaf_masks.par_chunks_mut(RUN)).zip(runs);
        let done: Vec<_> = pieces
            .map(|((slots, masks), run)| work(slots, masks, run))
            .collect();
        done.into_iter().collect::<Result<(), _>>()
    };
    #[cfg(not(feature = "rayon"))]
    let content = {
        let slots = unfolded.chunks_mut(voxels);
        let mut pieces = slots.zip(tree.leaf_masks.chunks_mut(RUN)).zip(runs);
        pieces.try_for_each(|((slots, masks), run)| work(slots, masks, run))
    };
    content.and(place)?;
    tree.leaf_values = unfolded;
    Ok(())
}

/// Cursors at the first leaf of each run, up to the first leaf whose end is not found, and why it is not.
fn runs<'a, T: Voxel>(
    cursor: &mut Cursor<'a>,
    values: &mut ValueReader,
    background: T,
    leaves: usize,
) -> (Vec<Cursor<'a>>, Result<(), VdbError>) {
    let mut runs = Vec::new();
    let mut mask = Vec::new();
    for leaf in 0..leaves {
        if leaf.is_multiple_of(RUN) {
            runs.push(cursor.clone());
        }
        let skipped = read_mask(cursor, LEAF_VOXELS, &mut mask)
            .and_then(|()| T::skip_leaf(cursor, values, &mask, background, LEAF_VOXELS));
        if skipped.is_err() {
            return (runs, skipped);
        }
    }
    (runs, Ok(()))
}
