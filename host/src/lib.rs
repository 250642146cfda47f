//! The woodcock renderer as a library: scenes, volumes, film, images.
#![forbid(unsafe_code)]

pub mod info;
pub mod scene;
pub mod volume;
