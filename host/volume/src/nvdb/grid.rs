//! One grid: its header, how it lies in the world, and its tree.

use glam::{DAffine3, DMat3, DVec3};
use std::sync::Arc;

use super::file::{checked_version, text};
use super::layout::{GridType, type_name};
use super::tree;
use crate::vdb::bytes::Budget;
use crate::vdb::{Grid, MetaEntry, MetaValue, Metadata, Transform, VdbError};

/// Bytes of a grid's header; its tree follows.
pub(super) const HEADER: usize = 672;

/// The header of a grid.
pub(super) struct Header {
    pub(super) version: [u32; 3],
    /// Bytes of the whole grid.
    pub(super) size: u64,
    pub(super) name: String,
    pub(super) grid_type: u32,
    class: u32,
    index_to_world: DAffine3,
}

/// A grid, and what its own header says of it.
pub(super) struct Read {
    pub(super) grid: Grid,
    pub(super) grid_type: u32,
    pub(super) size: u64,
}

fn word<const N: usize>(bytes: &[u8], at: usize) -> [u8; N] {
    let mut out = [0; N];
    if let Some(from) = bytes.get(at..at + N) {
        out.copy_from_slice(from);
    }
    out
}

impl Header {
    /// * `bytes`: at least [`HEADER`] of them, or they are truncated.
    pub(super) fn read(bytes: &[u8]) -> Result<Self, VdbError> {
        if bytes.len() < HEADER {
            return Err(VdbError::Truncated {
                what: "the header of a grid",
                offset: 0,
                needed: HEADER as u64,
                available: bytes.len() as u64,
            });
        }
        let u32_at = |at| u32::from_le_bytes(word(bytes, at));
        let f64_at = |at| f64::from_le_bytes(word(bytes, at));
        if !matches!(&word(bytes, 0), b"NanoVDB0" | b"NanoVDB1") {
            return Err(VdbError::Damaged {
                offset: 0,
                what: "the grid does not begin with NanoVDB's magic number".to_owned(),
            });
        }
        // Rows of the matrix in double precision, behind its twins in single precision.
        let row =
            |r: usize| DVec3::from_array(std::array::from_fn(|c| f64_at(384 + 24 * r + 8 * c)));
        let matrix = DMat3::from_cols(row(0), row(1), row(2)).transpose();
        Ok(Self {
            version: checked_version(u32_at(16))?,
            size: u64::from_le_bytes(word(bytes, 32)),
            name: text(bytes.get(40..296).unwrap_or_default()),
            class: u32_at(632),
            grid_type: u32_at(636),
            index_to_world: DAffine3 {
                matrix3: matrix,
                translation: DVec3::new(f64_at(528), f64_at(536), f64_at(544)),
            },
        })
    }
}

/// OpenVDB's name of a class of grids, and NanoVDB's own where that has none.
fn class(id: u32) -> &'static str {
    match id {
        1 => "level set",
        2 => "fog volume",
        3 => "staggered",
        4 => "point index",
        5 => "point data",
        6 => "topology",
        7 => "voxel volume",
        8 => "index grid",
        9 => "tensor grid",
        _ => "unknown",
    }
}

/// Reads a grid from its unpacked bytes. Offsets in errors are within them.
pub(super) fn read(
    bytes: &[u8],
    budget: &mut Budget,
    name: &str,
    codec: &str,
) -> Result<Read, VdbError> {
    let header = Header::read(bytes)?;
    let damaged = |what: &str| VdbError::Damaged {
        offset: 0,
        what: what.to_owned(),
    };
    let transform = Transform::of_affine("Map", header.index_to_world)
        .ok_or_else(|| damaged("the transform is singular or not finite"))?;
    let (voxels, reason) = match GridType::of(header.grid_type) {
        Some(grid_type) => (Some(Arc::new(tree::read(bytes, grid_type, budget)?)), None),
        None => (
            None,
            Some(format!(
                "grids of type `{}` are not supported (float, double, half, int32, int64, Vec3f, Vec3d and quantised floats \
                 are)",
                type_name(header.grid_type)
            )),
        ),
    };
    let entry = |value: String| MetaEntry {
        type_name: "string".to_owned(),
        value: MetaValue::Text(value),
    };
    let [major, minor, patch] = header.version;
    let metadata = Metadata::from([
        ("class".to_owned(), entry(class(header.class).to_owned())),
        ("codec".to_owned(), entry(codec.to_owned())),
        (
            "version".to_owned(),
            entry(format!("{major}.{minor}.{patch}")),
        ),
    ]);
    Ok(Read {
        grid_type: header.grid_type,
        size: header.size,
        grid: Grid {
            name: name.to_owned(),
            unique_name: name.to_owned(),
            type_name: type_name(header.grid_type).to_owned(),
            instance_of: None,
            half: false,
            metadata,
            transform,
            voxels,
            reason,
        },
    })
}
