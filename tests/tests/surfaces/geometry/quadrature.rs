//! Means over the unit square.

/// Abscissas and weights of Gauss and Legendre with three points on [0, 1].
const GAUSS: [(f64, f64); 3] = [
    (0.112_701_665_379_258_3, 5.0 / 18.0),
    (0.5, 8.0 / 18.0),
    (0.887_298_334_620_741_7, 5.0 / 18.0),
];

/// ∫∫ f over [0, 1]², on n × n panels.
pub(super) fn mean(n: u32, mut f: impl FnMut([f64; 2]) -> f64) -> f64 {
    let step = 1.0 / f64::from(n);
    let mut sum = 0.0;
    for i in 0..n {
        for j in 0..n {
            for (x, weight_x) in GAUSS {
                for (y, weight_y) in GAUSS {
                    let u = [(f64::from(i) + x) * step, (f64::from(j) + y) * step];
                    sum += weight_x * weight_y * f(u);
                }
            }
        }
    }
    sum * step * step
}

#[test]
fn polynomials_are_exact() {
    let found = mean(2, |[x, y]| x.powi(5) * y.powi(4));
    assert!((found - 1.0 / 30.0).abs() < 1e-15);
}
