//! The table that firmware and WebAssembly fill too: the same bits in scalar code, in eight lanes and in sixteen.
//!
//! Bits are pinned here; that they are right is what the suites of `woodcock-tests` prove.
#![forbid(unsafe_code)]

use woodcock_core::real::Real;
use woodcock_core::stream::{KeyedStream, PathStream};
use woodcock_packet::bits::LaneStream;
use woodcock_packet::both::{Both, Wide};
use woodcock_packet::lanes::Lanes;

#[path = "../../core/examples/same_bits/table.rs"]
mod table;

fn rows<R: Real, S: KeyedStream<R>>() -> Vec<[u32; 4]> {
    let mut rows = Vec::with_capacity(table::ROWS);
    table::fill::<R, S>(|row| rows.push(row.map(f32::to_bits))).expect("media of the table");
    rows
}

#[test]
fn the_table_is_pinned() {
    assert_eq!(table::hash::<f32, PathStream>(), table::HASH);
}

#[test]
fn packets_fill_the_same_table() {
    let scalar = rows::<f32, PathStream>();
    assert_eq!(scalar.len(), table::ROWS);
    let packets = [
        rows::<Lanes, LaneStream>(),
        rows::<Wide, Both<LaneStream>>(),
    ];
    for (packet, lanes) in packets.iter().zip([8, 16]) {
        for (i, (one, other)) in scalar.iter().zip(packet).enumerate() {
            assert_eq!(one, other, "row {i} in {lanes} lanes");
        }
    }
    assert_eq!(table::hash::<Lanes, LaneStream>(), table::HASH);
    assert_eq!(table::hash::<Wide, Both<LaneStream>>(), table::HASH);
}

/// A table that nothing happens in would be the same everywhere, too.
#[test]
fn much_happens_in_the_table() {
    let scalar = rows::<f32, PathStream>();
    assert!(
        !scalar
            .iter()
            .flatten()
            .any(|&bits| f32::from_bits(bits).is_nan())
    );
    // Rows by kind: runs of each in turn.
    let of_kind = |kind: usize| {
        let rows = scalar.iter().enumerate();
        rows.filter(move |(i, _)| i / table::RUN % table::KINDS == kind)
            .map(|(_, row)| row.map(f32::from_bits))
    };
    for flights in 0..3 {
        let all = of_kind(flights).count();
        let ended = of_kind(flights).filter(|[t, ..]| t.is_finite()).count();
        assert!(
            ended > all / 4 && ended < all,
            "{ended} of {all} flights of kind {flights} end"
        );
    }
    for weights in 3..5 {
        let all = of_kind(weights).count();
        let between = of_kind(weights)
            .filter(|&[w, ..]| 0.0 < w && w < 1.0)
            .count();
        assert!(
            between > all / 3,
            "{between} of {all} weights of kind {weights}"
        );
        let mean = of_kind(weights).map(|[w, ..]| w).sum::<f32>() / all as f32;
        assert!(
            (0.2..0.9).contains(&mean),
            "weights of kind {weights} are {mean} in the mean"
        );
    }
    for directions in 5..table::KINDS {
        for [density, x, y, z] in of_kind(directions) {
            let square = x * x + y * y + z * z;
            assert!(
                (square - 1.0).abs() < 1e-6 && density > 0.0,
                "({x}, {y}, {z}): {density}"
            );
        }
    }
    // And every row is of its own.
    let mut distinct = scalar.clone();
    distinct.sort_unstable();
    distinct.dedup();
    assert_eq!(distinct.len(), table::ROWS);
}
