//! Surfaces without matter of their own, at which one medium gives way to another.

use glam::{DAffine3, DVec3};

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
    pub shape: Shape,
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

/// The geometry of a boundary.
#[derive(Clone, Debug)]
pub enum Shape {
    /// A full sphere, or ellipsoid under a general transform.
    Sphere(Sphere),
    /// Triangles.
    TriangleMesh(TriangleMesh),
}

/// The sphere of `radius` around the origin of its own space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sphere {
    /// \[length of the sphere's space\], positive.
    pub radius: f64,
    /// From the sphere's space to the world; invertible, perhaps neither rigid nor uniform.
    pub object_to_world: DAffine3,
}

/// Triangles over shared vertices.
#[derive(Clone, Debug, PartialEq)]
pub struct TriangleMesh {
    /// Vertices in the world, finite.
    pub positions: Vec<DVec3>,
    /// Three vertices per triangle, all within `positions`. Triangles may be degenerate.
    pub indices: Vec<[u32; 3]>,
}
