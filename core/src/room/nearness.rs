//! Places on a line chosen by the angle that they are seen under from a point beside it.
//!
//! ```text
//! p(t) = D / (θ (D² + t²)) for a ≤ t ≤ b,     t = D tan(φ + u θ)
//! ```
//!
//! t is counted from the foot of the point, D is its distance from the line, φ the angle of a and θ that between both
//! ends. With φ by its sides, tan needs no arc tangent but that of the difference:
//!
//! ```text
//! t = D (a cos uθ + D sin uθ) / (D cos uθ − a sin uθ)
//! ```
//!
//! So distances are chosen by nearness to a lamp [Kulla, Fajardo 2012], and one coordinate of places on a rectangle about by
//! solid angle.

use core::f32::consts::TAU;

use crate::elementary::turn_of;
use crate::real::Real;

/// A part of a line, seen from beside it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Nearness<R> {
    from: R,
    to: R,
    apart: R,
    /// The angle, as a fraction of a full turn.
    turn: R,
}

impl<R: Real> Nearness<R> {
    /// * `from`, `to`: the ends, counted from the foot. `apart`: the distance of the point from the line, positive.
    #[inline(always)]
    pub(super) fn new(from: R, to: R, apart: R) -> Self {
        let turn = turn_of((to - from) * apart, apart * apart + from * to);
        Self {
            from,
            to,
            apart,
            turn,
        }
    }

    /// A place at a uniform number.
    #[inline(always)]
    pub(super) fn sample(&self, u: R) -> R {
        let (sin, cos) = (u * self.turn).sin_cos_turn();
        let (from, apart) = (self.from, self.apart);
        let place = apart * (from * cos + apart * sin) / (apart * cos - from * sin);
        // Rounding may lead past either end.
        place.max(from).min(self.to)
    }

    /// The angle \[rad\].
    #[inline(always)]
    pub(super) fn angle(&self) -> R {
        self.turn * R::splat(TAU)
    }

    /// Density of a place [1/length].
    #[inline(always)]
    pub(super) fn density(&self, place: R) -> R {
        let apart = self.apart;
        apart / (self.angle() * (apart * apart + place * place))
    }
}
