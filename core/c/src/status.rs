//! What functions answer, and in words.

use core::ffi::{CStr, c_char};

use woodcock_core::majorant::MajorantError;

/// `woodcock_status`: what became of a call.
#[repr(i32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Status {
    /// Done.
    Ok = 0,
    /// The walk has come to the end of its ray; no error.
    End = 1,
    /// A pointer is null.
    Null = 2,
    /// A pointer is not aligned to its type.
    Alignment = 3,
    /// Memory to write to overlaps memory to read from.
    Overlap = 4,
    /// A ray's origin is not finite, its direction not a unit vector, or its length negative or not a number.
    Ray = 5,
    /// An extinction or a bound is negative, infinite or not a number, or exceeds its bound.
    Extinction = 6,
    /// No such phase function.
    Phase = 7,
    /// A mean cosine that is not between −1 and 1.
    MeanCosine = 8,
    /// A cosine that is not from −1 to 1.
    Cosine = 9,
    /// An axis has fewer than two samples, or the grid too many.
    Dimensions = 10,
    /// Blocks cannot have such an edge.
    Edge = 11,
    /// A table has another length than the dimensions ask for.
    Length = 12,
    /// A sample is negative, not a number, or beyond 3.4e38.
    Sample = 13,
    /// A majorant does not bound the samples of its block.
    Bound = 14,
    /// A majorant of the rim is not zero.
    Rim = 15,
    /// A majorant below zero is no leap over empty blocks.
    Leap = 16,
    /// The map or the scale of a grid is not finite, or the scale negative or too large.
    Placement = 17,
    /// The grid was not opened, or the walk not begun.
    Unopened = 18,
    /// More than ten million tentative collisions would be expected on the ray.
    Work = 19,
    /// Something that this interface has no code for.
    Other = 20,
}

impl From<MajorantError> for Status {
    fn from(error: MajorantError) -> Self {
        match error {
            MajorantError::Dimensions(_) => Self::Dimensions,
            MajorantError::Edge(_) => Self::Edge,
            MajorantError::Length { .. } => Self::Length,
            MajorantError::Sample { .. } => Self::Sample,
            MajorantError::Bound { .. } => Self::Bound,
            MajorantError::Rim { .. } => Self::Rim,
            MajorantError::Leap { .. } => Self::Leap,
            _ => Self::Other,
        }
    }
}

/// The status of what was computed; the result goes where a checked pointer leads.
pub(crate) fn answer(result: Result<(), Status>) -> Status {
    result.err().unwrap_or(Status::Ok)
}

/// A status in words: never null, and never freed.
#[unsafe(no_mangle)]
pub extern "C" fn woodcock_error_text(status: i32) -> *const c_char {
    let text: &CStr = match status {
        0 => c"done",
        1 => c"the walk has come to the end of its ray",
        2 => c"a pointer is null",
        3 => c"a pointer is not aligned to its type",
        4 => c"memory to write to overlaps memory to read from",
        5 => c"a ray has an origin that is not finite, a direction that is no unit vector, or a negative length",
        6 => c"an extinction or its bound is negative, infinite or not a number, or the extinction exceeds the bound",
        7 => c"there is no such phase function",
        8 => c"a mean cosine lies between -1 and 1",
        9 => c"a cosine lies from -1 to 1",
        10 => c"each axis of a grid needs at least two samples, all together at most 2^31",
        11 => c"the edge of a block is 4, 8, 16, 32 or 64",
        12 => c"a table has another length than the dimensions of its grid ask for",
        13 => c"a sample is negative, not a number, or beyond 3.4e38",
        14 => c"a majorant does not bound the samples of its block",
        15 => c"a majorant in the rim is not zero",
        16 => c"a majorant below zero is no leap over empty blocks",
        17 => c"the map or the scale of a grid is not finite, or the scale is negative or too large",
        18 => c"the grid was not opened, or the walk not begun",
        19 => c"more than 1e7 tentative collisions would be expected on the ray",
        20 => c"an error that this interface has no code for",
        _ => c"no such status",
    };
    text.as_ptr()
}
