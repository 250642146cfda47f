//! What the runs of a method amount to.

use super::{Method, Run};
use crate::compare::deviates::student_exceeded_with;

/// Probability that an interval misses.
const MISS: f64 = 0.05;
/// The same for the verdict that there is a floor, which is passed on every method of every scene.
const MISS_VERDICT: f64 = 1e-3;

/// A number with the interval that holds it with probability 95 %.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    /// The estimate.
    pub value: f64,
    /// Half the width of the interval.
    pub radius: f64,
}

impl Interval {
    /// The mean of independent numbers; an infinite radius of a single one, `None` of none.
    pub fn of_mean(values: &[f64]) -> Option<Self> {
        let n = values.len() as f64;
        if values.is_empty() {
            return None;
        }
        let value = values.iter().sum::<f64>() / n;
        let scatter: f64 = values.iter().map(|v| (v - value).powi(2)).sum();
        let radius = if values.len() > 1 {
            student_exceeded_with(MISS, n - 1.0) * (scatter / (n * (n - 1.0))).sqrt()
        } else {
            f64::INFINITY
        };
        Some(Self { value, radius })
    }
}

/// What runs say of the error.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// It falls as one over time, as that of an unbiased method does.
    Falls,
    /// It stays above a floor, hence a bias; or noise has tails so heavy that runs this short do not show it.
    Floor,
    /// There are too few runs, or runs too noisy, to say.
    Unknown,
}

impl Verdict {
    /// As it is written in tables.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Falls => "as 1/t",
            Self::Floor => "FLOOR",
            Self::Unknown => "unknown",
        }
    }
}

/// What the runs of a method amount to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Summary {
    /// CPU seconds × relMSE: over the runs of the three largest budgets. Lower is better.
    pub efficiency: Interval,
    /// The same of the median over blocks.
    pub median: Interval,
    /// Slope of ln relMSE over ln seconds; −1 without bias.
    pub slope: Interval,
    /// What runs say of a bias.
    pub verdict: Verdict,
    /// The relMSE at which the error would stay, where it is significant.
    pub floor: Option<Interval>,
    /// CPU seconds per sample per pixel.
    pub pace: f64,
}

/// Budgets that count for the efficiency: the largest.
const LARGEST: usize = 3;

impl Method {
    /// What its runs amount to; `None` without runs.
    pub fn summary(&self) -> Option<Summary> {
        let budgets = self.budgets();
        let first = budgets.len().saturating_sub(LARGEST);
        let counted: Vec<&Run> = self
            .runs
            .iter()
            .filter(|run| budgets[first..].contains(&run.budget))
            .collect();
        let product = |of: fn(&Run) -> f64| {
            let values: Vec<f64> = counted.iter().map(|run| run.seconds * of(run)).collect();
            Interval::of_mean(&values)
        };
        let seconds: f64 = counted.iter().map(|run| run.seconds).sum();
        let samples: f64 = counted.iter().map(|run| f64::from(run.samples)).sum();
        let (slope, verdict) = self.slope();
        let floor = self.floor();
        let verdict = if floor.is_some() {
            Verdict::Floor
        } else {
            verdict
        };
        Some(Summary {
            efficiency: product(|run| run.judgement.relative)?,
            median: product(|run| run.judgement.median)?,
            slope,
            verdict,
            floor,
            pace: seconds / samples,
        })
    }

    /// The relMSE b of a bias, where there is one: of relMSE = a / t + b, by least squares of
    ///
    /// ```text
    /// t · relMSE = a + b t
    /// ```
    ///
    /// whose left side has about the same scatter at all budgets. Overheads make short runs dear, so b comes out too low rather than too high.
    fn floor(&self) -> Option<Interval> {
        let points: Vec<(f64, f64)> = self
            .runs
            .iter()
            .map(|run| (run.seconds, run.seconds * run.judgement.relative))
            .collect();
        let n = points.len() as f64;
        if points.len() < 4 {
            return None;
        }
        let x0 = points.iter().map(|p| p.0).sum::<f64>() / n;
        let y0 = points.iter().map(|p| p.1).sum::<f64>() / n;
        let xx: f64 = points.iter().map(|p| (p.0 - x0).powi(2)).sum();
        let xy: f64 = points.iter().map(|p| (p.0 - x0) * (p.1 - y0)).sum();
        let slope = xy / xx;
        let residual: f64 = points
            .iter()
            .map(|p| (p.1 - y0 - slope * (p.0 - x0)).powi(2))
            .sum();
        let error = (residual / (n - 2.0) / xx).sqrt();
        // One-sided: a floor is above.
        let sure = student_exceeded_with(2.0 * MISS_VERDICT, n - 2.0) * error;
        let radius = student_exceeded_with(MISS, n - 2.0) * error;
        (slope > sure).then_some(Interval {
            value: slope,
            radius,
        })
    }

