//! The direction of a triangle's normal, right to the last digits even for slivers.

use glam::DVec3;

/// A value and what rounding took from it.
type Pair = (f64, f64);

/// a + b without loss [Knuth 1997, section 4.2.2].
fn sum(a: f64, b: f64) -> Pair {
    let s = a + b;
    let t = s - a;
    (s, (a - (s - t)) + (b - t))
}

/// a · b without loss [Dekker 1971].
fn product(a: f64, b: f64) -> Pair {
    let split = |x: f64| {
        let t = 134_217_729.0 * x;
        let high = t - (t - x);
        (high, x - high)
    };
    let p = a * b;
    let ((a1, a2), (b1, b2)) = (split(a), split(b));
    (p, a2 * b2 - (((p - a1 * b1) - a2 * b1) - a1 * b2))
}

/// a d − b c.
fn determinant(a: Pair, b: Pair, c: Pair, d: Pair) -> f64 {
    let (p, p_rest) = product(a.0, d.0);
    let (q, q_rest) = product(b.0, c.0);
    let (s, s_rest) = sum(p, -q);
    let rest = (a.0 * d.1 + a.1 * d.0) - (b.0 * c.1 + b.1 * c.0);
    s + (s_rest + ((p_rest - q_rest) + rest))
}

/// cross(b − a, c − a), where nothing cancels: zero only for corners on one line.
pub(super) fn normal([a, b, c]: &[DVec3; 3]) -> DVec3 {
    let edge = |p: DVec3| [0, 1, 2].map(|i| sum(p[i], -a[i]));
    let (e, f) = (edge(*b), edge(*c));
    DVec3::new(
        determinant(e[1], e[2], f[1], f[2]),
        determinant(e[2], e[0], f[2], f[0]),
        determinant(e[0], e[1], f[0], f[1]),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slivers_have_the_normal_of_their_plane() {
        // Corners with integer coordinates: a cap of height 1 over a base of 2²⁶, far from the origin, whose exact
        // normal fits into 128 bits.
        let far = 1_i64 << 40;
        let corners = [
            [far, -far, far],
            [far + (1 << 26), -far + (1 << 25), far + (1 << 24)],
            [far + (1 << 25) + 1, -far + (1 << 24), far + (1 << 23)],
        ];
        let edge = |i: usize| {
            std::array::from_fn::<i128, 3, _>(|k| i128::from(corners[i][k] - corners[0][k]))
        };
        let (e, f) = (edge(1), edge(2));
        let exact = [
            e[1] * f[2] - e[2] * f[1],
            e[2] * f[0] - e[0] * f[2],
            e[0] * f[1] - e[1] * f[0],
        ]
        .map(|x| x as f64);
        let computed = normal(&corners.map(|c| DVec3::from_array(c.map(|x| x as f64))));
        assert_eq!(computed.to_array(), exact);
        // A third of a line is on it, as nearly as a double can say: no direction is left out.
        let on_line = [
            DVec3::ZERO,
            DVec3::new(3.0, 6.0, 9.0),
            DVec3::new(1.0, 2.0, 3.0),
        ];
        assert_eq!(normal(&on_line), DVec3::ZERO);
    }

    #[test]
    fn a_determinant_keeps_what_a_plain_one_loses() {
        let e = 2.0_f64.powi(-30);
        let (a, d) = ((1.0 + e, 0.0), (1.0 - e, 0.0));
        let one = (1.0, 0.0);
        assert_eq!(determinant(a, one, one, d), -e * e);
        assert_eq!((1.0 + e) * (1.0 - e) - 1.0, 0.0);
    }
}
