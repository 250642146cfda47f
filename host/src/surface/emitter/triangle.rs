//! Triangles chosen by the solid angle that they fill.

use std::f64::consts::TAU;

use glam::{DVec2, DVec3};

use super::super::exact;
use super::Choice;

/// Below this solid angle distance and slope hardly vary over the triangle, and choice by area is as good \[sr\].
const SMALL: f64 = 1e-5;
/// Above this one the reference is all but within the triangle \[sr\].
const LARGE: f64 = TAU - 1e-5;

/// A triangle that shines.
#[derive(Clone, Copy, Debug)]
pub(super) struct Triangle {
    corners: [DVec3; 3],
}

/// A triangle on the unit sphere around a reference.
struct Spherical {
    /// Unit vectors to the corners.
    a: DVec3,
    b: DVec3,
    c: DVec3,
    /// \[sr\].
    angle: f64,
}

impl Triangle {
    pub(super) fn new(corners: [DVec3; 3]) -> Self {
        Self { corners }
    }

    pub(super) fn area(&self) -> f64 {
        0.5 * exact::normal(&self.corners).length()
    }

    pub(super) fn normal(&self) -> DVec3 {
        exact::normal(&self.corners).normalize_or(DVec3::Z)
    }

    pub(super) fn area_pdf(&self) -> f64 {
        let area = self.area();
        if area > 0.0 { 1.0 / area } else { 0.0 }
    }

    pub(super) fn sample_area(&self, u: [f64; 2]) -> Choice {
        let root = u[0].sqrt();
        Choice {
            at: DVec2::new(root * (1.0 - u[1]), root * u[1]),
            near: DVec3::ZERO,
            pdf: self.area_pdf(),
        }
    }

    /// The triangle as seen from a reference; `None` where it is not chosen by solid angle.
    ///
    /// Its angle is that of [Van Oosterom, Strackee 1983]; the triple product is taken of differences, so that small
    /// triangles keep their digits.
    fn seen_from(&self, reference: DVec3) -> Option<Spherical> {
        let [a, b, c] = self.corners.map(|p| (p - reference).normalize_or_zero());
        let triple = a.dot((b - a).cross(c - a)).abs();
        let angle = 2.0 * libm::atan2(triple, 1.0 + a.dot(b) + b.dot(c) + c.dot(a));
        (angle > SMALL && angle < LARGE).then_some(Spherical { a, b, c, angle })
    }

    pub(super) fn angle_pdf(&self, reference: DVec3) -> Option<f64> {
        self.seen_from(reference).map(|s| 1.0 / s.angle)
    }

    pub(super) fn sample_angle(&self, reference: DVec3, u: [f64; 2]) -> Option<Choice> {
        let seen = self.seen_from(reference)?;
        let direction = seen.sample(u);
        // Weights by Cramer's rule, brought back into the triangle where rounding leaves it.
        let [p, q, r] = self.corners;
        let (e, f, from) = (q - p, r - p, reference - p);
        let across = direction.cross(f);
        let determinant = across.dot(e);
        let b = (across.dot(from) / determinant).clamp(0.0, 1.0);
        let c = (direction.dot(from.cross(e)) / determinant).clamp(0.0, 1.0);
        let sum = (b + c).max(1.0);
        let at = DVec2::new(b / sum, c / sum);
        at.is_finite().then_some(Choice {
            at,
            near: DVec3::ZERO,
            pdf: 1.0 / seen.angle,
        })
    }
}

impl Spherical {
    /// A direction within, uniform by solid angle [Arvo 1995].
    ///
    /// u₀ chooses a point c′ on the arc from a to c so that the triangle a, b, c′ has the area S = u₀ Ω. Arvo's
    /// formula for it cancels for small triangles; the half-angle form of the area does not:
    ///
    /// ```text
    /// tan(S/2) = k x sin α / (1 + k x cos α),  k = tan(∠ab / 2), x = tan(∠ac′ / 2), α the angle at a
    ///        x = sin(S/2) / (k sin(α − S/2))
    /// ```
    ///
    /// u₁ chooses a point on the arc from b to c′ by its height above b, which is uniform.
    fn sample(&self, [u0, u1]: [f64; 2]) -> DVec3 {
        let Self { a, b, c, angle } = *self;
        let (to_b, to_c) = (a.cross(b - a), a.cross(c - a));
        let alpha = libm::atan2(a.dot((b - a).cross(c - a)).abs(), to_b.dot(to_c));
        let half = 0.5 * u0 * angle;
        // Sides of the half-angle triangle; |a − b| / |a + b| is k.
        let rise = libm::sin(half) * (a + b).length();
        let run = libm::sin(alpha - half) * (b - a).length();
        let squared = rise * rise + run * run;
        let (cos, sin) = (
            (run * run - rise * rise) / squared,
            2.0 * rise * run / squared,
        );
        let tangent = (c - a) - a * (c - a).dot(a);
        let end = (a * cos + tangent.normalize_or_zero() * sin).normalize_or_zero();
        let chord = end - b;
        // 1 − cos of the arc from b.
        let height = u1 * 0.5 * chord.length_squared();
        let across = (chord - b * chord.dot(b)).normalize_or_zero();
        (b * (1.0 - height) + across * (height * (2.0 - height)).max(0.0).sqrt())
            .normalize_or_zero()
    }
}
