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

#[cfg(test)]
mod tests {
    use super::*;

    fn ray(origin: [f32; 3], towards: [f32; 3]) -> Ray<f32> {
        let origin = Vec3::splat(origin);
        Ray {
            origin,
            direction: (Vec3::splat(towards) - origin).normalised(),
        }
    }

    /// Rays to known places of a piece and beside it, from either side.
    #[test]
    fn pieces_are_met_within_their_outline() {
        let (corner, edges) = ([0.5, -1.0, 2.0], [[2.0, 1.0, 0.5], [-0.5, 1.5, 1.0]]);
        for triangle in [false, true] {
            let flat = Flat::new(corner, edges, triangle, 4.0).expect("a piece");
            for i in -5..26 {
                for j in -5..26 {
                    let (u, v) = (f64::from(i) / 20.0 + 0.003, f64::from(j) / 20.0 + 0.004);
                    let place =
                        [0, 1, 2].map(|c| (corner[c] + edges[0][c] * u + edges[1][c] * v) as f32);
                    let most = if triangle { u + v } else { u.max(v) };
                    let inside = u >= 0.0 && v >= 0.0 && most <= 1.0;
                    for from in [[3.0, -3.0, 4.0], [-3.0, 2.0, -4.0]] {
                        let ray = ray(from, place);
                        let (t, met) = flat.meet(&ray, 1e30);
                        assert_eq!(met, inside, "{u} {v} {triangle}");
                        if met {
                            let off = ray.at(t) - Vec3::splat(place);
                            assert!(off.dot(off).sqrt() < 4e-6);
                            assert!(!flat.meet(&ray, t).1, "not nearer than itself");
                        }
                    }
                }
            }
        }
        assert_eq!(Flat::new(corner, [[1.0, 2.0, 3.0]; 2], false, 1.0), None);
    }

    /// Pieces that share an edge leave no crack: every ray near it meets one of them.
    #[test]
    fn edges_hold() {
        let p = [0.1, 0.2, 0.3];
        let (e, f) = ([0.7, 0.11, -0.13], [0.07, -0.9, 0.31]);
        let g = [-0.2, 0.3, 0.8];
        let pieces =
            [[e, f], [e, g]].map(|edges| Flat::new(p, edges, false, 1.0).expect("a piece"));
        let mut state = 1_u32;
        let mut random = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            f64::from(state >> 8) / f64::from(1 << 24)
        };
        for _ in 0..100_000 {
            let u = 0.01 + 0.98 * random();
            let on_edge = [0, 1, 2].map(|c| (p[c] + e[c] * u) as f32);
            let from = [0, 1, 2].map(|c| (p[c] + 0.5 * e[c] + f[c] + g[c] + random() - 0.5) as f32);
            let ray = ray(from, on_edge);
            assert!(
                pieces.iter().any(|piece| piece.meet(&ray, 1e30).1),
                "{u} {from:?}"
            );
        }
    }

    /// A ray that leaves a ball outwards never meets it again, one that leads through it does on the other side.
    #[test]
    fn balls_are_left_and_crossed() {
        let ball = Ball::new([0.3, -0.2, 0.1], 0.7).expect("a ball");
        let mut state = 7_u32;
        let mut random = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 8) as f32 / 8_388_608.0 - 1.0
        };
        for _ in 0..10_000 {
            let normal = Vec3::new(random(), random(), random()).normalised();
            let direction = Vec3::new(random(), random(), random()).normalised();
            let centre = Vec3::splat([0.3, -0.2, 0.1]);
            let ray = Ray {
                origin: centre + normal * 0.7,
                direction,
            };
            let (t, met) = ball.meet(&ray, 1e30, true);
            assert_eq!(met, normal.dot(direction) < 0.0);
            if met {
                let off = ray.at(t) - centre;
                assert!((off.dot(off).sqrt() - 0.7).abs() < 1e-6);
            }
            // From outside it is met where it is nearest.
            let from = Ray {
                origin: centre + normal * 3.0,
                direction: -normal,
            };
            let (t, met) = ball.meet(&from, 1e30, false);
            assert!(met && (t - 2.3).abs() < 1e-5, "{t}");
        }
        assert_eq!(Ball::new([0.0; 3], 0.0), None);
    }
}
