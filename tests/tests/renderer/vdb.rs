//! The OpenVDB reader against what OpenVDB itself says about the same files, and against damaged ones.
//!
//! `data/expected.json` explains its fields. `WOODCOCK_TEST_DATA` names another folder of the same layout.

use glam::DVec3;
use serde_json::Value;
use std::path::PathBuf;
use std::time::Duration;
use woodcock_host::volume::{Limits, vdb};

mod damaged;
mod queries;

/// What one file, or one question to it, may cost.
pub(crate) const PATIENCE: Duration = Duration::from_secs(10);

pub(crate) fn data() -> PathBuf {
    match std::env::var_os("WOODCOCK_TEST_DATA") {
        Some(folder) => folder.into(),
        None => PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("data"),
    }
}

pub(crate) fn bytes(file: &str) -> Vec<u8> {
    let path = data().join(file);
    std::fs::read(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

pub(crate) fn json(file: &str) -> Value {
    serde_json::from_slice(&bytes(file)).expect("valid JSON")
}

fn load(file: &str) -> vdb::VdbFile {
    vdb::read(&bytes(file), &Limits::default()).unwrap_or_else(|error| panic!("{file}: {error}"))
}

pub(crate) fn array(value: &Value) -> &[Value] {
    value.as_array().map_or(&[], Vec::as_slice)
}

/// Numbers, truth values, and the strings nan, inf, -inf.
pub(crate) fn f64_of(value: &Value) -> f64 {
    match value {
        Value::Bool(flag) => f64::from(u8::from(*flag)),
        Value::String(text) => text.parse().expect("a number"),
        number => number.as_f64().expect("a number"),
    }
}

pub(crate) fn f64s<const N: usize>(values: &[Value]) -> [f64; N] {
    std::array::from_fn(|n| f64_of(&values[n]))
}

/// A scalar three times, or a vector.
pub(crate) fn vector_of(value: &Value) -> [f64; 3] {
    value
        .as_array()
        .map_or_else(|| [f64_of(value); 3], |v| f64s(v))
}

pub(crate) fn close(a: f64, b: f64, relative: f64, absolute: f64) -> bool {
    (a.is_nan() && b.is_nan()) || a == b || (a - b).abs() <= relative * b.abs() + absolute
}

/// Voxel values to the bit: single precision is printed with nine digits, double precision with seventeen.
fn same_value(type_name: &str, a: [f64; 3], b: [f64; 3]) -> bool {
    let single = type_name.contains("float") || type_name.contains("vec3s");
    (0..3).all(|n| {
        if single {
            close(f64::from(a[n] as f32), f64::from(b[n] as f32), 0.0, 0.0)
        } else {
            // The JSON parser may be off by one unit in the last place.
            close(a[n], b[n], 2.3e-16, 0.0)
        }
    })
}

#[derive(Debug, Default)]
struct Counts {
    files: usize,
    grids: usize,
    probes: usize,
    samples: usize,
    rays: usize,
    metadata: usize,
}

fn check_metadata(grid: &str, got: &vdb::Metadata, expected: &Value, counts: &mut Counts) {
    for (name, entry) in expected.as_object().into_iter().flatten() {
        let [type_name, text] = [0, 1].map(|n| entry[n].as_str().expect("a string"));
        let got = got
            .get(name)
            .unwrap_or_else(|| panic!("{grid}: no metadata {name}"));
        assert_eq!(got.type_name, type_name, "{grid}: {name}");
        // Matrices and reals are printed in another style: compare what remains of the digits.
        let numbers = |text: &str| -> Vec<f64> {
            let parts = text.split(|c: char| "[](), \n".contains(c));
            parts.filter_map(|part| part.parse().ok()).collect()
        };
        let got = got.value.to_string();
        let same = got == text || (!numbers(text).is_empty() && numbers(&got) == numbers(text));
        assert!(same, "{grid}: {name} is {got}, expected {text}");
        counts.metadata += 1;
    }
}

fn check_grid(file: &str, grid: &vdb::Grid, expected: &Value, counts: &mut Counts) {
    let label = format!("{file}: {}", grid.name);
    counts.grids += 1;
    assert_eq!(grid.name, expected["name"], "{label}");
    assert_eq!(grid.type_name, expected["type"], "{label}");
    assert_eq!(grid.class(), expected["class"], "{label}");
    assert_eq!(grid.half, expected["half"], "{label}");
    assert_eq!(
        grid.transform.type_name, expected["transform_type"],
        "{label}"
    );
    check_metadata(&label, &grid.metadata, &expected["metadata"], counts);

    let matrix = grid.transform.index_to_world();
    assert_eq!(
        matrix.is_some(),
        expected["index_to_world"].is_array(),
        "{label}"
    );
    if let Some(matrix) = matrix {
        for (row, expected) in array(&expected["index_to_world"]).iter().enumerate() {
            let (got, row_of) = (matrix.row(row).to_array(), f64s::<4>(array(expected)));
            let same = (0..4).all(|n| close(got[n], row_of[n], 2.3e-16, 0.0));
            assert!(same, "{label}: row {row} is {got:?}, expected {row_of:?}");
        }
    }
    for pair in array(&expected["world_of_index"]) {
        let [index, world] = [0, 1].map(|n| DVec3::from_array(vector_of(&pair[n])));
        assert!(
            grid.transform.to_world(index).distance(world) < 1e-14,
            "{label}"
        );
        assert!(
            grid.transform.to_index(world).distance(index) < 1e-11,
            "{label}"
        );
    }
    if expected.get("background").is_none() {
        assert!(
            grid.voxels().is_err() && grid.unreadable().is_some(),
            "{label}"
        );
        return;
    }
    let voxels = grid.voxels().expect("values");
    let same = |a, b| same_value(&grid.type_name, a, b);
    let background = vector_of(&expected["background"]);
    assert!(
        same(voxels.background_vector(), background),
        "{label}: background"
    );
    check_statistics(&label, grid, expected);

    for probe in array(&expected["probes"]) {
        let ijk = [0, 1, 2].map(|n| probe[n].as_i64().expect("an index"));
        let (got, value) = (voxels.vector(ijk), vector_of(&probe[3]));
        assert!(
            same(got, value),
            "{label}: voxel {ijk:?} is {got:?}, expected {value:?}"
        );
        assert_eq!(
            voxels.is_active(ijk),
            f64_of(&probe[4]) != 0.0,
            "{label}: {ijk:?}"
        );
        counts.probes += 1;
    }
    check_interpolation(&label, grid, expected, background[0], counts);
}

fn check_interpolation(
    label: &str,
    grid: &vdb::Grid,
    expected: &Value,
    background: f64,
    counts: &mut Counts,
) {
    // Errors are relative to the greatest value that can take part; positions carry the rounding of the inverse map,
    // which weighs more far from the origin.
    let scale = expected["max_active"]
        .as_f64()
        .unwrap_or(1.0)
        .abs()
        .max(background.abs());
    for sample in array(&expected["trilinear_samples"]) {
        let [x, y, z, value] = f64s(array(sample));
        let world = DVec3::new(x, y, z);
        let got = grid.trilinear(0, world).expect("a value");
        let reach = grid.transform.to_index(world).length().max(1.0);
        let absolute = scale * reach * 4.0 * f64::EPSILON;
        assert!(
            close(got, value, 1e-12, absolute),
            "{label}: {got} expected {value}"
        );
        counts.samples += 1;
    }
    for ray in array(&expected["rays"]) {
        let [from, to] = ["from", "to"].map(|end| DVec3::from_array(vector_of(&ray[end])));
        let (length, value) = (f64_of(&ray["length"]), f64_of(&ray["integral"]));
        let got = grid.line_integral(0, from, to).expect("an integral");
        let reversed = grid.line_integral(0, to, from).expect("an integral");
        let absolute = 1e-12 * scale * length;
        assert!(close(from.distance(to), length, 1e-14, 0.0), "{label}");
        assert!(
            close(got, value, 1e-11, absolute),
            "{label}: {got} expected {value}"
        );
        assert!(
            close(reversed, got, 1e-12, absolute),
            "{label}: reversed {reversed} {got}"
        );
        counts.rays += 1;
    }
}

fn check_statistics(label: &str, grid: &vdb::Grid, expected: &Value) {
    let s = grid.statistics().expect("statistics");
    assert_eq!(s.active_voxels, expected["active_voxels"], "{label}");
    assert_eq!(s.active_tiles, expected["active_tiles"], "{label}");
    assert_eq!(s.leaf_nodes, expected["leaf_nodes"], "{label}");
    let bbox = serde_json::to_value(s.active_bbox).expect("JSON");
    assert_eq!(bbox, expected["active_bbox"], "{label}");
    for (key, got) in [("min_active", s.min), ("max_active", s.max)] {
        if let Some(value) = expected.get(key) {
            assert!(
                same_value(&grid.type_name, got, vector_of(value)),
                "{label}: {key} {got:?} {value}"
            );
        }
    }
    if let Some(sum) = expected.get("sum_active") {
        let scale = s.max[0].abs() * s.active_voxels as f64;
        let same = close(s.sum[0], f64_of(sum), 1e-12, 1e-13 * scale);
        assert!(same, "{label}: {} {sum}", s.sum[0]);
    }
}

#[test]
fn grids_are_what_openvdb_says() {
    let expected = json("expected.json");
    let mut counts = Counts::default();
    for entry in array(&expected["files"]) {
        let name = entry["file"].as_str().expect("a name");
        if !name.ends_with(".vdb") || !data().join(name).exists() {
            continue;
        }
        let twin = entry["same_content_as"].as_str().map(|twin| {
            let twin = format!("vdb/{twin}");
            let mut files = array(&expected["files"]).iter();
            files.find(|entry| entry["file"] == twin.as_str())
        });
        let content = twin.flatten().unwrap_or(entry);
        let file = load(name);
        if let Some(version) = entry.get("format_version") {
            assert_eq!(file.version, *version, "{name}");
        }
        check_metadata(name, &file.metadata, &content["file_metadata"], &mut counts);
        let grids = array(&content["grids"]);
        assert_eq!(file.grids.len(), grids.len(), "{name}");
        for (grid, expected) in file.grids.iter().zip(grids) {
            // The metadata of twins names another codec.
            let mut expected = expected.clone();
            if twin.is_some() {
                expected["metadata"] = Value::Null;
            }
            check_grid(name, grid, &expected, &mut counts);
        }
        counts.files += 1;
    }
    println!("{counts:?}");
    assert!(counts.files > 0 && counts.probes > 0 && counts.rays > 0);
}

#[test]
fn twins_hold_the_same_values_in_every_voxel() {
    let mut twins = 0;
    for entry in array(&json("expected.json")["files"]) {
        let name = entry["file"].as_str().expect("a name");
        let Some(twin) = entry["same_content_as"].as_str() else {
            continue;
        };
        if !name.ends_with(".vdb") {
            continue;
        }
        let (a, b) = (load(name), load(&format!("vdb/{twin}")));
        for (a, b) in a.grids.iter().zip(&b.grids) {
            let (a, b) = (a.voxels().expect("values"), b.voxels().expect("values"));
            assert_eq!(a.statistics(), b.statistics(), "{name}");
            let (min, max) = a.statistics().stored_bbox.expect("a box");
            let dense = |v: &vdb::Voxels| v.to_dense(min, max, &Limits::default());
            assert_eq!(dense(a), dense(b), "{name}");
            twins += 1;
        }
    }
    assert!(twins > 0);
}
