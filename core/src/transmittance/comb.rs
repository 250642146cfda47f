//! Transmittance by Algorithm 2: a comb of delta-tracking walks, of which the ones that pass are counted.
//!
//! ```text
//! T ≈ e^−D + (1 − e^−D) · (share of the walks that pass),   D = ∫σ̄ dt
//! ```
//!
//! The line integral with c_V = 0 and c_∂V = 1. Exact where the bound is the extinction; between that and
//! n independent walks of delta tracking elsewhere. Source: [Raab, Seibert, Keller 2006] Algorithm 2.

use crate::line_integral;
use crate::medium::Medium;
use crate::ray::Ray;
use crate::real::Real;
use crate::stream::Stream;

/// One estimate, in [0, 1], of the transmittance of `[0, t_max)` of each active lane's ray, from a comb of
/// `walks` walks; zero in other lanes.
#[inline]
pub fn estimate<R: Real, M: Medium<R>>(
    medium: &M,
    ray: &Ray<R>,
    t_max: R,
    walks: u32,
    rng: &mut impl Stream<R>,
    active: R::Mask,
) -> R {
    let nothing = |_, _| R::zero();
    line_integral::collisions(medium, ray, t_max, walks, nothing, R::one(), rng, active)
}
