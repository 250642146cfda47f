//! The camera in double precision: rays from the film, and the film from places in the world.

use glam::{DMat3, DVec3};
use woodcock_core::camera::Projection;

use super::Draws;
use crate::ray::Ray;
use crate::world::World;

/// A way into the camera: from a place in the world to a point of the film.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sight {
    /// Point of the film \[pixels\].
    pub(crate) film: [f64; 2],
    /// Where on the lens (or, for parallel rays, on the film) the ray begins.
    pub(crate) origin: DVec3,
    /// Unit direction from the camera to the place.
    pub(crate) direction: DVec3,
    /// Density with which camera rays, spread evenly over the whole film, cross a unit of area at the place that
    /// faces them [1/length²].
    pub(crate) density: f64,
}

/// The ray through a point of the film. Draws two numbers for a lens.
pub(crate) fn ray<D: Draws>(world: &World, film: [f64; 2], draws: &mut D) -> Ray {
    let camera = &world.camera;
    let [x, y] = film;
    let ray = camera.ray_through(x, y, || draws.two());
    let vec = |v: woodcock_core::vec3::Vec3<f64>| DVec3::new(v.x, v.y, v.z);
    Ray {
        origin: vec(ray.origin),
        direction: vec(ray.direction),
    }
}

/// Whether camera rays are parallel, so that no distance dilutes them.
pub(crate) fn is_parallel(world: &World) -> bool {
    world.camera.projection == Projection::Orthographic
}

/// The rows of the camera's map as a matrix and a translation.
fn map(world: &World) -> (DMat3, DVec3) {
    let rows = world.camera.camera_to_world.map(|row| row.map(f64::from));
    let column = |c: usize| DVec3::new(rows[0][c], rows[1][c], rows[2][c]);
    (DMat3::from_cols(column(0), column(1), column(2)), column(3))
}

/// How a place is seen, through a point of the lens chosen by two numbers; `None` where it is behind the camera or
/// outside of the picture.
///
/// A direction ω has the density p_ω = 1 / (A cos³ θ) over the film, A being its area at distance one ([Pharr, Jakob,
/// Humphreys 2023], section 5.4), and p_ω / r² is what crosses a unit of area.
pub(crate) fn sight<D: Draws>(world: &World, place: DVec3, draws: &mut D) -> Option<Sight> {
    let camera = &world.camera;
    let (matrix, origin) = map(world);
    let unit = matrix.z_axis.length();
    let local = matrix.inverse() * (place - origin);
    let [[x0, dx], [y0, dy]] = camera.screen.map(|axis| axis.map(f64::from));
    let [width, height] = world.resolution.map(f64::from);
    let film_area = (width * height * dx * dy).abs();
    let on_film = |sx: f64, sy: f64| {
        let film = [(sx - x0) / dx, (sy - y0) / dy];
        let within = |at: f64, size: f64| (0.0..size).contains(&at);
        (within(film[0], width) && within(film[1], height)).then_some(film)
    };
    let mut lens = DVec3::ZERO;
    let radius = f64::from(camera.lens_radius);
    if radius > 0.0 {
        let [u, turn] = draws.two();
        let (sin, cos) = libm::sincos(std::f64::consts::TAU * turn);
        lens = DVec3::new(cos, sin, 0.0) * (radius * u.sqrt());
    }
    if local.z <= 0.0 {
        return None;
    }
    match camera.projection {
        Projection::Perspective => {
            let along = local - lens;
            // The ray meets the plane in focus where the pinhole's ray through the same point of the film does.
            let focus = if radius > 0.0 {
                let distance = f64::from(camera.focal_distance);
                (lens + along * (distance / along.z)) / distance
            } else {
                local / local.z
            };
            let film = on_film(focus.x, focus.y)?;
            let from = origin + matrix * lens;
            let towards = place - from;
            let distance_squared = towards.length_squared();
            let cosine = along.z / along.length();
            Some(Sight {
                film,
                origin: from,
                direction: towards / distance_squared.sqrt(),
                density: 1.0 / (film_area * cosine * cosine * cosine * distance_squared),
            })
        }
        Projection::Orthographic => {
            // The ray through a point s of the film and ℓ of the lens: s + ℓ (1 − z / focal distance).
            let distance = f64::from(camera.focal_distance);
            let film = local - lens * (1.0 - local.z / distance);
            let towards = DVec3::new(-lens.x, -lens.y, distance);
            let cosine = distance / towards.length();
            Some(Sight {
                film: on_film(film.x, film.y)?,
                origin: origin + matrix * (DVec3::new(film.x, film.y, 0.0) + lens),
                direction: (matrix * towards).normalize(),
                density: 1.0 / (film_area * unit * unit * cosine),
            })
        }
    }
}

/// The density of [`Sight`] at a place that a camera ray reached.
pub(crate) fn density(world: &World, ray: &Ray, distance: f64) -> f64 {
    let camera = &world.camera;
    let (matrix, _) = map(world);
    let unit = matrix.z_axis.length();
    let [[_, dx], [_, dy]] = camera.screen.map(|axis| axis.map(f64::from));
    let [width, height] = world.resolution.map(f64::from);
    let film_area = (width * height * dx * dy).abs();
    let cosine = ray.direction.dot(matrix.z_axis) / unit;
    match camera.projection {
        Projection::Perspective => {
            1.0 / (film_area * cosine * cosine * cosine * distance * distance)
        }
        Projection::Orthographic => 1.0 / (film_area * unit * unit * cosine),
    }
}
