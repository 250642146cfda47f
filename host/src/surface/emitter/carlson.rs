//! Carlson's symmetric elliptic integrals, and the singular values that an ellipsoid's area takes.

use glam::DVec3;

/// Squared singular values of a matrix by its columns: Jacobi's rotations of columns against each other
/// [Hestenes 1958].
pub(super) fn squared_singular_values(mut columns: [DVec3; 3]) -> [f64; 3] {
    // Convergence is quadratic; far fewer sweeps are ever needed.
    for _ in 0..16 {
        for (i, j) in [(0, 1), (0, 2), (1, 2)] {
            let (p, q) = (columns[i], columns[j]);
            let inner = p.dot(q);
            if inner == 0.0 {
                continue;
            }
            let zeta = (q.length_squared() - p.length_squared()) / (2.0 * inner);
            let tangent = 1.0_f64.copysign(zeta) / (zeta.abs() + (1.0 + zeta * zeta).sqrt());
            let cos = 1.0 / (1.0 + tangent * tangent).sqrt();
            let sin = cos * tangent;
            columns[i] = p * cos - q * sin;
            columns[j] = p * sin + q * cos;
        }
    }
    columns.map(DVec3::length_squared)
}

/// R_F and R_D of positive numbers by duplication [Carlson 1995].
fn r_f_and_d(mut x: f64, mut y: f64, mut z: f64) -> (f64, f64) {
    let (mut sum, mut quarter) = (0.0, 1.0);
    // Each step brings the three nearer by a factor of four.
    for _ in 0..64 {
        let mean = (x + y + 3.0 * z) / 5.0;
        let spread = (x - mean).abs().max((y - mean).abs()).max((z - mean).abs());
        if spread <= 1e-3 * mean {
            break;
        }
        let (a, b, c) = (x.sqrt(), y.sqrt(), z.sqrt());
        let lambda = a * b + b * c + c * a;
        sum += 3.0 * quarter / (c * (z + lambda));
        quarter *= 0.25;
        x = 0.25 * (x + lambda);
        y = 0.25 * (y + lambda);
        z = 0.25 * (z + lambda);
    }
    let mean = (x + y + z) / 3.0;
    let (u, v) = (1.0 - x / mean, 1.0 - y / mean);
    let w = -u - v;
    let (e2, e3) = (u * v - w * w, u * v * w);
    let first = (1.0 - e2 / 10.0 + e3 / 14.0 + e2 * e2 / 24.0
        - 3.0 * e2 * e3 / 44.0
        - 5.0 * e2 * e2 * e2 / 208.0)
        / mean.sqrt();
    let mean = (x + y + 3.0 * z) / 5.0;
    let (u, v) = (1.0 - x / mean, 1.0 - y / mean);
    let w = -(u + v) / 3.0;
    let (e2, e3) = (u * v - 6.0 * w * w, (3.0 * u * v - 8.0 * w * w) * w);
    let (e4, e5) = (3.0 * (u * v - w * w) * w * w, u * v * w * w * w);
    let series = 1.0 - 3.0 * e2 / 14.0 + e3 / 6.0 + 9.0 * e2 * e2 / 88.0
        - 3.0 * e4 / 22.0
        - 9.0 * e2 * e3 / 52.0
        + 3.0 * e5 / 26.0
        - e2 * e2 * e2 / 16.0
        + 3.0 * e3 * e3 / 40.0
        + 3.0 * e2 * e4 / 20.0;
    (first, sum + quarter * series / (mean * mean.sqrt()))
}

/// R_G(x, y, z) of positive numbers: 2 R_G = z R_F − (x − z)(y − z) R_D / 3 + √(xy/z), z the middle one, so that no
/// term is negative [Carlson 1995].
pub(super) fn r_g(x: f64, y: f64, z: f64) -> f64 {
    let mut sorted = [x, y, z];
    sorted.sort_by(f64::total_cmp);
    let [x, z, y] = sorted;
    let (f, d) = r_f_and_d(x, y, z);
    0.5 * (z * f - (x - z) * (y - z) * d / 3.0 + (x * y / z).sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn close(a: f64, b: f64, relative: f64) {
        assert!((a - b).abs() <= relative * b.abs(), "{a} {b}");
    }

    #[test]
    fn integrals_have_their_published_values() {
        // [Carlson 1995], section 3: R_F(1, 2, 0) has a zero; those of positive arguments follow.
        let (f, _) = r_f_and_d(2.0, 3.0, 4.0);
        close(f, 0.584_082_841_677_152_1, 1e-14);
        let (_, d) = r_f_and_d(2.0, 3.0, 4.0);
        close(d, 0.165_105_272_942_613_5, 1e-13);
        close(r_g(2.0, 3.0, 4.0), 1.725_503_028_069_227_2, 1e-13);
        close(r_g(1.0, 1.0, 1.0), 1.0, 1e-15);
    }

    #[test]
    fn spheroids_have_their_closed_forms() {
        use std::f64::consts::PI;
        for (a, c) in [
            (1.0_f64, 0.2_f64),
            (1.0, 5.0),
            (3.0, 2.9),
            (1e-3, 2.0),
            (2.0, 1e-3),
        ] {
            let area = 4.0 * PI * r_g(a.powi(4), a * a * c * c, a * a * c * c);
            let expected = if c < a {
                let e = (1.0 - (c / a).powi(2)).sqrt();
                2.0 * PI * a * a * (1.0 + (1.0 - e * e) / e * e.atanh())
            } else {
                let e = (1.0 - (a / c).powi(2)).sqrt();
                2.0 * PI * a * a * (1.0 + c / (a * e) * e.asin())
            };
            close(area, expected, 1e-12);
        }
    }

    #[test]
    fn singular_values_survive_rotation_and_shear() {
        let [x, y, z] = squared_singular_values([
            DVec3::new(3.0, 4.0, 0.0),
            DVec3::new(-8.0, 6.0, 0.0),
            DVec3::new(0.0, 0.0, 0.5),
        ]);
        let mut found = [x, y, z];
        found.sort_by(f64::total_cmp);
        assert_eq!(found, [0.25, 25.0, 100.0]);
        // Sum and product of the squares are the Frobenius norm and the determinant.
        let sheared = [
            DVec3::new(1.0, 0.2, -0.4),
            DVec3::new(0.9, 2.0, 0.3),
            DVec3::new(-1.0, 0.1, 1e-3),
        ];
        let [x, y, z] = squared_singular_values(sheared);
        close(
            x + y + z,
            sheared.iter().map(|c| c.length_squared()).sum(),
            1e-14,
        );
        let determinant = sheared[0].cross(sheared[1]).dot(sheared[2]);
        close(x * y * z, determinant * determinant, 1e-13);
    }
}
