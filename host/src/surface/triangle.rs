//! Triangles of meshes.

use glam::{DVec2, DVec3};

use super::exact;
use super::spot::Spot;
use crate::line::{ROUNDING, Shear};
use crate::scene::TriangleMesh;

/// The corners of a triangle; `None` beyond the mesh.
pub(super) fn corners(mesh: &TriangleMesh, origin: DVec3, index: u32) -> Option<[DVec3; 3]> {
    let [a, b, c] = *mesh.indices.get(index as usize)?;
    let vertex = |i: u32| mesh.positions.get(i as usize).map(|p| *p - origin);
    Some([vertex(a)?, vertex(b)?, vertex(c)?])
}

/// Where a ray meets a triangle at 0 < t ≤ `t_max`, and the weights of its second and third corner.
///
/// A t that rounding could have made positive is none: so a ray that starts off the triangle's plane by the error
/// bound of [`spot`], and leads away from it, cannot meet it.
pub(super) fn meet(
    corners: &[DVec3; 3],
    shear: &Shear,
    origin: DVec3,
    t_max: f64,
) -> Option<(f64, DVec2)> {
    let crossing = shear.cross(corners, origin)?;
    let t = crossing.t;
    let ahead = t > 0.0 && t <= t_max && t > shear.error(&crossing);
    ahead.then(|| (t, DVec2::from(crossing.weights())))
}

/// The place with given weights of the second and third corner, within the plane but for rounding.
///
/// The error sums, with u = 2⁻⁵³, S the largest coordinate and L the longest edge: the edges and their weighted sum
/// (6 u L), the last addition (2 u S), the start of a ray (2 u S), the turn of the normal and the sign of its
/// product with a direction, over the length of the triangle (8 u L). Twice that is taken.
pub(super) fn spot(mesh: &TriangleMesh, corners: &[DVec3; 3], index: u32, weights: DVec2) -> Spot {
    let (b, c) = (weights.x, weights.y);
    let a = 1.0 - b - c;
    let [p, q, r] = *corners;
    let (e, f) = (q - p, r - p);
    let normal = exact::normal(corners).normalize_or_zero();
    let indices = mesh
        .indices
        .get(index as usize)
        .copied()
        .unwrap_or_default();
    let uvs = indices.map(|i| mesh.uv.get(i as usize).copied());
    let [s, t, w] = match uvs {
        [Some(s), Some(t), Some(w)] => [s, t, w],
        _ => [DVec2::ZERO, DVec2::X, DVec2::ONE],
    };
    let normals = indices.map(|i| mesh.normals.get(i as usize).copied());
    let shading_normal = match normals {
        [Some(l), Some(m), Some(n)] => l * a + m * b + n * c,
        _ => normal,
    };
    let (g, h) = (t - s, w - s);
    let determinant = g.x * h.y - g.y * h.x;
    let tangent = if determinant == 0.0 {
        DVec3::ZERO
    } else {
        (e * h.y - f * g.y) / determinant
    };
    let size = p.abs().max(q.abs()).max(r.abs()).max_element();
    let reach = e.length().max(f.length()).max((r - q).length());
    Spot {
        point: p + (e * b + f * c),
        normal,
        shading_normal,
        tangent,
        uv: s * a + t * b + w * c,
        error: ROUNDING * (8.0 * size + 32.0 * reach),
        reach,
    }
}
