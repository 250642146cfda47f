//! The woodcock renderer as a library: scenes, volumes, worlds, film, images.
//!
//! A scene file becomes a [`scene::Scene`], which says what is where; [`world::assemble`] reads its
//! volumes and makes the tables, the geometry and the choice of kernel that [`render`] traces paths with;
//! where there are surfaces or lights among media, scalar integrators ([`integrator`]) take their place;
//! [`film`] sums their samples exactly, and [`image`] writes the picture.
#![forbid(unsafe_code)]

#[cfg(feature = "cli")]
pub mod bench;
pub mod bsdf;
pub mod builtin;
#[cfg(feature = "cli")]
pub mod cli;
pub mod compare;
pub mod drive;
pub mod film;
pub mod image;
pub mod info;
pub mod integrator;
mod kernel;
pub mod light;
mod line;
pub mod output;
pub mod pilot;
pub mod ray;
pub mod render;
pub mod report;
pub mod scene;
pub mod surface;
pub mod texture;
pub mod world;

pub use woodcock_volume as volume;
