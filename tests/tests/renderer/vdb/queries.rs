//! What can be asked of a file: integrals over any distance, dense boxes, single grids, `info`.

use super::{PATIENCE, array, bytes, close, load};
use glam::DVec3;
use std::time::Instant;
use woodcock_host::info::{InfoOptions, info_json, info_text};
use woodcock_host::volume::{Limits, vdb};

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
    let other = info_json(b"NanoVDB0", &options).expect_err("eight bytes");
    assert!(other.to_string().contains("truncated"), "{other}");
    let image = info_json(&[0x76, 0x2f, 0x31, 0x01], &options).expect_err("an image");
    assert!(image.to_string().contains("images"), "{image}");
}

#[test]
fn versions_of_one_layout_are_read_and_others_refused() {
    let mut file = bytes("vdb/cloud_blosc.vdb");
    let whole = load("vdb/cloud_blosc.vdb").grids[0].statistics();
    for version in 220_u32..=227 {
        file[8..12].copy_from_slice(&version.to_le_bytes());
        match vdb::read(&file, &Limits::default()) {
            Ok(file) => {
                assert!((222..=225).contains(&version), "{version}");
                assert_eq!(file.version, version);
                assert_eq!(file.grids[0].statistics(), whole);
            }
            Err(error) => assert_eq!(error, vdb::VdbError::Version(version)),
        }
    }
}
