//! Meshes as plane pieces: parallelograms where two triangles make one, triangles elsewhere.

use glam::DVec3;

use crate::scene::{BilinearMesh, TriangleMesh};

/// A parallelogram, or the half of one next to its corner.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Piece {
    pub(super) corner: DVec3,
    /// What leads from it to its neighbours; their product is the normal.
    pub(super) edges: [DVec3; 2],
    pub(super) triangle: bool,
}

/// Corners that are this near to one another, in parts of the mesh, are one.
const SAME: f64 = 1e-9;

impl Piece {
    fn new(corner: DVec3, [a, b]: [DVec3; 2], triangle: bool) -> Self {
        let edges = [a - corner, b - corner];
        Self {
            corner,
            edges,
            triangle,
        }
    }

    /// The same with its sides exchanged.
    pub(super) fn turned(self) -> Self {
        let [e, f] = self.edges;
        Self {
            edges: [f, e],
            ..self
        }
    }

    /// The product of the edges: of its length is the area of the parallelogram.
    pub(super) fn normal(&self) -> DVec3 {
        self.edges[0].cross(self.edges[1])
    }

    pub(super) fn area(&self) -> f64 {
        self.normal().length() * if self.triangle { 0.5 } else { 1.0 }
    }

    /// In order around it.
    pub(super) fn corners(&self) -> Vec<DVec3> {
        let [e, f] = self.edges;
        let [a, b, c] = [self.corner, self.corner + e, self.corner + f];
        if self.triangle {
            vec![a, b, c]
        } else {
            vec![a, b, b + f, c]
        }
    }

    pub(super) fn centre(&self) -> DVec3 {
        let share = if self.triangle { 1.0 / 3.0 } else { 0.5 };
        self.corner + (self.edges[0] + self.edges[1]) * share
    }

    /// The least of its heights, over its sides.
    pub(super) fn least_height(&self) -> f64 {
        let [e, f] = self.edges;
        let longest = e.length().max(f.length());
        let longest = if self.triangle {
            longest.max((f - e).length())
        } else {
            longest
        };
        self.normal().length() / longest
    }

    /// Whether it has an inside in common with another in about the same plane.
    ///
    /// * `near`: what is as good as no distance \[length\].
    pub(super) fn covers(&self, other: &Self, near: f64) -> bool {
        let normal = self.normal().normalize_or_zero();
        let (own, others) = (self.corners(), other.corners());
        let off = |p: &DVec3| (*p - self.corner).dot(normal).abs() > near;
        if others.iter().any(off) {
            return false;
        }
        // Two convex shapes are apart where a side of one of them has all of the other beyond it.
        let apart = |a: &[DVec3], b: &[DVec3], normal: DVec3| {
            (0..a.len()).any(|i| {
                let (from, to) = (a[i], a[(i + 1) % a.len()]);
                let outwards = (to - from).cross(normal).normalize_or_zero();
                b.iter().all(|p| (*p - from).dot(outwards) >= -near)
            })
        };
        let turned = if other.normal().dot(normal) < 0.0 {
            -normal
        } else {
            normal
        };
        !apart(&own, &others, normal) && !apart(&others, &own, turned)
    }
}

/// The parallelogram that two triangles make, if they do, with their normal.
fn joined(a: &[DVec3; 3], b: &[DVec3; 3]) -> Option<Piece> {
    let normal = |[p, q, r]: &[DVec3; 3]| (*q - *p).cross(*r - *p);
    let (n, m) = (normal(a), normal(b));
    let size = a
        .iter()
        .chain(b)
        .fold(0.0_f64, |s, p| s.max(p.abs().max_element()));
    let same = |p: DVec3, q: DVec3| (p - q).length() <= SAME * size;
    if !same(n.normalize_or_zero() * size, m.normalize_or_zero() * size) {
        return None;
    }
    for i in 0..3 {
        // The corner that the other does not have, and the side that both have.
        let [p, s, t] = [a[i], a[(i + 1) % 3], a[(i + 2) % 3]];
        for j in 0..3 {
            let [q, u, v] = [b[j], b[(j + 1) % 3], b[(j + 2) % 3]];
            if same(s, v) && same(t, u) && same(p + q, s + t) {
                return Some(Piece::new(p, [s, t], false));
            }
        }
    }
    None
}

/// The pieces of a mesh of triangles, those without area left out.
pub(super) fn of_triangles(mesh: &TriangleMesh, origin: DVec3) -> Option<Vec<Piece>> {
    let vertex = |i: u32| Some(*mesh.positions.get(i as usize)? - origin);
    let mut pieces = Vec::new();
    let mut before: Option<[DVec3; 3]> = None;
    for &[a, b, c] in &mesh.indices {
        let corners = [vertex(a)?, vertex(b)?, vertex(c)?];
        if let Some(piece) = before.and_then(|last| joined(&last, &corners)) {
            pieces.pop();
            pieces.push(piece);
            before = None;
        } else {
            pieces.push(Piece::new(corners[0], [corners[1], corners[2]], true));
            before = Some(corners);
        }
    }
    pieces.retain(|piece| piece.normal() != DVec3::ZERO);
    Some(pieces)
}

/// The pieces of a mesh of patches, if all are parallelograms.
pub(super) fn of_patches(mesh: &BilinearMesh, origin: DVec3) -> Option<Vec<Piece>> {
    let vertex = |i: u32| Some(*mesh.positions.get(i as usize)? - origin);
    let piece = |&[a, b, c, d]: &[u32; 4]| {
        let [a, b, c, d] = [vertex(a)?, vertex(b)?, vertex(c)?, vertex(d)?];
        let size = a.abs().max(d.abs()).max_element();
        ((a + d) - (b + c))
            .length()
            .le(&(SAME * size))
            .then(|| Piece::new(a, [b, c], false))
    };
    mesh.indices.iter().map(piece).collect()
}
