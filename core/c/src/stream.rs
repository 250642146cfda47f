//! Random numbers: a stream for each key, in the caller's memory.

use woodcock_core::stream::{self, PathStream, Stream};

use crate::pointer::{self, Place};
use crate::status::{Status, answer};

/// `woodcock_key`: what identifies a stream.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Key {
    /// Seed of everything.
    pub seed: u64,
    /// Index of a pixel, or of whatever is computed apart.
    pub pixel: u32,
    /// Index of the sample in it.
    pub sample: u32,
}

/// `woodcock_stream`: memory for a stream. Its contents mean nothing to the caller.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct OpaqueStream(pub [u64; 2]);

const _: () = assert!(size_of::<PathStream>() == size_of::<OpaqueStream>());
const _: () = assert!(align_of::<PathStream>() <= align_of::<OpaqueStream>());

/// Calls `draw` with a copy of the stream, and puts that back.
///
/// # Safety
/// As for [`pointer::read`] and [`Place::new`].
pub(crate) unsafe fn with<T>(
    stream: *mut OpaqueStream,
    draw: impl FnOnce(&mut PathStream) -> Result<T, Status>,
) -> Result<T, Status> {
    // SAFETY: the caller's word.
    let opaque = unsafe { pointer::read(stream) }?;
    // SAFETY: as large, aligned no less, and two integers of any value make a stream: its numbers are nothing but bits.
    let mut rng: PathStream = unsafe { core::mem::transmute(opaque) };
    let drawn = draw(&mut rng)?;
    // SAFETY: as above, without padding.
    let opaque: OpaqueStream = unsafe { core::mem::transmute(rng) };
    // SAFETY: the caller's word.
    unsafe { Place::new(stream) }?.put(opaque);
    Ok(drawn)
}

/// Puts the stream of a key at its beginning.
///
/// # Safety
/// Pointers lead to what their types say, or are null.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn woodcock_stream_begin(
    stream: *mut OpaqueStream,
    key: *const Key,
) -> Status {
    answer((|| {
        // SAFETY: the caller's word, for both.
        let (place, key) = unsafe { (Place::new(stream)?, pointer::read(key)?) };
        let Key {
            seed,
            pixel,
            sample,
        } = key;
        let rng = PathStream::new(stream::Key {
            seed,
            pixel,
            sample,
        });
        // SAFETY: of one size, without padding.
        place.put(unsafe { core::mem::transmute::<PathStream, OpaqueStream>(rng) });
        Ok(())
    })())
}

/// A number by one draw.
unsafe fn one(
    stream: *mut OpaqueStream,
    out: *mut f32,
    draw: fn(&mut PathStream) -> f32,
) -> Status {
    answer((|| {
        // SAFETY: the caller's word.
        let place = unsafe { Place::new(out) }?;
        // SAFETY: the caller's word.
        place.put(unsafe { with(stream, |rng| Ok(draw(rng))) }?);
        Ok(())
    })())
}

/// Draws a number uniform in [0, 1).
///
/// # Safety
/// Pointers lead to what their types say, or are null.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn woodcock_uniform(stream: *mut OpaqueStream, u: *mut f32) -> Status {
    // SAFETY: the caller's word.
    unsafe { one(stream, u, |rng| rng.uniform(true)) }
}

/// Draws an exponentially distributed number of mean one.
///
/// # Safety
/// Pointers lead to what their types say, or are null.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn woodcock_exponential(stream: *mut OpaqueStream, e: *mut f32) -> Status {
    // SAFETY: the caller's word.
    unsafe { one(stream, e, |rng| rng.exponential(true)) }
}
