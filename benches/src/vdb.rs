//! Writes OpenVDB files, so that reading them can be timed on volumes of any size.
//!
//! One grid `density` of single precision as OpenVDB 10 lays it out: format 224, a 5-4-3 tree, inactive values left out,
//! chunks stored, zlib, or blosc (LZ4 after a byte shuffle, which is OpenVDB's default).

use flate2::{Compression, write::ZlibEncoder};
use std::collections::BTreeMap;
use std::io::{self, Write};

/// How the values of a leaf are packed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Codec {
    /// As they are.
    Stored,
    /// zlib.
    Zip,
    /// LZ4 in a blosc container.
    Blosc,
}

impl Codec {
    /// Its name.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Stored => "stored",
            Self::Zip => "zip",
            Self::Blosc => "blosc",
        }
    }

    /// The flags of compression in a file; inactive values are left out.
    const fn flags(self) -> u32 {
        const ACTIVE_MASK: u32 = 2;
        ACTIVE_MASK
            | match self {
                Self::Stored => 0,
                Self::Zip => 1,
                Self::Blosc => 4,
            }
    }
}

/// Voxels along an edge of a leaf, of a lower and of an upper node.
const LEAF: i32 = 8;
const LOWER: i32 = 128;
const UPPER: i32 = 4096;

/// A mask of values and the values, z fastest.
struct Leaf {
    mask: [u64; 8],
    values: Vec<f32>,
}

impl Leaf {
    /// The leaf at an origin; `None` where nothing is.
    fn new(origin: [i32; 3], side: i32, density: &impl Fn([i32; 3]) -> f32) -> Option<Self> {
        let mut leaf = Self {
            mask: [0; 8],
            values: Vec::new(),
        };
        for n in 0..512_i32 {
            let [x, y, z] = [n >> 6, n >> 3 & 7, n & 7];
            let at = [origin[0] + x, origin[1] + y, origin[2] + z];
            let inside = at.iter().all(|i| *i < side);
            let value = if inside { density(at) } else { 0.0 };
            if value > 0.0 {
                leaf.mask[n as usize >> 6] |= 1 << (n & 63);
                leaf.values.push(value);
            }
        }
        (!leaf.values.is_empty()).then_some(leaf)
    }
}

/// A file with a cube of `side`³ voxels whose edge is a unit long; voxels are active where the density is above zero.
///
/// # Errors
/// None that memory does not have.
pub fn cube(side: u32, codec: Codec, density: impl Fn([i32; 3]) -> f32) -> io::Result<Vec<u8>> {
    let side = side as i32;
    let mut out = Vec::new();
    out.write_all(&[0x20, 0x42, 0x44, 0x56, 0, 0, 0, 0])?;
    for word in [224_u32, 10, 0] {
        out.write_all(&word.to_le_bytes())?;
    }
    out.push(1); // grids tell where they lie
    out.extend([b'0'; 36]); // the unique identifier
    out.extend(0_u32.to_le_bytes()); // metadata
    out.extend(1_u32.to_le_bytes()); // grids
    for text in ["density", "Tree_float_5_4_3", ""] {
        string(&mut out, text);
    }
    let places = out.len();
    out.extend([0; 24]);
    let start = out.len() as i64;
    out.extend(codec.flags().to_le_bytes());
    out.extend(0_u32.to_le_bytes()); // metadata
    string(&mut out, "UniformScaleMap");
    let scale = 1.0 / f64::from(side);
    let derived = [
        scale,
        1.0 / scale,
        1.0 / (scale * scale),
        0.5 / scale,
        scale,
    ];
    for number in derived.iter().flat_map(|number| [number; 3]) {
        out.extend(number.to_le_bytes());
    }
    tree(&mut out, side, codec, &density)?;
    let end = out.len() as i64;
    for (at, place) in [start, start, end].into_iter().enumerate() {
        out[places + 8 * at..][..8].copy_from_slice(&place.to_le_bytes());
    }
    Ok(out)
}

fn string(out: &mut Vec<u8>, text: &str) {
    out.extend((text.len() as u32).to_le_bytes());
    out.extend(text.as_bytes());
}

/// Origins along one axis of the nodes of an edge within a parent.
fn steps(from: i32, edge: i32, within: i32, side: i32) -> impl Iterator<Item = i32> {
    (from..side.min(from + within)).step_by(edge as usize)
}

