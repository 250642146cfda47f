//! Majorants: bounds that cover what lies below them, segments that tile the ray, and errors that say what is wrong.

use woodcock_core::majorant::{BLOCK, GridLayout, GridWalk};
use woodcock_core::medium::IDENTITY;
use woodcock_core::ray::Ray;
use woodcock_core::real::{Mask, Real};
use woodcock_core::stream::KeyedStream;
use woodcock_tests::each_width;
use woodcock_tests::grids::TestGrid;
use woodcock_tests::stats::independent::SplitMix;
use woodcock_tests::widths::{everyone, ray, width};

mod controls;
mod errors;
mod leaps;
mod marks;
mod rounding;
mod tracker;
mod work;

/// Sizes around the edge of a block: inside one, one exactly, one and a sample, many.
const SIZES: [[u32; 3]; 10] = [
    [2, 2, 2],
    [3, 2, 8],
    [8, 9, 10],
    [9, 9, 9],
    [16, 17, 18],
    [17, 3, 33],
    [65, 2, 9],
    [2, 65, 16],
    [9, 8, 65],
    [25, 24, 23],
];

/// Random grids, and single samples where a footprint ends: in corners, on the seams of blocks, beside them.
fn grids() -> Vec<(String, TestGrid)> {
    let mut all = Vec::new();
    for (i, dims) in SIZES.into_iter().enumerate() {
        all.push((
            format!("random {dims:?}"),
            TestGrid::random(dims, 70 + i as u64, 0.3),
        ));
        let spots = [0, 1, 7, 8, 9, 15, 16, 17, 31, 32, u32::MAX];
        for (k, &spot) in spots.iter().enumerate() {
            let at = [
                spot,
                spots[(k + 3) % spots.len()],
                spots[(k + 7) % spots.len()],
            ];
            let at = std::array::from_fn(|a| at[a].min(dims[a] - 1));
            all.push((
                format!("spike at {at:?} of {dims:?}"),
                TestGrid::spike(dims, at),
            ));
        }
    }
    all
}

/// Blocks along an axis, by counting the cells.
fn blocks(samples: u32) -> usize {
    (samples as usize - 1).div_ceil(BLOCK as usize)
}

/// The bound of a block, in a table with a rim.
fn bound(grid: &TestGrid, block: [usize; 3]) -> f64 {
    let [bx, by, _] = grid.dims.map(|n| blocks(n) + 2);
    f64::from(grid.majorants[(block[0] + 1) + bx * ((block[1] + 1) + by * (block[2] + 1))])
}

fn each_block(grid: &TestGrid, mut visit: impl FnMut([usize; 3])) {
    let [nx, ny, nz] = grid.dims.map(blocks);
    for z in 0..nz {
        for y in 0..ny {
            for x in 0..nx {
                visit([x, y, z]);
            }
        }
    }
}

#[test]
fn a_bound_is_the_largest_sample_of_its_footprint() {
    for (name, grid) in grids() {
        each_block(&grid, |block| {
            let mut largest = 0.0_f64;
            let range = |a: usize| {
                let first = block[a] * BLOCK as usize;
                first..=(first + BLOCK as usize).min(grid.dims[a] as usize - 1)
            };
            for z in range(2) {
                for y in range(1) {
                    for x in range(0) {
                        largest = largest.max(grid.sample([x, y, z]));
                    }
                }
            }
            let bound = bound(&grid, block);
            // Tight but for the stated rounding: a bound of infinity would cover as well.
            assert!(
                (largest..=largest * (1.0 + 1.2e-6)).contains(&bound),
                "{name}, block {block:?}: {bound} for {largest}"
            );
        });
        // The rim is empty.
        let inner: f64 = {
            let mut sum = 0.0;
            each_block(&grid, |block| sum += bound(&grid, block));
            sum
        };
        let all: f64 = grid.majorants.iter().map(|&b| f64::from(b)).sum();
        assert!(
            (all - inner).abs() <= 1e-9 * inner,
            "{name}: {all} with the rim, {inner} without"
        );
    }
}

#[test]
fn the_interpolant_stays_below_its_bound() {
    let mut rng = SplitMix::new(71);
    for (name, grid) in grids() {
        each_block(&grid, |block| {
            for _ in 0..20 {
                // Corners, edges and faces of the closed block, and the inside.
                let place: [f64; 3] = std::array::from_fn(|a| {
                    let share = match rng.bits() % 4 {
                        0 => 0.0,
                        1 => 1.0,
                        _ => rng.uniform(),
                    };
                    let low = (block[a] * BLOCK as usize) as f64;
                    (low + share * f64::from(BLOCK)).min(f64::from(grid.dims[a] - 1))
                });
                let (value, bound) = (grid.at(place), bound(&grid, block));
                assert!(value <= bound, "{name}: {value} at {place:?} above {bound}");
            }
        });
    }
}

