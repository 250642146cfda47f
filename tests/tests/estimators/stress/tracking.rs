//! Flights and walks from depths of 10⁻¹² to 10¹².

use super::{Worst, along_x, stream};
use woodcock_core::collision::roulette;
use woodcock_core::free_flight::{analytic, decomposition, delta, regular, weighted};
use woodcock_core::majorant::{Advance, Tracker};
use woodcock_core::medium::{Audited, Homogeneous, Medium, Procedural};
use woodcock_core::real::{Mask, Real, Word32};
use woodcock_core::stream::{KeyedStream, PathStream, Stream};
use woodcock_core::transmittance::ratio;
use woodcock_core::vec3::Vec3;
use woodcock_packet::bits::LaneStream;
use woodcock_packet::lanes::Lanes;
use woodcock_tests::stats::{KILL_Z, Sample, assert_agrees, judge, must_kill, samples};
use woodcock_tests::widths::{everyone, ray};

/// Some words, and then one for ever.
struct Digits<'a> {
    head: &'a [u32],
    tail: u32,
}

impl Stream<f32> for Digits<'_> {
    fn next_word(&mut self, _: bool) -> Word32 {
        let Some((first, rest)) = self.head.split_first() else {
            return Word32(self.tail);
        };
        self.head = rest;
        Word32(*first)
    }
}

