//! Formulas made of the operations: vectors, clipping, cameras, deflections, roulette, decisions in colour.

use super::operations::same;
use woodcock_core::camera::{Camera, Projection};
use woodcock_core::collision::roulette;
use woodcock_core::light::constant;
use woodcock_core::ray::{Ray, clip_to_box, clip_to_unit_sphere};
use woodcock_core::real::{Mask, Real};
use woodcock_core::spectral::{
    Decision, Spectrum, Tentative, hero::Hero, history_aware, history_aware::HistoryAware,
    weighted::Weighted,
};
use woodcock_core::stream::{Key, KeyedStream, PathStream};
use woodcock_core::vec3::Vec3;
use woodcock_packet::bits::LaneStream;
use woodcock_packet::lanes::{LANES, LaneMask, Lanes};
use woodcock_tests::stats::independent::SplitMix;

#[test]
fn geometry_agrees() {
    let mut rng = SplitMix::new(99);
    let spread =
        |rng: &mut SplitMix| (rng.normal() * 10.0_f64.powi((rng.bits() % 7) as i32 - 3)) as f32;
    for round in 0..20_000 {
        let vector = |rng: &mut SplitMix| -> [[f32; 3]; LANES] {
            std::array::from_fn(|_| {
                std::array::from_fn(|a| {
                    if round % 5 == a {
                        [0.0, -0.0][round % 2]
                    } else {
                        spread(rng)
                    }
                })
            })
        };
        let (origin, direction) = (vector(&mut rng), vector(&mut rng));
        let unit: [[f32; 3]; LANES] = std::array::from_fn(|_| {
            let d = woodcock_tests::grids::unit([rng.normal(), rng.normal(), rng.normal()]);
            d.map(|v| v as f32)
        });
        let cosine: [f32; LANES] = std::array::from_fn(|_| (2.0 * rng.uniform() - 1.0) as f32);
        let turn: [f32; LANES] = std::array::from_fn(|_| rng.uniform() as f32);
        let wide = |v: &[[f32; 3]; LANES]| {
            let mut w = Vec3::<Lanes>::uniform(0.0);
            for (lane, &v) in v.iter().enumerate() {
                w.set_lane(lane, v);
            }
            w
        };
        let one = |v: [f32; 3]| Vec3::<f32>::splat(v);
        let ray = Ray {
            origin: wide(&origin),
            direction: wide(&direction),
        };
        let size = [3.0, 0.5, 100.0];
        let boxed = clip_to_box(ray.origin, ray.direction, Vec3::splat(size));
        let ball = clip_to_unit_sphere(ray.origin, ray.direction);
        let turned = wide(&unit).deflected(Lanes::new(cosine), Lanes::new(turn));
        let sky = constant::sample(Lanes::new(turn), Lanes::new(cosine).abs());
        for lane in 0..LANES {
            let (o, d) = (one(origin[lane]), one(direction[lane]));
            let inputs = (
                origin[lane],
                direction[lane],
                unit[lane],
                cosine[lane],
                turn[lane],
            );
            let b = clip_to_box(o, d, Vec3::splat(size));
            same("box", boxed.t0.lane(lane), b.t0, &inputs);
            same("box", boxed.t1.lane(lane), b.t1, &inputs);
            let b = clip_to_unit_sphere(o, d);
            same("sphere", ball.t0.lane(lane), b.t0, &inputs);
            same("sphere", ball.t1.lane(lane), b.t1, &inputs);
            let t = one(unit[lane]).deflected(cosine[lane], turn[lane]).lane(0);
            let s = constant::sample(turn[lane], Real::abs(cosine[lane])).lane(0);
            for a in 0..3 {
                same("deflection", turned.lane(lane)[a], t[a], &inputs);
                same("sky", sky.lane(lane)[a], s[a], &inputs);
            }
            let length: f64 = t.map(|v| f64::from(v) * f64::from(v)).iter().sum();
            let along: f64 = (0..3)
                .map(|a| f64::from(t[a]) * f64::from(unit[lane][a]))
                .sum();
            assert!((length - 1.0).abs() < 5e-7, "{inputs:?}: length {length}");
            assert!(
                (along - f64::from(cosine[lane])).abs() < 1e-6,
                "{inputs:?}: cosine {along}"
            );
        }
    }
}

/// A keyed stream per lane, and each lane's own scalar one.
fn streams(round: u32) -> (LaneStream, [PathStream; LANES]) {
    let key = |lane: usize| Key {
        seed: 100,
        pixel: round,
        sample: lane as u32,
    };
    let mut wide = <LaneStream as KeyedStream<Lanes>>::idle();
    for lane in 0..LANES {
        wide.set_key(lane, key(lane));
    }
    (wide, std::array::from_fn(|lane| PathStream::new(key(lane))))
}

