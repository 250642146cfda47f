//! Free flight in closed form, where the optical depth can be inverted.
//!
//! ```text
//! ∫₀ᵗ σ_t ds = e,  e ~ Exp(1)
//! ```
//!
//! Exact; one exponential, no look-ups. Serves every medium that implements [`ClosedForm`]:
//! homogeneous, linear ramp, exponential atmosphere.

use crate::free_flight::Flight;
use crate::medium::ClosedForm;
use crate::ray::Ray;
use crate::real::Real;
use crate::stream::Stream;

/// Samples one flight on `[0, t_max)` of each active lane's ray.
///
/// * `ray`: per lane, world space. `t_max`: per lane \[length\].
///
/// Inactive lanes get t = `t_max` and no collision. In vacuum every flight leaves.
#[inline(always)]
pub fn sample<R: Real>(
    medium: &impl ClosedForm<R>,
    ray: &Ray<R>,
    t_max: R,
    rng: &mut impl Stream<R>,
    active: R::Mask,
) -> Flight<R> {
    let t = medium.distance(ray, rng.exponential(active));
    let collided = t.lt(t_max) & active;
    Flight {
        t: R::select(collided, t, t_max),
        collided,
    }
}
