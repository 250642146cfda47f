//! What shines in a room: how a place sees it, and where on a ray it is near.

use super::nearness::Nearness;
use crate::ray::Ray;
use crate::real::{Mask, Real};
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
    /// A plane piece.
    Flat(Sheet),
    /// A point that shines alike in all directions.
    Point([f32; 3]),
    /// A unit direction from which light comes.
    Direction([f32; 3]),
}

/// A plane piece that shines to the side of its normal or to both.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sheet {
    corner: [f32; 3],
    /// Unit vectors along the edges that leave the corner.
    along: [[f32; 3]; 2],
    /// How long they are.
    lengths: [f32; 2],
    normal: [f32; 3],
    /// Its middle.
    centre: [f32; 3],
    outline: Outline,
    two_sided: bool,
    area: f32,
}

/// What a sheet's edges make.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outline {
    /// Chosen about by solid angle.
    Rectangle,
    /// Chosen by area.
    Parallelogram,
    /// Half a parallelogram; chosen by area.
    Triangle,
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

impl Sheet {
    /// * `corner`, `edges`: one corner and what leads from it to its two neighbours \[length\].
    /// * `triangle`: the half of the parallelogram next to the corner.
    ///
    /// `None` if it has no area, or numbers beyond single precision.
    pub fn new(
        corner: [f64; 3],
        edges: [[f64; 3]; 2],
        triangle: bool,
        two_sided: bool,
    ) -> Option<Self> {
        let [e, f] = edges;
        let lengths = edges.map(|v| libm::sqrt(dot(v, v)));
        let along = [0, 1].map(|i| edges[i].map(|c| c / lengths[i]));
        let normal = [
            e[1] * f[2] - e[2] * f[1],
            e[2] * f[0] - e[0] * f[2],
            e[0] * f[1] - e[1] * f[0],
        ];
        let double = libm::sqrt(dot(normal, normal));
        let outline = if triangle {
            Outline::Triangle
        } else if dot(along[0], along[1]).abs() < 1e-6 {
            Outline::Rectangle
        } else {
            Outline::Parallelogram
        };
        let share = if triangle { 1.0 / 3.0 } else { 0.5 };
        let single = |v: [f64; 3]| v.map(|c| c as f32);
        let sheet = Self {
            corner: single(corner),
            along: along.map(single),
            lengths: lengths.map(|l| l as f32),
            normal: single(normal.map(|c| c / double)),
            centre: single([0, 1, 2].map(|c| corner[c] + (e[c] + f[c]) * share)),
            outline,
            two_sided,
            area: (double * if triangle { 0.5 } else { 1.0 }) as f32,
        };
        let vectors = [sheet.corner, sheet.along[0], sheet.along[1], sheet.normal];
        let finite = vectors.as_flattened().iter().all(|c| c.is_finite());
        (finite && sheet.area > 0.0 && sheet.area.is_finite()).then_some(sheet)
    }

    fn lights<R: Real>(&self, cosine: R) -> R::Mask {
        R::zero().lt(cosine) | R::Mask::splat(self.two_sided)
    }
}

/// A rectangle in coordinates along its edges, relative to a place.
struct Relative<R> {
    /// The corner, and its height over the place.
    low: [R; 2],
    high: [R; 2],
    height: R,
}

impl<R: Real> Relative<R> {
    #[inline(always)]
    fn new(sheet: &Sheet, from: Vec3<R>) -> Self {
        let to_corner = Vec3::splat(sheet.corner) - from;
        let low = sheet.along.map(|axis| Vec3::splat(axis).dot(to_corner));
        let [e, f] = sheet.lengths.map(R::splat);
        // In the plane nothing shines; no distance of zero divides anything.
        let height = Vec3::splat(sheet.normal).dot(to_corner).abs();
        Self {
            low,
            high: [low[0] + e, low[1] + f],
            height: height.max(R::splat(1e-6 * sheet.lengths[0])),
        }
    }

    #[inline(always)]
    fn across(&self) -> Nearness<R> {
        Nearness::new(self.low[0], self.high[0], self.height)
    }

