//! What goes wrong in random walks.

use woodcock_core::real::Real;
use woodcock_core::vec3::Vec3;

/// A planted mistake in the walk itself. What is scored, and where, can go wrong in each suite's own ways.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mistake {
    /// The cosine counts from the direction come from, not from the one travelled.
    PhaseReversed,
    /// Every flight of a particle is its first.
    StaleFlight,
    /// Directions are turned in a frame whose axes are orthogonal, but shorter than one.
    ShortFrame,
    /// The azimuth covers half a circle.
    HalfTurn,
    /// One number serves as cosine and as azimuth.
    OneUniform,
    /// Null collisions scatter.
    NullScatters,
    /// The last flight counts in full, not up to the boundary.
    Unclipped,
    /// Each collision multiplies by the albedo twice.
    AlbedoTwice,
    /// Survivors of roulette are not made heavier.
    LossyRoulette,
}

impl Mistake {
    /// All of them: each must be planted in some suite.
    pub const ALL: [Self; 9] = [
        Self::PhaseReversed,
        Self::StaleFlight,
        Self::ShortFrame,
        Self::HalfTurn,
        Self::OneUniform,
        Self::NullScatters,
        Self::Unclipped,
        Self::AlbedoTwice,
        Self::LossyRoulette,
    ];

    /// For messages.
    pub const fn name(self) -> &'static str {
        match self {
            Self::PhaseReversed => "phase function reversed",
            Self::StaleFlight => "flight not drawn anew after scattering",
            Self::ShortFrame => "frame not of unit vectors",
            Self::HalfTurn => "azimuth over half a circle",
            Self::OneUniform => "one number for cosine and azimuth",
            Self::NullScatters => "null collisions scatter",
            Self::Unclipped => "length not clipped at the boundary",
            Self::AlbedoTwice => "albedo applied twice",
            Self::LossyRoulette => "roulette without compensation",
        }
    }
}

/// A beginner's frame: cross products with a fixed axis, orthogonal to the direction and each other, but not brought
/// to unit length.
pub(super) fn short_frame(axis: Vec3<f32>, cos_theta: f32, turn: f32) -> Vec3<f32> {
    let sin_theta = (1.0 - cos_theta * cos_theta).max(0.0).sqrt();
    let (sin_phi, cos_phi) = turn.sin_cos_turn();
    let cross = |a: Vec3<f32>, b: Vec3<f32>| {
        Vec3::new(
            a.y * b.z - a.z * b.y,
            a.z * b.x - a.x * b.z,
            a.x * b.y - a.y * b.x,
        )
    };
    let tangent = cross(axis, Vec3::new(0.48, 0.36, 0.8));
    let bitangent = cross(axis, tangent);
    let side = tangent * (sin_theta * cos_phi) + bitangent * (sin_theta * sin_phi);
    (side + axis * cos_theta).normalised()
}
