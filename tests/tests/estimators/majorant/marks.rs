//! Marks: rays that set out from a known block walk as rays do that are placed anew.

use super::direction;
use woodcock_core::majorant::{GridWalk, Segment};
use woodcock_core::medium::{IDENTITY, Medium};
use woodcock_core::path::{Convex, MediumRecord, OneGrid, PathMedium, RecordKind};
use woodcock_core::ray::Ray;
use woodcock_tests::grids::TestGrid;
use woodcock_tests::stats::independent::SplitMix;
use woodcock_tests::widths::ray;

fn record(grid: &TestGrid) -> MediumRecord {
    MediumRecord {
        kind: RecordKind::Grid {
            world_to_grid: IDENTITY,
            dims: grid.dims,
            samples: 0,
            majorants: 0,
            edge: woodcock_core::majorant::BLOCK,
        },
        scale: 0.5,
        colour: [1.0; 3],
        albedo: [1.0; 3],
        g: 0.0,
        rayleigh: false,
    }
}

/// All segments up to a distance.
fn segments(medium: &OneGrid<'_>, walk: &mut GridWalk<f32>, end: f32) -> Vec<[u32; 2]> {
    let mut found = Vec::new();
    loop {
        let Segment { majorant, t_exit } = Medium::<f32>::segment(medium, walk);
        found.push([majorant, t_exit].map(f32::to_bits));
        if t_exit >= end {
            return found;
        }
        medium.next_segment(walk, true);
    }
}

#[test]
fn marked_rays_walk_as_those_that_are_placed() {
    let grid = TestGrid::random([33, 26, 29], 821, 0.4);
    let record = record(&grid);
    let size = grid.dims.map(|n| (n - 1) as f32);
    let domain = Convex::Box {
        to_local: IDENTITY,
        size,
    };
    let medium = OneGrid::new(&record, &grid.samples, &grid.majorants).within(&domain);
    assert!(PathMedium::<f32>::is_alone(&medium));
    let mut rng = SplitMix::new(822);
    let mut marks = 0;
    let mut wrong = 0;
    for kind in 0..2000 {
        // Off all seams, on which a place has two blocks.
        let from = size.map(|s| f64::from(s) * rng.uniform());
        let first = ray(from, direction(&mut rng, kind));
        let mut walk = medium.idle();
        Medium::<f32>::begin(&medium, &mut walk, &first, true);
        let Segment { majorant, t_exit } = Medium::<f32>::segment(&medium, &walk);
        if majorant == 0.0 {
            continue;
        }
        marks += 1;
        let t = rng.uniform() as f32 * t_exit;
        let mark = medium.mark(&walk, t);
        let onward = Ray {
            origin: walk.place(t),
            direction: ray::<f32>([0.0; 3], direction(&mut rng, kind / 7)).direction,
        };
        // Wherever the walk has gone since.
        Medium::<f32>::next_segment(&medium, &mut walk, true);
        let elsewhere = medium.mark(&walk, t_exit);
        let end = medium.resume(&mut walk, &mark, onward.direction, true);
        let exit = domain.clip(&onward).t1;
        assert!(
            (end - exit).abs() <= 1e-5 * exit.max(1.0),
            "{end} and {exit}"
        );
        let found = segments(&medium, &mut walk, end);
        let mut fresh = medium.idle();
        Medium::<f32>::begin(&medium, &mut fresh, &onward, true);
        assert_eq!(found, segments(&medium, &mut fresh, end));
        medium.resume(&mut walk, &elsewhere, onward.direction, true);
        wrong += u32::from(found != segments(&medium, &mut walk, end));
    }
    assert!(marks > 500, "only {marks} marks");
    // The comparison can fail: a mark elsewhere begins another walk.
    assert!(wrong > marks / 2, "{wrong} of {marks}");
}

/// Only a grid that fills its place is alone in it.
#[test]
fn a_grid_is_alone_in_its_own_domain_only() {
    let grid = TestGrid::random([9, 10, 11], 823, 0.2);
    let record = record(&grid);
    let medium = OneGrid::new(&record, &grid.samples, &grid.majorants);
    let size = grid.dims.map(|n| (n - 1) as f32);
    let boxed = |size| Convex::Box {
        to_local: IDENTITY,
        size,
    };
    let alone = |place: &Convex| PathMedium::<f32>::is_alone(&medium.within(place));
    assert!(alone(&boxed(size)));
    assert!(!PathMedium::<f32>::is_alone(&medium));
    assert!(!alone(&boxed(size.map(|s| s - 1.0))));
    assert!(!alone(&Convex::Everywhere));
    let to_local = IDENTITY;
    assert!(!alone(&Convex::Sphere { to_local }));
}
