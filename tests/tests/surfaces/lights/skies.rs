//! Light from everywhere: densities in closed form, draws that follow them, and irradiances.

use super::*;
use woodcock_tests::stats::{
    ChiSquare, Mutants, Sample, Verdict, assert_agrees, assert_verdict, judge, samples, seed,
};

const N: usize = 1 << 17;

/// A hundred times as bright as all else together, two black rows, a black column.
fn sun(x: u32, y: u32) -> f64 {
    match (x, y) {
        (5, 3) => 20_000.0,
        (_, 1 | 6) | (2, _) => 0.0,
        _ => 1.0 + f64::from((3 * x + 5 * y) % 7),
    }
}

/// A map of latitude as this suite understands it: solid angle of a row's pixels, and pixel of a direction.
struct Map {
    width: u32,
    height: u32,
}

impl Map {
    fn solid_angle(&self, y: u32) -> f64 {
        let cos = |y: u32| (PI * f64::from(y) / f64::from(self.height)).cos();
        2.0 * PI / f64::from(self.width) * (cos(y) - cos(y + 1))
    }

    fn centre(&self, x: u32, y: u32) -> DVec3 {
        let theta = PI * (f64::from(y) + 0.5) / f64::from(self.height);
        let phi = 2.0 * PI * (f64::from(x) + 0.5) / f64::from(self.width);
        DVec3::new(
            theta.sin() * phi.cos(),
            theta.sin() * phi.sin(),
            theta.cos(),
        )
    }

    fn pixel(&self, d: DVec3) -> usize {
        let phi = d.y.atan2(d.x).rem_euclid(2.0 * PI);
        let x = (phi / (2.0 * PI) * f64::from(self.width)) as u32;
        let y = (d.z.acos() / PI * f64::from(self.height)) as u32;
        (y.min(self.height - 1) * self.width + x.min(self.width - 1)) as usize
    }

    fn pixels(&self) -> impl Iterator<Item = (u32, u32)> + use<> {
        let (width, height) = (self.width, self.height);
        (0..height).flat_map(move |y| (0..width).map(move |x| (x, y)))
    }

    /// The share of each pixel, and the integral over all.
    fn shares(&self, value: impl Fn(u32, u32) -> f64) -> (Vec<f64>, f64) {
        let of = |(x, y)| value(x, y) * self.solid_angle(y);
        let weights: Vec<f64> = self.pixels().map(of).collect();
        let total: f64 = weights.iter().sum();
        (weights.iter().map(|w| w / total).collect(), total)
    }
}

const MAP: Map = Map {
    width: 24,
    height: 12,
};

fn map_setting(transform: DAffine3) -> Setting {
    Setting::new([image("sky.exr", transform)])
        .file("sky.exr", picture([MAP.width, MAP.height], sun))
}

#[test]
fn the_density_of_a_map_is_its_closed_form_and_integrates_to_one() {
    let transform = turned();
    let lights = map_setting(transform).lights();
    let (shares, _) = MAP.shares(sun);
    let mut integral = 0.0;
    for ((x, y), share) in MAP.pixels().zip(shares) {
        let world = transform.transform_vector3(MAP.centre(x, y)).normalize();
        let (light, radiance, pdf) = lights.escapes(world).next().expect("a sky");
        assert_eq!(light, 0);
        assert_eq!(radiance, lights.escape_radiance(world));
        let expected = [1.0, 0.5, 0.25].map(|c| f64::from((c * sun(x, y)) as f32));
        assert_eq!(radiance, expected, "({x}, {y})");
        let omega = MAP.solid_angle(y);
        assert!((pdf * omega - share).abs() <= 1e-12 * share, "({x}, {y})");
        integral += pdf * omega;
    }
    assert!((integral - 1.0).abs() < 1e-12, "{integral}");
    // At the poles themselves the density is that of their rows.
    for (pole, x, y) in [(DVec3::Z, 0, 0), (DVec3::NEG_Z, 0, 11)] {
        let world = transform.transform_vector3(pole).normalize();
        let (_, _, pdf) = lights.escapes(world).next().expect("a sky");
        let row = (0..MAP.width).map(|i| MAP.shares(sun).0[(y * MAP.width + i) as usize]);
        let row: Vec<f64> = row.map(|share| share / MAP.solid_angle(y)).collect();
        assert!(
            row.iter().any(|r| (r - pdf).abs() <= 1e-12 * r),
            "{x} {pdf} {row:?}"
        );
    }
}

