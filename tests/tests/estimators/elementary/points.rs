//! Exact values, order and tails of the elementary functions, which a bound in ulps does not tell.

use super::ulp;
use woodcock_core::real::Real;

#[test]
fn exact_points_are_exact() {
    assert_eq!(1.0_f32.ln(), 0.0);
    assert_eq!(Real::ln(1.0_f32), 0.0);
    assert_eq!(Real::exp(0.0_f32), 1.0);
    assert_eq!(Real::exp(-0.0_f32), 1.0);
    assert_eq!(Real::neg_ln_1m(0.0_f32), 0.0);
    assert_eq!(Real::ln_1p(0.0_f32), 0.0);
    assert_eq!(Real::exp_m1(0.0_f32), 0.0);
    assert_eq!(Real::exp(-1e30_f32), 0.0);
    assert_eq!(Real::exp(f32::NEG_INFINITY), 0.0);
    assert_eq!(Real::exp(f32::INFINITY), f32::INFINITY);
    assert_eq!(Real::exp(89.0_f32), f32::INFINITY);
    assert_eq!(Real::exp_m1(89.0_f32), f32::INFINITY);
    assert_eq!(Real::exp_m1(f32::INFINITY), f32::INFINITY);
    for x in [-17.4, -26.0, -1e30, f32::NEG_INFINITY] {
        assert_eq!(Real::exp_m1(x), -1.0, "at {x}");
    }
    // The least numbers are their own images, of either sign.
    for bits in 1..10_000 {
        for x in [f32::from_bits(bits), -f32::from_bits(bits)] {
            assert_eq!(Real::ln_1p(x), x);
            assert_eq!(Real::exp_m1(x), x);
        }
    }
    assert!(
        Real::ln(0.0_f32) < -80.0,
        "zero gives a large negative number"
    );
    assert!(
        Real::ln_1p(-1.0_f32) < -80.0,
        "minus one gives a large negative number"
    );
    for quarter in -16_384_i32..=16_384 {
        let (s, c) = (quarter as f32 * 0.25).sin_cos_turn();
        let expected = [(0.0, 1.0), (1.0, 0.0), (0.0, -1.0), (-1.0, 0.0)];
        assert_eq!(
            (s, c),
            expected[quarter.rem_euclid(4) as usize],
            "{quarter} quarters"
        );
    }
    // Powers of two are logarithms without a fraction: k ln 2, correctly rounded.
    for k in -149..128 {
        let exact = f64::from(k) * std::f64::consts::LN_2;
        let ulps = (f64::from(Real::ln(2.0_f64.powi(k) as f32)) - exact).abs() / ulp(exact);
        assert!(k == 0 || ulps <= 0.6, "ln 2^{k} is off by {ulps} ulp");
    }
}

/// A larger uniform number never means a shorter flight, over all that `uniform` can draw.
#[test]
fn flights_grow_with_their_uniform_number() {
    let mut before = 0.0_f32;
    for k in 0..1_u32 << 24 {
        let flight = Real::neg_ln_1m(k as f32 / 16_777_216.0);
        assert!(flight >= before, "at {k}: {flight:e} after {before:e}");
        before = flight;
    }
}

/// Between the bounds of the domain and the infinities, values stay ordered and finite numbers appear.
#[test]
fn tails_of_the_exponential_are_ordered() {
    let mut before = f32::INFINITY;
    let mut x = 87.0_f32;
    while x < 110.0 {
        let y = Real::exp(-x);
        assert!(
            y <= before && y >= 0.0,
            "exp(-{x}) = {y:e} after {before:e}"
        );
        let exact = f64::from(-x).exp();
        assert!(
            (f64::from(y) - exact).abs() <= 2.0 * ulp(exact),
            "exp(-{x}) = {y:e} for {exact:e}"
        );
        before = y;
        x += 1.0 / 1024.0;
    }
    assert_eq!(before, 0.0);
}

/// One function may take the other's place: e^ln(1 + x) − 1 = x, and ln(1 − u) from either side.
#[test]
fn functions_are_inverses() {
    for i in 1..200_000 {
        let u = i as f32 / 200_000.0;
        let flight = Real::neg_ln_1m(u);
        // Same reduction, same rounding: no bit between them.
        assert_eq!(Real::ln_1p(-u), -flight, "at {u}");
        let back = -Real::exp_m1(-flight);
        // The last place of a long flight moves u by flight · (1 − u) of its own.
        let allowed = 2.0 * f32::EPSILON * (u + flight * (1.0 - u));
        assert!((back - u).abs() <= allowed, "{u} became {back}");
    }
}

/// The oracle's functions are those of libm: within two units of its own last place.
#[test]
fn the_oracle_agrees_with_the_platform() {
    let close = |a: f64, b: f64| (a - b).abs() <= 2.0 * f64::EPSILON * b.abs();
    for i in 1..10_000 {
        let u = f64::from(i) / 10_000.0;
        for x in [u, -u, 1e-9 * u, -1e-9 * u, 50.0 * u] {
            assert!(close(Real::exp_m1(x), f64::exp_m1(x)), "exp_m1 at {x}");
            assert!(close(Real::exp(x), f64::exp(x)), "exp at {x}");
            assert!(close(Real::ln_1p(x), f64::ln_1p(x)), "ln_1p at {x}");
        }
        assert!(close(Real::ln(u), f64::ln(u)), "ln at {u}");
        assert!(
            close(Real::neg_ln_1m(u), -f64::ln_1p(-u)),
            "neg_ln_1m at {u}"
        );
    }
}
