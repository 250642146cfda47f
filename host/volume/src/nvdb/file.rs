//! The file around the grids: segments, each with a header, a list of grids, and their bytes.

use super::{MAGIC, grid};
use crate::Limits;
use crate::vdb::blosc;
use crate::vdb::bytes::{Budget, Cursor, filled};
use crate::vdb::codec::inflate;
use crate::vdb::{Grid, VdbError};

/// Bytes of a grid's entry in the list, its name apart.
const ENTRY: u64 = 176;
/// No codec unfolds a byte to more; zlib comes nearest.
const LARGEST_RATIO: u64 = 1040;

/// A NanoVDB file.
#[derive(Debug, Clone)]
pub struct NanoVdbFile {
    /// Major, minor and patch number of the version that wrote it; of the first segment.
    pub version: [u32; 3],
    /// Its grids, sorted by name.
    pub grids: Vec<Grid>,
}

impl NanoVdbFile {
    /// The first grid of that name.
    #[must_use]
    pub fn grid(&self, name: &str) -> Option<&Grid> {
        self.grids.iter().find(|grid| grid.name == name)
    }
}

/// A version as files pack it.
fn version(packed: u32) -> [u32; 3] {
    [packed >> 21, packed >> 10 & 0x7ff, packed & 0x3ff]
}

/// Refuses versions of another layout.
pub(super) fn checked_version(packed: u32) -> Result<[u32; 3], VdbError> {
    let version = version(packed);
    match version {
        [32, 3..=7, _] => Ok(version),
        [major, minor, _] => Err(VdbError::NanoVersion(major, minor)),
    }
}

/// How a grid's bytes are packed.
#[derive(Debug, Clone, Copy)]
enum Codec {
    Stored,
    Zip,
    Blosc,
}

impl Codec {
    fn new(cursor: &Cursor<'_>, id: u16) -> Result<Self, VdbError> {
        Ok(match id {
            0 => Self::Stored,
            1 => Self::Zip,
            2 => Self::Blosc,
            _ => {
                return Err(VdbError::Unsupported {
                    offset: cursor.offset(),
                    what: format!("codec {id} (0 to 2 exist: none, zip, blosc)"),
                });
            }
        })
    }

    const fn name(self) -> &'static str {
        match self {
            Self::Stored => "none",
            Self::Zip => "zip",
            Self::Blosc => "blosc",
        }
    }
}

/// An entry of the list of grids.
struct Entry {
    name: String,
    unpacked: u64,
    packed: u64,
    grid_type: u32,
    codec: Codec,
}

fn u64_of(cursor: &mut Cursor<'_>, what: &'static str) -> Result<u64, VdbError> {
    Ok(u64::from_le_bytes(cursor.array(what)?))
}

fn u16_of(cursor: &mut Cursor<'_>, what: &'static str) -> Result<u16, VdbError> {
    Ok(u16::from_le_bytes(cursor.array(what)?))
}

impl Entry {
    fn read(cursor: &mut Cursor<'_>) -> Result<Self, VdbError> {
        const WHAT: &str = "the list of grids";
        let unpacked = u64_of(cursor, WHAT)?;
        let packed = u64_of(cursor, WHAT)?;
        // A hash of the name, and the number of voxels.
        cursor.take(16, WHAT)?;
        let grid_type = cursor.u32(WHAT)?;
        // Class, boxes in the world and in index space, size of a voxel: the grid repeats them.
        cursor.take(4 + 48 + 24 + 24, WHAT)?;
        let name_size = cursor.u32(WHAT)?;
        // Counts of nodes and tiles.
        cursor.take(28, WHAT)?;
        let codec = u16_of(cursor, WHAT)?;
        let codec = Codec::new(cursor, codec)?;
        cursor.take(2, WHAT)?;
        checked_version(cursor.u32(WHAT)?)?;
        let name = cursor.take(name_size as usize, "the name of a grid")?;
        Ok(Self {
            name: text(name),
            unpacked,
            packed,
            grid_type,
            codec,
        })
    }

    /// The grid's own bytes.
    fn unpack(&self, cursor: &mut Cursor<'_>, budget: &mut Budget) -> Result<Vec<u8>, VdbError> {
        let start = cursor.offset();
        let damaged = |what: String| VdbError::Damaged {
            offset: start,
            what,
        };
        if self.unpacked > self.packed.saturating_mul(LARGEST_RATIO) {
            return Err(damaged(format!(
                "{} bytes are said to unfold to {}",
                self.packed, self.unpacked
            )));
        }
        budget.charge(self.unpacked, "a grid")?;
        match self.codec {
            Codec::Stored => {
                if self.packed != self.unpacked {
                    return Err(damaged(format!(
                        "a stored grid of {} bytes takes {}",
                        self.unpacked, self.packed
                    )));
                }
                let bytes = cursor.take(cursor.remaining(), "a grid")?;
                let mut out = filled(0_u8, self.unpacked, "a grid")?;
                out.copy_from_slice(bytes);
                Ok(out)
            }
            Codec::Zip => {
                let packed = chunk(cursor)?;
                let mut out = filled(0_u8, self.unpacked, "a grid")?;
                inflate(packed, &mut out).map_err(damaged)?;
                Ok(out)
            }
            Codec::Blosc => {
                let mut out = filled(0_u8, self.unpacked, "a grid")?;
                let mut rest = out.as_mut_slice();
                while !rest.is_empty() {
                    let packed = chunk(cursor)?;
                    let size = blosc::unpacked_size(packed).map_err(damaged)?;
                    if size == 0 || size > rest.len() {
                        return Err(damaged(format!(
                            "a blosc chunk unfolds to {size} bytes where {} are missing",
                            rest.len()
                        )));
                    }
                    let (part, beyond) = rest.split_at_mut(size);
                    blosc::decompress(packed, part).map_err(damaged)?;
                    rest = beyond;
                }
                Ok(out)
            }
        }
    }
}

