//! Work: known beforehand, refused above a limit, and bounded in segments however extreme the ray.

use super::{along_x, ray, stream};
use std::cell::Cell;
use woodcock_core::free_flight::delta;
use woodcock_core::majorant::{Segment, WORK_LIMIT, check_work, majorant_depth};
use woodcock_core::medium::{
    Audited, Control, Controlled, Exponential, Homogeneous, Linear, Medium, Procedural,
};
use woodcock_core::ray::Ray;
use woodcock_core::stream::Stream;
use woodcock_core::transmittance::{self, residual_ratio::Residual};
use woodcock_core::vec3::Vec3;

/// A medium whose walks must end: the step beyond a number of segments panics.
#[derive(Debug)]
pub(super) struct Patient<M> {
    medium: M,
    left: Cell<u32>,
}

impl<M> Patient<M> {
    pub(super) fn new(medium: M, segments: u32) -> Self {
        let left = Cell::new(segments);
        Self { medium, left }
    }
}

impl<M: Medium<f32>> Medium<f32> for Patient<M> {
    type Walk = M::Walk;
    const ONE_SEGMENT: bool = false;
    const TIGHT: bool = M::TIGHT;
    fn idle(&self) -> M::Walk {
        self.medium.idle()
    }
    fn begin(&self, walk: &mut M::Walk, ray: &Ray<f32>, active: bool) {
        self.medium.begin(walk, ray, active);
    }
    fn segment(&self, walk: &M::Walk) -> Segment<f32> {
        self.medium.segment(walk)
    }
    fn next_segment(&self, walk: &mut M::Walk, active: bool) {
        let left = self.left.get().checked_sub(1);
        self.left.set(left.expect("a walk that does not end"));
        self.medium.next_segment(walk, active);
    }
    fn sigma_t(&self, walk: &M::Walk, t: f32, rng: &mut impl Stream<f32>, active: bool) -> f32 {
        self.medium.sigma_t(walk, t, rng, active)
    }
}

impl<M: Controlled<f32>> Controlled<f32> for Patient<M> {
    fn control(&self, walk: &M::Walk) -> Control<f32> {
        self.medium.control(walk)
    }
}

#[test]
fn what_is_astronomical_is_refused_beforehand() {
    let nothing = |bound: f32| Audited::new(Procedural::new(|_: Vec3<f32>| 0.0, bound));
    for (bound, t_max) in [
        (1e30_f32, 1e-18_f32),
        (1.0, 1e12),
        (1e-15, 1e27),
        (1e30, 1e15),
    ] {
        let medium = nothing(bound);
        let error = check_work(&medium, &along_x(), t_max, WORK_LIMIT).expect_err("too much");
        let exact = f64::from(bound) * f64::from(t_max);
        let agrees = (f64::from(error.expected) / exact - 1.0).abs() < 1e-6;
        assert!(
            agrees || (exact > 1e38 && error.expected == f32::INFINITY),
            "{error}"
        );
        assert_eq!(
            (medium.lookups(), medium.segments()),
            (0, 0),
            "refused without any work"
        );
        // What the residual of a known medium costs is another matter: nothing.
        let known = Homogeneous::new(bound).expect("a valid extinction");
        let residual = Residual::<_, transmittance::residual_ratio::Mean>::new(&known);
        assert_eq!(
            check_work(&residual, &along_x(), t_max, WORK_LIMIT),
            Ok(0.0)
        );
    }
    assert_eq!(
        check_work(&nothing(1e7), &along_x(), 1.0, WORK_LIMIT),
        Ok(1e7)
    );
    assert!(check_work(&nothing(1e7), &along_x(), 1.0_f32.next_up(), WORK_LIMIT).is_err());
}

