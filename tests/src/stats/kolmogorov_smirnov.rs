//! Do these draws follow this continuous law, and if flights may escape, up to where they may?
//!
//! ```text
//! D = sup |Fₙ(x) − F(x)|,   P(√n D > λ) ≤ 2 e^{−2λ²} for every n
//! ```
//!
//! Unlike the limit law, this bound holds for small n as well, and for the supremum over any part of the line: so
//! flights that leave the medium at `t_max` are compared on [0, t_max) alone, with the escaped counted in n. The
//! last comparison, just below `t_max`, is the escape probability (sharper on its own: [`judge_proportion`]).
//!
//! *Blind to:* what happens within 1/√n of probability: the far tail, the first thousandth of a mean free path, and
//! atoms lighter than that. Prove those by enumeration. Source: [Massart 1990].
//!
//! [`judge_proportion`]: super::judge_proportion

use super::{KS_CRITICAL, Verdict, deviate_of_ln_p};

/// Distance between an empirical law and a continuous one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KolmogorovSmirnov {
    count: u64,
    distance: f64,
}

impl KolmogorovSmirnov {
    /// Compares draws with their cumulative distribution function; sorts the draws.
    ///
    /// `cdf` is continuous, rises from 0 to 1 and is called once per draw, in ascending order. A NaN among draws or
    /// values makes the distance NaN, which no verdict accepts.
    pub fn new(draws: &mut [f64], cdf: impl FnMut(f64) -> f64) -> Self {
        let distance = supremum(draws, draws.len() as f64, cdf);
        Self {
            count: draws.len() as u64,
            distance,
        }
    }

    /// Compares draws with the exponential law of rate 1, which every sampled optical depth follows.
    pub fn exponential(draws: &mut [f64]) -> Self {
        Self::new(draws, |x| -(-x.max(0.0)).exp_m1())
    }

    /// Compares flights that either collided at one of `distances` or were among the `escaped`.
    ///
    /// * `distances`: in [0, t_max), any unit; sorted here. One at or beyond `t_max` should have escaped: NaN.
    /// * `cdf`: P(collision before t) = 1 − e^{−τ(t)} for t in [0, t_max].
    pub fn censored(
        distances: &mut [f64],
        escaped: u64,
        t_max: f64,
        mut cdf: impl FnMut(f64) -> f64,
    ) -> Self {
        let count = distances.len() as u64 + escaped;
        let collided = distances.len() as f64 / count as f64;
        let inside = distances.iter().all(|&t| (0.0..t_max).contains(&t));
        let body = supremum(distances, count as f64, &mut cdf);
        let end = (collided - cdf(t_max)).abs();
        let distance = if inside && !end.is_nan() {
            if body > end || body.is_nan() {
                body
            } else {
                end
            }
        } else {
            f64::NAN
        };
        Self { count, distance }
    }

    /// Number of draws, escaped flights included.
    pub const fn count(&self) -> u64 {
        self.count
    }

    /// D, the largest distance found, in [0, 1].
    pub const fn distance(&self) -> f64 {
        self.distance
    }

    /// Upper bound of the probability of so large a distance; 1 for small ones.
    pub fn p_value(&self) -> f64 {
        self.ln_p().exp().min(1.0)
    }

    /// Agrees below 2.694/√n; `Blind` when that exceeds `resolution`, the distance the check must be able to see.
    pub fn verdict(&self, resolution: f64) -> Verdict {
        let critical = KS_CRITICAL / (self.count as f64).sqrt();
        let sees = critical <= resolution;
        if !sees || self.distance.is_nan() {
            Verdict::Blind {
                resolution: critical,
            }
        } else if self.distance < critical {
            Verdict::Agrees
        } else {
            Verdict::Biased {
                z: deviate_of_ln_p(self.ln_p()),
            }
        }
    }

    fn ln_p(&self) -> f64 {
        2.0_f64.ln() - 2.0 * self.count as f64 * self.distance * self.distance
    }
}

