//! What is wrong with a grid is said, with its place.

use woodcock_core::majorant::{MajorantError, MajorantGrid, fill_majorants, majorant_count};
use woodcock_tests::grids::TestGrid;

#[test]
fn bad_samples_are_named() {
    let dims = [5, 4, 3];
    let good = vec![0.5_f32; 60];
    let count = majorant_count(dims).expect("small");
    let mut bounds = vec![0.0; count];
    fill_majorants(&good, dims, &mut bounds).expect("good samples");
    let bounds = bounds;
    for value in [
        f32::NAN,
        -1.0,
        -1e-30,
        f32::INFINITY,
        f32::NEG_INFINITY,
        3.401e38,
    ] {
        for (index, at) in [(0, [0, 0, 0]), (33, [3, 2, 1]), (59, [4, 3, 2])] {
            let mut samples = good.clone();
            samples[index] = value;
            let complains = |error: MajorantError| match error {
                MajorantError::Sample {
                    at: place,
                    value: found,
                } => {
                    assert_eq!((place, found.to_bits()), (at, value.to_bits()));
                    let text = error.to_string();
                    assert!(
                        text.contains(&format!("({}, {}, {})", at[0], at[1], at[2])),
                        "{text}"
                    );
                }
                other => panic!("{value} at {at:?}: {other:?}"),
            };
            let mut out = vec![0.0; count];
            complains(fill_majorants(&samples, dims, &mut out).expect_err("bad sample"));
            complains(MajorantGrid::new(&samples, dims, &bounds).expect_err("bad sample"));
        }
    }
    // Minus zero is zero.
    let mut samples = good;
    samples[7] = -0.0;
    let mut out = vec![0.0; count];
    fill_majorants(&samples, dims, &mut out).expect("minus zero is not negative");
}

#[test]
fn bad_dimensions_and_lengths_are_named() {
    let dims = |dims: [u32; 3]| {
        let error = fill_majorants(&[], dims, &mut []).expect_err("bad dimensions");
        assert_eq!(error, MajorantError::Dimensions(dims));
        let error = MajorantGrid::new(&[], dims, &[]).expect_err("bad dimensions");
        assert_eq!(error, MajorantError::Dimensions(dims));
    };
    for bad in [
        [1, 2, 2],
        [2, 1, 2],
        [2, 2, 1],
        [0, 5, 5],
        [0; 3],
        [u32::MAX; 3],
        [1 << 16; 3],
        [1 << 24, 2, 2],
        [1 << 15, 1 << 15, 4],
    ] {
        dims(bad);
    }
    assert_eq!(majorant_count([u32::MAX; 3]), None);
    assert_eq!(majorant_count([2, 2, 2]), Some(27));
    assert_eq!(majorant_count([9, 9, 10]), Some(3 * 3 * 4));
    let samples = [0.0; 8];
    for (found, bounds) in [(7, 27), (9, 27), (0, 27)] {
        let samples = vec![0.0; found];
        let mut out = vec![0.0; bounds];
        let error = fill_majorants(&samples, [2; 3], &mut out).expect_err("wrong length");
        assert_eq!(error, MajorantError::Length { expected: 8, found });
    }
    for found in [0, 26, 28] {
        let mut out = vec![0.0; found];
        let error = fill_majorants(&samples, [2; 3], &mut out).expect_err("wrong length");
        assert_eq!(
            error,
            MajorantError::Length {
                expected: 27,
                found
            }
        );
        let error = MajorantGrid::new(&samples, [2; 3], &out).expect_err("wrong length");
        assert_eq!(
            error,
            MajorantError::Length {
                expected: 27,
                found
            }
        );
    }
}

/// A bound one float too small, or NaN, is found in whichever block it lies.
#[test]
fn bounds_that_fail_to_bound_are_named() {
    let grid = TestGrid::random([17, 10, 9], 74, 0.0);
    let mut planted = 0;
    for index in 0..grid.majorants.len() {
        if grid.majorants[index] == 0.0 {
            continue;
        }
        // The largest sample itself is no bound: interpolation rounds above it.
        let largest = grid.majorants[index] / (1.0 + 1.0 / 1_048_576.0);
        for wrong in [largest, 0.0, f32::NAN, -1.0, f32::INFINITY] {
            let mut bounds = grid.majorants.clone();
            bounds[index] = wrong;
            let error = MajorantGrid::new(&grid.samples, grid.dims, &bounds);
            assert!(
                matches!(error, Err(MajorantError::Bound { .. })),
                "bound {index} = {wrong}: {error:?}"
            );
            planted += 1;
        }
    }
    assert_eq!(
        planted,
        4 * 5,
        "two by two by one blocks, five mistakes each"
    );
    for index in (0..grid.majorants.len()).filter(|&i| grid.majorants[i] == 0.0) {
        let mut bounds = grid.majorants.clone();
        bounds[index] = 0.5;
        let error = MajorantGrid::new(&grid.samples, grid.dims, &bounds);
        assert_eq!(error.err(), Some(MajorantError::Rim { index }));
    }
}

/// Extinction at either end of the floats has bounds that are finite and can be proved.
#[test]
fn extreme_samples_are_bounded() {
    for extreme in [
        3.4e38,
        f32::MIN_POSITIVE,
        f32::from_bits(5),
        f32::from_bits(1),
    ] {
        let grid = TestGrid::new(
            [3, 9, 10],
            |[x, y, z]| if (x + y + z) % 2 == 0 { extreme } else { 0.0 },
        );
        assert!(grid.majorants.iter().all(|b| b.is_finite()));
        assert_eq!(grid.bounds().dims(), [3, 9, 10]);
    }
}
