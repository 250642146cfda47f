//! A tree as cubes of 8³ voxels that need not lie where its leaves do: for who keeps volumes in cubes of their own.
//!
//! Nothing here takes time or memory for what a tree does not store, tiles apart.

use super::tree::{LEAF_VOXELS, LOWER, Tree, entry_origin};
use super::values::Voxel;
use super::visit::{self, Region, grow, visit};
use std::ops::ControlFlow;

/// Voxels along an edge of a leaf.
const EDGE: i64 = 8;

/// A box of voxels, both ends inclusive.
pub type Box3 = ([i64; 3], [i64; 3]);

/// Walks over all that is stored, over leaves on all threads.
///
/// * `empty`: a state to begin with; `tile`, `leaf`: take up a stored region; `join`: two states. The order is anyone's.
fn fold<T: Voxel, S: Send>(
    tree: &Tree<T>,
    empty: impl Fn() -> S + Send + Sync,
    mut tile: impl FnMut(&mut S, Box3, T),
    leaf: impl Fn(&mut S, Box3, &[T]) + Send + Sync,
    join: impl Fn(&mut S, S) + Send + Sync,
) -> S {
    let mut state = empty();
    let mut leaves = Vec::with_capacity(tree.leaf_masks.len());
    let around = |origin: [i64; 3], edge: i64| (origin, origin.map(|v| v + edge - 1));
    // The visitor never breaks, so neither does the visit.
    let _ = visit(tree, &mut |origin, region| {
        match region {
            Region::Tile { log2, value, .. } => tile(&mut state, around(origin, 1 << log2), value),
            Region::Leaf { values, .. } => leaves.push((origin, values)),
        }
        ControlFlow::Continue(())
    });
    let add = |mut state: S, (origin, values): &([i64; 3], &[T])| {
        leaf(&mut state, around(*origin, EDGE), values);
        state
    };
    #[cfg(feature = "rayon")]
    let rest = {
        use rayon::prelude::*;
        let parts = leaves.par_iter().with_min_len(256).fold(&empty, add);
        parts.reduce(&empty, |mut a, b| {
            join(&mut a, b);
            a
        })
    };
    #[cfg(not(feature = "rayon"))]
    let rest = leaves.iter().fold(empty(), add);
    join(&mut state, rest);
    state
}

/// The box of the stored values for which `counts` holds.
pub(super) fn bounds<T: Voxel>(
    tree: &Tree<T>,
    counts: impl Fn(T) -> bool + Send + Sync,
) -> Option<Box3> {
    let tile = |found: &mut Option<Box3>, (near, far): Box3, value| {
        if counts(value) {
            grow(found, near, far);
        }
    };
    let leaf = |found: &mut Option<Box3>, (near, far): Box3, values: &[T]| {
        // Most leaves lie within what is found already.
        let within = |(low, high): Box3| (0..3).all(|a| low[a] <= near[a] && far[a] <= high[a]);
        if found.is_some_and(within) {
            return;
        }
        for (n, value) in values.iter().enumerate() {
            if counts(*value) {
                let at = entry_origin(near, n, 0, 3);
                grow(found, at, at);
            }
        }
    };
    fold(
        tree,
        || None,
        tile,
        leaf,
        |found, more| {
            if let Some((near, far)) = more {
                grow(found, near, far);
            }
        },
    )
}

/// Whether all that is stored can be a density, as [`visit::first_invalid`] asks.
pub(super) fn all_valid<T: Voxel>(tree: &Tree<T>) -> bool {
    let valid = |value: T| visit::invalid(value).is_none();
    let whole = fold(
        tree,
        || true,
        |all, _, value| *all &= valid(value),
        // No early end, so that a leaf takes few instructions.
        |all, _, values| *all &= values.iter().fold(true, |all, value| all & valid(*value)),
        |all, rest| *all &= rest,
    );
    whole && valid(tree.background)
}