/// P(yes) over all words of a stream, for a question that small words answer with yes: a search for the first
/// digit (to the base 2³²) where that ends, another for the second, and so on.
///
/// First words whose 24 top bits are ones, which mean flights beyond 16 mean free paths, are taken for no.
fn probability(yes: impl Fn(&mut Digits<'_>) -> bool) -> f64 {
    let (mut head, mut end, mut weight, mut p) = (Vec::new(), 0xffff_ff00_u64, 1.0, 0.0);
    while head.len() < 4 {
        weight /= 4_294_967_296.0;
        head.push(0);
        let digit = head.len() - 1;
        let (mut low, mut high) = (0, end);
        while low < high {
            let middle = (low + high) / 2;
            head[digit] = middle as u32;
            if yes(&mut Digits {
                head: &head,
                tail: u32::MAX,
            }) {
                low = middle + 1;
            } else {
                high = middle;
            }
        }
        p += low as f64 * weight;
        head[digit] = low as u32;
        if low == end
            || !yes(&mut Digits {
                head: &head,
                tail: 0,
            })
        {
            break;
        }
        end = 1 << 32;
    }
    p
}

/// A sampler of flights through fog, under its own bound, which is tight.
type Flight = fn(f32, f32, &mut Digits<'_>) -> bool;

fn fog(sigma_t: f32) -> Homogeneous {
    Homogeneous::new(sigma_t).expect("a valid extinction")
}

/// The same extinction under a bound that does not know it is tight.
fn formula<R: Real>(sigma_t: f32) -> Procedural<impl Fn(Vec3<R>) -> R> {
    Procedural::new(move |_: Vec3<R>| R::splat(sigma_t), sigma_t)
}

const FLIGHTS: [(&str, Flight); 8] = [
    ("analytic", |s, t, rng| {
        analytic::sample(&fog(s), &along_x(), t, rng, true).collided
    }),
    ("regular", |s, t, rng| {
        regular::sample(&fog(s), &along_x(), t, rng, true).collided
    }),
    ("delta", |s, t, rng| {
        delta::sample(&fog(s), &along_x(), t, rng, true).collided
    }),
    ("decomposition", |s, t, rng| {
        decomposition::sample(&fog(s), &along_x(), t, rng, true).collided
    }),
    ("weighted", |s, t, rng| {
        weighted::sample(&fog(s), &along_x(), t, rng, true)
            .flight
            .collided
    }),
    ("delta through a formula", |s, t, rng| {
        delta::sample(&formula::<f32>(s), &along_x(), t, rng, true).collided
    }),
    ("decomposition through a formula", |s, t, rng| {
        decomposition::sample(&formula::<f32>(s), &along_x(), t, rng, true).collided
    }),
    ("weighted through a formula", |s, t, rng| {
        weighted::sample(&formula::<f32>(s), &along_x(), t, rng, true)
            .flight
            .collided
    }),
];

/// The error of P(collision) over extinctions from 10⁻³⁰ to 10³⁰.
fn collisions(collided: impl Fn(f32, f32, &mut Digits<'_>) -> bool) -> Worst {
    let mut worst = Worst::default();
    for sigma_t in (-30..=30).step_by(6).map(|e| 10.0_f64.powi(e) as f32) {
        for depth in [1e-12_f32, 3e-10, 1e-9, 1e-6, 1e-3, 0.3, 1.0, 3.0] {
            let t = depth / sigma_t;
            if !(1e-37..1e30).contains(&t) {
                continue;
            }
            let exact = -(-f64::from(sigma_t) * f64::from(t)).exp_m1();
            let p = probability(|rng| collided(sigma_t, t, rng));
            worst.see((p / exact - 1.0).abs(), || {
                format!("sigma_t {sigma_t:e}, depth {depth:e}: {p:e}")
            });
        }
    }
    worst
}

#[test]
fn rare_collisions_have_their_probability() {
    const BOUND: f64 = 5e-7;
    for (name, flight) in FLIGHTS {
        collisions(flight).within(name, BOUND, 70);
    }
    // A uniform number on the grid of 2⁻²⁴ puts 6e-8 of all flights on the origin.
    let coarse = |sigma_t: f32, t: f32, rng: &mut Digits<'_>| {
        Stream::<f32>::uniform(rng, true).neg_ln_1m() / sigma_t < t
    };
    collisions(coarse).must_fail("-ln(1 - u) on a grid", BOUND);
    let cancelling = |sigma_t: f32, t: f32, rng: &mut Digits<'_>| {
        -(1.0 - Stream::<f32>::uniform_fine(rng, true)).ln() / sigma_t < t
    };
    collisions(cancelling).must_fail("ln of 1 - u", BOUND);
}

/// Errors of the survival of weights under a threshold, and of what survivors weigh.
fn survivals(roulette: impl Fn(f32, f32, &mut Digits<'_>) -> f32) -> Worst {
    let mut worst = Worst::default();
    for threshold in [1e-30_f32, 1e-3, 0.3, 1.0, 1e30] {
        for ratio in [1e-12_f32, 3e-10, 1e-6, 0.01, 0.7, 0.999] {
            let weight = threshold * ratio;
            if weight < 1e-37 {
                continue;
            }
            let exact = f64::from(weight) / f64::from(threshold);
            let p = probability(|rng| roulette(weight, threshold, rng) > 0.0);
            let survivor = roulette(
                weight,
                threshold,
                &mut Digits {
                    head: &[0, 0, 0],
                    tail: 1,
                },
            );
            let weighs = f64::from(weight * survivor) / f64::from(threshold);
            let error = (p / exact - 1.0).abs().max((weighs - 1.0).abs());
            worst.see(error, || format!("{weight:e} below {threshold:e}: {p:e}"));
        }
    }
    worst
}

#[test]
fn roulette_is_fair_to_small_weights() {
    const BOUND: f64 = 5e-7;
    let fair =
        |weight: f32, threshold: f32, rng: &mut Digits<'_>| roulette(weight, threshold, rng, true);
    survivals(fair).within("roulette", BOUND, 25);
    let coarse = |weight: f32, threshold: f32, rng: &mut Digits<'_>| {
        let survives = Stream::<f32>::uniform(rng, true) * threshold < weight;
        if survives { threshold / weight } else { 0.0 }
    };
    survivals(coarse).must_fail("roulette on a grid", BOUND);
}

/// At a depth of 10¹², flights that begin with any number of words at the top collide.
#[test]
fn opaque_media_let_nothing_pass() {
    for (name, flight) in FLIGHTS {
        for sigma_t in [1e-3_f32, 1.0, 1e30] {
            for top in 0..100 {
                let mut head = vec![u32::MAX; top];
                head.extend([1 << 31, 1 << 30]);
                let mut rng = Digits {
                    head: &head,
                    tail: 1 << 29,
                };
                assert!(
                    flight(sigma_t, 1e12 / sigma_t, &mut rng),
                    "{name}, {sigma_t:e}, {top}"
                );
            }
        }
    }
}

/// Mean free paths at a depth of 10¹², and that all collide.
fn mean_free_paths<R: Real, S: KeyedStream<R>>(sigma_t: f32, which: usize) -> Sample {
    let (all, t_max) = (everyone::<R>(), R::splat(1e12 / sigma_t));
    let along = ray::<R>([0.0; 3], [1.0, 0.0, 0.0]);
    woodcock_tests::widths::sample(0xdee9 + which as u64, 0, samples(1 << 15), |rng: &mut S| {
        let loose = Procedural::new(move |_: Vec3<R>| R::splat(0.25 * sigma_t), sigma_t)
            .with_control(0.125 * sigma_t, 0.25 * sigma_t);
        let (flight, unit) = match which {
            0 => (
                analytic::sample(&fog(sigma_t), &along, t_max, rng, all),
                1.0,
            ),
            1 => (regular::sample(&fog(sigma_t), &along, t_max, rng, all), 1.0),
            2 => (delta::sample(&fog(sigma_t), &along, t_max, rng, all), 1.0),
            3 => (delta::sample(&loose, &along, t_max, rng, all), 0.25),
            4 => (decomposition::sample(&loose, &along, t_max, rng, all), 0.25),
            _ => (
                weighted::sample(&loose, &along, t_max, rng, all).flight,
                0.25,
            ),
        };
        assert!(flight.collided.all(), "a flight left at a depth of 1e12");
        flight.t * R::splat(unit * sigma_t)
    })
}

#[test]
fn opaque_media_have_their_mean_free_path() {
    for which in 0..6 {
        for sigma_t in [1e-15_f32, 1.0, 1e27] {
            let name = format!("flight {which} at {sigma_t:e}");
            assert_agrees(
                &name,
                &mean_free_paths::<f32, PathStream>(sigma_t, which),
                1.0,
                0.01,
            );
        }
        assert_agrees(
            "lanes",
            &mean_free_paths::<Lanes, LaneStream>(1e9, which),
            1.0,
            0.01,
        );
    }
    let found = mean_free_paths::<f32, PathStream>(1.0, 3);
    must_kill(
        "a mean free path off by a tenth",
        judge(found.moments(), 1.1, 0.01),
    );
}

/// Tentative collisions on a ray of this majorant depth, through nothing under a bound.
fn collisions_on_a_ray<R: Real, S: KeyedStream<R>>(depth: f32) -> f64 {
    let nothing = Audited::new(Procedural::new(|_: Vec3<R>| R::zero(), depth));
    let mut rng = S::idle();
    (0..R::LANES).for_each(|lane| {
        rng.set_key(
            lane,
            woodcock_core::stream::Key {
                seed: 3,
                pixel: 1,
                sample: lane as u32,
            },
        );
    });
    let along = ray::<R>([0.0; 3], [1.0, 0.0, 0.0]);
    let weight = ratio::estimate(&nothing, &along, R::one(), &mut rng, everyone::<R>());
    assert!(
        (0..R::LANES).all(|lane| weight.lane(lane) == 1.0),
        "nothing was in the way"
    );
    nothing.lookups() as f64 / R::LANES as f64
}

/// The same with a distance in a single number, as a beginner keeps it.
fn in_one_number(depth: f32) -> f64 {
    let (mut t, mut count, mut rng) = (0.0_f32, 0_u32, stream(3));
    loop {
        let step: f32 = rng.exponential(true);
        t += step / depth;
        // It stalls, so that a beginner's loop might not even end.
        if t >= 1.0 || f64::from(count) > 3.0 * f64::from(depth) {
            return count.into();
        }
        count += 1;
    }
}

#[test]
fn ten_million_collisions_on_a_ray_do_not_stall() {
    let deviates = |count: f64, depth: f32| (count - f64::from(depth)) / f64::from(depth).sqrt();
    for depth in [1e4_f32, 1e6, 1e7] {
        let z = deviates(collisions_on_a_ray::<f32, PathStream>(depth), depth);
        assert!(z.abs() < 4.892, "depth {depth:e}: {z}");
    }
    let z = deviates(collisions_on_a_ray::<Lanes, LaneStream>(3e5), 3e5) * 8.0_f64.sqrt();
    assert!(z.abs() < 4.892, "lanes: {z}");
    let z = deviates(in_one_number(1e7), 1e7);
    assert!(
        z.abs() > KILL_Z,
        "a distance in one number, and only {z} off"
    );
}

/// Steps of a tracker at the ends of its ranges: it never goes back, never beyond, and says where it stands.
#[test]
fn steps_are_monotone() {
    for sigma_t in [f32::from_bits(1), 1e-38, 1e-30, 1.0, 1e30] {
        for t_max in [
            f32::from_bits(1),
            1e-30_f32,
            1e-15,
            1.0,
            1e15,
            1e30,
            f32::INFINITY,
        ] {
            let loose = Procedural::new(|_: Vec3<f32>| 0.0, sigma_t);
            let mut tracker = Tracker::<f32, _>::idle(Medium::<f32>::idle(&loose));
            let mut rng = stream(9);
            loose.begin(&mut tracker.walk, &along_x(), true);
            tracker.begin(t_max, &mut rng, true);
            let mut before = 0.0;
            for _ in 0..1000 {
                let Advance {
                    tentative, left, ..
                } = tracker.advance(&loose, true);
                let t = tracker.t();
                assert!(
                    before <= t && t <= t_max,
                    "{sigma_t:e}, {t_max:e}: {t:e} after {before:e}"
                );
                assert!(tentative != left, "one segment: either");
                before = t;
                if left {
                    assert_eq!(t, t_max.min(1e30));
                    break;
                }
                tracker.redraw(&mut rng, true);
            }
        }
    }
}
