//! Light that sets out lands where light is looked for: flux through a small disk, both ways.

use super::*;
use woodcock_tests::stats::{Mutants, Sample, Verdict, samples, seed, welch};

const N: usize = 1 << 18;

/// Of the difference, relative to the flux.
const RESOLUTION: f64 = 0.02;

/// A disk that receives light on the side of its normal.
pub(super) struct Receiver {
    pub(super) centre: DVec3,
    pub(super) normal: DVec3,
    pub(super) radius: f64,
}

impl Receiver {
    fn frame(&self) -> [DVec3; 2] {
        let across = if self.normal.x.abs() < 0.5 {
            DVec3::X
        } else {
            DVec3::Y
        };
        let u = self.normal.cross(across).normalize();
        [u, self.normal.cross(u)]
    }

    fn area(&self) -> f64 {
        PI * self.radius * self.radius
    }

    /// Flux by a light looked for at a place spread evenly.
    pub(super) fn look(&self, lights: &Lights, surfaces: &Surfaces, rng: &mut SplitMix) -> f64 {
        let (r, phi) = (self.radius * rng.uniform().sqrt(), 2.0 * PI * rng.uniform());
        let [u, v] = self.frame();
        let from = self.centre + (u * phi.cos() + v * phi.sin()) * r;
        let sample = lights.sample(surfaces, from, self.normal, uniforms(rng));
        sample.map_or(0.0, |sample| self.area() * weight(&sample, self.normal))
    }

    /// Flux by light that set out, if it lands on the lit side.
    pub(super) fn wait(&self, lights: &Lights, surfaces: &Surfaces, rng: &mut SplitMix) -> f64 {
        let Some(d) = lights.emit(surfaces, uniforms(rng)) else {
            return 0.0;
        };
        let speed = self.normal.dot(d.direction);
        let t = self.normal.dot(self.centre - d.anchor.point) / speed;
        let landing = d.anchor.point + d.direction * t;
        if speed < 0.0 && t > 0.0 && (landing - self.centre).length() < self.radius {
            mean(d.radiance) * d.cosine / (d.choice * d.pdf_position * d.pdf_direction)
        } else {
            0.0
        }
    }
}

/// Both estimates must agree, and neither may be blind.
pub(super) fn both_ways(setting: &Setting, receiver: &Receiver, base: u64, n: usize) -> Verdict {
    let (lights, surfaces) = (setting.lights(), setting.surfaces());
    let mut rng = SplitMix::new(seed(base));
    let look = Sample::collect(samples(n), |_| receiver.look(&lights, &surfaces, &mut rng));
    let wait = Sample::collect(samples(n), |_| receiver.wait(&lights, &surfaces, &mut rng));
    let (a, b) = (look.moments(), wait.moments());
    assert!(a.mean() > 0.0 && b.mean() > 0.0, "no light arrives");
    welch(a, b).verdict(RESOLUTION * a.mean())
}

const RECEIVER: Receiver = Receiver {
    centre: DVec3::new(0.3, -0.6, 0.4),
    normal: DVec3::new(0.0, 0.8, 0.6),
    radius: 1.2,
};

fn kinds() -> Vec<Light> {
    vec![
        point(DVec3::new(0.5, 1.0, 0.8), [3.0, 2.0, 1.0]),
        spot(
            DVec3::new(0.0, 2.0, 1.0),
            DVec3::new(0.1, -1.0, -0.4),
            [0.9, 0.4],
            [4.0; 3],
        ),
        distant(DVec3::new(0.4, 0.9, 0.2), [2.0; 3]),
        constant([0.5; 3]),
        image("map.exr", turned()),
        goniometric("lamp.exr", turned(), None),
    ]
}

fn with_files(setting: Setting) -> Setting {
    setting
        .file("map.exr", picture([8, 4], |x, y| f64::from(1 + x + 3 * y)))
        .file("lamp.exr", picture([6, 6], |x, y| f64::from(3 + x * y)))
}

#[test]
fn every_kind_of_light_lands_where_it_is_looked_for() {
    for (index, light) in kinds().into_iter().enumerate() {
        let setting = with_files(Setting::new([light]));
        let verdict = both_ways(&setting, &RECEIVER, 0x5411 + index as u64, N);
        assert_eq!(verdict, Verdict::Agrees, "kind {index}");
    }
}

#[test]
fn all_lights_together_land_where_they_are_looked_for() {
    let setting = with_files(Setting::new(kinds()));
    let mut suite = Mutants::new("adjoint", &["a smaller disk", "the dark side too"]);
    suite.check("flux", both_ways(&setting, &RECEIVER, 0x5421, N));
    // Mistakes of one of the two: its disk is not the other's, or it counts what comes from behind.
    let (lights, surfaces) = (setting.lights(), setting.surfaces());
    let mut rng = SplitMix::new(seed(0x5422));
    let look = Sample::collect(samples(N), |_| RECEIVER.look(&lights, &surfaces, &mut rng));
    let least = RESOLUTION * look.moments().mean();
    let smaller = Receiver {
        radius: 0.85 * RECEIVER.radius,
        ..RECEIVER
    };
    let wait = Sample::collect(samples(N), |_| smaller.wait(&lights, &surfaces, &mut rng));
    let verdict = welch(look.moments(), wait.moments()).verdict(least);
    suite.trial("flux", "a smaller disk", verdict);
    let behind = Receiver {
        normal: -RECEIVER.normal,
        ..RECEIVER
    };
    let wait = Sample::collect(samples(N), |_| {
        RECEIVER.wait(&lights, &surfaces, &mut rng) + behind.wait(&lights, &surfaces, &mut rng)
    });
    let verdict = welch(look.moments(), wait.moments()).verdict(4.0 * least);
    suite.trial("flux", "the dark side too", verdict);
    suite.finish();
}
