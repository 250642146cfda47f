//! A plain walk in double precision, for verifying the tables that have no quadrature.
//!
//! It shares no line, no number format and no generator with the trackers under test.

use super::phase_functions::Kind;
use crate::stats::independent::SplitMix;

/// A convex body and the extinction inside, bounded by a constant.
pub(crate) struct Body<'a> {
    shape: Shape,
    majorant: f64,
    sigma_t: &'a dyn Fn(f64, f64, f64) -> f64,
}

enum Shape {
    Sphere(f64),
    Block([f64; 3]),
}

/// How a walk ended.
pub(crate) struct End {
    pub(crate) dir: [f64; 3],
    pub(crate) real: i32,
    pub(crate) null: i32,
    /// Length of the whole walk.
    pub(crate) path: f64,
}

impl<'a> Body<'a> {
    pub(crate) fn sphere(
        radius: f64,
        majorant: f64,
        sigma_t: &'a dyn Fn(f64, f64, f64) -> f64,
    ) -> Self {
        let shape = Shape::Sphere(radius);
        Self {
            shape,
            majorant,
            sigma_t,
        }
    }

    /// The block [0, a] × [0, b] × [0, c].
    pub(crate) fn block(
        abc: [f64; 3],
        majorant: f64,
        sigma_t: &'a dyn Fn(f64, f64, f64) -> f64,
    ) -> Self {
        let shape = Shape::Block(abc);
        Self {
            shape,
            majorant,
            sigma_t,
        }
    }

    /// Distance from a point inside to the boundary.
    fn exit(&self, x: [f64; 3], dir: [f64; 3]) -> f64 {
        match self.shape {
            Shape::Sphere(radius) => {
                let along: f64 = (0..3).map(|i| x[i] * dir[i]).sum();
                let squared: f64 = x.iter().map(|v| v * v).sum();
                (along * along + radius * radius - squared).max(0.0).sqrt() - along
            }
            Shape::Block(abc) => (0..3)
                .map(|i| {
                    let wall = if dir[i] > 0.0 { abc[i] } else { 0.0 };
                    if dir[i] == 0.0 {
                        f64::INFINITY
                    } else {
                        (wall - x[i]) / dir[i]
                    }
                })
                .fold(f64::INFINITY, f64::min),
        }
    }

    /// A uniform point of the surface and a Lambertian direction inwards.
    pub(crate) fn enter(&self, rng: &mut SplitMix) -> ([f64; 3], [f64; 3]) {
        let (point, normal) = match self.shape {
            Shape::Sphere(radius) => {
                let outward = turn([0.0, 0.0, 1.0], 2.0 * rng.uniform() - 1.0, rng);
                (outward.map(|v| radius * v), outward.map(|v| -v))
            }
            Shape::Block(abc) => {
                let area = [abc[1] * abc[2], abc[2] * abc[0], abc[0] * abc[1]];
                let mut pick = rng.uniform() * (area[0] + area[1] + area[2]);
                let mut axis = 0;
                while axis < 2 && pick >= area[axis] {
                    pick -= area[axis];
                    axis += 1;
                }
                let far = rng.uniform() < 0.5;
                let mut point = abc.map(|edge| edge * rng.uniform());
                point[axis] = if far { abc[axis] } else { 0.0 };
                let mut normal = [0.0; 3];
                normal[axis] = if far { -1.0 } else { 1.0 };
                (point, normal)
            }
        };
        let cos = rng.uniform().sqrt();
        (point, turn(normal, cos, rng))
    }
}

/// Follows delta tracking with scattering at every real collision until the walk leaves.
pub(crate) fn walk(
    body: &Body<'_>,
    g: f64,
    origin: [f64; 3],
    dir: [f64; 3],
    rng: &mut SplitMix,
) -> End {
    let mut x = origin;
    let mut end = End {
        dir,
        real: 0,
        null: 0,
        path: 0.0,
    };
    loop {
        let flight = rng.exponential() / body.majorant;
        let exit = body.exit(x, end.dir);
        if flight >= exit {
            end.path += exit;
            return end;
        }
        end.path += flight;
        x = std::array::from_fn(|i| x[i] + flight * end.dir[i]);
        if rng.uniform() * body.majorant < (body.sigma_t)(x[0], x[1], x[2]) {
            end.real += 1;
            let cos = henyey_greenstein(g, rng);
            end.dir = turn(end.dir, cos, rng);
        } else {
            end.null += 1;
        }
    }
}

/// A cosine by rejection: slow where the lobe is narrow, and plainly right.
fn henyey_greenstein(g: f64, rng: &mut SplitMix) -> f64 {
    if g == 0.0 {
        return 2.0 * rng.uniform() - 1.0;
    }
    let phase = Kind::Hg { g };
    let peak = phase.eval(g.signum());
    loop {
        let cos = 2.0 * rng.uniform() - 1.0;
        if rng.uniform() * peak < phase.eval(cos) {
            return cos;
        }
    }
}

/// A unit vector at `cos` to `axis`, of uniform azimuth.
fn turn(axis: [f64; 3], cos: f64, rng: &mut SplitMix) -> [f64; 3] {
    // A uniform azimuth: a random vector made orthogonal to the axis.
    let across = loop {
        let v: [f64; 3] = std::array::from_fn(|_| 2.0 * rng.uniform() - 1.0);
        let squared: f64 = v.iter().map(|c| c * c).sum();
        if squared > 1.0 {
            continue;
        }
        let along: f64 = (0..3).map(|i| v[i] * axis[i]).sum();
        let side: [f64; 3] = std::array::from_fn(|i| v[i] - along * axis[i]);
        let length = side.iter().map(|c| c * c).sum::<f64>().sqrt();
        if length > 1e-3 {
            break side.map(|c| c / length);
        }
    };
    let sin = (1.0 - cos * cos).max(0.0).sqrt();
    let turned: [f64; 3] = std::array::from_fn(|i| cos * axis[i] + sin * across[i]);
    let length = turned.iter().map(|c| c * c).sum::<f64>().sqrt();
    turned.map(|c| c / length)
}
