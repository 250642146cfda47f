//! Bilinear patches: p(u, v) = p00 + u e + v f + u v g.

use glam::{DMat3, DVec2, DVec3};

use super::exact;
use super::spot::Spot;
use crate::line::ROUNDING;
use crate::scene::BilinearMesh;

/// A patch by its coefficients.
#[derive(Clone, Copy, Debug)]
pub(super) struct Patch {
    /// At (u, v) = (0, 0), (1, 0), (0, 1), (1, 1).
    pub(super) corners: [DVec3; 4],
}

/// The corners of a patch; `None` beyond the mesh.
pub(super) fn patch(mesh: &BilinearMesh, origin: DVec3, index: u32) -> Option<Patch> {
    let [a, b, c, d] = *mesh.indices.get(index as usize)?;
    let vertex = |i: u32| mesh.positions.get(i as usize).map(|p| *p - origin);
    Some(Patch {
        corners: [vertex(a)?, vertex(b)?, vertex(c)?, vertex(d)?],
    })
}

impl Patch {
    /// ∂p/∂u.
    fn along_u(&self, v: f64) -> DVec3 {
        let [a, b, c, d] = self.corners;
        (b - a) * (1.0 - v) + (d - c) * v
    }

    /// ∂p/∂v.
    fn along_v(&self, u: f64) -> DVec3 {
        let [a, b, c, d] = self.corners;
        (c - a) * (1.0 - u) + (d - b) * u
    }

    /// p(u, v), always within the hull of the corners.
    pub(super) fn at(&self, at: DVec2) -> DVec3 {
        let [a, b, c, d] = self.corners;
        let (u, v) = (at.x, at.y);
        (a * (1.0 - u) + b * u) * (1.0 - v) + (c * (1.0 - u) + d * u) * v
    }

    /// cross(∂p/∂u, ∂p/∂v): of its length is the area per du dv.
    pub(super) fn normal(&self, at: DVec2) -> DVec3 {
        self.along_u(at.y).cross(self.along_v(at.x))
    }

    /// Whether it has no area.
    pub(super) fn is_degenerate(&self) -> bool {
        let [a, b, c, d] = self.corners;
        [[a, b, c], [b, d, a], [c, a, d], [d, c, b]]
            .iter()
            .all(|corners| exact::normal(corners) == DVec3::ZERO)
    }

    /// Largest coordinate, and longest side or diagonal.
    fn sizes(&self) -> (f64, f64) {
        let [a, b, c, d] = self.corners;
        let size = a.abs().max(b.abs()).max(c.abs()).max(d.abs());
        let reach = [b - a, c - a, d - a, c - b, d - b, d - c]
            .into_iter()
            .fold(0.0_f64, |most, edge| most.max(edge.length()));
        (size.max_element(), reach)
    }

    /// Where a line crosses the patch or its continuation: t, u and v, up to two of them.
    ///
    /// [Reshetov 2019]: the line from p(u, 0) to p(u, 1) meets a given line where a quadratic of u vanishes. Each
    /// root is refined by Newton's method in (u, v, t). The crossings are exact but for a residual of
    /// |p(u, v) − o − t d|, the fourth number.
    fn cross(&self, origin: DVec3, direction: DVec3) -> [Option<(f64, DVec2, f64)>; 2] {
        let near = Self {
            corners: self.corners.map(|p| p - origin),
        };
        let [a, b, c, d] = near.corners;
        let first = a.cross(c - a).dot(direction);
        let last = b.cross(d - b).dot(direction);
        let square = (b - a).cross(d - c).dot(direction);
        let linear = last - first - square;
        let discriminant = linear * linear - 4.0 * square * first;
        if discriminant < 0.0 || discriminant.is_nan() {
            return [None; 2];
        }
        let root = discriminant.sqrt();
        let q = -0.5 * (linear + if linear < 0.0 { -root } else { root });
        let second = (square != 0.0).then(|| near.refine(q / square, direction));
        let first = (q != 0.0).then(|| near.refine(first / q, direction));
        [first.flatten(), second.flatten()]
    }

    /// The crossing near a given u of a line through the origin.
    fn refine(&self, u: f64, direction: DVec3) -> Option<(f64, DVec2, f64)> {
        // Far outside there is nothing to refine.
        if !(u > -0.5 && u < 1.5) {
            return None;
        }
        let start = self.corners[0] * (1.0 - u) + self.corners[1] * u;
        let along = self.along_v(u);
        let across = direction.cross(along);
        let squared = across.length_squared();
        if squared == 0.0 {
            return None;
        }
        let moment = start.cross(across) / squared;
        let mut best = (
            moment.dot(along),
            DVec2::new(u, moment.dot(direction)),
            f64::INFINITY,
        );
        let residual = |t: f64, at: DVec2| -> DVec3 { self.at(at) - direction * t };
        best.2 = residual(best.0, best.1).length();
        let mut current = best;
        for _ in 0..3 {
            let (t, at, _) = current;
            let jacobian = DMat3::from_cols(self.along_u(at.y), self.along_v(at.x), -direction);
            let normal = jacobian.x_axis.cross(jacobian.y_axis);
            let determinant = normal.dot(jacobian.z_axis);
            if determinant == 0.0 {
                break;
            }
            let rest = residual(t, at);
            let du = rest.dot(jacobian.y_axis.cross(jacobian.z_axis)) / determinant;
            let dv = rest.dot(jacobian.z_axis.cross(jacobian.x_axis)) / determinant;
            let dt = rest.dot(normal) / determinant;
            let (t, at) = (t - dt, at - DVec2::new(du, dv));
            current = (t, at, residual(t, at).length());
            // A step that does not help, or is not a number, ends it.
            let better = current.2 < best.2;
            if !better {
                break;
            }
            best = current;
        }
        best.2.is_finite().then_some(best)
    }

