//! Formulas made of the operations: vectors, clipping, cameras, deflections, collisions.

use super::operations::same;
use woodcock_core::camera::{Camera, Projection};
use woodcock_core::collision::{Chromatic, roulette};
use woodcock_core::light::constant;
use woodcock_core::ray::{Ray, clip_to_box, clip_to_unit_sphere};
use woodcock_core::real::{Mask, Real};
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
fn cameras_and_collisions_agree() {
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
        let event = Chromatic {
            sigma_t: Lanes::new(x) * Lanes::splat(0.005),
            majorant: Lanes::one(),
            colour: Vec3::splat([1.0, 0.5, 0.1]),
        };
        let ray = camera.ray(Lanes::new(x), Lanes::splat(7.0), &mut wide, active);
        let (real, weight) = event.decide(Vec3::splat([0.3, 0.9, 0.5]), &mut wide, active);
        let factor = roulette(event.sigma_t, Lanes::splat(0.5), &mut wide, active);
        for (lane, single) in singles
            .iter_mut()
            .enumerate()
            .filter(|(l, _)| active.lane(*l))
        {
            let one_ray = camera.ray(x[lane], 7.0, single, true);
            let event = Chromatic {
                sigma_t: x[lane] * 0.005,
                majorant: 1.0,
                colour: Vec3::splat([1.0, 0.5, 0.1]),
            };
            let (one_real, one_weight) = event.decide(Vec3::splat([0.3, 0.9, 0.5]), single, true);
            let one_factor = roulette(event.sigma_t, 0.5, single, true);
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
                same(
                    "weight",
                    weight.lane(lane)[a],
                    one_weight.lane(0)[a],
                    &round,
                );
            }
            assert_eq!(real.lane(lane), one_real);
            same("roulette", factor.lane(lane), one_factor, &round);
        }
    }
}
