//! Mistakes in free flight: by rejection, from cell to cell, in closed form, and with weights.

use super::{FlightMutant, Profile};
use crate::stats::independent::SplitMix;

/// Mistakes in tracking by rejection, by name.
pub const FLIGHTS: &[(&str, FlightMutant)] = &[
    ("majorant 10 % too low, clamped", low_majorant),
    ("one uniform for distance and acceptance", one_uniform),
    ("at most four null collisions", four_nulls),
    ("extinction of the step's start", stale_lookup),
    ("exponential from six bits", coarse_exponential),
    ("remaining depth forgotten at cells", forgotten_depth),
    ("decomposition, control above the minimum", high_control),
    (
        "decomposition, residual accepted as the whole",
        whole_residual,
    ),
];

/// Mistakes in tracking from cell to cell, a quarter of the ray each.
pub const CELLS: &[(&str, FlightMutant)] = &[
    ("regular, extinction of the cell before", |p, rng| {
        regular(p, rng, |cell| f64::from(cell.max(1) - 1) + 0.5)
    }),
    ("regular, extinction at the cell's entry", |p, rng| {
        regular(p, rng, |cell| f64::from(cell) + 1e-9)
    }),
];

/// Mistakes in the closed form of a ramp.
pub const RAMPS: &[(&str, FlightMutant)] = &[
    ("closed form, depth drawn twice", |p, rng| {
        let (one, other) = (rng.exponential(), rng.exponential());
        ramp(p, one, other, 1.0)
    }),
    ("closed form, root of the wrong sign", |p, rng| {
        let depth = rng.exponential();
        ramp(p, depth, depth, -1.0)
    }),
];

