//! Do two estimates agree, when neither is exact?
//!
//! ```text
//! t = (mean₁ − mean₂) / √(v₁/n₁ + v₂/n₂),
//! ν = (v₁/n₁ + v₂/n₂)² / ((v₁/n₁)²/(n₁ − 1) + (v₂/n₂)²/(n₂ − 1))
//! ```
//!
//! with sample variances v. Both variances count and need not be equal. Sources: [Welch 1947];
//! for images [Jung, Hanika, Dachsbacher 2020].

use super::{ALPHA, Moments, ROUNDING, Verdict, deviate_of_ln_p};
use statrs::function::{beta::checked_beta_reg, gamma::ln_gamma};

/// Difference of two means in units of its standard error, with the freedom of that unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Welch {
    /// The difference over its standard error.
    pub t: f64,
    /// Effective degrees of freedom ν.
    pub dof: f64,
    /// Standard error of the difference, in the unit of the weights.
    pub standard_error: f64,
}

/// Compares two means; neither need be exact.
pub fn welch(a: &Moments, b: &Moments) -> Welch {
    let scale = a.mean().abs().max(b.mean().abs());
    Welch::of(
        a.mean() - b.mean(),
        [a.standard_error().powi(2), b.standard_error().powi(2)],
        [a.count() as f64, b.count() as f64],
        scale,
    )
}

impl Welch {
    /// From a difference, the two variances of the means, the two counts and the size of the means, which sets
    /// the rounding allowed.
    pub(super) fn of(difference: f64, variances: [f64; 2], counts: [f64; 2], scale: f64) -> Self {
        let [va, vb] = variances;
        let sum = va + vb;
        let dof = sum * sum / (va * va / (counts[0] - 1.0) + vb * vb / (counts[1] - 1.0));
        let standard_error = (sum + (ROUNDING * scale).powi(2)).sqrt();
        Self {
            // Equal means of constant weights differ by nothing, whatever their error bar.
            t: if difference == 0.0 && !sum.is_nan() {
                0.0
            } else {
                difference / standard_error
            },
            dof: if sum == 0.0 { f64::INFINITY } else { dof },
            standard_error,
        }
    }

    /// Probability of so large a |t| when the means are equal, by Student's law.
    pub fn p_value(&self) -> f64 {
        self.ln_p().exp()
    }

    /// Normal deviate of the same p-value, with the sign of t.
    pub fn z(&self) -> f64 {
        if self.dof > 1e7 {
            return self.t; // the two laws agree to more digits than t has
        }
        deviate_of_ln_p(self.ln_p()).copysign(self.t)
    }

    /// Agrees for p ≥ α; `Blind` when the standard error exceeds `resolution`, in the unit of the weights.
    pub fn verdict(&self, resolution: f64) -> Verdict {
        let sees = self.standard_error <= resolution;
        let p = self.p_value();
        if !sees || p.is_nan() {
            Verdict::Blind {
                resolution: self.standard_error,
            }
        } else if p >= ALPHA {
            Verdict::Agrees
        } else {
            Verdict::Biased { z: self.z() }
        }
    }

    fn ln_p(&self) -> f64 {
        if self.t.is_nan() || self.dof.is_nan() || self.dof < 1.0 {
            return f64::NAN;
        }
        if self.t == 0.0 {
            return 0.0;
        }
        if self.dof > 1e7 {
            return super::ln_p_of_deviate(self.t.abs());
        }
        // P(|T| > t) = I_x(ν/2, ½) with x = ν/(ν + t²). Where that underflows, the density times its length of
        // decay, (ν + t²)/(νt), remains: exact in the limits of large t and of large ν.
        let half = 0.5 * self.dof;
        let (t, nu) = (self.t.abs(), self.dof);
        let x = nu / (nu + t * t);
        match checked_beta_reg(half, 0.5, x) {
            Ok(p) if p > 1e-280 => p.ln(),
            Ok(_) => {
                let ln_density =
                    ln_gamma(half + 0.5) - ln_gamma(half) - 0.5 * (nu * std::f64::consts::PI).ln()
                        + (half + 0.5) * x.ln();
                ln_density + (2.0 / (x * t)).ln()
            }
            Err(_) => f64::NAN,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stats::independent::SplitMix;

    fn normal(seed: u64, n: usize, mean: f64, deviation: f64) -> Moments {
        let mut rng = SplitMix::new(seed);
        (0..n).map(|_| mean + deviation * rng.normal()).collect()
    }

    #[test]
    fn student_quantiles_of_tables() {
        for (t, dof, p) in [
            (2.228_139, 10.0, 0.05),
            (4.032_143, 5.0, 0.01),
            (12.7062, 1.0, 0.05),
        ] {
            let welch = Welch {
                t,
                dof,
                standard_error: 1.0,
            };
            assert!(
                (welch.p_value() / p - 1.0).abs() < 1e-4,
                "{}",
                welch.p_value()
            );
        }
        let large = Welch {
            t: 40.0,
            dof: 1e6,
            standard_error: 1.0,
        };
        assert!(
            (large.z() - 40.0 * (1.0 - 4e-4)).abs() < 1e-3,
            "{}",
            large.z()
        );
    }

    #[test]
    fn small_and_unequal_samples_keep_the_rate() {
        let alarms = (0..2000)
            .filter(|&run| {
                let a = normal(80_000 + run, 8, 1.0, 1.0);
                let b = normal(90_000 + run, 30, 1.0, 3.0);
                welch(&a, &b).p_value() < 0.05
            })
            .count();
        assert!((52..=148).contains(&alarms), "{alarms} of 2000 at 5 %");
    }

    #[test]
    fn a_planted_difference_is_rejected_and_wide_bars_are_blind() {
        let (a, b) = (normal(61, 1 << 16, 1.0, 1.0), normal(62, 1 << 14, 1.0, 2.0));
        assert_eq!(welch(&a, &b).verdict(0.05), Verdict::Agrees);
        let shifted = normal(63, 1 << 14, 1.3, 2.0);
        assert!(matches!(welch(&a, &shifted).verdict(0.05), Verdict::Biased { z } if z < -10.0));
        assert!(matches!(welch(&a, &b).verdict(1e-3), Verdict::Blind { .. }));
        let mut spoilt = a;
        spoilt.push(f64::NAN);
        assert!(matches!(
            welch(&spoilt, &b).verdict(0.05),
            Verdict::Blind { .. }
        ));
        let one = normal(64, 1, 1.0, 1.0);
        assert!(matches!(
            welch(&one, &b).verdict(9.0),
            Verdict::Blind { .. }
        ));
    }

    #[test]
    fn constants_compare_to_the_rounding_of_f32() {
        let third: Moments = (0..9).map(|_| 1.0 / 3.0).collect();
        let rounded: Moments = (0..9).map(|_| f64::from(1.0_f32 / 3.0)).collect();
        let half: Moments = (0..9).map(|_| 0.5).collect();
        assert!(welch(&third, &third).verdict(0.01).agrees());
        assert!(welch(&third, &rounded).verdict(0.01).agrees());
        assert!(matches!(
            welch(&third, &half).verdict(0.01),
            Verdict::Biased { .. }
        ));
    }
}
