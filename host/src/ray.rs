//! Rays and points of double precision: what scalar code traces against surfaces.

use glam::DVec3;

use crate::line::ROUNDING;

/// A half-line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// Where it begins, in the world as rendered.
    pub origin: DVec3,
    /// Unit direction.
    pub direction: DVec3,
}

impl Ray {
    /// The place at distance `t`.
    pub fn at(&self, t: f64) -> DVec3 {
        self.origin + self.direction * t
    }
}

/// A place that rays leave from and arrive at: in space, or on a surface that they must not meet again.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Anchor {
    /// The place.
    pub point: DVec3,
    /// Unit geometric normal of the surface; zero in space.
    pub normal: DVec3,
    /// Bound on the distance of `point` from the true surface, rounding of the intersection and of its
    /// use included \[length\]; zero in space.
    pub error: f64,
}

impl Anchor {
    /// A place in space.
    pub fn in_space(point: DVec3) -> Self {
        Self {
            point,
            normal: DVec3::ZERO,
            error: 0.0,
        }
    }

    /// The place moved off its surface by the error bound, to the side that `direction` leads to.
    pub fn leave(&self, direction: DVec3) -> DVec3 {
        self.step_off(direction, self.error)
    }

    fn step_off(&self, direction: DVec3, distance: f64) -> DVec3 {
        if self.normal.dot(direction) < 0.0 {
            self.point - self.normal * distance
        } else {
            self.point + self.normal * distance
        }
    }

    /// The ray that leaves in a unit direction.
    pub fn ray(&self, direction: DVec3) -> Ray {
        Ray {
            origin: self.leave(direction),
            direction,
        }
    }

    /// The ray to another place, and its length. `None` where they coincide.
    ///
    /// It ends before a surface that it arrives at: by the error bound, and by what the rounding of its direction
    /// adds up to on the way.
    pub fn ray_to(&self, other: &Self) -> Option<(Ray, f64)> {
        let towards = other.point - self.point;
        let origin = self.leave(towards);
        let size = self.point.abs().max(other.point.abs()).max_element();
        let stray = 32.0 * ROUNDING * (size + towards.length());
        let arrival = other.step_off(-towards, other.error + stray);
        let length = (arrival - origin).length();
        let direction = (arrival - origin) / length;
        (length > 0.0 && direction.is_finite()).then_some((Ray { origin, direction }, length))
    }
}
