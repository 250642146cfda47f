//! A cursor over bytes from strangers, and the account of the memory they cost.

use super::VdbError;
use crate::Limits;

/// Reads little-endian values front to back; every read is checked against the end.
#[derive(Debug, Clone)]
pub(crate) struct Cursor<'a> {
    bytes: &'a [u8],
    position: usize,
}

impl<'a> Cursor<'a> {
    pub(crate) fn new(bytes: &'a [u8]) -> Self {
        Self { bytes, position: 0 }
    }

    /// Offset of the next byte from the start of the file \[bytes\].
    pub(crate) fn offset(&self) -> u64 {
        self.position as u64
    }

    pub(crate) fn remaining(&self) -> usize {
        self.bytes.len() - self.position
    }

    /// A cursor over the same file that starts at `start` and cannot see beyond `end`.
    pub(crate) fn window(&self, start: u64, end: u64) -> Option<Self> {
        let (start, end) = (usize::try_from(start).ok()?, usize::try_from(end).ok()?);
        let bytes = self.bytes.get(..end)?;
        (start <= end).then_some(Self {
            bytes,
            position: start,
        })
    }

    /// The next `count` bytes; `what` names them in the error.
    pub(crate) fn take(&mut self, count: usize, what: &'static str) -> Result<&'a [u8], VdbError> {
        self.need(count as u64, what)?;
        let taken = &self.bytes[self.position..self.position + count];
        self.position += count;
        Ok(taken)
    }

    /// Fails unless `count` bytes are left: asked before allocating for them.
    pub(crate) fn need(&self, count: u64, what: &'static str) -> Result<(), VdbError> {
        let available = self.remaining() as u64;
        if count > available {
            return Err(VdbError::Truncated {
                what,
                offset: self.offset(),
                needed: count,
                available,
            });
        }
        Ok(())
    }

    pub(crate) fn array<const N: usize>(
        &mut self,
        what: &'static str,
    ) -> Result<[u8; N], VdbError> {
        let mut out = [0; N];
        out.copy_from_slice(self.take(N, what)?);
        Ok(out)
    }

    pub(crate) fn u8(&mut self, what: &'static str) -> Result<u8, VdbError> {
        Ok(self.array::<1>(what)?[0])
    }

    pub(crate) fn u32(&mut self, what: &'static str) -> Result<u32, VdbError> {
        Ok(u32::from_le_bytes(self.array(what)?))
    }

    pub(crate) fn i32(&mut self, what: &'static str) -> Result<i32, VdbError> {
        Ok(i32::from_le_bytes(self.array(what)?))
    }

    pub(crate) fn i64(&mut self, what: &'static str) -> Result<i64, VdbError> {
        Ok(i64::from_le_bytes(self.array(what)?))
    }

    pub(crate) fn f64(&mut self, what: &'static str) -> Result<f64, VdbError> {
        Ok(f64::from_le_bytes(self.array(what)?))
    }

    pub(crate) fn f64s<const N: usize>(
        &mut self,
        what: &'static str,
    ) -> Result<[f64; N], VdbError> {
        self.need(8 * N as u64, what)?;
        let mut out = [0.0; N];
        for value in &mut out {
            *value = self.f64(what)?;
        }
        Ok(out)
    }

    pub(crate) fn i32x3(&mut self, what: &'static str) -> Result<[i32; 3], VdbError> {
        Ok([self.i32(what)?, self.i32(what)?, self.i32(what)?])
    }

    /// A string with its length in front. OpenVDB promises no encoding; what is not UTF-8 is replaced.
    pub(crate) fn string(&mut self, what: &'static str) -> Result<String, VdbError> {
        let length = self.u32(what)? as usize;
        let bytes = self.take(length, what)?;
        Ok(String::from_utf8_lossy(bytes).into_owned())
    }

    pub(crate) fn damaged(&self, what: impl Into<String>) -> VdbError {
        VdbError::Damaged {
            offset: self.offset(),
            what: what.into(),
        }
    }
}

/// Memory spent so far against [`Limits`].
#[derive(Debug)]
pub(crate) struct Budget {
    used: u64,
    limit: u64,
}

impl Budget {
    pub(crate) fn new(limits: &Limits) -> Self {
        Self {
            used: 0,
            limit: limits.max_memory,
        }
    }

    /// Counts `bytes` more; fails before they are allocated.
    pub(crate) fn charge(&mut self, bytes: u64, what: &'static str) -> Result<(), VdbError> {
        let needed = self.used.saturating_add(bytes);
        if needed > self.limit {
            return Err(VdbError::Memory {
                what,
                needed,
                limit: self.limit,
            });
        }
        self.used = needed;
        Ok(())
    }
}

/// `count` copies of a value; an error where the machine has not that much memory, whatever the limit.
pub(crate) fn filled<T: Copy>(
    value: T,
    count: u64,
    what: &'static str,
) -> Result<Vec<T>, VdbError> {
    let needed = count.saturating_mul(size_of::<T>() as u64);
    let refused = || VdbError::NoMemory { what, needed };
    let count = usize::try_from(count).map_err(|_| refused())?;
    let mut out = Vec::new();
    out.try_reserve_exact(count).map_err(|_| refused())?;
    out.resize(count, value);
    Ok(out)
}
