//! Do these counts follow these expectations?
//!
//! ```text
//! χ² = Σ (observedᵢ − expectedᵢ)² / expectedᵢ,   p = Q(k/2, χ²/2),   k = cells − 1
//! ```
//!
//! with Q the regularised upper incomplete gamma function. Neighbouring cells are pooled until each expects at
//! least five, where the law of χ² is a good approximation. *Blind to:* anything inside one cell, and to any shape
//! whose effect size √(Σ δᵢ²/eᵢ / n) lies below what [`ChiSquare::verdict`] is asked to resolve.
//! Source: [Pearson 1900]; pooling after [Cochran 1952].

use super::{ALPHA, Verdict, Z_CRITICAL, deviate_of_scaled_chi_square};
use statrs::function::gamma::checked_gamma_ur;

/// Fewest counts a cell must expect.
const POOL_BELOW: f64 = 5.0;

/// Distance of a histogram from its expectation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ChiSquare {
    statistic: f64,
    cells: usize,
    total: f64,
}

impl ChiSquare {
    /// Compares counts with the probabilities of their cells, which sum to 1; cells are pooled with neighbours.
    ///
    /// A cell of probability 0 that was hit anyway makes the statistic infinite.
    ///
    /// # Panics
    /// When the slices differ in length, a probability is negative or NaN, or the sum is off 1 by more than 10⁻⁶:
    /// these are mistakes of the test, not of what it tests.
    pub fn new(observed: &[u64], probabilities: &[f64]) -> Self {
        assert_eq!(
            observed.len(),
            probabilities.len(),
            "one probability per cell"
        );
        let sum: f64 = probabilities.iter().sum();
        assert!(
            probabilities.iter().all(|&p| p >= 0.0) && (sum - 1.0).abs() <= 1e-6,
            "probabilities of all cells are at least 0 and sum to 1, not {sum}"
        );
        let total = observed.iter().sum::<u64>() as f64;
        let impossible = observed
            .iter()
            .zip(probabilities)
            .any(|(&count, &p)| p == 0.0 && count > 0);

        // Greedy pools from the left; what is left over at the end joins the last pool.
        let mut pools: Vec<(f64, f64)> = Vec::new();
        let (mut count, mut expected) = (0.0, 0.0);
        for (&o, &p) in observed.iter().zip(probabilities) {
            count += o as f64;
            expected += p / sum * total;
            if expected >= POOL_BELOW {
                pools.push((count, expected));
                (count, expected) = (0.0, 0.0);
            }
        }
        if let Some(last) = pools.last_mut() {
            last.0 += count;
            last.1 += expected;
        }
        let statistic = if impossible {
            f64::INFINITY
        } else {
            pools.iter().map(|(o, e)| (o - e) * (o - e) / e).sum()
        };
        Self {
            statistic,
            cells: pools.len(),
            total,
        }
    }

    /// χ².
    pub const fn statistic(&self) -> f64 {
        self.statistic
    }

    /// Cells left after pooling.
    pub const fn cells(&self) -> usize {
        self.cells
    }

    /// Degrees of freedom, cells − 1.
    pub fn dof(&self) -> f64 {
        self.cells as f64 - 1.0
    }

    /// Probability of so large a χ² under the hypothesis; NaN below two cells.
    pub fn p_value(&self) -> f64 {
        if self.cells < 2 {
            return f64::NAN;
        }
        if self.statistic == 0.0 {
            return 1.0;
        }
        if self.statistic == f64::INFINITY {
            return 0.0;
        }
        checked_gamma_ur(0.5 * self.dof(), 0.5 * self.statistic).unwrap_or(f64::NAN)
    }

