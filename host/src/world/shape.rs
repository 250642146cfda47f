//! Boundaries whose shape needs no search: spheres and parallelepipeds.

use glam::{DAffine3, DMat3, DVec3};
use woodcock_core::path::Convex;

use super::boundaries::unit_sphere;
use super::medium::{Support, rows};
use crate::scene::{Boundary, Enclosure, TriangleMesh};

/// A convex region, with its inside known.
#[derive(Clone, Copy, Debug)]
pub(super) enum Region {
    /// The unit sphere of the space that the map leads to.
    Sphere(DAffine3),
    /// The unit cube [0, 1]³ of the space that the map leads to.
    Cube(DAffine3),
}

impl Region {
    /// The region of a boundary whose surface encloses it with its normals outwards, if it is that simple.
    pub(super) fn of(boundary: &Boundary, origin: DVec3) -> Option<Self> {
        match &boundary.shape {
            Enclosure::Sphere(sphere) => Some(Self::Sphere(unit_sphere(sphere, origin))),
            Enclosure::TriangleMesh(mesh) => Some(Self::Cube(unit_cube(mesh, origin)?)),
        }
    }

    /// Whether every one of these points lies inside, and with them their convex hull.
    pub(super) fn contains(&self, points: &[DVec3]) -> bool {
        points.iter().all(|&point| match self {
            Self::Sphere(to_unit) => to_unit.transform_point3(point).length_squared() <= 1.0,
            Self::Cube(to_unit) => {
                let p = to_unit.transform_point3(point);
                p.min_element() >= 0.0 && p.max_element() <= 1.0
            }
        })
    }

    /// As the kernels see it.
    pub(super) fn convex(&self) -> Convex {
        match self {
            Self::Sphere(to_unit) => Convex::Sphere {
                to_local: rows(to_unit),
            },
            Self::Cube(to_unit) => Convex::Box {
                to_local: rows(to_unit),
                size: [1.0; 3],
            },
        }
    }
}

/// The box of a grid as kernels see it.
pub(super) fn convex_box(support: &Support) -> Convex {
    let size = support.size.to_array().map(|s| s as f32);
    Convex::Box {
        to_local: rows(&support.to_local),
        size,
    }
}

/// Recognises the twelve triangles of a parallelepiped with its normals outwards, and gives the map to the
/// unit cube.
fn unit_cube(mesh: &TriangleMesh, origin: DVec3) -> Option<DAffine3> {
    if mesh.indices.len() != 12 {
        return None;
    }
    let corners = |t: &[u32; 3]| -> Option<[DVec3; 3]> {
        let corner = |i: u32| mesh.positions.get(i as usize).map(|p| *p - origin);
        Some([corner(t[0])?, corner(t[1])?, corner(t[2])?])
    };
    let triangles: Vec<_> = mesh.indices.iter().map(corners).collect::<Option<_>>()?;
    let mut points: Vec<DVec3> = Vec::with_capacity(8);
    for &p in triangles.iter().flatten() {
        if !points.contains(&p) {
            points.push(p);
        }
    }
    if points.len() != 8 {
        return None;
    }
    let first = points[0];
    let size = points
        .iter()
        .map(|p| (*p - first).length())
        .fold(0.0, f64::max);
    // Three edges from the first corner lead to its neighbours; try all triples of corners.
    for i in 1..8 {
        for j in i + 1..8 {
            for k in j + 1..8 {
                let (a, b, c) = (points[i] - first, points[j] - first, points[k] - first);
                let matrix3 = DMat3::from_cols(a, b, c);
                if matrix3.determinant().abs() < 1e-9 * size.powi(3) {
                    continue;
                }
                let to_unit = DAffine3 {
                    matrix3,
                    translation: first,
                }
                .inverse();
                if is_cube(&to_unit, &triangles) {
                    return Some(to_unit);
                }
            }
        }
    }
    None
}

