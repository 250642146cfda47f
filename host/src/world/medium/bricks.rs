//! Samples of a grid in bricks, as [`woodcock_core::path::Bricks`] borrows them.

use std::ops::Range;

use woodcock_core::path::{
    BRICK, BRICK_SAMPLES, Bricks, Exact, brick_counts, code, code_floor, half_to_single,
};
use woodcock_core::real::Word32;

/// Samples of a grid, those of empty bricks only once.
#[derive(Clone, Debug, PartialEq)]
pub struct BrickTables {
    places: Vec<u32>,
    codes: Vec<u32>,
    exact: ExactTable,
    floor: u32,
    dims: [u32; 3],
}

/// The samples of bricks.
#[derive(Clone, Debug, PartialEq)]
enum ExactTable {
    Single(Vec<f32>),
    Half(Vec<u32>),
}

/// One brick.
type Brick = [f32; BRICK_SAMPLES];

impl BrickTables {
    /// Puts the samples of a dense grid into bricks, on all threads; `None` where they are too many for the indices.
    ///
    /// * `samples`: x fastest, finite and not negative. `dims`: of them, along x, y, z.
    ///
    /// Where half precision holds every sample, they are kept so.
    pub fn of_dense(samples: &[f32], dims: [u32; 3]) -> Option<Self> {
        let [nx, ny, nz] = brick_counts(dims);
        let lattice = |n: u32| [n % nx, n / nx % ny, n / (nx * ny)];
        let read = |n: u32| of_dense(samples, dims, lattice(n));
        let count = u64::from(nx) * u64::from(ny) * u64::from(nz);
        let count = u32::try_from(count).ok()?;
        let present = each(count, |n| {
            let brick = read(n);
            brick.iter().any(|v| *v > 0.0)
        });
        Self::new(dims, &present, read)
    }

    /// * `present`: which bricks of the lattice hold matter. `read`: the samples of one of these.
    pub(super) fn new(
        dims: [u32; 3],
        present: &[bool],
        read: impl Fn(u32) -> Brick + Send + Sync,
    ) -> Option<Self> {
        let full: Vec<u32> = (0..)
            .zip(present)
            .filter_map(|(n, p)| p.then_some(n))
            .collect();
        // Indices are gathered as signed; the first brick is the empty one.
        let samples = (full.len() + 1) * BRICK_SAMPLES;
        if samples > i32::MAX as usize {
            return None;
        }
        let mut places = vec![0; present.len()];
        for (brick, n) in full.iter().enumerate() {
            *places.get_mut(*n as usize)? = ((brick + 1) * BRICK_SAMPLES) as u32;
        }
        let mut exact = vec![0.0; samples];
        let (_, filled) = exact.split_at_mut(BRICK_SAMPLES);
        for_chunks(filled, BRICK_SAMPLES, |at, chunk| {
            if let Some(n) = full.get(at) {
                chunk.copy_from_slice(&read(*n));
            }
        });
        let floor = code_floor(exact.iter().copied().fold(0.0, f32::max));
        let mut codes = vec![0_u32; samples / 4];
        for_chunks(&mut codes, BRICK_SAMPLES / 4, |at, chunk| {
            let brick = exact.get(at * BRICK_SAMPLES..).unwrap_or_default();
            for (word, four) in chunk.iter_mut().zip(brick.chunks_exact(4)) {
                let bytes = std::array::from_fn(|i| code(four[i], floor));
                *word = u32::from_le_bytes(bytes);
            }
        });
        Some(Self {
            places,
            codes,
            exact: ExactTable::of(exact),
            floor,
            dims,
        })
    }