    /// How far corners are from the origin of a line.
    fn distance(&self, origin: DVec3) -> f64 {
        self.corners
            .iter()
            .fold(0.0_f64, |most, p| most.max((*p - origin).length()))
    }

    /// Where a ray meets the patch at 0 < t ≤ `t_max`, and (u, v) there.
    ///
    /// The ray passes the place by at most 16 u R, R the distance of the farthest corner: what starts off the
    /// patch by the error bound of [`spot`] and leads away from it cannot meet it there. Edges are open to as much
    /// on either side, so that nothing slips between patches that share one.
    pub(super) fn meet(&self, origin: DVec3, direction: DVec3, t_max: f64) -> Option<(f64, DVec2)> {
        let slack = 16.0 * ROUNDING * self.distance(origin);
        let size = direction.length();
        let mut found: Option<(f64, DVec2)> = None;
        for (t, at, residual) in self.cross(origin, direction).into_iter().flatten() {
            let within = |x: f64, edge: DVec3| {
                (0.0..=1.0).contains(&x) || (-x).max(x - 1.0) * edge.length() <= slack
            };
            let ahead = t > 0.0 && t * size > slack && t <= found.map_or(t_max, |f| f.0);
            if ahead
                && residual <= slack
                && within(at.x, self.along_u(at.y))
                && within(at.y, self.along_v(at.x))
            {
                found = Some((t, at.clamp(DVec2::ZERO, DVec2::ONE)));
            }
        }
        found
    }

    /// (u, v) of a point of the patch, with its normal there.
    pub(super) fn invert(&self, point: DVec3, normal: DVec3) -> Option<DVec2> {
        let [a, b] = self.cross(point, normal);
        let outside = |at: DVec2| (at - at.clamp(DVec2::ZERO, DVec2::ONE)).length_squared();
        let (size, reach) = self.sizes();
        // Both crossings may be near: the one off the patch is not meant.
        let rank = |c: &(f64, DVec2, f64)| c.0.abs() + reach.max(size * 1e-12) * outside(c.1);
        let chosen = match (a, b) {
            (Some(a), Some(b)) if rank(&b) < rank(&a) => b,
            (Some(a), _) => a,
            (None, b) => b?,
        };
        Some(chosen.1.clamp(DVec2::ZERO, DVec2::ONE))
    }
}

/// The place at (u, v).
///
/// The error sums, with S the largest coordinate and L the longest side: the point and the start of a ray (8 u S),
/// what [`Patch::meet`] lets pass (16 u times at most 2 L), and the turn of the normal over the size of the patch.
pub(super) fn spot(mesh: &BilinearMesh, patch: &Patch, index: u32, at: DVec2) -> Spot {
    let (along_u, along_v) = (patch.along_u(at.y), patch.along_v(at.x));
    let mut cross = along_u.cross(along_v);
    if cross == DVec3::ZERO {
        // A corner where the patch is pointed.
        cross = patch.normal(DVec2::splat(0.5));
    }
    let normal = cross.normalize_or_zero();
    let indices = mesh
        .indices
        .get(index as usize)
        .copied()
        .unwrap_or_default();
    let (u, v) = (at.x, at.y);
    let weights = [(1.0 - u) * (1.0 - v), u * (1.0 - v), (1.0 - u) * v, u * v];
    let normals = indices.map(|i| mesh.normals.get(i as usize).copied());
    let shading_normal = match normals {
        [Some(a), Some(b), Some(c), Some(d)] => {
            a * weights[0] + b * weights[1] + c * weights[2] + d * weights[3]
        }
        _ => normal,
    };
    let uvs = indices.map(|i| mesh.uv.get(i as usize).copied());
    let (uv, tangent) = match uvs {
        [Some(a), Some(b), Some(c), Some(d)] => {
            let st = a * weights[0] + b * weights[1] + c * weights[2] + d * weights[3];
            let by_u = (b - a) * (1.0 - v) + (d - c) * v;
            let by_v = (c - a) * (1.0 - u) + (d - b) * u;
            let determinant = by_u.x * by_v.y - by_u.y * by_v.x;
            let tangent = if determinant == 0.0 {
                DVec3::ZERO
            } else {
                (along_u * by_v.y - along_v * by_u.y) / determinant
            };
            (st, tangent)
        }
        _ => (at, along_u),
    };
    let (size, reach) = patch.sizes();
    let sharpness = along_u.length() * along_v.length() / cross.length();
    let turn = if sharpness < 1e6 { sharpness } else { 1e6 };
    Spot {
        point: patch.at(at),
        normal,
        shading_normal,
        tangent,
        uv,
        error: ROUNDING * (16.0 * size + (80.0 + 8.0 * turn) * reach),
        reach,
    }
}
