//! Spheres and ellipsoids: the unit sphere of a space of its own.

use std::f64::consts::{PI, TAU};

use glam::{DVec2, DVec3};

use super::super::spot::Placement;
use super::{Choice, carlson};
use crate::line::ROUNDING;

/// An ellipsoid that shines.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ellipsoid<'a>(pub(super) &'a Placement);

/// The cone that the unit sphere fills as seen from outside.
struct Cone {
    /// The reference in the own space.
    origin: DVec3,
    /// Its distance from the centre.
    distance: f64,
    /// 1 − cos of the half opening angle.
    height: f64,
}

impl Ellipsoid<'_> {
    /// S = 4π R_G(a²b², a²c², b²c²), the semi-axes a, b, c being the singular values of the linear map
    /// [Carlson 1995]; these are the eigenvalues of its cofactors times their transpose.
    pub(super) fn area(&self) -> f64 {
        let m = self.0.to_world.matrix3;
        let cofactors = [
            m.y_axis.cross(m.z_axis),
            m.z_axis.cross(m.x_axis),
            m.x_axis.cross(m.y_axis),
        ];
        let [x, y, z] = carlson::squared_singular_values(cofactors);
        4.0 * PI * carlson::r_g(x, y, z)
    }

    /// A point by the direction from the centre in the own space.
    fn choice(&self, unit: DVec3, pdf: f64) -> Choice {
        Choice {
            at: DVec2::ZERO,
            near: self.0.to_world.transform_point3(unit),
            pdf,
        }
    }

    /// Uniform on the unit sphere. The map stretches area by |det M| |M⁻ᵀ n|.
    pub(super) fn sample_area(&self, u: [f64; 2]) -> Choice {
        let z = 1.0 - 2.0 * u[0];
        let radius = (2.0 * u[0] * (2.0 - 2.0 * u[0])).max(0.0).sqrt();
        let (sin, cos) = libm::sincos(TAU * u[1]);
        let unit = DVec3::new(radius * cos, radius * sin, z);
        self.choice(unit, self.pdf_at(unit))
    }

    fn pdf_at(&self, unit: DVec3) -> f64 {
        let placed = self.0;
        let stretch = placed.to_world.matrix3.determinant().abs()
            * (placed.to_local.matrix3.transpose() * unit).length();
        1.0 / (4.0 * PI * stretch)
    }

    pub(super) fn area_pdf(&self, point: DVec3) -> f64 {
        let local = self.0.to_local.transform_point3(point);
        self.pdf_at(local.normalize_or(DVec3::Z))
    }

    /// `None` from inside.
    fn cone(&self, reference: DVec3) -> Option<Cone> {
        let origin = self.0.to_local.transform_point3(reference);
        let distance = origin.length();
        let outside = distance > 1.0 && distance.is_finite();
        if !outside {
            return None;
        }
        let sin = 1.0 / distance;
        let cos = ((distance - 1.0) * sin * (1.0 + sin)).sqrt();
        Some(Cone {
            origin,
            distance,
            height: sin * sin / (1.0 + cos),
        })
    }

    /// Density of a direction of the world that leads from a reference to a point, if it is uniform in the cone of
    /// the own space. A map W turns a cone of directions d into one that is |det W| / |W d|³ as wide.
    fn turned_pdf(&self, cone: &Cone, unit: DVec3, reference: DVec3, point: DVec3) -> f64 {
        let shrink = (point - reference).length() / (unit - cone.origin).length();
        let determinant = self.0.to_local.matrix3.determinant().abs();
        determinant * shrink * shrink * shrink / (TAU * cone.height)
    }

    /// Uniform in the cone of the own space [Pharr, Jakob, Humphreys 2023, section 6.2.4]: for spheres that is uniform
    /// by solid angle. All is counted from the axis of the cone, so that far spheres lose nothing.
    pub(super) fn sample_angle(&self, reference: DVec3, u: [f64; 2]) -> Option<Choice> {
        let cone = self.cone(reference)?;
        let height = u[0] * cone.height;
        let cos = 1.0 - height;
        let sin_squared = height * (2.0 - height);
        // The sine of the angle of incidence.
        let incidence_squared = (sin_squared * cone.distance * cone.distance).min(1.0);
        let ratio = 1.0 / cone.distance;
        let slope = (1.0 - incidence_squared).sqrt();
        // Seen from the centre, the angle between the point and the reference.
        let cos_centre = ratio * incidence_squared + cos * slope;
        let sin_centre = incidence_squared.sqrt() * (cos - ratio * slope);
        let axis = cone.origin * ratio;
        let (x, y) = axis.normalize_or(DVec3::Z).any_orthonormal_pair();
        let (sin_phi, cos_phi) = libm::sincos(TAU * u[1]);
        let unit = axis * cos_centre + (x * cos_phi + y * sin_phi) * sin_centre;
        let unit = unit.normalize_or(axis);
        let choice = self.choice(unit, 0.0);
        let pdf = self.turned_pdf(&cone, unit, reference, choice.near);
        Some(Choice { pdf, ..choice })
    }

    pub(super) fn angle_pdf(&self, reference: DVec3, point: DVec3) -> Option<f64> {
        let cone = self.cone(reference)?;
        let unit = self
            .0
            .to_local
            .transform_point3(point)
            .normalize_or(DVec3::Z);
        // On the horizon rounding decides.
        let visible = unit.dot(cone.origin) >= 1.0 - 8.0 * ROUNDING * cone.distance;
        Some(if visible {
            self.turned_pdf(&cone, unit, reference, point)
        } else {
            0.0
        })
    }
}