#[test]
fn the_density_of_an_octahedron_integrates_to_one() {
    for size in [1, 9, 16] {
        let setting = Setting::new([image("sky.exr", turned())]).file(
            "sky.exr",
            picture([size, size], |x, y| f64::from(x + 2 * y) + 0.25),
        );
        let lights = setting.lights();
        let n = 800;
        let mut integral = 0.0;
        for i in 0..n * n {
            let u = [i / n, i % n].map(|i| (f64::from(i) + 0.5) / f64::from(n));
            let (_, _, pdf) = lights.escapes(sphere(u)).next().expect("a sky");
            integral += pdf;
        }
        integral *= 4.0 * PI / f64::from(n * n);
        assert!((integral - 1.0).abs() < 1e-3, "{size}: {integral}");
    }
}

/// Draws by pixel, from any source of directions in the light's own space.
fn histogram(n: usize, mut draw: impl FnMut() -> DVec3) -> Vec<u64> {
    let mut counts = vec![0; (MAP.width * MAP.height) as usize];
    for _ in 0..n {
        counts[MAP.pixel(draw())] += 1;
    }
    counts
}

#[test]
fn draws_follow_the_density() {
    let transform = turned();
    let back = transform.inverse();
    let setting = map_setting(transform);
    let (lights, surfaces) = (setting.lights(), setting.surfaces());
    // The sun aside, whose pixel would leave nothing to the others' test: a second sky without it.
    let dim = |x, y| sun(x, y).min(9.0);
    let dim_setting = Setting::new([image("sky.exr", transform)])
        .file("sky.exr", picture([MAP.width, MAP.height], dim));
    let dim_lights = dim_setting.lights();
    let mut rng = SplitMix::new(seed(0x5111));
    let mut draw = |lights: &Lights| {
        let u = uniforms(&mut rng);
        let sample = lights.sample(&surfaces, DVec3::ZERO, DVec3::ZERO, u);
        let sample = sample.expect("not black");
        let (_, radiance, pdf) = lights.escapes(sample.direction).next().expect("a sky");
        assert_eq!((sample.radiance, sample.pdf), (radiance, pdf));
        back.transform_vector3(sample.direction).normalize()
    };
    let mut suite = Mutants::new(
        "skies",
        &[
            "forgotten sine",
            "half a pixel off",
            "numbers of three bits",
        ],
    );
    let verdict = |counts: &[u64], value: &dyn Fn(u32, u32) -> f64| {
        ChiSquare::new(counts, &MAP.shares(value).0).verdict(0.08)
    };
    let n = samples(N);
    suite.check(
        "chi-square with sun",
        verdict(&histogram(n, || draw(&lights)), &sun),
    );
    suite.check(
        "chi-square",
        verdict(&histogram(n, || draw(&dim_lights)), &dim),
    );

    // The same by hand, without the Jacobian: pixels by value alone.
    let mut rng = SplitMix::new(seed(0x5112));
    for (name, value) in [
        ("chi-square with sun", &sun as &dyn Fn(u32, u32) -> f64),
        ("chi-square", &dim),
    ] {
        let weights: Vec<f64> = MAP.pixels().map(|(x, y)| value(x, y)).collect();
        let total: f64 = weights.iter().sum();
        let mut by_value = || {
            let mut at = rng.uniform() * total;
            let found = MAP.pixels().zip(&weights).find(|(_, w)| {
                at -= **w;
                at < 0.0
            });
            let ((x, y), _) = found.expect("within the total");
            MAP.centre(x, y)
        };
        let counts = histogram(n, &mut by_value);
        suite.trial(name, "forgotten sine", verdict(&counts, value));
    }
    // Half a pixel about the axis, and a number of too few bits to tell rows apart.
    let turn = DAffine3::from_rotation_z(PI / f64::from(MAP.width));
    let mut rng = SplitMix::new(seed(0x5113));
    let counts = histogram(n, || {
        let u = uniforms(&mut rng);
        let sample = dim_lights.sample(&surfaces, DVec3::ZERO, DVec3::ZERO, u);
        let local = back
            .transform_vector3(sample.expect("lit").direction)
            .normalize();
        turn.transform_vector3(local)
    });
    suite.trial("chi-square", "half a pixel off", verdict(&counts, &dim));
    let counts = histogram(n, || {
        let [a, b, c]: [f64; 3] = uniforms(&mut rng);
        let u = [a, (b * 8.0).floor() / 8.0, c];
        let sample = dim_lights.sample(&surfaces, DVec3::ZERO, DVec3::ZERO, u);
        back.transform_vector3(sample.expect("lit").direction)
            .normalize()
    });
    suite.trial(
        "chi-square",
        "numbers of three bits",
        verdict(&counts, &dim),
    );
    suite.finish();
}

