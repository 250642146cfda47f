//! Between p-values and normal deviates, far into the tails.
//!
//! All verdicts speak of z, so that "ten standard errors" means the same for a mean, a histogram and a distance
//! between distributions. p-values underflow beyond z = 38; their logarithms do not.

use statrs::function::erf::erfc;
use std::f64::consts::{PI, SQRT_2};

/// Logarithm of the two-sided tail probability of a standard normal, ln P(|Z| > z), for z ≥ 0.
///
/// Relative error of the probability below 10⁻⁹: the error function up to z = 20, beyond it the asymptotic series.
pub fn ln_p_of_deviate(z: f64) -> f64 {
    if z < 20.0 {
        return erfc(z / SQRT_2).ln();
    }
    // erfc(x) ~ e^{−x²}/(x√π) · (1 − 1/(2x²) + 3/(4x⁴) − 15/(8x⁶) + …), and 2x² = z².
    let w = 1.0 / (z * z);
    let series = 1.0 - w * (1.0 - w * (3.0 - w * (15.0 - w * (105.0 - w * 945.0))));
    -0.5 * z * z - (z * (0.5 * PI).sqrt()).ln() + series.ln()
}

/// The z ≥ 0 with P(|Z| > z) = p, given ln p; 0 for p ≥ 1, NaN for NaN.
pub fn deviate_of_ln_p(ln_p: f64) -> f64 {
    if ln_p.is_nan() {
        return f64::NAN;
    }
    if ln_p >= 0.0 {
        return 0.0;
    }
    if ln_p == f64::NEG_INFINITY {
        return f64::INFINITY;
    }
    // P(|Z| > z) ≤ e^{−z²/2}, so the root lies below √(−2 ln p); the function falls, hence bisection.
    let (mut low, mut high) = (0.0, (-2.0 * ln_p).sqrt());
    for _ in 0..80 {
        let middle = 0.5 * (low + high);
        if ln_p_of_deviate(middle) > ln_p {
            low = middle;
        } else {
            high = middle;
        }
    }
    0.5 * (low + high)
}

/// Signed normal deviate of a chi-square variate divided by its degrees of freedom, by its cube root.
///
/// * `ratio`: χ²/k, at least 0. `dof`: k, positive; need not be whole.
///
/// Good to a tenth of a deviate for k ≥ 10 and |z| ≤ 5, smaller than the truth far in the upper tail.
/// Source: [Wilson, Hilferty 1931].
pub fn deviate_of_scaled_chi_square(ratio: f64, dof: f64) -> f64 {
    let w = 2.0 / (9.0 * dof);
    (ratio.cbrt() - (1.0 - w)) / w.sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stats::{ALPHA, KS_CRITICAL, Z_CRITICAL};
    use statrs::function::gamma::gamma_ur;

    #[test]
    fn the_written_thresholds_follow_from_alpha() {
        assert!((deviate_of_ln_p(ALPHA.ln()) - Z_CRITICAL).abs() < 5e-4);
        // Rounded up, to stay on the side of the bound.
        let exact = (0.5 * (2.0 / ALPHA).ln()).sqrt();
        assert!((0.0..1e-3).contains(&(KS_CRITICAL - exact)), "{exact}");
    }

    #[test]
    fn tail_and_deviate_are_inverse() {
        for z in [
            0.01, 0.5, 1.0, 1.96, 4.892, 19.99, 20.01, 10.0, 37.0, 138.0, 4e3,
        ] {
            let back = deviate_of_ln_p(ln_p_of_deviate(z));
            assert!(
                (back - z).abs() < 1e-9 * z.max(1.0),
                "{z} came back as {back}"
            );
        }
        assert!((ln_p_of_deviate(1.959_963_985).exp() - 0.05).abs() < 1e-9);
        // The two branches meet.
        let step = ln_p_of_deviate(20.0 - 1e-10) - ln_p_of_deviate(20.0);
        assert!(step.abs() < 4e-9, "{step}");
    }

    #[test]
    fn extremes_and_nan_are_total() {
        assert_eq!(deviate_of_ln_p(0.0), 0.0);
        assert_eq!(deviate_of_ln_p(f64::NEG_INFINITY), f64::INFINITY);
        assert!(deviate_of_ln_p(f64::NAN).is_nan());
        assert!(deviate_of_scaled_chi_square(f64::NAN, 10.0).is_nan());
    }

    #[test]
    fn the_cube_root_follows_the_gamma_function() {
        for dof in [10.0, 30.0, 255.0, 4095.0] {
            for z in [-3.0, -1.0, 0.0, 2.0, 4.75] {
                // The ratio whose approximate deviate is z, sent through the exact tail.
                let w = 2.0 / (9.0 * dof);
                let ratio: f64 = (1.0 - w + z * f64::sqrt(w)).powi(3);
                let upper = gamma_ur(0.5 * dof, 0.5 * dof * ratio);
                let expected = 0.5 * erfc(z / SQRT_2);
                let exact_z = if z > 0.0 {
                    deviate_of_ln_p((2.0 * upper).ln())
                } else {
                    -deviate_of_ln_p((2.0 * (1.0 - upper)).ln())
                };
                assert!(
                    (exact_z - z).abs() < 0.1,
                    "dof {dof}, z {z}: {exact_z} ({upper} for {expected})"
                );
            }
        }
    }
}
