//! Free flights: the distance to the next collision.
//!
//! Every sampler draws t with density σ_t(t) T(t) and leaves with probability T(t_max), or carries a
//! weight that makes it so in expectation; each file has one, and the registry
//! [`for_each_free_flight`](crate::for_each_free_flight) names them for tests and benches.
//!
//! | sampler | serves | look-ups | weight |
//! |---|---|---|---|
//! | [`analytic`] | media in closed form | none | 1 |
//! | [`regular`] | piecewise constant media | none, but every cell is visited | 1 |
//! | [`delta`] | any medium with a bound | ∫σ̄T dt | 1 |
//! | [`decomposition`] | media that know a minimum | ∫(σ̄ − c)T dt | 1 |
//! | [`weighted`] | any medium, even where its bound fails | ∫σ̄T dt and more | signed |

pub mod analytic;
pub mod decomposition;
pub mod delta;
pub mod regular;
pub mod weighted;

/// Calls `$row!(name)` for each file of this folder.
#[macro_export]
macro_rules! for_each_free_flight {
    ($row:ident) => {
        $row!(analytic);
        $row!(decomposition);
        $row!(delta);
        $row!(regular);
        $row!(weighted);
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

impl<R: Real> Flight<R> {
    /// The distance to the collision, infinite where there is none.
    #[inline(always)]
    pub fn or_infinite(&self) -> R {
        R::select(self.collided, self.t, R::splat(f32::INFINITY))
    }
}
