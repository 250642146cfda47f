//! Mitsuba's grids (`.vol`): a header of 48 bytes and dense values.
//!
//! ```text
//! "VOL" 3 | encoding | nx ny nz | channels | box: 6 x float | values, channel fastest, then x, y, z
//! ```
//!
//! All little endian; encodings are 1 (float), 2 (half) and 3 (bytes, 255 being one). A voxel's value lies at the centre of
//! its cell; between centres it is interpolated trilinearly, between the outermost centres and the box it is constant, and
//! beyond the box there is nothing. Mitsuba maps the box to the unit cube: the box of the file is told, not used.
//!
//! Damaged files end in an error that says what is wrong; nothing is allocated before the file is known to hold it.

use super::Limits;
use half::f16;

/// The first three bytes of every such file.
pub const MAGIC: [u8; 3] = *b"VOL";

/// Bytes before the values.
const HEADER: usize = 48;
const VERSION: u8 = 3;

/// How values are stored.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Encoding {
    /// Single precision.
    Float32,
    /// Half precision.
    Float16,
    /// Bytes, 255 being one.
    UInt8,
}

impl Encoding {
    /// Its name.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Float32 => "float32",
            Self::Float16 => "float16",
            Self::UInt8 => "uint8",
        }
    }

    const fn bytes(self) -> u64 {
        match self {
            Self::Float32 => 4,
            Self::Float16 => 2,
            Self::UInt8 => 1,
        }
    }
}

/// Why a file cannot be read.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum VolError {
    /// The first three bytes are not Mitsuba's.
    #[error(
        "not a Mitsuba volume: the magic number is missing at byte 0; check that this is the file you meant"
    )]
    NotVol,
    /// The header contradicts the format, or asks for what is beyond this reader.
    #[error("the header is wrong at byte {offset}: {what}")]
    Header {
        /// Where \[bytes\].
        offset: usize,
        /// What is wrong.
        what: String,
    },
    /// The file has another length than its header asks for.
    #[error(
        "{needed} bytes are needed, the file has {found}: it is truncated or damaged; fetch or export it again"
    )]
    Length {
        /// What the header asks for \[bytes\].
        needed: u64,
        /// What there is \[bytes\].
        found: u64,
    },
    /// More memory than [`Limits`] allows.
    #[error(
        "the values need {needed} bytes of memory, the limit is {limit}; raise --max-memory or use a smaller volume"
    )]
    Memory {
        /// What they need \[bytes\].
        needed: u64,
        /// The limit \[bytes\].
        limit: u64,
    },
    /// A value that is NaN or infinite.
    #[error("voxel ({}, {}, {}), channel {channel}, is {value}", at[0], at[1], at[2])]
    Value {
        /// Its indices along x, y and z.
        at: [usize; 3],
        /// Its channel.
        channel: usize,
        /// The value, as text.
        value: String,
    },
}

/// A grid in Mitsuba's format.
#[derive(Debug, Clone, PartialEq)]
pub struct VolGrid {
    /// How the values were stored.
    pub encoding: Encoding,
    /// Voxels along x, y and z; each at least 1.
    pub size: [usize; 3],
    /// 1 or 3.
    pub channels: usize,
    /// Lower and upper corner of the box that the file tells.
    pub bounds: [[f32; 3]; 2],
    /// Finite; channel fastest, then x, y, z.
    pub values: Vec<f32>,
}

fn word(bytes: &[u8], at: usize) -> [u8; 4] {
    let mut word = [0; 4];
    if let Some(from) = bytes.get(at..at + 4) {
        word.copy_from_slice(from);
    }
    word
}

