//! A table of what the core computes, and its hash: one number that is the same on every machine.
//!
//! Ten thousand rows of free flights, weights and phase directions in closed forms and in a grid with empty
//! blocks, each with random numbers of its own. The body is generic over the number of lanes, so that scalar
//! code and packets fill the same table; firmware, WebAssembly and tests include this file as it stands.

use woodcock_core::free_flight::{Flight, analytic, decomposition, delta};
use woodcock_core::majorant::{MajorantGrid, fill_control_slab, fill_leaps, fill_slab};
use woodcock_core::medium::{Exponential, Grid, Homogeneous};
use woodcock_core::phase::{draine, henyey_greenstein, isotropic, rayleigh};
use woodcock_core::ray::Ray;
use woodcock_core::real::{Mask, Real};
use woodcock_core::stream::{Key, KeyedStream};
use woodcock_core::transmittance::residual_ratio::Mean;
use woodcock_core::transmittance::{self, comb, ratio, residual_ratio};
use woodcock_core::vec3::Vec3;

/// How many rows there are.
pub(crate) const ROWS: usize = 10_000;
/// The [hash] of the table.
pub(crate) const HASH: u64 = 0x8f1e_e3bc_7877_31ac;

/// Rows of a kind that follow each other: a multiple of the lanes of any packet, and a divisor of [`ROWS`].
pub(crate) const RUN: usize = 16;
/// Kinds of rows, in turn.
pub(crate) const KINDS: usize = 11;
const DIMS: [u32; 3] = [17, 9, 9];
const EDGE: u32 = 4;
/// Entries in a slab of a table over the blocks, rim included, and slabs.
const SLAB: usize = 6 * 4;
const SLABS: usize = 4;

/// The grid's memory: what the core borrows.
struct Memory {
    samples: [f32; 17 * 9 * 9],
    majorants: [f32; SLAB * SLABS],
    minorants: [f32; SLAB * SLABS],
    means: [f32; SLAB * SLABS],
}

impl Memory {
    /// Noise in [0, 1) beyond a few empty blocks.
    fn filled() -> Option<Self> {
        let mut memory = Self {
            samples: [0.0; _],
            majorants: [0.0; _],
            minorants: [0.0; _],
            means: [0.0; _],
        };
        for (i, sample) in memory.samples.iter_mut().enumerate() {
            let word = Key {
                seed: 0,
                pixel: 0,
                sample: i as u32,
            }
            .hash()
                >> 40;
            *sample = if i % 17 < 9 {
                0.0
            } else {
                word as f32 / 16_777_216.0
            };
        }
        let samples = &memory.samples;
        let slabs = memory.majorants.chunks_exact_mut(SLAB);
        let lower = memory.minorants.chunks_exact_mut(SLAB);
        let means = memory.means.chunks_exact_mut(SLAB);
        for (slab, ((majorants, minorants), means)) in slabs.zip(lower).zip(means).enumerate() {
            fill_slab(samples, DIMS, EDGE, slab, majorants).ok()?;
            fill_control_slab(samples, DIMS, EDGE, slab, [minorants, means]).ok()?;
        }
        fill_leaps(&mut memory.majorants, [4, 2, 2]).ok()?;
        Some(memory)
    }

    /// The grid, a voxel being a quarter of a unit of length.
    fn grid(&self) -> Option<Grid<'_>> {
        let bounds = MajorantGrid::with_edge(&self.samples, DIMS, EDGE, &self.majorants).ok()?;
        let bounds = bounds.with_controls(&self.minorants, &self.means).ok()?;
        let world_to_grid = [
            [4.0, 0.0, 0.0, 0.0],
            [0.0, 4.0, 0.0, 0.0],
            [0.0, 0.0, 4.0, 0.0],
        ];
        Grid::new(bounds, world_to_grid, 3.0)
    }
}

/// The media of the table, and the part of each ray that is looked at.
struct Media<'a> {
    fog: Homogeneous,
    air: Exponential,
    grid: Grid<'a>,
}

/// A direction, and its density.
fn scattered<R: Real>(ray: &Ray<R>, cos_theta: R, turn: R, density: R) -> [R; 4] {
    let Vec3 { x, y, z } = ray.direction.deflected(cos_theta, turn);
    [x, y, z, density]
}

/// A flight, and where it began.
fn flown<R: Real>(flight: Flight<R>, ray: &Ray<R>) -> [R; 4] {
    let Vec3 { x, y, z } = ray.origin;
    [flight.or_infinite(), x, y, z]
}