/// Rays through ramps whose crossings underflow, coincide with the origin, or lie where steps are not resolved.
#[test]
fn ramps_are_walked_in_few_segments() {
    let mut most = 0;
    for a in [
        -1e30_f32, -1.0, -1e-30, -1e-40, -0.0, 0.0, 1e-40, 1e-30, 1.0, 1e30,
    ] {
        for b in [
            -1e30_f32, -1.0, -1e-30, -1e-40, -0.0, 0.0, 1e-40, 1e-30, 1.0, 1e6, 1e30,
        ] {
            for t_max in [1e-30_f32, 1e-15, 1.0, 1e15, 1e30, f32::INFINITY] {
                let ramp = Patient::new(Linear::new(a, [b, 0.0, 0.0]).expect("finite"), 10_000);
                let depth = majorant_depth(&ramp, &along_x(), t_max, true);
                assert!(depth >= 0.0, "{a:e}, {b:e}, {t_max:e}: {depth}");
                most = most.max(10_000 - ramp.left.get());
                if depth <= WORK_LIMIT * 1e-3 {
                    let flight = delta::sample(&ramp, &along_x(), t_max, &mut stream(1), true);
                    assert!(flight.t >= 0.0 && flight.t <= t_max);
                }
            }
        }
    }
    println!("at most {most} segments on a ramp");
    assert!(most <= RAMP_SEGMENTS, "{most} segments on a ramp");
}

/// Doublings between the smallest and the largest number, and what begins and ends a ramp.
const RAMP_SEGMENTS: u32 = 160;
/// Doublings of an atmosphere from e⁻⁶⁰ of a mean free path a scale height to the largest number.
const AIR_SEGMENTS: u32 = 300;

#[test]
fn atmospheres_are_walked_in_few_segments() {
    let mut most = 0;
    for sigma_0 in [0.0_f32, 1e-40, 1e-30, 1.0, 1e30] {
        for k in [
            -1e15_f32, -1e6, -1.0, -1e-6, -1e-30, 0.0, 1e-30, 1e-6, 1.0, 1e6, 1e15,
        ] {
            for x in [-1e6_f32, -1.0, 0.0, 1.0, 1e6] {
                for t_max in [1e-15_f32, 1.0, 1e6, 1e15, f32::INFINITY] {
                    let air = Exponential::new(sigma_0, [k, 0.0, 0.0]).expect("finite");
                    let air = Patient::new(air, 100_000);
                    let ray = ray([x, 0.0, 0.0], [1.0, 0.0, 0.0]);
                    let depth = majorant_depth(&air, &ray, t_max, true);
                    assert!(
                        depth >= 0.0,
                        "{sigma_0:e}, {k:e}, {x:e}, {t_max:e}: {depth}"
                    );
                    most = most.max(100_000 - air.left.get());
                    if depth <= WORK_LIMIT * 1e-3 {
                        let flight = delta::sample(&air, &ray, t_max, &mut stream(1), true);
                        assert!(flight.t >= 0.0 && flight.t <= t_max);
                    }
                }
            }
        }
    }
    println!("at most {most} segments in an atmosphere");
    assert!(most <= AIR_SEGMENTS, "{most} segments in an atmosphere");
}

/// A ray without an end: every tracker ends, in fog so thin that it leaves as in fog that stops it.
#[test]
fn rays_without_an_end_are_tracked() {
    for sigma_t in [0.0_f32, 1e-38, 1e-30, 1.0, 1e30] {
        let fog = Homogeneous::new(sigma_t).expect("a valid extinction");
        for t_max in [1e30_f32, 3e38, f32::INFINITY] {
            for sample in 0..8 {
                for outcome in
                    super::media::outcomes::<f32, _, _>(&fog, &along_x(), t_max, &stream(sample))
                {
                    outcome.check(&format!("{sigma_t:e} without an end"), t_max);
                }
            }
        }
    }
}

/// The guard of these tests can fail: a walk whose segments do not get on.
#[test]
#[should_panic(expected = "a walk that does not end")]
fn a_walk_that_stands_still_is_noticed() {
    #[derive(Debug)]
    struct Still;
    impl Medium<f32> for Still {
        type Walk = ();
        const ONE_SEGMENT: bool = false;
        const TIGHT: bool = false;
        fn idle(&self) {}
        fn begin(&self, (): &mut (), _: &Ray<f32>, _: bool) {}
        fn segment(&self, (): &()) -> Segment<f32> {
            Segment {
                majorant: 1.0,
                t_exit: 0.5,
            }
        }
        fn next_segment(&self, (): &mut (), _: bool) {}
        fn sigma_t(&self, (): &(), _: f32, _: &mut impl Stream<f32>, _: bool) -> f32 {
            0.0
        }
    }
    majorant_depth(&Patient::new(Still, 1000), &along_x(), 1.0, true);
}
