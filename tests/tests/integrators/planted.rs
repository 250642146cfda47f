//! What the comparison of pictures sees: mistakes planted in the scene, one for each thing an integrator may get wrong, all
//! rejected by the judge of the other suites at the samples that it has there.

use woodcock_host::integrator::Integrator;
use woodcock_tests::gallery::*;
use woodcock_tests::pictures::*;
use woodcock_tests::replicates::Replicates;
use woodcock_tests::stats::must_kill;

/// What is planted.
struct Scene {
    extinction: f64,
    light: f64,
    limit: u32,
    reflectance: f64,
    g: f64,
    lens: f64,
    emission: f64,
}

const RIGHT: Scene = Scene {
    extinction: 1.0,
    light: 1.0,
    limit: 3,
    reflectance: 0.8,
    g: 0.5,
    lens: 0.05,
    emission: 1.0,
};

/// Relative standard error that each comparison must reach.
const RESOLUTION: f64 = 0.005;

impl Scene {
    /// A ball of fog and a fire close to the camera on a floor, below a wide lamp: few paths bring much more than others.
    fn exhibit(&self) -> Exhibit {
        let Self {
            extinction,
            light,
            reflectance,
            ..
        } = *self;
        let camera = perspective([0.0, 0.2, -3.0], [0.0, -0.15, 1.0], 32.0)
            + &format!(
                " \"float lensradius\" {} \"float focaldistance\" 2.5",
                self.lens
            );
        let world = sky(light)
            + &floor(&diffuse([reflectance; 3]))
            + &sphere(&diffuse([reflectance; 3]), [0.55, -0.5, -0.7], 0.4)
            + &homogeneous("m", &grey(3.0 * extinction, 0.4, self.g))
            + &fire(0.5 * self.emission)
            + &ball("m", "", [-0.3, 0.0, 0.0], 0.7)
            + &block("fire", "", [[0.0, -0.4, -0.2], [1.0; 3]]);
        Exhibit::new("planted", camera, world).limited(self.limit)
    }

    fn shoot(&self, integrator: Integrator, seed: u64) -> Replicates {
        self.shoot_times(1, integrator, seed)
    }

    fn shoot_times(&self, times: u32, integrator: Integrator, seed: u64) -> Replicates {
        let n = match integrator {
            Integrator::Path => 480,
            Integrator::Bdpt => 192,
            _ => 192,
        };
        Replicates::of(
            "planted",
            &self.exhibit().stage(integrator, seed),
            times * n,
        )
    }
}

#[test]
fn planted_mistakes_are_rejected() {
    let reference = RIGHT.shoot(Integrator::Path, 4000);
    for (integrator, seed) in [(Integrator::Bdpt, 4001), (Integrator::Mlt, 4002)] {
        let same = RIGHT.shoot(integrator, seed);
        same.assert_same(integrator.name(), &reference, RESOLUTION);
    }
    let mistakes = [
        (
            "extinction",
            Scene {
                extinction: 1.2,
                ..RIGHT
            },
        ),
        (
            "light",
            Scene {
                light: 1.05,
                ..RIGHT
            },
        ),
        ("limit", Scene { limit: 1, ..RIGHT }),
        (
            "reflectance",
            Scene {
                reflectance: 0.93 * 0.8,
                ..RIGHT
            },
        ),
        ("mean cosine", Scene { g: -0.3, ..RIGHT }),
        ("lens", Scene { lens: 2.5, ..RIGHT }),
        (
            "emission",
            Scene {
                emission: 1.3,
                ..RIGHT
            },
        ),
    ];
    for ((name, mistake), seed) in mistakes.into_iter().zip((4010..).step_by(10)) {
        let integrators = [Integrator::Path, Integrator::Bdpt, Integrator::Mlt];
        for (integrator, seed) in integrators.into_iter().zip(seed..) {
            let picture = mistake.shoot(integrator, seed);
            let verdict = picture.strongest(&reference, RESOLUTION);
            println!("{name}, {}: {verdict:?}", integrator.name());
            must_kill(&format!("{name}, {}", integrator.name()), verdict);
        }
    }
}

#[test]
fn with_more_samples_a_few_percent_are_seen() {
    let shoot = |scene: &Scene, seed| scene.shoot_times(4, Integrator::Path, seed);
    let reference = shoot(&RIGHT, 4100);
    shoot(&RIGHT, 4101).assert_same("the same", &reference, RESOLUTION);
    let mistakes = [
        (
            "light",
            Scene {
                light: 1.03,
                ..RIGHT
            },
        ),
        (
            "extinction",
            Scene {
                extinction: 1.05,
                ..RIGHT
            },
        ),
        (
            "reflectance",
            Scene {
                reflectance: 0.97 * 0.8,
                ..RIGHT
            },
        ),
        (
            "limit",
            Scene {
                limit: RIGHT.limit - 1,
                ..RIGHT
            },
        ),
    ];
    for ((name, mistake), seed) in mistakes.into_iter().zip(4110..) {
        let verdict = shoot(&mistake, seed).strongest(&reference, RESOLUTION);
        println!("{name}: {verdict:?}");
        must_kill(name, verdict);
    }
}
