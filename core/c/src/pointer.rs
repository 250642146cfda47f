//! What is believed of a pointer, and what is checked: never null, always aligned, of a size that memory can have.
//!
//! Values are copied in and out, and no reference to the caller's single values is ever held; so it does not matter if two of them
//! are one. Tables are borrowed.

use crate::status::Status;

fn check<T>(pointer: *const T) -> Result<(), Status> {
    if pointer.is_null() {
        Err(Status::Null)
    } else if !pointer.is_aligned() {
        Err(Status::Alignment)
    } else {
        Ok(())
    }
}

/// A copy of what a pointer leads to.
///
/// # Safety
/// A pointer that is neither null nor misaligned leads to a `T` that may be read.
pub(crate) unsafe fn read<T: Copy>(pointer: *const T) -> Result<T, Status> {
    check(pointer)?;
    // SAFETY: neither null nor misaligned, the rest is the caller's word.
    Ok(unsafe { pointer.read() })
}

/// A place that a result can be written to, once it is known.
pub(crate) struct Place<T>(*mut T);

impl<T> Place<T> {
    /// # Safety
    /// A pointer that is neither null nor misaligned leads to memory for a `T` that may be written until the
    /// function that is being called returns.
    pub(crate) unsafe fn new(pointer: *mut T) -> Result<Self, Status> {
        check(pointer)?;
        Ok(Self(pointer))
    }

    /// Writes the result.
    pub(crate) fn put(self, value: T) {
        // SAFETY: checked, and vouched for, when the place was made.
        unsafe { self.0.write(value) }
    }
}

fn check_table(pointer: *const f32, count: usize) -> Result<(), Status> {
    check(pointer)?;
    if count > isize::MAX as usize / size_of::<f32>() {
        return Err(Status::Length);
    }
    Ok(())
}

/// A table to be read.
///
/// # Safety
/// A pointer that is neither null nor misaligned leads to so many numbers, which stay as they are for `'a`.
pub(crate) unsafe fn table<'a>(pointer: *const f32, count: usize) -> Result<&'a [f32], Status> {
    check_table(pointer, count)?;
    // SAFETY: neither null nor misaligned nor larger than memory, the rest is the caller's word.
    Ok(unsafe { core::slice::from_raw_parts(pointer, count) })
}

/// A table to be written, apart from one that is read.
///
/// # Safety
/// As [`table`], and nobody else uses the numbers for `'a`, which have been written before.
pub(crate) unsafe fn table_mut<'a>(
    pointer: *mut f32,
    count: usize,
    apart_from: &[f32],
) -> Result<&'a mut [f32], Status> {
    check_table(pointer, count)?;
    let (begin, other) = (pointer.addr(), apart_from.as_ptr().addr());
    let end = begin.wrapping_add(count * size_of::<f32>());
    let other_end = other.wrapping_add(size_of_val(apart_from));
    if begin < other_end && other < end {
        return Err(Status::Overlap);
    }
    // SAFETY: as for a table to be read, and apart from the only other one.
    Ok(unsafe { core::slice::from_raw_parts_mut(pointer, count) })
}
