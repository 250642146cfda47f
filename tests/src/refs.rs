//! Reference tables: numbers to test against that no code of this workspace produced.
//!
//! Each file in `tests/refs/` states its definitions, how its numbers were made and cross-checked, and their
//! uncertainty; read its `definitions` before using it. Conventions shared by all: lengths in any one unit,
//! coefficients in 1/length; cos θ between the directions of travel before and after a scattering, +1 straight on;
//! phase functions integrate to 1 over the sphere [1/sr]; media without a boundary of their own (index matched) unless said;
//! radiance relative to a source of radiance 1. Deterministic numbers are good to the digits given; Monte Carlo ones
//! carry one standard error.
//!
//! Each loader parses a file that was compiled in, so it fails only where file and type disagree, and then loudly.

pub mod furnace;
pub mod halfspace;
pub mod infinite_medium;
pub mod invariance;
pub mod pencil_beam;
pub mod phase_functions;
pub mod scenes3d;
pub mod single_scatter;
pub mod slab_matched;
pub mod slab_mismatched;
pub mod slab_radiance;
pub mod surfaces;
pub mod transmittance;

pub mod quadrature;
#[cfg(test)]
mod walk;

/// Parses a table that was compiled in.
///
/// # Panics
/// When text and type disagree, with the place: a damaged table must stop every test that reads it.
fn parse<T: serde::de::DeserializeOwned>(name: &str, text: &str) -> T {
    serde_json::from_str(text).unwrap_or_else(|error| panic!("refs/{name}.json: {error}"))
}
