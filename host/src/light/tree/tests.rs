//! The tree against what it claims: shares that sum to one, the same in both walks, and no light left in the dark.

use std::f64::consts::{FRAC_PI_2, PI};

use super::*;
use crate::light::direction::uniform;

/// SplitMix64 [Steele, Lea, Flood 2014] would do; a linear congruence with the high bits does here.
struct Numbers(u64);

impl Numbers {
    fn next(&mut self) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) as f64 / (1_u64 << 31) as f64
    }

    fn place(&mut self, size: f64) -> DVec3 {
        (DVec3::new(self.next(), self.next(), self.next()) - 0.5) * size
    }

    fn direction(&mut self) -> DVec3 {
        uniform([self.next(), self.next()])
    }
}

/// Small disks, cones and points at random; some on top of each other, some of hardly any strength.
fn lights(count: usize, numbers: &mut Numbers) -> Vec<Extent> {
    (0..count)
        .map(|i| {
            let at = if i % 7 == 3 {
                DVec3::ONE
            } else {
                numbers.place(10.0)
            };
            let half = if i % 3 == 0 {
                numbers.place(1.0).abs()
            } else {
                DVec3::ZERO
            };
            Extent {
                low: at - half,
                high: at + half,
                axis: numbers.direction(),
                spread: [0.0, 0.4, PI][i % 3],
                reach: if i % 5 == 0 { 0.1 } else { FRAC_PI_2 },
                strength: if i % 11 == 0 {
                    1e-9
                } else {
                    0.1 + numbers.next()
                },
                two_sided: i % 4 == 0,
            }
        })
        .collect()
}

fn places(extents: &[Extent], numbers: &mut Numbers) -> Vec<(DVec3, DVec3)> {
    let mut places = vec![(DVec3::ONE, DVec3::Y), (DVec3::splat(1e12), DVec3::ZERO)];
    for i in 0..60 {
        let size = if i % 2 == 0 { 12.0 } else { 200.0 };
        let normal = if i % 3 == 0 {
            DVec3::ZERO
        } else {
            numbers.direction()
        };
        places.push((numbers.place(size), normal));
    }
    // On lights, in front of and behind them.
    for extent in extents.iter().take(20) {
        let centre = extent.centre();
        for at in [-1.0, 0.0, 1e-9, 1.0] {
            places.push((centre + extent.axis * at, extent.axis));
        }
    }
    places
}

#[test]
fn the_shares_of_all_lights_sum_to_one_everywhere() {
    let mut numbers = Numbers(1);
    for count in [1, 2, 3, 10, 200] {
        let extents = lights(count, &mut numbers);
        let tree = Tree::new(&extents, 10.0);
        for (from, normal) in places(&extents, &mut numbers) {
            let shares = (0..count as u32).map(|item| tree.probability(item, from, normal));
            let sum: f64 = shares.sum();
            assert!((sum - 1.0).abs() < 1e-12, "{count} {from} {sum}");
        }
        assert_eq!(
            tree.probability(count as u32, DVec3::ZERO, DVec3::ZERO),
            0.0
        );
    }
}

#[test]
fn the_choice_reports_the_bits_of_the_probability() {
    let mut numbers = Numbers(2);
    let extents = lights(200, &mut numbers);
    let tree = Tree::new(&extents, 10.0);
    for (from, normal) in places(&extents, &mut numbers) {
        for _ in 0..20 {
            let u = numbers.next();
            let (item, share, rest) = tree.choose(from, normal, u).expect("lights");
            assert_eq!(
                share.to_bits(),
                tree.probability(item, from, normal).to_bits()
            );
            assert!(share > 0.0 && (0.0..1.0).contains(&rest));
        }
        for u in [0.0, BELOW_ONE] {
            let (_, share, rest) = tree.choose(from, normal, u).expect("lights");
            assert!(share > 0.0 && (0.0..1.0).contains(&rest));
        }
    }
}

/// The smallest angle at which a light may be seen from a place to shine along one of its axes.
fn may_shine(light: &Extent, from: DVec3, numbers: &mut Numbers) -> bool {
    (0..40).any(|_| {
        let within = DVec3::new(numbers.next(), numbers.next(), numbers.next());
        let at = light.low + (light.high - light.low) * within;
        let Some(towards) = (from - at).try_normalize() else {
            return false;
        };
        let angle = libm::acos(light.axis.dot(towards).clamp(-1.0, 1.0));
        let angle = if light.two_sided {
            angle.min(PI - angle)
        } else {
            angle
        };
        angle < light.spread + light.reach
    })
}

#[test]
fn no_light_that_may_shine_is_left_out() {
    let mut numbers = Numbers(3);
    let extents = lights(200, &mut numbers);
    let tree = Tree::new(&extents, 10.0);
    let (mut lit, mut dark) = (0, 0);
    for (from, normal) in places(&extents, &mut numbers) {
        for (item, light) in (0_u32..).zip(&extents) {
            let share = tree.probability(item, from, normal);
            if may_shine(light, from, &mut numbers) {
                lit += 1;
                assert!(share > 0.0, "light {item} {light:?} at {from}");
            } else if share == 0.0 {
                dark += 1;
            }
        }
    }
    assert!(lit > 5000 && dark > 1000, "{lit} {dark}");
}

#[test]
fn lights_in_one_place_make_no_deep_tree() {
    let one = Extent {
        low: DVec3::ONE,
        high: DVec3::ONE,
        axis: DVec3::Z,
        spread: PI,
        reach: FRAC_PI_2,
        strength: 1.0,
        two_sided: false,
    };
    let tree = Tree::new(&vec![one; 1000], 1.0);
    let share = tree.probability(777, DVec3::ZERO, DVec3::ZERO);
    assert!((share - 1e-3).abs() < 1e-12, "{share}");
    // Powers of two apart, so that each split takes off one: halving takes over before the ways are full.
    let row: Vec<Extent> = (0..200)
        .map(|i| {
            let at = DVec3::X * 0.5_f64.powi(5 * i);
            Extent {
                low: at,
                high: at,
                ..one
            }
        })
        .collect();
    let tree = Tree::new(&row, 1.0);
    let sum: f64 = (0..200)
        .map(|i| tree.probability(i, DVec3::Y, DVec3::ZERO))
        .sum();
    assert!((sum - 1.0).abs() < 1e-12);
}

#[test]
fn near_lights_are_asked_more_often() {
    let mut numbers = Numbers(5);
    let mut extents = lights(50, &mut numbers);
    for extent in &mut extents {
        (extent.spread, extent.reach, extent.strength) = (PI, FRAC_PI_2, 1.0);
    }
    extents[20].low = DVec3::splat(30.0);
    extents[20].high = DVec3::splat(30.0);
    let tree = Tree::new(&extents, 10.0);
    let near = DVec3::splat(29.9);
    assert!(tree.probability(20, near, DVec3::ZERO) > 0.9);
    assert!(tree.probability(20, DVec3::splat(-30.0), DVec3::ZERO) < 0.02);
}
