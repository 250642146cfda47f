//! The value types of grids, and the packing of a node's values.

use super::VdbError;
use super::bytes::Cursor;
use super::codec::{Compression, read_chunk, skip_chunk};
use half::f16;

/// A type that voxels may have.
pub(crate) trait Voxel: Copy + PartialEq + std::fmt::Debug + Send + Sync + 'static {
    /// Size in a file \[bytes\].
    const SIZE: usize;
    /// 1 for scalars, 3 for vectors.
    const COMPONENTS: usize;
    /// Whether "saved as half" applies: it does to reals only.
    const REAL: bool;

    fn from_le(bytes: &[u8]) -> Self;
    /// From `COMPONENTS` half floats.
    fn from_half(bytes: &[u8]) -> Self;
    fn negative(self) -> Self;
    fn component(self, n: usize) -> f64;

    /// Reads the values of one leaf into `out` (512 voxels); its mask has been read.
    fn read_leaf(
        cursor: &mut Cursor<'_>,
        reader: &mut ValueReader,
        active: &[u64],
        background: Self,
        out: &mut [Self],
    ) -> Result<(), VdbError> {
        reader.read(cursor, active, background, out)
    }

    /// Moves behind the values of one leaf; its mask has been read.
    fn skip_leaf(
        cursor: &mut Cursor<'_>,
        reader: &mut ValueReader,
        active: &[u64],
        background: Self,
        voxels: usize,
    ) -> Result<(), VdbError> {
        reader.skip(cursor, active, background, voxels)
    }

    /// Equality for finding what need not be stored: NaN is the same as NaN.
    fn same(self, other: Self) -> bool {
        (0..Self::COMPONENTS).all(|n| self.component(n).to_bits() == other.component(n).to_bits())
    }
}

fn half_at(bytes: &[u8], n: usize) -> f32 {
    f16::from_le_bytes([bytes[2 * n], bytes[2 * n + 1]]).to_f32()
}

fn word<const N: usize>(bytes: &[u8]) -> [u8; N] {
    let mut out = [0; N];
    out.copy_from_slice(&bytes[..N]);
    out
}

macro_rules! scalar_and_vector {
    ($scalar:ty, $size:literal, $real:literal, $negative:expr, $half:expr) => {
        impl Voxel for $scalar {
            const SIZE: usize = $size;
            const COMPONENTS: usize = 1;
            const REAL: bool = $real;
            #[inline]
            fn from_le(bytes: &[u8]) -> Self {
                <$scalar>::from_le_bytes(word(bytes))
            }
            fn from_half(bytes: &[u8]) -> Self {
                $half(half_at(bytes, 0))
            }
            fn negative(self) -> Self {
                $negative(self)
            }
            fn component(self, _: usize) -> f64 {
                self as f64
            }
        }

        impl Voxel for [$scalar; 3] {
            const SIZE: usize = 3 * $size;
            const COMPONENTS: usize = 3;
            const REAL: bool = $real;
            #[inline]
            fn from_le(bytes: &[u8]) -> Self {
                std::array::from_fn(|n| <$scalar>::from_le_bytes(word(&bytes[n * $size..])))
            }
            fn from_half(bytes: &[u8]) -> Self {
                std::array::from_fn(|n| $half(half_at(bytes, n)))
            }
            fn negative(self) -> Self {
                self.map($negative)
            }
            fn component(self, n: usize) -> f64 {
                self[n] as f64
            }
        }
    };
}

scalar_and_vector!(f32, 4, true, |v: f32| -v, |h| h);
scalar_and_vector!(f64, 8, true, |v: f64| -v, f64::from);
scalar_and_vector!(i32, 4, false, i32::wrapping_neg, |h| h as i32);
scalar_and_vector!(i64, 8, false, i64::wrapping_neg, |h| h as i64);

impl Voxel for bool {
    const SIZE: usize = 1;
    const COMPONENTS: usize = 1;
    const REAL: bool = false;
    fn from_le(bytes: &[u8]) -> Self {
        bytes[0] != 0
    }
    fn from_half(bytes: &[u8]) -> Self {
        half_at(bytes, 0) != 0.0
    }
    fn negative(self) -> Self {
        !self
    }
    fn component(self, _: usize) -> f64 {
        f64::from(u8::from(self))
    }

    /// A leaf of truth values is a bare mask behind its origin, whatever the compression.
    fn read_leaf(
        cursor: &mut Cursor<'_>,
        reader: &mut ValueReader,
        _: &[u64],
        _: Self,
        out: &mut [Self],
    ) -> Result<(), VdbError> {
        Self::skip_leaf(cursor, reader, &[], false, out.len())?;
        for (n, value) in out.iter_mut().enumerate() {
            *value = bit(&reader.selection, n);
        }
        Ok(())
    }

    fn skip_leaf(
        cursor: &mut Cursor<'_>,
        reader: &mut ValueReader,
        _: &[u64],
        _: Self,
        voxels: usize,
    ) -> Result<(), VdbError> {
        cursor.i32x3("the origin of a leaf")?;
        read_mask(cursor, voxels, &mut reader.selection)
    }
}

/// A grid whose values *are* half floats (not one that was merely saved so).
impl Voxel for f16 {
    const SIZE: usize = 2;
    const COMPONENTS: usize = 1;
    const REAL: bool = true;
    fn from_le(bytes: &[u8]) -> Self {
        f16::from_le_bytes(word(bytes))
    }
    fn from_half(bytes: &[u8]) -> Self {
        Self::from_le(bytes)
    }
    fn negative(self) -> Self {
        -self
    }
    fn component(self, _: usize) -> f64 {
        f64::from(self.to_f32())
    }
}