    /// The sines of both ends of the other coordinate where the first is `x`, and the distance there.
    #[inline(always)]
    fn sines(&self, x: R) -> (R, R, R) {
        let squared = x * x + self.height * self.height;
        let sine = |y: R| y / (squared + y * y).sqrt();
        (sine(self.low[1]), sine(self.high[1]), squared)
    }

    /// Density per solid angle where the first coordinate is `x` [1/sr].
    ///
    /// With d² = x² + h², a strip dx is seen under h / d² (sin₁ − sin₀) dx, and nearness chooses it with h / (θ d²) dx.
    #[inline(always)]
    fn pdf(&self, across: &Nearness<R>, low: R, high: R) -> R {
        let strip = across.angle() * (high - low);
        R::one() / strip.max(R::splat(1e-12))
    }
}

/// A light seen from a place.
#[derive(Clone, Copy, Debug)]
pub(super) struct Seen<R> {
    /// Unit direction to it, and how far it is.
    pub(super) direction: Vec3<R>,
    pub(super) distance: R,
    /// Radiance; of points and directions what falls on a surface that faces them, over the probability of the choice.
    pub(super) radiance: Vec3<R>,
    /// Density of the direction, choice included [1/sr]; zero of what no path finds.
    pub(super) pdf: R,
}

impl Lamp {
    /// The light as seen from places, at two uniform numbers in [0, 1), per lane.
    ///
    /// * `step`: how far before a piece its light is said to be \[length\].
    #[inline(always)]
    pub(super) fn look<R: Real>(&self, from: Vec3<R>, uv: [R; 2], step: f32) -> Seen<R> {
        let chosen = Vec3::splat(self.radiance.map(|r| r / self.choice));
        match &self.light {
            LampLight::Flat(sheet) => self.look_at_sheet(sheet, from, uv, step),
            LampLight::Point(position) => {
                let towards = Vec3::splat(*position) - from;
                let squared = towards.dot(towards);
                let distance = squared.sqrt();
                Seen {
                    direction: towards * (R::one() / distance),
                    distance,
                    radiance: chosen * (R::one() / squared),
                    pdf: R::zero(),
                }
            }
            LampLight::Direction(direction) => Seen {
                direction: Vec3::splat(*direction),
                distance: R::splat(crate::ray::FAR),
                radiance: chosen,
                pdf: R::zero(),
            },
        }
    }

    #[inline(always)]
    fn look_at_sheet<R: Real>(
        &self,
        sheet: &Sheet,
        from: Vec3<R>,
        [u, v]: [R; 2],
        step: f32,
    ) -> Seen<R> {
        let normal = Vec3::splat(sheet.normal);
        let [e, f] = sheet.lengths.map(R::splat);
        let (x, y, solid) = match sheet.outline {
            Outline::Rectangle => {
                let relative = Relative::new(sheet, from);
                let across = relative.across();
                let x = across.sample(u);
                let (low, high, squared) = relative.sines(x);
                let sine = low + v * (high - low);
                let rest = (R::one() - sine * sine).max(R::splat(1e-12));
                let y = sine * (squared / rest).sqrt();
                let y = y.max(relative.low[1]).min(relative.high[1]);
                let pdf = relative.pdf(&across, low, high);
                (x - relative.low[0], y - relative.low[1], Some(pdf))
            }
            Outline::Parallelogram => (u * e, v * f, None),
            Outline::Triangle => {
                // A square folded onto half of it, by the root of the larger share.
                let root = u.sqrt();
                ((root - root * v) * e, root * v * f, None)
            }
        };
        let [along_x, along_y] = sheet.along.map(Vec3::splat);
        let on_it = Vec3::splat(sheet.corner) + along_x * x + along_y * y;
        let front = normal.dot(from - on_it);
        // Whatever begins on the sheet itself, or next to its plane, has rounding for a direction.
        let beside = front.abs().lt(R::splat(EDGE * step));
        let side = R::select(front.lt(R::zero()), R::splat(-step), R::splat(step));
        let towards = on_it + normal * side - from;
        let squared = towards.dot(towards);
        let distance = squared.sqrt();
        let direction = towards * (R::one() / distance);
        let cosine = -normal.dot(direction);
        let radiance = Vec3::splat(self.radiance);
        let pdf = solid.unwrap_or_else(|| by_area(sheet, squared, cosine));
        Seen {
            direction,
            distance,
            radiance: Vec3::select(
                sheet.lights(cosine).and_not(beside),
                radiance,
                Vec3::uniform(0.0),
            ),
            pdf: pdf * R::splat(self.choice),
        }
    }

