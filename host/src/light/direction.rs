//! Directions about an axis, in double precision: the frames and the uniform laws of [`woodcock_core`], once more
//! named for lights.

use std::f64::consts::PI;

use glam::DVec3;
use woodcock_core::vec3::Vec3;

/// Density of a uniform direction [1/sr].
pub(super) const UNIFORM: f64 = 1.0 / (4.0 * PI);

/// The unit direction at `cos_theta` from a unit `axis`, turned about it by `turn` of a full circle.
pub(super) fn about(axis: DVec3, cos_theta: f64, turn: f64) -> DVec3 {
    from_core(Vec3::new(axis.x, axis.y, axis.z).deflected(cos_theta, turn))
}

/// A uniform direction at two uniform numbers in [0, 1).
pub(super) fn uniform(u: [f64; 2]) -> DVec3 {
    from_core(woodcock_core::light::constant::sample(u[0], u[1]))
}

/// A point spread evenly over the disk across a unit `axis` around the origin.
pub(super) fn on_disk(axis: DVec3, radius: f64, u: [f64; 2]) -> DVec3 {
    about(axis, 0.0, u[1]) * (radius * u[0].sqrt())
}

fn from_core(v: Vec3<f64>) -> DVec3 {
    DVec3::new(v.x, v.y, v.z)
}
