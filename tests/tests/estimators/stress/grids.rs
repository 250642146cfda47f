//! Grids: rays along faces, edges and corners, voxels beside others of a millionth, single cells, far from the origin,
//! with samples as small and as large as numbers get.

use super::work::Patient;
use super::{Worst, ray, stream};
use woodcock_core::free_flight::delta;
use woodcock_core::majorant::majorant_depth;
use woodcock_core::medium::{Affine, Audited, Grid, IDENTITY, Interpolated, Medium};
use woodcock_core::real::Real;
use woodcock_core::transmittance::ratio;
use woodcock_tests::depth::Depth;
use woodcock_tests::grids::TestGrid;
use woodcock_tests::stats::independent::SplitMix;
use woodcock_tests::stats::{
    KolmogorovSmirnov, Sample, assert_agrees, assert_verdict, judge, must_kill, samples,
};

/// How far a ray can go in a grid, a bit less, in double precision; zero where it begins on its way out.
fn reach(dims: [u32; 3], o: [f32; 3], d: [f32; 3]) -> f64 {
    let ends = (0..3).map(|a| {
        let (o, d, last) = (f64::from(o[a]), f64::from(d[a]), f64::from(dims[a] - 1));
        match d {
            d if d > 0.0 => (last - o) / d,
            d if d < 0.0 => -o / d,
            _ => f64::INFINITY,
        }
    });
    ends.fold(f64::INFINITY, f64::min).max(0.0) * (1.0 - 1e-6)
}

/// Coordinates on faces of voxels and blocks, next to them, and between.
fn coordinates(samples: u32) -> Vec<f32> {
    let last = (samples - 1) as f32;
    let mut all = vec![
        0.0,
        -0.0,
        f32::from_bits(1),
        1e-30,
        0.5,
        1.0,
        last,
        last.next_down(),
        last - 0.5,
    ];
    for face in [1.0_f32, 2.0, 7.0, 8.0, 9.0, 16.0] {
        all.extend([face, face.next_down(), face.next_up()]);
    }
    all.retain(|x| (0.0..=last).contains(x));
    all
}

const COMPONENTS: [f32; 10] = [0.0, -0.0, 1e-40, -1e-30, 1e-30, 1e-7, -1e-7, 0.6, 1.0, -1.0];

#[test]
fn rays_along_faces_edges_and_corners_are_walked() {
    let mut rng = SplitMix::new(21);
    let (mut worst, mut most, mut walked) = (Worst::default(), 0.0_f64, 0);
    for dims in [[17, 18, 19], [9, 9, 9], [2, 2, 2], [3, 2, 33]] {
        let grid = TestGrid::random(dims, 6, 0.3);
        let full = Interpolated(grid.medium(IDENTITY, 1.0));
        let blocks = dims.map(|n| (n - 1).div_ceil(8));
        let limit = blocks.iter().sum::<u32>() + 3;
        let places = dims.map(coordinates);
        for _ in 0..30_000 {
            let o = [0, 1, 2].map(|a| places[a][(rng.bits() % places[a].len() as u64) as usize]);
            let mut d = [0; 3].map(|_| COMPONENTS[(rng.bits() % 10) as usize]);
            if d.iter().all(|d| d.abs() < 0.1) {
                d[(rng.bits() % 3) as usize] = if rng.uniform() < 0.5 { 1.0 } else { -1.0 };
            }
            let t_max = reach(dims, o, d) as f32;
            let ray = ray(o, d);
            let patient = Patient::new(full, limit);
            let bound = majorant_depth(&patient, &ray, t_max, true);
            assert!(
                bound >= 0.0 && bound.is_finite(),
                "{o:?} along {d:?}: {bound}"
            );
            let audited = Audited::new(full);
            let t = delta::sample(&audited, &ray, t_max, &mut stream(walked), true).t;
            assert!(
                (0.0..=t_max).contains(&t) && audited.violations() == 0,
                "{o:?} along {d:?}"
            );
            most = most.max(audited.segments() as f64 / f64::from(limit));
            walked += 1;
            // Along the far face itself a ray is outside.
            if (0..3).any(|a| o[a] == (dims[a] - 1) as f32) {
                continue;
            }
            // The look-ups on the way, in their segments.
            let mut walk = Medium::<f32>::idle(&full);
            full.begin(&mut walk, &ray, true);
            let mut t = 0.0_f32;
            while t < t_max {
                let exit = Medium::<f32>::segment(&full, &walk).t_exit.min(t_max);
                let middle = 0.5 * (t + exit);
                let found = full.sigma_t(&walk, middle, &mut stream(0), true);
                let place =
                    [0, 1, 2].map(|a| f64::from(o[a]) + f64::from(middle) * f64::from(d[a]));
                worst.see((f64::from(found) - grid.at(place)).abs(), || {
                    format!("{dims:?}, from {o:?} along {d:?} at {middle}")
                });
                assert!(found <= Medium::<f32>::segment(&full, &walk).majorant);
                t = t.max(exit);
                if t < t_max {
                    full.next_segment(&mut walk, true);
                }
            }
        }
    }
    println!("at most {most:.2} of the segments allowed");
    // Coordinates up to 32 are rounded to 2⁻²⁰, and so are weights.
    worst.within("interpolants along faces", 4e-6, 90_000);
}