    /// Radiance that a ray meets on a sheet at distance t, and the density with which [`look`](Self::look) finds it.
    #[inline(always)]
    pub(super) fn found<R: Real>(&self, ray: &Ray<R>, t: R, step: f32) -> (Vec3<R>, R) {
        let LampLight::Flat(sheet) = &self.light else {
            return (Vec3::uniform(0.0), R::zero());
        };
        let cosine = -Vec3::splat(sheet.normal).dot(ray.direction);
        let radiance = Vec3::splat(self.radiance);
        let radiance = Vec3::select(sheet.lights(cosine), radiance, Vec3::uniform(0.0));
        let pdf = if sheet.outline == Outline::Rectangle {
            let relative = Relative::new(sheet, ray.origin);
            let x = Vec3::splat(sheet.along[0]).dot(ray.direction) * t;
            let x = x.max(relative.low[0]).min(relative.high[0]);
            let (low, high, _) = relative.sines(x);
            relative.pdf(&relative.across(), low, high)
        } else {
            by_area(sheet, t * t, cosine)
        };
        let front = cosine.abs() * t;
        let pdf = R::select(front.lt(R::splat(EDGE * step)), R::zero(), pdf);
        (radiance, pdf * R::splat(self.choice))
    }

    /// The part of rays from `from` over a `length` as seen from the lamp, and the distance along it that is nearest; nothing
    /// for directions.
    #[inline(always)]
    pub(super) fn nearness<R: Real>(
        &self,
        ray: &Ray<R>,
        from: R,
        length: R,
    ) -> Option<(Nearness<R>, R)> {
        let (centre, room) = match &self.light {
            LampLight::Flat(sheet) => (sheet.centre, SOFT * sheet.area),
            LampLight::Point(position) => (*position, 0.0),
            LampLight::Direction(_) => return None,
        };
        let towards = Vec3::splat(centre) - ray.origin;
        let nearest = towards.dot(ray.direction);
        let across = towards - ray.direction * nearest;
        let apart = (across.dot(across) + R::splat(room)).sqrt();
        // On the ray itself the law would be a point. More than the rounding of its place it must not be: where the lamp is
        // nearer than is said, what arrives has a heavy tail.
        let least = towards.dot(towards).sqrt() * R::splat(1e-6);
        let apart = apart.max(least.max(R::splat(f32::MIN_POSITIVE)));
        let begins = from - nearest;
        Some((Nearness::new(begins, begins + length, apart), nearest))
    }
}

/// How many steps from its plane a sheet is sampled from, at least.
const EDGE: f32 = 4.0;
/// The part of a sheet's area by which its middle is said to be farther away (squared): nearer than its own size, it does
/// not become brighter.
const SOFT: f32 = 0.25;

/// Density of a choice by area, per solid angle [1/sr]. Cosines near zero are taken for more: it must stay finite.
#[inline(always)]
fn by_area<R: Real>(sheet: &Sheet, squared: R, cosine: R) -> R {
    squared * R::splat(1.0 / sheet.area) / cosine.abs().max(R::splat(1e-6))
}

#[cfg(test)]
mod tests {
    use super::*;
    use core::f64::consts::TAU;

    const PLACES: [[f32; 3]; 5] = [
        [0.3, -0.2, 0.5],
        [2.0, 1.0, 0.4],
        [0.4, 0.2, 0.03],
        [-5.0, 3.0, 9.0],
        [0.5, 0.25, 1.5],
    ];

    fn sheet(edges: [[f64; 3]; 2], triangle: bool) -> Lamp {
        let sheet = Sheet::new([0.0; 3], edges, triangle, true).expect("a sheet");
        Lamp {
            light: LampLight::Flat(sheet),
            radiance: [1.0; 3],
            choice: 0.5,
        }
    }

    /// The solid angle of a triangle of unit vectors [Van Oosterom, Strackee 1983].
    fn angle([a, b, c]: [Vec3<f64>; 3]) -> f64 {
        let cross = Vec3::new(
            b.y * c.z - b.z * c.y,
            b.z * c.x - b.x * c.z,
            b.x * c.y - b.y * c.x,
        );
        let half = libm::atan2(a.dot(cross).abs(), 1.0 + a.dot(b) + b.dot(c) + c.dot(a));
        2.0 * half
    }

