//! The sparse tree: a sorted root over nodes of 32³, 16³ and 8³ entries. Tiles stay tiles.

use super::values::{Voxel, bit};

/// log₂ of the voxels along one side of an entry: of the root, of an upper node, of a lower node.
pub(crate) const ROOT: u32 = 12;
pub(crate) const UPPER: u32 = 7;
pub(crate) const LOWER: u32 = 3;
/// Voxels of a leaf.
pub(crate) const LEAF_VOXELS: usize = 512;

/// A node whose entries are tiles or children. Children of a node lie side by side, in the order of the mask's bits.
#[derive(Debug)]
pub(crate) struct Internal<T> {
    pub(crate) children: Box<[u64]>,
    /// Active tiles (never set where there is a child).
    pub(crate) active: Box<[u64]>,
    pub(crate) first_child: usize,
    /// Children before each word of the mask.
    pub(crate) rank: Box<[u16]>,
    pub(crate) tiles: Tiles<T>,
}

/// Tile values; most nodes have but one.
#[derive(Debug)]
pub(crate) enum Tiles<T> {
    Uniform(T),
    Each(Box<[T]>),
}

impl<T: Voxel> Internal<T> {
    pub(crate) fn tile(&self, n: usize) -> T {
        match &self.tiles {
            Tiles::Uniform(value) => *value,
            Tiles::Each(values) => values[n],
        }
    }

    pub(crate) fn child(&self, n: usize) -> Option<usize> {
        if !bit(&self.children, n) {
            return None;
        }
        let below = self.children[n >> 6] & ((1 << (n & 63)) - 1);
        Some(self.first_child + usize::from(self.rank[n >> 6]) + below.count_ones() as usize)
    }
}

#[derive(Debug)]
pub(crate) enum RootEntry<T> {
    Tile { value: T, active: bool },
    Child(usize),
}

/// All values of a grid.
#[derive(Debug)]
pub(crate) struct Tree<T> {
    pub(crate) background: T,
    /// Sorted by key = origin / 4096, without duplicates.
    pub(crate) root: Vec<([i32; 3], RootEntry<T>)>,
    pub(crate) upper: Vec<Internal<T>>,
    pub(crate) lower: Vec<Internal<T>>,
    pub(crate) leaf_masks: Vec<[u64; 8]>,
    /// 512 per leaf, z fastest.
    pub(crate) leaf_values: Vec<T>,
}

/// What the tree holds at a voxel.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Found<T> {
    pub(crate) value: T,
    pub(crate) active: bool,
    /// The value holds in the whole aligned cube of 2^log2 voxels a side (0: just this voxel).
    pub(crate) log2: u32,
    /// The leaf, where the value is a voxel's.
    pub(crate) leaf: usize,
}

/// Index of an entry in a node of 2^(3·bits) entries of side 2^log2.
fn entry(ijk: [i64; 3], log2: u32, bits: u32) -> usize {
    let mask = (1 << bits) - 1;
    let [i, j, k] = ijk.map(|v| ((v >> log2) & mask) as usize);
    i << (2 * bits) | j << bits | k
}

/// Origin of entry `n` of a node at `origin`: the inverse of [`entry`].
pub(crate) fn entry_origin(origin: [i64; 3], n: usize, log2: u32, bits: u32) -> [i64; 3] {
    let mask = (1_usize << bits) - 1;
    let local = [n >> (2 * bits), n >> bits & mask, n & mask];
    std::array::from_fn(|a| origin[a] + ((local[a] as i64) << log2))
}

pub(crate) fn root_origin(key: [i32; 3]) -> [i64; 3] {
    key.map(|v| i64::from(v) << ROOT)
}

impl<T: Voxel> Tree<T> {
    pub(crate) fn leaf(&self, n: usize) -> &[T] {
        &self.leaf_values[n * LEAF_VOXELS..(n + 1) * LEAF_VOXELS]
    }

    /// Voxel, tile or background at an index coordinate; any coordinate is in the domain.
    pub(crate) fn find(&self, ijk: [i64; 3]) -> Found<T> {
        let found = |value, active, log2| Found {
            value,
            active,
            log2,
            leaf: 0,
        };
        let outside = found(self.background, false, ROOT);
        let key = ijk.map(|v| v >> ROOT);
        let at = self
            .root
            .binary_search_by(|(probe, _)| probe.map(i64::from).cmp(&key));
        let Ok(at) = at else { return outside };
        let upper = match self.root[at].1 {
            RootEntry::Tile { value, active } => return found(value, active, ROOT),
            RootEntry::Child(n) => &self.upper[n],
        };
        let n = entry(ijk, UPPER, 5);
        let Some(child) = upper.child(n) else {
            return found(upper.tile(n), bit(&upper.active, n), UPPER);
        };
        let lower = &self.lower[child];
        let n = entry(ijk, LOWER, 4);
        let Some(child) = lower.child(n) else {
            return found(lower.tile(n), bit(&lower.active, n), LOWER);
        };
        let n = entry(ijk, 0, 3);
        Found {
            leaf: child,
            ..found(self.leaf(child)[n], bit(&self.leaf_masks[child], n), 0)
        }
    }
}
