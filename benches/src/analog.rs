//! What there is to beat: plain analog tracking at full lane width, as one would write it in an afternoon.
//!
//! Eight lanes with refill, one majorant for everything, one sample of the eight around a place, absorption by weight with
//! roulette. The sky is met by escaping, the sun by a shadow ray that arrives or does not, a fire's light at collisions.
//! Where extinction has colour, each path has one, in turn. It owes nothing to woodcock but the colour of black bodies, and has the
//! same mean.

use std::f32::consts::TAU;

use wide::{f32x8, i32x8, u32x8};
use woodcock_host::scene::blackbody_peak_one;

use crate::picture::{Picture, Pixel};
use crate::yardstick::{Cells, Matter, RESOLUTION, Yardstick};

type V = [f32x8; 3];
/// Below this weight a path plays roulette.
const ROULETTE: f32 = 0.25;
/// Kelvins between entries of the table of black bodies.
const STEP: f32 = 0.5;

fn dot(a: V, b: V) -> f32x8 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn pick(mask: f32x8, a: V, b: V) -> V {
    [0, 1, 2].map(|i| mask.bitselect(a[i], b[i]))
}

/// xoshiro128+, eight of them.
struct Stream([u32x8; 4]);

impl Stream {
    fn new(mut seed: u64) -> Self {
        let mut word = || {
            seed = seed.wrapping_add(0x9e37_79b9_7f4a_7c15);
            let z = (seed ^ (seed >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
            ((z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb) >> 32) as u32
        };
        Self(std::array::from_fn(|_| {
            u32x8::new(std::array::from_fn(|_| word()))
        }))
    }

    /// Uniform in [0, 1).
    fn next(&mut self) -> f32x8 {
        let [a, b, c, d] = &mut self.0;
        let result: u32x8 = *a + *d;
        let t: u32x8 = *b << 9_u32;
        *c ^= *a;
        *d ^= *b;
        *b ^= *c;
        *a ^= *d;
        *c ^= t;
        *d = (*d << 11_u32) | (*d >> 21_u32);
        let bits: i32x8 = bytemuck::cast(result >> 8_u32);
        f32x8::from_i32x8(bits) * f32x8::splat(1.0 / 16_777_216.0)
    }
}

/// What paths fly through.
trait Medium {
    /// Distance to the matter's hull, and whether it is met.
    fn enter(&self, origin: V, direction: V) -> (f32x8, f32x8);
    fn inside(&self, p: V) -> f32x8;
    /// Whether a tentative collision is real.
    fn real(&self, p: V, inside: f32x8, rng: &mut Stream) -> f32x8;
    /// Light sent out at a place.
    fn glow(&self, p: [f32; 3]) -> [f32; 3];
}

struct Ball(f32);

impl Medium for Ball {
    fn enter(&self, origin: V, direction: V) -> (f32x8, f32x8) {
        let b = -dot(origin, direction);
        let root = b * b - (dot(origin, origin) - self.0 * self.0);
        (b - root.max(f32x8::ZERO).sqrt(), f32x8::ZERO.simd_lt(root))
    }
    fn inside(&self, p: V) -> f32x8 {
        dot(p, p).simd_lt(f32x8::splat(self.0 * self.0))
    }
    fn real(&self, _: V, inside: f32x8, _: &mut Stream) -> f32x8 {
        inside
    }
    fn glow(&self, _: [f32; 3]) -> [f32; 3] {
        [0.0; 3]
    }
}

#[derive(Debug)]
struct Grid<'a> {
    cells: &'a Cells,
    /// Over the largest density.
    density: Vec<f32>,
    far: [f32; 3],
    cells_per_length: f32,
    black_bodies: Vec<[f32; 3]>,
}

impl<'a> Grid<'a> {
    fn new(cells: &'a Cells, largest: f32, glow: f32) -> Self {
        let hottest = cells.kelvin.iter().copied().fold(0.0, f32::max);
        let colour =
            |i| blackbody_peak_one(f64::from(i as f32 * STEP)).map(|c| c.max(0.0) as f32 * glow);
        let entries = if hottest > 0.0 {
            (hottest / STEP) as usize + 2
        } else {
            0
        };
        Self {
            cells,
            density: cells.density.iter().map(|d| d / largest).collect(),
            far: cells.corner().map(|c| -c),
            cells_per_length: cells.dims.into_iter().max().unwrap_or(1) as f32,
            black_bodies: (0..entries).map(colour).collect(),
        }
    }
}

impl Medium for Grid<'_> {
    fn enter(&self, origin: V, direction: V) -> (f32x8, f32x8) {
        let (mut near, mut far) = (f32x8::ZERO, f32x8::splat(f32::MAX));
        for a in 0..3 {
            let inverse = f32x8::ONE / direction[a];
            let (s, t) = (
                (-f32x8::splat(self.far[a]) - origin[a]) * inverse,
                (f32x8::splat(self.far[a]) - origin[a]) * inverse,
            );
            near = near.fast_max(s.fast_min(t));
            far = far.fast_min(s.fast_max(t));
        }
        (near, near.simd_lt(far))
    }
    fn inside(&self, p: V) -> f32x8 {
        let [x, y, z] = [0, 1, 2].map(|a| p[a].abs().simd_lt(f32x8::splat(self.far[a])));
        x & y & z
    }
    fn real(&self, p: V, inside: f32x8, rng: &mut Stream) -> f32x8 {
        let [i, j, k] = [0, 1, 2].map(|a| {
            let at = (p[a] + f32x8::splat(self.far[a])) * f32x8::splat(self.cells_per_length) - 0.5;
            let index = (at + rng.next()).floor(); // the upper neighbour with the weight that it has
            let last = f32x8::splat((self.cells.dims[a] - 1) as f32);
            index.fast_max(f32x8::ZERO).fast_min(last).fast_trunc_int()
        });
        let [nx, ny, _] = self.cells.dims.map(|n| i32x8::splat(n as i32));
        let place = ((k * ny + j) * nx + i).to_array();
        let density = f32x8::new(place.map(|i| self.density[i as usize]));
        rng.next().simd_lt(density) & inside
    }
    fn glow(&self, p: [f32; 3]) -> [f32; 3] {
        let dims = self.cells.dims;
        let at: [f32; 3] = std::array::from_fn(|a| {
            let at = (p[a] + self.far[a]) * self.cells_per_length - 0.5;
            at.clamp(0.0, (dims[a] - 1) as f32)
        });
        let cell: [usize; 3] = std::array::from_fn(|a| (at[a] as usize).min(dims[a] - 2));
        let first = (cell[2] * dims[1] + cell[1]) * dims[0] + cell[0];
        let mut kelvin = 0.0;
        for corner in 0..8_usize {
            let up = [corner & 1, corner >> 1 & 1, corner >> 2];
            let offset = (up[2] * dims[1] + up[1]) * dims[0] + up[0];
            let weight = |a: usize| {
                let w = at[a] - cell[a] as f32;
                if up[a] == 1 { w } else { 1.0 - w }
            };
            kelvin += weight(0) * weight(1) * weight(2) * self.cells.kelvin[first + offset];
        }
        self.black_bodies[(kelvin / STEP + 0.5) as usize]
    }
}

