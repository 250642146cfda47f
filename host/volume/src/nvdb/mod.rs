//! NanoVDB files: an own reader. Its trees are OpenVDB's, laid out for look-ups, so grids come out as OpenVDB's do.
//!
//! * Read: versions 32.3 to 32.7; float, double, half, int32, int64, Vec3f and Vec3d, and floats quantised to 4, 8, 16 or
//!   a variable number of bits; stored, zip and blosc; any number of grids and segments; grids without a file header.
//! * Listed, with a reason: grids of other types (masks, indices, points, integers of other sizes).
//! * Refused: what contradicts the format. Offsets may lead anywhere in a damaged file: every access is checked, and no more
//!   nodes are read than the grid's bytes can hold, so nothing is read twice without end.
//! * Cost: a grid is unpacked whole, then rebuilt; both are counted against [`Limits`](crate::Limits).
//!
//! Index (i, j, k) is the centre of a voxel. Source: [Museth 2021]; the layout is documented by NanoVDB's implementation only.

mod file;
mod grid;
mod layout;
mod tree;

pub use file::{NanoVdbFile, read, read_grids};

/// The first seven bytes of every NanoVDB file; a digit follows.
pub const MAGIC: [u8; 7] = *b"NanoVDB";
