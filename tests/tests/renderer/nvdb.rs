//! The NanoVDB reader against what NanoVDB itself says about the same files, and against damaged ones.
//!
//! `data/expected_nvdb.json` explains its fields. `WOODCOCK_TEST_DATA` names another folder of the same layout.

use super::vdb::{PATIENCE, array, bytes, close, data, f64_of, json, vector_of};
use glam::DVec3;
use serde_json::Value;
use std::time::Instant;
use woodcock_host::info::{InfoOptions, info_json, info_text};
use woodcock_host::volume::vdb::{Grid, MetaValue};
use woodcock_host::volume::{Limits, nvdb, vdb};

fn load(file: &str) -> nvdb::NanoVdbFile {
    nvdb::read(&bytes(file), &Limits::default()).unwrap_or_else(|error| panic!("{file}: {error}"))
}

fn text<'a>(grid: &'a Grid, name: &str) -> &'a str {
    match &grid.metadata.get(name).expect("an entry").value {
        MetaValue::Text(text) => text,
        other => panic!("{name} is {other}"),
    }
}

/// Single precision is printed with nine digits.
fn same(a: [f64; 3], b: [f64; 3]) -> bool {
    (0..3).all(|n| close(f64::from(a[n] as f32), f64::from(b[n] as f32), 0.0, 0.0))
}

fn check_grid(label: &str, grid: &Grid, expected: &Value) -> usize {
    assert_eq!(grid.name, expected["name"], "{label}");
    assert_eq!(grid.type_name, expected["type"], "{label}");
    assert_eq!(text(grid, "version"), expected["version"], "{label}");
    let class = match expected["class"].as_str() {
        Some("FOG") => "fog volume",
        Some("SDF") => "level set",
        _ => "unknown",
    };
    assert_eq!(grid.class(), class, "{label}");
    let codec = ["none", "zip", "blosc"][expected["codec"].as_u64().expect("a codec") as usize];
    assert_eq!(text(grid, "codec"), codec, "{label}");
    let matrix = grid.transform.index_to_world().expect("a matrix");
    for (r, row) in array(&expected["index_to_world"]).iter().enumerate() {
        let got = matrix.row(r).to_array();
        for (got, expected) in got.iter().zip(array(row)) {
            assert!(
                close(*got, f64_of(expected), 2.3e-16, 0.0),
                "{label}: row {r}"
            );
        }
    }
    let voxels = grid.voxels().expect("values");
    let background = vector_of(&expected["background"]);
    assert!(
        same(voxels.background_vector(), background),
        "{label}: background"
    );
    let statistics = voxels.statistics();
    assert_eq!(
        statistics.active_voxels, expected["active_voxels"],
        "{label}"
    );
    let bbox = serde_json::to_value(statistics.active_bbox).expect("JSON");
    assert_eq!(bbox, expected["active_bbox"], "{label}");
    for probe in array(&expected["probes"]) {
        let ijk = [0, 1, 2].map(|n| probe[n].as_i64().expect("an index"));
        let (got, value) = (voxels.vector(ijk), vector_of(&probe[3]));
        assert!(
            same(got, value),
            "{label}: {ijk:?} is {got:?}, expected {value:?}"
        );
        assert_eq!(
            voxels.is_active(ijk),
            f64_of(&probe[4]) != 0.0,
            "{label}: {ijk:?}"
        );
    }
    array(&expected["probes"]).len()
}

#[test]
fn grids_are_what_nanovdb_says() {
    let (mut files, mut probes) = (0, 0);
    for entry in array(&json("expected_nvdb.json")["files"]) {
        let name = entry["file"].as_str().expect("a name");
        // Those without grids are listed only, see below.
        if !data().join(name).exists() || entry.get("grids").is_none() {
            continue;
        }
        let file = load(name);
        let mut expected: Vec<_> = array(&entry["grids"]).to_vec();
        expected.sort_by_key(|grid| grid["name"].as_str().map(str::to_owned));
        let listed = expected.iter().filter(|grid| grid.get("probes").is_some());
        assert_eq!(file.grids.len(), expected.len(), "{name}");
        assert!(listed.count() > 0, "{name}");
        for (grid, expected) in file.grids.iter().zip(&expected) {
            probes += check_grid(&format!("{name}: {}", grid.name), grid, expected);
        }
        files += 1;
    }
    println!("{files} files, {probes} probes");
    assert!(files >= 6 && probes > 100);
}

#[test]
fn indices_are_listed_without_values() {
    let name = "external/warp_test_index_grid.nvdb";
    if !data().join(name).exists() {
        return;
    }
    let file = load(name);
    assert!(!file.grids.is_empty());
    for grid in &file.grids {
        let reason = grid.unreadable().expect("a reason");
        assert!(
            reason.contains("Index") && grid.voxels().is_err(),
            "{reason}"
        );
    }
}

