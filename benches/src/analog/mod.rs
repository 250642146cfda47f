//! What there is to beat: plain analog tracking at full lane width, as one would write it in an afternoon.
//!
//! Eight lanes with refill, one majorant for everything, one sample of the eight around a place, absorption by weight with
//! roulette. The sky is met by escaping, the sun by a shadow ray that arrives or does not, a fire's light at collisions.
//! Where extinction has colour, each path has one, in turn. It owes nothing to woodcock but the colour of black bodies, and has the
//! same mean.

mod bank;
mod media;

use std::f32::consts::TAU;

use wide::{f32x8, i32x8, u32x8};

use crate::picture::{Picture, Pixel};
use crate::yardstick::{Matter, RESOLUTION, Yardstick};
use bank::Bank;
use media::{Ball, Grid, Medium};

type V = [f32x8; 3];
/// Below this weight a path plays roulette.
const ROULETTE: f32 = 0.25;
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
        self.render_every(1, samples, seed)
    }

    /// The same, of one pixel among so many along either axis; the others stay black.
    pub fn render_every(&self, stride: usize, samples: u32, seed: u64) -> Vec<Pixel> {
        let picture = match (&self.grid, &self.scene.matter) {
            (Some(grid), _) => trace(
                self.scene,
                grid,
                self.largest,
                [samples, stride as u32],
                seed,
            ),
            (None, Matter::Ball { radius }) => trace(
                self.scene,
                &Ball(*radius),
                1.0,
                [samples, stride as u32],
                seed,
            ),
            (None, Matter::Cells(_)) => Picture::new(RESOLUTION * RESOLUTION),
        };
        picture.pixels()
    }
}
fn trace<M: Medium>(
    scene: &Yardstick,
    medium: &M,
    largest: f32,
    sampling: [u32; 2],
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
    let mut bank = Bank::new(scene, sampling);
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
            let ray = bank.next(medium, rng, |pixel, colour| land(pixel, colour, scene.sky));
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