/// Reads a file.
///
/// # Errors
/// A [`VolError`]. Never panics.
pub fn read(bytes: &[u8], limits: &Limits) -> Result<VolGrid, VolError> {
    if !bytes.starts_with(&MAGIC) {
        return Err(VolError::NotVol);
    }
    let found = bytes.len() as u64;
    if bytes.len() < HEADER {
        let needed = HEADER as u64;
        return Err(VolError::Length { needed, found });
    }
    let wrong = |offset: usize, what: String| VolError::Header { offset, what };
    let version = bytes.get(3).copied().unwrap_or_default();
    if version != VERSION {
        return Err(wrong(3, format!("version {version} (3 is supported)")));
    }
    let i32_at = |at| i32::from_le_bytes(word(bytes, at));
    let encoding = match i32_at(4) {
        1 => Encoding::Float32,
        2 => Encoding::Float16,
        3 => Encoding::UInt8,
        other => {
            let what =
                format!("encoding {other} (1, 2 and 3 are supported: float32, float16, uint8)");
            return Err(wrong(4, what));
        }
    };
    let mut size = [0_usize; 3];
    for (axis, n) in size.iter_mut().enumerate() {
        let told = i32_at(8 + 4 * axis);
        *n = usize::try_from(told)
            .ok()
            .filter(|n| *n > 0)
            .ok_or_else(|| wrong(8 + 4 * axis, format!("{told} voxels along an axis")))?;
    }
    let channels = match i32_at(20) {
        1 => 1,
        3 => 3,
        other => {
            return Err(wrong(
                20,
                format!("{other} channels (1 and 3 are supported)"),
            ));
        }
    };
    let corner = |at: usize| [0, 4, 8].map(|n| f32::from_le_bytes(word(bytes, at + n)));
    let bounds = [corner(24), corner(36)];
    let [low, high] = bounds;
    // Not `low >= high`: a NaN bounds nothing.
    if !(0..3).all(|a| low[a] < high[a] && (high[a] - low[a]).is_finite()) {
        let what = format!("the box from {low:?} to {high:?} has no inside");
        return Err(wrong(24, what));
    }
    let count = size
        .iter()
        .fold(channels as u64, |count, n| count.saturating_mul(*n as u64));
    let needed = count
        .saturating_mul(encoding.bytes())
        .saturating_add(HEADER as u64);
    if needed > found {
        return Err(VolError::Length { needed, found });
    }
    let memory = count.saturating_mul(4);
    if memory > limits.max_memory {
        let limit = limits.max_memory;
        return Err(VolError::Memory {
            needed: memory,
            limit,
        });
    }
    let stored = usize::try_from(needed).ok();
    let stored = stored
        .and_then(|end| bytes.get(HEADER..end))
        .unwrap_or_default();
    let values: Vec<f32> = match encoding {
        Encoding::Float32 => stored
            .chunks_exact(4)
            .map(|b| f32::from_le_bytes(word(b, 0)))
            .collect(),
        Encoding::Float16 => stored
            .chunks_exact(2)
            .map(|b| f16::from_le_bytes([b[0], b[1]]).to_f32())
            .collect(),
        Encoding::UInt8 => stored.iter().map(|b| f32::from(*b) / 255.0).collect(),
    };
    if let Some(n) = values.iter().position(|v| !v.is_finite()) {
        let voxel = n / channels;
        let [nx, ny, _] = size;
        return Err(VolError::Value {
            at: [voxel % nx, voxel / nx % ny, voxel / nx / ny],
            channel: n % channels,
            value: values[n].to_string(),
        });
    }
    Ok(VolGrid {
        encoding,
        size,
        channels,
        bounds,
        values,
    })
}

impl VolGrid {
    /// The value of a voxel's channel, that of the nearest voxel where there is none.
    #[must_use]
    pub fn value(&self, at: [i64; 3], channel: usize) -> f32 {
        let [x, y, z] = [0, 1, 2].map(|a| {
            let last = self.size[a] as i64 - 1;
            at[a].clamp(0, last) as usize
        });
        let voxel = (z * self.size[1] + y) * self.size[0] + x;
        let index = voxel * self.channels + channel.min(self.channels - 1);
        self.values.get(index).copied().unwrap_or_default()
    }

    /// The interpolant at a point of the unit cube; zero beyond it, NaN where the point is not finite.
    #[must_use]
    pub fn trilinear(&self, channel: usize, [x, y, z]: [f64; 3]) -> f64 {
        let p = [x, y, z];
        if p.iter().any(|v| !v.is_finite()) {
            return f64::NAN;
        }
        if p.iter().any(|v| !(0.0..=1.0).contains(v)) {
            return 0.0;
        }
        let p: [f64; 3] = std::array::from_fn(|a| p[a] * self.size[a] as f64 - 0.5);
        self.interpolated(channel, p)
    }

    /// The interpolant in index space, where integers are centres.
    fn interpolated(&self, channel: usize, p: [f64; 3]) -> f64 {
        let cell = p.map(f64::floor);
        let w: [f64; 3] = std::array::from_fn(|a| p[a] - cell[a]);
        let mut sum = 0.0;
        for i in 0..8_usize {
            let far = [i & 1, i >> 1 & 1, i >> 2];
            let weight: f64 = (0..3)
                .map(|a| if far[a] == 1 { w[a] } else { 1.0 - w[a] })
                .product();
            let at = std::array::from_fn(|a| cell[a] as i64 + far[a] as i64);
            sum += weight * f64::from(self.value(at, channel));
        }
        sum
    }

