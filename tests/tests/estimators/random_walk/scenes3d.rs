//! Cubes under a sun or a lamp: what a camera ray sees after one scattering, and after all.
//!
//! A path from the camera scores at each of its collisions what the light sends there through the medium, by ratio
//! tracking where the density varies. Left out: the scenes with surfaces.

use super::{Ledger, honest_and, judge_near, names, record};
use std::f64::consts::PI;
use woodcock_core::vec3::Vec3;
use woodcock_tests::refs::scenes3d::{Lit, load, load_point_lit};
use woodcock_tests::stats::{Mutants, Sample};
use woodcock_tests::walker::{
    Block, Closed, Flights, HenyeyGreenstein, Law, Mistake, Run, UnderBound, Walk, ray, tally,
    vector,
};

/// What lights a cube from outside.
#[derive(Clone, Copy, Debug)]
enum Light {
    /// Irradiance 1 across the direction of travel.
    Sun(Vec3<f32>),
    /// An isotropic point of power 1.
    Lamp(Vec3<f32>),
}

impl Light {
    /// The direction to the light from a place, and its irradiance there without medium.
    fn at(self, place: Vec3<f32>) -> (Vec3<f32>, f64) {
        match self {
            Self::Sun(travels) => (-travels, 1.0),
            Self::Lamp(light) => {
                let way = light - place;
                let squared = f64::from(way.dot(way));
                (way.normalised(), 1.0 / (4.0 * PI * squared))
            }
        }
    }
}

fn scenes() -> Vec<(Light, Lit)> {
    let suns = load()
        .into_iter()
        .map(|c| (Light::Sun(vector(c.light_dir)), Lit::from(c)));
    let lamps = load_point_lit()
        .into_iter()
        .map(|c| (Light::Lamp(vector(c.light_pos)), c.rest));
    suns.chain(lamps).collect()
}

/// The medium: in closed form where it is homogeneous, else by tracking under a loose bound.
fn filling([p0, px, py, pz]: [f64; 4]) -> Box<dyn Flights> {
    if [px, py, pz] == [0.0; 3] {
        return Box::new(Closed::new(p0));
    }
    let sigma_t = move |x: f64, y: f64, z: f64| p0 + px * x + py * y + pz * z;
    let largest = p0 + px.max(0.0) + py.max(0.0) + pz.max(0.0);
    Box::new(sigma_t.under(1.2 * largest))
}

/// Radiances of all orders, and of the first.
fn seen(light: Light, cube: &Lit, mistake: Option<Mistake>, run: Run) -> Vec<Sample> {
    let law = HenyeyGreenstein(cube.g as f32);
    let mut walk = Walk::new(Block::unit(), filling(cube.p), law);
    walk.mistake = mistake;
    tally(run, 2, |draws, scores| {
        let mut ray = ray(cube.ray_origin, cube.ray_dir);
        let mut weight = 1.0;
        let mut first = true;
        walk.follow(&mut ray, draws, |ray, draws| {
            weight = walk.absorb(weight, cube.albedo);
            let (direction, irradiance) = light.at(ray.origin);
            let through = walk.way_out(ray.origin, direction, draws);
            let density = walk.law.density(&ray.origin, ray.direction.dot(direction));
            let score = weight * irradiance * through * f64::from(density);
            scores[0] += score;
            if first {
                scores[1] += score;
            }
            first = false;
            weight *= walk.roulette(weight, 0.1, draws);
            weight > 0.0
        });
    })
}

#[test]
fn radiance_of_camera_rays() {
    let mut ledger = Ledger::new("scenes3d");
    for (i, (light, cube)) in scenes().iter().enumerate() {
        let samples = seen(*light, cube, None, Run::new(115, i as u32, 1 << 18));
        let (known, error) = (cube.radiance, cube.radiance_error);
        ledger.within(
            format_args!("{i} L"),
            &samples[0],
            known,
            error,
            0.01 * known,
        );
        let (known, error) = (cube.once, cube.once_error);
        ledger.within(
            format_args!("{i} L1"),
            &samples[1],
            known,
            error,
            0.01 * known,
        );
    }
    ledger.finish(4 * 2);
}

/// The mistakes that these comparisons must reject.
pub(super) const MISTAKES: [Mistake; 6] = [
    Mistake::PhaseReversed,
    Mistake::StaleFlight,
    Mistake::ShortFrame,
    Mistake::HalfTurn,
    Mistake::NullScatters,
    Mistake::AlbedoTwice,
];

#[test]
fn mutants_die() {
    let mut suite = Mutants::new("scenes3d", &names(&MISTAKES));
    let scenes = scenes();
    for mistake in honest_and(&MISTAKES) {
        // The varying cube under the sun.
        let (light, cube) = &scenes[1];
        let samples = seen(*light, cube, mistake, Run::new(116, 0, 1 << 16));
        let (known, error) = (cube.radiance, cube.radiance_error);
        let verdict = judge_near(samples[0].moments(), known, error, 0.02 * known);
        record(&mut suite, "all orders", mistake, verdict);
        let (known, error) = (cube.once, cube.once_error);
        let verdict = judge_near(samples[1].moments(), known, error, 0.02 * known);
        record(&mut suite, "first order", mistake, verdict);
    }
    suite.finish();
}
