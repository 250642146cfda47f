//! Where a walk ends: convex bodies, and how far it is to their boundary.

use super::vector;
use woodcock_core::ray::{FAR, Ray, clip_to_box, clip_to_unit_sphere};
use woodcock_core::vec3::Vec3;

/// A convex body.
pub trait Body {
    /// Distance to the boundary along a ray that starts inside, up to rounding \[length\]; zero for one that rounding
    /// has put outside.
    fn exit(&self, ray: &Ray<f32>) -> f32;
}

/// 0 < z < `thickness`, unbounded in x and y; of infinite thickness a half-space.
#[derive(Clone, Copy, Debug)]
pub struct Slab {
    /// \[length\]
    pub thickness: f32,
}

/// All of space.
#[derive(Clone, Copy, Debug)]
pub struct Space;

/// Nothing but so much of any ray \[length\]: for a single flight.
#[derive(Clone, Copy, Debug)]
pub struct Stretch(
    /// How much.
    pub f32,
);

/// A ball about the origin.
#[derive(Clone, Copy, Debug)]
pub struct Ball {
    /// \[length\]
    pub radius: f32,
}

/// [0, a] × [0, b] × [0, c].
#[derive(Clone, Copy, Debug)]
pub struct Block {
    /// Its edges \[length\].
    pub edges: Vec3<f32>,
}

impl Block {
    /// A cube of edge 1.
    pub fn unit() -> Self {
        Self::new([1.0; 3])
    }

    /// From its edges \[length\].
    pub fn new(edges: [f64; 3]) -> Self {
        Self {
            edges: vector(edges),
        }
    }
}

impl Body for Slab {
    fn exit(&self, ray: &Ray<f32>) -> f32 {
        let (z, slope) = (ray.origin.z, ray.direction.z);
        let distance = if slope < 0.0 {
            -z / slope
        } else if slope > 0.0 {
            (self.thickness - z) / slope
        } else {
            FAR
        };
        distance.clamp(0.0, FAR)
    }
}

impl Body for Space {
    fn exit(&self, _: &Ray<f32>) -> f32 {
        FAR
    }
}

impl Body for Stretch {
    fn exit(&self, _: &Ray<f32>) -> f32 {
        self.0
    }
}

impl Body for Ball {
    fn exit(&self, ray: &Ray<f32>) -> f32 {
        let scale = 1.0 / self.radius;
        clip_to_unit_sphere(ray.origin * scale, ray.direction * scale)
            .t1
            .max(0.0)
    }
}

impl Body for Block {
    fn exit(&self, ray: &Ray<f32>) -> f32 {
        clip_to_box(ray.origin, ray.direction, self.edges)
            .t1
            .max(0.0)
    }
}

/// Bodies whose surface uniform light enters.
pub trait Lit: Body {
    /// A uniform point of the surface and the inward normal there, from three uniform numbers.
    fn surface(&self, u: [f32; 3]) -> (Vec3<f32>, Vec3<f32>);
}

impl Lit for Ball {
    fn surface(&self, [u, turn, _]: [f32; 3]) -> (Vec3<f32>, Vec3<f32>) {
        let normal = Vec3::new(0.0, 0.0, 1.0).deflected(2.0 * u - 1.0, turn);
        (normal * self.radius, -normal)
    }
}

impl Lit for Block {
    fn surface(&self, [u, v, w]: [f32; 3]) -> (Vec3<f32>, Vec3<f32>) {
        let Vec3 { x, y, z } = self.edges;
        let areas = [y * z, z * x, x * y];
        // One number picks the pair of faces by area, and which of the two by what is left of it.
        let mut pick = w * 2.0 * (areas[0] + areas[1] + areas[2]);
        let mut axis = 0;
        while axis < 2 && pick >= 2.0 * areas[axis] {
            pick -= 2.0 * areas[axis];
            axis += 1;
        }
        let far = pick >= areas[axis];
        let (at, inwards) = if far { (1.0, -1.0) } else { (0.0, 1.0) };
        let unit = match axis {
            0 => ([at, u, v], [inwards, 0.0, 0.0]),
            1 => ([v, at, u], [0.0, inwards, 0.0]),
            _ => ([u, v, at], [0.0, 0.0, inwards]),
        };
        (Vec3::splat(unit.0).times(self.edges), Vec3::splat(unit.1))
    }
}
