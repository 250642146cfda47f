//! BloscLZ, blosc's own byte-oriented LZ77 (a relative of FastLZ).
//!
//! A control byte below 32 announces that many literals plus one. Otherwise its upper three bits hold the match length
//! minus two (7: more length bytes follow, 255 goes on) and its lower five the high bits of the distance, whose low byte
//! follows. All distance bits set announce a far match with a distance of 16 more bits.

/// The longest distance that needs no far match \[bytes\].
const NEAR: usize = 8191;

/// Unfolds `packed` into `out`; returns the bytes written. Never reads or writes outside of the two.
pub(super) fn decompress(packed: &[u8], out: &mut [u8]) -> Result<usize, String> {
    let mut input = packed.iter().copied();
    let mut next = || -> Result<usize, String> {
        let byte = input.next().map(usize::from);
        byte.ok_or_else(|| "a BloscLZ stream ends too early".to_owned())
    };
    let overflow = || "a BloscLZ stream unfolds to more than its block".to_owned();
    let mut written = 0_usize;
    let mut consumed = 1_usize;
    // The first control byte is always literals; its upper bits are a version.
    let mut control = next()? & 31;
    loop {
        if control < 32 {
            let count = control + 1;
            let target = out.get_mut(written..written + count).ok_or_else(overflow)?;
            for byte in target {
                *byte = next()? as u8;
            }
            consumed += count;
            written += count;
        } else {
            let mut length = (control >> 5) - 1;
            let mut distance = (control & 31) << 8;
            if length == 6 {
                loop {
                    let more = next()?;
                    consumed += 1;
                    length += more;
                    if more != 255 {
                        break;
                    }
                }
            }
            let low = next()?;
            consumed += 1;
            if low == 255 && distance == 31 << 8 {
                let high = next()?;
                distance = (high << 8) + next()? + NEAR;
                consumed += 2;
            } else {
                distance += low;
            }
            let length = length + 3;
            let source = written
                .checked_sub(distance + 1)
                .ok_or("a BloscLZ match reaches before its block")?;
            if out.len() - written < length {
                return Err(overflow());
            }
            // Byte by byte: source and target overlap when a run repeats.
            for n in 0..length {
                out[written + n] = out[source + n];
            }
            written += length;
        }
        if consumed >= packed.len() {
            return Ok(written);
        }
        control = next()?;
        consumed += 1;
    }
}
