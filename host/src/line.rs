//! Where a line crosses a triangle and the unit sphere: what boundaries of media and surfaces share.

use glam::DVec3;

/// Half of the distance between 1 and the next double: the bound on the relative error of one rounding.
pub(crate) const ROUNDING: f64 = f64::EPSILON / 2.0;

/// A direction made ready for triangles: the shear that turns it into the z axis, after [Woop, Benthin, Wald 2013].
#[derive(Clone, Copy, Debug)]
pub(crate) struct Shear {
    axes: [usize; 3],
    x: f64,
    y: f64,
    z: f64,
}

/// A line that passes through a triangle.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Crossing {
    /// Where, in multiples of the direction; perhaps negative or not finite.
    pub(crate) t: f64,
    edges: [f64; 3],
    determinant: f64,
    sheared: [(f64, f64, f64); 3],
}

impl Shear {
    /// * `direction`: of any length but zero.
    #[inline]
    pub(crate) fn new(direction: DVec3) -> Self {
        let size = direction.abs();
        let kz = if size.x > size.y && size.x > size.z {
            0
        } else if size.y > size.z {
            1
        } else {
            2
        };
        let axes = [(kz + 1) % 3, (kz + 2) % 3, kz];
        let z = 1.0 / direction[kz];
        let (x, y) = (direction[axes[0]] * z, direction[axes[1]] * z);
        Self { axes, x, y, z }
    }

    /// Watertight: edges are judged by signs that two triangles sharing them agree on, and an edge belongs to both.
    #[inline]
    pub(crate) fn cross(&self, corners: &[DVec3; 3], origin: DVec3) -> Option<Crossing> {
        let [kx, ky, kz] = self.axes;
        let shear = |corner: DVec3| {
            let p = (corner - origin).to_array();
            (
                p[kx] - self.x * p[kz],
                p[ky] - self.y * p[kz],
                self.z * p[kz],
            )
        };
        // Not by `map`, whose calls are not always compiled away.
        let [a, b, c] = [shear(corners[0]), shear(corners[1]), shear(corners[2])];
        let sheared = [a, b, c];
        let u = c.0 * b.1 - c.1 * b.0;
        let v = a.0 * c.1 - a.1 * c.0;
        let w = b.0 * a.1 - b.1 * a.0;
        let any_negative = u < 0.0 || v < 0.0 || w < 0.0;
        let any_positive = u > 0.0 || v > 0.0 || w > 0.0;
        let determinant = u + v + w;
        if (any_negative && any_positive) || determinant == 0.0 {
            return None;
        }
        Some(Crossing {
            t: (u * a.2 + v * b.2 + w * c.2) / determinant,
            edges: [u, v, w],
            determinant,
            sheared,
        })
    }

    /// A bound on the error of a crossing's t: of the exact quotient for the triangle and the line as given.
    ///
    /// A t above it is truly ahead of the origin; it also exceeds every t where rounding decides the sign of the
    /// determinant. The analysis is that of [Pharr, Jakob, Humphreys 2023], section 6.8.8, with room for the
    /// subtraction of the origin.
    pub(crate) fn error(&self, crossing: &Crossing) -> f64 {
        let largest = |f: fn(&(f64, f64, f64)) -> f64| {
            let [a, b, c] = &crossing.sheared;
            f(a).abs().max(f(b).abs()).max(f(c).abs())
        };
        let (x, y, z) = (largest(|p| p.0), largest(|p| p.1), largest(|p| p.2));
        // z before it was scaled; a corner's x before the shear is at most x + depth.
        let depth = z / self.z.abs();
        let error_x = 8.0 * ROUNDING * (x + depth);
        let error_y = 8.0 * ROUNDING * (y + depth);
        let error_z = 4.0 * ROUNDING * z;
        let error_edge = 2.0 * (3.0 * ROUNDING * x * y + error_y * x + error_x * y);
        let edges = crossing.edges.map(f64::abs);
        let edge = edges[0].max(edges[1]).max(edges[2]);
        3.0 * (6.0 * ROUNDING * edge * z + error_edge * z + error_z * edge)
            / crossing.determinant.abs()
    }
}

impl Crossing {
    /// The weights of the second and third corner.
    pub(crate) fn weights(&self) -> (f64, f64) {
        (
            self.edges[1] / self.determinant,
            self.edges[2] / self.determinant,
        )
    }
}

/// Where a line enters and leaves the unit sphere around the origin, in multiples of `direction`.
///
/// The discriminant is that of the point nearest to the centre, which loses no digits to a distant origin
/// [Haines, Günther, Akenine-Möller 2019].
pub(crate) fn cross_unit_sphere(origin: DVec3, direction: DVec3) -> Option<[f64; 2]> {
    let a = direction.length_squared();
    let closest = -origin.dot(direction) / a;
    let foot = origin + direction * closest;
    let half_squared = (1.0 - foot.length_squared()) / a;
    (half_squared > 0.0).then(|| {
        let half = half_squared.sqrt();
        [closest - half, closest + half]
    })
}
