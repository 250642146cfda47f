//! OpenVDB files: an own reader, because volumes arrive as `.vdb` and a renderer must not fall over them.
//!
//! ```no_run
//! use woodcock_volume::{Limits, vdb};
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let file = vdb::read_grids(&std::fs::read("cloud.vdb")?, &Limits::default(), |name| name == "density")?;
//! for grid in &file.grids {
//!     println!("{}: {} active voxels", grid.name, grid.statistics()?.active_voxels);
//! }
//! # Ok(())
//! # }
//! ```
//!
//! * Read: format versions 222 to 225; 5-4-3 trees of float, double, half, int32, int64, bool, vec3s, vec3d, vec3i, also
//!   saved as half floats; chunks stored, zlib, blosc (LZ4, BloscLZ, zlib inside); every encoding of inactive values;
//!   instances; files from a stream; all linear transforms, and frustums for looking up values.
//! * Listed, with a reason: other grids (points, masks, other trees) and grids in a frustum, which cannot be rendered.
//! * Refused: what contradicts the format. A damaged grid fails the call that reads it; [`read_grids`] does not touch the
//!   grids that were not asked for.
//! * Cost: one pass over the bytes that are read. A tree is as sparse in memory as in the file, and what it takes is
//!   counted against [`Limits`] before it is allocated.
//!
//! Index (i, j, k) is the centre of a voxel, as in OpenVDB. Source: Museth 2013, "VDB: High-resolution sparse volumes with
//! dynamic topology"; the layout of the file is documented by OpenVDB's implementation only.

mod archive;
pub(crate) mod blosc;
mod blosclz;
pub(crate) mod bytes;
pub(crate) mod codec;
mod cubes;
mod error;
pub(crate) mod grid;
mod integral;
mod metadata;
pub(crate) mod transform;
pub(crate) mod tree;
pub(crate) mod tree_read;
pub(crate) mod values;
mod visit;
pub(crate) mod voxels;

pub use cubes::Box3;
pub use error::VdbError;
pub use grid::Grid;
pub use metadata::{MetaEntry, MetaValue, Metadata};
pub use transform::Transform;
pub use voxels::{InvalidValue, Statistics, Voxels};

use super::Limits;

/// The first bytes of every OpenVDB file.
pub const MAGIC: [u8; 8] = [0x20, 0x42, 0x44, 0x56, 0, 0, 0, 0];

/// An OpenVDB file.
#[derive(Debug, Clone)]
pub struct VdbFile {
    /// Format version.
    pub version: u32,
    /// Major and minor version of the library that wrote it.
    pub library: (u32, u32),
    /// The file's own metadata.
    pub metadata: Metadata,
    /// Its grids, sorted by name.
    pub grids: Vec<Grid>,
}

impl VdbFile {
    /// The first grid of that name.
    #[must_use]
    pub fn grid(&self, name: &str) -> Option<&Grid> {
        self.grids.iter().find(|grid| grid.name == name)
    }
}

/// Reads a file with all its grids.
///
/// # Errors
/// A [`VdbError`] that names what is wrong, the byte, and the grid: for what is no OpenVDB file, another format version,
/// bytes that contradict the format, and what exceeds `limits`. Never panics.
pub fn read(bytes: &[u8], limits: &Limits) -> Result<VdbFile, VdbError> {
    archive::read(bytes, limits, &|_| true)
}

/// Reads a file with those of its grids whose name `wanted` accepts; the others cost nothing and may be damaged (except
/// in files from a stream, where every grid must be read to find the next).
///
/// # Errors
/// As [`read`].
pub fn read_grids(
    bytes: &[u8],
    limits: &Limits,
    wanted: impl Fn(&str) -> bool,
) -> Result<VdbFile, VdbError> {
    archive::read(bytes, limits, &wanted)
}