/// A scene ready to render.
#[derive(Debug)]
pub struct Analog<'a> {
    scene: &'a Yardstick,
    grid: Option<Grid<'a>>,
    largest: f32,
}

impl<'a> Analog<'a> {
    /// Builds what tracking needs.
    pub fn new(scene: &'a Yardstick) -> Self {
        let (grid, largest) = match &scene.matter {
            Matter::Ball { .. } => (None, 1.0),
            Matter::Cells(cells) => {
                let largest = cells.density.iter().copied().fold(0.0, f32::max);
                (Some(Grid::new(cells, largest, scene.glow)), largest)
            }
        };
        Self {
            scene,
            grid,
            largest,
        }
    }

    /// Renders with one thread; a multiple of three samples where extinction has colour.
    pub fn render(&self, samples: u32, seed: u64) -> Vec<Pixel> {
        let picture = match (&self.grid, &self.scene.matter) {
            (Some(grid), _) => trace(self.scene, grid, self.largest, samples, seed),
            (None, Matter::Ball { radius }) => {
                trace(self.scene, &Ball(*radius), 1.0, samples, seed)
            }
            (None, Matter::Cells(_)) => Picture::new(RESOLUTION * RESOLUTION),
        };
        picture.pixels()
    }
}

/// Rays of the camera that meet the matter, eight at a time.
struct Bank {
    pixel: u32,
    sample: u32,
    rays: Vec<([f32; 3], [f32; 3], usize, usize)>,
    /// Along x and y of the screen, and to its middle.
    frame: [V; 3],
    eye: V,
}

impl Bank {
    fn new(scene: &Yardstick) -> Self {
        let unit = |v: [f32; 3]| {
            let length = v.iter().map(|c| c * c).sum::<f32>().sqrt();
            v.map(|c| c / length)
        };
        let cross = |[a, b, c]: [f32; 3], [x, y, z]: [f32; 3]| {
            [b * z - c * y, c * x - a * z, a * y - b * x]
        };
        let ahead = unit(scene.eye.map(|c| -c));
        let right = unit(cross(ahead, [0.0, 1.0, 0.0]));
        let half = (0.5 * scene.fov.to_radians()).tan();
        let frame = [
            right.map(|c| c * half),
            cross(right, ahead).map(|c| c * half),
            ahead,
        ];
        Self {
            pixel: 0,
            sample: 0,
            rays: Vec::new(),
            frame: frame.map(|v| v.map(f32x8::splat)),
            eye: scene.eye.map(f32x8::splat),
        }
    }

