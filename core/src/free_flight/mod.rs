//! Free flights: the distance to the next collision.
//!
//! Every sampler draws t with density σ_t(t) T(t) and leaves with probability T(t_max); each file
//! has one, and the registry [`for_each_free_flight`](crate::for_each_free_flight) names them for
//! tests and benches.

pub mod analytic;
pub mod delta;

/// Calls `$row!(name)` for each file of this folder.
#[macro_export]
macro_rules! for_each_free_flight {
    ($row:ident) => {
        $row!(analytic);
        $row!(delta);
    };
}

use crate::real::Real;

/// A sampled flight, per lane.
#[derive(Clone, Copy, Debug)]
pub struct Flight<R: Real> {
    /// Where it ended \[length\]: the collision, or `t_max`.
    pub t: R,
    /// Whether it ended in a real collision.
    pub collided: R::Mask,
}
