//! A path tracer in a page: what is scattered once or many times, unbiased, in an array of any size.

use woodcock_core::collision::roulette;
use woodcock_core::free_flight::delta;
use woodcock_core::majorant::{MajorantGrid, fill_majorants};
use woodcock_core::medium::Grid;
use woodcock_core::phase::henyey_greenstein;
use woodcock_core::ray::Ray;
use woodcock_core::stream::{Key, PathStream, Stream};
use woodcock_core::transmittance::ratio;
use woodcock_core::vec3::Vec3;

const TO_SUN: [f32; 3] = [0.36, 0.48, 0.8];
/// Mean cosine of scattering.
const G: f32 = 0.6;

/// Two hills of fog, of which 4 x 2 x 2 units of length are sampled four to a unit.
fn extinction(x: f32, y: f32, z: f32) -> f32 {
    let hill = |at: f32, height: f32| height - 0.9 * ((x - at) * (x - at) + 1.5 * z * z) - y;
    (hill(-0.9, 0.9).max(hill(0.7, 1.6)) * 8.0).clamp(0.0, 4.0)
}

/// The part of a ray in the fog, and its length, which is not positive where there is none.
fn part(fog: &Grid<'_>, origin: Vec3<f32>, direction: Vec3<f32>) -> (Ray<f32>, f32) {
    let ray = Ray { origin, direction };
    let inside = fog.clip(&ray);
    let origin = ray.at(inside.t0);
    (Ray { origin, direction }, inside.t1 - inside.t0)
}

/// What is seen along a ray: the sky, the ground, and fog that scatters their light and the sun's.
fn radiance(fog: &Grid<'_>, origin: Vec3<f32>, towards: Vec3<f32>, rng: &mut PathStream) -> f32 {
    let (mut found, mut throughput, mut origin, mut direction) = (0.0, 1.0, origin, towards);
    while throughput > 0.0 {
        let (ray, length) = part(fog, origin, direction);
        let flight = delta::sample(fog, &ray, length, rng, true);
        if !flight.collided {
            return found + throughput * if direction.y < 0.0 { 0.2 } else { 0.5 };
        }
        origin = ray.at(flight.t);
        let (to_sun, length) = part(fog, origin, Vec3::splat(TO_SUN));
        let seen = ratio::estimate(fog, &to_sun, length, rng, true);
        throughput *= 0.95; // the albedo
        let cos_theta = direction.dot(to_sun.direction);
        found += throughput * 2.0 * seen * henyey_greenstein::eval(cos_theta, G);
        throughput *= roulette(throughput, 0.5, rng, true);
        let cos_theta = henyey_greenstein::sample(rng.uniform(true), G);
        direction = direction.deflected(cos_theta, rng.uniform(true));
    }
    found
}

/// Renders into the rows of an array; the same bits wherever it runs. Nothing where the fog is no medium.
pub(crate) fn render<const W: usize, const H: usize>(
    image: &mut [[f32; W]; H],
    paths: u32,
) -> Option<()> {
    let mut samples = [0.0; 17 * 9 * 9];
    let mut majorants = [0.0; 4 * 3 * 3];
    for (i, sample) in samples.iter_mut().enumerate() {
        let [x, y, z] = [i % 17, i / 17 % 9, i / 153].map(|n| n as f32 * 0.25);
        *sample = extinction(x - 2.0, y, z - 1.0);
    }
    fill_majorants(&samples, [17, 9, 9], &mut majorants).ok()?;
    let bounds = MajorantGrid::new(&samples, [17, 9, 9], &majorants).ok()?;
    let to_grid = [
        [4.0, 0.0, 0.0, 8.0],
        [0.0, 4.0, 0.0, 0.0],
        [0.0, 0.0, 4.0, 4.0],
    ];
    let fog = Grid::new(bounds, to_grid, 1.0)?;
    for (i, pixel) in image.as_flattened_mut().iter_mut().enumerate() {
        let mut sum = 0.0;
        for sample in 0..paths {
            let mut rng = PathStream::new(Key {
                seed: 6,
                pixel: i as u32,
                sample,
            });
            let [dx, dy]: [f32; 2] = [rng.uniform(true), rng.uniform(true)];
            let x = ((i % W) as f32 + dx) / W as f32 - 0.5;
            let y = 0.3 - 0.6 * ((i / W) as f32 + dy) / H as f32;
            let origin = Vec3::splat([0.0, 0.7, -6.0]);
            let direction = Vec3::new(x, y + 0.08, 1.2).normalised();
            sum += radiance(&fog, origin, direction, &mut rng);
        }
        *pixel = sum / paths as f32;
    }
    Some(())
}

/// A radiance as a character, from dark to bright.
pub(crate) fn shade(radiance: f32) -> u8 {
    b" .:-=+*#%@"
        .get((radiance * 8.0) as usize)
        .copied()
        .unwrap_or(b'@')
}
