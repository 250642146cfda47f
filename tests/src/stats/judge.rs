//! Does a measured mean equal a known value, and could the measurement have told?
//!
//! ```text
//! z = (mean − truth) / √(se² + (2⁻²² · truth)²),   se the standard error
//! ```
//!
//! `Blind` ends the commonest vacuity, error bars too wide to see anything: too few samples, NaN and exploding
//! variance land there. *What it cannot see:* correlation between the weights, which narrows `se` without moving
//! the mean (see [`Sample::judge_blocks`]); and rare large weights that a run happened not to draw, which narrow it
//! too: for weights in [0, 1] use [`judge_bounded`]. Source of the approach: [Subr, Arvo 2007].

use super::{ALPHA, Moments, ROUNDING, Sample, Z_CRITICAL, deviate_of_ln_p};

/// The answer of a statistical check. Only `Agrees` passes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Verdict {
    /// The measurement could have told, and it did not object.
    Agrees,
    /// Rejected: as surprising as a standard normal at `z` (signed where the check has a direction).
    Biased {
        /// Deviation in standard errors, or the normal deviate of the same p-value.
        z: f64,
    },
    /// The error bar is wider than the resolution the check asked for, or not a number.
    Blind {
        /// What the measurement could have resolved, in the measure the check asked for.
        resolution: f64,
    },
}

impl Verdict {
    /// Whether the check passed.
    pub const fn agrees(&self) -> bool {
        matches!(self, Self::Agrees)
    }

    /// The first of two answers that does not pass, so that one check may ask two questions.
    pub const fn and(self, other: Self) -> Self {
        if self.agrees() { other } else { self }
    }
}

/// Compares a mean with `truth` at α = 10⁻⁶.
///
/// * `truth`: the exact expectation, in the unit of the weights; not 0 (use [`judge_within`] there).
/// * `resolution`: the relative standard error the check must reach, for example 0.003.
pub fn judge(m: &Moments, truth: f64, resolution: f64) -> Verdict {
    match judge_within(m, truth, resolution * truth.abs()) {
        Verdict::Blind { resolution } => Verdict::Blind {
            resolution: resolution / truth.abs(),
        },
        verdict => verdict,
    }
}

/// Compares a mean with `truth`, asking for a standard error of at most `resolution` in the unit of the weights.
///
/// For expectations of 0, and wherever a relative error means nothing.
pub fn judge_within(m: &Moments, truth: f64, resolution: f64) -> Verdict {
    let rounding = ROUNDING * truth.abs(); // f32 weights cannot do better
    let standard_error = m.standard_error().hypot(rounding);
    // Also catches NaN, which compares as neither.
    let sees = standard_error <= resolution;
    if !sees || !m.mean().is_finite() || !truth.is_finite() {
        return Verdict::Blind {
            resolution: standard_error,
        };
    }
    let difference = m.mean() - truth;
    if difference == 0.0 {
        return Verdict::Agrees; // a constant 0 where 0 is expected has no error bar either
    }
    let z = difference / standard_error;
    if z.abs() < Z_CRITICAL {
        Verdict::Agrees
    } else {
        Verdict::Biased { z }
    }
}

/// Compares the mean of weights in [0, 1] with `truth` without trusting their sample variance.
///
/// ```text
/// P(|mean − truth| ≥ δ) ≤ 2 e^{−2nδ²}
/// ```
///
/// Holds for every n and every law on [0, 1], rare events included; much wider than [`judge`] where the variance
/// is small. A weight outside [0, 1 + 2⁻²²] voids the bound: `Blind` with infinite resolution. Reports as z the
/// normal deviate of the bound. Source: [Hoeffding 1963].
pub fn judge_bounded(m: &Moments, truth: f64, resolution: f64) -> Verdict {
    let n = m.count() as f64;
    if m.count() > 0 && (m.min() < 0.0 || m.max() > 1.0 + ROUNDING) {
        return Verdict::Blind {
            resolution: f64::INFINITY,
        };
    }
    let half_width = ((2.0 / ALPHA).ln() / (2.0 * n)).sqrt() + ROUNDING * truth.abs();
    let sees = half_width <= resolution * truth.abs();
    if !sees || !m.mean().is_finite() {
        return Verdict::Blind {
            resolution: half_width / truth.abs(),
        };
    }
    let difference = m.mean() - truth;
    if difference.abs() < half_width {
        Verdict::Agrees
    } else {
        let ln_p = (2.0_f64).ln() - 2.0 * n * difference * difference;
        Verdict::Biased {
            z: deviate_of_ln_p(ln_p).copysign(difference),
        }
    }
}

