//! The unit disk z = 0 of its own space, perhaps with a hole.

use std::f64::consts::TAU;

use glam::{DVec2, DVec3};

use super::spot::Spot;
use crate::line::ROUNDING;

/// Where a ray meets the disk at 0 < t ≤ `t_max`, and x and y there.
///
/// * `hole`: its radius, in [0, 1).
pub(super) fn meet(origin: DVec3, direction: DVec3, hole: f64, t_max: f64) -> Option<(f64, DVec2)> {
    let t = -origin.z / direction.z;
    if !(t > 0.0 && t <= t_max) {
        return None;
    }
    let at = origin.truncate() + direction.truncate() * t;
    let squared = at.length_squared();
    (squared <= 1.0 && squared >= hole * hole).then_some((t, at))
}

/// The place at x and y, with pbrt's coordinates: u = φ / 2π, v = (1 − r) / (1 − hole).
///
/// The place lies in the plane exactly; what remains is the sign of the rounded height and slope of later rays.
pub(super) fn spot(at: DVec2, hole: f64) -> Spot {
    let phi = libm::atan2(at.y, at.x);
    let phi = if phi < 0.0 { phi + TAU } else { phi };
    let v = (1.0 - at.length()) / (1.0 - hole);
    Spot {
        point: at.extend(0.0),
        normal: DVec3::Z,
        shading_normal: DVec3::Z,
        tangent: DVec3::new(-at.y, at.x, 0.0),
        uv: DVec2::new(phi / TAU, v),
        error: 32.0 * ROUNDING,
        reach: 2.0,
    }
}
