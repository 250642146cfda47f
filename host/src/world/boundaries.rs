//! Media bounded by any closed surfaces: intervals on a ray from all crossings at once.
//!
//! A ray is met with every surface ahead of it, in double precision. The crossings of one boundary,
//! sorted, must alternate between in and out; the first of them says whether the ray begins inside. So
//! no state travels with a path, no offsets are needed, and a crossing that an edge reports twice or not
//! at all cannot leave a ray in the wrong medium for longer than that one ray.
//!
//! A boundary adds its inner medium between its crossings and takes away its outer one, so that a cloud
//! whose boundary says "outside is fog" displaces the fog. Regions of different media that overlap
//! otherwise hold both: coefficients add.

use std::collections::HashMap;
use std::time::Duration;

use glam::{DVec3, Vec3A};
use obvhs::aabb::Aabb;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::builder::build_bvh2;
use obvhs::{BvhBuildParams, ray::Ray as BvhRay};
use woodcock_core::path::{Geometry, Stretch};
use woodcock_core::ray::{FAR, Interval, Ray};
use woodcock_core::real::{Mask, Real, Word};

use super::medium::Support;
use crate::scene;

/// A surface between media, in the world as rendered.
#[derive(Clone, Debug)]
enum Surface {
    /// A triangle of a mesh.
    Triangle([DVec3; 3]),
    /// The unit sphere of the space that the map leads to.
    Sphere(glam::DAffine3),
}

/// A crossing of a ray with a boundary.
#[derive(Clone, Copy, Debug)]
struct Crossing {
    t: f64,
    boundary: usize,
    /// Towards the inside.
    enters: bool,
}

/// Which media a boundary has on its sides; indices of assembled media.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sides {
    /// Behind the normal.
    pub inside: Option<usize>,
    /// In front of it.
    pub outside: Option<usize>,
}

impl Sides {
    /// The same surface seen with its normals turned around.
    pub(super) const fn swapped(self) -> Self {
        Self {
            inside: self.outside,
            outside: self.inside,
        }
    }
}

/// Which way the normals of a surface point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Facing {
    /// Out of the region that it encloses.
    Outwards,
    /// Into it: what lies behind them has no bound.
    Inwards,
    /// It encloses no region.
    Open,
}

/// Which way the normals of a shape point: by the sign of the volume that its triangles enclose, if every edge
/// is shared by as many triangles in one direction as in the other.
pub(super) fn facing(shape: &scene::Shape) -> Facing {
    let scene::Shape::TriangleMesh(mesh) = shape else {
        return Facing::Outwards;
    };
    let vertex = |i: u32| mesh.positions.get(i as usize).copied().unwrap_or_default();
    // Meshes often repeat a vertex for each face, so places are compared and not indices.
    let key = |p: DVec3| (p + DVec3::ZERO).to_array().map(f64::to_bits);
    let mut edges: HashMap<_, i64> = HashMap::new();
    let mut volume = 0.0;
    let middle = mesh.positions.first().copied().unwrap_or_default();
    for triangle in &mesh.indices {
        let [a, b, c] = triangle.map(vertex);
        volume += (a - middle).dot((b - middle).cross(c - middle));
        for (from, to) in [(a, b), (b, c), (c, a)] {
            let (from, to) = (key(from), key(to));
            let (edge, direction) = if from < to {
                ((from, to), 1)
            } else {
                ((to, from), -1)
            };
            // An edge of no length is no edge.
            *edges.entry(edge).or_default() += if from == to { 0 } else { direction };
        }
    }
    let closed = volume != 0.0 && edges.values().all(|&balance| balance == 0);
    match (closed, volume < 0.0) {
        (false, _) => Facing::Open,
        (true, false) => Facing::Outwards,
        (true, true) => Facing::Inwards,
    }
}

/// All boundaries of a scene, with the media between them.
pub struct Boundaries {
    surfaces: Vec<(Surface, usize)>,
    sides: Vec<Sides>,
    /// The medium that fills space outside of every boundary.
    exterior: Option<usize>,
    supports: Vec<Option<Support>>,
    bvh: Option<Bvh2>,
    overlaps: bool,
}

impl std::fmt::Debug for Boundaries {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Boundaries")
            .field("surfaces", &self.surfaces.len())
            .field("sides", &self.sides)
            .field("exterior", &self.exterior)
            .finish_non_exhaustive()
    }
}

/// The corners of a box around a surface.
fn bounds(surface: &Surface) -> (DVec3, DVec3) {
    match surface {
        Surface::Triangle([a, b, c]) => (a.min(*b).min(*c), a.max(*b).max(*c)),
        Surface::Sphere(to_unit) => {
            let from_unit = to_unit.inverse();
            let m = from_unit.matrix3.transpose();
            let reach = DVec3::new(m.x_axis.length(), m.y_axis.length(), m.z_axis.length());
            (from_unit.translation - reach, from_unit.translation + reach)
        }
    }
}