fn tree(
    out: &mut Vec<u8>,
    side: i32,
    codec: Codec,
    density: &impl Fn([i32; 3]) -> f32,
) -> io::Result<()> {
    // Leaves by the index of their lower node and their own, which is the order of files.
    let mut nodes: BTreeMap<usize, BTreeMap<usize, Leaf>> = BTreeMap::new();
    for x in steps(0, LEAF, UPPER, side) {
        for y in steps(0, LEAF, UPPER, side) {
            for z in steps(0, LEAF, UPPER, side) {
                if let Some(leaf) = Leaf::new([x, y, z], side, density) {
                    let lower = entry([x, y, z], LOWER, 32);
                    let own = entry([x, y, z].map(|i| i % LOWER), LEAF, 16);
                    nodes.entry(lower).or_default().insert(own, leaf);
                }
            }
        }
    }
    for word in [1_u32, 0, 0, 1] {
        out.extend(word.to_le_bytes()); // buffers, background, tiles and children of the root
    }
    out.extend([0; 12]); // origin of the child
    node(out, 1 << 15, nodes.keys(), codec)?;
    for leaves in nodes.values() {
        node(out, 1 << 12, leaves.keys(), codec)?;
        for leaf in leaves.values() {
            out.extend(bytes(&leaf.mask));
        }
    }
    for leaf in nodes.values().flat_map(BTreeMap::values) {
        out.extend(bytes(&leaf.mask));
        out.push(0); // what is inactive is background
        chunk(out, codec, &leaf.values)?;
    }
    Ok(())
}

/// The index of the entry of a node where a place lies.
fn entry(place: [i32; 3], edge: i32, across: i32) -> usize {
    let [x, y, z] = place.map(|i| i / edge);
    ((x * across + y) * across + z) as usize
}

fn bytes(mask: &[u64]) -> impl Iterator<Item = u8> {
    mask.iter().flat_map(|word| word.to_le_bytes())
}

/// Masks of a node without tiles.
fn node<'a>(
    out: &mut Vec<u8>,
    entries: usize,
    children: impl Iterator<Item = &'a usize>,
    codec: Codec,
) -> io::Result<()> {
    let mut mask = vec![0_u64; entries / 64];
    for child in children {
        mask[child / 64] |= 1 << (child % 64);
    }
    out.extend(bytes(&mask));
    out.extend(vec![0; entries / 8]);
    out.push(0);
    chunk(out, codec, &[])
}

fn chunk(out: &mut Vec<u8>, codec: Codec, values: &[f32]) -> io::Result<()> {
    let plain: Vec<u8> = values
        .iter()
        .flat_map(|value| value.to_le_bytes())
        .collect();
    let packed = match codec {
        Codec::Stored => {
            out.extend(plain);
            return Ok(());
        }
        Codec::Zip => {
            let mut encoder = ZlibEncoder::new(Vec::new(), Compression::default());
            encoder.write_all(&plain)?;
            encoder.finish()?
        }
        Codec::Blosc => blosc(&plain),
    };
    if packed.len() < plain.len() {
        out.extend((packed.len() as i64).to_le_bytes());
        out.extend(packed);
    } else {
        out.extend((-(plain.len() as i64)).to_le_bytes());
        out.extend(plain);
    }
    Ok(())
}

/// One block of one stream, shuffled.
fn blosc(plain: &[u8]) -> Vec<u8> {
    const WIDTH: usize = 4;
    let elements = plain.len() / WIDTH;
    let shuffled: Vec<u8> = (0..plain.len())
        .map(|at| plain[at % elements * WIDTH + at / elements])
        .collect();
    let stream = lz4_flex::block::compress(&shuffled);
    let total = 16 + 4 + 4 + stream.len();
    // Version 2 with LZ4 of version 1; shuffled, whole blocks; the size of an element.
    let mut packed = vec![2, 1, 0x01 | 0x10 | 1 << 5, WIDTH as u8];
    for word in [plain.len(), plain.len(), total, 20, stream.len()] {
        packed.extend((word as u32).to_le_bytes());
    }
    packed.extend(stream);
    packed
}

#[cfg(test)]
mod tests {
    use super::*;
    use woodcock_host::volume::{Limits, vdb};

    #[test]
    fn what_is_written_is_read() {
        let density = |[x, y, z]: [i32; 3]| {
            let inside = (x - 20).pow(2) + (y - 9).pow(2) + (z - 17).pow(2) < 150;
            if inside { (x + y * z) as f32 } else { 0.0 }
        };
        for codec in [Codec::Stored, Codec::Zip, Codec::Blosc] {
            let file = cube(37, codec, density).expect("a file");
            let file = vdb::read(&file, &Limits::default()).expect("a volume");
            let grid = file.grid("density").expect("a grid");
            let voxels = grid.voxels().expect("voxels");
            for n in 0..37_i32.pow(3) {
                let at = [n % 37, n / 37 % 37, n / 37 / 37];
                let found = voxels.value(at.map(i64::from));
                assert_eq!(found, f64::from(density(at)), "{codec:?} {at:?}");
            }
        }
    }
}