/// Whether triangles are, in the space of the map, two halves of each face of the unit cube, normals outwards.
fn is_cube(to_unit: &DAffine3, triangles: &[[DVec3; 3]]) -> bool {
    const NEAR: f64 = 1e-9;
    let mirrored = to_unit.matrix3.determinant() < 0.0;
    let mut faces = [[0.0_f64; 2]; 3];
    for triangle in triangles {
        let local = triangle.map(|p| to_unit.transform_point3(p));
        let at_corner = |x: f64| x.abs() < NEAR || (x - 1.0).abs() < NEAR;
        if !local
            .iter()
            .all(|p| p.to_array().into_iter().all(at_corner))
        {
            return false;
        }
        let normal = (local[1] - local[0]).cross(local[2] - local[0]);
        let outwards = if mirrored { -normal } else { normal };
        let Some(axis) = (0..3).find(|&axis| (outwards[axis].abs() - 1.0).abs() < NEAR) else {
            return false;
        };
        let side = local[0][axis].round();
        if (outwards[axis] > 0.0) != (side > 0.5) {
            return false;
        }
        faces[axis][usize::from(side > 0.5)] += 1.0;
    }
    // The centroids of a face's two halves lie opposite each other about its middle.
    let centres: Vec<DVec3> = triangles
        .iter()
        .map(|t| to_unit.transform_point3((t[0] + t[1] + t[2]) / 3.0))
        .collect();
    let halves = centres.iter().all(|a| {
        centres
            .iter()
            .filter(|b| {
                let sum = *a + **b;
                let face = (0..3).any(|i| (a[i] - b[i]).abs() < NEAR && at_face(a[i]));
                face && (0..3).all(|i| at_face(a[i]) || (sum[i] - 1.0).abs() < 1e-6)
            })
            .count()
            == 1
    });
    faces.as_flattened().iter().all(|&n| n == 2.0) && halves
}

fn at_face(x: f64) -> bool {
    x.abs() < 1e-9 || (x - 1.0).abs() < 1e-9
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A sheared box; corners are numbered around the bottom (0 to 3), then around the top.
    fn parallelepiped(triangles: [[u32; 3]; 12]) -> TriangleMesh {
        let square = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        let corner = |i: usize| {
            let ([x, y], z) = (square[i % 4], if i < 4 { 0.0 } else { 1.0 });
            DVec3::new(2.0 * x + 0.5 * y, 3.0 * y + 0.25 * z, 4.0 * z)
        };
        TriangleMesh {
            positions: (0..8).map(corner).collect(),
            indices: triangles.to_vec(),
            ..TriangleMesh::default()
        }
    }

    const OUTWARDS: [[u32; 3]; 12] = [
        [0, 2, 1],
        [0, 3, 2],
        [4, 5, 6],
        [4, 6, 7],
        [0, 1, 5],
        [0, 5, 4],
        [3, 7, 6],
        [3, 6, 2],
        [0, 4, 7],
        [0, 7, 3],
        [1, 2, 6],
        [1, 6, 5],
    ];

    #[test]
    fn recognises_a_sheared_box() {
        let to_unit = unit_cube(&parallelepiped(OUTWARDS), DVec3::ZERO).expect("a box");
        let middle = to_unit.transform_point3(DVec3::new(1.25, 1.625, 2.0));
        assert!((middle - DVec3::splat(0.5)).length() < 1e-12, "{middle}");
    }

    #[test]
    fn refuses_what_is_no_closed_box_with_outward_normals() {
        let inwards = OUTWARDS.map(|[a, b, c]| [a, c, b]);
        assert!(unit_cube(&parallelepiped(inwards), DVec3::ZERO).is_none());
        let mut one_turned = OUTWARDS;
        one_turned[4] = [0, 5, 1];
        assert!(unit_cube(&parallelepiped(one_turned), DVec3::ZERO).is_none());
        let mut twice_the_same_half = OUTWARDS;
        twice_the_same_half[1] = [2, 1, 0];
        assert!(unit_cube(&parallelepiped(twice_the_same_half), DVec3::ZERO).is_none());
        let mut halves_that_overlap = OUTWARDS;
        halves_that_overlap[1] = [0, 3, 1];
        assert!(unit_cube(&parallelepiped(halves_that_overlap), DVec3::ZERO).is_none());
    }
}
