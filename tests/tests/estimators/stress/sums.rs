//! Sums of up to 10⁹ addends.

use super::Worst;
use woodcock_core::real::Real;
use woodcock_core::sum::Compensated;
use woodcock_packet::lanes::Lanes;
use woodcock_tests::stats::independent::SplitMix;

/// What a compensated sum may be off, relative, as long as addends are smaller than the sum.
const BOUND: f64 = 1.2e-7;

fn exhaustive() -> bool {
    std::env::var_os("WOODCOCK_EXHAUSTIVE").is_some_and(|value| value == "1")
}

/// n times the same addend, from zero.
fn repeated<R: Real>(addend: f32, n: u32) -> f32 {
    let mut sum = Compensated::<R>::zero();
    for _ in 0..n {
        sum = sum.plus(R::splat(addend));
    }
    sum.high.lane(R::LANES - 1)
}

#[test]
fn equal_addends_add_up() {
    let n = if exhaustive() {
        1_000_000_000
    } else {
        100_000_000
    };
    let mut worst = Worst::default();
    let exact = f64::from(0.1_f32) * f64::from(n);
    let found = f64::from(repeated::<f32>(0.1, n));
    worst.see((found / exact - 1.0).abs(), || "0.1".to_owned());
    for addend in [1e-30_f32, 1.000_000_1, 3e20] {
        let n = 10_000_000;
        let exact = f64::from(addend) * f64::from(n);
        for found in [repeated::<f32>(addend, n), repeated::<Lanes>(addend, n)] {
            worst.see((f64::from(found) / exact - 1.0).abs(), || {
                format!("{addend:e}")
            });
        }
    }
    worst.within("sums of equal addends", BOUND, 7);
    let mut plain = Worst::default();
    let sum = (0..50_000_000).fold(0.0_f32, |sum, _| sum + 0.1);
    plain.see(
        (f64::from(sum) / (5e7 * f64::from(0.1_f32)) - 1.0).abs(),
        || "0.1".to_owned(),
    );
    plain.must_fail("a plain sum", BOUND);
}

#[test]
fn addends_of_any_size_add_up() {
    let mut rng = SplitMix::new(77);
    let mut worst = Worst::default();
    for decades in [0.0, 2.0, 8.0, 30.0] {
        let (mut sum, mut exact) = (Compensated::<f32>::zero(), 0.0_f64);
        for _ in 0..1_000_000 {
            let addend = 10.0_f64.powf(decades * (rng.uniform() - 1.0)) as f32;
            sum = sum.plus(addend);
            exact += f64::from(addend);
        }
        worst.see((f64::from(sum.high) / exact - 1.0).abs(), || {
            format!("over {decades} decades")
        });
    }
    worst.within("sums of random addends", BOUND, 4);
}

/// 10⁹ paths of a pixel are not added one by one into one number: what the film does is tested with it. Here, a
/// distance made of steps that are 10⁻¹² of it.
#[test]
fn a_small_step_still_advances() {
    let mut sum = Compensated::new(1e6_f32);
    for _ in 0..1_000_000 {
        sum = sum.plus(1e-6);
    }
    let exact = 1e6 + 1e6 * f64::from(1e-6_f32);
    let found = f64::from(sum.high) + f64::from(sum.low);
    assert!((found - exact).abs() < 1e-9 * exact, "{found}");
    let plain = (0..1_000_000).fold(1e6_f32, |sum, _| sum + 1e-6);
    assert_eq!(plain, 1e6, "a plain sum stands still");
}
