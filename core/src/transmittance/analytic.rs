//! Transmittance in closed form: T = e^−τ, without variance, wherever τ is known.

use crate::medium::ClosedForm;
use crate::ray::Ray;
use crate::real::Real;

/// The transmittance of `[0, t_max)`, per lane; exact up to rounding (1 ulp of `exp`, and the
/// relative error of the optical depth, 6e-8 in homogeneous media, times that depth).
#[inline(always)]
pub fn estimate<R: Real>(medium: &impl ClosedForm<R>, ray: &Ray<R>, t_max: R) -> R {
    (-medium.optical_depth(ray, t_max)).exp()
}

/// e^(−σ_t t): the same for an extinction that differs per lane [1/length].
#[inline(always)]
pub fn through<R: Real>(sigma_t: R, t: R) -> R {
    (-(sigma_t * t)).exp()
}
