//! The shadow rays that paths send, and what truly passes along each.
//!
//! Paths are flown as [`woodcock_core::path`] flies those of a single grey grid under one sun, one by one and without points that lie
//! well: the same flights, albedos, roulettes and phase functions. What is left to the caller is the transmittance of each
//! shadow ray, so that the same paths can be had with the exact one.

use std::array;

use woodcock_core::collision;
use woodcock_core::free_flight::delta;
use woodcock_core::majorant::majorant_depth;
use woodcock_core::path::{
    Convex, Geometry, MediumRecord, OneGrid, PathMedium, RecordKind, Settings,
};
use woodcock_core::ray::Ray;
use woodcock_core::real::Word32;
use woodcock_core::stream::{Key, PathStream, Stream};
use woodcock_core::vec3::Vec3;
use woodcock_host::world::{Location, Tables, World};

use crate::yardstick::{Cells, Matter, Yardstick};

/// A scene of a name with a sun, and with grey matter that does not shine; its grid `coarser` times coarser than it should be.
pub fn sunny(name: &str, coarser: usize) -> Option<Yardstick> {
    let sun = Some(([-0.6, 0.7, -0.5], [2.0; 3]));
    match name {
        "cloud" => Some(Yardstick::cloud(256 / coarser)),
        "smoke" => Some(Yardstick {
            name: "smoke",
            sigma_a: [1.2; 3],
            sigma_s: [10.8; 3],
            sun,
            sky: [0.5; 3],
            ..Yardstick::smoke(128 / coarser)
        }),
        "fire" => {
            let mut fire = Yardstick::fire(48 / coarser);
            if let Matter::Cells(cells) = &mut fire.matter {
                // A fire that has burnt down: its paths are not combed, its shadow rays are.
                cells.kelvin.clear();
            }
            Some(Yardstick {
                sun,
                sky: [0.5; 3],
                ..fire
            })
        }
        "haze" => {
            // Matter everywhere, twelve mean free paths across the middle and one along an edge, nowhere rough.
            let density = |p: [f32; 3]| {
                let square: f32 = p.iter().map(|c| c * c).sum();
                0.08 + 0.92 * (-9.0 * square).exp()
            };
            Some(Yardstick {
                name: "haze",
                matter: Matter::Cells(Cells::new([128 / coarser; 3], density)),
                sigma_a: [0.6; 3],
                sigma_s: [19.4; 3],
                g: 0.5,
                sun,
                sky: [0.5; 3],
                ..Yardstick::smoke(8)
            })
        }
        _ => None,
    }
}

/// A shadow ray.
#[derive(Clone, Copy, Debug)]
pub struct ShadowRay {
    /// Where light scattered.
    pub origin: [f32; 3],
    /// Towards the sun.
    pub direction: [f32; 3],
    /// To the medium's end \[length\].
    pub t_max: f32,
    /// What the light brings by colour but for its transmittance.
    pub direct: [f32; 3],
    /// Below this weight paths let it play roulette.
    pub floor: f32,
}

impl ShadowRay {
    /// As trackers take it.
    pub fn ray(&self) -> Ray<f32> {
        Ray {
            origin: Vec3::splat(self.origin),
            direction: Vec3::splat(self.direction),
        }
    }
}

/// Where paths fly: the only medium of a world, a grey grid in a convex shape, under one sun and a constant sky.
#[derive(Clone, Copy, Debug)]
pub struct Flown<'a> {
    world: &'a World,
    /// What rays are tracked through.
    pub medium: OneGrid<'a>,
    shape: &'a Convex,
    record: &'a MediumRecord,
    settings: Settings,
}

fn numbers(v: Vec3<f32>) -> [f32; 3] {
    [v.x, v.y, v.z]
}

impl<'a> Flown<'a> {
    /// From a world, if it is one of these.
    pub fn new(world: &'a World, settings: Settings) -> Option<Self> {
        let (Location::Convex(shape), [medium]) = (&world.place, world.media.as_slice()) else {
            return None;
        };
        let grid = matches!(medium.record.kind, RecordKind::Grid { .. });
        let plain = medium.is_plain() && !medium.is_chromatic() && !medium.is_emissive();
        let lights = world.lights();
        let one_sun = lights.distant.len() == 1 && !lights.sample_environment;
        (grid && plain && one_sun).then_some(Self {
            world,
            medium: world.tables.one_grid(&medium.record),
            shape,
            record: &medium.record,
            settings,
        })
    }

    /// The part of a ray within the medium, moved to its beginning; `None` where it misses.
    fn within(&self, ray: &Ray<f32>) -> Option<(Ray<f32>, f32)> {
        let stretch = self.shape.stretch(ray, Word32(0), true);
        let (t0, t1) = (stretch.interval.t0, stretch.interval.t1);
        let origin = ray.at(t0);
        let direction = ray.direction;
        (stretch.found && t0 < t1).then_some((Ray { origin, direction }, t1 - t0))
    }

