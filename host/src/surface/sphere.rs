//! The unit sphere of its own space.

use std::f64::consts::{PI, TAU};

use glam::{DVec2, DVec3};

use super::spot::Spot;
use crate::line::{ROUNDING, cross_unit_sphere};

/// Where a ray meets the sphere at 0 < t ≤ `t_max`.
pub(super) fn meet(origin: DVec3, direction: DVec3, t_max: f64) -> Option<f64> {
    let [enter, leave] = cross_unit_sphere(origin, direction)?;
    let t = if enter > 0.0 { enter } else { leave };
    (t > 0.0 && t <= t_max).then_some(t)
}

/// The place of the sphere nearest to a point, with pbrt's coordinates: u = φ / 2π, v = 1 − θ / π.
///
/// After the normalisation the point is within 3 u of the sphere. A later intersection rounds the square of its
/// distance from the centre by some 16 u; the error takes four times as much.
pub(super) fn spot(near: DVec3) -> Spot {
    let unit = near.normalize_or_zero();
    let point = if unit == DVec3::ZERO { DVec3::Z } else { unit };
    let phi = libm::atan2(point.y, point.x);
    let phi = if phi < 0.0 { phi + TAU } else { phi };
    let theta = libm::acos(point.z.clamp(-1.0, 1.0));
    Spot {
        point,
        normal: point,
        shading_normal: point,
        tangent: DVec3::new(-point.y, point.x, 0.0),
        uv: DVec2::new(phi / TAU, 1.0 - theta / PI),
        error: 64.0 * ROUNDING,
        reach: 2.0,
    }
}
