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

use super::crossing::{Crossing, Surface, cross, inside};
use super::medium::Support;
use crate::line::Shear;
use crate::scene;

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
pub(super) fn facing(shape: &scene::Enclosure) -> Facing {
    let scene::Enclosure::TriangleMesh(mesh) = shape else {
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
                scene::Enclosure::Sphere(sphere) => {
                    surfaces.push((Surface::Sphere(unit_sphere(sphere, origin)), index));
                }
                scene::Enclosure::TriangleMesh(mesh) => {
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

    /// Whether different media may share a place.
    pub(super) fn overlap(&self) -> bool {
        self.overlaps
    }

    /// The medium that fills space outside of every boundary.
    pub(super) fn exterior(&self) -> Option<usize> {
        self.exterior
    }

    /// The stretches of a ray within media, sorted by where they begin.
    pub(super) fn stretches(
        &self,
        origin: DVec3,
        direction: DVec3,
        found: &mut Vec<(f64, f64, usize)>,
    ) {
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
        let shear = Shear::new(direction);
        let vec = |v: DVec3| Vec3A::new(v.x as f32, v.y as f32, v.z as f32);
        bvh.ray_traverse_anyhit(BvhRay::new_inf(vec(origin), vec(direction)), |_, place| {
            let surface = bvh.primitive_indices.get(place);
            if let Some((surface, boundary)) = surface.and_then(|&i| self.surfaces.get(i as usize))
            {
                cross(
                    surface,
                    *boundary,
                    origin,
                    direction,
                    &shear,
                    &mut crossings,
                );
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
