//! What the comb is for: less variance than independent walks, never more.

use super::{Score, per_distance};
use woodcock_core::free_flight::delta;
use woodcock_core::medium::Procedural;
use woodcock_core::ray::Ray;
use woodcock_core::stream::PathStream;
use woodcock_tests::stats::{Moments, Sample, samples, seed};
use woodcock_tests::widths::{per_lane, ray, sample};

const WALKS: u32 = 16;

/// Source function of the tests; it differs along the ray, or a homogeneous medium would leave no variance at all.
fn source(t: f64) -> f64 {
    1.0 + t
}

/// Variances of as many independent walks of delta tracking, and of a comb of them.
fn variances(sigma_t: &dyn Fn(f64) -> f64, majorant: f32, score: Score) -> [f64; 2] {
    let medium = Procedural::new(per_lane::<f32>(|x, _, _| sigma_t(x)), majorant);
    let along: Ray<f32> = ray([0.0; 3], [1.0, 0.0, 0.0]);
    let n = samples(1 << 14);
    let independent = sample::<f32, PathStream>(seed(131), 0, n, |rng| {
        let mut sum = 0.0;
        for _ in 0..WALKS {
            let flight = delta::sample(&medium, &along, 1.0, rng, true);
            sum += if flight.collided {
                source(f64::from(flight.t)) as f32
            } else {
                0.5
            };
        }
        sum / WALKS as f32
    });
    let of = (per_distance::<f32>(source), per_distance::<f32>(sigma_t));
    let comb = sample::<f32, PathStream>(seed(132), 0, n, |rng| {
        score.estimate(&medium, (&along, 1.0), WALKS, (&of.0, &of.1), 0.5, rng)
    });
    let agree = |a: &Sample, b: &Sample| {
        let (a, b) = (a.moments(), b.moments());
        let error = a.standard_error().hypot(b.standard_error());
        assert!(
            (a.mean() - b.mean()).abs() < 4.892 * error,
            "{} and {}",
            a.mean(),
            b.mean()
        );
    };
    agree(&independent, &comb);
    [independent, comb].map(|s| s.moments().variance())
}

/// Var over Δ of e^−D c_∂V + (p/n) Σ c(uᵢ), in double precision: all that chance decides in a homogeneous medium.
fn variance_of_the_offset(depth: f64) -> f64 {
    let opacity = -(-depth).exp_m1();
    let walks = f64::from(WALKS);
    let offsets = 4096;
    let estimates = (0..offsets).map(|offset| {
        let offset = (f64::from(offset) + 0.5) / f64::from(offsets);
        let tooth = |i: u32| {
            let u = opacity * (f64::from(i) + offset) / walks;
            source(-(-u).ln_1p() / depth)
        };
        opacity * (0..WALKS).map(tooth).sum::<f64>() / walks
    });
    estimates.collect::<Moments>().variance()
}

/// Where the bound is the extinction the first tentative point decides all, and n points equidistant in it leave
/// little to chance: more than tenfold less, but for deep rays, on which the source at the last point is any.
#[test]
fn homogeneous_media_gain_as_much_as_the_offset_leaves() {
    for (depth, least) in [(1.0_f32, 10.0), (3.0, 10.0), (10.0, 5.0)] {
        let left = variance_of_the_offset(f64::from(depth));
        for score in [Score::Collisions, Score::Tentative] {
            let [independent, comb] = variances(&|_| f64::from(depth), depth, score);
            let gain = independent / comb;
            println!("depth {depth}, {score:?}: {gain:.0} times less variance");
            assert!(gain > least, "depth {depth}, {score:?}: {gain}");
            assert!(
                (comb / left - 1.0).abs() < 0.1,
                "depth {depth}, {score:?}: {comb} for {left}"
            );
        }
    }
}

/// Under a loose bound later points decide, and little is gained; nothing is lost.
#[test]
fn bumps_lose_nothing() {
    for depth in [1.0_f32, 3.0, 10.0] {
        let bump = |t: f64| f64::from(depth) * (-((t - 0.5) / 0.21).powi(2)).exp();
        for (score, least) in [(Score::Collisions, 0.95), (Score::Tentative, 1.5)] {
            let [independent, comb] = variances(&bump, depth, score);
            let gain = independent / comb;
            println!("bump of {depth}, {score:?}: {gain:.2} times less variance");
            assert!(gain > least, "bump of {depth}, {score:?}: {gain}");
        }
    }
}
