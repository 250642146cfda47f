//! A table of what the core computes, and its hash: one number that is the same on every machine.
//!
//! Ten thousand rows of free flights, weights and phase directions in closed forms and in a grid with empty
//! blocks, each with random numbers of its own. The body is generic over the number of lanes, so that scalar
//! code and packets fill the same table; firmware, WebAssembly and tests include this file as it stands.

use woodcock_core::free_flight::{analytic, delta};
use woodcock_core::majorant::{MajorantGrid, fill_leaps, fill_slab};
use woodcock_core::medium::{Exponential, Grid, Homogeneous};
use woodcock_core::phase::{draine, henyey_greenstein, rayleigh};
use woodcock_core::ray::Ray;
use woodcock_core::real::{Mask, Real};
use woodcock_core::stream::{Key, KeyedStream};
use woodcock_core::transmittance::{self, ratio};
use woodcock_core::vec3::Vec3;

/// How many rows there are.
pub(crate) const ROWS: usize = 10_000;
/// The [hash] of the table.
pub(crate) const HASH: u64 = 0xcb9f_295d_b90d_d8b5;

/// Rows of a kind that follow each other: a multiple of the lanes of any packet, and a divisor of [`ROWS`].
pub(crate) const RUN: usize = 16;
/// Kinds of rows, in turn.
pub(crate) const KINDS: usize = 8;
const DIMS: [u32; 3] = [17, 9, 9];
const EDGE: u32 = 4;
/// Entries in a slab of a table over the blocks, rim included, and slabs.
const SLAB: usize = 6 * 4;
const SLABS: usize = 4;

/// The grid's memory: what the core borrows.
struct Memory {
    samples: [f32; 17 * 9 * 9],
    majorants: [f32; SLAB * SLABS],
}

impl Memory {
    const EMPTY: Self = Self {
        samples: [0.0; _],
        majorants: [0.0; _],
    };

    /// Noise in [0, 1) beyond a few empty blocks, in place: firmware has no room for two of it.
    fn fill(&mut self) -> Option<()> {
        for (i, sample) in self.samples.iter_mut().enumerate() {
            let key = Key {
                seed: 0,
                pixel: 0,
                sample: i as u32,
            };
            *sample = if i % 17 < 9 {
                0.0
            } else {
                (key.hash() >> 40) as f32 / 16_777_216.0
            };
        }
        let slabs = self.majorants.chunks_exact_mut(SLAB);
        for (slab, entries) in slabs.enumerate() {
            fill_slab(&self.samples, DIMS, EDGE, slab, entries).ok()?;
        }
        fill_leaps(&mut self.majorants, [4, 2, 2]).ok()
    }

    /// The grid, a voxel being a quarter of a unit of length.
    fn grid(&self) -> Option<Grid<'_>> {
        let bounds = MajorantGrid::with_edge(&self.samples, DIMS, EDGE, &self.majorants).ok()?;
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

/// Rows of one kind, one a lane.
fn rows<R: Real>(media: &Media<'_>, kind: usize, rng: &mut impl KeyedStream<R>) -> [R; 4] {
    let all = R::Mask::splat(true);
    // From anywhere in the grid to anywhere.
    let mut anywhere = || {
        let [x, y, z] = [4.0, 2.0, 2.0].map(|size| rng.uniform(all) * R::splat(size));
        Vec3::new(x, y, z)
    };
    let (origin, end) = (anywhere(), anywhere());
    let t = (end - origin).dot(end - origin).sqrt();
    let up = Vec3::splat([0.0, 0.0, 1.0]);
    let direction = (end - origin) * (R::one() / t);
    let direction = Vec3::select(t.lt(R::splat(1e-3)), up, direction);
    let ray = Ray { origin, direction };
    let Media { fog, air, grid } = media;
    // Where the ray begins and what becomes of it …
    let with = |found: R| [found, origin.x, origin.y, origin.z];
    match kind {
        0 => return with(analytic::sample(fog, &ray, t, rng, all).or_infinite()),
        1 => return with(analytic::sample(air, &ray, t, rng, all).or_infinite()),
        2 => return with(delta::sample(grid, &ray, t, rng, all).or_infinite()),
        3 => return with(transmittance::analytic::estimate(air, &ray, t)),
        4 => return with(ratio::estimate(grid, &ray, t, rng, all)),
        _ => {}
    }
    // … or the density of a new direction, and the direction.
    let (u, turn) = (rng.uniform(all), rng.uniform(all));
    let g = rng.uniform(all) * R::splat(1.9) - R::splat(0.95);
    let (cos_theta, density) = match kind {
        5 => {
            let cos_theta = henyey_greenstein::sample(u, g);
            (cos_theta, henyey_greenstein::eval(cos_theta, g))
        }
        6 => {
            let cos_theta = rayleigh::sample(u);
            (cos_theta, rayleigh::eval(cos_theta))
        }
        _ => {
            let cos_theta = draine::sample(u, g, R::one());
            (cos_theta, draine::eval(cos_theta, g, R::one()))
        }
    };
    let Vec3 { x, y, z } = direction.deflected(cos_theta, turn);
    [density, x, y, z]
}

/// Fills the table and calls `visit` with each row: a flight, a weight or a density, and where from or whereto.
///
/// Nothing where the core refuses the table's own media.
#[inline(never)]
pub(crate) fn fill<R: Real, S: KeyedStream<R>>(mut visit: impl FnMut([f32; 4])) -> Option<()> {
    let mut memory = Memory::EMPTY;
    memory.fill()?;
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
