//! Leaps: how far a walk may go where nothing is.
//!
//! An entry of a table of bounds that is zero says that its block is empty; one below zero says that blocks around
//! it are, too. Its negative is a whole number of 24 bits, three for each octant of directions, and k, one more than
//! such three bits, is the edge of a cube of empty blocks that begins with the block and goes on the way that
//! the octant's rays go. A walk takes the cube as one segment.
//!
//! ```text
//! k(b) = 1 + min k over the seven blocks next to b on the octant's way,   0 where there is matter, at most 8
//! ```
//!
//! Octant-wise cubes are longer than those around a block: what lies behind a ray cannot stop it.

use crate::majorant::MajorantError;
use crate::majorant::footprint::table_size;

/// Bits of an octant's part of a code.
pub(crate) const CODE_BITS: u32 = 3;
/// What remains of a code when the octant's part has been shifted to its end.
pub(crate) const CODE_MASK: u32 = (1 << CODE_BITS) - 1;
/// Codes are below this, so that single precision holds them.
const CODES: f32 = 16_777_216.0;

/// A table of bounds and the way to go in it.
#[derive(Clone, Copy)]
struct Steps {
    size: [u32; 3],
    octant: u32,
}

impl Steps {
    fn shift(self) -> u32 {
        self.octant * CODE_BITS
    }

    /// The index of an entry.
    fn index(self, [x, y, z]: [u32; 3]) -> usize {
        ((z * self.size[1] + y) * self.size[0] + x) as usize
    }

    /// The next coordinate on the octant's way along an axis, if the table has it.
    fn next(self, axis: usize, at: u32) -> Option<u32> {
        let next = if self.octant >> axis & 1 == 1 {
            at.checked_sub(1)?
        } else {
            at + 1
        };
        (next < self.size[axis]).then_some(next)
    }

    /// One more than the least k of the seven blocks beyond: what k may be here.
    fn allowed(self, at: [u32; 3], k: impl Fn(usize) -> u32) -> u32 {
        let next = [0, 1, 2].map(|axis| self.next(axis, at[axis]));
        let [Some(x), Some(y), Some(z)] = next else {
            return 1;
        };
        let least = (1..8_u32).fold(CODE_MASK, |least, corner| {
            let pick = |axis: usize, beyond| {
                if corner >> axis & 1 == 1 {
                    beyond
                } else {
                    at[axis]
                }
            };
            least.min(k(self.index([pick(0, x), pick(1, y), pick(2, z)])))
        });
        least + 1
    }
}

/// The code of an entry, `None` where there is matter.
#[inline]
fn code(entry: f32) -> Option<u32> {
    (entry <= 0.0).then_some(-entry as u32)
}

/// The k of an entry for an octant.
#[inline]
fn reach(entry: f32, shift: u32) -> u32 {
    code(entry).map_or(0, |code| (code >> shift & CODE_MASK) + 1)
}

/// Writes the leaps into the empty entries of a table of bounds.
///
/// * `majorants`: as [`fill_majorants`](crate::majorant::fill_majorants) makes them, rim included.
/// * `blocks`: along x, y, z, without the rim.
///
/// Eight passes over the table, each reading seven neighbours of empty entries.
///
/// # Errors
/// A table of another length.
pub fn fill_leaps(majorants: &mut [f32], blocks: [u32; 3]) -> Result<(), MajorantError> {
    let size = table_size(blocks)?;
    let expected = size.iter().map(|n| *n as usize).product();
    if majorants.len() != expected {
        return Err(MajorantError::Length {
            expected,
            found: majorants.len(),
        });
    }
    for entry in majorants.iter_mut().filter(|entry| **entry <= 0.0) {
        *entry = 0.0;
    }
    for octant in 0..8 {
        fill_octant(majorants, Steps { size, octant });
    }
    Ok(())
}

/// Adds the leaps of one octant, from where its rays go to where they come from.
fn fill_octant(majorants: &mut [f32], steps: Steps) {
    let shift = steps.shift();
    let order = |axis: usize, i: u32| {
        if steps.octant >> axis & 1 == 1 {
            i
        } else {
            steps.size[axis] - 1 - i
        }
    };
    for z in 0..steps.size[2] {
        for y in 0..steps.size[1] {
            for x in 0..steps.size[0] {
                let at = [order(0, x), order(1, y), order(2, z)];
                let index = steps.index(at);
                let entry = majorants.get(index).copied().unwrap_or(1.0);
                let Some(known) = code(entry) else {
                    continue;
                };
                let k = |i: usize| majorants.get(i).map_or(0, |entry| reach(*entry, shift));
                let further = steps.allowed(at, k) - 1;
                if let Some(entry) = majorants.get_mut(index) {
                    *entry = -((known | further << shift) as f32);
                }
            }
        }
    }
}

/// Proves the leaps of a table: none goes beyond what the blocks on its way allow, hence by induction none beyond
/// empty blocks.
pub(super) fn prove(majorants: &[f32], blocks: [u32; 3]) -> Result<(), MajorantError> {
    let size = table_size(blocks)?;
    let mut index = 0;
    for z in 0..size[2] {
        for y in 0..size[1] {
            for x in 0..size[0] {
                let entry = majorants.get(index).copied().unwrap_or(f32::NAN);
                if entry < 0.0 {
                    let whole = entry > -CODES && (-entry as u32) as f32 == -entry;
                    let sound = (0..8).all(|octant| {
                        let steps = Steps { size, octant };
                        let shift = steps.shift();
                        let k = |i: usize| majorants.get(i).map_or(0, |e| reach(*e, shift));
                        let claimed = reach(entry, shift);
                        claimed == 1 || claimed <= steps.allowed([x, y, z], k)
                    });
                    if !(whole && sound) {
                        return Err(MajorantError::Leap { index });
                    }
                }
                index += 1;
            }
        }
    }
    Ok(())
}
