//! Rayleigh scattering: particles much smaller than the wavelength.
//!
//! ```text
//! p(μ) = 3/(16π) (1 + μ²),   u = (μ³ + 3μ + 4)/8
//! ```
//!
//! The inverse is the one real root of μ³ + 3μ + 4 − 8u = 0. With μ = 2 sinh(θ) it reads
//! 2 sinh(3θ) = 8u − 4, but Cardano's form cancels near u = 1/2, where μ is small. One Newton step
//! on the cubic, which is convex and well conditioned (slope at least 3), repairs that. Mean cosine 0.
//! Source: [Chandrasekhar 1960].

use crate::phase::INV_4PI;
use crate::real::Real;

/// Density over the sphere [1/sr].
#[inline(always)]
pub fn eval<R: Real>(cos_theta: R) -> R {
    R::splat(0.75 * INV_4PI) * (R::one() + cos_theta * cos_theta)
}

/// The cosine at u in [0, 1), per lane.
#[inline(always)]
pub fn sample<R: Real>(u: R) -> R {
    // c³ − 1/c³ = 8u − 4 at μ = c − 1/c; taken for |8u − 4| and turned around.
    let q = u * R::splat(4.0) - R::splat(2.0);
    let magnitude = q.abs();
    let cube = magnitude + (magnitude * magnitude + R::one()).sqrt();
    let c = (cube.ln() * R::splat(1.0 / 3.0)).exp();
    let start = c - R::one() / c;
    let three = R::splat(3.0);
    let square = start * start;
    let excess = (square + three) * start - (magnitude + magnitude);
    let root = start - excess / (three * square + three);
    let root = root.max(R::zero()).min(R::one());
    R::select(q.lt(R::zero()), -root, root)
}

/// The u of a cosine in [−1, 1].
#[inline(always)]
pub fn invert<R: Real>(cos_theta: R) -> R {
    let cubic = (cos_theta * cos_theta + R::splat(3.0)) * cos_theta;
    (cubic + R::splat(4.0)) * R::splat(0.125)
}