/// Marks the cubes of a lattice that a stored value lies in for which `counts` holds, and others that its leaf reaches into.
///
/// * `low`: the first voxel of the first cube. `cubes`: of them along x, y, z. `marks`: one for each, x fastest.
pub(super) fn mark<T: Voxel>(
    tree: &Tree<T>,
    low: [i64; 3],
    cubes: [u32; 3],
    counts: impl Fn(T) -> bool + Send + Sync,
    marks: &mut [bool],
) {
    let [nx, ny, _] = cubes.map(i64::from);
    let mut set = |(near, far): Box3| {
        let range = |a: usize| {
            let last = i64::from(cubes[a]) - 1;
            ((near[a] - low[a]) >> 3).max(0)..=((far[a] - low[a]) >> 3).min(last)
        };
        for z in range(2) {
            for y in range(1) {
                for x in range(0) {
                    if let Some(mark) = marks.get_mut(((z * ny + y) * nx + x) as usize) {
                        *mark = true;
                    }
                }
            }
        }
    };
    let tile = |_: &mut Vec<Box3>, place, value| {
        if counts(value) {
            set(place);
        }
    };
    let leaf = |found: &mut Vec<Box3>, place, values: &[T]| {
        if values.iter().any(|value| counts(*value)) {
            found.push(place);
        }
    };
    let found = fold(tree, Vec::new, tile, leaf, |found, more| found.extend(more));
    for place in found {
        set(place);
    }
}

/// The values of the cube at `low`, x fastest, up to the voxel `high`; zeros beyond.
pub(super) fn cube<T: Voxel>(
    tree: &Tree<T>,
    low: [i64; 3],
    high: [i64; 3],
    convert: impl Fn(T) -> f32,
) -> [f32; LEAF_VOXELS] {
    let mut out = [0.0; LEAF_VOXELS];
    let last: [i64; 3] = std::array::from_fn(|a| high[a].min(low[a] + EDGE - 1));
    // A cube has parts in two leaves along each axis, or in one.
    let parts = |a: usize| {
        let next = (low[a] | (EDGE - 1)) + 1;
        let parts = [(low[a], last[a].min(next - 1)), (next, last[a])];
        parts.into_iter().filter(|(from, to)| from <= to)
    };
    for (z0, z1) in parts(2) {
        for (y0, y1) in parts(1) {
            for (x0, x1) in parts(0) {
                let values = tree.leaf_at([x0, y0, z0]);
                for z in z0..=z1 {
                    for y in y0..=y1 {
                        let row = ((z - low[2]) << 6 | (y - low[1]) << 3) as usize;
                        let row =
                            &mut out[row + (x0 - low[0]) as usize..=row + (x1 - low[0]) as usize];
                        match values {
                            Ok(values) => {
                                let n = ((x0 & 7) << 6 | (y & 7) << 3 | (z & 7)) as usize;
                                for (slot, value) in
                                    row.iter_mut().zip(values[n..].iter().step_by(64))
                                {
                                    *slot = convert(*value);
                                }
                            }
                            Err(value) => row.fill(convert(value)),
                        }
                    }
                }
            }
        }
    }
    out
}

