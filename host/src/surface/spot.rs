//! A place on a surface, and how a transform carries it with its error bound.

use glam::{DAffine3, DMat3, DVec2, DVec3};

use crate::line::ROUNDING;

/// A place on a surface, in some space.
#[derive(Clone, Copy, Debug)]
pub(super) struct Spot {
    pub(super) point: DVec3,
    /// Unit geometric normal.
    pub(super) normal: DVec3,
    /// Normal of shading, of any length but zero.
    pub(super) shading_normal: DVec3,
    /// ∂p/∂u, perhaps zero.
    pub(super) tangent: DVec3,
    pub(super) uv: DVec2,
    /// How far a ray must start from `point` along the normal so as not to meet the shape again: bounds the
    /// distance from the shape and the rounding of the start and of its next intersection \[length\].
    pub(super) error: f64,
    /// A bound on the size of the shape, seen from the place \[length\].
    pub(super) reach: f64,
}

impl Spot {
    /// The same surface with its sides exchanged.
    pub(super) fn turned(self) -> Self {
        Self {
            normal: -self.normal,
            shading_normal: -self.shading_normal,
            ..self
        }
    }

    /// Unit shading normal on the side of the geometric one, and the unit tangent orthogonal to it.
    pub(super) fn frame(&self) -> (DVec3, DVec3) {
        let unit = self.shading_normal.normalize_or_zero();
        let normal = if unit == DVec3::ZERO {
            self.normal
        } else if unit.dot(self.normal) < 0.0 {
            -unit
        } else {
            unit
        };
        let along = self.tangent.normalize_or_zero();
        let across = along - normal * normal.dot(along);
        // A tangent along the normal says nothing.
        let tangent = if across.length_squared() > 1e-20 {
            across.normalize()
        } else {
            normal.any_orthonormal_vector()
        };
        (normal, tangent)
    }
}

/// A space of its own, placed in another one by an invertible map.
///
/// What is placed is what the map *to* the own space says, as that one carries rays; the map back is as exact as
/// doubles allow, and its residual is part of the error bounds.
#[derive(Clone, Debug)]
pub(super) struct Placement {
    pub(super) to_world: DAffine3,
    pub(super) to_local: DAffine3,
    /// Product of the norms of the linear maps.
    condition: f64,
    /// Frobenius norm of the linear map to the world.
    scale: f64,
}

fn norm(matrix: DMat3) -> f64 {
    (matrix.x_axis.length_squared()
        + matrix.y_axis.length_squared()
        + matrix.z_axis.length_squared())
    .sqrt()
}

impl Placement {
    /// `None` if the map cannot be inverted in doubles.
    pub(super) fn new(to_world: DAffine3) -> Option<Self> {
        let to_local = to_world.inverse();
        let scale = norm(to_world.matrix3);
        let condition = scale * norm(to_local.matrix3);
        // Beyond this no digit of a direction would be left.
        let usable = to_world.is_finite() && to_local.is_finite() && condition < 1e12;
        usable.then_some(Self {
            to_world,
            to_local,
            condition,
            scale,
        })
    }

    /// A line in the own space, with the same t.
    pub(super) fn line(&self, origin: DVec3, direction: DVec3) -> (DVec3, DVec3) {
        (
            self.to_local.transform_point3(origin),
            self.to_local.transform_vector3(direction),
        )
    }

    /// Carries a place of the own space to the world.
    ///
    /// A step e along the normal n = Wᵀm / |Wᵀm| of the world, W being the linear map to the own space and m its
    /// normal there, leads away from the surface by |Wᵀm| e in the own space. There it must make up for the error
    /// of the place, for what the way to the world and back changed, for the rounding of every later origin, and
    /// for directions that turn by a few roundings times the condition number.
    pub(super) fn carry(&self, local: &Spot) -> Spot {
        let point = self.to_world.transform_point3(local.point);
        let inverse_transpose = self.to_local.matrix3.transpose();
        let turned = inverse_transpose * local.normal;
        let stretch = turned.length();
        let back = self.to_local.transform_point3(point);
        let residual = (back - local.point).dot(local.normal).abs();
        let linear = self.to_local.matrix3;
        let sizes = linear.x_axis.abs() * point.x.abs()
            + linear.y_axis.abs() * point.y.abs()
            + linear.z_axis.abs() * point.z.abs()
            + self.to_local.translation.abs();
        let error = local.error
            + residual
            + ROUNDING * (16.0 * sizes.length() + 16.0 * self.condition * local.reach);
        Spot {
            point,
            normal: turned / stretch,
            shading_normal: inverse_transpose * local.shading_normal,
            tangent: self.to_world.matrix3 * local.tangent,
            uv: local.uv,
            error: error / stretch + 4.0 * ROUNDING * point.length(),
            reach: local.reach * self.scale,
        }
    }

    /// The corners of a box around the image of the unit sphere.
    pub(super) fn ball_bounds(&self) -> [DVec3; 2] {
        let rows = self.to_world.matrix3.transpose();
        let lengths = [rows.x_axis, rows.y_axis, rows.z_axis].map(DVec3::length);
        self.around(DVec3::from_array(lengths))
    }

    /// The corners of a box around the image of the unit disk z = 0.
    pub(super) fn disk_bounds(&self) -> [DVec3; 2] {
        let (x, y) = (self.to_world.matrix3.x_axis, self.to_world.matrix3.y_axis);
        self.around(DVec3::from_array(
            [0, 1, 2].map(|i| (x[i] * x[i] + y[i] * y[i]).sqrt()),
        ))
    }

    fn around(&self, reach: DVec3) -> [DVec3; 2] {
        let centre = self.to_world.translation;
        [centre - reach, centre + reach]
    }

    /// The corners of a box around the image of a box, with room for what the map to the own space is off.
    pub(super) fn box_bounds(&self, [low, high]: [DVec3; 2]) -> [DVec3; 2] {
        let half = (high - low) * 0.5;
        let centre = self.to_world.transform_point3(low + half);
        let linear = self.to_world.matrix3;
        let reach = linear.x_axis.abs() * half.x
            + linear.y_axis.abs() * half.y
            + linear.z_axis.abs() * half.z;
        let size = low.abs().max(high.abs()).length();
        let room = 16.0 * ROUNDING * self.condition * (self.scale * size + centre.length());
        [centre - reach - room, centre + reach + room]
    }
}
