//! One light, assembled: how bright it is from a place, and how strong on the whole.

use std::f64::consts::{FRAC_PI_2, PI};

use glam::{DMat3, DVec3};

use super::direction::{self, uniform};
use super::picture::{SphericalPicture, mean};
use super::spot::Cone;
use super::tree::Extent;
use super::{Bounds, LightSample};
use crate::ray::Anchor;
use crate::surface::Surfaces;

/// A light. Radiances are times the film's factor, places relative to the origin of rendering.
#[derive(Debug)]
pub(super) enum Source {
    /// In one direction.
    Distant {
        direction: DVec3,
        irradiance: [f64; 3],
    },
    /// The same from everywhere.
    Constant { radiance: [f64; 3] },
    /// A picture of everywhere.
    Image(Painted),
    /// A point, the same in all directions.
    Point {
        position: DVec3,
        intensity: [f64; 3],
    },
    /// A point with a cone.
    Spot {
        position: DVec3,
        cone: Cone,
        intensity: [f64; 3],
    },
    /// A point with a picture, whose colours are averaged as in pbrt-v4.
    Goniometric {
        position: DVec3,
        painted: Painted,
        intensity: [f64; 3],
    },
    /// A piece of surface.
    Emitter {
        index: u32,
        radiance: [f64; 3],
        two_sided: bool,
        area: f64,
        centre: DVec3,
    },
}

/// A turned picture with a factor.
#[derive(Debug)]
pub(super) struct Painted {
    pub(super) picture: SphericalPicture,
    /// From the light's space to the world: a rotation, perhaps mirrored.
    pub(super) rotation: DMat3,
    pub(super) factor: f64,
}

/// Direction in the world, colour times the factor, density [1/sr].
pub(super) type Painting = (DVec3, [f64; 3], f64);

impl Painted {
    pub(super) fn look(&self, direction: DVec3) -> Painting {
        let seen = self.picture.look(self.rotation.transpose() * direction);
        (direction, scaled(seen.colour, self.factor), seen.pdf)
    }

    pub(super) fn sample(&self, u: [f64; 2]) -> Option<Painting> {
        let seen = self.picture.sample(u)?;
        let colour = scaled(seen.colour, self.factor);
        Some((self.rotation * seen.direction, colour, seen.pdf))
    }

    /// ∫ of the mean colour over all directions.
    pub(super) fn total(&self) -> f64 {
        self.picture.total() * self.factor
    }
}

pub(super) fn scaled(colour: [f64; 3], factor: f64) -> [f64; 3] {
    colour.map(|c| c * factor)
}

/// Whether light leaves the side of a surface that looks along `direction`.
pub(super) fn shines(normal: DVec3, direction: DVec3, two_sided: bool) -> bool {
    let cos = normal.dot(direction);
    cos > 0.0 || (two_sided && cos < 0.0)
}

impl Source {
    /// The middle of a light at a place; `None` is far away.
    pub(super) fn centre(&self) -> Option<DVec3> {
        match self {
            Self::Distant { .. } | Self::Constant { .. } | Self::Image(_) => None,
            Self::Point { position, .. }
            | Self::Spot { position, .. }
            | Self::Goniometric { position, .. } => Some(*position),
            Self::Emitter { centre, .. } => Some(*centre),
        }
    }

    /// Power into the scene \[W\], colours averaged: for lights far away, what falls through the disk of `bounds`.
    pub(super) fn power(&self, bounds: &Bounds) -> f64 {
        let disk = PI * bounds.radius * bounds.radius;
        match self {
            Self::Distant { irradiance, .. } => mean(*irradiance) * disk,
            Self::Constant { radiance } => 4.0 * PI * mean(*radiance) * disk,
            Self::Image(painted) => painted.total() * disk,
            Self::Point { intensity, .. } => 4.0 * PI * mean(*intensity),
            Self::Spot {
                cone, intensity, ..
            } => cone.total() * mean(*intensity),
            Self::Goniometric {
                painted, intensity, ..
            } => painted.total() * mean(*intensity),
            Self::Emitter {
                radiance,
                two_sided,
                area,
                ..
            } => {
                let sides = if *two_sided { 2.0 } else { 1.0 };
                PI * mean(*radiance) * area * sides
            }
        }
    }