    /// For kernels.
    pub fn borrow(&self) -> Bricks<'_> {
        Bricks {
            places: &self.places,
            codes: &self.codes,
            exact: match &self.exact {
                ExactTable::Single(samples) => Exact::Single(samples),
                ExactTable::Half(pairs) => Exact::Half(pairs),
            },
            floor: self.floor,
        }
    }

    /// The sample of an index that a tap picked; zero beyond the last.
    pub fn sample(&self, index: u32) -> f32 {
        match &self.exact {
            ExactTable::Single(samples) => samples.get(index as usize).copied().unwrap_or(0.0),
            ExactTable::Half(pairs) => {
                let pair = pairs.get(index as usize / 2).copied().unwrap_or(0);
                half_to_single::<f32>(Word32(pair >> (index % 2 * 16) & 0xffff))
            }
        }
    }

    /// The index of the sample at coordinates within the grid.
    pub fn index(&self, [x, y, z]: [u32; 3]) -> u32 {
        let place = self.place([x, y, z].map(|i| i / BRICK));
        let within = |i: u32| i % BRICK;
        place + within(x) + BRICK * (within(y) + BRICK * within(z))
    }

    /// Where the samples of a brick of the lattice begin; zero where they are zeros.
    pub(super) fn place(&self, [x, y, z]: [u32; 3]) -> u32 {
        let [nx, ny, _] = brick_counts(self.dims);
        let brick = (z * ny + y) * nx + x;
        self.places.get(brick as usize).copied().unwrap_or(0)
    }

    /// Appends the samples of adjoining indices.
    pub(super) fn append_to(&self, found: &mut Vec<f32>, indices: Range<usize>) {
        match &self.exact {
            ExactTable::Single(samples) => {
                found.extend_from_slice(samples.get(indices).unwrap_or_default());
            }
            ExactTable::Half(_) => found.extend(indices.map(|i| self.sample(i as u32))),
        }
    }

    /// Samples along x, y, z.
    pub fn dims(&self) -> [u32; 3] {
        self.dims
    }

    /// Bytes of all tables.
    pub fn bytes(&self) -> u64 {
        let exact = match &self.exact {
            ExactTable::Single(samples) => samples.len(),
            ExactTable::Half(pairs) => pairs.len(),
        };
        4 * (self.places.len() + self.codes.len() + exact) as u64
    }

    /// Bricks that hold matter.
    pub fn present(&self) -> usize {
        (4 * self.codes.len() / BRICK_SAMPLES).saturating_sub(1)
    }

    /// Samples of the bricks that hold matter.
    pub fn samples(&self) -> u64 {
        (self.present() * BRICK_SAMPLES) as u64
    }

    /// Whether samples are in half precision.
    pub fn is_half(&self) -> bool {
        matches!(self.exact, ExactTable::Half(_))
    }
}

impl ExactTable {
    /// In half precision, if that changes nothing.
    fn of(samples: Vec<f32>) -> Self {
        let mut pairs = vec![0_u32; samples.len() / 2];
        let lossless = |at: usize, chunk: &mut [u32]| {
            let from = samples.get(at * BRICK_SAMPLES..).unwrap_or_default();
            let mut lossless = true;
            for (pair, two) in chunk.iter_mut().zip(from.chunks_exact(2)) {
                let halves = [half(two[0]), half(two[1])];
                lossless &= halves.iter().all(Option::is_some);
                let [low, high] = halves.map(|h| u32::from(h.unwrap_or(0)));
                *pair = low | high << 16;
            }
            lossless
        };
        // Most grids of single precision show it at once.
        let whole = std::sync::atomic::AtomicBool::new(true);
        for_chunks(&mut pairs, BRICK_SAMPLES / 2, |at, chunk| {
            use std::sync::atomic::Ordering::Relaxed;
            if whole.load(Relaxed) && !lossless(at, chunk) {
                whole.store(false, Relaxed);
            }
        });
        if whole.into_inner() {
            Self::Half(pairs)
        } else {
            Self::Single(samples)
        }
    }
}

/// The bits in half precision of a number from 0 to 65504 that it holds exactly.
fn half(value: f32) -> Option<u16> {
    // As `half_to_single` undoes it: a multiplication by a power of two, exact but where bits are lost below.
    let scaled = value * f32::from_bits((127 - 112) << 23);
    let bits = (scaled.to_bits() >> 13) as u16;
    let back = half_to_single::<f32>(Word32(u32::from(bits)));
    (bits < 0x7c00 && back.to_bits() == value.to_bits()).then_some(bits)
}

/// The samples of a brick of a dense grid; zeros beyond it.
fn of_dense(samples: &[f32], dims: [u32; 3], brick: [u32; 3]) -> Brick {
    let mut found = [0.0; BRICK_SAMPLES];
    let [nx, ny, nz] = dims;
    let first = brick.map(|b| b * BRICK);
    let edge = BRICK as usize;
    for (row, values) in found.chunks_exact_mut(edge).enumerate() {
        let (y, z) = (
            first[1] + (row % edge) as u32,
            first[2] + (row / edge) as u32,
        );
        if y < ny && z < nz {
            let from = (z as usize * ny as usize + y as usize) * nx as usize + first[0] as usize;
            let length = edge.min((nx - first[0]) as usize);
            let from = samples.get(from..from + length).unwrap_or_default();
            for (value, sample) in values.iter_mut().zip(from) {
                *value = *sample;
            }
        }
    }
    found
}

