//! Combs of points along camera rays through what shines: radiance, what passes and where light scatters, against quadrature.
//!
//! Extinction and light change along the ray alone, so that one sum over small steps knows everything. The means that plausible
//! mistakes would have are sums of the same kind; the checks must reject each.

use woodcock_core::camera::{Camera, Projection};
use woodcock_core::light::Lights;
use woodcock_core::majorant::BLOCK;
use woodcock_core::majorant::Mark;
use woodcock_core::medium::Affine;
use woodcock_core::path::{
    self, Convex, Counts, Field, Geometry, MediumRecord, OneGrid, Radiance, RecordKind, STRATUM,
    Scene, Settings, Shining, Source, Start,
};
use woodcock_core::points::{self, LaneStrata};
use woodcock_core::ray::Ray;
use woodcock_core::real::Word32;
use woodcock_core::stream::{Key, PathStream};
use woodcock_core::vec3::Vec3;
use woodcock_tests::grids::TestGrid;
use woodcock_tests::stats::{Moments, assert_mean_agrees, judge, must_kill, samples, seed};

const RESOLUTION: f64 = 0.002;
const SKY: [f32; 3] = [0.2, 0.4, 0.8];
const ABSORBED: [f32; 3] = [0.9, 0.5, 0.3];
/// Steps of a sum between two samples.
const STEPS: usize = 2000;

/// A medium between z = 0 and 1, by samples of density and light that lie evenly on the way.
struct Case {
    name: &'static str,
    density: Vec<f32>,
    light: Vec<f32>,
    scale: f32,
    albedo: f32,
}

/// What a ray brings, or would by a mistake.
#[derive(Clone, Copy, Debug, Default)]
struct Means {
    radiance: [f64; 3],
    hidden: f64,
    /// ∫ σ_t T t dt: where scatterings are.
    moment: f64,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Mistake {
    None,
    /// Strata of a single point, and no second order.
    FirstOrder,
    /// Sources that the half of their stratum before them does not dim.
    Undimmed,
    /// Points where a stratum begins instead of within.
    NoJitter,
}

fn at(samples: &[f32], z: f64) -> f64 {
    let place = z * (samples.len() - 1) as f64;
    let cell = (place as usize).min(samples.len() - 2);
    let w = place - cell as f64;
    f64::from(samples[cell]) * (1.0 - w) + f64::from(samples[cell + 1]) * w
}

impl Case {
    /// By midpoints. With a mistake: of a medium in one block, whose bound is its largest sample.
    fn means(&self, mistake: Mistake) -> Means {
        let scale = f64::from(self.scale);
        let bound = scale * f64::from(self.density.iter().copied().fold(0.0, f32::max));
        let stratum = f64::from(STRATUM);
        let n = STEPS * (self.density.len() - 1);
        let step = 1.0 / n as f64;
        let mut means = Means::default();
        // What passes to the present stratum, and ∫(a − ½) dx within it.
        let (mut passes, mut within, mut index) = (1.0, 0.0, 0.0);
        for i in 0..n {
            let z = (i as f64 + 0.5) * step;
            let x = bound * z;
            let beginning = (x / stratum).floor();
            let mut sigma_t = scale * at(&self.density, z);
            let mut light = at(&self.light, z);
            if mistake == Mistake::NoJitter {
                let z = beginning * stratum / bound;
                (sigma_t, light) = (scale * at(&self.density, z), at(&self.light, z));
            }
            if mistake == Mistake::FirstOrder {
                if beginning > index {
                    passes *= (-stratum / 2.0_f64).exp() * (1.0 - within);
                    (within, index) = (0.0, beginning);
                }
                within += (sigma_t / bound - 0.5) * bound * step;
            }
            let depth = x - beginning * stratum;
            let through = match mistake {
                Mistake::None | Mistake::NoJitter => passes * (-sigma_t * step / 2.0).exp(),
                Mistake::Undimmed => passes * (depth / 2.0).exp(),
                Mistake::FirstOrder => passes * (-depth / 2.0).exp(),
            };
            if mistake != Mistake::FirstOrder {
                passes *= (-sigma_t * step).exp();
            }
            for (radiance, absorbed) in means.radiance.iter_mut().zip(ABSORBED) {
                *radiance += through * f64::from(absorbed) * sigma_t * light * step;
            }
            means.moment += through * sigma_t * z * step;
        }
        if mistake == Mistake::FirstOrder {
            // Beyond the end is nothing.
            within -= 0.5 * (stratum - (bound - index * stratum));
            passes *= (-stratum / 2.0_f64).exp() * (1.0 - within);
        }
        for (radiance, sky) in means.radiance.iter_mut().zip(SKY) {
            *radiance += passes * f64::from(sky);
        }
        means.hidden = 1.0 - passes;
        means
    }

