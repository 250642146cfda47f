//! Isotropic scattering: every direction alike. p = 1/(4π), mean cosine 0.

use crate::phase::INV_4PI;
use crate::real::Real;

/// Density over the sphere [1/sr].
#[inline(always)]
pub fn eval<R: Real>(_cos_theta: R) -> R {
    R::splat(INV_4PI)
}

/// The cosine at u in [0, 1): 2u − 1.
#[inline(always)]
pub fn sample<R: Real>(u: R) -> R {
    u + u - R::one()
}

/// The u of a cosine in [−1, 1].
#[inline(always)]
pub fn invert<R: Real>(cos_theta: R) -> R {
    (cos_theta + R::one()) * R::splat(0.5)
}
