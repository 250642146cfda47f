//! Pieces of surface, made ready to be met by rays.

use super::{GROWTH, SHRINK};
use crate::ray::Ray;
use crate::real::{Mask, Real, Word};
use crate::vec3::Vec3;

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

fn single(v: [f64; 3]) -> [f32; 3] {
    v.map(|c| c as f32)
}

/// A parallelogram or a triangle, grown by [`GROWTH`].
///
/// With the dual basis a = f × n / |n|², b = n × e / |n|² of its edges e and f and their product n, a place p of its plane
/// has the coordinates u = a·p − a₀ and v = b·p − b₀. They are scaled and shifted so that the piece is
///
/// ```text
/// max(|u|, |v|) ≤ 1       a parallelogram
/// min(u, v, 1 − u − v) ≥ 0        a triangle
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Flat {
    normal: [f32; 3],
    /// n·corner.
    height: f32,
    along_u: [f32; 3],
    from_u: f32,
    along_v: [f32; 3],
    from_v: f32,
    triangle: bool,
}

impl Flat {
    /// * `corner`, `edges`: one corner and what leads from it to its two neighbours \[length\].
    /// * `triangle`: the half of the parallelogram next to the corner.
    /// * `size`: the largest coordinate of the scene \[length\].
    ///
    /// `None` if it has no area, or none that single precision could tell.
    pub fn new(corner: [f64; 3], edges: [[f64; 3]; 2], triangle: bool, size: f64) -> Option<Self> {
        let [e, f] = edges;
        let n = cross(e, f);
        let squared = dot(n, n);
        let unit = n.map(|c| c / libm::sqrt(squared));
        let dual = |v: [f64; 3]| v.map(|c| c / squared);
        let (a, b) = (dual(cross(f, n)), dual(cross(n, e)));
        // By what a coordinate grows where the piece does.
        let slack = |along: [f64; 3]| libm::sqrt(dot(along, along)) * f64::from(GROWTH) * size;
        let (at_u, at_v) = (slack(a), slack(b));
        // From 0 to 1 of the piece, to what is kept: (u + shift) · factor.
        let [(shift_u, factor_u), (shift_v, factor_v)] = if triangle {
            let third = slack([0, 1, 2].map(|i| a[i] + b[i]));
            let factor = 1.0 / (1.0 + at_u + at_v + third);
            [(at_u, factor), (at_v, factor)]
        } else {
            [at_u, at_v].map(|slack| (-0.5, 2.0 / (1.0 + 2.0 * slack)))
        };
        let scaled = |along: [f64; 3], factor: f64| single(along.map(|c| c * factor));
        let flat = Self {
            normal: single(unit),
            height: dot(unit, corner) as f32,
            along_u: scaled(a, factor_u),
            from_u: ((dot(a, corner) - shift_u) * factor_u) as f32,
            along_v: scaled(b, factor_v),
            from_v: ((dot(b, corner) - shift_v) * factor_v) as f32,
            triangle,
        };
        let numbers = [flat.height, flat.from_u, flat.from_v];
        let vectors = [flat.normal, flat.along_u, flat.along_v];
        let finite = |x: &f32| x.is_finite();
        (numbers.iter().all(finite) && vectors.as_flattened().iter().all(finite)).then_some(flat)
    }

    /// Unit normal: the product of the edges.
    pub fn normal(&self) -> [f32; 3] {
        self.normal
    }

    /// Where rays meet it at 0 < t < `bound`, and which do.
    #[inline(always)]
    pub(super) fn meet<R: Real>(&self, ray: &Ray<R>, bound: R) -> (R, R::Mask) {
        let normal = Vec3::splat(self.normal);
        let t = (R::splat(self.height) - normal.dot(ray.origin)) / normal.dot(ray.direction);
        let place = ray.at(t);
        let u = Vec3::splat(self.along_u).dot(place) - R::splat(self.from_u);
        let v = Vec3::splat(self.along_v).dot(place) - R::splat(self.from_v);
        let within = if self.triangle {
            R::zero().le(u.min(v).min(R::one() - u - v))
        } else {
            u.abs().max(v.abs()).le(R::one())
        };
        // Along the plane t is infinite or no number, and so nothing is met.
        (t, R::zero().lt(t) & t.lt(bound) & within)
    }
}

