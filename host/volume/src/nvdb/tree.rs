//! From NanoVDB's tree, whose nodes name their children by offsets, to one whose children lie side by side.

use super::grid::HEADER;
use super::layout::{GridType, Layout};
use crate::vdb::VdbError;
use crate::vdb::bytes::Budget;
use crate::vdb::tree::{Internal, LEAF_VOXELS, RootEntry, Tree};
use crate::vdb::tree_read::node;
use crate::vdb::values::{Voxel, bit, count};
use crate::vdb::voxels::{Typed, Voxels};

/// log₂ of the entries of an upper and of a lower node.
const UPPER: u32 = 15;
const LOWER: u32 = 12;
/// Of a node's value mask, behind its box and flags \[bytes\].
const MASKS: usize = 32;
/// Of a leaf's value mask \[bytes\].
const LEAF_MASK: usize = 16;

/// How leaves hold their values.
#[derive(Clone, Copy)]
enum Leaves {
    Plain,
    Quantised(u32),
    QuantisedByLeaf,
}

/// Reads the values of a grid from its unpacked bytes.
pub(super) fn read(
    bytes: &[u8],
    grid_type: GridType,
    budget: &mut Budget,
) -> Result<Voxels, VdbError> {
    let float = Layout::new(4, 4, 4);
    let plain = Leaves::Plain;
    let quantised = |leaves, budget: &mut Budget| {
        // A leaf's factors take the place of its statistics.
        convert::<f32>(bytes, float, leaves, budget).map(Typed::Float)
    };
    let typed = match grid_type {
        GridType::Float => Typed::Float(convert(bytes, float, plain, budget)?),
        GridType::Double => Typed::Double(convert(bytes, Layout::new(8, 8, 8), plain, budget)?),
        GridType::Int32 => Typed::Int32(convert(bytes, Layout::new(4, 4, 4), plain, budget)?),
        GridType::Int64 => Typed::Int64(convert(bytes, Layout::new(8, 8, 8), plain, budget)?),
        GridType::Vec3f => Typed::Vec3s(convert(bytes, Layout::new(12, 4, 4), plain, budget)?),
        GridType::Vec3d => Typed::Vec3d(convert(bytes, Layout::new(24, 8, 8), plain, budget)?),
        GridType::Half => Typed::Half(convert(bytes, Layout::new(2, 2, 4), plain, budget)?),
        GridType::Quantised { log2 } => quantised(Leaves::Quantised(log2), budget)?,
        GridType::QuantisedByLeaf => quantised(Leaves::QuantisedByLeaf, budget)?,
    };
    Ok(Voxels(typed))
}

/// A value that quantised leaves can have: floats only, for which they exist.
trait Dequantise: Voxel {
    fn of(value: f32) -> Option<Self>;
}

impl Dequantise for f32 {
    fn of(value: f32) -> Option<Self> {
        Some(value)
    }
}

macro_rules! never_quantised {
    ($($type:ty),*) => {
        $(impl Dequantise for $type {
            fn of(_: f32) -> Option<Self> {
                None
            }
        })*
    };
}
never_quantised!(f64, i32, i64, [f32; 3], [f64; 3], half::f16);

struct Reader<'a, T> {
    bytes: &'a [u8],
    layout: Layout,
    leaves: Leaves,
    /// Bytes of all nodes read so far: never more than there are.
    visited: u64,
    tree: Tree<T>,
}

fn convert<T: Dequantise>(
    bytes: &[u8],
    layout: Layout,
    leaves: Leaves,
    budget: &mut Budget,
) -> Result<Tree<T>, VdbError> {
    let mut reader = Reader {
        bytes,
        layout,
        leaves,
        visited: 0,
        tree: Tree {
            background: T::from_le(&[0; 24]),
            root: Vec::new(),
            upper: Vec::new(),
            lower: Vec::new(),
            leaf_masks: Vec::new(),
            leaf_values: Vec::new(),
        },
    };
    reader.root(budget)?;
    Ok(reader.tree)
}

impl<'a, T: Dequantise> Reader<'a, T> {
    fn damaged(offset: usize, what: impl Into<String>) -> VdbError {
        VdbError::Damaged {
            offset: offset as u64,
            what: what.into(),
        }
    }

