//! Mistakes in the power series about a jittered estimate of the optical depth.

use super::{Profile, WeightMutant};
use crate::stats::independent::SplitMix;

/// Mistakes in transmittance by power series, by name.
pub const SERIES: &[(&str, WeightMutant)] = &[
    ("power series of order zero", |p, rng| depth(p, rng).exp()),
    ("power series of order one", |p, rng| {
        let (first, second) = (depth(p, rng), depth(p, rng));
        first.exp() * (1.0 + (second - first))
    }),
    ("power series, rare orders not made up for", |p, rng| {
        series(p, rng, |_| 1.0, false, 1.0)
    }),
    ("power series, one jitter for all", |p, rng| {
        series(p, rng, reached, true, 1.0)
    }),
    ("power series, differences of the wrong sign", |p, rng| {
        series(p, rng, reached, false, -1.0)
    }),
];

/// −(L/M) Σ σ_t over a comb of one point: M is small so that orders matter.
fn depth(p: &Profile<'_>, rng: &mut SplitMix) -> f64 {
    -(p.sigma_t)(rng.uniform() * p.t_max) * p.t_max
}

/// P(N ≥ k).
fn reached(k: usize) -> f64 {
    match k {
        0 => 1.0,
        1 | 2 => 0.1,
        _ => reached(k - 1) * 2.0 / k as f64,
    }
}

/// e^{X₀} Σ_k m_k(Xⱼ − X₀)/(k! P(N ≥ k)).
///
/// * `probability`: what terms are divided by. `shared`: all estimates are the first. `sign`: of the differences.
fn series(
    p: &Profile<'_>,
    rng: &mut SplitMix,
    probability: fn(usize) -> f64,
    shared: bool,
    sign: f64,
) -> f64 {
    let decision = rng.uniform();
    let mut order = 0;
    while decision < reached(order + 1) {
        order += 1;
    }
    let first = depth(p, rng);
    let mut other = |_| if shared { first } else { depth(p, rng) };
    let others: Vec<f64> = (0..order).map(|j| sign * (other(j) - first)).collect();
    let (mut sum, mut binomial, mut factorial) = (1.0, 1.0, 1.0);
    for (k, power) in symmetric(&others).into_iter().enumerate().skip(1) {
        binomial *= (order - k + 1) as f64 / k as f64;
        factorial *= k as f64;
        sum += power / binomial / (factorial * probability(k));
    }
    first.exp() * sum
}

/// The elementary symmetric polynomials of all orders.
fn symmetric(numbers: &[f64]) -> Vec<f64> {
    let mut all = vec![0.0; numbers.len() + 1];
    all[0] = 1.0;
    for x in numbers {
        for k in (1..all.len()).rev() {
            all[k] += x * all[k - 1];
        }
    }
    all
}
