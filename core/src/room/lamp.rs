//! What shines in a room, sampled.

use crate::real::{Mask, Real};
use crate::stream::Stream;
use crate::vec3::Vec3;

/// Something that shines.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lamp {
    /// What it is.
    pub light: LampLight,
    /// Radiance; of a point its intensity, of a direction its irradiance on a surface that faces it, by colour.
    pub radiance: [f32; 3],
    /// Probability of its choice.
    pub choice: f32,
}

/// Kinds of lamps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LampLight {
    /// A plane piece, which shines to the side of its normal or to both.
    Flat {
        /// One corner.
        corner: [f32; 3],
        /// What leads from it to its neighbours.
        edges: [[f32; 3]; 2],
        /// Unit normal.
        normal: [f32; 3],
        /// The half of the parallelogram next to the corner.
        triangle: bool,
        /// Whether the back shines too.
        two_sided: bool,
        /// Area \[length²\].
        area: f32,
    },
    /// A point that shines alike in all directions.
    Point([f32; 3]),
    /// A unit direction from which light comes.
    Direction([f32; 3]),
}

/// A light seen from a place.
#[derive(Clone, Copy, Debug)]
pub(super) struct Seen<R> {
    /// Where it is; of a direction, anywhere.
    pub(super) point: Vec3<R>,
    /// Unit direction to it, and how far it is.
    pub(super) direction: Vec3<R>,
    pub(super) distance: R,
    /// Radiance over the probability of the choice; of points and directions, what falls on a surface that faces them.
    pub(super) radiance: Vec3<R>,
    /// Density of the direction, choice included [1/sr]; zero of what no path finds.
    pub(super) pdf: R,
}

impl Lamp {
    /// The light as seen from places, at two uniform numbers in [0, 1), per lane.
    ///
    /// * `step`: how far before a piece its light is said to be \[length\].
    #[inline(always)]
    fn look<R: Real>(&self, from: Vec3<R>, [u, v]: [R; 2], step: f32) -> Seen<R> {
        let mut radiance = Vec3::splat(self.radiance.map(|r| r / self.choice));
        match self.light {
            LampLight::Flat {
                corner,
                edges,
                normal,
                triangle,
                two_sided,
                area,
            } => {
                let (u, v) = if triangle {
                    // A square folded onto half of it, by the root of the larger share.
                    let root = u.sqrt();
                    (root - root * v, root * v)
                } else {
                    (u, v)
                };
                let normal = Vec3::splat(normal);
                let on_it =
                    Vec3::splat(corner) + Vec3::splat(edges[0]) * u + Vec3::splat(edges[1]) * v;
                let front = normal.dot(from - on_it);
                let side = R::select(front.lt(R::zero()), R::splat(-step), R::splat(step));
                let point = on_it + normal * side;
                let towards = point - from;
                let squared = towards.dot(towards);
                let distance = squared.sqrt();
                let direction = towards * (R::one() / distance);
                let cosine = -normal.dot(direction);
                let lit = if two_sided {
                    R::Mask::splat(true)
                } else {
                    R::zero().lt(cosine)
                };
                radiance = Vec3::select(lit, radiance, Vec3::uniform(0.0));
                Seen {
                    point,
                    direction,
                    distance,
                    radiance,
                    pdf: self.pdf(area, squared, cosine),
                }
            }
            LampLight::Point(position) => {
                let point = Vec3::splat(position);
                let towards = point - from;
                let squared = towards.dot(towards);
                let distance = squared.sqrt();
                Seen {
                    point,
                    direction: towards * (R::one() / distance),
                    distance,
                    radiance: radiance * (R::one() / squared),
                    pdf: R::zero(),
                }
            }
            LampLight::Direction(direction) => {
                let direction = Vec3::splat(direction);
                Seen {
                    point: from,
                    direction,
                    distance: R::splat(crate::ray::FAR),
                    radiance,
                    pdf: R::zero(),
                }
            }
        }
    }

    /// Density of a direction in which a flat is met, choice included [1/sr].
    #[inline(always)]
    fn pdf<R: Real>(&self, area: f32, squared: R, cosine: R) -> R {
        squared * R::splat(self.choice / area) / cosine.abs().max(R::splat(GRAZING))
    }

    /// Radiance that a ray meets on a flat, by its cosine with the normal, and the density with which sampling finds it.
    #[inline(always)]
    pub(super) fn found<R: Real>(&self, direction: Vec3<R>, t: R) -> (Vec3<R>, R) {
        let LampLight::Flat {
            normal,
            two_sided,
            area,
            ..
        } = self.light
        else {
            return (Vec3::uniform(0.0), R::zero());
        };
        let cosine = -Vec3::splat(normal).dot(direction);
        let radiance = Vec3::splat(self.radiance);
        let lit = R::zero().lt(cosine) | R::Mask::splat(two_sided);
        let radiance = Vec3::select(lit, radiance, Vec3::uniform(0.0));
        (radiance, self.pdf(area, t * t, cosine))
    }
}

/// Cosines below this are taken for it in densities, which must stay finite.
const GRAZING: f32 = 1e-6;

/// Samples one lamp for each active lane. One draw to choose if there are several, two for a place on a piece.
#[inline(always)]
pub(super) fn sample<R: Real>(
    lamps: &[Lamp],
    from: Vec3<R>,
    step: f32,
    rng: &mut impl Stream<R>,
    active: R::Mask,
) -> Seen<R> {
    let several = lamps.len() > 1;
    let u = if several {
        rng.uniform(active)
    } else {
        R::zero()
    };
    let uv = [rng.uniform(active), rng.uniform(active)];
    let zero = Vec3::uniform(0.0);
    let mut seen = Seen {
        point: from,
        direction: Vec3::splat([0.0, 0.0, 1.0]),
        distance: R::zero(),
        radiance: zero,
        pdf: R::zero(),
    };
    if !several {
        return lamps.first().map_or(seen, |lamp| lamp.look(from, uv, step));
    }
    let mut below = 0.0;
    for (index, lamp) in lamps.iter().enumerate() {
        let above = if index + 1 == lamps.len() {
            1.0
        } else {
            below + lamp.choice
        };
        let chosen = R::splat(below).le(u) & u.lt(R::splat(above)) & active;
        below = above;
        if chosen.any() {
            let found = lamp.look(from, uv, step);
            seen = Seen {
                point: Vec3::select(chosen, found.point, seen.point),
                direction: Vec3::select(chosen, found.direction, seen.direction),
                distance: R::select(chosen, found.distance, seen.distance),
                radiance: Vec3::select(chosen, found.radiance, seen.radiance),
                pdf: R::select(chosen, found.pdf, seen.pdf),
            };
        }
    }
    seen
}
