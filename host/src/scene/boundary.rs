//! Surfaces at which one medium gives way to another, and the shapes that surfaces have.

use std::sync::Arc;

use glam::{DAffine3, DVec2, DVec3};

use super::{MediumId, Place};

/// A surface with a medium on either side.
///
/// The side that the normal points to is `outside`. A sphere's normal points away from its centre, a
/// triangle's is `cross(p1 - p0, p2 - p0)`. Everything pbrt says about orientation
/// (`ReverseOrientation`, mirroring transforms, vertex normals) is already worked into the order of
/// the vertices and into which medium is which.
#[derive(Clone, Debug)]
pub struct Boundary {
    /// The surface.
    pub shape: Enclosure,
    /// Medium behind the normal; `None` is vacuum.
    pub inside: Option<MediumId>,
    /// Medium in front of the normal; `None` is vacuum.
    pub outside: Option<MediumId>,
    /// Where it is described.
    pub place: Place,
}

impl Boundary {
    /// Whether crossing it changes the medium. If not, it can be left out: as in pbrt, a surface with
    /// the same medium on both sides leaves a ray in whatever medium it was.
    pub fn is_transition(&self) -> bool {
        self.inside != self.outside
    }
}

/// The geometry of a boundary: what can enclose space. The reader turns other shapes into triangles.
#[derive(Clone, Debug)]
pub enum Enclosure {
    /// A full sphere, or ellipsoid under a general transform.
    Sphere(Sphere),
    /// Triangles.
    TriangleMesh(Arc<TriangleMesh>),
}

/// The geometry of a surface.
#[derive(Clone, Debug)]
pub enum Shape {
    /// A full sphere, or ellipsoid under a general transform.
    Sphere(Sphere),
    /// Triangles.
    TriangleMesh(Arc<TriangleMesh>),
    /// Bilinear patches.
    BilinearMesh(Arc<BilinearMesh>),
    /// A disk or ring.
    Disk(Disk),
}

/// The sphere of `radius` around the origin of its own space. Its normal points away from the centre,
/// whatever the transform.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sphere {
    /// \[length of the sphere's space\], positive.
    pub radius: f64,
    /// From the sphere's space to the world; invertible, perhaps neither rigid nor uniform.
    pub object_to_world: DAffine3,
}

/// Triangles over shared vertices.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TriangleMesh {
    /// Vertices in the world, finite.
    pub positions: Vec<DVec3>,
    /// Three vertices per triangle, all within `positions`. Triangles may be degenerate.
    pub indices: Vec<[u32; 3]>,
    /// A shading normal per vertex, of any length, on the side of the geometric one; or none at all.
    pub normals: Vec<DVec3>,
    /// (u, v) per vertex, or none at all: then the corners have (0, 0), (1, 0), (1, 1), as in pbrt.
    pub uv: Vec<DVec2>,
}

/// Bilinear patches over shared vertices.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct BilinearMesh {
    /// Vertices in the world, finite.
    pub positions: Vec<DVec3>,
    /// Four vertices per patch, at (u, v) = (0, 0), (1, 0), (0, 1), (1, 1), all within `positions`. The
    /// normal is `cross(∂p/∂u, ∂p/∂v)`.
    pub indices: Vec<[u32; 4]>,
    /// A shading normal per vertex, or none at all.
    pub normals: Vec<DVec3>,
    /// (u, v) per vertex, or none at all.
    pub uv: Vec<DVec2>,
}

/// A disk or ring around the z axis of its own space. Its normal is that space's +z, brought to the world
/// as normals are (a mirror keeps the side).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Disk {
    /// Where on the z axis.
    pub height: f64,
    /// Outer radius, positive.
    pub radius: f64,
    /// Radius of the hole, from 0 to below `radius`.
    pub inner_radius: f64,
    /// From the disk's space to the world; invertible.
    pub object_to_world: DAffine3,
}
