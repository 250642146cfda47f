//! Surfaces, materials, lights and pictures, each on its own.

mod bsdf;
mod geometry;
mod lights;
mod textures;