impl<T: Voxel> Tree<T> {
    /// The 512 values of the leaf around a voxel, or the one that they all have.
    fn leaf_at(&self, ijk: [i64; 3]) -> Result<&[T], T> {
        let found = self.find(ijk);
        if found.log2 >= LOWER {
            return Err(found.value);
        }
        Ok(self.leaf(found.leaf))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::vdb::tree::{Internal, RootEntry, Tiles};

    /// A node with children at some entries, and a tile of a value at another.
    fn node(entries: usize, child: usize, first_child: usize, tile: (usize, f32)) -> Internal<f32> {
        let mut children = vec![0_u64; entries / 64];
        children[child / 64] |= 1 << (child % 64);
        let mut rank = vec![0_u16; entries / 64];
        rank[child / 64 + 1..].fill(1);
        let mut tiles = vec![0.0; entries];
        tiles[tile.0] = tile.1;
        Internal {
            children: children.into(),
            active: vec![0; entries / 64].into(),
            first_child,
            rank: rank.into(),
            tiles: Tiles::Each(tiles.into()),
        }
    }

    /// A leaf at 8 (3, 4, 5), tiles of 8³ and 128³ beside it, and one of 4096³ on its other side.
    fn tree() -> Tree<f32> {
        let leaf = (3 * 16 + 4) * 16 + 5;
        let values = (0..512).map(|n| if n % 5 == 0 { 0.0 } else { n as f32 });
        Tree {
            background: 0.0,
            root: vec![
                (
                    [-1, 0, 0],
                    RootEntry::Tile {
                        value: 7.5,
                        active: false,
                    },
                ),
                ([0, 0, 0], RootEntry::Child(0)),
            ],
            upper: vec![node(1 << 15, 0, 0, (1, 9.5))],
            lower: vec![node(1 << 12, leaf, 0, (leaf + 1, 8.5))],
            leaf_masks: vec![[!0; 8]],
            leaf_values: values.collect(),
        }
    }

    #[test]
    fn cubes_hold_what_is_found_voxel_by_voxel() {
        let tree = tree();
        let mut matter = 0;
        for low in [
            [24, 32, 40],
            [21, 30, 43],
            [-4, -3, 125],
            [20, 36, 47],
            [27, 100, 500],
        ] {
            let high = low.map(|v: i64| v + 5);
            for (n, value) in cube(&tree, low, high, |v| v).into_iter().enumerate() {
                let at = [
                    low[0] + (n & 7) as i64,
                    low[1] + (n >> 3 & 7) as i64,
                    low[2] + (n >> 6) as i64,
                ];
                let beyond = (0..3).any(|a| at[a] > high[a]);
                let expected = if beyond { 0.0 } else { tree.find(at).value };
                assert_eq!(value, expected, "{at:?}");
                matter += u32::from(value > 0.0);
            }
        }
        assert!(matter > 100, "{matter}");
    }

    #[test]
    fn every_cube_with_matter_is_marked() {
        let tree = tree();
        let (low, cubes) = ([-13, 17, 22], [6, 5, 15]);
        let mut marks = vec![false; 6 * 5 * 15];
        mark(&tree, low, cubes, |v| v > 0.0, &mut marks);
        let mut marked = 0;
        for (n, mark) in (0..).zip(&marks) {
            let at = [n % 6, n / 6 % 5, n / 30];
            let first: [i64; 3] = std::array::from_fn(|a| low[a] + 8 * at[a]);
            let any = cube(&tree, first, [i64::MAX / 2; 3], |v| v)
                .iter()
                .any(|v| *v > 0.0);
            assert!(*mark || !any, "{first:?}");
            marked += u32::from(*mark);
        }
        assert!((1..marks.len() as u32).contains(&marked), "{marked}");
    }

    #[test]
    fn boxes_hold_what_counts() {
        let tree = tree();
        assert_eq!(
            bounds(&tree, |v| v == 8.5),
            Some(([24, 32, 48], [31, 39, 55]))
        );
        assert_eq!(
            bounds(&tree, |v| v == 9.5),
            Some(([0, 0, 128], [127, 127, 255]))
        );
        assert_eq!(
            bounds(&tree, |v| v == 7.5),
            Some(([-4096, 0, 0], [-1, 4095, 4095]))
        );
        // 511 is the last voxel of the leaf, 1 the second.
        assert_eq!(
            bounds(&tree, |v| v == 511.0),
            Some(([31, 39, 47], [31, 39, 47]))
        );
        assert_eq!(
            bounds(&tree, |v| v == 1.0),
            Some(([24, 32, 41], [24, 32, 41]))
        );
        assert_eq!(bounds(&tree, |v| v < 0.0), None);
        assert!(all_valid(&tree));
        let mut broken = tree;
        broken.leaf_values[300] = f32::NAN;
        assert!(!all_valid(&broken));
    }
}