#[test]
fn cameras_and_roulette_agree() {
    let mut rng = SplitMix::new(101);
    for round in 0..2000_u32 {
        let (mut wide, mut singles) = streams(round);
        let active = LaneMask::from_bits(rng.bits() as u32 & 255);
        let camera = Camera {
            projection: if round % 2 == 0 {
                Projection::Perspective
            } else {
                Projection::Orthographic
            },
            screen: [[-1.0, 0.01], [0.7, -0.01]],
            camera_to_world: [
                [0.6, 0.8, 0.0, 1.0],
                [-0.8, 0.6, 0.0, 2.0],
                [0.0, 0.0, 1.0, 3.0],
            ],
            lens_radius: if round % 3 == 0 { 0.0 } else { 0.3 },
            focal_distance: 4.0,
        };
        let x: [f32; LANES] = std::array::from_fn(|_| (rng.bits() % 200) as f32);
        let weight = Lanes::new(x) * Lanes::splat(0.005);
        let ray = camera.ray(Lanes::new(x), Lanes::splat(7.0), &mut wide, active);
        let factor = roulette(weight, Lanes::splat(0.5), &mut wide, active);
        for (lane, single) in singles
            .iter_mut()
            .enumerate()
            .filter(|(l, _)| active.lane(*l))
        {
            let one_ray = camera.ray(x[lane], 7.0, single, true);
            let one_factor = roulette(x[lane] * 0.005, 0.5, single, true);
            for a in 0..3 {
                same(
                    "origin",
                    ray.origin.lane(lane)[a],
                    one_ray.origin.lane(0)[a],
                    &round,
                );
                same(
                    "direction",
                    ray.direction.lane(lane)[a],
                    one_ray.direction.lane(0)[a],
                    &round,
                );
            }
            same("roulette", factor.lane(lane), one_factor, &round);
        }
    }
}

/// A colour of each kind: opaque, clear, in between.
fn colour(rng: &mut SplitMix) -> f32 {
    [1.0, 0.0, 0.01, rng.uniform() as f32][(rng.bits() % 4) as usize]
}

/// Many decisions in a row, in changing lanes, by lanes and by each lane's own scalar path.
fn decisions<const N: usize, A: Decision<Lanes, N>, B: Decision<f32, N> + Clone>(
    name: &str,
    mut eight: A,
    one: &B,
) {
    let mut rng = SplitMix::new(102);
    let all = LaneMask::splat(true);
    for round in 0..100_u32 {
        let (mut wide, mut singles) = streams(1 << 20 | round);
        let mut ones: [B; LANES] = std::array::from_fn(|_| one.clone());
        eight.begin(&mut wide, all);
        for (one, single) in ones.iter_mut().zip(&mut singles) {
            one.begin(single, true);
        }
        let mut outcomes = [0_u32; 2];
        for _ in 0..30 {
            let active = LaneMask::from_bits(rng.bits() as u32 & 255);
            let sigma_t: [f32; LANES] = std::array::from_fn(|_| rng.uniform() as f32);
            let colours: [[f32; LANES]; N] =
                std::array::from_fn(|_| std::array::from_fn(|_| colour(&mut rng)));
            let event = Tentative {
                sigma_t: Lanes::new(sigma_t),
                majorant: Lanes::splat(1.01),
                colour: Spectrum(colours.map(Lanes::new)),
            };
            let real = eight.decide(&event, &mut wide, active);
            for (lane, one) in ones.iter_mut().enumerate() {
                if active.lane(lane) {
                    let event = Tentative {
                        sigma_t: sigma_t[lane],
                        majorant: 1.01,
                        colour: Spectrum(colours.map(|c| c[lane])),
                    };
                    let one_real = one.decide(&event, &mut singles[lane], true);
                    assert_eq!(real.lane(lane), one_real, "{name}, {N}");
                    outcomes[usize::from(one_real)] += 1;
                } else {
                    assert!(!real.lane(lane), "{name}, {N}: a decision for no one");
                }
                let (wide, one) = (eight.weight().lane(lane), one.weight().lane(0));
                for (w, o) in wide.into_iter().zip(one) {
                    same(name, w, o, &(round, N));
                }
            }
        }
        assert!(outcomes.iter().all(|&n| n > 0), "{name}: {outcomes:?}");
    }
}

#[test]
fn decisions_in_colour_agree() {
    fn all<const N: usize>() {
        decisions::<N, _, _>("history-aware", HistoryAware::idle(), &HistoryAware::idle());
        decisions::<N, _, _>("hero", Hero::idle(), &Hero::idle());
        decisions::<N, _, _>(
            "weighted",
            Weighted::new(|e: &Tentative<Lanes, N>, _| Lanes::splat(0.1) + e.sigma_t * e.sigma_t),
            &Weighted::new(|e: &Tentative<f32, N>, _| 0.1 + e.sigma_t * e.sigma_t),
        );
    }
    all::<1>();
    all::<3>();
    all::<4>();
    all::<8>();
}

/// Three wavelengths are three colours: a spectrum has the bits of a vector's operations.
#[test]
fn three_wavelengths_are_a_vector() {
    let mut rng = SplitMix::new(103);
    for round in 0..10_000 {
        let mut number = || (rng.normal() * 3.0) as f32;
        let mut vector = || Vec3::new(number(), number(), number());
        let (a, b) = (vector(), vector());
        let (s, t) = (Spectrum::from(a), Spectrum::from(b));
        let factor = a.x;
        same("sum", s.sum(), a.sum(), &round);
        let scaled = (s.times(t) * factor, a.times(b) * factor);
        for (s, v) in scaled.0.lane(0).into_iter().zip(scaled.1.lane(0)) {
            same("product", s, v, &round);
        }
        assert_eq!(Vec3::from(s), a);
    }
}

/// What the renderer relies on: a decision from given weights is that of the path's own state.
#[test]
fn a_decision_is_that_of_its_state() {
    for round in 0..1000 {
        let (_, [mut a, mut b, ..]) = streams(round);
        b.clone_from(&a);
        let event = Tentative {
            sigma_t: 0.7_f32,
            majorant: 1.0,
            colour: Spectrum([1.0, 0.5, 0.1]),
        };
        let mut state = HistoryAware::idle();
        state.begin(&mut a, true);
        let real = state.decide(&event, &mut a, true);
        let (found, weight) = history_aware::decide(&event, Spectrum([1.0; 3]), &mut b, true);
        assert_eq!((found, weight), (real, state.weight()));
    }
}
