//! What `woodcock info` says about a volume file: grids, ranges, sparsity, metadata; values at points, along segments.
//!
//! The format is told from the content, not from the file's name.

mod mitsuba;

use crate::volume::vdb::{self, Grid, MetaValue, Metadata, Statistics, VdbError};
use crate::volume::vol::{self, VolError, VolGrid};
use crate::volume::{Limits, nvdb};
use crate::world::{Held, held};
use glam::DVec3;
use serde_json::{Map, Value, json};
use std::cell::RefCell;
use std::collections::BTreeSet;
use std::fmt::Write;

/// What to tell.
#[derive(Debug, Clone, Default)]
pub struct InfoOptions {
    /// Only the grids of this name.
    pub grid: Option<String>,
    /// World points at which to tell the trilinear value.
    pub at: Vec<[f64; 3]>,
    /// World segments (from, to) along which to tell the line integral.
    pub rays: Vec<[f64; 6]>,
    /// What reading may cost.
    pub limits: Limits,
}

/// Why there is nothing to tell.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum InfoError {
    /// The error of the readers of OpenVDB and NanoVDB files.
    #[error(transparent)]
    Vdb(#[from] VdbError),
    /// The error of the reader of Mitsuba's grids.
    #[error(transparent)]
    Vol(#[from] VolError),
    /// A format that is recognised, and no volume.
    #[error("{0} files hold images, not volumes")]
    NoVolume(&'static str),
    /// No volume format that we know.
    #[error(
        "unknown format: the first bytes are none of OpenVDB's, NanoVDB's, Mitsuba's .vol or OpenEXR's"
    )]
    UnknownFormat,
    /// No grid has the name that was asked for.
    #[error("there is no grid `{name}`; the file has: {available}")]
    NoSuchGrid {
        /// The name asked for.
        name: String,
        /// The names there are.
        available: String,
    },
}

/// Formats that the first bytes tell apart.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Format {
    OpenVdb,
    NanoVdb,
    MitsubaVol,
    OpenExr,
}

fn sniff(bytes: &[u8]) -> Option<Format> {
    // NanoVDB has three magic numbers, "NanoVDB0" to "NanoVDB2".
    match bytes {
        _ if bytes.starts_with(&vdb::MAGIC) => Some(Format::OpenVdb),
        _ if bytes.starts_with(&nvdb::MAGIC) => Some(Format::NanoVdb),
        _ if bytes.starts_with(&vol::MAGIC) => Some(Format::MitsubaVol),
        _ if bytes.starts_with(&[0x76, 0x2f, 0x31, 0x01]) => Some(Format::OpenExr),
        _ => None,
    }
}

/// What a file holds.
enum File {
    Trees(Trees),
    Mitsuba(VolGrid),
}

/// Grids of a file of sparse trees, and what the file says of itself.
struct Trees {
    /// Name of the format.
    format: &'static str,
    version: Value,
    /// Version of the library that wrote it, where that is another one.
    library: Option<String>,
    metadata: Metadata,
    grids: Vec<Grid>,
}

fn open(bytes: &[u8], options: &InfoOptions) -> Result<File, InfoError> {
    let names = RefCell::new(BTreeSet::new());
    let wanted = |name: &str| {
        names.borrow_mut().insert(format!("`{name}`"));
        options.grid.as_ref().is_none_or(|wanted| name == wanted)
    };
    let trees = match sniff(bytes) {
        Some(Format::OpenVdb) => {
            let file = vdb::read_grids(bytes, &options.limits, wanted)?;
            Trees {
                format: "OpenVDB",
                version: json!(file.version),
                library: Some(format!("{}.{}", file.library.0, file.library.1)),
                metadata: file.metadata,
                grids: file.grids,
            }
        }
        Some(Format::NanoVdb) => {
            let file = nvdb::read_grids(bytes, &options.limits, wanted)?;
            let [major, minor, patch] = file.version;
            Trees {
                format: "NanoVDB",
                version: json!(format!("{major}.{minor}.{patch}")),
                library: None,
                metadata: Metadata::new(),
                grids: file.grids,
            }
        }
        Some(Format::MitsubaVol) => {
            return match &options.grid {
                Some(name) if !name.is_empty() => Err(InfoError::NoSuchGrid {
                    name: name.clone(),
                    available: "one grid without a name".to_owned(),
                }),
                _ => Ok(File::Mitsuba(vol::read(bytes, &options.limits)?)),
            };
        }
        Some(Format::OpenExr) => return Err(InfoError::NoVolume("OpenEXR")),
        None => return Err(InfoError::UnknownFormat),
    };
    match &options.grid {
        Some(wanted) if trees.grids.is_empty() => {
            let names: Vec<_> = names.into_inner().into_iter().collect();
            Err(InfoError::NoSuchGrid {
                name: wanted.clone(),
                available: names.join(", "),
            })
        }
        _ => Ok(File::Trees(trees)),
    }
}