    /// ∫ du dv / p is the solid angle that sampling covers: the sheet's. And a ray that meets the place has the same density.
    #[test]
    fn sheets_are_sampled_by_their_density() {
        let rectangle = [[1.0, 0.0, 0.0], [0.0, 0.5, 0.0]];
        let slanted = [[1.0, 0.0, 0.0], [0.3, 0.5, 0.0]];
        for (edges, triangle) in [(rectangle, false), (slanted, false), (slanted, true)] {
            let lamp = sheet(edges, triangle);
            for place in PLACES {
                let from = Vec3::<f64>::splat(place);
                let corner = |u: f64, v: f64| {
                    let [e, f] = edges.map(|v| Vec3::new(v[0], v[1], v[2]));
                    (e * u + f * v - from).normalised()
                };
                let [a, b, c, d] = [
                    corner(0.0, 0.0),
                    corner(1.0, 0.0),
                    corner(1.0, 1.0),
                    corner(0.0, 1.0),
                ];
                let expected = if triangle {
                    angle([a, b, d])
                } else {
                    angle([a, b, c]) + angle([a, c, d])
                };
                let n = 400;
                let mut sum = 0.0;
                for i in 0..n {
                    for j in 0..n {
                        let uv = [i, j].map(|k| (f64::from(k) + 0.5) / f64::from(n));
                        let seen = lamp.look(from, uv, 0.0);
                        sum += lamp.choice as f64 / seen.pdf;
                        let ray = Ray {
                            origin: from,
                            direction: seen.direction,
                        };
                        let (radiance, pdf) = lamp.found(&ray, seen.distance, 0.0);
                        assert_eq!(radiance.x, 1.0);
                        assert!((pdf / seen.pdf - 1.0).abs() < 2e-5, "{pdf} {}", seen.pdf);
                    }
                }
                let found = sum / f64::from(n * n);
                // The root of a triangle's choice has an endless slope.
                let room = if triangle { 2e-4 } else { 3e-5 };
                assert!(
                    (found / expected - 1.0).abs() < room,
                    "{edges:?} {place:?} {triangle}: {found} {expected}"
                );
            }
        }
    }

    /// A rectangle's density is as even as it is said to be: it seldom differs from that of the solid angle by much.
    #[test]
    fn rectangles_are_chosen_about_by_solid_angle() {
        let lamp = sheet([[1.0, 0.0, 0.0], [0.0, 0.5, 0.0]], false);
        for place in PLACES {
            let from = Vec3::<f64>::splat(place);
            let at = |u: f64, v: f64| f64::from(lamp.choice) / lamp.look(from, [u, v], 0.0).pdf;
            let angles = [at(0.01, 0.5), at(0.5, 0.01), at(0.5, 0.5), at(0.99, 0.99)];
            let least = angles.iter().fold(f64::INFINITY, |a, b| a.min(*b));
            let most = angles.iter().fold(0.0_f64, |a, b| a.max(*b));
            assert!(most < TAU && most / least < 3.0, "{place:?}: {angles:?}");
        }
    }

    #[test]
    fn lamps_shine_to_their_side() {
        let one_sided = Sheet::new([0.0; 3], [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], false, false);
        let lamp = Lamp {
            light: LampLight::Flat(one_sided.expect("a sheet")),
            radiance: [2.0; 3],
            choice: 1.0,
        };
        let front = lamp.look(Vec3::<f32>::splat([0.2, 0.2, 1.0]), [0.5; 2], 1e-5);
        let behind = lamp.look(Vec3::<f32>::splat([0.2, 0.2, -1.0]), [0.5; 2], 1e-5);
        assert_eq!((front.radiance.x, behind.radiance.x), (2.0, 0.0));
        let beside = lamp.look(Vec3::<f32>::splat([0.2, 0.2, 1e-5]), [0.5; 2], 1e-5);
        assert_eq!(beside.radiance.x, 0.0);
        assert!(Sheet::new([0.0; 3], [[1.0, 0.0, 0.0]; 2], false, false).is_none());
    }
}
