//! Blocks of other sizes, leaps over empty ones, and the cost by which a size is chosen.

use super::{direction, everyone, length, place, ray};
use woodcock_core::majorant::{
    EDGES, GridLayout, GridWalk, MajorantError, MajorantGrid, block_counts, coarsen, fill_leaps,
    fill_slab, majorant_count_of, majorant_depth, walk_cost,
};
use woodcock_core::medium::{Grid, IDENTITY};
use woodcock_core::ray::Ray;
use woodcock_core::real::Real;
use woodcock_tests::each_width;
use woodcock_tests::grids::TestGrid;
use woodcock_tests::stats::independent::SplitMix;

/// A few lumps in much emptiness, in a box that no block divides.
fn sparse() -> TestGrid {
    let mut rng = SplitMix::new(811);
    let lumps = [[20.0, 30.0, 15.0], [90.0, 12.0, 30.0], [60.0, 50.0, 44.0]];
    TestGrid::new([107, 66, 50], |at| {
        let inside = lumps.iter().any(|lump| {
            let squares = (0..3).map(|a| (f64::from(at[a]) - lump[a]).powi(2));
            squares.sum::<f64>() < 60.0
        });
        if inside {
            0.2 + rng.uniform() as f32
        } else {
            0.0
        }
    })
}

/// Bounds in blocks of an edge, without leaps.
fn bounds(grid: &TestGrid, edge: u32) -> Vec<f32> {
    let count = majorant_count_of(grid.dims, edge).expect("few blocks");
    let mut table = vec![f32::NAN; count];
    let [x, y, _] = block_counts(grid.dims, edge).map(|n| n as usize + 2);
    for (slab, entries) in table.chunks_exact_mut(x * y).enumerate() {
        fill_slab(&grid.samples, grid.dims, edge, slab, entries).expect("valid samples");
    }
    table
}

fn with_leaps(grid: &TestGrid, edge: u32) -> Vec<f32> {
    let mut table = bounds(grid, edge);
    fill_leaps(&mut table, block_counts(grid.dims, edge)).expect("a table of this size");
    table
}

#[test]
fn coarse_blocks_are_the_union_of_finer_ones() {
    for grid in [sparse(), TestGrid::random([33, 17, 70], 812, 0.5)] {
        let mut fine = bounds(&grid, EDGES[0]);
        for pair in EDGES.windows(2) {
            let [edge, double] = [pair[0], pair[1]];
            let count = majorant_count_of(grid.dims, double).expect("few blocks");
            let mut coarse = vec![f32::NAN; count];
            coarsen(&fine, block_counts(grid.dims, edge), &mut coarse).expect("sizes that fit");
            assert_eq!(coarse, bounds(&grid, double), "{double}");
            fine = coarse;
        }
    }
}

/// The edge of the largest cube of empty blocks from one on, the octant's way, by looking at all of them.
fn largest_cube(table: &[f32], size: [i64; 3], at: [i64; 3], octant: usize) -> i64 {
    let empty = |p: [i64; 3]| {
        let inside = (0..3).all(|a| (0..size[a]).contains(&p[a]));
        inside && table[((p[2] * size[1] + p[1]) * size[0] + p[0]) as usize] <= 0.0
    };
    let way = |a: usize| if octant >> a & 1 == 1 { -1 } else { 1 };
    let all_empty = |k: i64| {
        (0..k * k * k).all(|n| {
            let step = [n % k, n / k % k, n / k / k];
            empty(std::array::from_fn(|a| at[a] + way(a) * step[a]))
        })
    };
    (1..=8).take_while(|k| all_empty(*k)).last().unwrap_or(0)
}

#[test]
fn leaps_are_the_largest_empty_cubes() {
    let grid = sparse();
    let mut longest = 0;
    for edge in [4, 8] {
        let table = with_leaps(&grid, edge);
        let size = block_counts(grid.dims, edge).map(|n| i64::from(n) + 2);
        for (index, entry) in table.iter().enumerate() {
            let index = index as i64;
            let at = [
                index % size[0],
                index / size[0] % size[1],
                index / size[0] / size[1],
            ];
            for octant in 0..8 {
                let code = (-entry.min(0.0)) as u32;
                let claimed = i64::from(code >> (3 * octant) & 7) + 1;
                let claimed = if *entry > 0.0 { 0 } else { claimed };
                assert_eq!(
                    claimed,
                    largest_cube(&table, size, at, octant),
                    "{at:?}, {octant}"
                );
                longest = longest.max(claimed);
            }
        }
    }
    assert_eq!(longest, 8, "some leap is as long as leaps can be");
}