/// A number, or the string nan, inf or -inf: JSON has none of them.
fn number(value: f64) -> Value {
    if value.is_nan() {
        json!("nan")
    } else if value.is_infinite() {
        json!(if value > 0.0 { "inf" } else { "-inf" })
    } else {
        json!(value)
    }
}

/// One voxel value in the manner of its grid: a truth value, a whole number, a number, or a list of three.
fn voxel_value(grid: &Grid, value: [f64; 3]) -> Value {
    let Ok(voxels) = grid.voxels() else {
        return Value::Null;
    };
    let scalar = |v: f64| {
        if voxels.is_bool() {
            json!(v != 0.0)
        } else if voxels.is_integral() {
            json!(v as i64)
        } else {
            number(v)
        }
    };
    if voxels.components() == 1 {
        return scalar(value[0]);
    }
    Value::Array(value.map(scalar).to_vec())
}

/// An interpolated or integrated value: never whole, never a truth value.
fn real_value(
    grid: &Grid,
    of: impl Fn(&Grid, usize) -> Result<f64, VdbError>,
) -> Result<Value, VdbError> {
    let components = grid.voxels()?.components();
    let values = (0..components).map(|n| of(grid, n).map(number));
    let mut values = values.collect::<Result<Vec<_>, _>>()?;
    Ok(if components == 1 {
        values.remove(0)
    } else {
        Value::Array(values)
    })
}

fn at(grid: &Grid, point: [f64; 3]) -> Value {
    let point = DVec3::from_array(point);
    real_value(grid, |grid, n| grid.trilinear(n, point)).unwrap_or(Value::Null)
}

fn ray(grid: &Grid, [x0, y0, z0, x1, y1, z1]: [f64; 6]) -> Value {
    let (from, to) = (DVec3::new(x0, y0, z0), DVec3::new(x1, y1, z1));
    real_value(grid, |grid, n| grid.line_integral(n, from, to)).unwrap_or(Value::Null)
}

fn metadata_json(metadata: &Metadata) -> Value {
    fn list<T: Copy>(values: &[T], json: impl Fn(T) -> Value) -> Value {
        match values {
            [single] => json(*single),
            many => many.iter().map(|v| json(*v)).collect(),
        }
    }
    let entries = metadata.iter().map(|(name, entry)| {
        let value = match &entry.value {
            MetaValue::Bool(value) => json!(value),
            MetaValue::Text(value) => json!(value),
            MetaValue::Integers(values) => list(values, |v| json!(v)),
            MetaValue::Reals(values) => list(values, number),
            MetaValue::Unknown(size) => json!({"type": entry.type_name, "bytes": size}),
        };
        (name.clone(), value)
    });
    Value::Object(entries.collect())
}