#[test]
fn a_constant_sky_gives_pi_times_its_radiance() {
    let setting = Setting::new([constant([1.0, 2.0, 6.0])]);
    let (lights, surfaces) = (setting.lights(), setting.surfaces());
    let mut rng = SplitMix::new(seed(0x5121));
    let normal = DVec3::new(0.6, 0.0, 0.8);
    let irradiance = Sample::collect(samples(N), |_| {
        let u = uniforms(&mut rng);
        lights
            .sample(&surfaces, DVec3::ONE, normal, u)
            .map_or(0.0, |s| weight(&s, normal))
    });
    assert_agrees("constant sky", &irradiance, 3.0 * PI, 0.01);
    let (_, radiance, pdf) = lights.escapes(normal).next().expect("a sky");
    assert_eq!((radiance, pdf), ([1.0, 2.0, 6.0], 1.0 / (4.0 * PI)));
}

/// ∫ max(z, 0) dω over a pixel of a map: Δφ (sin² b − sin² a) / 2 above the horizon.
fn projected(y: u32) -> f64 {
    let sine = |y: u32| {
        (PI * f64::from(y) / f64::from(MAP.height))
            .min(0.5 * PI)
            .sin()
    };
    2.0 * PI / f64::from(MAP.width) * 0.5 * (sine(y + 1).powi(2) - sine(y).powi(2))
}

#[test]
fn a_map_gives_the_irradiance_of_its_pixels() {
    let transform = turned();
    let up = transform.transform_vector3(DVec3::Z).normalize();
    let setting = map_setting(transform);
    let (lights, surfaces) = (setting.lights(), setting.surfaces());
    let pixels = MAP.pixels();
    let truth: f64 = pixels.map(|(x, y)| TINT * sun(x, y) * projected(y)).sum();
    let mut rng = SplitMix::new(seed(0x5131));
    let mut sines = Vec::new();
    let irradiance = Sample::collect(samples(N), |_| {
        let u = uniforms(&mut rng);
        let sample = lights.sample(&surfaces, DVec3::ONE, up, u).expect("a sky");
        let cos = up.dot(sample.direction);
        sines.push((weight(&sample, up), (1.0 - cos * cos).sqrt()));
        weight(&sample, up)
    });
    assert_agrees("map", &irradiance, truth, 0.01);
    // A density that forgot the sine, with the weights it would give.
    let mutant: Sample = sines.iter().map(|(weight, sine)| weight * sine).collect();
    let verdict = judge(mutant.moments(), truth, 0.01);
    assert!(
        matches!(verdict, Verdict::Biased { z } if z.abs() > 10.0),
        "{verdict:?}"
    );
}

