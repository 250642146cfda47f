//! Chunks of node values: stored, zlib, or blosc. The tree says how many bytes a chunk unfolds to, never the chunk.

use super::VdbError;
use super::blosc;
use super::bytes::Cursor;
use flate2::{Decompress, FlushDecompress, Status};

/// How the values of a grid are packed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Codec {
    Stored,
    Zip,
    Blosc,
}

/// The compression flags that precede every grid.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Compression {
    pub(crate) codec: Codec,
    /// Inactive values are left out where they can be told from the masks.
    pub(crate) active_mask: bool,
}

impl Compression {
    pub(crate) fn read(cursor: &mut Cursor<'_>) -> Result<Self, VdbError> {
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
pub(crate) fn read_chunk(
    cursor: &mut Cursor<'_>,
    codec: Codec,
    out: &mut [u8],
) -> Result<(), VdbError> {
    let start = cursor.offset();
    let damaged = |what: String| VdbError::Damaged {
        offset: start,
        what,
    };
    match (chunk(cursor, codec, out.len())?, codec) {
        (Chunk::Stored(bytes), _) => {
            out.copy_from_slice(bytes);
            Ok(())
        }
        (Chunk::Packed(bytes), Codec::Blosc) => blosc::decompress(bytes, out).map_err(damaged),
        (Chunk::Packed(bytes), _) => inflate(bytes, out).map_err(damaged),
    }
}

/// Moves behind a chunk that unfolds to so many bytes, if what is inside does.
pub(crate) fn skip_chunk(
    cursor: &mut Cursor<'_>,
    codec: Codec,
    unfolded: usize,
) -> Result<(), VdbError> {
    chunk(cursor, codec, unfolded).map(|_| ())
}

/// The bytes of a chunk.
enum Chunk<'a> {
    Stored(&'a [u8]),
    Packed(&'a [u8]),
}

fn chunk<'a>(
    cursor: &mut Cursor<'a>,
    codec: Codec,
    unfolded: usize,
) -> Result<Chunk<'a>, VdbError> {
    const WHAT: &str = "a chunk of voxel values";
    if codec == Codec::Stored {
        return cursor.take(unfolded, WHAT).map(Chunk::Stored);
    }
    let start = cursor.offset();
    let size = cursor.i64("the size of a chunk")?;
    if size <= 0 {
        // Not worth compressing: stored, which the sign tells.
        if size.unsigned_abs() != unfolded as u64 {
            return Err(VdbError::Damaged {
                offset: start,
                what: format!(
                    "a stored chunk has {} bytes where its node needs {unfolded}",
                    size.unsigned_abs()
                ),
            });
        }
        return cursor.take(unfolded, WHAT).map(Chunk::Stored);
    }
    cursor.need(size.unsigned_abs(), WHAT)?;
    let size = usize::try_from(size).unwrap_or(usize::MAX);
    cursor.take(size, WHAT).map(Chunk::Packed)
}

/// Unfolds a zlib stream into exactly `out`: one byte more or less is an error, so a bomb costs nothing.
pub(crate) fn inflate(packed: &[u8], out: &mut [u8]) -> Result<(), String> {
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