    /// Line integral \[value · length\] of the interpolant along a segment of the unit cube's space, exact up to rounding;
    /// NaN where an end is not finite.
    #[must_use]
    pub fn line_integral(&self, channel: usize, from: [f64; 3], to: [f64; 3]) -> f64 {
        let d: [f64; 3] = std::array::from_fn(|a| to[a] - from[a]);
        if from.iter().chain(&d).any(|v| !v.is_finite()) {
            return f64::NAN;
        }
        // Clipped to the cube.
        let (mut t0, mut t1) = (0.0_f64, 1.0_f64);
        for a in 0..3 {
            if d[a] == 0.0 {
                if !(0.0..=1.0).contains(&from[a]) {
                    return 0.0;
                }
                continue;
            }
            let (near, far) = (-from[a] / d[a], (1.0 - from[a]) / d[a]);
            t0 = t0.max(near.min(far));
            t1 = t1.min(near.max(far));
        }
        if t0 >= t1 {
            return 0.0;
        }
        // Where the segment crosses planes through centres: in between the integrand is a cubic in t.
        let mut cuts = vec![t0, t1];
        for a in 0..3 {
            let n = self.size[a] as f64;
            let at = |t: f64| (from[a] + t * d[a]) * n - 0.5;
            let (low, high) = (at(t0).min(at(t1)), at(t0).max(at(t1)));
            let mut plane = low.floor().max(-1.0) + 1.0;
            while plane < high && plane < n {
                let t = ((plane + 0.5) / n - from[a]) / d[a];
                if t0 < t && t < t1 {
                    cuts.push(t);
                }
                plane += 1.0;
            }
        }
        cuts.sort_by(f64::total_cmp);
        let value = |t: f64| {
            let p = std::array::from_fn(|a| (from[a] + t * d[a]) * self.size[a] as f64 - 0.5);
            self.interpolated(channel, p)
        };
        let third = 1.0 / 3.0_f64.sqrt();
        let mean: f64 = cuts
            .windows(2)
            .map(|pair| {
                let (middle, half) = (0.5 * (pair[0] + pair[1]), 0.5 * (pair[1] - pair[0]));
                half * (value(middle - half * third) + value(middle + half * third))
            })
            .sum();
        mean * (d[0] * d[0] + d[1] * d[1] + d[2] * d[2]).sqrt()
    }

    /// Least and greatest value and the sum of a channel.
    #[must_use]
    pub fn statistics(&self, channel: usize) -> (f32, f32, f64) {
        let values = self.values.iter().skip(channel).step_by(self.channels);
        values.fold(
            (f32::INFINITY, f32::NEG_INFINITY, 0.0),
            |(low, high, sum), v| (low.min(*v), high.max(*v), sum + f64::from(*v)),
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ramp() -> VolGrid {
        let size = [4, 3, 2];
        // Linear in each index: the interpolant within the centres is the same function.
        let values = (0..24)
            .map(|n| (n % 4) as f32 + 10.0 * (n / 4 % 3) as f32 + 100.0 * (n / 12) as f32)
            .collect();
        VolGrid {
            encoding: Encoding::Float32,
            size,
            channels: 1,
            bounds: [[0.0; 3], [1.0; 3]],
            values,
        }
    }

    #[test]
    fn the_interpolant_meets_centres_and_is_constant_beyond_them() {
        let grid = ramp();
        assert_eq!(grid.trilinear(0, [0.375, 0.5, 0.25]), 11.0);
        let between = grid.trilinear(0, [0.5, 0.5, 0.5]);
        assert!((between - 61.5).abs() < 1e-12, "{between}");
        assert_eq!(grid.trilinear(0, [0.0, 0.0, 0.0]), 0.0);
        assert_eq!(grid.trilinear(0, [1.0, 1.0, 1.0]), 123.0);
        assert_eq!(grid.trilinear(0, [1.01, 0.5, 0.5]), 0.0);
        assert!(grid.trilinear(0, [f64::NAN, 0.5, 0.5]).is_nan());
    }

    #[test]
    fn line_integrals_are_those_of_a_fine_quadrature() {
        let mut grid = ramp();
        // No longer linear.
        for (n, value) in grid.values.iter_mut().enumerate() {
            *value = ((n * n * 7 + 3) % 11) as f32;
        }
        let segments = [
            ([-0.5, 0.1, 0.2], [1.5, 0.8, 0.9]),
            ([0.9, 0.9, 0.9], [0.1, 0.05, 0.2]),
            ([0.5, -1.0, 0.5], [0.5, 2.0, 0.5]),
            ([2.0, 2.0, 2.0], [3.0, 2.0, 2.0]),
        ];
        for (from, to) in segments {
            const STEPS: u32 = 200_000;
            let at = |t: f64| std::array::from_fn(|a| from[a] + t * (to[a] - from[a]));
            let mean: f64 = (0..STEPS)
                .map(|i| grid.trilinear(0, at((f64::from(i) + 0.5) / f64::from(STEPS))))
                .sum::<f64>()
                / f64::from(STEPS);
            let length = (0..3)
                .map(|a| (to[a] - from[a]) * (to[a] - from[a]))
                .sum::<f64>()
                .sqrt();
            let exact = grid.line_integral(0, from, to);
            // The clipped ends cost the quadrature a step each.
            assert!(
                (exact - mean * length).abs() < 2e-4,
                "{exact} {mean} {length}"
            );
            let back = grid.line_integral(0, to, from);
            assert!((exact - back).abs() < 1e-12);
        }
    }
}