    /// The next ray at its entry: place, direction, pixel, colour.
    fn next<M: Medium>(
        &mut self,
        medium: &M,
        samples: u32,
        rng: &mut Stream,
        mut missed: impl FnMut(usize, usize),
    ) -> Option<([f32; 3], [f32; 3], usize, usize)> {
        let edge = RESOLUTION as u32;
        while self.rays.is_empty() {
            if self.pixel == edge * edge {
                return None;
            }
            let mut owners = [(0, 0); 8];
            for owner in &mut owners {
                *owner = (self.pixel, self.sample);
                self.sample += 1;
                if self.sample == samples {
                    (self.pixel, self.sample) = (self.pixel + 1, 0);
                }
            }
            let axis = |number: fn(u32) -> u32, rng: &mut Stream| {
                let at = f32x8::new(owners.map(|(pixel, _)| number(pixel) as f32)) + rng.next();
                at * f32x8::splat(2.0 / edge as f32) - 1.0
            };
            let (x, y) = (
                axis(|p| p % RESOLUTION as u32, rng),
                -axis(|p| p / RESOLUTION as u32, rng),
            );
            let [right, up, ahead] = self.frame;
            let way: V = std::array::from_fn(|a| right[a] * x + up[a] * y + ahead[a]);
            let inverse = f32x8::ONE / dot(way, way).sqrt();
            let way = way.map(|c| c * inverse);
            let (t, met) = medium.enter(self.eye, way);
            let entry: V = std::array::from_fn(|a| self.eye[a] + way[a] * t);
            let (entry, way, met) = (
                entry.map(|c| c.to_array()),
                way.map(|c| c.to_array()),
                met.to_bitmask(),
            );
            for (lane, (pixel, sample)) in owners.into_iter().enumerate().rev() {
                let colour = sample as usize % 3;
                if pixel == edge * edge {
                } else if met >> lane & 1 == 1 {
                    let ray = (
                        entry.map(|c| c[lane]),
                        way.map(|c| c[lane]),
                        pixel as usize,
                        colour,
                    );
                    self.rays.push(ray);
                } else {
                    missed(pixel as usize, colour);
                }
            }
        }
        self.rays.pop()
    }
}

