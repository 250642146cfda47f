//! Where what lies in a node, by the type of the grid.
//!
//! Values are aligned to their own size, tables to 32 bytes; a table's entry is a value or the 64-bit offset of a child.

/// Types of grids that are read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum GridType {
    Float,
    Double,
    Int32,
    Int64,
    Vec3f,
    Vec3d,
    Half,
    /// Floats in leaves of 2^log2 bits a value.
    Quantised {
        log2: u32,
    },
    /// Floats, each leaf with a width of its own.
    QuantisedByLeaf,
}

impl GridType {
    /// The type of an id, if it is read.
    pub(super) fn of(id: u32) -> Option<Self> {
        Some(match id {
            1 => Self::Float,
            2 => Self::Double,
            4 => Self::Int32,
            5 => Self::Int64,
            6 => Self::Vec3f,
            7 => Self::Vec3d,
            9 => Self::Half,
            13 => Self::Quantised { log2: 2 },
            14 => Self::Quantised { log2: 3 },
            15 => Self::Quantised { log2: 4 },
            16 => Self::QuantisedByLeaf,
            _ => return None,
        })
    }
}

/// NanoVDB's name of a type of grids.
pub(super) fn type_name(id: u32) -> &'static str {
    const NAMES: [&str; 27] = [
        "?",
        "float",
        "double",
        "int16",
        "int32",
        "int64",
        "Vec3f",
        "Vec3d",
        "Mask",
        "Half",
        "uint32",
        "bool",
        "RGBA8",
        "Float4",
        "Float8",
        "Float16",
        "FloatN",
        "Vec4f",
        "Vec4d",
        "Index",
        "OnIndex",
        "IndexMask",
        "OnIndexMask",
        "PointIndex",
        "Vec3u8",
        "Vec3u16",
        "uint8",
    ];
    NAMES.get(id as usize).copied().unwrap_or("?")
}

/// Offsets and sizes \[bytes\].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Layout {
    /// Of the background in the root, and the root's own size; its tiles follow.
    pub(super) background: usize,
    pub(super) root: usize,
    /// Of the value in a tile, and the tile's size.
    pub(super) tile_value: usize,
    pub(super) tile: usize,
    /// Size of an entry of an internal node's table.
    pub(super) entry: usize,
    /// Of the tables of upper and lower nodes.
    pub(super) upper_table: usize,
    pub(super) lower_table: usize,
    /// Of the values of a leaf.
    pub(super) leaf_table: usize,
}

fn aligned(at: usize, to: usize) -> usize {
    at.next_multiple_of(to)
}

impl Layout {
    /// The layout for values of `size` bytes made of numbers of `scalar` bytes, whose mean and deviation take
    /// `statistic` bytes each.
    pub(super) fn new(size: usize, scalar: usize, statistic: usize) -> Self {
        // Least value, greatest value, mean and deviation follow each other.
        let four = |at: usize| {
            let least = aligned(at, scalar);
            aligned(least + 2 * size, statistic) + 2 * statistic
        };
        let background = aligned(28, scalar);
        let tile_value = aligned(20, scalar);
        Self {
            background,
            root: aligned(four(background + size), 32),
            tile_value,
            tile: aligned(tile_value + size, 32),
            entry: aligned(size, 8),
            upper_table: aligned(four(8224), 32),
            lower_table: aligned(four(1056), 32),
            leaf_table: aligned(four(80), 32),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn layouts_are_nanovdbs() {
        let layout = |background, root, tile_value, tile, entry, tables: [usize; 3]| Layout {
            background,
            root,
            tile_value,
            tile,
            entry,
            upper_table: tables[0],
            lower_table: tables[1],
            leaf_table: tables[2],
        };
        // float and int32, double and int64, half, Vec3f, Vec3d.
        let float = layout(28, 64, 20, 32, 8, [8256, 1088, 96]);
        assert_eq!(Layout::new(4, 4, 4), float);
        let double = layout(32, 96, 24, 32, 8, [8256, 1088, 128]);
        assert_eq!(Layout::new(8, 8, 8), double);
        let half = layout(28, 64, 20, 32, 8, [8256, 1088, 96]);
        assert_eq!(Layout::new(2, 2, 4), half);
        let vec3f = layout(28, 96, 20, 32, 16, [8256, 1088, 128]);
        assert_eq!(Layout::new(12, 4, 4), vec3f);
        let vec3d = layout(32, 128, 24, 64, 24, [8288, 1120, 160]);
        assert_eq!(Layout::new(24, 8, 8), vec3d);
    }
}
