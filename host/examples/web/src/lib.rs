//! The engine of the page: woodcock's path tracer over one grid, as a WebAssembly module without imports.
//!
//! A page and each of its workers have an instance of their own, with its own memory. The page writes `Controls` and the bytes
//! of files, calls the functions below and reads what they leave; nothing is copied but by the page.
#![allow(
    unsafe_code,
    reason = "names for other languages, and memory that they read and write"
)]

#[path = "../../../src/builtin/cumulus.rs"]
mod cumulus;
mod film;
mod text;
#[path = "../../../src/image/tone.rs"]
mod tone;
mod view;
mod volume;

use std::cell::RefCell;

use film::Film;
use view::Controls;
use volume::Volume;

/// What an instance holds.
#[derive(Debug, Default)]
struct Engine {
    controls: Controls,
    volume: Option<Volume>,
    film: Film,
    /// A file that the page writes, and the text of a scene that it reads.
    bytes: Vec<u8>,
    /// What was found out about the volume, or went wrong.
    message: String,
    /// Radiance of the pixels of the last rows.
    rows: Vec<[f32; 3]>,
}

thread_local! {
    static ENGINE: RefCell<Engine> = RefCell::default();
}

fn with<T>(job: impl FnOnce(&mut Engine) -> T) -> T {
    ENGINE.with_borrow_mut(job)
}

/// Where the page writes what it wants: a `Controls` of `view.rs`.
#[unsafe(no_mangle)]
pub extern "C" fn controls() -> *mut Controls {
    with(|engine| &raw mut engine.controls)
}

/// Room for the bytes of a file.
#[unsafe(no_mangle)]
pub extern "C" fn room(length: usize) -> *mut u8 {
    with(|engine| {
        engine.bytes = vec![0; length];
        engine.bytes.as_mut_ptr()
    })
}

/// Takes a cloud (0), a ball of fog (1) or the file in the room; true if it can be rendered. A message says why not, or what it is.
#[unsafe(no_mangle)]
pub extern "C" fn load(kind: u32) -> bool {
    with(|engine| {
        let read = match kind {
            0 => Volume::cumulus(),
            1 => Ok(Volume::Fog),
            _ => Volume::of_file(&engine.bytes),
        };
        engine.bytes = Vec::new();
        let loaded = read.is_ok();
        engine.message = match read {
            Ok(volume) => {
                let text = volume.to_string();
                engine.volume = Some(volume);
                text
            }
            Err(why) => why,
        };
        loaded
    })
}

/// The message, in UTF-8.
#[unsafe(no_mangle)]
pub extern "C" fn message() -> *const u8 {
    with(|engine| engine.message.as_ptr())
}

/// Bytes of the message.
#[unsafe(no_mangle)]
pub extern "C" fn message_length() -> usize {
    with(|engine| engine.message.len())
}

/// Writes the scene as the `woodcock` program reads it: bytes in the room, whose number is returned.
#[unsafe(no_mangle)]
pub extern "C" fn describe() -> usize {
    with(|engine| {
        let volume = engine.volume.as_ref();
        let text = volume.map(|volume| text::scene(&engine.controls, volume));
        engine.bytes = text.unwrap_or_default().into_bytes();
        engine.bytes.len()
    })
}

/// Where the room begins.
#[unsafe(no_mangle)]
pub extern "C" fn bytes() -> *const u8 {
    with(|engine| engine.bytes.as_ptr())
}

/// Traces one path through each pixel of the rows from `first` to before `end`: three floats a pixel, linear. Without a volume they are
/// black.
#[unsafe(no_mangle)]
pub extern "C" fn trace(first: u32, end: u32, sample: u32) -> *const f32 {
    with(|engine| {
        let count = engine.controls.width as usize * end.saturating_sub(first) as usize;
        engine.rows.clear();
        engine.rows.resize(count, [0.0; 3]);
        if let Some(volume) = &engine.volume {
            volume.trace(&engine.controls, first..end, sample, &mut engine.rows);
        }
        engine.rows.as_ptr().cast()
    })
}

/// Begins an empty film of the size in the controls, and gives the place of its picture: four bytes a pixel.
#[unsafe(no_mangle)]
pub extern "C" fn film() -> *const u8 {
    with(|engine| {
        let Controls { width, height, .. } = engine.controls;
        engine.film.begin(width, height);
        engine.film.picture.as_ptr().cast()
    })
}

/// Room for `count` rows that a worker traced, before [`expose`].
#[unsafe(no_mangle)]
pub extern "C" fn rows(count: u32) -> *mut f32 {
    with(|engine| {
        let count = engine.controls.width as usize * count as usize;
        engine.rows.clear();
        engine.rows.resize(count, [0.0; 3]);
        engine.rows.as_mut_ptr().cast()
    })
}

/// Adds these rows to the film, from row `first` on, a sample a pixel.
#[unsafe(no_mangle)]
pub extern "C" fn expose(first: u32) {
    with(|engine| engine.film.add(first, &engine.rows));
}

/// Makes the picture of what the film has so far.
#[unsafe(no_mangle)]
pub extern "C" fn develop() {
    with(|engine| engine.film.develop());
}

/// Standard error of a pixel over what it shows, as a root mean square; NaN before each pixel has two samples.
#[unsafe(no_mangle)]
pub extern "C" fn noise() -> f64 {
    with(|engine| engine.film.noise())
}

/// Mean of all pixels and colours, linear.
#[unsafe(no_mangle)]
pub extern "C" fn mean() -> f64 {
    with(|engine| engine.film.mean())
}
