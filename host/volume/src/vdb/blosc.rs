//! Blosc 1 containers: a header of 16 bytes, offsets of blocks, blocks of (shuffled, possibly split) streams.
//!
//! Source: the format description of c-blosc 1 (`README_HEADER.rst` of its repository). Supported inside: LZ4, BloscLZ,
//! zlib, stored; byte shuffle. OpenVDB writes LZ4 with byte shuffle.

use super::{blosclz, codec};

const HEADER: usize = 16;
/// The most streams a block may be split into.
const MAX_SPLITS: usize = 16;
/// Blocks with fewer elements than this are never split.
const MIN_SPLIT_ELEMENTS: usize = 128;

#[derive(Debug, Clone, Copy)]
enum Inner {
    BloscLz,
    Lz4,
    Zlib,
}

fn u32_at(bytes: &[u8], at: usize) -> Result<usize, String> {
    let end = at.checked_add(4);
    match end.and_then(|end| bytes.get(at..end)) {
        Some(&[a, b, c, d]) => Ok(u32::from_le_bytes([a, b, c, d]) as usize),
        _ => Err("a blosc chunk ends inside its header".to_owned()),
    }
}

/// What a container says that it unfolds to \[bytes\].
#[cfg(feature = "nvdb")]
pub(crate) fn unpacked_size(packed: &[u8]) -> Result<usize, String> {
    u32_at(packed, 4)
}

/// Unfolds `packed` into exactly `out`.
pub(crate) fn decompress(packed: &[u8], out: &mut [u8]) -> Result<(), String> {
    if packed.len() < HEADER {
        return Err(format!("a blosc chunk has only {} bytes", packed.len()));
    }
    let flags = packed[2];
    let type_size = usize::from(packed[3]).max(1);
    let total = u32_at(packed, 4)?;
    let block_size = u32_at(packed, 8)?;
    let packed_size = u32_at(packed, 12)?;
    if packed[0] != 2 {
        return Err(format!("blosc format {} is not known (2 is)", packed[0]));
    }
    if total != out.len() {
        return Err(format!(
            "a blosc chunk unfolds to {total} bytes where its node needs {}",
            out.len()
        ));
    }
    let packed = packed
        .get(..packed_size)
        .ok_or("a blosc chunk is longer than its place in the file")?;
    if total == 0 {
        return Ok(());
    }
    if flags & 0x02 != 0 {
        let stored = packed.get(HEADER..HEADER + total);
        out.copy_from_slice(stored.ok_or("a stored blosc chunk is too short")?);
        return Ok(());
    }
    if flags & 0x04 != 0 {
        return Err("blosc's bit shuffle is not supported (byte shuffle is)".to_owned());
    }
    let inner = match flags >> 5 {
        0 => Inner::BloscLz,
        1 => Inner::Lz4,
        3 => Inner::Zlib,
        other => {
            let name = match other {
                2 => "snappy",
                4 => "zstd",
                _ => "unknown",
            };
            return Err(format!(
                "blosc's codec {other} ({name}) is not supported (blosclz, lz4 and zlib are)"
            ));
        }
    };
    if block_size == 0 {
        return Err("a blosc chunk has blocks of zero bytes".to_owned());
    }
    let shuffled = flags & 0x01 != 0 && type_size > 1;
    let split = flags & 0x10 == 0
        && type_size <= MAX_SPLITS
        && block_size / type_size >= MIN_SPLIT_ELEMENTS;
    let mut scratch = Vec::new();
    for (n, block) in out.chunks_mut(block_size).enumerate() {
        let start = u32_at(packed, HEADER + 4 * n)?;
        // Only full blocks are split into one stream per byte of the type.
        let streams = if split && block.len() == block_size {
            type_size
        } else {
            1
        };
        if shuffled {
            scratch.resize(block.len(), 0);
            streams_into(packed, start, streams, inner, &mut scratch)?;
            unshuffle(&scratch, type_size, block);
        } else {
            streams_into(packed, start, streams, inner, block)?;
        }
    }
    Ok(())
}