/// Largest distance on either side of each step of the empirical law of `n` draws, of which some are listed.
fn supremum(draws: &mut [f64], n: f64, mut cdf: impl FnMut(f64) -> f64) -> f64 {
    draws.sort_by(f64::total_cmp);
    let mut largest = 0.0_f64;
    for (i, &x) in draws.iter().enumerate() {
        let expected = cdf(x);
        let below = (expected - i as f64 / n).abs();
        let above = ((i + 1) as f64 / n - expected).abs();
        if x.is_nan() || expected.is_nan() {
            return f64::NAN;
        }
        largest = largest.max(below).max(above);
    }
    largest
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stats::independent::SplitMix;
    use statrs::function::erf::erf;

    fn draws(seed: u64, n: usize, draw: impl Fn(&mut SplitMix) -> f64) -> Vec<f64> {
        let mut rng = SplitMix::new(seed);
        (0..n).map(|_| draw(&mut rng)).collect()
    }

    #[test]
    fn a_small_set_by_hand() {
        // Steps at 0.1, 0.5, 0.6 of a uniform law: the largest gap is 1 − 0.6 after the last step.
        let ks = KolmogorovSmirnov::new(&mut [0.6, 0.1, 0.5], |x| x);
        assert!((ks.distance() - 0.4).abs() < 1e-15);
        let ks = KolmogorovSmirnov::new(&mut [0.6, 0.7, 0.9], |x| x);
        assert!((ks.distance() - 0.6).abs() < 1e-15, "before the first step");
    }

    #[test]
    fn known_laws_agree() {
        let n = 1 << 17;
        let uniform = KolmogorovSmirnov::new(&mut draws(31, n, SplitMix::uniform), |x| x);
        let normal = KolmogorovSmirnov::new(&mut draws(32, n, SplitMix::normal), |x| {
            0.5 + 0.5 * erf(x / std::f64::consts::SQRT_2)
        });
        let exponential = KolmogorovSmirnov::exponential(&mut draws(33, n, SplitMix::exponential));
        for ks in [uniform, normal, exponential] {
            assert_eq!(ks.verdict(0.01), Verdict::Agrees, "{ks:?}");
        }
    }

    #[test]
    fn false_alarms_stay_near_and_below_the_bound() {
        // The bound is nearly attained for n = 1000: at α = 0.1, 2000 runs should give somewhat below 200.
        let critical = (0.5 * (2.0_f64 / 0.1).ln() / 1000.0).sqrt();
        let alarms = (0..2000)
            .filter(|&run| {
                let mut u = draws(40_000 + run, 1000, SplitMix::uniform);
                KolmogorovSmirnov::new(&mut u, |x| x).distance() > critical
            })
            .count();
        assert!((120..=250).contains(&alarms), "{alarms}");
    }

    #[test]
    fn a_planted_rate_is_rejected() {
        let n = 1 << 17;
        let mut slow = draws(34, n, |r| 1.03 * r.exponential());
        let verdict = KolmogorovSmirnov::exponential(&mut slow).verdict(0.01);
        // sup |e^{−x} − e^{−x/1.03}| ≈ 0.03/e.
        assert!(matches!(verdict, Verdict::Biased { .. }), "{verdict:?}");
        let mut slower = draws(35, n, |r| 1.2 * r.exponential());
        let verdict = KolmogorovSmirnov::exponential(&mut slower).verdict(0.01);
        assert!(
            matches!(verdict, Verdict::Biased { z } if z > 10.0),
            "{verdict:?}"
        );
    }

    fn fly(seed: u64, n: usize, rate: f64, t_max: f64) -> (Vec<f64>, u64) {
        let flights = draws(seed, n, |r| r.exponential() / rate);
        let collided: Vec<f64> = flights.into_iter().filter(|&t| t < t_max).collect();
        let escaped = (n - collided.len()) as u64;
        (collided, escaped)
    }

    #[test]
    fn censored_flights_agree_and_a_lost_escape_does_not() {
        let cdf = |t: f64| -(-0.7 * t).exp_m1();
        let (mut collided, escaped) = fly(36, 1 << 17, 0.7, 2.0);
        let ks = KolmogorovSmirnov::censored(&mut collided, escaped, 2.0, cdf);
        assert_eq!(ks.count(), 1 << 17);
        assert_eq!(ks.verdict(0.01), Verdict::Agrees, "{ks:?}");
        // Forgetting a tenth of the escaped moves every share by some per cent.
        let ks = KolmogorovSmirnov::censored(&mut collided, escaped * 9 / 10, 2.0, cdf);
        assert!(matches!(ks.verdict(0.01), Verdict::Biased { z } if z > 10.0));
    }

    #[test]
    fn all_escaping_is_judged_by_the_escape_probability() {
        let ks = KolmogorovSmirnov::censored(&mut [], 1 << 17, 2.0, |_| 0.0);
        assert!(ks.verdict(0.01).agrees());
        let ks = KolmogorovSmirnov::censored(&mut [], 1 << 17, 2.0, |t| 0.1 * t);
        assert!(matches!(ks.verdict(0.01), Verdict::Biased { z } if z > 10.0));
    }

    #[test]
    fn nan_strays_and_short_runs_are_blind() {
        let blind = |v: Verdict| matches!(v, Verdict::Blind { .. });
        let mut spoilt = draws(37, 1 << 17, SplitMix::uniform);
        spoilt[5] = f64::NAN;
        assert!(blind(
            KolmogorovSmirnov::new(&mut spoilt, |x| x).verdict(0.01)
        ));
        let mut few = draws(38, 1000, SplitMix::uniform);
        assert!(blind(KolmogorovSmirnov::new(&mut few, |x| x).verdict(0.01)));
        assert!(blind(KolmogorovSmirnov::new(&mut [], |x| x).verdict(0.01)));
        let mut beyond = vec![2.5; 1 << 17];
        let ks = KolmogorovSmirnov::censored(&mut beyond, 0, 2.0, |t| 0.5 * t);
        assert!(blind(ks.verdict(0.01)));
    }
}