fn grid_json(grid: &Grid, options: &InfoOptions) -> Value {
    let mut out = Map::new();
    let mut put = |key: &str, value: Value| out.insert(key.to_owned(), value);
    put("name", json!(grid.name));
    put("type", json!(grid.type_name));
    put("class", json!(grid.class()));
    put("half", json!(grid.half));
    put("readable", json!(grid.unreadable().is_none()));
    if let Some(reason) = grid.unreadable() {
        put("reason", json!(reason));
    }
    put("transform_type", json!(grid.transform.type_name));
    let rows = grid.transform.index_to_world().map(|m| {
        let rows = [0, 1, 2, 3].map(|r| m.row(r).to_array().map(number).to_vec());
        json!(rows)
    });
    put("index_to_world", rows.unwrap_or(Value::Null));
    put("metadata", metadata_json(&grid.metadata));
    if let Ok(voxels) = grid.voxels() {
        let s = voxels.statistics();
        put("background", voxel_value(grid, voxels.background_vector()));
        put("active_voxels", json!(s.active_voxels));
        put("active_tiles", json!(s.active_tiles));
        put("leaf_nodes", json!(s.leaf_nodes));
        put("active_bbox", json!(s.active_bbox));
        let any = s.active_voxels > 0;
        let of = |value: [f64; 3]| any.then(|| voxel_value(grid, value));
        put("min_active", json!(of(s.min)));
        put("max_active", json!(of(s.max)));
        let sum = real_value(grid, |_, n| Ok(s.sum[n])).unwrap_or(Value::Null);
        put("sum_active", if any { sum } else { Value::Null });
        if let Some(invalid) = voxels.first_invalid().filter(|v| !v.value.is_finite()) {
            put("not_finite", json!(invalid.to_string()));
        }
        let held = held(grid, &options.limits).map(|held| {
            json!({
                "samples": held.samples,
                "bytes": held.bytes,
                "bytes_per_sample": held.bytes_per_sample(),
                "bricks": held.bricks,
                "half": held.half,
            })
        });
        put("rendering", held.unwrap_or(Value::Null));
        put("at", options.at.iter().map(|p| at(grid, *p)).collect());
        put("ray", options.rays.iter().map(|r| ray(grid, *r)).collect());
    }
    Value::Object(out)
}

/// All about the grids of a file, as `woodcock info --json` prints it.
///
/// Keys of a grid: `name`, `type`, `class`, `half`, `readable` (with `reason` where false), `transform_type`,
/// `index_to_world` (rows of the matrix that takes column vectors from index to world space; null for a frustum),
/// `metadata`; where its values were read also `background`, `active_voxels`, `active_tiles`, `leaf_nodes`, `active_bbox`
/// (\[min, max\], inclusive), `min_active`, `max_active`, `sum_active` (all four null without active voxels), `rendering` (what a scene would
/// hold of it: `samples`, `bytes`, `bytes_per_sample`, `bricks`, `half`; null for no density), `at` and
/// `ray` (one value per question, null where there is no answer). Non-finite numbers are the strings nan, inf, -inf;
/// vectors are lists of three. The one grid of a Mitsuba file has no name; its world is the unit cube, all of its voxels
/// are active, and it has `size`, `channels` and `file_bounds` besides.
///
/// # Errors
/// [`InfoError`].
pub fn info_json(bytes: &[u8], options: &InfoOptions) -> Result<Value, InfoError> {
    let file = match open(bytes, options)? {
        File::Trees(file) => file,
        File::Mitsuba(grid) => return Ok(mitsuba::json(&grid, options)),
    };
    let grids: Value = file.grids.iter().map(|g| grid_json(g, options)).collect();
    let mut told = json!({
        "format": file.format,
        "format_version": file.version,
        "metadata": metadata_json(&file.metadata),
        "grids": grids,
    });
    if let Some(library) = file.library {
        told["library_version"] = json!(library);
    }
    Ok(told)
}

/// The same for people, as `woodcock info` prints it.
///
/// # Errors
/// [`InfoError`].
pub fn info_text(bytes: &[u8], options: &InfoOptions) -> Result<String, InfoError> {
    let file = match open(bytes, options)? {
        File::Trees(file) => file,
        File::Mitsuba(grid) => return Ok(mitsuba::text(&grid, options)),
    };
    let version = match &file.library {
        Some(library) => format!(
            "format version {}, written by library {library}",
            file.version
        ),
        None => format!("version {}", file.version.as_str().unwrap_or("?")),
    };
    let mut text = format!("{}, {version}, {} grid(s)\n", file.format, file.grids.len());
    metadata_text(&mut text, "  ", &file.metadata);
    for grid in &file.grids {
        text.push('\n');
        grid_text(&mut text, grid, options);
    }
    Ok(text)
}