/// Packed bytes with their number in front.
fn chunk<'a>(cursor: &mut Cursor<'a>) -> Result<&'a [u8], VdbError> {
    const WHAT: &str = "a packed grid";
    let size = u64_of(cursor, WHAT)?;
    cursor.need(size, WHAT)?;
    cursor.take(usize::try_from(size).unwrap_or(usize::MAX), WHAT)
}

/// Text up to the first zero byte; what is not UTF-8 is replaced.
pub(super) fn text(bytes: &[u8]) -> String {
    let end = bytes.iter().position(|b| *b == 0).unwrap_or(bytes.len());
    String::from_utf8_lossy(bytes.get(..end).unwrap_or_default()).into_owned()
}

/// Reads a file with all its grids.
///
/// # Errors
/// A [`VdbError`] that names what is wrong, the byte (within a grid: of its unpacked bytes), and the grid. Never panics.
pub fn read(bytes: &[u8], limits: &Limits) -> Result<NanoVdbFile, VdbError> {
    read_grids(bytes, limits, |_| true)
}

/// Reads a file with those of its grids whose name `wanted` accepts; the others cost nothing and may be damaged.
///
/// # Errors
/// As [`read`].
pub fn read_grids(
    bytes: &[u8],
    limits: &Limits,
    wanted: impl Fn(&str) -> bool,
) -> Result<NanoVdbFile, VdbError> {
    if !bytes.starts_with(&MAGIC) {
        return Err(VdbError::NotNanoVdb);
    }
    let mut cursor = Cursor::new(bytes);
    let mut budget = Budget::new(limits);
    let mut grids = Vec::new();
    let mut first = None;
    while cursor.remaining() > 0 {
        let version = match bytes.get(MAGIC.len()) {
            // Bare grids, as they lie in memory.
            Some(b'1') => bare(&mut cursor, &mut budget, &wanted, &mut grids)?,
            _ => segment(&mut cursor, &mut budget, &wanted, &mut grids)?,
        };
        first.get_or_insert(version);
    }
    // Names that several grids share are told apart by their place in the file, as those of OpenVDB are.
    grids.sort_by(|a: &Grid, b: &Grid| a.name.cmp(&b.name));
    Ok(NanoVdbFile {
        version: first.unwrap_or_default(),
        grids,
    })
}

fn segment(
    cursor: &mut Cursor<'_>,
    budget: &mut Budget,
    wanted: &impl Fn(&str) -> bool,
    grids: &mut Vec<Grid>,
) -> Result<[u32; 3], VdbError> {
    const WHAT: &str = "the header of a segment";
    let magic: [u8; 8] = cursor.array(WHAT)?;
    if !matches!(&magic, b"NanoVDB0" | b"NanoVDB2") {
        return Err(cursor.damaged("a segment does not begin with NanoVDB's magic number"));
    }
    let version = checked_version(cursor.u32(WHAT)?)?;
    let count = u16_of(cursor, WHAT)?;
    let codec = u16_of(cursor, WHAT)?;
    Codec::new(cursor, codec)?;
    cursor.need(u64::from(count) * ENTRY, "the list of grids")?;
    let mut entries = Vec::new();
    for _ in 0..count {
        let entry = Entry::read(cursor)?;
        budget.charge(256 + 4 * entry.name.len() as u64, "the list of grids")?;
        entries.push(entry);
    }
    for entry in entries {
        cursor
            .need(entry.packed, "a grid")
            .map_err(|error| error.in_grid(&entry.name))?;
        let start = cursor.offset();
        let window = cursor.window(start, start + entry.packed);
        let Some(mut window) = window else {
            return Err(cursor.damaged("a grid lies outside of the file"));
        };
        cursor.take(
            usize::try_from(entry.packed).unwrap_or(usize::MAX),
            "a grid",
        )?;
        if !wanted(&entry.name) {
            continue;
        }
        let mut read = || {
            let bytes = entry.unpack(&mut window, budget)?;
            let grid = grid::read(&bytes, budget, &entry.name, entry.codec.name())?;
            if grid.grid_type != entry.grid_type || grid.size != bytes.len() as u64 {
                return Err(cursor.damaged(format!(
                    "the list says type {} and {} bytes, the grid itself type {} and {} bytes",
                    entry.grid_type,
                    bytes.len(),
                    grid.grid_type,
                    grid.size
                )));
            }
            Ok(grid.grid)
        };
        grids.push(read().map_err(|error| error.in_grid(&entry.name))?);
    }
    Ok(version)
}

/// One grid without a header before it.
fn bare(
    cursor: &mut Cursor<'_>,
    budget: &mut Budget,
    wanted: &impl Fn(&str) -> bool,
    grids: &mut Vec<Grid>,
) -> Result<[u32; 3], VdbError> {
    let mut peek = cursor.clone();
    let header = grid::Header::read(peek.take(grid::HEADER, "the header of a grid")?)?;
    if header.size < grid::HEADER as u64 {
        return Err(cursor.damaged(format!("a grid is said to have {} bytes", header.size)));
    }
    cursor.need(header.size, "a grid")?;
    let bytes = cursor.take(usize::try_from(header.size).unwrap_or(usize::MAX), "a grid")?;
    if wanted(&header.name) {
        let read = grid::read(bytes, budget, &header.name, Codec::Stored.name());
        grids.push(read.map_err(|error| error.in_grid(&header.name))?.grid);
    }
    Ok(header.version)
}
