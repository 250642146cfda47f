//! Light that sets out: total power, and densities that are what they say.

use super::*;
use woodcock_host::light::Departure;
use woodcock_tests::stats::{Mutants, Sample, judge, samples, seed};

const N: usize = 1 << 16;

/// Power per departure; colours averaged.
fn power(departure: &Departure) -> f64 {
    mean(departure.radiance) * departure.cosine
        / (departure.choice * departure.pdf_position * departure.pdf_direction)
}

/// One of each that is no surface, with its power in closed form.
fn each() -> Vec<(Light, f64)> {
    let disk = PI * BOUNDS.radius * BOUNDS.radius;
    // Rows of a map of latitude: 4π is shared by (1 − √½) / 2, √½ / 2 and their mirror images.
    let row = |y: u32| f64::from(y + 1);
    let half = 0.5_f64.sqrt();
    let shares = [1.0 - half, half, half, 1.0 - half].map(|s| 2.0 * PI * s);
    let map: f64 = (0..4).map(|y| row(y) * shares[y as usize]).sum();
    vec![
        (point(DVec3::X, [1.0, 2.0, 3.0]), 8.0 * PI),
        (
            spot(DVec3::Y, DVec3::new(1.0, -1.0, 0.5), [0.8, 0.3], [5.0; 3]),
            2.0 * PI * 5.0 * (0.2 + 0.25),
        ),
        (distant(DVec3::new(0.2, 0.3, -0.9), [0.5; 3]), 0.5 * disk),
        (constant([0.02, 0.01, 0.03]), 4.0 * PI * 0.02 * disk),
        (image("map.exr", turned()), TINT * map * disk),
        (goniometric("lamp.exr", turned(), Some(30.0)), 60.0),
    ]
}

fn with_files(setting: Setting) -> Setting {
    setting
        .file("map.exr", picture([8, 4], |_, y| f64::from(y + 1)))
        .file("lamp.exr", picture([5, 5], |x, y| f64::from(x * y)))
}

#[test]
fn what_each_light_sends_is_its_power() {
    for (index, (light, expected)) in each().into_iter().enumerate() {
        let setting = with_files(Setting::new([light]));
        let (lights, surfaces) = (setting.lights(), setting.surfaces());
        let mut rng = SplitMix::new(0x5311 + index as u64);
        // All are sampled in exact proportion to what they send, so every departure carries the whole power; colours
        // of the spot's edge and all but the mean of a lamp's picture cancel.
        for _ in 0..2000 {
            let departure = lights.emit(&surfaces, uniforms(&mut rng)).expect("lit");
            let power = power(&departure);
            assert!(
                (power / expected - 1.0).abs() < 1e-6,
                "{index}: {power} {expected}"
            );
        }
    }
}

#[test]
fn all_lights_together_send_the_sum() {
    let (list, powers): (Vec<Light>, Vec<f64>) = each().into_iter().unzip();
    let total: f64 = powers.iter().sum();
    let setting = with_files(Setting::new(list));
    let (lights, surfaces) = (setting.lights(), setting.surfaces());
    let mut suite = Mutants::new(
        "departures",
        &["even choice", "half a light", "a disk of half the radius"],
    );
    let run = |mutate: &dyn Fn(&Departure) -> f64, seed_of: u64| {
        let mut rng = SplitMix::new(seed(seed_of));
        let sample = Sample::collect(samples(N), |_| {
            let departure = lights.emit(&surfaces, uniforms(&mut rng));
            departure.map_or(0.0, |d| mutate(&d) * power(&d))
        });
        judge(sample.moments(), total, 0.01)
    };
    suite.check("total power", run(&|_| 1.0, 0x5321));
    let count = powers.len() as f64;
    suite.trial(
        "total power",
        "even choice",
        run(&|d| d.choice * count, 0x5322),
    );
    let half = |d: &Departure| if d.light == 3 { 0.5 } else { 1.0 };
    suite.trial("total power", "half a light", run(&half, 0x5323));
    let disk = |d: &Departure| if (2..5).contains(&d.light) { 0.25 } else { 1.0 };
    suite.trial(
        "total power",
        "a disk of half the radius",
        run(&disk, 0x5324),
    );
    suite.finish();

    for (index, power) in powers.iter().enumerate() {
        let choice = lights.emission_choice(index as u32);
        assert!((choice - power / total).abs() < 1e-9, "{index}: {choice}");
    }
}

#[test]
fn departures_have_the_densities_they_are_asked_for() {
    let (list, _): (Vec<Light>, Vec<f64>) = each().into_iter().unzip();
    let setting = with_files(Setting::new(list));
    let (lights, surfaces) = (setting.lights(), setting.surfaces());
    let mut rng = SplitMix::new(0x5331);
    let mut seen = [0; 6];
    for _ in 0..20_000 {
        let d = lights.emit(&surfaces, uniforms(&mut rng)).expect("lit");
        seen[d.light as usize] += 1;
        let pdf = lights.emission_pdf(&surfaces, d.light, &d.anchor, d.direction);
        assert!(
            (pdf.0 / d.pdf_position - 1.0).abs() < 1e-12,
            "{d:?} {pdf:?}"
        );
        assert!(
            (pdf.1 / d.pdf_direction - 1.0).abs() < 1e-9,
            "{d:?} {pdf:?}"
        );
        assert_eq!(
            d.choice.to_bits(),
            lights.emission_choice(d.light).to_bits()
        );
        assert!((d.direction.length() - 1.0).abs() < 1e-12);
        let from_centre = d.anchor.point - BOUNDS.centre;
        if (2..5).contains(&d.light) {
            // From a disk across that the sphere does not reach.
            let ahead = -from_centre.dot(d.direction);
            let across = from_centre + d.direction * ahead;
            assert!(ahead > BOUNDS.radius && across.length() < BOUNDS.radius * (1.0 + 1e-12));
        }
    }
    assert!(seen.iter().all(|count| *count > 10), "{seen:?}");
    // Directions that are never taken have no density.
    let spot = &lights.emission_pdf(&surfaces, 1, &setting_anchor(), DVec3::Y);
    assert_eq!(*spot, (1.0, 0.0));
    assert_eq!(
        lights.emission_pdf(&surfaces, 99, &setting_anchor(), DVec3::Y),
        (0.0, 0.0)
    );
}

fn setting_anchor() -> woodcock_host::ray::Anchor {
    woodcock_host::ray::Anchor::in_space(DVec3::Y)
}

#[test]
fn densities_of_directions_integrate_to_one() {
    let (list, _): (Vec<Light>, Vec<f64>) = each().into_iter().unzip();
    let setting = with_files(Setting::new(list));
    let (lights, surfaces) = (setting.lights(), setting.surfaces());
    let n = 700;
    for light in [0, 1, 3, 4, 5] {
        let mut sum = 0.0;
        for i in 0..n * n {
            let u = [i / n, i % n].map(|i| (f64::from(i) + 0.5) / f64::from(n));
            sum += lights
                .emission_pdf(&surfaces, light, &setting_anchor(), sphere(u))
                .1;
        }
        let integral = sum * 4.0 * PI / f64::from(n * n);
        assert!((integral - 1.0).abs() < 2e-3, "{light}: {integral}");
    }
}