/// Rounded outwards, with room for the rounding of the traversal's own slab test.
fn aabb((low, high): (DVec3, DVec3)) -> Aabb {
    let room = (high - low).max_element() * 1e-5 + low.abs().max(high.abs()).max_element() * 1e-5;
    let vec = |v: DVec3| Vec3A::new(v.x as f32, v.y as f32, v.z as f32);
    Aabb::new(
        vec(low - DVec3::splat(room)),
        vec(high + DVec3::splat(room)),
    )
}

impl Boundaries {
    /// Sorts surfaces for traversal.
    ///
    /// * `boundaries`: with the media on their sides, as if normals that point inwards pointed outwards.
    /// * `origin`: the place of the world that becomes the origin of rendering.
    /// * `supports`: for each assembled medium the box that bounds it, if any.
    pub fn new(
        boundaries: &[(&scene::Boundary, Sides)],
        exterior: Option<usize>,
        supports: Vec<Option<Support>>,
        origin: DVec3,
        overlaps: bool,
    ) -> Self {
        let mut surfaces = Vec::new();
        for (index, (boundary, _)) in boundaries.iter().enumerate() {
            match &boundary.shape {
                scene::Shape::Sphere(sphere) => {
                    surfaces.push((Surface::Sphere(unit_sphere(sphere, origin)), index));
                }
                scene::Shape::TriangleMesh(mesh) => {
                    let vertex = |i: u32| mesh.positions.get(i as usize).map(|p| *p - origin);
                    let inwards = facing(&boundary.shape) == Facing::Inwards;
                    let triangles = mesh.indices.iter().filter_map(|&[a, b, c]| {
                        let [b, c] = if inwards { [c, b] } else { [b, c] };
                        Some(Surface::Triangle([vertex(a)?, vertex(b)?, vertex(c)?]))
                    });
                    surfaces.extend(triangles.map(|t| (t, index)));
                }
            }
        }
        let boxes: Vec<_> = surfaces.iter().map(|(s, _)| aabb(bounds(s))).collect();
        let bvh = (!boxes.is_empty()).then(|| {
            build_bvh2(
                &boxes,
                BvhBuildParams::medium_build(),
                &mut Duration::default(),
            )
        });
        Self {
            surfaces,
            sides: boundaries.iter().map(|(_, sides)| *sides).collect(),
            exterior,
            supports,
            bvh,
            overlaps,
        }
    }

    /// The medium that fills space outside of every boundary.
    pub(super) fn exterior(&self) -> Option<usize> {
        self.exterior
    }

    /// The stretches of a ray within media, sorted by where they begin.
    fn stretches(&self, origin: DVec3, direction: DVec3, found: &mut Vec<(f64, f64, usize)>) {
        let crossings = self.crossings(origin, direction);
        let mut events = Vec::with_capacity(2 * crossings.len());
        for (boundary, sides) in self.sides.iter().enumerate() {
            for (t0, t1) in inside(&crossings, boundary) {
                if let Some(medium) = sides.inside {
                    events.extend([(t0, medium, 1), (t1, medium, -1)]);
                }
                if let Some(medium) = sides.outside {
                    events.extend([(t0, medium, -1), (t1, medium, 1)]);
                }
            }
        }
        if let Some(medium) = self.exterior {
            events.push((0.0, medium, 1));
        }
        events.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        found.clear();
        for (medium, support) in self.supports.iter().enumerate() {
            let clip = support.as_ref().map_or((0.0, f64::INFINITY), |support| {
                clip(support, origin, direction)
            });
            let mut layers = 0;
            let mut since = 0.0;
            let mut push = |t0: f64, t1: f64| {
                let (t0, t1) = (t0.max(clip.0), t1.min(clip.1));
                if t0 < t1 {
                    found.push((t0, t1, medium));
                }
            };
            for &(t, _, change) in events.iter().filter(|event| event.1 == medium) {
                let before = layers > 0;
                layers += change;
                match (before, layers > 0) {
                    (false, true) => since = t,
                    (true, false) => push(since, t),
                    _ => {}
                }
            }
            if layers > 0 {
                push(since, f64::INFINITY);
            }
        }
        found.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.2.cmp(&b.2)));
    }

    /// All crossings ahead, sorted.
    fn crossings(&self, origin: DVec3, direction: DVec3) -> Vec<Crossing> {
        let mut crossings = Vec::new();
        let Some(bvh) = &self.bvh else {
            return crossings;
        };
        let vec = |v: DVec3| Vec3A::new(v.x as f32, v.y as f32, v.z as f32);
        bvh.ray_traverse_anyhit(BvhRay::new_inf(vec(origin), vec(direction)), |_, place| {
            let surface = bvh.primitive_indices.get(place);
            if let Some((surface, boundary)) = surface.and_then(|&i| self.surfaces.get(i as usize))
            {
                cross(surface, *boundary, origin, direction, &mut crossings);
            }
        });
        crossings.sort_by(|a, b| {
            a.t.total_cmp(&b.t)
                .then(a.boundary.cmp(&b.boundary))
                .then(a.enters.cmp(&b.enters))
        });
        crossings
    }
}

