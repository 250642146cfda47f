//! The elementary functions of core against `f64`: bounds in units in the last place, and lanes bit by bit.
//!
//! By default every 257th float of each domain, and all floats around the seams of the range reductions.
//! `WOODCOCK_EXHAUSTIVE=1` takes every float; that is a matter of minutes.

use std::f64::consts::TAU;
use woodcock_core::real::Real;
use woodcock_packet::lanes::{LANES, Lanes};

/// The largest error met, in ulps of the true value, and where.
#[derive(Clone, Copy, Debug, Default)]
struct Worst {
    ulps: f64,
    at: f32,
    tested: u64,
}

impl Worst {
    fn merge(self, other: Self) -> Self {
        let tested = self.tested + other.tested;
        let worse = if other.ulps > self.ulps { other } else { self };
        Self { tested, ..worse }
    }
}

/// Spacing of `f32` at a value.
fn ulp(exact: f64) -> f64 {
    let exponent = (exact.abs().to_bits() >> 52) as i32 - 1023;
    2.0_f64.powi(exponent.max(-126) - 23)
}

fn exhaustive() -> bool {
    std::env::var_os("WOODCOCK_EXHAUSTIVE").is_some_and(|value| value == "1")
}

/// Runs `f32` and lanes over all floats whose bits lie in a range; the function may ask for a floor under the ulp.
fn sweep(
    bits: std::ops::RangeInclusive<u32>,
    step: u32,
    one: impl Fn(f32) -> f32 + Sync,
    eight: impl Fn(Lanes) -> Lanes + Sync,
    error: impl Fn(f32, f32) -> f64 + Sync,
) -> Worst {
    let part = |first: u32, last: u32| {
        let mut worst = Worst::default();
        let mut next = u64::from(first);
        while next <= u64::from(last) {
            let x: [f32; LANES] = std::array::from_fn(|i| {
                f32::from_bits((next + i as u64 * u64::from(step)).min(u64::from(last)) as u32)
            });
            let wide = eight(Lanes::new(x)).to_array();
            for (x, wide) in x.into_iter().zip(wide) {
                let y = one(x);
                assert_eq!(
                    y.to_bits(),
                    wide.to_bits(),
                    "lanes differ at {x:e}: {y:e} and {wide:e}"
                );
                worst = worst.merge(Worst {
                    ulps: error(x, y),
                    at: x,
                    tested: 1,
                });
            }
            next += LANES as u64 * u64::from(step);
        }
        worst
    };
    let (first, last) = bits.into_inner();
    let middle = first + (last - first) / 2 / step * step;
    let part = &part;
    std::thread::scope(|scope| {
        let low = scope.spawn(move || part(first, middle));
        let high = part(middle + 1, last);
        low.join().expect("a sweep ends").merge(high)
    })
}

/// Every 257th float of a range of positive ones, or all; and all near the seams.
fn domain(
    low: f32,
    high: f32,
    seams: &[f32],
    one: impl Fn(f32) -> f32 + Sync,
    eight: impl Fn(Lanes) -> Lanes + Sync,
    error: impl Fn(f32, f32) -> f64 + Sync,
) -> Worst {
    let step = if exhaustive() { 1 } else { 257 };
    let (first, last) = (low.to_bits(), high.to_bits());
    let mut worst = sweep(first..=last, step, &one, &eight, &error);
    for seam in seams {
        let near =
            |by: i64| (i64::from(seam.to_bits()) + by).clamp(first.into(), last.into()) as u32;
        worst = worst.merge(sweep(near(-20_000)..=near(20_000), 1, &one, &eight, &error));
    }
    worst
}

fn relative(exact: impl Fn(f64) -> f64) -> impl Fn(f32, f32) -> f64 {
    move |x, y| {
        let exact = exact(f64::from(x));
        if f64::from(y) == exact {
            return 0.0;
        }
        let error = (f64::from(y) - exact).abs() / ulp(exact);
        if error.is_nan() { f64::INFINITY } else { error }
    }
}

fn bounded(name: &str, worst: Worst, bound: f64, least: u64) {
    println!(
        "{name}: {:.4} ulp at {:e} of {} floats",
        worst.ulps, worst.at, worst.tested
    );
    assert!(
        worst.tested >= least,
        "{name}: only {} floats",
        worst.tested
    );
    assert!(
        worst.ulps <= bound,
        "{name}: {:.4} ulp at {:e}, promised {bound}",
        worst.ulps,
        worst.at
    );
}