fn trace<M: Medium>(
    scene: &Yardstick,
    medium: &M,
    largest: f32,
    samples: u32,
    seed: u64,
) -> Picture {
    let sigma_t = scene.sigma_t();
    let albedo: [f32; 3] = std::array::from_fn(|c| scene.sigma_s[c] / sigma_t[c]);
    let chromatic = sigma_t[0] != sigma_t[1] || sigma_t[1] != sigma_t[2];
    let mut picture = Picture::new(RESOLUTION * RESOLUTION);
    let mut land = |pixel: usize, colour: usize, radiance: [f32; 3]| {
        let one: [f32; 3] =
            std::array::from_fn(|c| if c == colour { 3.0 * radiance[c] } else { 0.0 });
        picture.add(pixel, if chromatic { one } else { radiance });
    };
    let rng = &mut Stream::new(seed);
    let mut bank = Bank::new(scene);
    let zero = f32x8::ZERO;
    let (g, g2) = (f32x8::splat(scene.g), f32x8::splat(scene.g * scene.g));
    let (towards, irradiance) = scene.sun.unwrap_or(([0.0, 1.0, 0.0], [0.0; 3]));
    let length = towards.iter().map(|c| c * c).sum::<f32>().sqrt();
    let towards = towards.map(|c| f32x8::splat(c / length));
    // Per lane: flight, the flight after a shadow ray, weights.
    let (mut p, mut way): (V, V) = ([zero; 3], [zero; 3]);
    let (mut hit, mut next): (V, V) = ([zero; 3], [zero; 3]);
    let (mut weight, mut direct, mut sunlit, mut shadow) = (zero, zero, zero, zero);
    let (mut mean_free_path, mut alpha) = (zero, zero);
    let mut fire = [[0.0_f32; 3]; 8];
    let mut owners: [Option<(usize, usize)>; 8] = [None; 8];
    let mut finished = 0xff_u32;
    loop {
        while finished != 0 {
            let lane = finished.trailing_zeros() as usize;
            finished &= finished - 1;
            if let Some((pixel, colour)) = owners[lane] {
                let (sky, sun) = (weight.to_array()[lane], sunlit.to_array()[lane]);
                let radiance = std::array::from_fn(|c| {
                    sky * scene.sky[c] + sun * irradiance[c] + fire[lane][c]
                });
                land(pixel, colour, radiance);
            }
            let ray = bank.next(medium, samples, rng, |pixel, colour| {
                land(pixel, colour, scene.sky)
            });
            owners[lane] = ray.map(|(_, _, pixel, colour)| (pixel, colour));
            fire[lane] = [0.0; 3];
            let here = f32x8::new(std::array::from_fn(|i| {
                f32::from_bits(if i == lane { u32::MAX } else { 0 })
            }));
            let (from, along, _, colour) = ray.unwrap_or(([9.0; 3], [0.0; 3], 0, 0));
            p = pick(here, from.map(f32x8::splat), p);
            way = pick(here, along.map(f32x8::splat), way);
            weight = here.bitselect(f32x8::ONE, weight);
            sunlit = here.bitselect(zero, sunlit);
            shadow = here.bitselect(zero, shadow);
            mean_free_path = here.bitselect(
                f32x8::splat(1.0 / (largest * sigma_t[colour])),
                mean_free_path,
            );
            alpha = here.bitselect(f32x8::splat(albedo[colour]), alpha);
        }
        if owners.iter().all(Option::is_none) {
            return picture;
        }
        let t = -(f32x8::ONE - rng.next()).ln() * mean_free_path;
        p = std::array::from_fn(|a| p[a] + way[a] * t);
        let inside = medium.inside(p);
        let real = medium.real(p, inside, rng);
        if scene.sun.is_some() {
            sunlit = (shadow & !inside).bitselect(sunlit + direct, sunlit);
        }
        let real_flight = real & !shadow;
        let mut ended = !inside & !shadow; // these have met the sky
        let resumed = shadow & (real | !inside);
        shadow &= !resumed;
        if resumed.any() {
            p = pick(resumed, hit, p);
            way = pick(resumed, next, way);
        }
        if real_flight.any() {
            if scene.glow > 0.0 {
                let (places, weights) = (p.map(|c| c.to_array()), weight.to_array());
                for lane in (0..8).filter(|lane| real_flight.to_bitmask() >> lane & 1 == 1) {
                    let light = medium.glow(places.map(|c| c[lane]));
                    let absorbed = weights[lane] * (1.0 - albedo[0]);
                    (0..3).for_each(|c| fire[lane][c] += absorbed * light[c]);
                }
            }
            weight = real_flight.bitselect(weight * alpha, weight);
            let low = real_flight & weight.simd_lt(f32x8::splat(ROULETTE));
            if low.any() {
                let lost = low & !(rng.next() * f32x8::splat(ROULETTE)).simd_lt(weight);
                weight = lost.bitselect(zero, low.bitselect(f32x8::splat(ROULETTE), weight));
                ended |= lost;
            }
            let u = rng.next();
            let root = (f32x8::ONE - g2) / (f32x8::ONE - g + f32x8::splat(2.0) * g * u);
            let cos = ((f32x8::ONE + g2 - root * root) / (g + g))
                .fast_max(-f32x8::ONE)
                .fast_min(f32x8::ONE);
            let sin = (f32x8::ONE - cos * cos).sqrt();
            let (turn_sin, turn_cos) = (rng.next() * f32x8::splat(TAU)).sin_cos();
            let [x, y, z] = way;
            let sign = z.simd_lt(zero).bitselect(-f32x8::ONE, f32x8::ONE);
            let a = -f32x8::ONE / (sign + z);
            let b = x * y * a;
            let (u, v) = (sin * turn_cos, sin * turn_sin);
            let turned = [
                u * (f32x8::ONE + sign * x * x * a) + v * b + cos * x,
                u * sign * b + v * (sign + y * y * a) + cos * y,
                -u * sign * x - v * y + cos * z,
            ];
            if scene.sun.is_some() {
                let base = f32x8::ONE + g2 - (g + g) * dot(way, towards);
                let phase = (f32x8::ONE - g2) / (f32x8::splat(2.0 * TAU) * base * base.sqrt());
                direct = real_flight.bitselect(weight * phase, direct);
                hit = pick(real_flight, p, hit);
                next = pick(real_flight, turned, next);
                way = pick(real_flight, towards, way);
                shadow |= real_flight;
            } else {
                way = pick(real_flight, turned, way);
            }
        }
        let running = owners
            .iter()
            .enumerate()
            .fold(0, |bits, (i, o)| bits | u32::from(o.is_some()) << i);
        finished = ended.to_bitmask() & running;
    }
}