/// World as rendered to the space where a sphere is the unit sphere.
pub(super) fn unit_sphere(sphere: &scene::Sphere, origin: DVec3) -> glam::DAffine3 {
    let from_unit = glam::DAffine3::from_translation(-origin)
        * sphere.object_to_world
        * glam::DAffine3::from_scale(DVec3::splat(sphere.radius));
    from_unit.inverse()
}

/// The part of a ray within a medium's box.
fn clip(support: &Support, origin: DVec3, direction: DVec3) -> (f64, f64) {
    let o = support.to_local.transform_point3(origin);
    let d = support.to_local.transform_vector3(direction);
    let (mut t0, mut t1) = (0.0_f64, f64::INFINITY);
    for axis in 0..3 {
        let (a, b) = (-o[axis] / d[axis], (support.size[axis] - o[axis]) / d[axis]);
        if d[axis] == 0.0 {
            if o[axis] < 0.0 || o[axis] > support.size[axis] {
                return (0.0, 0.0);
            }
        } else {
            t0 = t0.max(a.min(b));
            t1 = t1.min(a.max(b));
        }
    }
    (t0, t1)
}

/// The intervals between the crossings of one boundary: those that alternate count.
fn inside(crossings: &[Crossing], boundary: usize) -> impl Iterator<Item = (f64, f64)> {
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
fn cross(
    surface: &Surface,
    boundary: usize,
    origin: DVec3,
    direction: DVec3,
    crossings: &mut Vec<Crossing>,
) {
    match surface {
        Surface::Triangle(corners) => {
            if let Some((t, enters)) = cross_triangle(corners, origin, direction) {
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
            let a = d.length_squared();
            let closest = -o.dot(d) / a;
            let foot = o + d * closest;
            let half_squared = (1.0 - foot.length_squared()) / a;
            if half_squared > 0.0 {
                let half = half_squared.sqrt();
                let ends = [(closest - half, true), (closest + half, false)];
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

/// Watertight ray-triangle intersection after Woop, Benthin and Wald 2013: the triangle is sheared so that
/// the ray runs along z, and edges are judged by signs that two triangles sharing them agree on.
fn cross_triangle(corners: &[DVec3; 3], origin: DVec3, direction: DVec3) -> Option<(f64, bool)> {
    let size = direction.abs();
    let kz = if size.x > size.y && size.x > size.z {
        0
    } else if size.y > size.z {
        1
    } else {
        2
    };
    let (kx, ky) = ((kz + 1) % 3, (kz + 2) % 3);
    let sz = 1.0 / direction[kz];
    let (sx, sy) = (direction[kx] * sz, direction[ky] * sz);
    let sheared = corners.map(|corner| {
        let p = corner - origin;
        (p[kx] - sx * p[kz], p[ky] - sy * p[kz], sz * p[kz])
    });
    let [a, b, c] = sheared;
    let u = c.0 * b.1 - c.1 * b.0;
    let v = a.0 * c.1 - a.1 * c.0;
    let w = b.0 * a.1 - b.1 * a.0;
    let any_negative = u < 0.0 || v < 0.0 || w < 0.0;
    let any_positive = u > 0.0 || v > 0.0 || w > 0.0;
    let determinant = u + v + w;
    if (any_negative && any_positive) || determinant == 0.0 {
        return None;
    }
    let t = (u * a.2 + v * b.2 + w * c.2) / determinant;
    let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
    (t > 0.0 && t.is_finite()).then(|| (t, normal.dot(direction) < 0.0))
}

impl<R: Real> Geometry<R> for Boundaries {
    fn overlaps(&self) -> bool {
        self.overlaps
    }

    fn stretch(&self, ray: &Ray<R>, cursor: R::Word, active: R::Mask) -> Stretch<R> {
        let mut interval = Interval {
            t0: R::zero(),
            t1: R::zero(),
        };
        let mut medium = R::Word::splat(0);
        let mut has = R::Word::splat(0);
        let mut found = Vec::new();
        for lane in (0..R::LANES).filter(|&lane| active.lane(lane)) {
            let vec = |v: [f32; 3]| DVec3::from_array(v.map(f64::from));
            let (origin, direction) = (vec(ray.origin.lane(lane)), vec(ray.direction.lane(lane)));
            self.stretches(origin, direction, &mut found);
            if let Some(&(t0, t1, id)) = found.get(cursor.lane(lane) as usize) {
                interval.t0.set_lane(lane, t0 as f32);
                interval.t1.set_lane(lane, t1.min(f64::from(FAR)) as f32);
                medium.set_lane(lane, id as u32);
                has.set_lane(lane, 1);
            }
        }
        Stretch {
            interval,
            medium,
            found: has.eq(R::Word::splat(1)),
        }
    }
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
