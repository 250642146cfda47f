//! Bricks straight from the leaves of a volume, without a table of all samples in between.

use woodcock_core::path::{BRICK, BRICK_SAMPLES, brick_counts};

use super::bricks::{BrickTables, each};
use crate::volume::Limits;
use crate::volume::vdb::Voxels;

impl BrickTables {
    /// As [`of_dense`](Self::of_dense), of the values of a volume: no table of all samples is made.
    ///
    /// * `low`: the voxel of the first sample. `dims`: samples along x, y, z. Values are finite and not negative, and zero beyond.
    ///
    /// # Errors
    /// More memory than the limit, which is asked before it is taken: for bricks, their lattice and the bounds of their blocks.
    pub(super) fn of_voxels(
        voxels: &Voxels,
        low: [i64; 3],
        dims: [u64; 3],
        limits: &Limits,
    ) -> Result<Self, String> {
        let refused = |bytes: u64| {
            let [x, y, z] = dims;
            format!(
                "a grid of {x} x {y} x {z} voxels needs {bytes} bytes in bricks, the limit is {} (and 2^23 voxels along an axis, 2^31 \
                 of bricks with matter); raise --max-memory or use a smaller volume",
                limits.max_memory
            )
        };
        let counts = dims.map(|n| n.div_ceil(u64::from(BRICK)));
        let lattice = counts.iter().fold(1, |n: u64, c| n.saturating_mul(*c));
        // A place and a mark for each brick; bounds, minorants and means of its eight blocks.
        let lattice_bytes = lattice.saturating_mul(4 + 1 + 3 * 8 * 4);
        let short = dims.iter().all(|n| *n <= 1 << 23);
        if !short || lattice > i32::MAX as u64 / 16 || lattice_bytes > limits.max_memory {
            return Err(refused(lattice_bytes));
        }
        let dims = dims.map(|n| n as u32);
        let high: [i64; 3] = std::array::from_fn(|a| low[a] + i64::from(dims[a]) - 1);
        let [nx, ny, _] = brick_counts(dims);
        let read = |n: u32| {
            let at = [n % nx, n / nx % ny, n / (nx * ny)];
            let first = std::array::from_fn(|a| low[a] + i64::from(at[a] * BRICK));
            voxels.cube(first, high)
        };
        let mut marks = vec![false; lattice as usize];
        voxels.mark_cubes(low, brick_counts(dims), &mut marks);
        let present = each(lattice as u32, |n| {
            let marked = marks.get(n as usize).copied().unwrap_or(false);
            marked && read(n).iter().any(|v| *v > 0.0)
        });
        drop(marks);
        let bricks = present.iter().filter(|p| **p).count() as u64 + 1;
        // Samples, their codes, and perhaps the same in half precision.
        let bytes = lattice_bytes.saturating_add(bricks * BRICK_SAMPLES as u64 * (4 + 1 + 2));
        if bytes > limits.max_memory {
            return Err(refused(bytes));
        }
        Self::new(dims, &present, read).ok_or_else(|| refused(bytes))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::world::medium::bounds::{self, Bounds};
    use crate::world::medium::brick_bounds;
    use crate::world::medium::samples::{Samples, Values, trimmed};
    use crate::world::medium::sources::{Room, openvdb};
    use woodcock_core::majorant::EDGES;

    /// Volumes of OpenVDB's: halves and floats, doubles and whole numbers, tiles, every encoding of what is inactive, values that are
    /// no density, a grid with no voxel.
    const FILES: [(&[u8], &[&str]); 8] = [
        (
            include_bytes!("../../../../tests/data/vdb/fire_160.vdb"),
            &["density", "temperature"],
        ),
        (
            include_bytes!("../../../../tests/data/vdb/cloud_blosc.vdb"),
            &["density"],
        ),
        (
            include_bytes!("../../../../tests/data/vdb/cloud_half_zip.vdb"),
            &["density"],
        ),
        (
            include_bytes!("../../../../tests/data/vdb/quantised_blosc.vdb"),
            &["density"],
        ),
        (
            include_bytes!("../../../../tests/data/vdb/inactive_values.vdb"),
            &[
                "inactive_zero",
                "one_inactive",
                "two_inactive",
                "many_inactive",
            ],
        ),
        (
            include_bytes!("../../../../tests/data/vdb/multi_grid.vdb"),
            &["density", "density_d", "id", "id64", "mask"],
        ),
        (
            include_bytes!("../../../../tests/data/vdb/bad_values.vdb"),
            &["density"],
        ),
        (
            include_bytes!("../../../../tests/data/vdb/empty_grid.vdb"),
            &["density"],
        ),
    ];

    fn read(bytes: &[u8], name: &str, room: Room) -> Result<Option<Samples>, String> {
        let limits = Limits {
            max_memory: 1 << 28,
        };
        openvdb(bytes, (name, room), None, &limits, |_| ()).map(|grids| grids.density)
    }

    #[test]
    fn leaves_and_a_dense_table_give_the_same_bricks_and_bounds() {
        let (mut compared, mut refused) = (0, 0);
        for (bytes, names) in FILES {
            for name in names {
                let direct = read(bytes, name, Room::Bricks { from: 0 });
                let dense = read(bytes, name, Room::Table);
                let (direct, dense) = match (direct, dense) {
                    (Ok(direct), Ok(dense)) => (direct, dense.and_then(trimmed)),
                    (Err(one), Err(other)) => {
                        assert_eq!(one, other);
                        refused += 1;
                        continue;
                    }
                    (one, other) => panic!("{name}: {:?}, {:?}", one.err(), other.err()),
                };
                let (Some(direct), Some(dense)) = (&direct, &dense) else {
                    assert!(direct.is_none() && dense.is_none(), "{name}");
                    continue;
                };
                compared += u32::from(same(direct, dense, name));
            }
        }
        assert!(compared > 8 && refused > 0, "{compared}, {refused}");
    }

    /// Compares all that kernels see; false where a background has no bricks.
    fn same(direct: &Samples, dense: &Samples, name: &str) -> bool {
        let values = table(dense);
        let Values::Bricks(bricks) = &direct.values else {
            return false;
        };
        let dims = dense.dims;
        assert_eq!(direct.dims, dims, "{name}");
        assert_eq!(direct.to_medium, dense.to_medium, "{name}");
        assert_eq!((direct.low, direct.high), (dense.low, dense.high), "{name}");
        let expected = BrickTables::of_dense(values, dims).expect("few samples");
        assert!(**bricks == expected, "{name}: bricks differ");
        for depth in [0.001, 1.0, 100.0] {
            let expected = Bounds::new(values, dims, depth).expect("bounds");
            let found = brick_bounds::bounds(bricks, depth).expect("bounds");
            assert_eq!(found.edge, expected.edge, "{name}");
            assert!(
                found.majorants == expected.majorants,
                "{name}: bounds differ"
            );
        }
        for edge in EDGES {
            let expected = bounds::controls(values, dims, edge).expect("controls");
            let found = brick_bounds::controls(bricks, edge).expect("controls");
            assert!(found == expected, "{name}: controls of {edge} differ");
        }
        true
    }

    #[test]
    fn damaged_files_end_alike_with_a_table_and_without() {
        let mut state = 1_u32;
        let mut random = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 8) as usize
        };
        let (mut compared, mut refused) = (0, 0);
        for round in 0..160 {
            let (good, names) = FILES[[1, 2, 3][round % 3]];
            let mut bytes = good.to_vec();
            for _ in 0..1 + random() % 3 {
                let reach = if round % 2 == 0 { bytes.len() } else { 1200 };
                let at = random() % reach;
                bytes[at] ^= 1 << (random() % 8);
            }
            let [direct, dense] =
                [Room::Bricks { from: 0 }, Room::Table].map(|room| read(&bytes, names[0], room));
            match (direct, dense.map(|dense| dense.and_then(trimmed))) {
                (Ok(Some(direct)), Ok(Some(dense))) => {
                    // A sample beyond single precision is refused with its bounds, later.
                    if Bounds::new(table(&dense), dense.dims, 1.0).is_ok() {
                        compared += u32::from(same(&direct, &dense, "damaged"));
                    }
                }
                (Err(one), Err(other)) => {
                    // Both tell of the limit in words of their own.
                    assert!(one == other || one.contains("limit"), "{one}; {other}");
                    refused += 1;
                }
                (Ok(None), Ok(None)) => {}
                // What is far apart takes less memory in bricks.
                (Ok(_), Err(error)) => assert!(error.contains("limit"), "{error}"),
                (Err(error), Ok(_)) => panic!("only bricks are refused: {error}"),
                (Ok(one), Ok(_)) => panic!("one is empty, direct: {}", one.is_none()),
            }
        }
        assert!(compared > 20 && refused > 20, "{compared}, {refused}");
    }

    /// The samples of what went through a table.
    fn table(samples: &Samples) -> &[f32] {
        match &samples.values {
            Values::Dense(values) => values,
            Values::Bricks(_) => panic!("no table"),
        }
    }

    #[test]
    fn bricks_of_another_place_are_not_the_same() {
        let (bytes, _) = FILES[1];
        let file = crate::volume::vdb::read(bytes, &Limits::default()).expect("a file");
        let voxels = file.grids[0].voxels().expect("voxels");
        let (min, max) = voxels.visible_box().expect("voxels");
        let dims = [0, 1, 2].map(|a| (max[a] - min[a] + 3) as u64);
        let bricks = |shift: i64| {
            let low = [min[0] - 1 + shift, min[1] - 1, min[2] - 1];
            BrickTables::of_voxels(voxels, low, dims, &Limits::default()).expect("bricks")
        };
        assert!(bricks(0) == bricks(0));
        assert!(bricks(0) != bricks(1), "a shift by a voxel was not seen");
    }

    #[test]
    fn memory_is_asked_for_before_it_is_taken() {
        let (bytes, _) = FILES[1];
        let file = crate::volume::vdb::read(bytes, &Limits::default()).expect("a file");
        let voxels = file.grids[0].voxels().expect("voxels");
        let (min, max) = voxels.visible_box().expect("voxels");
        let dims = [0, 1, 2].map(|a| (max[a] - min[a] + 3) as u64);
        let low = min.map(|i| i - 1);
        let made =
            |dims, max_memory| BrickTables::of_voxels(voxels, low, dims, &Limits { max_memory });
        // All bricks are present, near enough: seven bytes a voxel.
        let needed = 7 * dims.iter().product::<u64>();
        assert!(made(dims, 3 * needed).is_ok());
        for (dims, limit) in [
            (dims, needed / 4),
            (dims, 100),
            ([1 << 40; 3], 1 << 40),
            ([1 << 22; 3], 1 << 40),
        ] {
            let error = made(dims, limit).expect_err("too little memory");
            assert!(
                error.contains("limit") && error.contains("--max-memory"),
                "{error}"
            );
        }
        // What is empty costs its part of the lattice.
        let wide = [1 << 13, 1 << 10, 1 << 10];
        let bricks = made(wide, 3 << 30).expect("a wide box");
        assert_eq!(
            bricks.present(),
            made(dims, 1 << 30).expect("bricks").present()
        );
    }
}