#[test]
fn a_picture_of_known_radiance_gives_its_integral() {
    // L = (1 + z)² / 2: with the cosine, 2π ∫ L z dz = 17π/12 over the upper half.
    let fine = Map {
        width: 256,
        height: 128,
    };
    let value = |x: u32, y: u32| 0.5 * (1.0 + fine.centre(x, y).z).powi(2);
    let setting = Setting::new([image("sky.exr", DAffine3::IDENTITY)])
        .file("sky.exr", picture([fine.width, fine.height], value));
    let (lights, surfaces) = (setting.lights(), setting.surfaces());
    let mut rng = SplitMix::new(seed(0x5141));
    let irradiance = Sample::collect(samples(N), |_| {
        let u = uniforms(&mut rng);
        lights
            .sample(&surfaces, DVec3::ZERO, DVec3::Z, u)
            .map_or(0.0, |s| weight(&s, DVec3::Z))
    });
    assert_agrees("(1 + z)² / 2", &irradiance, TINT * 17.0 * PI / 12.0, 0.005);
}

#[test]
fn illuminance_scales_what_falls_on_the_plane() {
    let luminance = 0.2126 + 0.5 * 0.7152 + 0.25 * 0.0722;
    let sizes = [[MAP.width, MAP.height], [10, 10], [11, 11]];
    for (i, size) in sizes.into_iter().enumerate() {
        let transform = turned();
        let up = transform.transform_vector3(DVec3::Z).normalize();
        let mut light = image("sky.exr", transform);
        if let Light::Image(light) = &mut light {
            light.illuminance = Some(1000.0);
            light.scale = 17.0;
        }
        let dim = |x, y| sun(x, y).min(9.0);
        let mut setting = Setting::new([light]).file("sky.exr", picture(size, dim));
        setting.scene.film.imaging_ratio = 0.25;
        let (lights, surfaces) = (setting.lights(), setting.surfaces());
        let mut rng = SplitMix::new(seed(0x5151 + i as u64));
        let irradiance = Sample::collect(samples(N), |_| {
            let u = uniforms(&mut rng);
            let sample = lights.sample(&surfaces, DVec3::ZERO, up, u).expect("a sky");
            weight(&sample, up) / TINT * luminance
        });
        assert_agrees("illuminance", &irradiance, 250.0, 0.01);
    }
}

#[test]
fn octahedral_pictures_are_drawn_from_evenly() {
    // By octant: the picture's quarters hold columns of octants, its diamond the upper half.
    let size = 16;
    let value = |x: u32, y: u32| 1.0 + f64::from(x >= 8) + 4.0 * f64::from(y >= 8);
    let setting = Setting::new([image("sky.exr", DAffine3::IDENTITY)])
        .file("sky.exr", picture([size, size], value));
    let (lights, surfaces) = (setting.lights(), setting.surfaces());
    let mut rng = SplitMix::new(seed(0x5161));
    let mut counts = [0_u64; 8];
    for _ in 0..samples(N) {
        let u = uniforms(&mut rng);
        let sample = lights.sample(&surfaces, DVec3::ZERO, DVec3::ZERO, u);
        let d = sample.expect("a sky").direction;
        counts[usize::from(d.x > 0.0) + 2 * usize::from(d.y > 0.0) + 4 * usize::from(d.z > 0.0)] +=
            1;
    }
    let shares = [1.0, 2.0, 5.0, 6.0, 1.0, 2.0, 5.0, 6.0].map(|w| w / 28.0);
    assert_verdict("octants", ChiSquare::new(&counts, &shares).verdict(0.02));
    // Mirrored, it is another law.
    let mirrored = [2.0, 1.0, 6.0, 5.0, 2.0, 1.0, 6.0, 5.0].map(|w| w / 28.0);
    let verdict = ChiSquare::new(&counts, &mirrored).verdict(0.02);
    assert!(
        matches!(verdict, Verdict::Biased { z } if z > 10.0),
        "{verdict:?}"
    );
}
