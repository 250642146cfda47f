//! Planted mistakes: trackers that go wrong the way trackers do.
//!
//! Each is written out on its own, in plain `f64`, as a beginner's first version of the real thing; the suites demand
//! that their checks reject every one. All walk [0, `t_max`) of a ray whose extinction is a function of distance.

use crate::stats::independent::SplitMix;

/// Extinction as a function of distance, and what bounds it.
#[derive(Clone, Copy)]
pub struct Profile<'a> {
    /// σ_t(t) [1/length].
    pub sigma_t: &'a dyn Fn(f64) -> f64,
    /// σ̄ [1/length].
    pub majorant: f64,
    /// Length of the ray.
    pub t_max: f64,
}

impl std::fmt::Debug for Profile<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "a profile below {} on {}", self.majorant, self.t_max)
    }
}

/// A planted mistake in free flight; infinite where the flight leaves.
pub type FlightMutant = fn(&Profile<'_>, &mut SplitMix) -> f64;

/// A planted mistake in the estimate of transmittance.
pub type WeightMutant = fn(&Profile<'_>, &mut SplitMix) -> f64;

/// The mistakes in free flight, by name.
pub const FLIGHTS: [(&str, FlightMutant); 5] = [
    ("majorant 10 % too low, clamped", low_majorant),
    ("one uniform for distance and acceptance", one_uniform),
    ("at most four null collisions", four_nulls),
    ("extinction of the step's start", stale_lookup),
    ("exponential from six bits", coarse_exponential),
];

/// The mistakes in transmittance, by name.
pub const WEIGHTS: [(&str, WeightMutant); 7] = [
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
];

fn passed(flight: f64) -> f64 {
    f64::from(u8::from(flight.is_infinite()))
}

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

fn low_majorant(p: &Profile<'_>, rng: &mut SplitMix) -> f64 {
    delta(p, 0.9 * p.majorant, u32::MAX - 1, rng, honest, |_, next| {
        next
    })
}

fn one_uniform(p: &Profile<'_>, rng: &mut SplitMix) -> f64 {
    let same = |rng: &mut SplitMix| {
        let u = rng.uniform();
        (-(-u).ln_1p(), u)
    };
    delta(p, p.majorant, u32::MAX - 1, rng, same, |_, next| next)
}

fn four_nulls(p: &Profile<'_>, rng: &mut SplitMix) -> f64 {
    delta(p, p.majorant, 4, rng, honest, |_, next| next)
}

fn stale_lookup(p: &Profile<'_>, rng: &mut SplitMix) -> f64 {
    delta(p, p.majorant, u32::MAX - 1, rng, honest, |t, _| t)
}

fn coarse_exponential(p: &Profile<'_>, rng: &mut SplitMix) -> f64 {
    let coarse = |rng: &mut SplitMix| {
        let u = (rng.uniform() * 64.0).floor() / 64.0;
        (-(-u).ln_1p(), rng.uniform())
    };
    delta(p, p.majorant, u32::MAX - 1, rng, coarse, |_, next| next)
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