/// Walks a ray to its end: segments, and the depth of bounds in double precision.
fn depth<R: Real>(
    grid: &MajorantGrid<'_>,
    table: &[f32],
    along: &Ray<R>,
    t_max: f64,
) -> (u32, f64) {
    let layout = GridLayout::<R>::of(grid, 1.0);
    let all = everyone::<R>();
    let mut walk = GridWalk::idle();
    walk.begin(&layout, along, table, all);
    let (mut from, mut depth, mut segments) = (0.0_f64, 0.0, 0);
    loop {
        let segment = walk.segment();
        let to = f64::from(segment.t_exit.lane(0)).min(t_max).max(from);
        depth += f64::from(segment.majorant.lane(0)) * (to - from);
        segments += 1;
        assert!(segments < 300, "the walk goes on");
        if to >= t_max {
            return (segments, depth);
        }
        from = to;
        walk.next_segment(table, all);
    }
}

/// Leaps change how many segments a ray has, and not what it meets in them.
#[test]
fn a_walk_that_leaps_meets_the_same_bounds() {
    let grid = sparse();
    let mut rng = SplitMix::new(813);
    let (mut plain, mut leaping, mut missed) = (0, 0, 0);
    for edge in EDGES {
        let without = bounds(&grid, edge);
        let with = with_leaps(&grid, edge);
        // A planted mistake: leaps are a block too long.
        let too_long: Vec<f32> = with
            .iter()
            .map(|entry| {
                let code = (-entry.min(0.0)) as u32;
                let longer = *entry <= 0.0 && (1..6).contains(&(code & 7));
                if longer { -((code + 1) as f32) } else { *entry }
            })
            .collect();
        let bound = |table| MajorantGrid::with_edge(&grid.samples, grid.dims, edge, table);
        let plain_grid = bound(&without).expect("bounds that hold");
        let leap_grid = bound(&with).expect("bounds and leaps that hold");
        if edge == 4 {
            let refused = bound(&too_long).map(|_| ());
            assert!(
                matches!(refused, Err(MajorantError::Leap { .. })),
                "{refused:?}"
            );
        }
        each_width!(R, S => {
            let _unused: Option<S> = None;
            for kind in 0..600 {
                let way = direction(&mut rng, kind).map(|d| f64::from(d as f32));
                let origin = place(&mut rng, grid.dims, 0).map(|p| f64::from(p as f32));
                let t_max = length(grid.dims, origin, way);
                let along: Ray<R> = ray(origin, way);
                let (a, expected) = depth::<R>(&plain_grid, &without, &along, t_max);
                let (b, found) = depth::<R>(&leap_grid, &with, &along, t_max);
                let close = (found - expected).abs() <= 2e-4 * (1.0 + expected);
                assert!(close, "edge {edge}: {found} for {expected} from {origin:?} to {way:?}");
                assert!(b <= a);
                plain += a;
                leaping += b;
                if edge == 4 {
                    let (_, wrong) = depth::<R>(&leap_grid, &too_long, &along, t_max);
                    missed += u32::from((wrong - expected).abs() > 0.01);
                }
            }
        });
    }
    assert!(
        f64::from(leaping) < 0.6 * f64::from(plain),
        "{leaping} segments of {plain}"
    );
    assert!(missed > 20, "the check sees leaps over matter: {missed}");
}

