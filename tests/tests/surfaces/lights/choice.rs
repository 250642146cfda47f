//! The choice among lights: probabilities that sum to one, and sums that it does not bias.

use super::*;
use woodcock_tests::stats::{Mutants, Sample, judge, samples, seed};

const N: usize = 1 << 17;

fn random_direction(rng: &mut SplitMix) -> DVec3 {
    sphere(uniforms(rng))
}

fn random_place(rng: &mut SplitMix, size: f64) -> DVec3 {
    (DVec3::from(uniforms::<3>(rng)) - 0.5) * size
}

/// Points and spots within the bounds, some at one place, some weak, some dark.
fn many(count: usize, rng: &mut SplitMix) -> Vec<Light> {
    (0..count)
        .map(|i| {
            let at = if i % 9 == 4 {
                DVec3::ONE
            } else {
                random_place(rng, 5.0)
            };
            let strength = match i % 13 {
                0 => 1e-6,
                7 => 0.0,
                _ => 0.5 + rng.uniform(),
            };
            let intensity = [strength, 0.3 * strength, 0.7 * strength];
            if i % 2 == 0 {
                point(at, intensity)
            } else {
                spot(
                    at,
                    random_direction(rng),
                    [0.8, [0.2, -0.5, 0.8][i % 3]],
                    intensity,
                )
            }
        })
        .collect()
}

fn far_away() -> [Light; 4] {
    [
        distant(DVec3::new(1.0, 1.0, 0.5), [2.0; 3]),
        constant([0.0; 3]),
        constant([0.1, 0.2, 0.3]),
        image("sky.exr", turned()),
    ]
}

/// Everything at once, in an order that mixes kinds.
fn everything(rng: &mut SplitMix) -> Setting {
    let mut lights = many(60, rng);
    for (i, light) in far_away().into_iter().enumerate() {
        lights.insert(7 * i, light);
    }
    Setting::new(lights).file("sky.exr", picture([8, 4], |x, y| f64::from(x * y)))
}

/// Irradiance on a surface, from the side of its normal, or in space the fluence; from one light, in closed form.
fn truth(light: &Light, from: DVec3, normal: DVec3) -> f64 {
    let cosine = |d: DVec3| {
        if normal == DVec3::ZERO {
            1.0
        } else {
            normal.dot(d).max(0.0)
        }
    };
    let from = from + ORIGIN;
    match light {
        Light::Point(light) => {
            let to = light.position - from;
            mean(light.intensity) * cosine(to.normalize()) / to.length_squared()
        }
        Light::Spot(light) => {
            let to = light.position - from;
            let cos = -light.axis.dot(to.normalize());
            let width = light.cos_falloff_start - light.cos_total_width;
            let x = if width > 0.0 {
                ((cos - light.cos_total_width) / width).clamp(0.0, 1.0)
            } else {
                f64::from(cos >= light.cos_falloff_start)
            };
            let edge = x * x * (3.0 - 2.0 * x);
            mean(light.intensity) * edge * cosine(to.normalize()) / to.length_squared()
        }
        Light::Distant(light) => mean(light.irradiance) * cosine(light.direction_to_light),
        Light::Constant(light) => mean(light.radiance) * PI,
        Light::Image(_) | Light::Goniometric(_) => unreachable!("not in these scenes"),
    }
}

fn places(setting: &Setting, rng: &mut SplitMix) -> Vec<(DVec3, DVec3)> {
    let mut places = vec![
        (DVec3::ONE, DVec3::X),
        (DVec3::splat(1e9), DVec3::ZERO),
        (BOUNDS.centre, DVec3::ZERO),
    ];
    for i in 0..60 {
        let normal = if i % 3 == 0 {
            DVec3::ZERO
        } else {
            random_direction(rng)
        };
        places.push((
            random_place(rng, if i % 2 == 0 { 5.0 } else { 80.0 }),
            normal,
        ));
    }
    for light in &setting.scene.lights {
        let (at, axis) = match light {
            Light::Point(light) => (light.position, DVec3::Z),
            Light::Spot(light) => (light.position, light.axis),
            _ => continue,
        };
        for step in [0.0, 1e-12, 0.5, -0.5] {
            places.push((at - ORIGIN + axis * step, axis));
        }
    }
    places
}

