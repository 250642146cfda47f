//! Bytes that contradict the format: an error or values, never a panic, a hang, or a memory bill.

use super::{PATIENCE, array, bytes, json, load};
use glam::DVec3;
use std::time::Instant;
use woodcock_host::volume::{Limits, vdb};

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