fn streams_into(
    packed: &[u8],
    start: usize,
    streams: usize,
    inner: Inner,
    out: &mut [u8],
) -> Result<(), String> {
    let mut at = start;
    if !out.len().is_multiple_of(streams) {
        return Err("a blosc block does not divide into its streams".to_owned());
    }
    for part in out.chunks_mut(out.len() / streams) {
        let size = u32_at(packed, at)?;
        at += 4;
        let stream = at.checked_add(size).and_then(|end| packed.get(at..end));
        let stream = stream.ok_or("a blosc stream reaches beyond its chunk")?;
        at += size;
        if size == part.len() {
            part.copy_from_slice(stream);
            continue;
        }
        let written = match inner {
            Inner::Lz4 => lz4_flex::block::decompress_into(stream, part)
                .map_err(|error| format!("an LZ4 stream is corrupt ({error})"))?,
            Inner::BloscLz => blosclz::decompress(stream, part)?,
            Inner::Zlib => codec::inflate(stream, part).map(|()| part.len())?,
        };
        if written != part.len() {
            return Err(format!(
                "a blosc stream unfolds to {written} bytes instead of {}",
                part.len()
            ));
        }
    }
    Ok(())
}

/// Byte `b` of element `e` lies at `b · elements + e`; what fills no element follows as it is.
fn unshuffle(shuffled: &[u8], type_size: usize, out: &mut [u8]) {
    let elements = out.len() / type_size;
    let whole = elements * type_size;
    for (b, plane) in shuffled[..whole].chunks_exact(elements.max(1)).enumerate() {
        for (element, &byte) in out[..whole].chunks_exact_mut(type_size).zip(plane) {
            element[b] = byte;
        }
    }
    out[whole..].copy_from_slice(&shuffled[whole..]);
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Chunks written by c-blosc 1.21: which of two contents (u32), length (u32), chunk. Types of 1, 2, 4 and 12 bytes,
    /// blocks split and whole, shuffled and not, matches near and far.
    const CHUNKS: &[u8] = include_bytes!("../../../../tests/data/blosc/chunks.bin");

    /// 600 floats and three bytes that fill no element.
    fn small() -> Vec<u8> {
        let value = |i: u32| (i % 37) as f32 * 0.25 + (i / 100) as f32;
        let mut bytes: Vec<u8> = (0..600).flat_map(|i| value(i).to_le_bytes()).collect();
        bytes.extend(b"xyz");
        bytes
    }

    /// Noise, the same noise again (a far match), zeros (a long match).
    fn large() -> Vec<u8> {
        let mut state = 1_u32;
        let mut bytes: Vec<u8> = std::iter::repeat_with(|| {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 24) as u8
        })
        .take(12_000)
        .collect();
        bytes.extend_from_within(..);
        bytes.resize(29_000, 0);
        bytes
    }

    fn chunks() -> Vec<(usize, &'static [u8])> {
        let mut rest = CHUNKS;
        let mut chunks = Vec::new();
        while !rest.is_empty() {
            let length = u32_at(rest, 4).expect("a length");
            chunks.push((u32_at(rest, 0).expect("a number"), &rest[8..8 + length]));
            rest = &rest[8 + length..];
        }
        chunks
    }

    #[test]
    fn chunks_of_c_blosc_unfold() {
        let contents = [small(), large()];
        for (n, (which, chunk)) in chunks().into_iter().enumerate() {
            let mut out = vec![0; contents[which].len()];
            decompress(chunk, &mut out).unwrap_or_else(|error| panic!("chunk {n}: {error}"));
            assert!(out == contents[which], "chunk {n}");
        }
    }

    #[test]
    fn damaged_chunks_end_in_an_error_or_in_bytes() {
        let contents = [small(), large()];
        for (which, chunk) in chunks() {
            let mut out = vec![0; contents[which].len()];
            assert!(decompress(&chunk[..chunk.len() - 1], &mut out).is_err());
            assert!(decompress(chunk, &mut out[1..]).is_err());
            for at in (0..chunk.len()).step_by(29) {
                for bit in [0, 3, 7] {
                    let mut bad = chunk.to_vec();
                    bad[at] ^= 1 << bit;
                    let _ = decompress(&bad, &mut out);
                }
            }
        }
    }
}