    /// Where it is and where it shines; `None` if that is far away.
    pub(super) fn extent(&self, surfaces: &Surfaces) -> Option<Extent> {
        let point = |position: DVec3, strength: f64| Extent {
            low: position,
            high: position,
            axis: DVec3::Z,
            spread: PI,
            reach: FRAC_PI_2,
            strength,
            two_sided: false,
        };
        match self {
            Self::Distant { .. } | Self::Constant { .. } | Self::Image(_) => None,
            Self::Point {
                position,
                intensity,
            } => Some(point(*position, mean(*intensity))),
            Self::Spot {
                position,
                cone,
                intensity,
            } => {
                let spread = libm::acos(cone.cos_full.clamp(-1.0, 1.0));
                Some(Extent {
                    axis: cone.axis,
                    spread,
                    reach: libm::acos(cone.cos_dark.clamp(-1.0, 1.0)) - spread,
                    ..point(*position, mean(*intensity))
                })
            }
            Self::Goniometric {
                position,
                painted,
                intensity,
            } => {
                let average = painted.total() * direction::UNIFORM;
                Some(point(*position, mean(*intensity) * average))
            }
            Self::Emitter {
                index,
                radiance,
                two_sided,
                area,
                ..
            } => {
                let ([low, high], axis, cos) = surfaces.emitter_bounds(*index);
                let spread = libm::acos(cos.clamp(-1.0, 1.0));
                // What faces all around shows a quarter of its area.
                let shown = if cos <= -1.0 { 0.25 * area } else { *area };
                Some(Extent {
                    low,
                    high,
                    axis,
                    spread,
                    reach: FRAC_PI_2,
                    strength: mean(*radiance) * shown,
                    two_sided: *two_sided,
                })
            }
        }
    }

    /// The light as seen from a place, at two uniform numbers; `None` where it is dark. Index and choice are left
    /// to the caller.
    pub(super) fn arrive(
        &self,
        surfaces: &Surfaces,
        from: DVec3,
        u: [f64; 2],
    ) -> Option<LightSample> {
        match self {
            Self::Distant {
                direction,
                irradiance,
            } => Some(LightSample {
                delta: true,
                ..far(*direction, *irradiance, 1.0)
            }),
            Self::Constant { radiance } => Some(far(uniform(u), *radiance, direction::UNIFORM)),
            Self::Image(painted) => {
                let (direction, radiance, pdf) = painted.sample(u)?;
                Some(far(direction, radiance, pdf))
            }
            Self::Point {
                position,
                intensity,
            } => at_point(*position, from, |_| *intensity),
            Self::Spot {
                position,
                cone,
                intensity,
            } => at_point(*position, from, |away| {
                scaled(*intensity, cone.profile(away))
            }),
            Self::Goniometric {
                position,
                painted,
                intensity,
            } => at_point(*position, from, |away| {
                scaled(*intensity, mean(painted.look(away).1))
            }),
            Self::Emitter {
                index,
                radiance,
                two_sided,
                ..
            } => {
                let point = surfaces.sample_emitter(*index, from, u)?;
                let direction = (point.anchor.point - from).try_normalize()?;
                let lit = shines(point.anchor.normal, -direction, *two_sided);
                (lit && point.pdf > 0.0).then_some(LightSample {
                    anchor: Some(point.anchor),
                    ..far(direction, *radiance, point.pdf)
                })
            }
        }
    }
}

fn far(direction: DVec3, radiance: [f64; 3], pdf: f64) -> LightSample {
    LightSample {
        light: 0,
        anchor: None,
        direction,
        radiance,
        pdf,
        choice: 1.0,
        delta: false,
    }
}

/// A point light whose intensity depends on the direction away from it.
fn at_point(
    position: DVec3,
    from: DVec3,
    intensity: impl Fn(DVec3) -> [f64; 3],
) -> Option<LightSample> {
    let to_light = position - from;
    let squared = to_light.length_squared();
    let direction = to_light / squared.sqrt();
    let radiance = intensity(-direction).map(|i| i / squared);
    let lit = radiance.iter().any(|r| *r > 0.0) && radiance.iter().all(|r| r.is_finite());
    (lit && direction.is_finite()).then(|| LightSample {
        anchor: Some(Anchor::in_space(position)),
        delta: true,
        ..far(direction, radiance, 1.0)
    })
}
