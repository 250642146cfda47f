//! The power series: its cost, its variance beside that of others, and its rare long orders.

use super::rows;
use super::rows::Estimator;
use woodcock_core::medium::{Audited, Homogeneous, Overlap, Procedural, Within};
use woodcock_core::ray::Ray;
use woodcock_core::real::{Real, Word32};
use woodcock_core::stream::{PathStream, Stream};
use woodcock_core::transmittance::power_series::{self, Depth, Distance};
use woodcock_tests::stats::{Sample, assert_agrees, samples, seed};
use woodcock_tests::widths::{collect, per_lane, ray, sample};

/// M for a spread, in double precision.
fn points(s: f64) -> f64 {
    let whole = ((0.015 + s) * (0.65 + s) * (60.3 + s)).cbrt().ceil();
    (whole / 1.31945).round().max(1.0)
}

/// E N = Σ P(N ≥ k) = (e² − 1)/20 further estimates of M look-ups each.
#[test]
fn look_ups_are_as_many_as_it_says() {
    let along: Ray<f32> = ray([0.0; 3], [1.0, 0.0, 0.0]);
    for (pixel, spread) in (0..).zip([0.25_f32, 1.75, 6.0, 20.0]) {
        let field = per_lane::<f32>(|x, _, _| 0.5 + f64::from(spread) * x * (1.0 - x));
        let medium = Audited::new(Procedural::new(field, 0.5 + spread).with_control(0.5, 0.5));
        let mut costs = Sample::new();
        let mut before = 0;
        collect::<f32, PathStream>(seed(36), pixel, samples(1 << 16), |rng| {
            let weight = power_series::estimate::<Distance, _, _>(&medium, &along, 1.0, rng, true);
            costs.push((medium.lookups() - before) as f64);
            before = medium.lookups();
            weight
        });
        let further = (1.0_f64.exp().powi(2) - 1.0) / 20.0;
        let expected = points(f64::from(spread)) * (1.0 + further);
        assert_agrees(&format!("spread {spread}"), &costs, expected, 0.005);
        assert_eq!(medium.violations(), 0);
    }
}

/// Variance times look-ups on a smooth medium: residual ratio tracking a tenth of ratio tracking, power series a tenth
/// of that, at least.
#[test]
fn smooth_media_order_the_estimators() {
    // Its waves die out quickly, and it ends as it begins.
    let field = |x: f64, _: f64, _: f64| {
        let wave = (std::f64::consts::TAU * x).sin();
        2.9 + 0.3 * wave * wave.exp()
    };
    let along: Ray<f32> = ray([0.0; 3], [1.0, 0.0, 0.0]);
    let medium = Procedural::new(per_lane::<f32>(field), 3.75).with_control(2.75, 3.05);
    let medium = Audited::new(medium);
    let cost = |name: &str, estimate: &dyn Fn(&mut PathStream) -> f32| {
        let before = medium.lookups();
        let n = samples(1 << 16);
        let weights = sample::<f32, PathStream>(seed(37), 0, n, estimate);
        let m = weights.moments();
        let relative = m.variance() / (m.mean() * m.mean());
        let cost = relative * (medium.lookups() - before) as f64 / n as f64;
        println!("{name}: relative variance times look-ups {cost:.3e}");
        cost
    };
    let ratio = cost("ratio", &|rng| {
        rows::ratio::Row::in_any(&medium, &along, 1.0, rng, true)
    });
    let residual = cost("residual ratio", &|rng| {
        rows::residual_ratio::Row::in_any(&medium, &along, 1.0, rng, true)
    });
    let series = cost("power series", &|rng| {
        rows::power_series::Row::in_any(&medium, &along, 1.0, rng, true)
    });
    assert!(10.0 * residual < ratio, "{residual} of {ratio}");
    assert!(10.0 * series < residual, "{series} of {residual}");
}

/// Points in the depth of what is unknown leave dense fog alone whose extinction is known: it adds no spread.
#[test]
fn known_fog_costs_no_variance() {
    let fog = Homogeneous::new(12.0).expect("a valid extinction");
    let dense = Within::aligned(fog, [1.0, -1.0, -1.0], [2.0, 1.0, 1.0]).expect("a box");
    let field = per_lane::<f32>(|x, _, _| 0.3 + 0.25 * (3.0 * x).sin());
    let medium = Overlap(dense, Procedural::new(field, 0.6));
    let along: Ray<f32> = ray([0.0; 3], [1.0, 0.0, 0.0]);
    let depth = 12.0 + 0.3 * 4.0 + 0.25 / 3.0 * (1.0 - 12.0_f64.cos());
    let weights = sample::<f32, PathStream>(seed(38), 0, samples(1 << 14), |rng| {
        power_series::estimate::<Depth, _, _>(&medium, &along, 4.0, rng, true)
    });
    assert_agrees("fog and a wave", &weights, (-depth).exp(), 0.005);
}

