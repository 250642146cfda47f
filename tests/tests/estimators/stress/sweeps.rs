//! Sweeps: media of every kind at random ends of all ranges, one lane and eight. Nothing is NaN, all is in range, work
//! is what was predicted, and lanes have the bits of scalars.

use super::media::{Outcome, Tables, Visit, each, outcomes};
use proptest::prelude::*;
use proptest::test_runner::{Config, RngAlgorithm, TestError, TestRng, TestRunner};
use woodcock_core::free_flight::delta;
use woodcock_core::majorant::{Segment, majorant_depth};
use woodcock_core::medium::{Audited, Controlled, Medium};
use woodcock_core::ray::Ray;
use woodcock_core::stream::{Key, KeyedStream, PathStream, Stream};
use woodcock_core::transmittance::ratio;
use woodcock_packet::bits::LaneStream;
use woodcock_packet::lanes::{LANES, Lanes};

/// A runner whose cases are the same on every run, and that writes no file.
fn runner(cases: u32) -> TestRunner {
    let config = Config {
        cases,
        failure_persistence: None,
        ..Config::default()
    };
    TestRunner::new_with_rng(config, TestRng::deterministic_rng(RngAlgorithm::ChaCha))
}

fn key(sample: u32) -> Key {
    Key {
        seed: 0x5eed,
        pixel: 9,
        sample,
    }
}

/// One path's values, medium by medium and call by call.
struct Scalar {
    sample: u32,
    bits: Vec<u32>,
    refused: u32,
}

/// Rays that are deeper are refused, as a caller would.
const LIMIT: f32 = 3e3;

impl Visit<f32> for Scalar {
    fn visit<M: Controlled<f32>>(
        &mut self,
        name: &'static str,
        medium: &M,
        ray: &Ray<f32>,
        t_max: f32,
    ) {
        let depth = majorant_depth(medium, ray, t_max, true);
        assert!(depth >= 0.0, "{name}: majorant depth {depth}");
        if depth > LIMIT {
            self.refused += 1;
            return;
        }
        let stream = PathStream::new(key(self.sample));
        for outcome in outcomes(medium, ray, t_max, &stream) {
            outcome.check(name, t_max);
            self.bits.push(outcome.value.to_bits());
        }
        // Tentative collisions follow Poisson's law: 8 deviations, and what short tails need.
        let audited = Audited::new(Borrowed(medium));
        ratio::estimate(&audited, ray, t_max, &mut stream.clone(), true);
        delta::sample(&audited, ray, t_max, &mut stream.clone(), true);
        let most = 2.0 * (f64::from(depth) + 8.0 * f64::from(depth).sqrt() + 16.0);
        assert!(
            audited.lookups() as f64 <= most,
            "{name}: {} look-ups at a depth of {depth}",
            audited.lookups()
        );
        assert_eq!(audited.violations(), 0, "{name}");
        assert!(
            audited.segments() <= 1200,
            "{name}: {} segments",
            audited.segments()
        );
    }
}

/// A borrowed medium as one to count.
struct Borrowed<'a, M>(&'a M);

impl<M: Medium<f32>> Medium<f32> for Borrowed<'_, M> {
    type Walk = M::Walk;
    const ONE_SEGMENT: bool = M::ONE_SEGMENT;
    const TIGHT: bool = M::TIGHT;
    fn idle(&self) -> M::Walk {
        self.0.idle()
    }
    fn begin(&self, walk: &mut M::Walk, ray: &Ray<f32>, active: bool) {
        self.0.begin(walk, ray, active);
    }
    fn segment(&self, walk: &M::Walk) -> Segment<f32> {
        self.0.segment(walk)
    }
    fn next_segment(&self, walk: &mut M::Walk, active: bool) {
        self.0.next_segment(walk, active);
    }
    fn sigma_t(&self, walk: &M::Walk, t: f32, rng: &mut impl Stream<f32>, active: bool) -> f32 {
        self.0.sigma_t(walk, t, rng, active)
    }
}