/// Flights and weights through a grid against its optical depth, and no look-up above its bound.
fn flights_and_weights(
    name: &str,
    medium: &Grid<'_>,
    o: [f32; 3],
    d: [f32; 3],
    t_max: f32,
    exact: &Depth<'_>,
) {
    let n = samples(1 << 14);
    let audited = Audited::new(*medium);
    let ray = ray(o, d);
    let mut flights: Vec<f64> = (0..n as u32)
        .map(|i| delta::sample(&audited, &ray, t_max, &mut stream(i), true))
        .filter(|flight| flight.collided)
        .map(|flight| flight.t.into())
        .collect();
    let all = exact.collided(t_max.into());
    let share: Sample = (0..n)
        .map(|i| f64::from(u8::from(i < flights.len())))
        .collect();
    assert_verdict(name, judge(share.moments(), all, 0.1));
    let ks = KolmogorovSmirnov::new(&mut flights, |t| exact.collided(t) / all);
    assert_verdict(name, ks.verdict(0.1));
    let weights = Sample::collect(n, |i| {
        ratio::estimate(&audited, &ray, t_max, &mut stream(i as u32), true).into()
    });
    if exact.total() < 8.0 {
        assert_agrees(name, &weights, (-exact.total()).exp(), 0.05);
        must_kill(
            name,
            judge(weights.moments(), 3.0 * (-exact.total()).exp(), 0.05),
        );
    } else {
        assert!(weights.moments().max() <= 1.0 && weights.moments().min() >= 0.0);
    }
    assert_eq!(audited.violations(), 0, "{name}");
}

#[test]
fn a_voxel_of_a_million_beside_one_of_nothing() {
    // One cell, from nothing at x = 0 to a million at x = 1: flights end after a thousandth of it.
    let cell = TestGrid::new([2, 2, 2], |[x, _, _]| 1e6 * x as f32);
    let exact = cell.depth([0.0, 0.25, 0.5], [1.0, 0.0, 0.0], 0.999, 1.0);
    let medium = cell.medium(IDENTITY, 1.0);
    let t_max = 0.015_625; // a depth of 122, and as many look-ups as 15625
    assert!(exact.total() > 4e5);
    let near = Depth::new(t_max.into(), 1, &[], |t| 1e6 * t);
    let mut flights: Vec<f64> = (0..2000)
        .map(|i| {
            delta::sample(
                &medium,
                &ray([0.0, 0.25, 0.5], [1.0, 0.0, 0.0]),
                t_max,
                &mut stream(i),
                true,
            )
        })
        .map(|flight| {
            assert!(flight.collided);
            flight.t.into()
        })
        .collect();
    let ks = KolmogorovSmirnov::new(&mut flights, |t| near.collided(t));
    assert_verdict("towards a million", ks.verdict(0.1));
    // The other way at a scale where light passes, along the axis, askew, and along an edge of the cell.
    let medium = cell.medium(IDENTITY, 4e-6);
    for (o, d) in [
        ([1.0_f32, 0.25, 0.5], [-1.0_f32, 0.0, -0.0]),
        ([1.0, 0.0, 0.0], [-1.0, -0.0, 0.0]),
        ([0.0, 0.0, 0.0], [0.6, 0.0, 0.8]),
        ([0.0, 0.125, 0.25], [0.6, 0.48, 0.64]),
    ] {
        let t_max = reach(cell.dims, o, d) as f32;
        let exact = cell.depth(
            o.map(f64::from),
            d.map(f64::from),
            t_max.into(),
            4e-6_f32.into(),
        );
        flights_and_weights(&format!("{o:?} along {d:?}"), &medium, o, d, t_max, &exact);
    }
    // A checkerboard of both.
    let board = TestGrid::new(
        [10, 10, 10],
        |[x, y, z]| if (x + y + z) % 2 == 0 { 1e6 } else { 0.0 },
    );
    let medium = board.medium(IDENTITY, 3e-7);
    let (o, d) = ([0.5_f32, 0.25, 0.125], [0.6_f32, 0.48, 0.64]);
    let t_max = 10.0;
    let exact = board.depth(
        o.map(f64::from),
        d.map(f64::from),
        t_max.into(),
        3e-7_f32.into(),
    );
    flights_and_weights("a checkerboard", &medium, o, d, t_max, &exact);
}