#[test]
fn no_look_up_exceeds_its_bound_in_blocks_of_any_size() {
    let grids = [sparse(), TestGrid::random([41, 33, 67], 815, 0.3)];
    let mut rng = SplitMix::new(816);
    for grid in &grids {
        for edge in EDGES {
            let table = with_leaps(grid, edge);
            let bounds = MajorantGrid::with_edge(&grid.samples, grid.dims, edge, &table)
                .expect("bounds that hold");
            let layout = GridLayout::<f32>::of(&bounds, 1.0);
            let mut looked = 0;
            for kind in 0..400 {
                let way = direction(&mut rng, kind).map(|d| f64::from(d as f32));
                let origin = place(&mut rng, grid.dims, 0).map(|p| f64::from(p as f32));
                let t_max = length(grid.dims, origin, way) as f32;
                let mut walk = GridWalk::idle();
                walk.begin(&layout, &ray(origin, way), &table, true);
                let mut from = 0.0_f32;
                while from < t_max * (1.0 - 1e-6) {
                    let segment = walk.segment();
                    let to = segment.t_exit.min(t_max).max(from);
                    for share in [0.0, 0.3, 0.7, 1.0] {
                        let value = walk.trilinear(&grid.samples, from + (to - from) * share);
                        let within = value <= segment.majorant || to - from < 1e-4;
                        assert!(within, "edge {edge}: {value} above {}", segment.majorant);
                        looked += 1;
                    }
                    from = to;
                    walk.next_segment(&table, true);
                }
            }
            assert!(looked > 1000, "{looked}");
        }
    }
}

#[test]
fn what_is_no_leap_is_refused() {
    let grid = TestGrid::new([40, 40, 40], |_| 0.0);
    let good = with_leaps(&grid, 8);
    let check =
        |table: &[f32]| MajorantGrid::with_edge(&grid.samples, grid.dims, 8, table).map(|_| ());
    assert_eq!(check(&good), Ok(()));
    for wrong in [-0.5, -16_777_216.0, f32::NEG_INFINITY, f32::NAN] {
        let mut table = good.clone();
        table[100] = wrong;
        assert!(check(&table).is_err(), "{wrong}");
    }
    let mut table = good;
    // Seven more blocks each way, from a corner of the table outwards.
    table[0] = -16_777_215.0;
    assert_eq!(check(&table), Err(MajorantError::Leap { index: 0 }));
    for edge in [0, 1, 5, 128] {
        let refused = MajorantGrid::with_edge(&grid.samples, grid.dims, edge, &table);
        assert_eq!(refused.map(|_| ()), Err(MajorantError::Edge(edge)));
    }
    let short = fill_leaps(&mut table[1..], [5; 3]);
    assert!(matches!(short, Err(MajorantError::Length { .. })));
}

/// Per length of rays that are everywhere alike: each of a place and a direction at random, its chord's work by its length.
#[test]
fn the_cost_is_that_of_rays_from_everywhere() {
    let grid = sparse();
    let mut rng = SplitMix::new(817);
    for edge in [4, 8, 16, 32] {
        let table = with_leaps(&grid, edge);
        let bounds = MajorantGrid::with_edge(&grid.samples, grid.dims, edge, &table)
            .expect("bounds that hold");
        let depth = 0.5;
        let cost = walk_cost(&table, grid.dims, edge, depth).expect("a table of this size");
        let medium = Grid::new(bounds, IDENTITY, depth as f32).expect("a medium");
        let (mut crossings, mut collisions) = (0.0, 0.0);
        let number = 4000;
        for _ in 0..number {
            let way = woodcock_tests::grids::unit([rng.normal(), rng.normal(), rng.normal()]);
            let inside: [f64; 3] = grid.dims.map(|n| f64::from(n - 1) * rng.uniform());
            let back = length(grid.dims, inside, way.map(|d| -d));
            let origin: [f64; 3] = std::array::from_fn(|a| {
                let last = f64::from(grid.dims[a] - 1);
                (inside[a] - back * way[a]).clamp(0.0, last)
            });
            let chord = back + length(grid.dims, inside, way);
            let along: Ray<f32> = ray(origin, way);
            let (segments, _) = self::depth::<f32>(&bounds, &table, &along, chord * (1.0 - 1e-6));
            crossings += f64::from(segments - 1) / chord;
            collisions += f64::from(majorant_depth(&medium, &along, chord as f32, true)) / chord;
        }
        let (crossings, collisions) = (
            crossings / f64::from(number),
            collisions / f64::from(number),
        );
        // Other rays, and whole chords instead of their latter parts: they begin in the rim's cubes.
        let ratio = crossings / cost.crossings;
        assert!(
            (0.7..1.35).contains(&ratio),
            "edge {edge}: {crossings} for {}",
            cost.crossings
        );
        let ratio = collisions / cost.collisions;
        assert!(
            (0.93..1.07).contains(&ratio),
            "edge {edge}: {collisions} for {}",
            cost.collisions
        );
    }
}