#[test]
fn probabilities_sum_to_one_and_are_those_of_the_samples() {
    let mut rng = SplitMix::new(0x5211);
    let setting = everything(&mut rng);
    let (lights, surfaces) = (setting.lights(), setting.surfaces());
    let count = setting.scene.lights.len() as u32;
    assert!(!lights.is_empty() && lights.first_emitter() == count);
    for (from, normal) in places(&setting, &mut rng) {
        let sum: f64 = (0..count).map(|l| lights.choice(l, from, normal)).sum();
        assert!((sum - 1.0).abs() < 1e-12, "{sum} at {from}");
        assert_eq!(lights.choice(count, from, normal), 0.0);
        for _ in 0..10 {
            let Some(sample) = lights.sample(&surfaces, from, normal, uniforms(&mut rng)) else {
                continue;
            };
            let choice = lights.choice(sample.light, from, normal);
            assert_eq!(choice.to_bits(), sample.choice.to_bits());
            assert!((sample.direction.length() - 1.0).abs() < 1e-12);
        }
        for (index, light) in (0_u32..).zip(&setting.scene.lights) {
            let lit = match light {
                Light::Image(_) => true,
                light => truth(light, from, normal) > 0.0,
            };
            let choice = lights.choice(index, from, normal);
            assert!(!lit || choice > 0.0, "{light:?} at {from}");
        }
    }
}

#[test]
fn shares_of_lights_far_away_are_half_even_and_half_by_power() {
    let sun = distant(DVec3::X, [3.0; 3]);
    let sky = constant([1.0; 3]);
    let setting = Setting::new([sun, sky, point(DVec3::ZERO, [1.0; 3])]);
    let lights = setting.lights();
    let disk = PI * 25.0;
    let powers = [3.0 * disk, 4.0 * PI * disk, 4.0 * PI];
    let total: f64 = powers.iter().sum();
    for (light, power) in (0_u32..).zip(powers) {
        let expected = 0.5 / 3.0 + 0.5 * power / total;
        let got = lights.choice(light, DVec3::ONE, DVec3::Y);
        assert!((got - expected).abs() < 1e-12, "{light}: {got} {expected}");
        let got = lights.emission_choice(light);
        assert!((got - power / total).abs() < 1e-12, "{light}: {got}");
    }
    // Behind the only lamp nothing is spent on it.
    let lamp = spot(DVec3::ZERO, DVec3::Z, [0.9, 0.8], [1.0; 3]);
    let setting = Setting::new([lamp, distant(DVec3::X, [1.0; 3])]);
    let behind = DVec3::new(0.0, 0.0, -1.0);
    assert_eq!(setting.lights().choice(0, behind, DVec3::ZERO), 0.0);
    assert_eq!(setting.lights().choice(1, behind, DVec3::ZERO), 1.0);
    assert!(setting.lights().choice(0, -behind, DVec3::ZERO) > 0.0);
}

