//! Where a ray crosses a surface, and which crossings of one boundary make intervals.

use glam::DVec3;

use crate::line::{Shear, cross_unit_sphere};

/// A surface between media, in the world as rendered.
#[derive(Clone, Debug)]
pub(super) enum Surface {
    /// A triangle of a mesh.
    Triangle([DVec3; 3]),
    /// The unit sphere of the space that the map leads to.
    Sphere(glam::DAffine3),
}

/// A crossing of a ray with a boundary.
#[derive(Clone, Copy, Debug)]
pub(super) struct Crossing {
    pub(super) t: f64,
    pub(super) boundary: usize,
    /// Towards the inside.
    pub(super) enters: bool,
}

/// The intervals between the crossings of one boundary: those that alternate count.
pub(super) fn inside(crossings: &[Crossing], boundary: usize) -> impl Iterator<Item = (f64, f64)> {
    let mut entry = None;
    let mut begun = false;
    crossings
        .iter()
        .filter(move |c| c.boundary == boundary)
        .filter_map(move |c| {
            let first = !begun;
            begun = true;
            match (c.enters, entry) {
                (true, None) => {
                    entry = Some(c.t);
                    None
                }
                (false, Some(t0)) => {
                    entry = None;
                    Some((t0, c.t))
                }
                // Out before in: the ray begins inside.
                (false, None) if first => Some((0.0, c.t)),
                _ => None,
            }
        })
}

/// Adds the crossings of a ray with a surface, at t > 0.
pub(super) fn cross(
    surface: &Surface,
    boundary: usize,
    origin: DVec3,
    direction: DVec3,
    shear: &Shear,
    crossings: &mut Vec<Crossing>,
) {
    match surface {
        Surface::Triangle(corners) => {
            if let Some((t, enters)) = cross_triangle(corners, origin, direction, shear) {
                crossings.push(Crossing {
                    t,
                    boundary,
                    enters,
                });
            }
        }
        Surface::Sphere(to_unit) => {
            let o = to_unit.transform_point3(origin);
            let d = to_unit.transform_vector3(direction);
            if let Some([enter, leave]) = cross_unit_sphere(o, d) {
                let ends = [(enter, true), (leave, false)];
                crossings.extend(
                    ends.into_iter()
                        .filter(|end| end.0 > 0.0)
                        .map(|(t, enters)| Crossing {
                            t,
                            boundary,
                            enters,
                        }),
                );
            }
        }
    }
}

/// Where a ray crosses a triangle, and whether it does so against the normal.
///
/// * `shear`: that of the direction, for it serves all triangles of a ray.
#[inline]
pub(super) fn cross_triangle(
    corners: &[DVec3; 3],
    origin: DVec3,
    direction: DVec3,
    shear: &Shear,
) -> Option<(f64, bool)> {
    let t = shear.cross(corners, origin)?.t;
    let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
    (t > 0.0 && t.is_finite()).then(|| (t, normal.dot(direction) < 0.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A cube of two triangles a side around the origin, normals outwards.
    fn cube(half: f64) -> Vec<[DVec3; 3]> {
        let mut triangles = Vec::new();
        for axis in 0..3 {
            for sign in [-1.0, 1.0] {
                let corner = |u: f64, v: f64| {
                    let mut p = [0.0; 3];
                    p[axis] = sign * half;
                    p[(axis + 1) % 3] = u * half;
                    p[(axis + 2) % 3] = v * half * sign;
                    DVec3::from_array(p)
                };
                let [a, b, c, d] = [
                    corner(-1.0, -1.0),
                    corner(1.0, -1.0),
                    corner(1.0, 1.0),
                    corner(-1.0, 1.0),
                ];
                triangles.extend([[a, b, c], [a, c, d]]);
            }
        }
        triangles
    }

    #[test]
    fn a_closed_mesh_is_crossed_in_pairs_along_edges_and_faces_too() {
        let mesh = cube(1.0);
        // Directions through corners, edges and the diagonals of faces, and nearly parallel ones, from far away.
        let targets = [-1.0, -0.5, 0.0, 1e-9, 1.0 / 3.0, 1.0];
        for (x, y) in targets
            .iter()
            .flat_map(|x| targets.iter().map(move |y| (*x, *y)))
        {
            let target = DVec3::new(x, y, 0.0);
            for origin in [DVec3::new(3.0, 3.0, 3.0), DVec3::new(1e6, 2e6, -3e6)] {
                let direction = (target - origin).normalize();
                let mut crossings = Vec::new();
                for triangle in &mesh {
                    cross(
                        &Surface::Triangle(*triangle),
                        0,
                        origin,
                        direction,
                        &Shear::new(direction),
                        &mut crossings,
                    );
                }
                crossings.sort_by(|a, b| a.t.total_cmp(&b.t));
                let count = inside(&crossings, 0).count();
                assert!(count <= 1, "{crossings:?}");
                if x.abs() < 0.9 && y.abs() < 0.9 {
                    assert_eq!(count, 1, "{target} from {origin}: {crossings:?}");
                }
            }
        }
    }

    #[test]
    fn the_first_crossing_says_where_a_ray_begins() {
        let crossing = |t, enters| Crossing {
            t,
            boundary: 0,
            enters,
        };
        let list = |c: &[Crossing]| inside(c, 0).collect::<Vec<_>>();
        assert_eq!(
            list(&[crossing(1.0, true), crossing(2.0, false)]),
            [(1.0, 2.0)]
        );
        assert_eq!(list(&[crossing(2.0, false)]), [(0.0, 2.0)]);
        // An edge counted twice, and a surface that is not closed.
        let doubled = [
            crossing(1.0, true),
            crossing(1.0, true),
            crossing(2.0, false),
        ];
        assert_eq!(list(&doubled), [(1.0, 2.0)]);
        assert_eq!(list(&[crossing(1.0, true)]), []);
    }
}