    /// `count` bytes at an offset of the grid.
    fn at(&self, offset: usize, count: usize, what: &'static str) -> Result<&'a [u8], VdbError> {
        let end = offset.checked_add(count);
        end.and_then(|end| self.bytes.get(offset..end))
            .ok_or(VdbError::Truncated {
                what,
                offset: offset as u64,
                needed: count as u64,
                available: (self.bytes.len() as u64).saturating_sub(offset as u64),
            })
    }

    /// The offset that a signed distance from another leads to.
    fn jump(&self, from: usize, distance: i64, what: &'static str) -> Result<usize, VdbError> {
        let distance = isize::try_from(distance).ok();
        distance
            .and_then(|distance| from.checked_add_signed(distance))
            .filter(|to| *to >= HEADER && *to < self.bytes.len())
            .ok_or_else(|| Self::damaged(from, format!("{what} lies outside of the grid")))
    }

    fn i64_at(&self, offset: usize, what: &'static str) -> Result<i64, VdbError> {
        let mut word = [0; 8];
        word.copy_from_slice(self.at(offset, 8, what)?);
        Ok(i64::from_le_bytes(word))
    }

    fn u32_at(&self, offset: usize, what: &'static str) -> Result<u32, VdbError> {
        let mut word = [0; 4];
        word.copy_from_slice(self.at(offset, 4, what)?);
        Ok(u32::from_le_bytes(word))
    }

    /// Counts a node of `size` bytes at an offset. Together they cannot exceed the grid, unless some are named twice.
    fn visit(&mut self, offset: usize, size: usize, what: &'static str) -> Result<(), VdbError> {
        self.at(offset, size, what)?;
        self.visited += size as u64;
        if self.visited > self.bytes.len() as u64 {
            return Err(Self::damaged(
                offset,
                "a node is the child of several others",
            ));
        }
        Ok(())
    }

    fn root(&mut self, budget: &mut Budget) -> Result<(), VdbError> {
        const WHAT: &str = "the root node";
        let layout = self.layout;
        // Of the offsets of leaves, lower and upper nodes and the root only the last is needed.
        let root = self.jump(HEADER, self.i64_at(HEADER + 24, "the tree")?, WHAT)?;
        self.visit(root, layout.root, WHAT)?;
        let tiles = self.u32_at(root + 24, WHAT)? as usize;
        self.tree.background = T::from_le(self.at(root + layout.background, T::SIZE, WHAT)?);
        let table = root + layout.root;
        let size = tiles.checked_mul(layout.tile);
        let size = size.ok_or_else(|| Self::damaged(root, "the root has too many tiles"))?;
        self.visit(table, size, WHAT)?;
        budget.charge(
            tiles as u64 * size_of::<([i32; 3], RootEntry<T>)>() as u64,
            WHAT,
        )?;
        let mut children = Vec::new();
        for n in 0..tiles {
            let at = table + n * layout.tile;
            let key = self.i64_at(at, WHAT)?.cast_unsigned();
            // Twenty bits of each coordinate, the sign in the uppermost.
            let coordinate = |shift: u32| ((key >> shift) as u32) << 12;
            let key = [42, 21, 0].map(|shift| coordinate(shift).cast_signed() >> 12);
            let child = self.i64_at(at + 8, WHAT)?;
            if child == 0 {
                let active = self.u32_at(at + 16, WHAT)? != 0;
                let value = T::from_le(self.at(at + layout.tile_value, T::SIZE, WHAT)?);
                self.tree
                    .root
                    .push((key, RootEntry::Tile { value, active }));
            } else {
                children.push((key, self.jump(root, child, "an upper node")?));
            }
        }
        for (key, at) in children {
            let index = self.tree.upper.len();
            let upper = self.upper(at, budget)?;
            self.tree.upper.push(upper);
            self.tree.root.push((key, RootEntry::Child(index)));
        }
        self.tree.root.sort_unstable_by_key(|entry| entry.0);
        if self.tree.root.windows(2).any(|pair| pair[0].0 == pair[1].0) {
            return Err(Self::damaged(root, "two root entries have the same origin"));
        }
        Ok(())
    }

    /// Masks, tiles and the offsets of the children of an internal node.
    fn internal(
        &mut self,
        at: usize,
        log2: u32,
        table: usize,
        first_child: usize,
        budget: &mut Budget,
        what: &'static str,
    ) -> Result<(Internal<T>, Vec<usize>), VdbError> {
        let entries = 1_usize << log2;
        let layout = self.layout;
        self.visit(at, table + entries * layout.entry, what)?;
        let mask = |bytes: &[u8]| -> Vec<u64> {
            let word = |b: &[u8]| b.iter().rev().fold(0, |w, b| w << 8 | u64::from(*b));
            bytes.chunks_exact(8).map(word).collect()
        };
        let active = mask(self.at(at + MASKS, entries / 8, what)?);
        let children = mask(self.at(at + MASKS + entries / 8, entries / 8, what)?);
        budget.charge((entries / 8 * 3 + entries * size_of::<T>()) as u64, what)?;
        let mut tiles = vec![self.tree.background; entries];
        let mut offsets = Vec::with_capacity(count(&children));
        let values = self.at(at + table, entries * layout.entry, what)?;
        for (n, entry) in values.chunks_exact(layout.entry).enumerate() {
            if bit(&children, n) {
                let mut word = [0; 8];
                word.copy_from_slice(entry.get(..8).unwrap_or(&[0; 8]));
                offsets.push(self.jump(at, i64::from_le_bytes(word), "a child of a node")?);
            } else {
                tiles[n] = T::from_le(entry);
            }
        }
        let background = self.tree.background;
        let node = node(budget, children, active, tiles, background, first_child)?;
        Ok((node, offsets))
    }

    fn upper(&mut self, at: usize, budget: &mut Budget) -> Result<Internal<T>, VdbError> {
        let first = self.tree.lower.len();
        let table = self.layout.upper_table;
        let (node, lowers) = self.internal(at, UPPER, table, first, budget, "an upper node")?;
        for at in lowers {
            let first = self.tree.leaf_masks.len();
            let table = self.layout.lower_table;
            let (lower, leaves) = self.internal(at, LOWER, table, first, budget, "a lower node")?;
            self.tree.lower.push(lower);
            for at in leaves {
                self.leaf(at, budget)?;
            }
        }
        Ok(node)
    }

    fn leaf(&mut self, at: usize, budget: &mut Budget) -> Result<(), VdbError> {
        const WHAT: &str = "a leaf";
        let table = self.layout.leaf_table;
        let log2 = match self.leaves {
            Leaves::Plain => None,
            Leaves::Quantised(log2) => Some(log2),
            // In the upper bits of the leaf's flags, behind the box.
            Leaves::QuantisedByLeaf => Some(self.u32_at(at + 12, WHAT)? >> 29),
        };
        if let Some(log2) = log2.filter(|log2| *log2 > 4) {
            let what = format!("a leaf has 2^{log2} bits a value (16 are the most)");
            return Err(Self::damaged(at, what));
        }
        let size = log2.map_or(LEAF_VOXELS * T::SIZE, |log2| (LEAF_VOXELS << log2) / 8);
        self.visit(at, table + size, WHAT)?;
        budget.charge(64 + (LEAF_VOXELS * size_of::<T>()) as u64, WHAT)?;
        let mut mask = [0_u64; 8];
        for (n, word) in mask.iter_mut().enumerate() {
            *word = self.i64_at(at + LEAF_MASK + 8 * n, WHAT)?.cast_unsigned();
        }
        self.tree.leaf_masks.push(mask);
        let values = self.at(at + table, size, WHAT)?;
        let Some(log2) = log2 else {
            let values = values.chunks_exact(T::SIZE).map(T::from_le);
            self.tree.leaf_values.extend(values);
            return Ok(());
        };
        let least = f32::from_bits(self.u32_at(at + 80, WHAT)?);
        let quantum = f32::from_bits(self.u32_at(at + 84, WHAT)?);
        for n in 0..LEAF_VOXELS {
            let bits = n << log2;
            // Values of less than a byte lie in it from the lowest bit on; longer ones are two bytes.
            let low = values.get(bits / 8).copied().unwrap_or(0);
            let code = match log2 {
                4 => {
                    let high = values.get(bits / 8 + 1).copied().unwrap_or(0);
                    u16::from_le_bytes([low, high])
                }
                _ => u16::from(low >> (bits % 8)) & ((1 << (1_u32 << log2)) - 1),
            };
            let value = T::of(f32::from(code) * quantum + least);
            self.tree
                .leaf_values
                .push(value.unwrap_or(self.tree.background));
        }
        Ok(())
    }
}
