//! The woodcock renderer as a library: scenes, volumes, film, images.
#![forbid(unsafe_code)]

#[cfg(feature = "cli")]
pub mod cli;
pub mod drive;
pub mod film;
pub mod image;
pub mod output;
pub mod report;
pub mod scene;
pub mod volume;
