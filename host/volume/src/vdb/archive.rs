//! The file around the grids: header, descriptors, and which bytes belong to which grid.

use super::bytes::{Budget, Cursor};
use super::codec::Compression;
use super::values::{ValueReader, Voxel};
use super::voxels::{Typed, Voxels};
use super::{Grid, MAGIC, VdbError, VdbFile, metadata, transform, tree_read};
use crate::Limits;
use std::collections::{HashMap, HashSet};
use std::sync::Arc;

const VERSIONS: std::ops::RangeInclusive<u32> = 222..=225;
/// Marks, at the end of a type's name, that reals were saved as half floats.
const HALF_SUFFIX: &str = "_HalfFloat";
/// Separates a name from the number that makes it unique.
const SEPARATOR: char = '\u{1e}';

/// Where a grid is announced.
struct Descriptor {
    unique_name: String,
    type_name: String,
    half: bool,
    parent: String,
    /// Start and end of the grid's bytes; zero in files from a stream.
    start: i64,
    end: i64,
}

impl Descriptor {
    fn read(cursor: &mut Cursor<'_>) -> Result<Self, VdbError> {
        let unique_name = cursor.string("the name of a grid")?;
        let full_type = cursor.string("the type of a grid")?;
        let parent = cursor.string("the parent of a grid")?;
        let start = cursor.i64("the place of a grid")?;
        let _blocks = cursor.i64("the place of a grid")?;
        let end = cursor.i64("the place of a grid")?;
        let half = full_type.ends_with(HALF_SUFFIX);
        let type_name = full_type.trim_end_matches(HALF_SUFFIX).to_owned();
        Ok(Self {
            unique_name,
            type_name,
            half,
            parent,
            start,
            end,
        })
    }

    fn charge(&self, budget: &mut Budget) -> Result<(), VdbError> {
        let strings = self.unique_name.len() + self.type_name.len() + self.parent.len();
        budget.charge(1024 + 4 * strings as u64, "the list of grids")
    }

    fn name(&self) -> &str {
        let name = self.unique_name.split(SEPARATOR).next();
        name.unwrap_or_default()
    }
}

/// Reads a file; of its grids, those whose name `wanted` accepts.
pub(super) fn read(
    bytes: &[u8],
    limits: &Limits,
    wanted: &dyn Fn(&str) -> bool,
) -> Result<VdbFile, VdbError> {
    let mut cursor = Cursor::new(bytes);
    let cursor = &mut cursor;
    let mut budget = Budget::new(limits);
    if !bytes.starts_with(&MAGIC) {
        return Err(VdbError::NotVdb);
    }
    cursor.take(MAGIC.len(), "the magic number")?;
    let version = cursor.u32("the format version")?;
    if !VERSIONS.contains(&version) {
        return Err(VdbError::Version(version));
    }
    let library = (
        cursor.u32("the library version")?,
        cursor.u32("the library version")?,
    );
    let has_offsets = cursor.u8("the mark of grid offsets")? != 0;
    cursor.take(36, "the unique identifier")?;
    let metadata = metadata::read(cursor, &mut budget)?;
    let count = cursor.i32("the grid count")?;
    let count =
        u32::try_from(count).map_err(|_| cursor.damaged(format!("the grid count is {count}")))?;
    // Three string lengths and three places at least.
    cursor.need(u64::from(count) * 36, "the grids")?;

    let mut grids = if has_offsets {
        read_placed(cursor, &mut budget, count, wanted)?
    } else {
        read_stream(cursor, &mut budget, count)?
    };
    share(&mut grids);
    grids.retain(|grid| wanted(&grid.name));
    grids.sort_by(|a, b| (&a.name, &a.unique_name).cmp(&(&b.name, &b.unique_name)));
    Ok(VdbFile {
        version,
        library,
        metadata,
        grids,
    })
}