    /// Moments of red and blue radiance, of what is hidden, of the weight of all branches, and of that times their distance.
    fn found(&self, points: bool, n: u32) -> [Moments; 5] {
        let nz = self.density.len() as u32;
        let grid = TestGrid::new([3, 3, nz], |[.., z]| self.density[z as usize]);
        let light: Vec<f32> = (0..4 * self.light.len())
            .flat_map(|i| [self.light[i / 4]; 3])
            .collect();
        let map = |n: usize| {
            let mut map: Affine = [[0.0; 4]; 3];
            (map[0][0], map[1][1], map[2][2]) = (1.0, 1.0, (n - 1) as f32);
            (map[0][3], map[1][3]) = (0.5, 0.5);
            map
        };
        let world_to_grid = map(self.density.len());
        let record = MediumRecord {
            kind: RecordKind::Grid {
                world_to_grid,
                dims: grid.dims,
                samples: 0,
                majorants: 0,
                edge: BLOCK,
            },
            scale: self.scale,
            colour: [1.0; 3],
            albedo: [self.albedo; 3],
            g: 0.0,
            rayleigh: false,
        };
        let source = Source {
            absorbed: ABSORBED,
            factor: None,
            radiance: Radiance::Field(Field {
                values: &light,
                dims: [2, 2, self.light.len() as u32],
                world_to_grid: map(self.light.len()),
            }),
        };
        let medium = OneGrid::new(&record, &grid.samples, &grid.majorants);
        let medium = Shining { medium, source };
        let geometry = Convex::Box {
            to_local: world_to_grid,
            size: [2.0, 2.0, (nz - 1) as f32],
        };
        let camera = Camera {
            projection: Projection::Perspective,
            screen: [[0.0; 2]; 2],
            camera_to_world: woodcock_core::medium::IDENTITY,
            lens_radius: 0.0,
            focal_distance: 1.0,
        };
        let scene = Scene {
            medium: &medium,
            geometry: &geometry,
            lights: Lights {
                distant: &[],
                environment: SKY,
                sample_environment: false,
            },
            camera: &camera,
            settings: Settings {
                points,
                ..Settings::default()
            },
        };
        let ray = Ray {
            origin: Vec3::splat([0.5, 0.5, -1.0]),
            direction: Vec3::splat([0.0, 0.0, 1.0]),
        };
        let first = Geometry::<f32>::stretch(&geometry, &ray, Word32(0), true);
        assert!(first.found, "{}", self.name);
        let mut moments = [(); 5].map(|()| Moments::new());
        let mut counts = Counts::default();
        for pixel in 0..n {
            let key = Key {
                seed: seed(611),
                pixel,
                sample: pixel % 16,
            };
            let strata = points::strata(key).words().map(Word32);
            let strata = LaneStrata::new(strata).with_common(Word32(points::common(key)));
            let start = Start {
                ray,
                first,
                strata,
                mark: Mark::none(),
            };
            let mut rng = PathStream::new(key);
            let glow = path::glow(&scene, &start, &mut rng, true, &mut counts);
            let [red, _, blue] = glow.radiance.lane(0);
            let branches = glow.branches as usize;
            let (mut weight, mut moment) = (0.0, 0.0);
            for distance in &glow.distances[..branches] {
                weight += f64::from(glow.weight);
                moment += f64::from(glow.weight) * f64::from(distance - 1.0);
            }
            let all = [
                f64::from(red),
                f64::from(blue),
                f64::from(glow.alpha),
                weight,
                moment,
            ];
            for (moments, x) in moments.iter_mut().zip(all) {
                moments.push(x);
            }
            assert!(
                glow.weight >= 0.0 && glow.alpha < 1.0 + 1e-6,
                "{}: {glow:?}",
                self.name
            );
        }
        assert_eq!(counts.majorant_violations, 0, "{}", self.name);
        moments
    }
}

/// Of the five quantities of [`Case::found`].
fn truths(means: &Means) -> [(&'static str, f64); 5] {
    [
        ("red", means.radiance[0]),
        ("blue", means.radiance[2]),
        ("hidden", means.hidden),
        ("scattered", means.hidden),
        ("moment", means.moment),
    ]
}

fn cases() -> [Case; 4] {
    let light = vec![0.2, 3.0, 0.0, 1.0];
    let many = |i: u32| {
        if i.is_multiple_of(3) {
            0.05
        } else {
            0.1 * (i % 11) as f32
        }
    };
    [
        Case {
            name: "a slab of constant density",
            density: vec![1.0; 5],
            light: vec![1.0; 2],
            scale: 2.3,
            albedo: 0.25,
        },
        Case {
            name: "a ramp in one block",
            density: vec![0.0, 0.25, 0.5, 0.75, 1.0],
            light: light.clone(),
            scale: 5.0,
            albedo: 0.9,
        },
        Case {
            name: "thick and uneven, in several blocks",
            density: (0..34).map(many).collect(),
            light: light.clone(),
            scale: 14.0,
            albedo: 0.25,
        },
        Case {
            name: "thin, with little to scatter",
            density: vec![0.1, 1.0, 0.1],
            light,
            scale: 0.3,
            albedo: 0.02,
        },
    ]
}

#[test]
fn means_are_those_of_quadrature() {
    let n = samples(1 << 18) as u32;
    for case in cases() {
        let truths = truths(&case.means(Mistake::None));
        for points in [false, true] {
            for (moments, (what, truth)) in case.found(points, n).iter().zip(truths) {
                let name = format!("{}, {what}, points {points}", case.name);
                // Few paths have a branch where little scatters.
                let resolution = if case.albedo < 0.1 {
                    5.0 * RESOLUTION
                } else {
                    RESOLUTION
                };
                assert_mean_agrees(&name, moments, truth, resolution);
            }
        }
    }
}

/// The closed form of a slab, L = L_e (1 − e^−τ) + e^−τ L_sky, is what the sums know too.
#[test]
fn sums_know_the_closed_form() {
    let [slab, ..] = cases();
    let means = slab.means(Mistake::None);
    let passes = (-f64::from(slab.scale)).exp();
    for c in 0..3 {
        let exact = f64::from(ABSORBED[c]) * (1.0 - passes) + passes * f64::from(SKY[c]);
        assert!((means.radiance[c] / exact - 1.0).abs() < 1e-6, "{means:?}");
    }
}

#[test]
fn mistakes_would_be_found() {
    let n = samples(1 << 18) as u32;
    let [_, ramp, ..] = cases();
    for points in [false, true] {
        let found = ramp.found(points, n);
        for mistake in [Mistake::FirstOrder, Mistake::Undimmed, Mistake::NoJitter] {
            let wrong = truths(&ramp.means(mistake));
            // The second order is worth most to what passes; without dimming that is right.
            let place = if mistake == Mistake::FirstOrder { 2 } else { 0 };
            let (what, wrong) = wrong[place];
            let name = format!("{mistake:?}, {what}");
            must_kill(&name, judge(&found[place], wrong, RESOLUTION));
        }
    }
}
