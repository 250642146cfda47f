//! What is biased is seen to be: bounds that fail, streams that repeat, and ray marching, which says so itself.

use super::rows;
use super::rows::Estimator;
use woodcock_core::medium::{Linear, Procedural};
use woodcock_core::ray::Ray;
use woodcock_core::stream::{KeyedStream, PathStream};
use woodcock_core::transmittance::ray_marching;
use woodcock_tests::stats::{Sample, assert_verdict, judge, must_kill, samples, seed};
use woodcock_tests::widths::{per_lane, ray, sample};

/// Streams that repeat in fours leave the mean alone; the block variance sees them.
#[test]
fn repeated_streams_are_seen() {
    let medium = Procedural::new(per_lane::<f32>(|x, _, _| 2.0 * x), 2.0);
    let along = ray([0.0; 3], [1.0, 0.0, 0.0]);
    let mut rng = <PathStream as KeyedStream<f32>>::idle();
    let weights = Sample::collect(samples(1 << 20), |i| {
        let key = woodcock_core::stream::Key {
            seed: seed(28),
            pixel: 0,
            sample: (i / 4) as u32,
        };
        KeyedStream::<f32>::set_key(&mut rng, 0, key);
        f64::from(rows::ratio::Row::in_any(
            &medium, &along, 1.0, &mut rng, true,
        ))
    });
    must_kill("repeats in fours", weights.judge_blocks());
}

/// Ratio tracking keeps its mean where the bound fails to bound, as it promises; delta tracking does not.
#[test]
fn only_ratio_tracking_survives_a_bound_that_is_none() {
    let medium = Procedural::new(per_lane::<f32>(|x, _, _| 2.0 * x), 1.6);
    let along = ray([0.0; 3], [1.0, 0.0, 0.0]);
    let truth = (-1.0_f64).exp();
    let run = |estimate: &dyn Fn(&mut PathStream) -> f32| {
        let weights = sample::<f32, PathStream>(seed(29), 0, samples(1 << 20), estimate);
        judge(weights.moments(), truth, 0.003)
    };
    assert_verdict(
        "ratio",
        run(&|rng| rows::ratio::Row::in_any(&medium, &along, 1.0, rng, true)),
    );
    let delta = run(&|rng| rows::delta::Row::in_any(&medium, &along, 1.0, rng, true));
    must_kill("delta", delta);
}

/// On a ramp of slope b the jitter ξ of n steps shifts the depth by bL²(ξ − ½)/n, evenly, so that the mean is
///
/// ```text
/// E[e^−X] = T sinh(h)/h,   h = bL²/(2n)
/// ```
#[test]
fn ray_marching_is_biased_as_it_says() {
    let medium = Linear::new(0.5, [3.0, 0.0, 0.0]).expect("a finite ramp");
    let along: Ray<f32> = ray([0.0; 3], [1.0, 0.0, 0.0]);
    let truth = (-2.0_f64).exp();
    let mut smaller = f64::INFINITY;
    for steps in [1, 2, 4, 8, 16] {
        let weights = sample::<f32, PathStream>(seed(35), steps, samples(1 << 17), |rng| {
            ray_marching::estimate(&medium, &along, 1.0, steps, rng, true)
        });
        let h = 1.5 / f64::from(steps);
        let stated = truth * h.sinh() / h;
        let name = format!("{steps} steps");
        assert_verdict(&name, judge(weights.moments(), stated, 0.005));
        let bias = weights.moments().mean() / truth - 1.0;
        assert!(
            0.0 < bias && bias < 0.4 * smaller,
            "{name}: {bias} after {smaller}"
        );
        smaller = bias;
        if steps <= 4 {
            must_kill(&name, judge(weights.moments(), truth, 0.005));
        }
    }
}