/// Grids of a file that tells where each lies: only what is wanted is read.
fn read_placed(
    cursor: &mut Cursor<'_>,
    budget: &mut Budget,
    count: u32,
    wanted: &dyn Fn(&str) -> bool,
) -> Result<Vec<Grid>, VdbError> {
    let mut placed = Vec::new();
    for n in 0..count {
        let descriptor = Descriptor::read(cursor)?;
        descriptor.charge(budget)?;
        let window = place(cursor, &descriptor, n + 1 == count)
            .map_err(|error| error.in_grid(descriptor.name()))?;
        placed.push((descriptor, window));
    }
    let parents: HashSet<String> = placed
        .iter()
        .filter(|(descriptor, _)| wanted(descriptor.name()))
        .map(|(descriptor, _)| descriptor.parent.clone())
        .collect();
    let mut grids = Vec::new();
    for (descriptor, mut window) in placed {
        if !wanted(descriptor.name()) && !parents.contains(&descriptor.unique_name) {
            continue;
        }
        let name = descriptor.name().to_owned();
        let grid = read_grid(&mut window, budget, descriptor);
        grids.push(grid.map_err(|error| error.in_grid(&name))?);
    }
    Ok(grids)
}

/// Grids of a file written to a stream: each must be read to find the next.
fn read_stream(
    cursor: &mut Cursor<'_>,
    budget: &mut Budget,
    count: u32,
) -> Result<Vec<Grid>, VdbError> {
    let mut grids = Vec::new();
    for n in 0..count {
        let descriptor = Descriptor::read(cursor)?;
        descriptor.charge(budget)?;
        let name = descriptor.name().to_owned();
        let grid = read_grid(cursor, budget, descriptor);
        let grid = grid.map_err(|error| error.in_grid(&name))?;
        if grid.voxels.is_none() && grid.instance_of.is_none() && n + 1 < count {
            let reason = grid.reason.as_deref().unwrap_or("an unknown grid");
            let what = format!(
                "{reason}, and a file without grid offsets does not tell where the next grid begins; save it with \
                 OpenVDB's io::File"
            );
            let offset = cursor.offset();
            return Err(VdbError::Unsupported { offset, what }.in_grid(&name));
        }
        grids.push(grid);
    }
    Ok(grids)
}

/// The bytes of a grid; `cursor` moves on to the next descriptor.
///
/// They must follow their descriptor and not overlap the next one: so no byte is read twice, and no file can ask for more
/// time than its length is worth.
fn place<'a>(
    cursor: &mut Cursor<'a>,
    descriptor: &Descriptor,
    last: bool,
) -> Result<Cursor<'a>, VdbError> {
    let here = cursor.offset();
    let file_end = here + cursor.remaining() as u64;
    let wrong = |cursor: &Cursor<'_>, what: &str, at: i64| {
        cursor.damaged(format!(
            "the grid is said to {what} at byte {at}, outside of {here} to {file_end}"
        ))
    };
    let start = u64::try_from(descriptor.start).unwrap_or(0);
    if !(here..=file_end).contains(&start) {
        return Err(wrong(cursor, "begin", descriptor.start));
    }
    // Nothing depends on where the last grid ends.
    let end = match u64::try_from(descriptor.end) {
        Ok(end) if (start..=file_end).contains(&end) => end,
        _ if last => file_end,
        Ok(end) if end > file_end => {
            return Err(VdbError::Truncated {
                what: "a grid",
                offset: start,
                needed: end - start,
                available: file_end - start,
            });
        }
        _ => return Err(wrong(cursor, "end", descriptor.end)),
    };
    let windows = (cursor.window(start, end), cursor.window(end, file_end));
    let (Some(window), Some(rest)) = windows else {
        return Err(wrong(cursor, "lie", descriptor.start));
    };
    *cursor = rest;
    Ok(window)
}

