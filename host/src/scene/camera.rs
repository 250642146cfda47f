//! The camera: a projection through a screen window, with or without a lens.

use glam::{DAffine3, DVec3};

use super::{Film, Place};

/// Where the image is seen from.
///
/// In camera space the camera sits at the origin and looks along +z, x to the right, y up.
#[derive(Clone, Debug)]
pub struct Camera {
    /// Perspective or orthographic.
    pub projection: Projection,
    /// The part of the screen that the full film covers.
    pub screen_window: ScreenWindow,
    /// Radius of the thin lens \[length\]; 0 is a pinhole.
    pub lens_radius: f64,
    /// Distance of the plane of focus along the axis \[length\], positive.
    pub focal_distance: f64,
    /// From camera space to the world: invertible, finite, possibly mirrored or scaled.
    pub camera_to_world: DAffine3,
    /// Where the camera is described, if it is.
    pub place: Option<Place>,
}

/// How points of the screen become rays.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Projection {
    /// Rays of one origin. Screen point (x, y) looks along (x tan(fov/2), y tan(fov/2), 1), so `fov`
    /// \[degrees, in (0, 180)\] spans the shorter side of a default screen window.
    Perspective {
        /// Field of view of the shorter axis \[degrees\].
        fov: f64,
    },
    /// Parallel rays along +z from (x, y, 0), the screen being measured in lengths.
    Orthographic,
}

/// A rectangle of the screen. The film's left edge is `x_min`, its *upper* edge `y_max`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ScreenWindow {
    /// Left edge.
    pub x_min: f64,
    /// Right edge.
    pub x_max: f64,
    /// Lower edge.
    pub y_min: f64,
    /// Upper edge.
    pub y_max: f64,
}

impl ScreenWindow {
    /// The default window: ±1 along the shorter axis, ±`aspect` (width / height) in proportion.
    pub fn from_aspect(aspect: f64) -> Self {
        let (x, y) = if aspect > 1.0 {
            (aspect, 1.0)
        } else {
            (1.0, 1.0 / aspect)
        };
        Self {
            x_min: -x,
            x_max: x,
            y_min: -y,
            y_max: y,
        }
    }
}

impl Camera {
    /// Origin and unit direction, in the world, of the ray through the centre of the lens and the
    /// film point (`x`, `y`) \[pixels from the upper left corner\]: what the renderer's own rays are
    /// tested against.
    pub fn central_ray(&self, film: &Film, x: f64, y: f64) -> (DVec3, DVec3) {
        let w = &self.screen_window;
        let u = x / f64::from(film.width);
        let v = y / f64::from(film.height);
        let sx = w.x_min + (w.x_max - w.x_min) * u;
        let sy = w.y_max + (w.y_min - w.y_max) * v;
        let (origin, direction) = match self.projection {
            Projection::Perspective { fov } => {
                let half = libm::tan(0.5 * fov.to_radians());
                (DVec3::ZERO, DVec3::new(sx * half, sy * half, 1.0))
            }
            Projection::Orthographic => (DVec3::new(sx, sy, 0.0), DVec3::Z),
        };
        let m = &self.camera_to_world;
        (
            m.transform_point3(origin),
            m.transform_vector3(direction).normalize(),
        )
    }
}