fn line(text: &mut String, label: &str, value: impl std::fmt::Display) {
    // Writing to a string cannot fail.
    let _ = writeln!(text, "  {label:<16}{value}");
}

fn metadata_text(text: &mut String, indent: &str, metadata: &Metadata) {
    for (name, entry) in metadata {
        let value = entry.value.to_string().replace('\n', " ");
        let _ = writeln!(text, "{indent}{name} ({}) = {value}", entry.type_name);
    }
}

fn grid_text(text: &mut String, grid: &Grid, options: &InfoOptions) {
    let half = if grid.half { ", saved as half" } else { "" };
    let _ = writeln!(text, "grid `{}`", grid.name);
    line(text, "type", format!("{}{half}", grid.type_name));
    line(text, "class", grid.class());
    if let Some(parent) = &grid.instance_of {
        line(text, "instance of", parent);
    }
    if let Some(reason) = grid.unreadable() {
        line(text, "not renderable", reason);
    }
    line(text, "transform", &grid.transform.type_name);
    if let Some(m) = grid.transform.index_to_world() {
        for row in [0, 1, 2] {
            let [a, b, c, d] = m.row(row).to_array();
            line(
                text,
                "",
                format!("[{a:>12.6} {b:>12.6} {c:>12.6} {d:>12.6}]"),
            );
        }
    }
    if let Ok(voxels) = grid.voxels() {
        statistics_text(text, grid, &voxels.statistics());
        if let Some(invalid) = voxels.first_invalid().filter(|v| !v.value.is_finite()) {
            line(text, "warning", format!("not finite: {invalid}"));
        }
        if let Some(held) = held(grid, &options.limits) {
            line(text, "rendering", held_text(&held));
        }
        for point in &options.at {
            line(text, "at", format!("{point:?}: {}", at(grid, *point)));
        }
        for segment in &options.rays {
            line(text, "ray", format!("{segment:?}: {}", ray(grid, *segment)));
        }
    }
    metadata_text(text, "  ", &grid.metadata);
}

/// What rendering would hold of a grid.
fn held_text(held: &Held) -> String {
    let store = match (held.bricks, held.half) {
        (false, _) => "one table",
        (true, false) => "bricks",
        (true, true) => "bricks in half precision",
    };
    format!(
        "{store} of {} samples, {:.1} MB, {:.3} bytes a sample with all tables",
        held.samples,
        held.bytes as f64 / 1e6,
        held.bytes_per_sample()
    )
}

fn statistics_text(text: &mut String, grid: &Grid, s: &Statistics) {
    if let Ok(voxels) = grid.voxels() {
        let background = voxel_value(grid, voxels.background_vector());
        line(text, "background", background);
    }
    line(text, "active voxels", s.active_voxels);
    line(text, "active tiles", s.active_tiles);
    line(text, "leaf nodes", s.leaf_nodes);
    let Some((min, max)) = s.active_bbox else {
        return;
    };
    let size: [i64; 3] = std::array::from_fn(|a| max[a] - min[a] + 1);
    let box_volume: f64 = size.iter().map(|v| *v as f64).product();
    let filled = 100.0 * s.active_voxels as f64 / box_volume;
    line(
        text,
        "active box",
        format!(
            "{min:?} to {max:?}: {}x{}x{}, {filled:.3} % active",
            size[0], size[1], size[2]
        ),
    );
    let (low, high) = (voxel_value(grid, s.min), voxel_value(grid, s.max));
    line(text, "active range", format!("{low} to {high}"));
    let sum = real_value(grid, |_, n| Ok(s.sum[n])).unwrap_or(Value::Null);
    line(text, "active sum", sum);
}
