//! Ramps in closed form: the law of flights, the depth against a formula of its own, and both ways round.

use super::{COARSE, PATHS, SHARP, distance, judge};
use woodcock_core::free_flight::{analytic, delta};
use woodcock_core::medium::{ClosedForm, Exponential, Linear, Medium};
use woodcock_core::ray::Ray;
use woodcock_core::real::Real;
use woodcock_core::stream::{Key, PathStream};
use woodcock_packet::lanes::Lanes;
use woodcock_tests::depth::Depth;
use woodcock_tests::each_width;
use woodcock_tests::fixtures::{self, Fixture};
use woodcock_tests::refs::transmittance::Field;
use woodcock_tests::stats::{assert_verdict, samples, seed};
use woodcock_tests::widths::{collect, everyone, ray, width};

/// A medium in closed form at every width.
trait Closed: ClosedForm<f32> + ClosedForm<f64> + ClosedForm<Lanes> {}
impl<M: ClosedForm<f32> + ClosedForm<f64> + ClosedForm<Lanes>> Closed for M {}

/// Flights of a medium against the law of a depth, by the closed form at every width.
fn law<M: Closed>(name: &str, medium: &M, from: ([f64; 3], [f64; 3]), t_max: f64, depth: &Depth) {
    each_width!(R, S => {
        let along: Ray<R> = ray(from.0, from.1);
        let end = R::splat(t_max as f32);
        let sharp = width::<R>() == "f32";
        let (n, resolution) = if sharp { (PATHS, SHARP) } else { (PATHS / 8, COARSE) };
        let flights = collect::<R, S>(seed(18), 0, samples(n), |rng| {
            distance(analytic::sample(medium, &along, end, rng, everyone::<R>()), end)
        });
        let (law, share) = judge(flights, t_max, resolution, |t| depth.collided(t));
        let name = format!("{name}, {}", width::<R>());
        assert_verdict(&name, law);
        assert_verdict(&name, share);
    });
}

/// Names, a, b and lengths of ramps max(0, a + bt).
const RAMPS: [(&str, f64, f64, f64); 9] = [
    ("rising", 0.5, 3.0, 1.5),
    ("rising from zero", 0.0, 4.0, 1.25),
    ("rising from below zero", -1.0, 2.0, 2.5),
    ("falling", 3.0, -0.5, 1.0),
    ("falling to zero and on", 2.0, -2.0, 3.0),
    ("never above zero", -1.0, -2.0, 2.0),
    ("flat", 1.25, 0.0, 1.0),
    ("steep", 1.0, 16_384.0, 0.0625),
    ("falling steeply", 64.0, -16_384.0, 0.0625),
];

fn linear(a: f64, b: f64) -> Linear {
    Linear::new(a as f32, [0.0, b as f32, 0.0]).expect("a finite ramp")
}

/// The depth of max(0, a + bt) in `f64`: a trapezium over the part where it is positive.
fn depth(a: f64, b: f64, t: f64) -> f64 {
    let crossing = if b == 0.0 { f64::NAN } else { -a / b };
    let (from, to) = match (a >= 0.0, b < 0.0) {
        (true, true) => (0.0, t.min(crossing)),
        (true, false) => (0.0, t),
        (false, true) => return 0.0,
        (false, false) if b == 0.0 => return 0.0,
        (false, false) => (crossing.min(t), t),
    };
    0.5 * (to - from) * ((a + b * from).max(0.0) + (a + b * to).max(0.0))
}

#[test]
fn ramps_give_their_law() {
    for (name, a, b, t_max) in RAMPS {
        let exact = Depth::new(t_max, 1, &[-a / b], |t| (a + b * t).max(0.0));
        assert!((exact.total() - depth(a, b, t_max)).abs() <= 1e-12 * (1.0 + exact.total()));
        let from = ([0.0; 3], [0.0, 1.0, 0.0]);
        law(name, &linear(a, b), from, t_max, &exact);
    }
}

/// Flights through a field of the table that has a closed form.
fn field<M: Closed>(fixture: &Fixture, medium: &M) {
    let t_max = f64::from(fixture.ray.t_max as f32);
    let depth = Depth::new(t_max, 200, &[], fixture.along());
    let from = (fixture.ray.origin, fixture.ray.dir);
    law(&fixture.name, medium, from, t_max, &depth);
}

#[test]
fn fields_in_closed_form_give_their_law() {
    let mut fields = 0;
    for fixture in fixtures::all() {
        match fixture.field {
            Field::Linear { s0, k } => {
                let ramp = Linear::new(s0 as f32, k.map(|k| k as f32));
                field(&fixture, &ramp.expect("a finite ramp"));
            }
            Field::ExponentialZ { s0, height } => {
                let air = Exponential::new(s0 as f32, [0.0, 0.0, (1.0 / height) as f32]);
                field(&fixture, &air.expect("a valid atmosphere"));
            }
            _ => continue,
        }
        fields += 1;
    }
    assert_eq!(fields, 8);
}

/// Trackers cut a ramp into pieces; what they find is the same, from zero and below it as well.
#[test]
fn tracked_ramps_give_their_law() {
    for (name, a, b, t_max) in RAMPS {
        let exact = Depth::new(t_max, 1, &[-a / b], |t| (a + b * t).max(0.0));
        let medium = linear(a, b);
        each_width!(R, S => {
            let along: Ray<R> = ray([0.0; 3], [0.0, 1.0, 0.0]);
            let end = R::splat(t_max as f32);
            let sharp = width::<R>() == "f32";
            let (n, resolution) = if sharp { (PATHS, SHARP) } else { (PATHS / 8, COARSE) };
            let flights = collect::<R, S>(seed(19), 0, samples(n), |rng| {
                distance(delta::sample(&medium, &along, end, rng, everyone::<R>()), end)
            });
            let (law, share) = judge(flights, t_max, resolution, |t| exact.collided(t));
            let name = format!("{name}, {}", width::<R>());
            assert_verdict(&name, law);
            assert_verdict(&name, share);
        });
    }
}