pub(crate) fn bit(words: &[u64], n: usize) -> bool {
    words[n >> 6] >> (n & 63) & 1 != 0
}

pub(crate) fn count(words: &[u64]) -> usize {
    words.iter().map(|word| word.count_ones() as usize).sum()
}

/// Reads a bit mask of `bits` entries, a multiple of 64.
pub(crate) fn read_mask(
    cursor: &mut Cursor<'_>,
    bits: usize,
    out: &mut Vec<u64>,
) -> Result<(), VdbError> {
    let bytes = cursor.take(bits / 8, "a node mask")?;
    out.clear();
    out.extend(bytes.chunks_exact(8).map(|b| u64::from_le_bytes(word(b))));
    Ok(())
}

/// What the values of one grid have in common, and scratch memory for reading them.
#[derive(Debug, Clone)]
pub(crate) struct ValueReader {
    compression: Compression,
    half: bool,
    bytes: Vec<u8>,
    selection: Vec<u64>,
}

impl ValueReader {
    pub(crate) fn new(compression: Compression, half: bool) -> Self {
        Self {
            compression,
            half,
            bytes: Vec::new(),
            selection: Vec::new(),
        }
    }

    /// Reads the values of one node into `out`, all of them, also those that the file leaves out because they are
    /// inactive. `active` is the node's value mask.
    pub(crate) fn read<T: Voxel>(
        &mut self,
        cursor: &mut Cursor<'_>,
        active: &[u64],
        background: T,
        out: &mut [T],
    ) -> Result<(), VdbError> {
        let Inactive {
            off,
            on,
            selects,
            masked,
        } = self.inactive(cursor, background, out.len())?;
        let stored = if masked { count(active) } else { out.len() };
        let width = self.width::<T>();
        self.bytes.resize(stored * width, 0);
        if self.has_chunk::<T>(stored) {
            read_chunk(cursor, self.compression.codec, &mut self.bytes)?;
        }
        let decode = if self.halves::<T>() {
            T::from_half
        } else {
            T::from_le
        };
        let mut values = self.bytes.chunks_exact(width).map(decode);
        if stored == out.len() {
            for (slot, value) in out.iter_mut().zip(values) {
                *slot = value;
            }
            return Ok(());
        }
        for (n, slot) in out.iter_mut().enumerate() {
            *slot = if bit(active, n) {
                values.next().unwrap_or(background)
            } else if selects && bit(&self.selection, n) {
                on
            } else {
                off
            };
        }
        Ok(())
    }

    /// Moves behind the values of a node of so many entries without unfolding them.
    pub(crate) fn skip<T: Voxel>(
        &mut self,
        cursor: &mut Cursor<'_>,
        active: &[u64],
        background: T,
        entries: usize,
    ) -> Result<(), VdbError> {
        let inactive = self.inactive(cursor, background, entries)?;
        let stored = if inactive.masked {
            count(active)
        } else {
            entries
        };
        if self.has_chunk::<T>(stored) {
            skip_chunk(cursor, self.compression.codec, stored * self.width::<T>())?;
        }
        Ok(())
    }

    /// What precedes the chunk of a node; the mask that selects goes to `selection`.
    fn inactive<T: Voxel>(
        &mut self,
        cursor: &mut Cursor<'_>,
        background: T,
        entries: usize,
    ) -> Result<Inactive<T>, VdbError> {
        // What the inactive values are, and which mask chooses between two of them:
        //   0 background          1 −background      2 one value        3 −background or background
        //   4 one or background   5 one or another   6 anything: all values are stored
        let kind = cursor.u8("a node's value kind")?;
        let mut off = match kind {
            0 => background,
            1..=6 => background.negative(),
            _ => {
                return Err(cursor.damaged(format!("a node's value kind is {kind} (0 to 6 exist)")));
            }
        };
        let mut on = background;
        if matches!(kind, 2 | 4 | 5) {
            off = T::from_le(cursor.take(T::SIZE, "an inactive value")?);
        }
        if kind == 5 {
            on = T::from_le(cursor.take(T::SIZE, "an inactive value")?);
        }
        let selects = matches!(kind, 3..=5);
        if selects {
            read_mask(cursor, entries, &mut self.selection)?;
        }
        Ok(Inactive {
            off,
            on,
            selects,
            masked: self.compression.active_mask && kind != 6,
        })
    }

    /// Whether values are stored as half floats.
    fn halves<T: Voxel>(&self) -> bool {
        self.half && T::REAL
    }

    /// Bytes of a stored value.
    fn width<T: Voxel>(&self) -> usize {
        if self.halves::<T>() {
            2 * T::COMPONENTS
        } else {
            T::SIZE
        }
    }

    /// Of zero halves not even an empty chunk is written.
    fn has_chunk<T: Voxel>(&self, stored: usize) -> bool {
        !(self.halves::<T>() && stored == 0)
    }
}

/// What the values are that a node leaves out.
struct Inactive<T> {
    /// Where the selection is clear or there is none, and where it is set.
    off: T,
    on: T,
    /// Whether there is a selection.
    selects: bool,
    /// Whether inactive values are left out at all.
    masked: bool,
}