#[test]
fn every_voxel_is_openvdbs() {
    let twin = vdb::read(&bytes("vdb/quantised_blosc.vdb"), &Limits::default()).expect("a file");
    let twin = twin.grids[0].voxels().expect("values");
    let (low, high) = twin.statistics().stored_bbox.expect("a box");
    let (low, high) = (low.map(|v| v - 2), high.map(|v| v + 2));
    let dense = |voxels: &vdb::Voxels| voxels.to_dense(low, high, &Limits::default());
    let expected = dense(twin).expect("values");
    // Quantised values may be off by half a step of the largest range, 1.125 / (2^bits − 1).
    for (name, bound) in [
        ("cloud_float_blosc", 0.0),
        ("cloud_float_zip", 0.0),
        ("multi", 0.0),
        ("cloud_fp16", 0.6 * 1.125 / 65_535.0),
        ("cloud_fp8", 0.6 * 1.125 / 255.0),
        ("cloud_fpn", 0.01),
    ] {
        let file = load(&format!("nvdb/{name}.nvdb"));
        let voxels = file
            .grid("density")
            .expect("a grid")
            .voxels()
            .expect("values");
        let found = dense(voxels).expect("values");
        let off = found.iter().zip(&expected).map(|(a, b)| (a - b).abs());
        let off = off.fold(0.0_f32, f32::max);
        assert!(off <= bound, "{name} is off by {off}");
        // Quantisation loses something, or the test compares a file with itself.
        assert_eq!(off == 0.0, bound == 0.0, "{name}");
    }
}

#[test]
fn only_what_is_asked_for_is_read() {
    let mut damaged = bytes("nvdb/multi.nvdb");
    let last = damaged.len() - 10_000;
    damaged[last..].fill(0xff);
    assert!(nvdb::read(&damaged, &Limits::default()).is_err());
    let file = nvdb::read_grids(&damaged, &Limits::default(), |name| name == "density");
    assert_eq!(file.expect("the first grid").grids.len(), 1);
}

#[test]
fn memory_is_asked_for_before_it_is_taken() {
    let limits = Limits {
        max_memory: 400_000,
    };
    let error = nvdb::read(&bytes("nvdb/cloud_float_zip.nvdb"), &limits).expect_err("a limit");
    assert!(error.to_string().contains("limit"), "{error}");
}

fn use_everything(file: &nvdb::NanoVdbFile) {
    for grid in &file.grids {
        let Ok(voxels) = grid.voxels() else { continue };
        let _ = voxels.statistics();
        let _ = voxels.first_invalid();
        let _ = voxels.to_dense([-2; 3], [40; 3], &Limits::default());
        let _ = grid.trilinear(0, DVec3::splat(0.3));
        let _ = grid.line_integral(0, DVec3::new(-5.0, -4.0, -3.0), DVec3::new(9.0, 8.0, 7.0));
    }
}

#[test]
fn damaged_files_fail_cleanly() {
    let limits = Limits {
        max_memory: 512 << 20,
    };
    let base = load("malformed_nvdb/base.nvdb");
    let mut files = 0;
    for entry in array(&json("malformed_nvdb/malformed_nvdb.json")["files"]) {
        let name = entry["file"].as_str().expect("a name");
        let began = Instant::now();
        let result = nvdb::read(&bytes(&format!("malformed_nvdb/{name}")), &limits);
        match entry["must"].as_str() {
            Some("error") => {
                let error = result.err().unwrap_or_else(|| panic!("{name} was read"));
                println!("{name}: {error}");
            }
            Some("ok") => {
                let file = result.unwrap_or_else(|error| panic!("{name}: {error}"));
                let statistics = |file: &nvdb::NanoVdbFile| file.grids[0].statistics();
                assert_eq!(statistics(&file), statistics(&base), "{name}");
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
        assert!(began.elapsed() < PATIENCE, "{name}: {:?}", began.elapsed());
        files += 1;
    }
    assert!(files > 30);
}

#[test]
fn truncations_and_bit_flips_never_panic() {
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
    let (mut read, mut refused) = (0, 0);
    // Stored values let damage through to the tree: its headers take the first 1200 bytes, its root 300 more.
    for (seed, reach) in [
        ("nvdb/cloud_fp16.nvdb", 1200),
        ("nvdb/cloud_fp16.nvdb", 20_000),
        ("nvdb/cloud_fpn.nvdb", 300),
        ("nvdb/multi.nvdb", 1000),
    ] {
        let good = bytes(seed);
        for round in 0..100 {
            let mut bad = good.clone();
            let reach = if round % 3 == 0 { bad.len() } else { reach };
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
            match nvdb::read(&bad, &limits) {
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
        read > 20 && refused > 20,
        "the damage is either harmless or total"
    );
}

#[test]
fn info_tells_what_is_in_a_file() {
    let options = InfoOptions {
        at: vec![[1.4, 0.5, 1.6]],
        rays: vec![[0.0, 0.7, 1.5, 4.0, 1.0, 2.0]],
        ..InfoOptions::default()
    };
    let told = info_json(&bytes("nvdb/multi.nvdb"), &options).expect("a file");
    assert_eq!(told["format"], "NanoVDB");
    let twin = info_json(&bytes("vdb/quantised_blosc.vdb"), &options).expect("a file");
    let [density, temperature] = array(&told["grids"]) else {
        panic!("two grids: {told}");
    };
    let twin = &twin["grids"][0];
    for key in [
        "background",
        "active_voxels",
        "active_bbox",
        "min_active",
        "at",
        "ray",
    ] {
        assert_eq!(density[key], twin[key], "{key}");
    }
    assert!(f64_of(&density["ray"][0]) > 0.1);
    assert_eq!(temperature["name"], "temperature");
    let text = info_text(&bytes("nvdb/multi.nvdb"), &options).expect("text");
    assert!(
        text.contains("NanoVDB, version 32.4.2, 2 grid(s)"),
        "{text}"
    );
    let only = InfoOptions {
        grid: Some("smoke".to_owned()),
        ..InfoOptions::default()
    };
    let error = info_json(&bytes("nvdb/multi.nvdb"), &only).expect_err("no such grid");
    assert!(
        error.to_string().contains("`density`, `temperature`"),
        "{error}"
    );
}