/// What a function makes of each number below `count`, in order, on all threads.
pub(super) fn each<T: Send>(count: u32, make: impl Fn(u32) -> T + Send + Sync) -> Vec<T> {
    crate::render::map_all(count, make)
}

/// Works on the pieces of a table, on all threads.
fn for_chunks<T: Send>(
    table: &mut [T],
    length: usize,
    work: impl Fn(usize, &mut [T]) + Send + Sync,
) {
    #[cfg(feature = "rayon")]
    {
        use rayon::prelude::*;
        let chunks = table.par_chunks_mut(length).enumerate();
        chunks.for_each(|(at, chunk)| work(at, chunk));
    }
    #[cfg(not(feature = "rayon"))]
    for (at, chunk) in table.chunks_mut(length).enumerate() {
        work(at, chunk);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Numbers of any size in a grid that no brick divides, most of it empty.
    fn samples(dims: [u32; 3], half: bool) -> Vec<f32> {
        let mut noise = 12_345_u32;
        let mut next = || {
            noise = noise.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            noise >> 8
        };
        let [nx, ny, nz] = dims;
        (0..nx * ny * nz)
            .map(|n| match (n % nx / 8 + n / nx % ny / 8, half) {
                (0 | 3, _) => 0.0,
                (_, true) => half_to_single::<f32>(Word32(next() % 0x7c00)),
                (_, false) => f32::from_bits(next() % 0x0070_0000 * 256),
            })
            .collect()
    }

    #[test]
    fn every_sample_is_found_again() {
        for half in [false, true] {
            let dims = [37, 19, 10];
            let dense = samples(dims, half);
            let bricks = BrickTables::of_dense(&dense, dims).expect("few samples");
            assert_eq!(bricks.is_half(), half);
            for (n, sample) in (0..).zip(&dense) {
                let at = [n % 37, n / 37 % 19, n / 37 / 19];
                let found = bricks.sample(bricks.index(at));
                assert_eq!(found.to_bits(), sample.to_bits(), "{at:?}");
            }
            // 5 × 3 × 2 bricks, of which those with x + y = 0 or 3 are empty.
            assert_eq!(bricks.present(), 30 - 2 * 4);
            let per_voxel = if half { 3.0 } else { 5.0 };
            let voxels = (bricks.present() + 1) * BRICK_SAMPLES;
            let expected = per_voxel * voxels as f64 + 4.0 * 30.0;
            assert_eq!(bricks.bytes() as f64, expected);
        }
    }

    #[test]
    fn bytes_bracket_their_samples() {
        let largest = 3.0e30_f32;
        let floor = code_floor(largest);
        let (mut tested, mut closest) = (0, 0.0_f32);
        for bits in (0..=largest.to_bits()).step_by(40_961) {
            let sample = f32::from_bits(bits);
            let c = u32::from(code(sample, floor));
            let number = |c: u32| f32::from_bits((c + floor) << 19);
            let low = if c == 0 { 0.0 } else { number(c) };
            assert!(low <= sample && sample < number(c + 1), "{sample:e}");
            if c > 0 {
                closest = closest.max((number(c + 1) - low) / low);
            }
            tested += 1;
        }
        assert!(tested > 40_000, "{tested}");
        // Four bits of mantissa.
        assert_eq!(closest, 1.0 / 16.0);
        assert_eq!(code(largest, floor), 255);
    }

    #[test]
    fn halves_are_known_exactly() {
        for bits in 0..0x7c00_u16 {
            let value = half_to_single::<f32>(Word32(u32::from(bits)));
            let exponent = i32::from(bits >> 10);
            let mantissa = f64::from(bits & 0x3ff) / 1024.0;
            let expected = if exponent == 0 {
                mantissa * 2.0_f64.powi(-14)
            } else {
                (1.0 + mantissa) * 2.0_f64.powi(exponent - 15)
            };
            assert_eq!(f64::from(value), expected);
            assert_eq!(half(value), Some(bits));
        }
        for not in [1e-9, 65_536.0, 0.1, 1.000_1, f32::INFINITY, -1.0] {
            assert_eq!(half(not), None, "{not}");
        }
    }
}
