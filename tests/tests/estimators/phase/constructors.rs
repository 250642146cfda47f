//! What constructors refuse.

use woodcock_core::phase::mie_fit::{DiameterError, MieFit};
use woodcock_core::phase::tabulated::{TableError, Tabulated, fill_cumulative};

const COSINES: [f32; 4] = [-1.0, 0.0, 0.5, 1.0];
const VALUES: [f32; 4] = [0.5, 0.0, 1.0, 2.0];

/// The error of a table, which both functions must report alike.
fn refused(cosines: &[f32], values: &[f32]) -> TableError {
    let mut cumulative = vec![0.0; cosines.len()];
    let error = fill_cumulative(cosines, values, &mut cumulative).expect_err("a bad table");
    let same = Tabulated::new(cosines, values, &cumulative).expect_err("a bad table");
    assert_eq!(format!("{error:?} {error}"), format!("{same:?} {same}"));
    error
}

#[test]
fn a_good_table_is_taken() {
    let mut cumulative = [f32::NAN; 4];
    fill_cumulative(&COSINES, &VALUES, &mut cumulative).expect("a good table");
    assert_eq!(cumulative, [0.0, 0.2, 0.4, 1.0]);
    let table = Tabulated::new(&COSINES, &VALUES, &cumulative).expect("a good table");
    // ∫ μ v dμ = −1/6 + 1/12 + 7/12 over ∫ v dμ = 1/4 + 1/4 + 3/4.
    assert_eq!(table.mean_cosine(), 0.4);
    assert_eq!(table.sample(cumulative[1]), 0.0);
}

#[test]
fn bad_tables_are_refused() {
    let nan = f32::NAN;
    assert_eq!(refused(&[], &[]), TableError::Nodes(0));
    assert_eq!(refused(&[-1.0], &[1.0]), TableError::Nodes(1));
    let length = TableError::Length {
        expected: 4,
        found: 3,
    };
    assert_eq!(refused(&COSINES, &VALUES[..3]), length);
    for (first, last) in [(-0.99, 1.0), (-1.0, 0.999), (1.0, -1.0)] {
        let error = TableError::Range { first, last };
        assert_eq!(refused(&[first, 0.0, last], &[1.0; 3]), error);
    }
    for middle in [[0.5, 0.0], [0.0, 0.0], [nan, 0.5], [0.0, nan], [0.5, 1.0]] {
        let [b, c] = middle;
        let error = refused(&[-1.0, b, c, 1.0], &[1.0; 4]);
        assert!(matches!(error, TableError::Order { at: 1..=3 }), "{error}");
    }
    for value in [-1e-9, f32::INFINITY, nan] {
        let error = refused(&COSINES, &[0.0, 1.0, value, 1.0]);
        assert!(matches!(error, TableError::Value { at: 2, .. }), "{error}");
    }
    for value in [0.0, f32::MIN_POSITIVE * 1e-3, f32::MAX] {
        let error = refused(&COSINES, &[value; 4]);
        assert!(matches!(error, TableError::Integral(_)), "{error}");
    }
}

#[test]
fn a_distribution_function_of_another_table_is_refused() {
    let mut cumulative = [0.0; 4];
    fill_cumulative(&COSINES, &VALUES, &mut cumulative).expect("a good table");
    for at in 0..4 {
        for other in [cumulative[at].next_up(), cumulative[at] - 0.1, f32::NAN] {
            let mut wrong = cumulative;
            wrong[at] = other;
            let error = Tabulated::new(&COSINES, &VALUES, &wrong);
            assert_eq!(error, Err(TableError::Cumulative { at }));
        }
    }
    let length = TableError::Length {
        expected: 4,
        found: 2,
    };
    let short = Tabulated::new(&COSINES, &VALUES, &cumulative[..2]);
    assert_eq!(short, Err(length));
    assert_eq!(
        fill_cumulative(&COSINES, &VALUES, &mut cumulative[..2]),
        Err(length)
    );
}

#[test]
fn diameters_beyond_the_fit_are_refused() {
    for wrong in [0.0, -1.0, 50.0_f32.next_up(), f32::INFINITY, f32::NAN] {
        let error = MieFit::<f32>::new(wrong).expect_err("a bad diameter");
        let DiameterError(reported) = error;
        assert_eq!(reported.to_bits(), wrong.to_bits());
        assert!(error.to_string().contains("50 µm"));
    }
    assert!(MieFit::<f32>::new(50.0).is_ok());
    assert!(MieFit::<f32>::new(f32::MIN_POSITIVE).is_ok());
}
