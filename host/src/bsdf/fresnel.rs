//! How much light a smooth boundary reflects.
//!
//! ```text
//! r_s = (cos θ − η cos θt) / (cos θ + η cos θt)      cos θt = √(1 − sin²θ / η²)
//! r_p = (η cos θ − cos θt) / (η cos θ + cos θt)      F = (|r_s|² + |r_p|²) / 2
//! ```
//!
//! η is the index of where light goes over that of where it comes from, complex for metals. Light is unpolarised.
//! Source: [Born, Wolf 1999], sections 1.5 and 14.2.

/// The part of light that a dielectric reflects, in [0, 1].
///
/// * `cosine`: of the angle to the normal, in [0, 1].
/// * `eta`: index where light goes over that where it comes from, positive.
pub fn dielectric(cosine: f64, eta: f64) -> f64 {
    // At a grazing angle all is reflected, also where the quotients below are 0 / 0.
    let (Some(refracted), true) = (refracted_cosine(cosine, eta), cosine > 0.0) else {
        return 1.0;
    };
    let s = (cosine - eta * refracted) / (cosine + eta * refracted);
    let p = (eta * cosine - refracted) / (eta * cosine + refracted);
    0.5 * (s * s + p * p)
}

/// The part of light that a metal reflects, in [0, 1].
///
/// * `cosine`: of the angle to the normal, in [0, 1].
/// * `eta`, `k`: the complex index η + i k of the metal over that in front of it; neither negative.
pub fn conductor(cosine: f64, eta: f64, k: f64) -> f64 {
    // (a + i b)² = (η + i k)² − sin²θ, which is (η cos θt)².
    let cos2 = (cosine * cosine).min(1.0);
    let sin2 = 1.0 - cos2;
    let real = eta * eta - k * k - sin2;
    let imaginary = 2.0 * eta * k;
    let square = (real * real + imaginary * imaginary).sqrt(); // a² + b²
    let a = (0.5 * (square + real)).max(0.0).sqrt();
    let s = quotient(square + cos2, 2.0 * a * cosine);
    let p = s * quotient(cos2 * square + sin2 * sin2, 2.0 * a * cosine * sin2);
    0.5 * (s + p)
}

/// (x − y) / (x + y) for 0 ≤ y ≤ x, and one where both vanish.
fn quotient(x: f64, y: f64) -> f64 {
    if x > 0.0 {
        (x - y).max(0.0) / (x + y)
    } else {
        1.0
    }
}

/// Cosine of the refracted direction, by Snell's law; `None` where all is reflected.
pub fn refracted_cosine(cosine: f64, eta: f64) -> Option<f64> {
    let sin2 = (1.0 - cosine * cosine).max(0.0) / (eta * eta);
    (sin2 < 1.0).then(|| (1.0 - sin2).sqrt())
}

/// The part of light that a pane of two parallel faces reflects, all reflections between them included:
///
/// ```text
/// R + T R T + T R³ T + … = R + T² R / (1 − R²) = 2 R / (1 + R)      T = 1 − R
/// ```
///
/// * `eta`: index of the pane over that around it.
pub fn pane(cosine: f64, eta: f64) -> f64 {
    let r = dielectric(cosine, eta);
    2.0 * r / (1.0 + r)
}
