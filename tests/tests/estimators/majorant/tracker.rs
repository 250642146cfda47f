//! The walk through very loose bounds: ten million steps and more along one ray lose none of it.

use woodcock_core::medium::{Audited, Procedural};
use woodcock_core::ray::Ray;
use woodcock_core::real::Real;
use woodcock_core::stream::{Key, KeyedStream, PathStream};
use woodcock_core::transmittance::{ratio, residual_ratio};
use woodcock_packet::bits::LaneStream;
use woodcock_packet::lanes::{LANES, Lanes};
use woodcock_tests::stats::independent::SplitMix;
use woodcock_tests::stats::{Verdict, Z_CRITICAL, assert_verdict, must_kill, seed};
use woodcock_tests::widths::{collect, everyone, ray};

/// Whether a number of events is Poisson's of this mean.
fn poisson(events: u64, mean: f64) -> Verdict {
    let z = (events as f64 - mean) / mean.sqrt();
    if z.abs() < Z_CRITICAL {
        Verdict::Agrees
    } else {
        Verdict::Biased { z }
    }
}

/// Tentative collisions on one ray a lane, of unit length, under a bound with nothing below it.
fn tentative<R: Real, S: KeyedStream<R>>(bound: f32) -> u64 {
    let nothing = Audited::new(Procedural::new(|_| R::zero(), bound));
    let along: Ray<R> = ray([0.0; 3], [0.6, 0.0, 0.8]);
    let weights = collect::<R, S>(seed(151), 0, R::LANES, |rng| {
        ratio::estimate(&nothing, &along, R::one(), rng, everyone::<R>())
    });
    assert!(weights.iter().all(|&w| w == 1.0), "{weights:?}");
    nothing.lookups()
}

#[test]
fn no_step_is_lost() {
    let single = tentative::<f32, PathStream>(4e7);
    assert_verdict(&format!("{single} of 4e7"), poisson(single, 4e7));
    let eight = tentative::<Lanes, LaneStream>(2e6);
    let all = 2e6 * LANES as f64;
    assert_verdict(&format!("{eight} of {all}"), poisson(eight, all));
    // A plain sum of as many steps: it stalls where they are below half a unit of its last place.
    let mut rng = SplitMix::new(seed(152));
    let (mut t, mut events) = (0.0_f32, 0_u64);
    while t < 1.0 && events < 60_000_000 {
        t += rng.exponential() as f32 / 4e7;
        events += 1;
    }
    must_kill("a plain sum", poisson(events, 4e7));
}

/// The control's depth is a sum over the same steps. A control that is the extinction leaves nothing else.
#[test]
fn the_control_keeps_its_depth() {
    let medium = Procedural::new(|_| 2.0_f32, 1e7).with_control(2.0, 2.0);
    let along: Ray<f32> = ray([0.0; 3], [0.0, 1.0, 0.0]);
    let mut rng = PathStream::new(Key::default());
    let weight = residual_ratio::estimate::<residual_ratio::Minimum, f32, _>(
        &medium, &along, 1.0, &mut rng, true,
    );
    let off = f64::from(weight) / (-2.0_f64).exp() - 1.0;
    assert!(off.abs() < 1e-6, "{weight}: off by {off:e}");
}
