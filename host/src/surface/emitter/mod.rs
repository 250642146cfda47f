//! Pieces of surface that shine, and points on them chosen as light.

mod carlson;
mod disk;
mod ellipsoid;
mod patch;
mod triangle;

use glam::{DVec2, DVec3};

use super::part::{Geometry, Part};
use super::spot::Spot;
use super::{EmitterPoint, Surfaces, anchor, patch as patches, triangle as triangles};
use crate::ray::Anchor;
use triangle::Triangle;

/// A place on a piece, as [`Part::spot`] takes it, with a density.
#[derive(Clone, Copy, Debug)]
struct Choice {
    at: DVec2,
    near: DVec3,
    pdf: f64,
}

/// The shape of an emitter.
#[derive(Debug)]
enum Shape<'a> {
    Triangle(Triangle),
    Patch(patches::Patch),
    Ellipsoid(ellipsoid::Ellipsoid<'a>),
    Disk(disk::Disk<'a>),
}

impl<'a> Shape<'a> {
    fn new(part: &'a Part, piece: u32) -> Option<Self> {
        Some(match &part.geometry {
            Geometry::Triangles(mesh, origin) => {
                Self::Triangle(Triangle::new(triangles::corners(mesh, *origin, piece)?))
            }
            Geometry::Patches(mesh, origin) => Self::Patch(patches::patch(mesh, *origin, piece)?),
            Geometry::Sphere(placement) => Self::Ellipsoid(ellipsoid::Ellipsoid(placement)),
            Geometry::Disk(placement, hole) => Self::Disk(disk::Disk(placement, *hole)),
        })
    }

    fn area(&self) -> f64 {
        match self {
            Self::Triangle(shape) => shape.area(),
            Self::Patch(shape) => patch::area(shape),
            Self::Ellipsoid(shape) => shape.area(),
            Self::Disk(shape) => shape.area(),
        }
    }

    /// Axis and cosine of a cone around the normals, before they are flipped.
    fn cone(&self) -> (DVec3, f64) {
        match self {
            Self::Triangle(shape) => (shape.normal(), 1.0),
            Self::Patch(shape) => patch::cone(shape),
            Self::Ellipsoid(_) => (DVec3::Z, -1.0),
            Self::Disk(shape) => (shape.normal(), 1.0),
        }
    }

    /// A point by area.
    fn sample_area(&self, u: [f64; 2]) -> Choice {
        match self {
            Self::Triangle(shape) => shape.sample_area(u),
            Self::Patch(shape) => patch::sample_area(shape, u),
            Self::Ellipsoid(shape) => shape.sample_area(u),
            Self::Disk(shape) => shape.sample_area(u),
        }
    }

    /// Density of [`sample_area`](Self::sample_area) at a point of the shape \[1/length²\].
    fn area_pdf(&self, point: &Anchor) -> f64 {
        match self {
            Self::Triangle(shape) => shape.area_pdf(),
            Self::Patch(shape) => patch::area_pdf(shape, point),
            Self::Ellipsoid(shape) => shape.area_pdf(point.point),
            Self::Disk(shape) => shape.area_pdf(),
        }
    }

    /// A point by solid angle, if that can be done from the reference.
    fn sample_angle(&self, reference: DVec3, u: [f64; 2]) -> Option<Choice> {
        match self {
            Self::Triangle(shape) => shape.sample_angle(reference, u),
            Self::Ellipsoid(shape) => shape.sample_angle(reference, u),
            Self::Patch(_) | Self::Disk(_) => None,
        }
    }

    /// Density of [`sample_angle`](Self::sample_angle) \[1/sr\]; `None` exactly where that is `None`.
    fn angle_pdf(&self, reference: DVec3, point: DVec3) -> Option<f64> {
        match self {
            Self::Triangle(shape) => shape.angle_pdf(reference),
            Self::Ellipsoid(shape) => shape.angle_pdf(reference, point),
            Self::Patch(_) | Self::Disk(_) => None,
        }
    }
}

/// Area per solid angle, d² / |cos θ|: densities per area times this are densities per solid angle. Zero where that
/// has no meaning: in the plane, and at the point itself.
fn area_per_angle(reference: DVec3, point: DVec3, normal: DVec3) -> f64 {
    let towards = point - reference;
    let squared = towards.length_squared();
    let factor = squared * squared.sqrt() / towards.dot(normal).abs();
    if factor.is_finite() { factor } else { 0.0 }
}

impl Surfaces {
    /// How many pieces of surface shine: each triangle, patch, disk or sphere of an area light is one, those without
    /// area too.
    pub fn emitters(&self) -> u32 {
        self.emitters
    }

    /// The part of an emitter, and its piece there.
    fn shining(&self, emitter: u32) -> Option<(&Part, u32)> {
        let after = self.shining.partition_point(|(first, _)| *first <= emitter);
        let (first, part) = *self.shining.get(after.checked_sub(1)?)?;
        let part = self.world.parts.get(part as usize)?;
        Some((part, emitter - first)).filter(|(part, piece)| (*piece as usize) < part.pieces())
    }

    fn shape(&self, emitter: u32) -> Option<(Shape<'_>, &Part, u32)> {
        let (part, piece) = self.shining(emitter)?;
        Some((Shape::new(part, piece)?, part, piece))
    }

    /// Radiance that an emitter sends to the side of its normal, and whether the back shines too.
    pub fn emission(&self, emitter: u32) -> ([f64; 3], bool) {
        self.shining(emitter)
            .and_then(|(part, _)| part.emission)
            .map_or(([0.0; 3], false), |e| (e.radiance, e.two_sided))
    }

    /// An emitter's area \[length²\]: in closed form but for curved patches, where it is good to 10⁻⁹. Not for the hot
    /// path.
    pub fn area(&self, emitter: u32) -> f64 {
        self.shape(emitter).map_or(0.0, |(shape, ..)| shape.area())
    }

    /// The corners of a box around an emitter, and the unit vector and cosine of a cone around its normals.
    pub fn emitter_bounds(&self, emitter: u32) -> ([DVec3; 2], DVec3, f64) {
        let nothing = ([DVec3::ZERO; 2], DVec3::Z, -1.0);
        let Some((shape, part, piece)) = self.shape(emitter) else {
            return nothing;
        };
        let Some(bounds) = part.bounds(piece) else {
            return nothing;
        };
        let (axis, cosine) = shape.cone();
        (bounds, if part.flipped { -axis } else { axis }, cosine)
    }

    /// A point on an emitter as seen from `reference`, by solid angle where that can be done; the density is per
    /// solid angle.
    ///
    /// Triangles are chosen by solid angle [Arvo 1995] unless they are seen under a tiny one or fill almost a
    /// hemisphere; spheres and ellipsoids by the cone that they fill, from outside. All else is chosen by area.
    /// `None` where the point lies in its own plane as seen from the reference.
    pub fn sample_emitter(
        &self,
        emitter: u32,
        reference: DVec3,
        u: [f64; 2],
    ) -> Option<EmitterPoint> {
        let (shape, part, piece) = self.shape(emitter)?;
        if let Some(choice) = shape.sample_angle(reference, u) {
            let spot = spot(part, piece, &choice)?;
            return Some(EmitterPoint {
                anchor: anchor(&spot),
                pdf: choice.pdf,
            });
        }
        let choice = shape.sample_area(u);
        let spot = spot(part, piece, &choice)?;
        let pdf = choice.pdf * area_per_angle(reference, spot.point, spot.normal);
        (pdf > 0.0).then(|| EmitterPoint {
            anchor: anchor(&spot),
            pdf,
        })
    }

    /// The density per solid angle with which [`sample_emitter`](Self::sample_emitter) finds a point of the emitter:
    /// zero on the far side of a sphere.
    pub fn emitter_pdf(&self, emitter: u32, reference: DVec3, point: &Anchor) -> f64 {
        let Some((shape, ..)) = self.shape(emitter) else {
            return 0.0;
        };
        shape.angle_pdf(reference, point.point).unwrap_or_else(|| {
            shape.area_pdf(point) * area_per_angle(reference, point.point, point.normal)
        })
    }

    /// A point spread over an emitter, evenly but for ellipsoids and curved patches; the density is per area, zero
    /// for emitters without any.
    pub fn sample_emitter_area(&self, emitter: u32, u: [f64; 2]) -> EmitterPoint {
        self.shape(emitter)
            .and_then(|(shape, part, piece)| {
                let choice = shape.sample_area(u);
                let spot = spot(part, piece, &choice)?;
                (choice.pdf > 0.0 && choice.pdf.is_finite()).then(|| EmitterPoint {
                    anchor: anchor(&spot),
                    pdf: choice.pdf,
                })
            })
            .unwrap_or(EmitterPoint {
                anchor: Anchor::in_space(DVec3::ZERO),
                pdf: 0.0,
            })
    }

    /// The density per area of [`sample_emitter_area`](Self::sample_emitter_area) at a point.
    pub fn emitter_area_pdf(&self, emitter: u32, point: &Anchor) -> f64 {
        self.shape(emitter)
            .map_or(0.0, |(shape, ..)| shape.area_pdf(point))
    }
}

fn spot(part: &Part, piece: u32, choice: &Choice) -> Option<Spot> {
    part.spot(piece, choice.at, choice.near)
}
