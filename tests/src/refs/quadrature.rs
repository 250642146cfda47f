//! Gauss–Legendre quadrature for verifying the tables, by means that share nothing with how they were made.
//!
//! Nodes are the roots of the Legendre polynomial, by Newton from cosines; order 20 is exact to degree 39.

use std::sync::LazyLock;

const ORDER: usize = 20;

/// Nodes on [−1, 1] and their weights.
static RULE: LazyLock<[(f64, f64); ORDER]> = LazyLock::new(|| {
    std::array::from_fn(|i| {
        let n = ORDER as f64;
        let mut x = (std::f64::consts::PI * (i as f64 + 0.75) / (n + 0.5)).cos();
        let mut slope = 1.0;
        for _ in 0..50 {
            let (mut p, mut before) = (x, 1.0);
            for k in 2..=ORDER {
                let k = k as f64;
                (p, before) = (((2.0 * k - 1.0) * x * p - (k - 1.0) * before) / k, p);
            }
            slope = n * (x * p - before) / (x * x - 1.0);
            x -= p / slope;
        }
        (x, 2.0 / ((1.0 - x * x) * slope * slope))
    })
});

/// ∫ f over [a, b], in `panels` equal panels.
pub fn integrate(a: f64, b: f64, panels: usize, mut f: impl FnMut(f64) -> f64) -> f64 {
    let half = 0.5 * (b - a) / panels as f64;
    let mut sum = 0.0;
    for panel in 0..panels {
        let middle = a + half * (2 * panel + 1) as f64;
        for (x, weight) in *RULE {
            sum += weight * f(middle + half * x);
        }
    }
    sum * half
}

/// Asserts a tabulated number.
///
/// # Panics
/// Unless `got` equals `expected` to `tolerance`, relative where `expected` exceeds 1.
#[track_caller]
pub fn close(name: &str, got: f64, expected: f64, tolerance: f64) {
    assert!(
        (got - expected).abs() <= tolerance * expected.abs().max(1.0),
        "{name}: {got:.15e} for {expected:.15e}"
    );
}

#[test]
fn polynomials_and_an_exponential_are_exact() {
    close(
        "x^38",
        integrate(-1.0, 1.0, 1, |x| x.powi(38)),
        2.0 / 39.0,
        1e-14,
    );
    close(
        "e^x",
        integrate(0.0, 3.0, 2, f64::exp),
        3.0_f64.exp_m1(),
        1e-14,
    );
}
