//! Rooms: a few plane pieces and balls that reflect diffusely, lamps among them, and perhaps one fog that fills them.
//!
//! A ray is met with every piece, eight rays at a time: for so few that is cheaper than any tree, needs no decision, and
//! every lane does the same work. So a path has only one kind of step, and lanes wait for nothing:
//!
//! ```text
//! launch → step ⟲    nearest piece, flight in the fog, light found, one light sampled, roulette, next direction
//! ```
//!
//! ## Single precision
//! With u = 2⁻²⁴ and S the largest coordinate of the scene and its camera, a computed place lies within some 8 u S of the
//! piece that it was found on. Rays leave pieces by a step of [`STEP`] S along the normal, to the side that they lead to,
//! and shadow rays end as far before the lamp. Pieces are larger than they are by [`GROWTH`] S, so that
//! nothing slips between two that share an edge; and places move towards the middle of their piece by [`SHRINK`] of the
//! way, so that none lies beyond another piece that meets it there. A ball is not met again by a ray that leaves it
//! outwards. What all of this shifts is of the order of 10⁻⁶ of the scene; where pieces are small beside that, whoever
//! makes the room must refuse.

mod lamp;
mod nearness;
mod piece;
mod walk;

pub use lamp::{Lamp, LampLight, Outline, Sheet};
pub use piece::{Ball, Flat, Matter};
pub use walk::Walks;

use crate::camera::Camera;
use crate::path::Convex;

/// By what part of the scene's size rays step off the pieces that they leave.
pub const STEP: f32 = 1.0 / 524_288.0;
/// By what part of the scene's size pieces are grown.
pub const GROWTH: f32 = 1.0 / 2_097_152.0;
/// By what part of the way to the middle of their piece places move.
pub const SHRINK: f32 = 1.0 / 262_144.0;

/// A homogeneous medium of grey extinction that scatters by Henyey and Greenstein's law.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fog {
    /// Extinction [1/length], positive.
    pub sigma_t: f32,
    /// Single-scattering albedo by colour.
    pub albedo: [f32; 3],
    /// Mean cosine, in (−1, 1).
    pub g: f32,
    /// Where it lies.
    pub region: Convex,
}

/// Everything that a path in a room can meet.
#[derive(Clone, Copy, Debug)]
pub struct Room<'a> {
    /// Plane pieces: those that shine, then others, then the [`walls`](Self::walls).
    pub flats: &'a [Flat],
    /// How many of the last flats are walls: they have all pieces and lamps at places on one side.
    ///
    /// Nothing between two places on that side can be hidden by them.
    pub walls: u32,
    /// Whether the camera is on that side of all walls.
    pub camera_within: bool,
    /// Balls; they do not shine.
    pub balls: &'a [Ball],
    /// What the pieces are made of: the flats, then the balls; see [`Matter::words`].
    pub matter: &'a [f32],
    /// What light sampling chooses from.
    pub lamps: &'a [Lamp],
    /// How many of the flats shine; they are the first lamps, in the same order.
    pub shining: u32,
    /// Radiance of what lies beyond all pieces.
    pub environment: [f32; 3],
    /// What fills the room.
    pub fog: Option<Fog>,
    /// Where paths begin.
    pub camera: &'a Camera,
    /// How far rays step off the pieces that they leave \[length\].
    pub step: f32,
    /// Whether the sixteen paths of a replicate share out their first choices ([`crate::points`]).
    pub points: bool,
    /// Scatterings after which a path is cut off; `u32::MAX` is no limit.
    pub max_depth: u32,
}