    /// Flies a path of a pixel: what it brings, where `through` tells what passes along a shadow ray.
    pub fn path(
        &self,
        key: Key,
        [x, y]: [u32; 2],
        mut through: impl FnMut(&ShadowRay) -> f64,
    ) -> [f64; 3] {
        let mut rng = PathStream::new(key);
        let lights = self.world.lights();
        let sun = &lights.distant[0];
        let mut brought = [0.0_f64; 3];
        let mut throughput = [1.0_f32; 3];
        let mut ray = self.world.camera.ray(x as f32, y as f32, &mut rng, true);
        let mut depth = 0;
        loop {
            let flight = self.within(&ray).and_then(|(ray, length)| {
                let flight = delta::sample(&self.medium, &ray, length, &mut rng, true);
                flight.collided.then(|| ray.at(flight.t))
            });
            let Some(point) = flight else {
                let sky = lights.environment;
                return array::from_fn(|c| brought[c] + f64::from(throughput[c] * sky[c]));
            };
            if depth >= self.settings.max_depth {
                return brought;
            }
            depth += 1;
            let optics = PathMedium::<f32>::optics(&self.medium, &idle(&self.medium));
            let albedo = numbers(optics.albedo);
            let largest = |v: [f32; 3]| v.into_iter().fold(0.0, f32::max);
            let left: [f32; 3] = array::from_fn(|c| throughput[c] * albedo[c]);
            let factor = collision::roulette(largest(left), self.settings.roulette, &mut rng, true);
            throughput = left.map(|c| c * factor);
            if largest(throughput) == 0.0 {
                return brought;
            }
            let phase = optics.phase;
            let (u, turn): (f32, f32) = (rng.uniform(true), rng.uniform(true));
            let towards = Vec3::splat(sun.direction());
            let density = phase.eval::<true>(ray.direction.dot(towards));
            let promise = largest(throughput) * density;
            let factor = collision::roulette(promise, self.settings.faint, &mut rng, true);
            if factor > 0.0
                && let Some((shadow, t_max)) = self.within(&Ray {
                    origin: point,
                    direction: towards,
                })
            {
                let light = sun.radiance();
                let sent = ShadowRay {
                    origin: numbers(shadow.origin),
                    direction: numbers(shadow.direction),
                    t_max,
                    direct: array::from_fn(|c| throughput[c] * light[c] * density * factor),
                    floor: floor(promise, self.settings.faint),
                };
                let passes = through(&sent);
                brought = array::from_fn(|c| brought[c] + passes * f64::from(sent.direct[c]));
            }
            let direction = ray.direction.deflected(phase.sample::<true>(u), turn);
            ray = Ray {
                origin: point,
                direction,
            };
        }
    }

    /// The mean number of tentative collisions of ratio tracking on a ray.
    pub fn majorant_depth(&self, ray: &ShadowRay) -> f32 {
        majorant_depth(&self.medium, &ray.ray(), ray.t_max, true)
    }

    /// What truly passes along a ray.
    pub fn transmittance(&self, ray: &ShadowRay) -> f64 {
        (-optical_depth(&self.world.tables, self.record, ray)).exp()
    }
}

/// Below which weight paths let a shadow ray of so much promise play roulette on its way.
fn floor(promise: f32, faint: f32) -> f32 {
    (0.4 * faint / promise.max(faint)).clamp(1.0 / 64.0, 0.5)
}

/// A walk with no ray.
fn idle<'a>(medium: &OneGrid<'a>) -> <OneGrid<'a> as woodcock_core::medium::Medium<f32>>::Walk {
    woodcock_core::medium::Medium::<f32>::idle(medium)
}

/// ∫σ_t dt of the interpolant: between planes of samples it is a cubic along a ray, for which Simpson's rule is exact.
fn optical_depth(tables: &Tables, record: &MediumRecord, ray: &ShadowRay) -> f64 {
    let RecordKind::Grid {
        world_to_grid,
        dims,
        samples,
        ..
    } = record.kind
    else {
        return f64::from(record.scale) * f64::from(ray.t_max);
    };
    let rows = world_to_grid.map(|row| row.map(f64::from));
    let dot =
        |row: [f64; 4], v: [f32; 3]| -> f64 { (0..3).map(|i| row[i] * f64::from(v[i])).sum() };
    let origin = rows.map(|row| dot(row, ray.origin) + row[3]);
    let direction = rows.map(|row| dot(row, ray.direction));
    let value = |t: f64| {
        let mut cell = [0_u32; 3];
        let mut share = [0.0; 3];
        for axis in 0..3 {
            let last = f64::from(dims[axis] - 1);
            let place = (origin[axis] + direction[axis] * t).clamp(0.0, last);
            let low = place.floor().min((last - 1.0).max(0.0));
            (cell[axis], share[axis]) = (low as u32, place - low);
        }
        let mut sum = 0.0;
        for corner in 0..8 {
            let up: [u32; 3] = array::from_fn(|axis| corner >> axis & 1);
            let weight: f64 = (0..3)
                .map(|a| if up[a] == 1 { share[a] } else { 1.0 - share[a] })
                .product();
            if weight > 0.0 {
                let at = array::from_fn(|a| cell[a] + up[a]);
                sum += weight * f64::from(tables.sample(tables.tap(samples, dims, at)));
            }
        }
        sum
    };
    let end = f64::from(ray.t_max);
    let forward = |axis: usize| direction[axis] > 0.0;
    // The next plane of samples along each axis.
    let mut planes: [f64; 3] = array::from_fn(|a| {
        if forward(a) {
            origin[a].floor() + 1.0
        } else {
            origin[a].ceil() - 1.0
        }
    });
    let mut t = 0.0;
    let mut low = value(0.0);
    let mut sum = 0.0;
    while t < end {
        let crossing = |a: usize| {
            if direction[a] == 0.0 {
                return f64::INFINITY;
            }
            (planes[a] - origin[a]) / direction[a]
        };
        let crossings: [f64; 3] = array::from_fn(crossing);
        let next = crossings.into_iter().fold(end, f64::min).max(t);
        let high = value(next);
        sum += (next - t) / 6.0 * (low + 4.0 * value(0.5 * (t + next)) + high);
        for axis in 0..3 {
            if crossings[axis] <= next {
                planes[axis] += if forward(axis) { 1.0 } else { -1.0 };
            }
        }
        (t, low) = (next, high);
    }
    sum * f64::from(record.scale)
}