#[test]
fn ln_keeps_its_bound() {
    let binades: Vec<f32> = (-126..128)
        .flat_map(|e| [1.0, 4.0 / 3.0].map(|m| m * 2.0_f32.powi(e)))
        .collect();
    let mut seams = vec![
        1.0,
        2.0 / 3.0,
        4.0 / 3.0,
        f32::MIN_POSITIVE,
        f32::MAX,
        f32::from_bits(1),
    ];
    seams.extend(binades.iter().step_by(17));
    let worst = domain(
        f32::from_bits(1),
        f32::MAX,
        &seams,
        Real::ln,
        Real::ln,
        relative(f64::ln),
    );
    bounded("ln", worst, 0.96, 8_000_000);
}

#[test]
fn neg_ln_1m_keeps_its_bound() {
    let below_one = 1.0_f32.next_down();
    let mut seams = vec![
        0.0,
        f32::MIN_POSITIVE,
        1.0 / 3.0,
        0.5,
        2.0 / 3.0,
        5.0 / 6.0,
        below_one,
    ];
    seams.extend((1..33).map(|e| 2.0_f32.powi(-e)));
    let exact = |u: f64| -(-u).ln_1p();
    let worst = domain(
        0.0,
        below_one,
        &seams,
        Real::neg_ln_1m,
        Real::neg_ln_1m,
        relative(exact),
    );
    bounded("neg_ln_1m", worst, 0.9, 4_000_000);
}

#[test]
fn exp_keeps_its_bound() {
    let half_steps = (0..127).map(|i| (i as f32 + 0.5) * core::f32::consts::LN_2);
    let mut seams: Vec<f32> = half_steps.filter(|&x| x < 87.0).step_by(5).collect();
    seams.extend([0.0, 1.0, 87.3, 88.7]);
    let rising = domain(0.0, 88.7, &seams, Real::exp, Real::exp, relative(f64::exp));
    let falling = domain(
        0.0,
        87.3,
        &seams,
        |x| Real::exp(-x),
        |x| Real::exp(-x),
        relative(|x| (-x).exp()),
    );
    bounded("exp", rising.merge(falling), 1.0, 8_000_000);
}

/// Sine and cosine of a turn, whose fraction of a quarter is exact in `f64`.
fn exact_sin_cos(turn: f64) -> (f64, f64) {
    let quarters = (4.0 * turn).round();
    let rest = TAU * (turn - 0.25 * quarters);
    let (s, c) = (rest.sin(), rest.cos());
    match quarters.rem_euclid(4.0) as u32 {
        0 => (s, c),
        1 => (c, -s),
        2 => (-s, -c),
        _ => (-c, s),
    }
}

/// In ulps, or in units of 3e-8 where the value is small: two of either are the bound.
fn turn_error(y: f32, exact: f64) -> f64 {
    let error = (f64::from(y) - exact).abs();
    (error / ulp(exact)).min(error / 3e-8)
}

#[test]
fn sin_cos_turn_keeps_its_bound() {
    let mut seams: Vec<f32> = (1..16).map(|i| i as f32 / 8.0).collect();
    seams.extend([0.0, 1000.125, 4096.0]);
    for (name, sign) in [("turn", 1.0_f32), ("negative turn", -1.0)] {
        let sine = domain(
            0.0,
            4096.0,
            &seams,
            |x| (sign * x).sin_cos_turn().0,
            |x| (Lanes::splat(sign) * x).sin_cos_turn().0,
            |x, y| turn_error(y, exact_sin_cos(f64::from(sign * x)).0),
        );
        let cosine = domain(
            0.0,
            4096.0,
            &seams,
            |x| (sign * x).sin_cos_turn().1,
            |x| (Lanes::splat(sign) * x).sin_cos_turn().1,
            |x, y| turn_error(y, exact_sin_cos(f64::from(sign * x)).1),
        );
        bounded(&format!("sine of a {name}"), sine, 2.0, 4_000_000);
        bounded(&format!("cosine of a {name}"), cosine, 2.0, 4_000_000);
    }
}

#[test]
fn exact_points_are_exact() {
    assert_eq!(1.0_f32.ln(), 0.0);
    assert_eq!(Real::ln(1.0_f32), 0.0);
    assert_eq!(Real::exp(0.0_f32), 1.0);
    assert_eq!(Real::exp(-0.0_f32), 1.0);
    assert_eq!(Real::neg_ln_1m(0.0_f32), 0.0);
    assert_eq!(Real::exp(-1e30_f32), 0.0);
    assert_eq!(Real::exp(f32::NEG_INFINITY), 0.0);
    assert_eq!(Real::exp(f32::INFINITY), f32::INFINITY);
    assert_eq!(Real::exp(89.0_f32), f32::INFINITY);
    assert!(
        Real::ln(0.0_f32) < -80.0,
        "zero gives a large negative number"
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