/// Compares a share of `hits` among `n` independent trials with the probability `p`.
///
/// Uses the variance p(1 − p)/n that the hypothesis itself predicts, so a run without any hit is judged too.
/// `resolution` bounds the standard error relative to the rarer of p and 1 − p. Domain: p in (0, 1).
pub fn judge_proportion(hits: u64, n: u64, p: f64, resolution: f64) -> Verdict {
    let standard_error = (p * (1.0 - p) / n as f64).sqrt();
    let rarer = p.min(1.0 - p);
    let sees = standard_error <= resolution * rarer;
    if !sees {
        return Verdict::Blind {
            resolution: standard_error / rarer,
        };
    }
    let z = (hits as f64 / n as f64 - p) / standard_error.hypot(ROUNDING * rarer);
    if z.abs() < Z_CRITICAL {
        Verdict::Agrees
    } else {
        Verdict::Biased { z }
    }
}

/// Passes when the weights are independent and their mean is `truth`; says what it saw otherwise.
///
/// # Panics
/// When [`judge`] or [`Sample::judge_blocks`] does not agree: this is the assertion of a statistical test.
#[track_caller]
pub fn assert_agrees(name: &str, sample: &Sample, truth: f64, resolution: f64) {
    assert_mean_agrees(name, sample.moments(), truth, resolution);
    let verdict = sample.judge_blocks();
    assert!(
        verdict.agrees(),
        "{name}: weights are not independent: block variance is {:.4} times what independence gives, \
         over {} blocks of {}: {verdict:?}",
        sample.block_ratio(),
        sample.blocks(),
        sample.block_size(),
    );
}

/// Passes when [`judge`] agrees; for moments whose blocks are not known.
///
/// # Panics
/// When it does not agree.
#[track_caller]
pub fn assert_mean_agrees(name: &str, m: &Moments, truth: f64, resolution: f64) {
    let verdict = judge(m, truth, resolution);
    let standard_error = m.standard_error();
    assert!(
        verdict.agrees(),
        "{name}: mean {:.9e}, truth {truth:.9e}, standard error {standard_error:.3e}, z {:+.2}, \
         relative error {:+.3e}, n {}, asked to resolve {resolution:.1e}: {verdict:?}",
        m.mean(),
        (m.mean() - truth) / standard_error,
        m.mean() / truth - 1.0,
        m.count(),
    );
}

