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

#[cfg(test)]
mod tests {
    use super::*;

    /// The law's distribution function at a sampled place is the number that it was sampled by, and its density the
    /// derivative: for lamps beside, before and behind the part of the line, near it and far away.
    #[test]
    fn places_follow_their_density() {
        for (from, to) in [(-1.0, 2.0), (0.5, 0.75), (-40.0, -3.0), (0.0, 1e3)] {
            for apart in [1e-3, 0.3, 7.0, 500.0_f64] {
                let nearness = Nearness::new(from, to, apart);
                let angle = |t: f64| libm::atan2(t, apart);
                let whole = angle(to) - angle(from);
                for u in [0.0, 0.01, 0.25, 0.5, 0.9, 0.999] {
                    let place = nearness.sample(u);
                    let below = (angle(place) - angle(from)) / whole;
                    assert!((below - u).abs() < 3e-6, "{from} {to} {apart} {u}: {below}");
                    let density = apart / (whole * (apart * apart + place * place));
                    let ratio = nearness.density(place) / density;
                    assert!(
                        (ratio - 1.0).abs() < 1e-6,
                        "{from} {to} {apart} {u}: {ratio}"
                    );
                }
            }
        }
    }

    /// In single precision nothing leaves the part or turns to no number, even where the lamp is all but on the line.
    #[test]
    fn places_stay_on_the_part() {
        for apart in [1e-4_f32, 1e-2, 1.0, 1e3] {
            for from in [-10.0_f32, -1e-3, 0.0, 5.0] {
                let nearness = Nearness::new(from, from + 2.0, apart);
                for i in 0..1000_u16 {
                    let place = nearness.sample(f32::from(i) / 1000.0);
                    assert!(
                        place >= from && place <= from + 2.0,
                        "{apart} {from} {i}: {place}"
                    );
                    assert!(nearness.density(place) > 0.0 && nearness.density(place).is_finite());
                }
            }
        }
    }
}