/// Rays a walk may trip over: along axes of either sign and either zero, almost along them, diagonal, any.
fn direction(rng: &mut SplitMix, kind: usize) -> [f64; 3] {
    let any: [f64; 3] = [rng.normal(), rng.normal(), rng.normal()];
    let sign = |x: f64| if x < 0.0 { -1.0 } else { 1.0 };
    let d = match kind % 7 {
        0 => any,
        1 => [sign(any[0]), 0.0, -0.0],
        2 => [-0.0, sign(any[1]), 0.0],
        3 => [1e-7 * any[0], -1e-30, sign(any[2])],
        4 => any.map(sign),
        5 => [1e-39, 1e-3 * any[1], any[2]],
        _ => [any[0], any[1], 0.0],
    };
    woodcock_tests::grids::unit(d)
}

/// A place in a grid: anywhere, on planes of samples, on seams of blocks, on faces.
fn place(rng: &mut SplitMix, dims: [u32; 3], kind: usize) -> [f64; 3] {
    dims.map(|n| {
        let last = f64::from(n - 1);
        let p = last * rng.uniform();
        match (kind / 7 + (rng.bits() % 2) as usize) % 4 {
            0 | 1 => p,
            2 => ((p / 8.0).round() * 8.0).min(last),
            _ => [0.0, last, p.round()][(rng.bits() % 3) as usize],
        }
    })
}

/// How far a ray stays in the domain.
fn length(dims: [u32; 3], origin: [f64; 3], direction: [f64; 3]) -> f64 {
    (0..3)
        .filter(|&a| direction[a] != 0.0)
        .map(|a| {
            let wall = if direction[a] > 0.0 {
                f64::from(dims[a] - 1)
            } else {
                0.0
            };
            (wall - origin[a]) / direction[a]
        })
        .fold(f64::INFINITY, f64::min)
        .max(0.0)
}

/// What one walk of a lane came to.
struct Tally {
    segments: u64,
    lookups: u64,
    tiled: f64,
}

/// Walks one ray (the same in every lane), looking up at both ends of each segment and between.
fn walk<R: Real, S: KeyedStream<R>>(
    grid: &TestGrid,
    origin: [f64; 3],
    direction: [f64; 3],
    t_max: f64,
    rng: &mut S,
    name: &str,
) -> Tally {
    let all = everyone::<R>();
    let layout = GridLayout::<R>::of(&grid.bounds(), 1.0);
    let along: Ray<R> = ray(origin, direction);
    let mut walk = GridWalk::idle();
    walk.begin(&layout, &along, &grid.majorants, all);
    let end = R::splat(t_max as f32);
    let mut from = R::zero();
    let mut tally = Tally {
        segments: 0,
        lookups: 0,
        tiled: 0.0,
    };
    let most = grid.dims.iter().map(|&n| blocks(n) as u64).sum::<u64>() + 6;
    loop {
        let segment = walk.segment();
        let to = segment.t_exit.min(end);
        // An exit may lie before the entry by rounding, by no more than that of the coordinates.
        let slack = 1e-4 * (1.0 + t_max);
        let backwards = f64::from((from - to).lane(0));
        assert!(
            backwards <= slack,
            "{name}: a segment of length {}",
            -backwards
        );
        let to = to.max(from);
        tally.segments += 1;
        tally.tiled += f64::from(to.lane(0)) - f64::from(from.lane(0));
        for share in [0.0, 1e-6, 0.25, 0.5, 0.999, 1.0] {
            let t = from + (to - from) * R::splat(share);
            let full = walk.trilinear(&grid.samples, t);
            let tap = walk.sigma_t(&grid.samples, t, rng, all);
            // Above its bound only in the rim: rounding alone leads there, the bound is zero, and so no tentative
            // collision can fall there.
            let above = segment.majorant.lt(full) | segment.majorant.lt(tap);
            let rim =
                segment.majorant.eq(R::zero()) & (to - from).le(R::splat(slack as f32 / 10.0));
            assert!(
                !above.and_not(rim).any(),
                "{name}: {full:?} or {tap:?} above {:?} at {t:?}",
                segment.majorant
            );
            tally.lookups += 2 * R::LANES as u64;
            // Where nothing is rounded across a face, the interpolant is that of the oracle.
            let t = f64::from(t.lane(0));
            let exact = grid.at(std::array::from_fn(|a| origin[a] + t * direction[a]));
            let error = (f64::from(full.lane(0)) - exact).abs();
            assert!(error < 2e-4, "{name}: {full:?} for {exact} at {t}");
        }
        from = to;
        if end.le(from).all() {
            return tally;
        }
        assert!(tally.segments <= most, "{name}: more segments than blocks");
        walk.next_segment(&grid.majorants, all);
    }
}

