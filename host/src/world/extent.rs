//! How far a scene reaches.

use glam::DVec3;

use super::{Medium, Support};
use crate::light::Bounds;
use crate::scene::{Enclosure, Scene};
use crate::surface::Surfaces;

/// The corners of what holds points.
#[derive(Clone, Copy, Debug)]
struct Corners {
    low: DVec3,
    high: DVec3,
}

impl Corners {
    fn none() -> Self {
        Self {
            low: DVec3::INFINITY,
            high: DVec3::NEG_INFINITY,
        }
    }

    fn add(&mut self, p: DVec3) {
        self.low = self.low.min(p);
        self.high = self.high.max(p);
    }

    /// Adds all boundaries between media, in the world as described.
    fn add_boundaries(&mut self, scene: &Scene) {
        for boundary in &scene.boundaries {
            match &boundary.shape {
                Enclosure::Sphere(sphere) => {
                    let map = &sphere.object_to_world;
                    for axis in 0..3 {
                        let reach = map.matrix3.col(axis) * sphere.radius * 3.0_f64.sqrt();
                        self.add(map.translation + reach);
                        self.add(map.translation - reach);
                    }
                }
                Enclosure::TriangleMesh(mesh) => mesh.positions.iter().for_each(|p| self.add(*p)),
            }
        }
    }
}

/// The diameter of all boundaries together \[length\].
pub(super) fn diameter(scene: &Scene) -> f64 {
    let mut corners = Corners::none();
    corners.add_boundaries(scene);
    if corners.low.is_finite() {
        (corners.high - corners.low).length()
    } else {
        f64::INFINITY
    }
}

/// A sphere around everything that light can meet, in the world as rendered, and the camera.
pub(super) fn bounds(
    scene: &Scene,
    surfaces: &Surfaces,
    media: &[Medium],
    origin: DVec3,
) -> Bounds {
    let mut corners = Corners::none();
    corners.add_boundaries(scene);
    if corners.low.is_finite() {
        corners.low -= origin;
        corners.high -= origin;
    }
    let supports = media.iter().filter_map(|medium| medium.support.as_ref());
    let known = surfaces.bounds().into_iter().flatten();
    for corner in known.chain(supports.flat_map(Support::corners)) {
        corners.add(corner);
    }
    corners.add(scene.camera.camera_to_world.translation - origin);
    let radius = (corners.high - corners.low).length() * 0.5;
    Bounds {
        centre: (corners.low + corners.high) * 0.5,
        // Light from far away needs a disk of some size even where there is nothing.
        radius: if radius > 0.0 { radius } else { 1.0 },
    }
}
