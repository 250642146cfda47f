//! The reader of Mitsuba's grids against what Mitsuba itself says about the same files, and against damaged ones.

use super::vdb::{array, bytes, close, data, f64_of, f64s, json};
use woodcock_host::info::{InfoOptions, info_json, info_text};
use woodcock_host::volume::{Limits, vol};

#[test]
fn grids_are_what_mitsuba_says() {
    let (mut read, mut refused) = (0, 0);
    for entry in array(&json("expected_vol.json")["files"]) {
        let name = entry["file"].as_str().expect("a name");
        if !data().join(name).exists() {
            continue;
        }
        let result = vol::read(&bytes(name), &Limits::default());
        let must = entry["must"].as_str().expect("an obligation");
        if entry.get("size_xyz").is_none() {
            match (must, result) {
                ("error", Ok(_)) => panic!("{name} was read"),
                (_, Err(error)) => {
                    println!("{name}: {error}");
                    refused += 1;
                }
                (_, Ok(_)) => println!("{name}: read"),
            }
            continue;
        }
        let grid = result.unwrap_or_else(|error| panic!("{name}: {error}"));
        assert_eq!(serde_json::json!(grid.size), entry["size_xyz"], "{name}");
        assert_eq!(grid.channels, entry["channels"], "{name}");
        let encoding = entry["encoding"].as_str().expect("an encoding");
        assert!(encoding.starts_with(grid.encoding.name()), "{name}");
        let bounds: [f64; 6] = f64s(array(&entry["bbox"]));
        assert_eq!(
            grid.bounds.as_flattened(),
            bounds.map(|b| b as f32),
            "{name}"
        );
        let of = |n: usize| grid.statistics(n);
        let least = (0..grid.channels)
            .map(|n| of(n).0)
            .fold(f32::INFINITY, f32::min);
        let most = (0..grid.channels).map(|n| of(n).1).fold(0.0, f32::max);
        let sum: f64 = (0..grid.channels).map(|n| of(n).2).sum();
        for (found, key) in [
            (f64::from(least), "min"),
            (f64::from(most), "max"),
            (sum, "sum"),
        ] {
            let expected = f64_of(&entry[key]);
            assert!(
                close(found, expected, 1e-7, 0.0),
                "{name}: {key} {found} {expected}"
            );
        }
        for probe in array(&entry["probes"]) {
            let [x, y, z, channel] = [0, 1, 2, 3].map(|n| probe[n].as_i64().expect("an index"));
            let (found, expected) = (grid.value([x, y, z], channel as usize), f64_of(&probe[4]));
            assert!(
                close(f64::from(found), expected, 6e-8, 0.0),
                "{name}: {probe}"
            );
        }
        read += 1;
    }
    println!("{read} read, {refused} refused");
    assert!(read >= 5 && refused >= 10);
}

#[test]
fn nothing_is_allocated_for_a_file_that_does_not_hold_it() {
    let limits = Limits { max_memory: 100 };
    let error = vol::read(&bytes("vol/density_f32.vol"), &limits).expect_err("a limit");
    assert!(error.to_string().contains("limit is 100"), "{error}");
    for cut in 0..1008 {
        let whole = bytes("vol/density_f32.vol");
        assert!(
            vol::read(&whole[..cut], &Limits::default()).is_err(),
            "{cut}"
        );
    }
}

#[test]
fn info_tells_what_is_in_a_file() {
    let options = InfoOptions {
        at: vec![[1.5 / 8.0, 4.5 / 6.0, 1.5 / 5.0]],
        rays: vec![[-1.0, 0.5, 0.5, 2.0, 0.5, 0.5]],
        ..InfoOptions::default()
    };
    let told = info_json(&bytes("vol/density_f32.vol"), &options).expect("a file");
    assert_eq!(told["format"], "Mitsuba");
    assert_eq!(told["format_version"], 3);
    let grid = &told["grids"][0];
    // Voxel (1, 4, 1) by the probes.
    assert!(close(
        f64_of(&grid["at"][0]),
        2.542_873_144_149_780_3,
        1e-12,
        0.0
    ));
    assert_eq!(grid["type"], "float32");
    assert_eq!(grid["active_voxels"], 240);
    // Along x through the middle of slice 2, between rows 2 and 3: constant to the faces, so every voxel weighs 1/8.
    let volume = vol::read(&bytes("vol/density_f32.vol"), &Limits::default()).expect("a grid");
    let rows = (0..8).map(|x| f64::from(volume.value([x, 2, 2], 0) + volume.value([x, 3, 2], 0)));
    let expected = rows.sum::<f64>() / 16.0;
    assert!(
        close(f64_of(&grid["ray"][0]), expected, 1e-6, 0.0),
        "{grid} {expected}"
    );
    let text = info_text(&bytes("vol/albedo_rgb_f32.vol"), &options).expect("text");
    assert!(text.contains("Mitsuba") && text.contains("8x5x6"), "{text}");
}