#[test]
fn segments_tile_the_ray_and_no_look_up_exceeds_its_bound() {
    let mut rng = SplitMix::new(72);
    let mut lookups = 0;
    let grids: Vec<_> = grids().into_iter().step_by(3).collect();
    each_width!(R, S => {
        let mut stream = <S as KeyedStream<R>>::idle();
        for kind in 0..12_000 {
            let (name, grid) = &grids[kind % grids.len()];
            let direction = direction(&mut rng, kind).map(|d| f64::from(d as f32));
            let mut origin = place(&mut rng, grid.dims, kind).map(|p| f64::from(p as f32));
            for a in 0..3 {
                // A ray along the far face is outside: domains are half open, as `clip` has them too.
                let last = f64::from(grid.dims[a] - 1);
                if direction[a].abs() < 4e-38 && origin[a] == last {
                    origin[a] = last - 0.5;
                }
            }
            let t_max = length(grid.dims, origin, direction);
            let t_max = f64::from(t_max as f32);
            let name = format!("{name}, {} from {origin:?} to {direction:?}", width::<R>());
            let tally = walk::<R, S>(grid, origin, direction, t_max, &mut stream, &name);
            lookups += tally.lookups;
            assert!((tally.tiled - t_max).abs() <= 1e-6 * t_max, "{name}: {} of {t_max}", tally.tiled);
        }
    });
    assert!(lookups > 1_000_000, "{lookups} look-ups");
}

/// A ray along a far face misses the domain and one along a near face does not: it is half open.
#[test]
fn the_far_face_is_outside() {
    let grid = TestGrid::random([8, 9, 10], 75, 0.0);
    let medium = grid.medium(IDENTITY, 1.0);
    for (origin, direction) in [
        ([2.0, 8.0, 3.0], [1.0, 0.0, 0.0]),
        ([7.0, 3.0, 1.0], [0.0, 0.0, 1.0]),
        ([1.0, 1.0, 9.0], [0.6, 0.8, 0.0]),
    ] {
        let interval = medium.clip::<f32>(&ray(origin, direction));
        assert!(interval.t1 <= interval.t0, "{interval:?}");
    }
    let interval = medium.clip::<f32>(&ray([0.0; 3], [1.0, 0.0, 0.0]));
    assert!(
        interval.t0 == 0.0 && interval.t1 == 7.0,
        "the near faces are inside: {interval:?}"
    );
}

/// The blocks met are those of the oracle, in order: every block has a bound of its own here.
#[test]
fn the_walk_meets_the_blocks_that_the_ray_crosses() {
    let mut rng = SplitMix::new(73);
    let grid = TestGrid::new([41, 33, 25], |_| 0.5 + 0.5 * rng.uniform() as f32);
    let layout = GridLayout::<f32>::of(&grid.bounds(), 1.0);
    let mut compared = 0;
    for kind in 0..5000 {
        let direction = direction(&mut rng, kind).map(|d| f64::from(d as f32));
        let origin = place(&mut rng, grid.dims, 0).map(|p| f64::from(p as f32));
        let t_max = length(grid.dims, origin, direction);
        let mut walk = GridWalk::idle();
        walk.begin(&layout, &ray(origin, direction), &grid.majorants, true);
        let mut from = 0.0_f64;
        while from < t_max * (1.0 - 1e-6) {
            let segment = walk.segment();
            let to = f64::from(segment.t_exit).min(t_max);
            let middle = 0.5 * (from + to);
            let place: [f64; 3] = std::array::from_fn(|a| origin[a] + middle * direction[a]);
            let clear = |p: &f64| {
                let off = p / f64::from(BLOCK);
                (off - off.round()).abs() > 1e-4
            };
            if to - from > 1e-4 && place.iter().all(clear) {
                let block = place.map(|p| (p / f64::from(BLOCK)) as usize);
                assert_eq!(
                    f64::from(segment.majorant),
                    bound(&grid, block),
                    "at {place:?}"
                );
                compared += 1;
            }
            from = from.max(to);
            walk.next_segment(&grid.majorants, true);
        }
    }
    assert!(compared > 10_000, "{compared} segments");
}
