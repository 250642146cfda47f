//! The OpenVDB reader against what OpenVDB itself says about the same files, and against damaged ones.
//!
//! `data/expected.json` explains its fields. `WOODCOCK_TEST_DATA` names another folder of the same layout.

use glam::DVec3;
use serde_json::Value;
use std::path::PathBuf;
use std::time::{Duration, Instant};
use woodcock_host::info::{InfoOptions, info_json, info_text};
use woodcock_host::volume::{Limits, vdb};

/// What one damaged file may cost.
const PATIENCE: Duration = Duration::from_secs(10);

fn data() -> PathBuf {
    match std::env::var_os("WOODCOCK_TEST_DATA") {
        Some(folder) => folder.into(),
        None => PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("data"),
    }
}

fn bytes(file: &str) -> Vec<u8> {
    let path = data().join(file);
    std::fs::read(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

fn json(file: &str) -> Value {
    serde_json::from_slice(&bytes(file)).expect("valid JSON")
}

fn load(file: &str) -> vdb::VdbFile {
    vdb::read(&bytes(file), &Limits::default()).unwrap_or_else(|error| panic!("{file}: {error}"))
}

fn array(value: &Value) -> &[Value] {
    value.as_array().map_or(&[], Vec::as_slice)
}

/// Numbers, truth values, and the strings nan, inf, -inf.
fn f64_of(value: &Value) -> f64 {
    match value {
        Value::Bool(flag) => f64::from(u8::from(*flag)),
        Value::String(text) => text.parse().expect("a number"),
        number => number.as_f64().expect("a number"),
    }
}

fn f64s<const N: usize>(values: &[Value]) -> [f64; N] {
    std::array::from_fn(|n| f64_of(&values[n]))
}

/// A scalar three times, or a vector.
fn vector_of(value: &Value) -> [f64; 3] {
    value
        .as_array()
        .map_or_else(|| [f64_of(value); 3], |v| f64s(v))
}

fn close(a: f64, b: f64, relative: f64, absolute: f64) -> bool {
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

#[test]
fn damaged_files_fail_cleanly() {
    let started = Instant::now();
    let limits = Limits {
        max_memory: 512 << 20,
    };
    let base = load("malformed/base_blosc.vdb");
    let mut files = 0;
    for entry in array(&json("malformed/malformed.json")["files"]) {
        let name = entry["file"].as_str().expect("a name");
        let path = format!("malformed/{name}");
        let result = vdb::read(&bytes(&path), &limits);
        match entry["must"].as_str() {
            Some("error") => {
                let error = result.err().unwrap_or_else(|| panic!("{name} was read"));
                println!("{name}: {error}");
            }
            Some("ok") => {
                let file = result.unwrap_or_else(|error| panic!("{name}: {error}"));
                for (grid, base) in file.grids.iter().zip(&base.grids) {
                    assert_eq!(grid.statistics(), base.statistics(), "{name}");
                }
            }
            Some("no_crash") => match result {
                Ok(file) => {
                    println!("{name}: read");
                    use_everything(&file);
                }
                Err(error) => println!("{name}: {error}"),
            },
            other => panic!("{name}: must {other:?}?"),
        }
        files += 1;
    }
    assert!(files > 0);
    assert!(started.elapsed() < PATIENCE, "{:?}", started.elapsed());
}

/// Whatever was read must also be usable.
fn use_everything(file: &vdb::VdbFile) {
    for grid in &file.grids {
        let Ok(voxels) = grid.voxels() else { continue };
        let _ = voxels.statistics();
        let _ = voxels.first_invalid();
        let _ = voxels.to_dense([-9; 3], [9; 3], &Limits::default());
        let _ = grid.trilinear(0, DVec3::splat(0.3));
        let _ = grid.line_integral(0, DVec3::new(-5.0, -4.0, -3.0), DVec3::new(9.0, 8.0, 7.0));
    }
}

#[test]
fn truncations_and_bit_flips_never_panic() {
    let rounds: u64 = match std::env::var("WOODCOCK_SAMPLES") {
        Ok(factor) => factor.parse::<u64>().expect("a factor") * 150,
        Err(_) => 150,
    };
    let limits = Limits {
        max_memory: 256 << 20,
    };
    // SplitMix64: a fixed stream of positions.
    let mut state = 0x5eed_u64;
    let mut random = move || {
        state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = state;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        (z ^ (z >> 31)) as usize
    };
    let seeds = [
        "malformed/base_blosc.vdb",
        "malformed/base_zip.vdb",
        "vdb/quantised_blosc_nomask.vdb",
        "vdb/points_then_density.vdb",
        "vdb/odd_tree_then_density.vdb",
        "vdb/tiles.vdb",
        "vdb/inactive_values_half.vdb",
        "vdb/multi_grid_stream.vdb",
        "vdb/transforms.vdb",
    ];
    let (mut read, mut refused) = (0, 0);
    for seed in seeds {
        let good = bytes(seed);
        for round in 0..rounds {
            let mut bad = good.clone();
            // A third of the damage goes where the sizes, names and types are.
            let reach = if round % 3 == 0 {
                1200.min(bad.len())
            } else {
                bad.len()
            };
            for _ in 0..1 + random() % 8 {
                let at = random() % reach;
                match random() % 4 {
                    0 => bad[at] = 0xff,
                    1 => bad[at] = 0,
                    _ => bad[at] ^= 1 << (random() % 8),
                }
            }
            if round % 4 == 0 {
                bad.truncate(random() % good.len());
            }
            let began = Instant::now();
            match vdb::read(&bad, &limits) {
                Ok(file) => {
                    read += 1;
                    use_everything(&file);
                }
                Err(_) => refused += 1,
            }
            assert!(began.elapsed() < PATIENCE, "{seed}, round {round}");
        }
    }
    println!("{read} read, {refused} refused");
    assert!(
        read > 0 && refused > 0,
        "the damage is either harmless or total"
    );
}

#[test]
fn bad_values_are_named() {
    for name in ["vdb/bad_values.vdb", "vdb/bad_values_half.vdb"] {
        let file = load(name);
        let voxels = file.grids[0].voxels().expect("values");
        let invalid = voxels.first_invalid().expect("an invalid value");
        let voxel = invalid.voxel.expect("a voxel");
        assert!(
            !invalid.value.is_finite() || invalid.value < 0.0,
            "{name}: {invalid}"
        );
        let value = voxels.value(voxel);
        assert!(
            value == invalid.value || value.is_nan(),
            "{name}: {invalid}"
        );
        let text = info_text(&bytes(name), &InfoOptions::default()).expect("text");
        assert!(text.contains("not finite"), "{name}: {text}");
    }
    let background = load("malformed/background_nan.vdb");
    let voxels = background.grids[0].voxels().expect("values");
    let invalid = voxels.first_invalid().expect("an invalid value");
    assert!(invalid.voxel.is_none() && invalid.value.is_nan());
    let good = load("vdb/cloud_blosc.vdb");
    assert_eq!(
        good.grids[0].voxels().expect("values").first_invalid(),
        None
    );
}

/// The interpolant along a segment by brute force: each unit cell for itself, two Gauss points each.
fn mean_by_cells(voxels: &vdb::Voxels, from: DVec3, to: DVec3) -> f64 {
    let d = to - from;
    let mut cuts = vec![0.0, 1.0];
    for axis in 0..3 {
        let (low, high) = (from[axis].min(to[axis]), from[axis].max(to[axis]));
        for plane in low.ceil() as i64..=high.floor() as i64 {
            let t = (plane as f64 - from[axis]) / d[axis];
            if t > 0.0 && t < 1.0 {
                cuts.push(t);
            }
        }
    }
    cuts.sort_by(f64::total_cmp);
    let mean = cuts.windows(2).map(|pair| {
        let (middle, half) = (0.5 * (pair[0] + pair[1]), 0.5 * (pair[1] - pair[0]));
        let offset = half / 3.0_f64.sqrt();
        let f = |t: f64| voxels.trilinear(0, from + d * t);
        half * (f(middle - offset) + f(middle + offset))
    });
    mean.sum()
}

#[test]
fn rays_across_tiles_equal_the_walk_through_every_cell() {
    let file = load("vdb/tiles.vdb");
    let voxels = file.grids[0].voxels().expect("values");
    // Along, across and between tiles of all levels; the second runs in the face between two root tiles.
    let segments = [
        [[-150.0, -20.0, -30.0], [700.0, 500.0, 300.0]],
        [[4095.5, 10.25, 20.5], [4095.5, 900.75, 300.0]],
        [[8300.0, 4200.0, 4150.0], [7500.0, 3900.0, 3000.0]],
        [[127.5, -20.0, 12.0], [127.5, 260.0, 12.0]],
        [[-1.0, -1.0, -1.0], [131.0, 131.0, 131.0]],
        [[4000.0, 4000.0, 4000.0], [4200.0, 4200.0, 4200.0]],
    ];
    let mut nonzero = 0;
    for [from, to] in segments.map(|ends| ends.map(DVec3::from_array)) {
        let (got, expected) = (
            voxels.mean_along(0, from, to),
            mean_by_cells(voxels, from, to),
        );
        assert!(
            close(got, expected, 1e-11, 1e-13),
            "{from} to {to}: {got} {expected}"
        );
        nonzero += usize::from(got != 0.0);
    }
    assert!(nonzero >= 4, "{nonzero} of the segments meet values");
}

#[test]
fn rays_over_any_distance_end() {
    for name in ["vdb/tiles.vdb", "vdb/far_coords.vdb", "vdb/cloud_blosc.vdb"] {
        let file = load(name);
        let voxels = file.grids[0].voxels().expect("values");
        for far in [1e3, 2_147_483_647.5, 1e12, 1e18, 1e40, 1e300] {
            for direction in [
                DVec3::X,
                DVec3::NEG_Y,
                DVec3::new(1.0, 1.0, 1.0),
                DVec3::new(-1.0, 0.3, 1e-9),
            ] {
                for base in [DVec3::ZERO, DVec3::splat(4095.5), DVec3::new(0.0, 7.5, 1e9)] {
                    let began = Instant::now();
                    let got = voxels.mean_along(0, base - direction * far, base + direction * far);
                    assert!(
                        got.is_finite() && got >= 0.0,
                        "{name}: {far} {direction}: {got}"
                    );
                    assert!(voxels.trilinear(0, base + direction * far).is_finite());
                    assert!(began.elapsed() < PATIENCE, "{name}: {far} {direction}");
                }
            }
        }
        assert!(voxels.mean_along(0, DVec3::NAN, DVec3::ZERO).is_nan());
        assert!(voxels.trilinear(0, DVec3::INFINITY).is_nan());
    }
}

#[test]
fn dense_boxes_hold_what_the_tree_holds() {
    for (name, min, max) in [
        ("vdb/tiles.vdb", [-21, -9, -20], [140, 25, 30]),
        ("vdb/inactive_values.vdb", [-2, -1, -3], [13, 9, 12]),
        ("vdb/levelset.vdb", [-20; 3], [20; 3]),
    ] {
        let file = load(name);
        let voxels = file.grids[0].voxels().expect("values");
        let dense = voxels
            .to_dense(min, max, &Limits::default())
            .expect("a box");
        let mut dense = dense.into_iter();
        for z in min[2]..=max[2] {
            for y in min[1]..=max[1] {
                for x in min[0]..=max[0] {
                    let value = voxels.value([x, y, z]) as f32;
                    assert_eq!(dense.next(), Some(value), "{name}: {x} {y} {z}");
                }
            }
        }
        assert_eq!(dense.next(), None);
    }
    let tiles = load("vdb/tiles.vdb");
    let voxels = tiles.grids[0].voxels().expect("values");
    let (min, max) = voxels.statistics().stored_bbox.expect("a box");
    let refused = voxels.to_dense(min, max, &Limits::default());
    assert!(
        matches!(refused, Err(vdb::VdbError::Memory { .. })),
        "tiles stay tiles"
    );
    let all = voxels.to_dense([i64::MIN; 3], [i64::MAX; 3], &Limits::default());
    assert!(matches!(all, Err(vdb::VdbError::Memory { .. })));
}

#[test]
fn only_what_is_asked_for_is_read() {
    // `temperature` is cut off, `density` is whole.
    let cut = bytes("malformed/trunc_24769.vdb");
    let limits = Limits::default();
    let file = vdb::read_grids(&cut, &limits, |name| name == "density").expect("density");
    let base = load("malformed/base_blosc.vdb");
    let whole = base.grid("density").expect("density").statistics();
    assert_eq!(file.grids[0].statistics(), whole);
    assert!(vdb::read_grids(&cut, &limits, |name| name == "temperature").is_err());
    // An instance brings the values of its parent along.
    let multi = bytes("vdb/multi_grid.vdb");
    let file = vdb::read_grids(&multi, &limits, |name| name == "density_instance").expect("one");
    assert_eq!((file.grids.len(), file.grids[0].unreadable()), (1, None));
    assert_eq!(
        file.grids[0].statistics().expect("values").active_voxels,
        6545
    );
    let tight = Limits { max_memory: 10_000 };
    let refused = vdb::read(&bytes("vdb/cloud_blosc.vdb"), &tight);
    assert!(matches!(refused, Err(vdb::VdbError::InGrid { source, .. })
        if matches!(*source, vdb::VdbError::Memory { .. })));
}

#[test]
fn info_answers_in_json() {
    let options = InfoOptions {
        at: vec![[0.5, 0.5, 0.5]],
        rays: vec![[-1.0, 0.5, 0.5, 1.0, 0.5, 0.5]],
        ..InfoOptions::default()
    };
    let all = info_json(&bytes("vdb/multi_grid.vdb"), &options).expect("JSON");
    let grid = |name: &str| {
        let mut grids = array(&all["grids"]).iter();
        grids.find(|grid| grid["name"] == name).expect("the grid")
    };
    assert_eq!(all["format_version"], 224);
    assert_eq!(array(&all["grids"]).len(), 14);
    assert_eq!(grid("maskgrid")["readable"], false);
    assert!(grid("maskgrid")["reason"].is_string());
    assert_eq!(grid("mask")["background"], false);
    assert_eq!(grid("id")["min_active"], 4018);
    assert_eq!(array(&grid("velocity")["at"][0]).len(), 3);
    assert_eq!(array(&grid("density")["ray"]).len(), 1);
    let bad = info_json(&bytes("vdb/bad_values.vdb"), &options).expect("JSON");
    assert_eq!(bad["grids"][0]["sum_active"], "nan");
    let frustum = InfoOptions {
        grid: Some("frustum".to_owned()),
        ..options.clone()
    };
    let one = info_json(&bytes("vdb/transforms.vdb"), &frustum).expect("JSON");
    assert_eq!(one["grids"][0]["readable"], false);
    assert!(one["grids"][0]["index_to_world"].is_null() && one["grids"][0]["ray"][0].is_null());
    let missing = info_json(&bytes("vdb/cloud_blosc.vdb"), &frustum).expect_err("no such grid");
    assert!(missing.to_string().contains("`density`"), "{missing}");
    let other = info_json(b"NanoVDB0", &options).expect_err("not yet");
    assert!(other.to_string().contains("not yet supported"), "{other}");
}
