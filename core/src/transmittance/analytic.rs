//! Transmittance in closed form, for a homogeneous medium: T = e^(−σ_t t_max), without variance.

use crate::medium::Homogeneous;
use crate::real::Real;

/// The transmittance of `[0, t_max)`, per lane; exact up to rounding (1 ulp of `exp`, and the
/// relative error 6e-8 of the optical depth times that depth).
#[inline(always)]
pub fn estimate<R: Real>(medium: &Homogeneous, t_max: R) -> R {
    through(R::splat(medium.extinction()), t_max)
}

/// e^(−σ_t t): the same for an extinction that differs per lane [1/length].
#[inline(always)]
pub fn through<R: Real>(sigma_t: R, t: R) -> R {
    (-(sigma_t * t)).exp()
}