fn read_grid(
    cursor: &mut Cursor<'_>,
    budget: &mut Budget,
    descriptor: Descriptor,
) -> Result<Grid, VdbError> {
    let compression = Compression::read(cursor)?;
    let metadata = metadata::read(cursor, budget)?;
    let transform = transform::read(cursor)?;
    let instance_of = (!descriptor.parent.is_empty()).then(|| descriptor.parent.clone());
    let mut reason = None;
    let mut voxels = None;
    if instance_of.is_none() {
        let mut reader = ValueReader::new(compression, descriptor.half);
        match read_voxels(cursor, budget, &descriptor.type_name, &mut reader)? {
            Some(typed) => voxels = Some(Arc::new(Voxels(typed))),
            None => {
                reason = Some(format!(
                    "grids of type `{}` are not supported (5-4-3 trees of {SUPPORTED} are)",
                    descriptor.type_name
                ));
            }
        }
    }
    if transform.affine().is_none() && reason.is_none() {
        reason = Some("its frustum transform is not linear".to_owned());
    }
    Ok(Grid {
        name: descriptor.name().to_owned(),
        unique_name: descriptor.unique_name,
        type_name: descriptor.type_name,
        instance_of,
        half: descriptor.half,
        metadata,
        transform,
        voxels,
        reason,
    })
}

#[cfg(feature = "all-types")]
const SUPPORTED: &str = "float, double, half, int32, int64, bool, vec3s, vec3d and vec3i";
#[cfg(not(feature = "all-types"))]
const SUPPORTED: &str = "float and half";

fn read_voxels(
    cursor: &mut Cursor<'_>,
    budget: &mut Budget,
    type_name: &str,
    reader: &mut ValueReader,
) -> Result<Option<Typed>, VdbError> {
    fn tree<T: Voxel>(
        cursor: &mut Cursor<'_>,
        budget: &mut Budget,
        reader: &mut ValueReader,
        wrap: impl Fn(super::tree::Tree<T>) -> Typed,
    ) -> Result<Option<Typed>, VdbError> {
        tree_read::read(cursor, budget, reader).map(|tree| Some(wrap(tree)))
    }
    match type_name {
        "Tree_float_5_4_3" => tree(cursor, budget, reader, Typed::Float),
        #[cfg(feature = "all-types")]
        "Tree_double_5_4_3" => tree(cursor, budget, reader, Typed::Double),
        "Tree_half_5_4_3" => tree(cursor, budget, reader, Typed::Half),
        #[cfg(feature = "all-types")]
        "Tree_int32_5_4_3" => tree(cursor, budget, reader, Typed::Int32),
        #[cfg(feature = "all-types")]
        "Tree_int64_5_4_3" => tree(cursor, budget, reader, Typed::Int64),
        #[cfg(feature = "all-types")]
        "Tree_bool_5_4_3" => tree(cursor, budget, reader, Typed::Bool),
        #[cfg(feature = "all-types")]
        "Tree_vec3s_5_4_3" => tree(cursor, budget, reader, Typed::Vec3s),
        #[cfg(feature = "all-types")]
        "Tree_vec3d_5_4_3" => tree(cursor, budget, reader, Typed::Vec3d),
        #[cfg(feature = "all-types")]
        "Tree_vec3i_5_4_3" => tree(cursor, budget, reader, Typed::Vec3i),
        _ => Ok(None),
    }
}

/// Gives instances the values of their parents.
fn share(grids: &mut [Grid]) {
    let parents: HashMap<String, (Option<Arc<Voxels>>, Option<String>)> = grids
        .iter()
        .filter(|grid| grid.instance_of.is_none())
        .map(|grid| {
            let shared = (grid.voxels.clone(), grid.reason.clone());
            (grid.unique_name.clone(), shared)
        })
        .collect();
    for grid in grids {
        let Some(parent) = &grid.instance_of else {
            continue;
        };
        let reason = match parents.get(parent) {
            Some((Some(voxels), _)) => {
                grid.voxels = Some(Arc::clone(voxels));
                None
            }
            Some((None, reason)) => reason.clone(),
            None => Some(format!(
                "its values are those of `{parent}`, which is missing"
            )),
        };
        grid.reason = grid.reason.take().or(reason);
    }
}