/// The unit of rounding of a width.
fn rounding<R: Real>() -> f64 {
    match width::<R>() {
        "f64" => f64::EPSILON,
        _ => f64::from(f32::EPSILON),
    }
}

/// What is asked of a number, in double precision at every width.
fn ask<R: Real>(of: f64, question: impl Fn(R) -> R) -> f64 {
    f64::from(question(R::splat(of as f32)).lane(0))
}

/// Rounding of `t` moves the depth by σ_t t ε + b (t ε)², and rounding of the depth moves `t` by τ ε/σ_t.
#[test]
fn depth_and_distance_undo_each_other() {
    let mut compared = 0;
    for (name, a, b, _) in RAMPS {
        let medium = linear(a, b);
        each_width!(R, S => {
            let _: Option<S> = None;
            let along: Ray<R> = ray([0.0; 3], [0.0, 1.0, 0.0]);
            for exponent in -60..14 {
                // `lane` rounds to f32, in which the comparison is therefore made at any width.
                let epsilon = 8.0 * rounding::<R>() + f64::from(f32::EPSILON);
                let x = f64::from((1.3 * f64::from(exponent).exp2()) as f32);
                let name = format!("{name}, {x:e}, {}", width::<R>());
                let t = ask::<R>(x, |e| medium.distance(&along, e));
                let back = ask::<R>(x, |e| {
                    medium.optical_depth(&along, medium.distance(&along, e))
                });
                if t.is_finite() {
                    let sigma_t = (a + b * t).max(0.0);
                    let allowed = epsilon * (x + sigma_t * t) + b.abs() * (epsilon * t).powi(2);
                    assert!((back - x).abs() <= allowed, "{name}: depth {back:e}, allowed {allowed:e}");
                    compared += 1;
                } else {
                    let total = if b < 0.0 { (a.max(0.0)).powi(2) / (-2.0 * b) } else { 0.0 };
                    assert!(total <= x * (1.0 + 1e-6), "{name}: no distance within {total:e}");
                }
                let there = depth(a, b, x);
                let sigma_t = (a + b * x).max(0.0);
                if there > 0.0 && sigma_t > 1e-3 * there {
                    let back = ask::<R>(x, |t| {
                        medium.distance(&along, medium.optical_depth(&along, t))
                    });
                    // The depth of a short way behind the beginning of a ramp has few digits of its own.
                    let behind = (-a / b).max(0.0);
                    let allowed = epsilon * (x + behind + there / sigma_t);
                    assert!((back - x).abs() <= 4.0 * allowed, "{name}: distance {back:e}, allowed {allowed:e}");
                    compared += 1;
                }
            }
        });
    }
    assert!(compared > 2500, "{compared}");
}

#[test]
fn the_depth_is_that_of_the_trapezium() {
    let mut compared = 0;
    for (name, a, b, _) in RAMPS {
        let medium = linear(a, b);
        each_width!(R, S => {
            let _: Option<S> = None;
            let along: Ray<R> = ray([0.0; 3], [0.0, 1.0, 0.0]);
            for exponent in -60..14 {
                let t = f64::from((1.7 * f64::from(exponent).exp2()) as f32);
                let exact = depth(a, b, t);
                let found = ask::<R>(t, |t| medium.optical_depth(&along, t));
                let sigma_t = (a + b * t).max(0.0);
                let epsilon = f64::from(f32::EPSILON);
                let allowed = epsilon * (2.0 * exact + sigma_t * t) + b.abs() * (epsilon * t).powi(2);
                assert!(
                    (found - exact).abs() <= allowed,
                    "{name}, {t:e}, {}: {found:e} for {exact:e}, allowed {allowed:e}",
                    width::<R>()
                );
                compared += 1;
            }
        });
    }
    assert!(compared > 1500, "{compared}");
}

/// However far a ramp goes, a tracker passes it in few pieces; and no end at all is an end.
#[test]
fn endless_ramps_end() {
    for (name, a, b, _) in RAMPS {
        let medium = linear(a, b);
        let along: Ray<f32> = ray([0.0; 3], [0.0, 1.0, 0.0]);
        let mut walk = Medium::<f32>::idle(&medium);
        medium.begin(&mut walk, &along, true);
        let mut pieces = 0;
        while Medium::<f32>::segment(&medium, &walk).t_exit < 1e30 {
            let from = Medium::<f32>::segment(&medium, &walk).t_exit;
            Medium::<f32>::next_segment(&medium, &mut walk, true);
            let to = Medium::<f32>::segment(&medium, &walk).t_exit;
            assert!(to > from, "{name}: a piece from {from:e} to {to:e}");
            pieces += 1;
            assert!(pieces < 300, "{name}: {pieces} pieces");
        }
        let total = depth(a, b, 1e30);
        for sample in 0..100 {
            let mut rng = PathStream::new(Key {
                sample,
                ..Key::default()
            });
            let flight = delta::sample(&medium, &along, f32::INFINITY, &mut rng, true);
            let (may, must) = (total > 0.0, total > 100.0);
            assert!(
                flight.collided && may || !flight.collided && !must,
                "{name}: {flight:?} of {total}"
            );
        }
    }
}
