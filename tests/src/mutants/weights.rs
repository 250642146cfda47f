//! Mistakes in the estimate of transmittance by tracking: delta, ratio and residual ratio.

use super::flights::{four_nulls, low_majorant, one_uniform, stale_lookup};
use super::{Profile, WeightMutant};
use crate::stats::independent::SplitMix;

/// Mistakes in transmittance by tracking, by name.
pub const WEIGHTS: &[(&str, WeightMutant)] = &[
    ("delta, majorant 10 % too low, clamped", |p, rng| {
        passed(low_majorant(p, rng))
    }),
    ("delta, one uniform for both", |p, rng| {
        passed(one_uniform(p, rng))
    }),
    ("delta, at most four null collisions", |p, rng| {
        passed(four_nulls(p, rng))
    }),
    ("delta, extinction of the step's start", |p, rng| {
        passed(stale_lookup(p, rng))
    }),
    ("ratio, majorant 10 % too low, clamped", low_ratio),
    ("jittered ray marching of eight steps", marching),
    ("ratio, roulette without compensation", lossy_roulette),
    ("residual ratio without the control's factor", |p, rng| {
        residual(p, p.minimum, |rest| rest, |_, weight| weight, rng)
    }),
    (
        "residual ratio, control up to the last collision",
        |p, rng| {
            let control = p.minimum;
            let until = |t: f64, weight: f64| weight * (-control * t).exp();
            residual(p, control, |rest| rest, until, rng)
        },
    ),
    ("residual ratio, rest below the mean clamped", |p, rng| {
        let mean = 0.5 * (p.minimum + p.majorant);
        let through = (-mean * p.t_max).exp();
        residual(p, mean, |rest| rest.max(0.0), |_, w| w * through, rng)
    }),
];

fn passed(flight: f64) -> f64 {
    f64::from(u8::from(flight.is_infinite()))
}

/// Ratio tracking whose factors pass through `factor`.
fn ratio(
    p: &Profile<'_>,
    majorant: f64,
    rng: &mut SplitMix,
    mut factor: impl FnMut(f64, f64, &mut SplitMix) -> f64,
) -> f64 {
    let (mut t, mut weight) = (0.0, 1.0);
    loop {
        t += rng.exponential() / majorant;
        if t >= p.t_max {
            return weight;
        }
        weight = factor(weight, 1.0 - (p.sigma_t)(t) / majorant, rng);
        if weight == 0.0 {
            return 0.0;
        }
    }
}

fn low_ratio(p: &Profile<'_>, rng: &mut SplitMix) -> f64 {
    ratio(p, 0.9 * p.majorant, rng, |w, f, _| w * f.max(0.0))
}

fn lossy_roulette(p: &Profile<'_>, rng: &mut SplitMix) -> f64 {
    ratio(p, p.majorant, rng, |w, f, rng| {
        let weight = w * f;
        if weight < 0.125 && rng.uniform() * 0.125 >= weight {
            0.0
        } else {
            weight
        }
    })
}

fn marching(p: &Profile<'_>, rng: &mut SplitMix) -> f64 {
    let step = p.t_max / 8.0;
    let jitter = rng.uniform();
    let depth: f64 = (0..8)
        .map(|i| (p.sigma_t)((f64::from(i) + jitter) * step) * step)
        .sum();
    (-depth).exp()
}

/// Residual ratio tracking whose σ_t − c passes through `rest`; `total` makes the estimate of the distance to the
/// last collision and the product of all factors.
fn residual(
    p: &Profile<'_>,
    control: f64,
    rest: impl Fn(f64) -> f64,
    total: impl Fn(f64, f64) -> f64,
    rng: &mut SplitMix,
) -> f64 {
    let rate = (p.majorant - control).max(control - p.minimum);
    let (mut last, mut weight) = (0.0, 1.0);
    loop {
        let t = last + rng.exponential() / rate;
        if t >= p.t_max {
            return total(last, weight);
        }
        last = t;
        weight *= 1.0 - rest((p.sigma_t)(t) - control) / rate;
    }
}
