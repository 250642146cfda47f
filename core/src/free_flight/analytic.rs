//! Free flight in closed form, for a homogeneous medium.
//!
//! ```text
//! t = e / σ_t,  e ~ Exp(1)
//! ```
//!
//! Exact; one exponential, no look-ups.

use crate::free_flight::Flight;
use crate::medium::Homogeneous;
use crate::real::Real;
use crate::stream::Stream;

/// Samples one flight on `[0, t_max)`, per active lane.
///
/// * `t_max`: per lane \[length\].
///
/// Inactive lanes get t = `t_max` and no collision. In vacuum every flight leaves.
#[inline(always)]
pub fn sample<R: Real>(
    medium: &Homogeneous,
    t_max: R,
    rng: &mut impl Stream<R>,
    active: R::Mask,
) -> Flight<R> {
    let t = rng.exponential(active) / R::splat(medium.extinction());
    let collided = t.lt(t_max) & active;
    Flight {
        t: R::select(collided, t, t_max),
        collided,
    }
}
