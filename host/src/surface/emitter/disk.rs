//! Disks and rings, chosen by area: affine maps keep it even.

use std::f64::consts::{PI, TAU};

use glam::{DVec2, DVec3};

use super::super::spot::Placement;
use super::Choice;

/// A disk that shines, with a hole of some radius.
#[derive(Clone, Copy, Debug)]
pub(super) struct Disk<'a>(pub(super) &'a Placement, pub(super) f64);

impl Disk<'_> {
    pub(super) fn area(&self) -> f64 {
        let linear = self.0.to_world.matrix3;
        PI * (1.0 - self.1 * self.1) * linear.x_axis.cross(linear.y_axis).length()
    }

    pub(super) fn normal(&self) -> DVec3 {
        let normal = self.0.to_local.matrix3.transpose() * DVec3::Z;
        normal.normalize_or(DVec3::Z)
    }

    pub(super) fn area_pdf(&self) -> f64 {
        1.0 / self.area()
    }

    pub(super) fn sample_area(&self, u: [f64; 2]) -> Choice {
        let hole = self.1 * self.1;
        let radius = (hole + u[0] * (1.0 - hole)).sqrt();
        let (sin, cos) = libm::sincos(TAU * u[1]);
        Choice {
            at: DVec2::new(radius * cos, radius * sin),
            near: DVec3::ZERO,
            pdf: self.area_pdf(),
        }
    }
}