    /// Agrees for p ≥ α = 10⁻⁶; `Blind` where an effect size of `resolution` could not have been rejected.
    ///
    /// The effect size of a density off by a relative ε everywhere is |ε|. Reported z: cube-root deviate.
    pub fn verdict(&self, resolution: f64) -> Verdict {
        let p = self.p_value();
        if self.statistic == f64::INFINITY {
            return Verdict::Biased { z: f64::INFINITY };
        }
        // Smallest χ² that is rejected, from the same cube root, less what chance alone gives.
        let dof = self.dof();
        let w = 2.0 / (9.0 * dof);
        let critical = dof * (1.0 - w + Z_CRITICAL * w.sqrt()).powi(3);
        let smallest_effect = ((critical - dof) / self.total).sqrt();
        let sees = self.cells >= 2 && smallest_effect <= resolution;
        if !sees || p.is_nan() {
            Verdict::Blind {
                resolution: smallest_effect,
            }
        } else if p >= ALPHA {
            Verdict::Agrees
        } else {
            Verdict::Biased {
                z: deviate_of_scaled_chi_square(self.statistic / dof, dof),
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stats::{KolmogorovSmirnov, independent::SplitMix};

    fn histogram(
        seed: u64,
        n: usize,
        cells: usize,
        draw: impl Fn(&mut SplitMix) -> f64,
    ) -> Vec<u64> {
        let mut rng = SplitMix::new(seed);
        let mut counts = vec![0; cells];
        for _ in 0..n {
            let cell = (draw(&mut rng) * cells as f64) as usize;
            counts[cell.min(cells - 1)] += 1;
        }
        counts
    }

    #[test]
    fn a_die_by_hand() {
        let die = ChiSquare::new(&[5, 8, 9, 8, 10, 20], &[1.0 / 6.0; 6]);
        assert!((die.statistic() - 13.4).abs() < 1e-12);
        assert_eq!(die.dof(), 5.0);
        // Critical values of tables: 11.0705 at 5 %, 15.0863 at 1 %.
        assert!((0.01..0.05).contains(&die.p_value()));
        let p = checked_gamma_ur(2.5, 0.5 * 11.070_498).expect("a valid argument");
        assert!((p - 0.05).abs() < 1e-7);
    }

    #[test]
    fn p_values_are_uniform_under_the_hypothesis() {
        let mut p_values: Vec<f64> = (0..2000)
            .map(|run| {
                let counts = histogram(70_000 + run, 5000, 20, SplitMix::uniform);
                ChiSquare::new(&counts, &[0.05; 20]).p_value()
            })
            .collect();
        let alarms = p_values.iter().filter(|&&p| p < 0.05).count();
        assert!((52..=148).contains(&alarms), "{alarms} of 2000 at 5 %");
        let ks = KolmogorovSmirnov::new(&mut p_values, |p| p);
        assert_eq!(ks.verdict(0.1), Verdict::Agrees, "{ks:?}");
    }

    #[test]
    fn poor_cells_are_pooled() {
        // Geometric cells expect 500, 250, …, 7.8, 3.9, …: the eighth pool takes the ninth, the tail joins it.
        let probabilities: Vec<f64> = (1..=20).map(|i| 0.5_f64.powi(i.min(19))).collect();
        let mut rng = SplitMix::new(51);
        let mut counts = vec![0_u64; 20];
        for _ in 0..1000 {
            let cell = -rng.uniform().log2();
            counts[(cell as usize).min(19)] += 1;
        }
        let chi = ChiSquare::new(&counts, &probabilities);
        assert_eq!(chi.cells(), 8);
        assert!(chi.p_value() > 1e-3, "{chi:?}");
    }

    #[test]
    fn a_planted_ripple_is_rejected() {
        let n = 1 << 18;
        let ripple = |r: &mut SplitMix| {
            // Density 1 + 0.05 sin(2πx·5), by rejection.
            loop {
                let x = r.uniform();
                let density = 1.0 + 0.05 * (std::f64::consts::TAU * 5.0 * x).sin();
                if 1.05 * r.uniform() < density {
                    return x;
                }
            }
        };
        let flat = ChiSquare::new(&histogram(52, n, 50, SplitMix::uniform), &[0.02; 50]);
        assert_eq!(flat.verdict(0.03), Verdict::Agrees, "{flat:?}");
        let chi = ChiSquare::new(&histogram(53, n, 50, ripple), &[0.02; 50]);
        assert!(
            matches!(chi.verdict(0.03), Verdict::Biased { z } if z > 10.0),
            "{chi:?}"
        );
    }

    #[test]
    fn few_counts_or_one_cell_are_blind_and_the_impossible_is_not() {
        let blind = |chi: ChiSquare| matches!(chi.verdict(0.03), Verdict::Blind { .. });
        assert!(blind(ChiSquare::new(
            &histogram(54, 1000, 20, SplitMix::uniform),
            &[0.05; 20]
        )));
        assert!(blind(ChiSquare::new(&[1_000_000], &[1.0])));
        assert!(blind(ChiSquare::new(&[0, 0], &[0.5, 0.5])));
        let hit_nothing = ChiSquare::new(&[500_000, 500_000, 1], &[0.5, 0.5, 0.0]);
        assert!(matches!(hit_nothing.verdict(0.03), Verdict::Biased { .. }));
    }
}