/// Passes when `verdict` agrees; for every check that has no sharper assertion.
///
/// # Panics
/// When it does not agree.
#[track_caller]
pub fn assert_verdict(name: &str, verdict: Verdict) {
    assert!(verdict.agrees(), "{name}: {verdict:?}");
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stats::independent::SplitMix;

    fn draw(seed: u64, n: usize, weight: impl Fn(&mut SplitMix) -> f64) -> Moments {
        let mut rng = SplitMix::new(seed);
        (0..n).map(|_| weight(&mut rng)).collect()
    }

    #[test]
    fn known_means_agree() {
        let n = 1 << 16;
        let cases = [
            (draw(1, n, SplitMix::uniform), 0.5),
            (draw(2, n, SplitMix::exponential), 1.0),
            (draw(3, n, |r| 3.0 + r.normal()), 3.0),
        ];
        for (m, truth) in cases {
            assert_eq!(judge(&m, truth, 0.01), Verdict::Agrees);
        }
        assert!(judge_within(&draw(4, n, SplitMix::normal), 0.0, 0.01).agrees());
    }

    #[test]
    fn too_few_samples_are_blind() {
        for n in [0, 1, 2, 100] {
            let m = draw(5, n, SplitMix::exponential);
            assert!(matches!(judge(&m, 1.0, 0.01), Verdict::Blind { .. }), "{n}");
            assert!(matches!(
                judge_bounded(&m, 0.5, 0.01),
                Verdict::Blind { .. }
            ));
        }
    }

    #[test]
    fn nan_infinity_and_exploding_variance_are_blind() {
        for bad in [f64::NAN, f64::INFINITY, 1e30] {
            let mut m = draw(6, 1 << 16, SplitMix::uniform);
            m.push(bad);
            assert!(
                matches!(judge(&m, 0.5, 0.01), Verdict::Blind { .. }),
                "{bad}"
            );
        }
        let m = draw(7, 1 << 16, SplitMix::uniform);
        assert!(matches!(judge(&m, f64::NAN, 0.01), Verdict::Blind { .. }));
        assert!(matches!(judge(&m, 0.5, f64::NAN), Verdict::Blind { .. }));
    }

    #[test]
    fn an_exact_estimator_agrees_to_the_rounding_of_f32() {
        let third: Moments = (0..1000).map(|_| f64::from(1.0_f32 / 3.0)).collect();
        assert!(judge(&third, 1.0 / 3.0, 0.01).agrees());
        let off: Moments = (0..1000).map(|_| 1.0 / 3.0 * (1.0 + 1e-5)).collect();
        assert!(matches!(judge(&off, 1.0 / 3.0, 0.01), Verdict::Biased { z } if z > 10.0));
    }

    #[test]
    fn false_alarms_come_at_the_nominal_rate() {
        // At a laxer α = 0.05 over 2000 runs the count is binomial: mean 100, deviation 9.75.
        let lax = 1.959_964;
        let (mut means, mut proportions) = (0, 0);
        for run in 0..2000 {
            let m = draw(1000 + run, 400, SplitMix::uniform);
            let z = (m.mean() - 0.5) / m.standard_error();
            means += u32::from(z.abs() > lax);
            let mut rng = SplitMix::new(9000 + run);
            let hits = (0..400).filter(|_| rng.uniform() < 0.3).count() as f64;
            let z = (hits / 400.0 - 0.3) / (0.3 * 0.7 / 400.0_f64).sqrt();
            proportions += u32::from(z.abs() > lax);
            assert!(judge(&m, 0.5, 0.1).agrees());
        }
        assert!((52..=148).contains(&means), "{means}");
        assert!((52..=148).contains(&proportions), "{proportions}");
    }

    #[test]
    fn planted_shifts_are_seen_at_the_predicted_deviate() {
        let n = 1 << 18;
        for percent in [1.0, 5.0] {
            let m = draw(8, n, |r| r.uniform() * (1.0 + percent / 100.0));
            let predicted = 0.5 * percent / 100.0 / (1.0 / 12.0 / n as f64).sqrt();
            let Verdict::Biased { z } = judge(&m, 0.5, 0.01) else {
                panic!("a shift of {percent} % went unseen")
            };
            assert!(
                (z - predicted).abs() < 0.1 * predicted + 5.0,
                "{z} for {predicted}"
            );
        }
    }

    #[test]
    fn bounded_weights_need_no_variance() {
        // The sample variance of an all-zero run is 0; the bound does not care.
        let zeros: Moments = (0..100_000).map(|_| 0.0).collect();
        assert!(judge_bounded(&zeros, 1e-3, 20.0).agrees());
        assert!(matches!(judge_bounded(&zeros, 0.1, 1.0), Verdict::Biased { z } if z < -10.0));
        let m = draw(10, 1 << 16, SplitMix::uniform);
        assert!(judge_bounded(&m, 0.5, 0.05).agrees());
        assert!(matches!(judge_bounded(&m, 0.45, 0.05), Verdict::Biased { z } if z > 10.0));
        let stray: Moments = (0..1 << 16)
            .map(|i| if i == 0 { 1.5 } else { 0.5 })
            .collect();
        assert!(matches!(
            judge_bounded(&stray, 0.5, 0.05),
            Verdict::Blind { .. }
        ));
    }

    #[test]
    fn proportions_judge_the_absence_of_hits() {
        assert!(judge_proportion(0, 1 << 20, 1e-3, 0.1) != Verdict::Agrees);
        assert!(judge_proportion(1049, 1 << 20, 1e-3, 0.1).agrees());
        assert!(matches!(
            judge_proportion(0, 1000, 1e-3, 0.1),
            Verdict::Blind { .. }
        ));
    }

    #[test]
    #[should_panic(expected = "shifted: mean 4.999")]
    fn a_failure_names_itself_and_its_numbers() {
        let sample: Sample = (0..1 << 16).map(|i| f64::from(i % 7) / 6.0).collect();
        assert_agrees("shifted", &sample, 0.6, 0.01);
    }
}