#[test]
fn samples_at_the_ends_of_f32_mean_what_they_say() {
    let (o, d, t_max) = ([0.5_f32, 0.25, 0.125], [0.6_f32, 0.48, 0.64], 8.0_f32);
    for (unit, scale) in [
        (1e-40_f32, 3e38_f32),
        (1e-44, 3e38),
        (1.1e-38, 1e37),
        (3.3e38, 1e-39),
        (3.3e38, 7e-40),
    ] {
        let mut rng = SplitMix::new(3);
        let grid = TestGrid::new([9, 10, 11], |_| (rng.uniform() as f32) * unit);
        let medium = grid.medium(IDENTITY, scale);
        // 1e-44 has three bits, and 1e-44 · 3e38 is 3e-6: stretch the ray's world instead.
        let by = if unit < 1e-43 { 1e-5_f32 } else { 1.0 };
        let map: Affine = IDENTITY.map(|row| row.map(|x| x * by));
        let medium = if by < 1.0 {
            grid.medium(map, scale)
        } else {
            medium
        };
        let [o, t_max] = [o.map(|x| x / by), [t_max / by; 3]];
        let t_max = t_max[0];
        let local = |v: f64| v * f64::from(by);
        let exact = grid.depth(
            o.map(|x| local(x.into())),
            d.map(f64::from),
            local(t_max.into()),
            f64::from(scale) / f64::from(by),
        );
        let (total, name) = (
            exact.total(),
            format!("samples of {unit:e}, scaled by {scale:e}"),
        );
        assert!((0.01..20.0).contains(&total), "{name}: {total}");
        let world = Depth::new(t_max.into(), 400, &[], |t| {
            f64::from(scale)
                * grid.at([0, 1, 2].map(|a| local(f64::from(o[a]) + t * f64::from(d[a]))))
        });
        flights_and_weights(&name, &medium, o, d, t_max, &world);
    }
}

/// A grid whose box lies at a million: a map of integers keeps all digits that world coordinates have there.
#[test]
fn grids_at_an_offset_of_a_million_are_themselves() {
    let grid = TestGrid::random([17, 18, 19], 9, 0.3);
    let far = [1e6_f32, -1e6, 1e6];
    let map: Affine = std::array::from_fn(|a| {
        let mut row = IDENTITY[a];
        row[3] = -far[a];
        row
    });
    let medium = grid.medium(map, 0.5);
    let near = grid.medium(IDENTITY, 0.5);
    for (o, d) in [
        ([0.0_f32, 4.0, 8.0], [1.0_f32, 0.0, -0.0]),
        ([0.25, 0.0625, 16.5], [0.6, 0.48, -0.64]),
    ] {
        let t_max = reach(grid.dims, o, d) as f32;
        let world: [f32; 3] = std::array::from_fn(|a| o[a] + far[a]);
        let exact = grid.depth(o.map(f64::from), d.map(f64::from), t_max.into(), 0.5);
        flights_and_weights(
            &format!("far away, {d:?}"),
            &medium,
            world,
            d,
            t_max,
            &exact,
        );
        for i in 0..1000 {
            let there = delta::sample(&medium, &ray(world, d), t_max, &mut stream(i), true).t;
            let here = delta::sample(&near, &ray(o, d), t_max, &mut stream(i), true).t;
            assert_eq!(there.to_bits(), here.to_bits(), "the same flight, far away");
        }
    }
}

#[test]
fn what_no_tracker_can_step_under_is_refused() {
    let grid = TestGrid::new([2, 2, 2], |_| 3e38);
    assert!(Grid::new(grid.bounds(), IDENTITY, 1.0).is_some());
    assert!(
        Grid::new(grid.bounds(), IDENTITY, 1.2).is_none(),
        "a bound of infinity"
    );
    let mut table = vec![0.0; 27];
    table[13] = 3e38;
    use woodcock_core::medium::Voxels;
    assert!(Voxels::new(&table, [1; 3], IDENTITY, 1.0).is_ok());
    assert!(
        Voxels::new(&table, [1; 3], IDENTITY, 1.2).is_err(),
        "an extinction of infinity"
    );
}

/// A bound that is the largest sample does not cover the interpolant as it is rounded; those of core do.
#[test]
fn interpolants_of_equal_samples_exceed_them() {
    let mut rng = SplitMix::new(17);
    let (mut over, mut violations) = (0, 0);
    for _ in 0..400 {
        let value = (1.0 + rng.uniform()) as f32;
        let grid = TestGrid::new([3, 3, 3], |_| value);
        let full = Interpolated(grid.medium(IDENTITY, 1.0));
        let o = [0; 3].map(|_| rng.uniform() as f32);
        let mut walk = Medium::<f32>::idle(&full);
        full.begin(&mut walk, &ray(o, [0.6, 0.48, 0.64]), true);
        for i in 0..20 {
            let found: f32 = full.sigma_t(&walk, i as f32 * 0.06, &mut stream(0), true);
            over += u32::from(value < found);
            violations += u32::from(Medium::<f32>::segment(&full, &walk).majorant.lt(found));
        }
    }
    assert_eq!(violations, 0);
    assert!(
        over > 10,
        "a bound without a margin, exceeded {over} times of 8000 only"
    );
}
