//! Bounds of cells that fail to bound, and what has no bound, are named with their place.

use super::{Formula, Puffs, bounds, cut};
use woodcock_core::enclosure::Enclosure;
use woodcock_core::majorant::{CellError, Cells};
use woodcock_core::vec3::Vec3;

/// Mistakes that a table of bounds can have, each found, and the cell named.
#[test]
fn bounds_that_fail_to_bound_are_named() {
    let counts = [5, 3, 4];
    let cells = cut(counts);
    let majorants = bounds(&cells, Puffs::extension);
    let prove = |majorants: &[f32]| cells.prove(Puffs::extension, majorants);
    assert_eq!(prove(&majorants), Ok(()));
    let entry = |[x, y, z]: [u32; 3]| (x + 1 + 7 * (y + 1 + 5 * (z + 1))) as usize;
    for cell in [[0, 0, 0], [4, 2, 3], [2, 1, 2]] {
        for wrong in [
            majorants[entry(cell)].next_down(),
            0.0,
            -1.0,
            f32::NAN,
            f32::INFINITY,
        ] {
            let mut planted = majorants.clone();
            planted[entry(cell)] = wrong;
            assert_eq!(prove(&planted), Err(CellError::Bound { cell }), "{wrong}");
        }
    }
    // The largest value found at corners and centres of cells.
    let guess = |p: [Enclosure; 3]| {
        let places = (0..27).map(|i| {
            let share = [i % 3, i / 3 % 3, i / 9].map(|s| 0.5 * s as f32);
            std::array::from_fn(|a| p[a].low() + share[a] * (p[a].high() - p[a].low()))
        });
        let values = places.map(|[x, y, z]| Puffs::sigma_t::<f32>(Vec3::new(x, y, z)));
        Enclosure::point(values.fold(0.0, f32::max))
    };
    assert!(matches!(
        prove(&bounds(&cells, guess)),
        Err(CellError::Bound { .. })
    ));
    // Bounds of the neighbours.
    let mut shifted = majorants.clone();
    shifted.rotate_left(1);
    assert!(prove(&shifted).is_err());
    for index in [0, 6, 34, 7 * 5 * 6 - 1] {
        let mut planted = majorants.clone();
        planted[index] = 1.0;
        assert_eq!(prove(&planted), Err(CellError::Rim { index }));
    }
    let expected = 7 * 5 * 6;
    assert_eq!(cells.majorant_count(), expected);
    for found in [0, expected - 1, expected + 1] {
        let length = Err(CellError::Length { expected, found });
        assert_eq!(prove(&vec![1.0; found]), length);
        assert_eq!(
            cells.fill_majorants(Puffs::extension, &mut vec![1.0; found]),
            length
        );
    }
}

#[test]
fn what_cannot_be_cut_or_bounded_is_refused() {
    let new = |low, high, counts| Cells::new(low, high, counts);
    for counts in [
        [0, 1, 1],
        [1, 1, 0],
        [(1 << 20) + 1, 1, 1],
        [u32::MAX; 3],
        [1 << 11; 3],
    ] {
        assert_eq!(
            new([0.0; 3], [1.0; 3], counts),
            Err(CellError::Counts(counts))
        );
    }
    for (x0, x1) in [
        (1.0, 1.0),
        (2.0, 1.0),
        (f32::NAN, 1.0),
        (0.0, f32::INFINITY),
        (f32::NEG_INFINITY, 0.0),
        (f32::MIN, f32::MAX),
        (0.0, 1e-39),
    ] {
        let (low, high) = ([0.0, x0, 0.0], [1.0, x1, 1.0]);
        let refused = new(low, high, [2; 3]);
        assert!(
            matches!(refused, Err(CellError::Extent { .. })),
            "{x0} to {x1}: {refused:?}"
        );
    }
    let cells = cut([4, 4, 4]);
    let mut out = vec![0.0; cells.majorant_count()];
    // No bound where a quotient passes through infinity, nor of a square root of what may be negative.
    let unbounded: [fn([Enclosure; 3]) -> Enclosure; 4] = [
        |[x, _, _]| Enclosure::point(1.0) / x,
        |[x, _, _]| x.sqrt(),
        |[_, y, _]| (y * 10.0).exp(),
        |[x, _, _]| (x * 0.0 - 1.0).min(Enclosure::point(5.0)),
    ];
    for extension in unbounded {
        let error = cells
            .fill_majorants(extension, &mut out)
            .expect_err("no bound");
        let CellError::Extension {
            cell: [x, y, z], ..
        } = error
        else {
            panic!("{error:?}");
        };
        assert!(
            error.to_string().contains(&format!("({x}, {y}, {z})")),
            "{error}"
        );
    }
}