/// A ball.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ball {
    centre: [f32; 3],
    radius: f32,
}

impl Ball {
    /// * `radius`: positive \[length\].
    pub fn new(centre: [f64; 3], radius: f64) -> Option<Self> {
        let ball = Self {
            centre: single(centre),
            radius: radius as f32,
        };
        let finite = ball.centre.iter().all(|c| c.is_finite()) && ball.radius.is_finite();
        (finite && ball.radius > 0.0).then_some(ball)
    }

    /// Where rays meet it at 0 < t < `bound`, and which do.
    ///
    /// * `on_it`: rays that begin on it: one of the two roots of the quadratic is known to be zero.
    ///
    /// The discriminant is that of the point nearest to the centre [Haines, Günther, Akenine-Möller 2019].
    #[inline(always)]
    pub(super) fn meet<R: Real>(&self, ray: &Ray<R>, bound: R, on_it: R::Mask) -> (R, R::Mask) {
        let towards = Vec3::splat(self.centre) - ray.origin;
        let nearest = towards.dot(ray.direction);
        let foot = towards - ray.direction * nearest;
        let radius = R::splat(self.radius);
        let squared = radius * radius - foot.dot(foot);
        let half = squared.max(R::zero()).sqrt();
        let enter = nearest - half;
        let outside = R::zero().lt(enter);
        let t = R::select(outside, enter, nearest + half);
        let t = R::select(on_it, nearest + nearest, t);
        let met = R::zero().lt(t) & t.lt(bound) & (R::zero().lt(squared) | on_it);
        (t, met)
    }
}

/// What a piece is made of, and where.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Matter {
    /// Unit normal of a flat; anything for a ball.
    pub normal: [f32; 3],
    /// Its middle.
    pub centre: [f32; 3],
    /// The part of light that it reflects, by colour.
    pub reflectance: [f32; 3],
    /// Radius of a ball; zero for flats.
    pub radius: f32,
}

/// Numbers a piece has in a table.
const STRIDE: u32 = 10;

impl Matter {
    /// The numbers that [`super::Room::matter`] has for it.
    pub fn words(&self) -> [f32; STRIDE as usize] {
        let ([a, b, c], [d, e, f], [g, h, i]) = (self.normal, self.centre, self.reflectance);
        [a, b, c, d, e, f, g, h, i, self.radius]
    }
}

/// A place on a piece.
#[derive(Clone, Copy, Debug)]
pub(super) struct Spot<R: Real> {
    /// The place.
    pub(super) point: Vec3<R>,
    /// Unit normal.
    pub(super) normal: Vec3<R>,
    pub(super) reflectance: Vec3<R>,
    /// Whether it lies on a ball.
    pub(super) round: R::Mask,
}

impl<R: Real> Spot<R> {
    /// Looks up the piece that was met near a place.
    #[inline(always)]
    pub(super) fn look(matter: &[f32], piece: R::Word, near: Vec3<R>) -> Self {
        let row = piece * R::Word::splat(STRIDE);
        let number = |i: u32| R::gather(matter, row + R::Word::splat(i));
        let vector = |i: u32| Vec3::new(number(i), number(i + 1), number(i + 2));
        let centre = vector(3);
        let radius = number(9);
        let round = R::zero().lt(radius);
        let mut normal = vector(0);
        let mut point = near + (centre - near) * R::splat(SHRINK);
        if round.any() {
            let outwards = (near - centre).normalised();
            normal = Vec3::select(round, outwards, normal);
            point = Vec3::select(round, centre + outwards * radius, point);
        }
        Self {
            point,
            normal,
            reflectance: vector(6),
            round,
        }
    }
}