/// A weight, and the ray's direction.
fn weighed<R: Real>(weight: R, ray: &Ray<R>) -> [R; 4] {
    let Vec3 { x, y, z } = ray.direction;
    [weight, x, y, z]
}

/// Rows of one kind, one a lane.
fn rows<R: Real>(media: &Media<'_>, kind: usize, rng: &mut impl KeyedStream<R>) -> [R; 4] {
    let all = R::Mask::splat(true);
    // From anywhere in the grid to anywhere.
    let mut anywhere = || {
        let [x, y, z] = [4.0, 2.0, 2.0].map(|size| rng.uniform(all) * R::splat(size));
        Vec3::new(x, y, z)
    };
    let (origin, end) = (anywhere(), anywhere());
    let length = (end - origin).dot(end - origin).sqrt();
    let up = Vec3::splat([0.0, 0.0, 1.0]);
    let toss = up.deflected(isotropic::sample(rng.uniform(all)), rng.uniform(all));
    let short = length.lt(R::splat(1e-3));
    let direction = Vec3::select(short, toss, (end - origin) * (R::one() / length));
    let (ray, t) = (
        Ray { origin, direction },
        length.or_zero(all.and_not(short)),
    );
    let Media { fog, air, grid } = media;
    let g = rng.uniform(all) * R::splat(1.9) - R::splat(0.95);
    match kind {
        0 => flown(analytic::sample(fog, &ray, t, rng, all), &ray),
        1 => flown(analytic::sample(air, &ray, t, rng, all), &ray),
        2 => flown(delta::sample(grid, &ray, t, rng, all), &ray),
        3 => flown(decomposition::sample(grid, &ray, t, rng, all), &ray),
        4 => weighed(transmittance::analytic::estimate(air, &ray, t), &ray),
        5 => weighed(ratio::estimate(grid, &ray, t, rng, all), &ray),
        6 => weighed(
            residual_ratio::estimate::<Mean, R, _>(grid, &ray, t, rng, all),
            &ray,
        ),
        7 => weighed(comb::estimate(grid, &ray, t, 4, rng, all), &ray),
        8 => {
            let cos_theta = henyey_greenstein::sample(rng.uniform(all), g);
            let density = henyey_greenstein::eval(cos_theta, g);
            scattered(&ray, cos_theta, rng.uniform(all), density)
        }
        9 => {
            let cos_theta = rayleigh::sample(rng.uniform(all));
            scattered(&ray, cos_theta, rng.uniform(all), rayleigh::eval(cos_theta))
        }
        _ => {
            let cos_theta = draine::sample(rng.uniform(all), g, R::one());
            let density = draine::eval(cos_theta, g, R::one());
            scattered(&ray, cos_theta, rng.uniform(all), density)
        }
    }
}

/// Fills the table and calls `visit` with each row: what was found, and from where or whereto.
///
/// Nothing where the core refuses the table's own media.
#[inline(never)]
pub(crate) fn fill<R: Real, S: KeyedStream<R>>(mut visit: impl FnMut([f32; 4])) -> Option<()> {
    let memory = Memory::filled()?;
    let media = Media {
        fog: Homogeneous::new(0.7).ok()?,
        air: Exponential::new(1.5, [0.3, -0.2, 0.8]).ok()?,
        grid: memory.grid()?,
    };
    let mut rng = S::idle();
    for first in (0..ROWS).step_by(R::LANES) {
        for lane in 0..R::LANES {
            let sample = (first + lane) as u32;
            rng.set_key(
                lane,
                Key {
                    seed: 6,
                    pixel: 1,
                    sample,
                },
            );
        }
        let found = rows::<R>(&media, first / RUN % KINDS, &mut rng);
        for lane in 0..R::LANES {
            visit(found.map(|number| number.lane(lane)));
        }
    }
    Some(())
}

/// FNV-1a over the bits of the table, row by row, the lowest byte of each number first; zero where there is none.
pub(crate) fn hash<R: Real, S: KeyedStream<R>>() -> u64 {
    let mut hash = 0xcbf2_9ce4_8422_2325_u64;
    let filled = fill::<R, S>(|row| {
        for byte in row.iter().flat_map(|number| number.to_bits().to_le_bytes()) {
            hash = (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3);
        }
    });
    filled.map_or(0, |()| hash)
}