    /// The line through the logarithms of the means of each budget, weighted by their runs, and whether it says anything.
    ///
    /// Means come before logarithms: that of a single run is too low where tails are heavy. The residuals give the interval.
    fn slope(&self) -> (Interval, Verdict) {
        let nothing = Interval {
            value: f64::NAN,
            radius: f64::INFINITY,
        };
        let mut points = Vec::new();
        for budget in self.budgets() {
            let (mut n, mut seconds, mut error) = (0.0, 0.0, 0.0);
            for run in self.at(budget) {
                n += 1.0;
                seconds += run.seconds;
                error += run.judgement.relative;
            }
            if seconds > 0.0 && error > 0.0 {
                points.push((n, libm::log(seconds / n), libm::log(error / n)));
            }
        }
        if points.len() < 3 {
            return (nothing, Verdict::Unknown);
        }
        let weight: f64 = points.iter().map(|p| p.0).sum();
        let mean = |of: fn(&(f64, f64, f64)) -> f64| {
            points.iter().map(|p| p.0 * of(p)).sum::<f64>() / weight
        };
        let (x0, y0) = (mean(|p| p.1), mean(|p| p.2));
        let xx: f64 = points.iter().map(|p| p.0 * (p.1 - x0).powi(2)).sum();
        let xy: f64 = points.iter().map(|p| p.0 * (p.1 - x0) * (p.2 - y0)).sum();
        if xx <= 0.0 {
            return (nothing, Verdict::Unknown);
        }
        let slope = xy / xx;
        let residual: f64 = points
            .iter()
            .map(|p| p.0 * (p.2 - y0 - slope * (p.1 - x0)).powi(2))
            .sum();
        let freedom = points.len() as f64 - 2.0;
        let error = (residual / freedom / xx).sqrt();
        let interval = Interval {
            value: slope,
            radius: student_exceeded_with(MISS, freedom) * error,
        };
        let verdict = if interval.radius > 0.5 {
            Verdict::Unknown
        } else {
            Verdict::Falls
        };
        (interval, verdict)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bench::Judgement;

    /// Approximately normal numbers.
    fn normals(seed: u32) -> impl Iterator<Item = f64> {
        let mut state = seed.wrapping_mul(0x9e37_79b9);
        let mut uniform = move || {
            state = state.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
            let word = (state >> ((state >> 28) + 4) ^ state).wrapping_mul(277_803_737);
            f64::from(word >> 22 ^ word) / 4_294_967_296.0
        };
        std::iter::repeat_with(move || (0..12).map(|_| uniform()).sum::<f64>() - 6.0)
    }

    /// Six budgets of three runs: relMSE 0.02 / seconds with noise, and a bias.
    fn method(seed: u32, bias: f64, noise: f64) -> Method {
        let mut normal = normals(seed);
        let runs = (0..18).map(|i| {
            let budget = i % 6;
            let seconds = 0.1 * f64::from(1 << budget);
            let factor = 1.0 + noise * normal.next().unwrap_or(0.0);
            let relative = 0.02 / seconds * factor + bias * bias;
            Run {
                budget,
                seed: 0,
                samples: 4 << budget,
                seconds,
                judgement: Judgement {
                    mse: relative,
                    relative,
                    median: 0.5 * relative,
                },
            }
        });
        Method {
            name: "path".into(),
            runs: runs.collect(),
        }
    }

    #[test]
    fn exact_runs_have_the_slope_and_the_efficiency_they_were_made_with() {
        let found = method(1, 0.0, 0.0).summary().expect("runs");
        assert!((found.slope.value + 1.0).abs() < 1e-9);
        assert!((found.efficiency.value - 0.02).abs() < 1e-12);
        assert!((found.median.value - 0.01).abs() < 1e-12);
        assert!(found.efficiency.radius < 1e-12);
        assert_eq!(found.verdict, Verdict::Falls);
        assert!((found.pace - 0.025).abs() < 1e-12);
    }

    #[test]
    fn intervals_cover_and_verdicts_stay_calm_without_bias() {
        let (mut slopes, mut efficiencies, mut floors) = (0, 0, 0);
        for seed in 0..1000 {
            let found = method(seed, 0.0, 0.1).summary().expect("runs");
            slopes += u32::from((found.slope.value + 1.0).abs() <= found.slope.radius);
            let error = (found.efficiency.value - 0.02).abs();
            efficiencies += u32::from(error <= found.efficiency.radius);
            floors += u32::from(found.verdict == Verdict::Floor);
        }
        // 950 ± 34 are five deviations of the binomial law; the quantile of 4 degrees is 2 % long.
        assert!((910..=990).contains(&slopes), "{slopes}");
        assert!((910..=990).contains(&efficiencies), "{efficiencies}");
        assert!(floors <= 8, "{floors}");
    }

    #[test]
    fn a_bias_is_a_floor() {
        // A bias of half the noise of the longest run, root mean square, and three per cent of it.
        let sees = |bias: f64| {
            (0..100)
                .filter(|&seed| {
                    let found = method(seed, bias, 0.05).summary().expect("runs");
                    found.verdict == Verdict::Floor
                })
                .count()
        };
        let noise = f64::sqrt(0.02 / 3.2);
        assert!(sees(0.5 * noise) > 90, "{}", sees(0.5 * noise));
        assert!(sees(0.03 * noise) < 5);
    }

    #[test]
    fn too_little_is_unknown() {
        let mut few = method(1, 0.0, 0.0);
        few.runs.retain(|run| run.budget < 2);
        let found = few.summary().expect("runs");
        assert_eq!(found.verdict, Verdict::Unknown);
        few.runs.clear();
        assert_eq!(few.summary(), None);
    }
}