/// The same media to eight lanes.
struct Wide {
    first: u32,
    bits: [Vec<u32>; LANES],
}

impl Visit<Lanes> for Wide {
    fn visit<M: Controlled<Lanes>>(
        &mut self,
        _: &'static str,
        medium: &M,
        ray: &Ray<Lanes>,
        t_max: f32,
    ) {
        use woodcock_core::real::{Mask, Real};
        let depth = majorant_depth(medium, ray, Lanes::splat(t_max), Mask::splat(true));
        if depth.lane(0) > LIMIT {
            return;
        }
        let mut stream = LaneStream::idle();
        (0..LANES).for_each(|lane| stream.set_key(lane, key(self.first + lane as u32)));
        for Outcome { value, .. } in outcomes(medium, ray, t_max, &stream) {
            for (lane, value) in value.to_array().into_iter().enumerate() {
                self.bits[lane].push(value.to_bits());
            }
        }
    }
}

/// Decimal exponents of a unit of length and of the depth in it.
fn ends() -> impl Strategy<Value = (f32, f32, u32)> {
    (-15.0..15.0_f64, -12.0..12.0_f64, 0..1_u32 << 30).prop_map(|(unit, depth, sample)| {
        (
            10.0_f64.powf(unit) as f32,
            10.0_f64.powf(depth) as f32,
            sample,
        )
    })
}

#[test]
fn nothing_breaks_between_the_ends() {
    let tables = Tables::new();
    let (mut ran, mut refused) = (0, 0);
    let tally = std::cell::RefCell::new((&mut ran, &mut refused));
    let result = runner(400).run(&ends(), |(unit, depth, sample)| {
        let mut scalar = Scalar {
            sample,
            bits: Vec::new(),
            refused: 0,
        };
        each::<f32>(&tables, unit, depth, &mut scalar);
        let mut tally = tally.borrow_mut();
        *tally.0 += scalar.bits.len();
        *tally.1 += scalar.refused;
        Ok(())
    });
    assert_eq!(result, Ok(()));
    println!("{ran} values, {refused} rays refused");
    assert!(
        ran > 30_000 && refused > 500,
        "{ran} values, {refused} refused"
    );
}

#[test]
fn lanes_have_the_bits_of_scalars_at_the_ends_too() {
    let tables = Tables::new();
    let compared = std::cell::Cell::new(0);
    let result = runner(60).run(&ends(), |(unit, depth, first)| {
        let mut wide = Wide {
            first,
            bits: Default::default(),
        };
        each::<Lanes>(&tables, unit, depth, &mut wide);
        for (lane, wide) in wide.bits.iter().enumerate() {
            let mut scalar = Scalar {
                sample: first + lane as u32,
                bits: Vec::new(),
                refused: 0,
            };
            each::<f32>(&tables, unit, depth, &mut scalar);
            prop_assert_eq!(&scalar.bits, wide);
            compared.set(compared.get() + wide.len());
        }
        Ok(())
    });
    assert_eq!(result, Ok(()));
    assert!(compared.get() > 30_000, "{} values", compared.get());
}

/// The sweep finds what breaks at an end only: a weight of an exponential that is formed as a quotient of two.
#[test]
fn sweeps_find_what_breaks_at_an_end() {
    use woodcock_core::real::Real;
    // e^(−τ/2) as e^−τ/e^(−τ/2), whose numbers vanish where the quotient does not: 0/0 from depths of 208 on.
    let result = runner(400).run(&ends(), |(_, depth, _)| {
        let weight = Real::exp(-depth) / Real::exp(-0.5 * depth);
        prop_assert!((0.0..=1.0).contains(&weight), "depth {depth:e}: {weight}");
        Ok(())
    });
    assert!(matches!(result, Err(TestError::Fail(..))), "{result:?}");
}
