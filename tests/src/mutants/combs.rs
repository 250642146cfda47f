//! Mistakes in transmittance by a comb of walks.

use super::lines::{Comb, collisions};
use super::{Line, Profile, WeightMutant};

/// Mistakes in transmittance by a comb, by name.
pub const COMBS: &[(&str, WeightMutant)] = &[
    ("comb without its offset", |p, rng| {
        let comb = Comb {
            offset: 0.0,
            ..Comb::honest(p, rng)
        };
        comb.estimate(&alone(p), |t, _| collisions(&alone(p), t, rng))
    }),
    ("comb, uncollided part counted twice", |p, rng| {
        let comb = Comb {
            collides: 1.0,
            ..Comb::honest(p, rng)
        };
        comb.estimate(&alone(p), |t, _| collisions(&alone(p), t, rng))
    }),
    ("comb, teeth as steps of one product", |p, rng| {
        let comb = Comb {
            collides: 1.0,
            ..Comb::honest(p, rng)
        };
        let walks = f64::from(Comb::WALKS);
        let mut weight = 1.0;
        comb.estimate(&alone(p), |t, _| {
            if t < p.t_max {
                weight *= 1.0 - (p.sigma_t)(t) / (walks * p.majorant);
            }
            0.0
        });
        weight
    }),
];

/// What makes a line integral a transmittance: light at the end alone.
fn alone<'a>(p: &Profile<'a>) -> Line<'a> {
    Line {
        profile: *p,
        volume: &|_| 0.0,
        boundary: 1.0,
    }
}
