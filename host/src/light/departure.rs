//! Light that sets out: places and directions, in proportion to what a light sends.

use std::f64::consts::PI;

use glam::DVec3;

use super::direction::{self, about, on_disk, uniform};
use super::picture::mean;
use super::source::{Source, scaled, shines};
use super::{Bounds, Departure};
use crate::ray::Anchor;
use crate::surface::Surfaces;

/// How far outside of the bounds, in their radii, light from far away begins: not on the sphere itself, which what
/// bounds it may touch.
const OUTSIDE: f64 = 1.0 + 1.0 / 1024.0;

impl Source {
    /// A place (by the first two numbers) and a direction (by the others). Index and choice are left to the caller.
    pub(super) fn depart(
        &self,
        surfaces: &Surfaces,
        bounds: &Bounds,
        [a, b, c, d]: [f64; 4],
    ) -> Option<Departure> {
        match self {
            Self::Distant {
                direction,
                irradiance,
            } => Some(from_far(bounds, (*direction, *irradiance, 1.0), [a, b])),
            Self::Constant { radiance } => {
                let seen = (uniform([c, d]), *radiance, direction::UNIFORM);
                Some(from_far(bounds, seen, [a, b]))
            }
            Self::Image(painted) => Some(from_far(bounds, painted.sample([c, d])?, [a, b])),
            Self::Point {
                position,
                intensity,
            } => Some(from_point(
                *position,
                uniform([c, d]),
                *intensity,
                direction::UNIFORM,
            )),
            Self::Spot {
                position,
                cone,
                intensity,
            } => {
                let direction = cone.sample([c, d]);
                let profile = cone.profile(direction);
                // At the very edge nothing is sent, and nothing is lost.
                (profile > 0.0).then(|| {
                    let sent = scaled(*intensity, profile);
                    from_point(*position, direction, sent, cone.pdf(direction))
                })
            }
            Self::Goniometric {
                position,
                painted,
                intensity,
            } => {
                let (direction, seen, pdf) = painted.sample([c, d])?;
                let sent = scaled(*intensity, mean(seen));
                Some(from_point(*position, direction, sent, pdf))
            }
            Self::Emitter {
                index,
                radiance,
                two_sided,
                ..
            } => {
                let point = surfaces.sample_emitter_area(*index, [a, b]);
                // The first bit of the third number says which side.
                let (normal, c) = match (*two_sided, 2.0 * c) {
                    (false, _) => (point.anchor.normal, c),
                    (true, twice) if twice < 1.0 => (point.anchor.normal, twice),
                    (true, twice) => (-point.anchor.normal, twice - 1.0),
                };
                let direction = about(normal, (1.0 - c).sqrt(), d);
                let pdf_direction = cosine_pdf(point.anchor.normal, direction, *two_sided);
                (point.pdf > 0.0 && pdf_direction > 0.0).then_some(Departure {
                    light: 0,
                    anchor: point.anchor,
                    direction,
                    radiance: *radiance,
                    pdf_position: point.pdf,
                    pdf_direction,
                    choice: 1.0,
                    cosine: point.anchor.normal.dot(direction).abs(),
                })
            }
        }
    }

    /// The densities of [`depart`](Self::depart): of the place, and of the direction of travel.
    pub(super) fn departure_pdf(
        &self,
        surfaces: &Surfaces,
        bounds: &Bounds,
        anchor: &Anchor,
        direction: DVec3,
    ) -> (f64, f64) {
        match self {
            Self::Distant { .. } => (disk_pdf(bounds), 1.0),
            Self::Constant { .. } => (disk_pdf(bounds), direction::UNIFORM),
            Self::Image(painted) => (disk_pdf(bounds), painted.look(-direction).2),
            Self::Point { .. } => (1.0, direction::UNIFORM),
            Self::Spot { cone, .. } => (1.0, cone.pdf(direction)),
            Self::Goniometric { painted, .. } => (1.0, painted.look(direction).2),
            Self::Emitter {
                index, two_sided, ..
            } => (
                surfaces.emitter_area_pdf(*index, anchor),
                cosine_pdf(anchor.normal, direction, *two_sided),
            ),
        }
    }
}

/// Density of directions in proportion to the cosine, on one side or both [1/sr].
fn cosine_pdf(normal: DVec3, direction: DVec3, two_sided: bool) -> f64 {
    if !shines(normal, direction, two_sided) {
        return 0.0;
    }
    let sides = if two_sided { 2.0 } else { 1.0 };
    normal.dot(direction).abs() / (PI * sides)
}

fn disk_pdf(bounds: &Bounds) -> f64 {
    1.0 / (PI * bounds.radius * bounds.radius)
}

fn from_far(
    bounds: &Bounds,
    (to_light, radiance, pdf_direction): (DVec3, [f64; 3], f64),
    u: [f64; 2],
) -> Departure {
    let across = on_disk(to_light, bounds.radius, u);
    let start = bounds.centre + to_light * (bounds.radius * OUTSIDE) + across;
    Departure {
        pdf_position: disk_pdf(bounds),
        ..from_point(start, -to_light, radiance, pdf_direction)
    }
}

fn from_point(
    position: DVec3,
    direction: DVec3,
    radiance: [f64; 3],
    pdf_direction: f64,
) -> Departure {
    Departure {
        light: 0,
        anchor: Anchor::in_space(position),
        direction,
        radiance,
        pdf_position: 1.0,
        pdf_direction,
        choice: 1.0,
        cosine: 1.0,
    }
}
