//! Camera rays: from a point of the film to a ray of the world.

use crate::medium::{Affine, transform_ray};
use crate::ray::Ray;
use crate::real::Real;
use crate::stream::Stream;
use crate::vec3::Vec3;

/// How film points become rays.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Projection {
    /// Rays from one point; the screen lies at distance one.
    Perspective,
    /// Parallel rays along +z; the screen lies at the camera.
    Orthographic,
}

/// A camera. In camera space it looks along +z, x to the right, y up.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// How film points become rays.
    pub projection: Projection,
    /// Screen coordinates of the film point (0, 0), and their change per pixel, for x and y.
    pub screen: [[f32; 2]; 2],
    /// Camera space to world; rotation, uniform scale and translation.
    pub camera_to_world: Affine,
    /// Radius of the lens [camera units]; zero is a pinhole.
    pub lens_radius: f32,
    /// Distance of the plane in focus [camera units].
    pub focal_distance: f32,
}

impl Camera {
    /// A ray through a uniform point of a pixel (the box filter), in world space.
    ///
    /// * `x`, `y`: column and row of the pixel, per lane.
    ///
    /// Two draws, two more for a lens.
    #[inline(always)]
    pub fn ray<R: Real>(&self, x: R, y: R, rng: &mut impl Stream<R>, active: R::Mask) -> Ray<R> {
        let (u, v) = (rng.uniform(active), rng.uniform(active));
        self.ray_through(x + u, y + v, || [rng.uniform(active), rng.uniform(active)])
    }

    /// The ray through a point of the film, in world space.
    ///
    /// * `x`, `y`: the point \[pixels from the upper left corner\], per lane.
    /// * `lens`: asked for two uniform numbers if there is a lens.
    #[inline(always)]
    pub fn ray_through<R: Real>(&self, x: R, y: R, lens: impl FnOnce() -> [R; 2]) -> Ray<R> {
        let [[x0, dx], [y0, dy]] = self.screen;
        let sx = R::splat(x0) + R::splat(dx) * x;
        let sy = R::splat(y0) + R::splat(dy) * y;
        let mut local = match self.projection {
            Projection::Perspective => Ray {
                origin: Vec3::uniform(0.0),
                direction: Vec3::new(sx, sy, R::one()),
            },
            Projection::Orthographic => Ray {
                origin: Vec3::new(sx, sy, R::zero()),
                direction: Vec3::splat([0.0, 0.0, 1.0]),
            },
        };
        if self.lens_radius > 0.0 {
            let [u, v] = lens();
            let radius = R::splat(self.lens_radius) * u.sqrt();
            let (sin, cos) = v.sin_cos_turn();
            // Directions have z = 1, so the plane in focus lies at t = focal distance.
            let focus = local.at(R::splat(self.focal_distance));
            local.origin = local.origin + Vec3::new(radius * cos, radius * sin, R::zero());
            local.direction = focus - local.origin;
        }
        let rows = self.camera_to_world.map(|row| row.map(R::splat));
        let ray = transform_ray(rows, &local);
        Ray {
            origin: ray.origin,
            direction: ray.direction.normalised(),
        }
    }
}