#[test]
fn a_thousand_lights_sum_to_their_irradiance() {
    let mut rng = SplitMix::new(0x5221);
    let setting = Setting::new(many(1000, &mut rng));
    let (lights, surfaces) = (setting.lights(), setting.surfaces());
    let mut suite = Mutants::new(
        "choice",
        &[
            "even choice assumed",
            "one light left out",
            "choice at a neighbour",
        ],
    );
    let n = samples(N);
    for (from, normal) in [
        (DVec3::new(0.5, 2.9, -0.3), DVec3::NEG_Y),
        (DVec3::new(-4.0, 1.0, 3.0), DVec3::ZERO),
        (DVec3::new(0.1, 0.2, 0.3), DVec3::new(0.6, 0.0, -0.8)),
    ] {
        let each: Vec<f64> = setting
            .scene
            .lights
            .iter()
            .map(|light| truth(light, from, normal))
            .collect();
        let sum: f64 = each.iter().sum();
        // The strongest of those that a heuristic may think unimportant: it is missed like any other.
        let (left_out, _) =
            each.iter().enumerate().fold(
                (0, 0.0),
                |best, (i, &e)| {
                    if e > best.1 { (i, e) } else { best }
                },
            );
        let run = |mutate: &dyn Fn(&LightSample) -> f64, seed_of: u64| {
            let mut rng = SplitMix::new(seed(seed_of));
            let sample = Sample::collect(n, |_| {
                let sample = lights.sample(&surfaces, from, normal, uniforms(&mut rng));
                sample.map_or(0.0, |sample| mutate(&sample) * weight(&sample, normal))
            });
            judge(sample.moments(), sum, 0.01)
        };
        suite.check("irradiance", run(&|_| 1.0, 0x5222));
        let count = setting.scene.lights.len() as f64;
        let even = |s: &LightSample| s.choice * count;
        suite.trial("irradiance", "even choice assumed", run(&even, 0x5223));
        let without = |s: &LightSample| f64::from(s.light as usize != left_out);
        suite.trial("irradiance", "one light left out", run(&without, 0x5224));
        let beside = from + DVec3::new(0.0, 0.5, 0.0);
        let neighbour = |s: &LightSample| match lights.choice(s.light, beside, normal) {
            0.0 => 0.0,
            choice => s.choice / choice,
        };
        suite.trial(
            "irradiance",
            "choice at a neighbour",
            run(&neighbour, 0x5225),
        );
    }
    suite.finish();
}

/// Variance of the estimate of a sum of parts when one is chosen with given probabilities, over the sum squared.
fn relative_variance(parts: &[f64], probability: impl Fn(u32) -> f64) -> f64 {
    let sum: f64 = parts.iter().sum();
    let squares = parts.iter().zip(0_u32..).filter(|(part, _)| **part > 0.0);
    squares
        .map(|(part, light)| part * part / probability(light))
        .sum::<f64>()
        / (sum * sum)
        - 1.0
}

#[test]
fn the_tree_spends_its_samples_where_the_light_is() {
    // The exact variance, against that of a choice by power alone and of an even one.
    let mut rng = SplitMix::new(0x5231);
    let setting = Setting::new(many(1000, &mut rng));
    let lights = setting.lights();
    let (mut by_power, mut evenly, mut places) = (0.0, 0.0, 0.0);
    for i in 0..100 {
        let from = random_place(&mut rng, 6.0);
        let normal = if i % 2 == 0 {
            DVec3::ZERO
        } else {
            random_direction(&mut rng)
        };
        let of = |light| truth(light, from, normal);
        let parts: Vec<f64> = setting.scene.lights.iter().map(of).collect();
        if parts.iter().sum::<f64>() == 0.0 {
            continue;
        }
        let tree = relative_variance(&parts, |light| lights.choice(light, from, normal));
        let power = relative_variance(&parts, |light| lights.emission_choice(light));
        by_power += (power / tree).ln();
        evenly += (relative_variance(&parts, |_| 1e-3) / tree).ln();
        places += 1.0;
    }
    let [by_power, evenly] = [by_power, evenly].map(|sum: f64| (sum / places).exp());
    assert!(
        places > 80.0 && by_power > 3.0 && evenly > 3.0,
        "{places} {by_power} {evenly}"
    );
}

#[test]
fn no_light_is_no_choice() {
    for lights in [
        vec![],
        vec![point(DVec3::ZERO, [0.0; 3]), constant([0.0; 3])],
    ] {
        let setting = Setting::new(lights);
        let (lights, surfaces) = (setting.lights(), setting.surfaces());
        assert!(lights.is_empty());
        assert!(
            lights
                .sample(&surfaces, DVec3::ONE, DVec3::Y, [0.5; 3])
                .is_none()
        );
        assert!(lights.emit(&surfaces, [0.5; 5]).is_none());
        assert_eq!(lights.choice(0, DVec3::ONE, DVec3::Y), 0.0);
        assert_eq!(lights.emission_choice(0), 0.0);
        assert_eq!(lights.escapes(DVec3::X).count(), 0);
    }
    assert!(Lights::default().is_empty());
}