/// A stream that gives the words it is told to.
struct Words<'a>(&'a [u32]);

impl<R: Real<Mask = bool, Word = Word32>> Stream<R> for Words<'_> {
    fn next_word(&mut self, active: bool) -> Word32 {
        if !active {
            return Word32(0);
        }
        let (first, rest) = self.0.split_first().expect("no word left");
        self.0 = rest;
        Word32(*first)
    }
}

/// The series of order `n` about each of the first twelve estimates, from its definition: sums over all subsets.
fn oracle(x: &[f64], n: usize) -> f64 {
    let pivots = x.len().min(12);
    // k! P(N ≥ k), each from its own definition.
    let reached = |k: usize| (3..=k).fold(0.1, |p, k| p * 2.0 / k as f64);
    let factorial = |k: usize| (1..=k).map(|i| i as f64).product::<f64>();
    let about = |i: usize| {
        let others: Vec<f64> = (0..pivots)
            .filter(|&j| j != i)
            .map(|j| x[j] - x[i])
            .collect();
        let mut sums = vec![0.0; others.len() + 1];
        let mut subsets = vec![0.0; others.len() + 1];
        for set in 0_u32..1 << others.len() {
            let chosen = others.iter().enumerate().filter(|(j, _)| set >> j & 1 == 1);
            let size = set.count_ones() as usize;
            sums[size] += chosen.map(|(_, d)| d).product::<f64>();
            subsets[size] += 1.0;
        }
        let mut series = 1.0;
        for k in 1..=n.min(others.len()) {
            series += sums[k] / subsets[k] / (factorial(k) * reached(k));
        }
        // Beyond the pivots: one product, of all differences so far.
        let mut product: f64 = others.iter().product();
        for k in pivots..=n {
            product *= x[k] - x[i];
            series += product / (factorial(k) * reached(k));
        }
        x[i].exp() * series
    };
    (0..pivots).map(about).sum::<f64>() / pivots as f64
}

/// Orders that no run would see: up to 15, with differences that make their terms the largest.
#[test]
fn rare_long_orders_have_all_their_terms() {
    // One look-up each, as bound and minimum are said to be equal; the estimates are 8ξ.
    fn run<R: Real<Mask = bool, Word = Word32>>(words: &[u32]) -> f64 {
        let medium = Procedural::new(|p: woodcock_core::vec3::Vec3<R>| p.x * R::splat(8.0), 1.0)
            .with_control(1.0, 1.0);
        let along: Ray<R> = ray([0.0; 3], [1.0, 0.0, 0.0]);
        let mut rng = Words(words);
        let weight =
            power_series::estimate::<Distance, R, _>(&medium, &along, R::one(), &mut rng, true);
        assert!(rng.0.is_empty(), "{} words left", rng.0.len());
        f64::from(weight.lane(0))
    }
    let fraction = |u: f64| (u * 4_294_967_296.0) as u32;
    for order in [0_usize, 2, 3, 7, 10, 11, 12, 13, 15] {
        // In [0.3, 0.98), in an order that mixes near and far.
        let offsets: Vec<u32> = (0..=order)
            .map(|j| fraction(0.3 + 0.68 * ((j * 7) % 17) as f64 / 17.0) & !0xff)
            .collect();
        let mut words = vec![fraction(if order == 0 { 0.5 } else { 0.05 }), offsets[0]];
        for (k, &offset) in offsets.iter().enumerate().skip(1) {
            if k > 2 {
                words.push(fraction(0.1)); // goes on: below 2/k
            }
            words.push(offset);
        }
        if order > 0 {
            words.push(fraction(0.9)); // stops: above 2/k
        }
        let x: Vec<f64> = offsets
            .iter()
            .map(|&w| -8.0 * f64::from(w) / 4_294_967_296.0)
            .collect();
        let exact = oracle(&x, order);
        let (single, double) = (run::<f32>(&words), run::<f64>(&words));
        assert!(
            (double / exact - 1.0).abs() < 1e-6,
            "order {order}: {double:e} for {exact:e}"
        );
        assert!(
            (single / exact - 1.0).abs() < 1e-4,
            "order {order}: {single:e} for {exact:e}"
        );
    }
}
