//! Chunks of node values: stored, zlib, or blosc. The tree says how many bytes a chunk unfolds to, never the chunk.

use super::VdbError;
use super::blosc;
use super::bytes::Cursor;
use flate2::{Decompress, FlushDecompress, Status};

/// How the values of a grid are packed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::volume) enum Codec {
    Stored,
    Zip,
    Blosc,
}

/// The compression flags that precede every grid.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::volume) struct Compression {
    pub(in crate::volume) codec: Codec,
    /// Inactive values are left out where they can be told from the masks.
    pub(in crate::volume) active_mask: bool,
}

impl Compression {
    pub(in crate::volume) fn read(cursor: &mut Cursor<'_>) -> Result<Self, VdbError> {
        let flags = cursor.u32("the compression flags")?;
        if flags & !0b111 != 0 {
            return Err(VdbError::Unsupported {
                offset: cursor.offset() - 4,
                what: format!(
                    "compression flags {flags:#x} (zip, active mask and blosc are known)"
                ),
            });
        }
        let codec = match flags {
            // Where both are set OpenVDB, too, takes blosc.
            _ if flags & 4 != 0 => Codec::Blosc,
            _ if flags & 1 != 0 => Codec::Zip,
            _ => Codec::Stored,
        };
        Ok(Self {
            codec,
            active_mask: flags & 2 != 0,
        })
    }
}

/// Reads one chunk of exactly `out.len()` bytes.
pub(in crate::volume) fn read_chunk(
    cursor: &mut Cursor<'_>,
    codec: Codec,
    out: &mut [u8],
) -> Result<(), VdbError> {
    const WHAT: &str = "a chunk of voxel values";
    if codec == Codec::Stored {
        out.copy_from_slice(cursor.take(out.len(), WHAT)?);
        return Ok(());
    }
    let start = cursor.offset();
    let damaged = |what: String| VdbError::Damaged {
        offset: start,
        what,
    };
    let size = cursor.i64("the size of a chunk")?;
    if size <= 0 {
        // Not worth compressing: stored, which the sign tells.
        if size.unsigned_abs() != out.len() as u64 {
            return Err(damaged(format!(
                "a stored chunk has {} bytes where its node needs {}",
                size.unsigned_abs(),
                out.len()
            )));
        }
        out.copy_from_slice(cursor.take(out.len(), WHAT)?);
        return Ok(());
    }
    cursor.need(size.unsigned_abs(), WHAT)?;
    let packed = cursor.take(usize::try_from(size).unwrap_or(usize::MAX), WHAT)?;
    match codec {
        Codec::Blosc => blosc::decompress(packed, out).map_err(damaged),
        _ => inflate(packed, out).map_err(damaged),
    }
}

/// Unfolds a zlib stream into exactly `out`: one byte more or less is an error, so a bomb costs nothing.
pub(in crate::volume) fn inflate(packed: &[u8], out: &mut [u8]) -> Result<(), String> {
    let mut stream = Decompress::new(true);
    let status = stream
        .decompress(packed, out, FlushDecompress::Finish)
        .map_err(|error| format!("a zlib chunk is corrupt ({error})"))?;
    let complete = stream.total_out() == out.len() as u64;
    if complete && status == Status::StreamEnd {
        return Ok(());
    }
    // The output is full but the end mark not yet read: it must follow without another byte of output.
    if complete {
        let rest = packed
            .get(usize::try_from(stream.total_in()).unwrap_or(usize::MAX)..)
            .unwrap_or(&[]);
        let mut extra = [0_u8];
        let status = stream.decompress(rest, &mut extra, FlushDecompress::Finish);
        if matches!(status, Ok(Status::StreamEnd)) && stream.total_out() == out.len() as u64 {
            return Ok(());
        }
    }
    Err(format!(
        "a zlib chunk does not hold exactly the {} bytes that its node needs",
        out.len()
    ))
}