/// A planted mistake in weighted tracking: distance, infinite where the flight leaves, and weight.
pub type WeightedMutant = fn(&Profile<'_>, &mut SplitMix) -> (f64, f64);

/// Mistakes in weighted tracking under a bound that fails.
pub const WEIGHTED: &[(&str, WeightedMutant)] = &[
    ("weights clamped at zero", |p, rng| {
        weighted(p, rng, |w| w.max(0.0), |w| w)
    }),
    ("weights without the sign", |p, rng| {
        weighted(p, rng, f64::abs, |w| w)
    }),
    ("collisions without their weight", |p, rng| {
        weighted(p, rng, |w| w, |_| 1.0)
    }),
];

/// Delta tracking, its parts exchangeable: `step` draws a distance and the number that decides.
fn delta(
    p: &Profile<'_>,
    majorant: f64,
    nulls: u32,
    rng: &mut SplitMix,
    step: impl Fn(&mut SplitMix) -> (f64, f64),
    place: impl Fn(f64, f64) -> f64,
) -> f64 {
    let mut t = 0.0;
    for _ in 0..=nulls {
        let (depth, decision) = step(rng);
        let next = t + depth / majorant;
        if next >= p.t_max {
            return f64::INFINITY;
        }
        if decision * majorant < (p.sigma_t)(place(t, next)) {
            return next;
        }
        t = next;
    }
    f64::INFINITY
}

fn honest(rng: &mut SplitMix) -> (f64, f64) {
    (rng.exponential(), rng.uniform())
}

pub(super) fn low_majorant(p: &Profile<'_>, rng: &mut SplitMix) -> f64 {
    delta(p, 0.9 * p.majorant, u32::MAX - 1, rng, honest, |_, next| {
        next
    })
}

pub(super) fn one_uniform(p: &Profile<'_>, rng: &mut SplitMix) -> f64 {
    let same = |rng: &mut SplitMix| {
        let u = rng.uniform();
        (-(-u).ln_1p(), u)
    };
    delta(p, p.majorant, u32::MAX - 1, rng, same, |_, next| next)
}

pub(super) fn four_nulls(p: &Profile<'_>, rng: &mut SplitMix) -> f64 {
    delta(p, p.majorant, 4, rng, honest, |_, next| next)
}

pub(super) fn stale_lookup(p: &Profile<'_>, rng: &mut SplitMix) -> f64 {
    delta(p, p.majorant, u32::MAX - 1, rng, honest, |t, _| t)
}

fn coarse_exponential(p: &Profile<'_>, rng: &mut SplitMix) -> f64 {
    let coarse = |rng: &mut SplitMix| {
        let u = (rng.uniform() * 64.0).floor() / 64.0;
        (-(-u).ln_1p(), rng.uniform())
    };
    delta(p, p.majorant, u32::MAX - 1, rng, coarse, |_, next| next)
}

/// Delta tracking under a bound for each quarter, which neither carries the depth across nor draws it anew.
fn forgotten_depth(p: &Profile<'_>, rng: &mut SplitMix) -> f64 {
    let cell = 0.25 * p.t_max;
    let mut depth = rng.exponential();
    for i in 0..4 {
        let (mut t, end) = (f64::from(i) * cell, f64::from(i + 1) * cell);
        let majorant = (p.sigma_t)(t).max((p.sigma_t)(end));
        while depth < majorant * (end - t) {
            t += depth / majorant;
            if rng.uniform() * majorant < (p.sigma_t)(t) {
                return t;
            }
            depth = rng.exponential();
        }
    }
    f64::INFINITY
}

/// Decomposition tracking by two processes: the control collides unseen, the rest as `accept`(σ_t) decides.
fn decomposed(
    p: &Profile<'_>,
    control: f64,
    rng: &mut SplitMix,
    accept: impl Fn(f64) -> f64,
) -> f64 {
    let of_control = rng.exponential() / control;
    let rate = p.majorant - control;
    let mut t = 0.0;
    loop {
        t += rng.exponential() / rate;
        if t >= of_control.min(p.t_max) {
            return if of_control < p.t_max {
                of_control
            } else {
                f64::INFINITY
            };
        }
        if rng.uniform() < accept((p.sigma_t)(t)) {
            return t;
        }
    }
}

fn high_control(p: &Profile<'_>, rng: &mut SplitMix) -> f64 {
    let control = 0.75 * p.minimum + 0.25 * p.majorant;
    decomposed(p, control, rng, |sigma_t| {
        (sigma_t - control) / (p.majorant - control)
    })
}

fn whole_residual(p: &Profile<'_>, rng: &mut SplitMix) -> f64 {
    decomposed(p, p.minimum, rng, |sigma_t| sigma_t / p.majorant)
}

/// Regular tracking over quarters, with the extinction at `place`(cell), counted in cells.
fn regular(p: &Profile<'_>, rng: &mut SplitMix, place: impl Fn(u32) -> f64) -> f64 {
    let cell = 0.25 * p.t_max;
    let mut depth = rng.exponential();
    for i in 0..4 {
        let sigma_t = (p.sigma_t)(place(i) * cell);
        if depth < sigma_t * cell {
            return f64::from(i) * cell + depth / sigma_t;
        }
        depth -= sigma_t * cell;
    }
    f64::INFINITY
}

/// 2e/(a + √(a² + 2be)) with the depth of the numerator, that of the root, and the root's sign of b.
fn ramp(p: &Profile<'_>, depth: f64, in_root: f64, sign: f64) -> f64 {
    let a = (p.sigma_t)(0.0);
    let b = ((p.sigma_t)(p.t_max) - a) / p.t_max;
    let square = a * a + sign * 2.0 * b * in_root;
    let t = 2.0 * depth / (a + square.sqrt());
    if t < p.t_max { t } else { f64::INFINITY }
}

/// Weighted tracking whose weights pass through `null` and `real`.
fn weighted(
    p: &Profile<'_>,
    rng: &mut SplitMix,
    null: impl Fn(f64) -> f64,
    real: impl Fn(f64) -> f64,
) -> (f64, f64) {
    let (mut t, mut weight) = (0.0, 1.0);
    loop {
        t += rng.exponential() / p.majorant;
        if t >= p.t_max {
            return (f64::INFINITY, weight);
        }
        let sigma_t = (p.sigma_t)(t);
        let total = sigma_t + (p.majorant - sigma_t).abs();
        let factor = total / p.majorant;
        if rng.uniform() * total < sigma_t {
            return (t, weight * real(factor));
        }
        weight *= null(factor.copysign(p.majorant - sigma_t));
    }
}
