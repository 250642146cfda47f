//! Media: extinction where it should be, below its bound, in segments that tile the ray; for every row.

use woodcock_core::for_each_medium;
use woodcock_core::majorant::GridLayout;
use woodcock_core::majorant::GridWalk;
use woodcock_core::medium::{
    Affine, Controlled, Exponential, Grid, Homogeneous, IDENTITY, Interpolated, Linear, Medium,
    Overlap, Placed, Procedural, Voxels, Within, fill_voxels, voxel_count,
};
use woodcock_core::ray::Ray;
use woodcock_core::real::{Mask, Real};
use woodcock_core::stream::{KeyedStream, PathStream};
use woodcock_tests::each_width;
use woodcock_tests::fixtures;
use woodcock_tests::grids::{Chord, TestGrid, chord, map_point, unit};
use woodcock_tests::stats::independent::SplitMix;
use woodcock_tests::stats::{
    ChiSquare, Sample, assert_agrees, assert_verdict, must_kill, samples, seed,
};
use woodcock_tests::widths::{everyone, per_lane, ray, sample, width};

mod cells;

/// A question that is put to every case of every row.
trait Question<R: Real> {
    /// * `sigma_t`: the extinction at a world-space place, by an oracle.
    fn ask<M: Controlled<R>>(
        &mut self,
        name: &str,
        medium: &M,
        sigma_t: &dyn Fn([f64; 3]) -> f64,
        chord: &Chord,
    );
}

/// A row's cases.
trait Row {
    fn put<R: Real>(question: &mut impl Question<R>);
}

const AXES: [[f64; 3]; 4] = [
    [1.0, 0.0, 0.0],
    [0.0, -1.0, 0.0],
    [0.6, 0.48, 0.64],
    [-1.0, 1e-7, 1.0],
];

#[expect(non_camel_case_types, reason = "the registry names files")]
mod rows {
    use super::*;

    pub(super) struct Fog;
    impl Row for Fog {
        fn put<R: Real>(question: &mut impl Question<R>) {
            for sigma_t in [0.0, 0.7, 1e6] {
                let medium = Homogeneous::new(sigma_t).expect("a valid extinction");
                for direction in AXES {
                    let chord = chord([9, 9, 9], [4.0, 3.0, 2.0], direction);
                    let name = format!("fog {sigma_t}");
                    question.ask(&name, &medium, &|_| f64::from(sigma_t), &chord);
                }
            }
        }
    }

    /// Turned by 30 degrees about z, stretched unevenly, sheared and moved.
    pub(super) const PLACED: Affine = [
        [6.928_203, 4.0, 0.5, 3.0],
        [-5.0, 8.660_254, 0.0, 6.0],
        [0.25, 0.0, 12.0, 4.0],
    ];

    pub(super) struct OnGrid;
    impl Row for OnGrid {
        fn put<R: Real>(question: &mut impl Question<R>) {
            for (dims, empty) in [([17, 18, 19], 0.5), ([2, 2, 2], 0.0), ([41, 9, 33], 0.9)] {
                let grid = TestGrid::random(dims, 81, empty);
                let medium = grid.medium(IDENTITY, 2.5);
                let middle = dims.map(|n| 0.5 * f64::from(n - 1));
                for direction in AXES {
                    let name = format!("grid of {dims:?}");
                    let chord = chord(dims, middle, direction);
                    question.ask(&name, &medium, &|p| 2.5 * grid.at(p), &chord);
                }
            }
            // From near the grid's origin to where the walk must stop inside it, in world space.
            let grid = TestGrid::random([17, 25, 33], 82, 0.3);
            let medium = grid.medium(PLACED, 4.0);
            for direction in [[0.3, 0.4, 0.8], [0.0, 1.0, 0.0], [-0.5, 0.2, 0.1]] {
                let chord = Chord {
                    origin: [0.25, 0.5, 0.25],
                    direction: unit(direction).map(|d| f64::from(d as f32)),
                    t_max: 0.5,
                };
                let sigma_t = |p| 4.0 * grid.at(map_point(&PLACED, p));
                question.ask("placed grid", &medium, &sigma_t, &chord);
            }
        }
    }

    pub(super) struct InFull;
    impl Row for InFull {
        fn put<R: Real>(question: &mut impl Question<R>) {
            let grid = TestGrid::random([17, 18, 19], 64, 0.5);
            let medium = Interpolated(grid.medium(IDENTITY, 2.5));
            for direction in AXES {
                let chord = chord(grid.dims, [8.2, 8.1, 9.3], direction);
                question.ask("grid in full", &medium, &|p| 2.5 * grid.at(p), &chord);
            }
        }
    }

    pub(super) struct Formula;
    impl Row for Formula {
        fn put<R: Real>(question: &mut impl Question<R>) {
            for fixture in fixtures::all().iter().step_by(4) {
                let field = fixture.sigma_t();
                let bound = (fixture.majorant as f32).next_up();
                let medium = Procedural::new(per_lane::<R>(fixture.sigma_t()), bound)
                    .with_control(fixture.minimum() as f32, fixture.mean() as f32);
                let chord = Chord {
                    origin: fixture.ray.origin.map(|v| f64::from(v as f32)),
                    direction: fixture.ray.dir.map(|v| f64::from(v as f32)),
                    t_max: f64::from(fixture.ray.t_max as f32),
                };
                question.ask(&fixture.name, &medium, &|p| field(p[0], p[1], p[2]), &chord);
            }
        }
    }

    /// σ₀ and gradient of ramps; the last two are zero somewhere on their way.
    pub(super) const RAMPS: [(f32, [f32; 3]); 5] = [
        (2.0, [0.0; 3]),
        (0.5, [0.3, 0.0, 0.1]),
        (3.0, [-0.1, 0.05, -0.2]),
        (0.4, [-0.1, -0.1, -0.1]),
        (-1.0, [0.2, 0.3, 0.01]),
    ];

    pub(super) struct Ramp;
    impl Row for Ramp {
        fn put<R: Real>(question: &mut impl Question<R>) {
            for (offset, gradient) in RAMPS {
                let medium = Linear::new(offset, gradient).expect("a finite ramp");
                let at = |p: [f64; 3]| {
                    let slope: f64 = (0..3).map(|a| f64::from(gradient[a]) * p[a]).sum();
                    (f64::from(offset) + slope).max(0.0)
                };
                for direction in AXES {
                    let chord = chord([9, 9, 9], [4.0, 3.0, 2.0], direction);
                    question.ask(&format!("ramp {offset} {gradient:?}"), &medium, &at, &chord);
                }
            }
        }
    }

    pub(super) struct Atmosphere;
    impl Row for Atmosphere {
        fn put<R: Real>(question: &mut impl Question<R>) {
            for (sigma_0, falloff) in [
                (2.0, [0.0; 3]),
                (0.0, [0.0, 0.0, 1.0]),
                (0.5, [0.3, 0.0, -0.1]),
                (3.0, [0.0, 0.0, 2.0]),
                (4.0, [1e-6, -1e-7, 0.0]),
            ] {
                let medium = Exponential::new(sigma_0, falloff).expect("a valid atmosphere");
                let at = |p: [f64; 3]| {
                    let heights: f64 = (0..3).map(|a| f64::from(falloff[a]) * p[a]).sum();
                    f64::from(sigma_0) * (-heights).exp()
                };
                for direction in AXES {
                    let chord = chord([9, 9, 9], [4.0, 3.0, 2.0], direction);
                    question.ask(&format!("air {sigma_0} {falloff:?}"), &medium, &at, &chord);
                }
            }
        }
    }

    /// Voxels with their table.
    pub(super) struct Blocks {
        dims: [u32; 3],
        table: Vec<f32>,
    }
    impl Blocks {
        pub(super) fn random(dims: [u32; 3], seed: u64) -> Self {
            let mut rng = SplitMix::new(seed);
            let count = dims.iter().product::<u32>() as usize;
            let value = |_| {
                if rng.uniform() < 0.3 {
                    0.0
                } else {
                    rng.uniform() as f32
                }
            };
            let values: Vec<f32> = (0..count).map(value).collect();
            let mut table = vec![f32::NAN; voxel_count(dims).expect("few cells")];
            fill_voxels(&values, dims, &mut table).expect("lengths that fit");
            Self { dims, table }
        }
        pub(super) fn at(&self, p: [f64; 3]) -> f64 {
            let [x, y, z] = p.map(|v| v.floor() as usize + 1);
            let [nx, ny, _] = self.dims.map(|n| n as usize + 2);
            f64::from(self.table[x + nx * (y + ny * z)])
        }
        pub(super) fn medium(&self, world_to_grid: Affine, scale: f32) -> Voxels<'_> {
            Voxels::new(&self.table, self.dims, world_to_grid, scale).expect("valid cells")
        }
    }

    pub(super) struct OfVoxels;
    impl Row for OfVoxels {
        fn put<R: Real>(question: &mut impl Question<R>) {
            for dims in [[8, 8, 8], [1, 1, 1], [13, 2, 5]] {
                let blocks = Blocks::random(dims, 61);
                let medium = blocks.medium(IDENTITY, 3.0);
                let middle = dims.map(|n| 0.4143 * f64::from(n));
                for direction in AXES {
                    let chord = chord(dims.map(|n| n + 1), middle, direction);
                    question.ask("cells", &medium, &|p| 3.0 * blocks.at(p), &chord);
                }
            }
        }
    }

    pub(super) struct Sum;
    impl Row for Sum {
        fn put<R: Real>(question: &mut impl Question<R>) {
            let grid = TestGrid::random([17, 18, 19], 62, 0.4);
            let fog = Homogeneous::new(0.25).expect("a valid extinction");
            let ramp = Linear::new(0.5, [0.1, 0.0, 0.05]).expect("a finite ramp");
            let medium = Overlap(Overlap(fog, grid.medium(IDENTITY, 2.0)), ramp);
            let at = |p: [f64; 3]| 0.25 + 2.0 * grid.at(p) + 0.5 + 0.1 * p[0] + 0.05 * p[2];
            for direction in AXES {
                let chord = chord(grid.dims, [8.0, 7.5, 9.0], direction);
                question.ask("fog, grid and ramp", &medium, &at, &chord);
            }
        }
    }

    pub(super) struct Moved;
    impl Row for Moved {
        fn put<R: Real>(question: &mut impl Question<R>) {
            for (offset, gradient) in RAMPS {
                let ramp = Linear::new(offset, gradient).expect("a finite ramp");
                let medium = Placed::new(ramp, PLACED).expect("a finite map");
                let at = |p: [f64; 3]| {
                    let q = map_point(&PLACED, p);
                    let slope: f64 = (0..3).map(|a| f64::from(gradient[a]) * q[a]).sum();
                    (f64::from(offset) + slope).max(0.0)
                };
                for direction in AXES {
                    let chord = chord([9, 9, 9], [4.0, 3.0, 2.0], direction);
                    question.ask("placed ramp", &medium, &at, &chord);
                }
            }
        }
    }

    pub(super) struct Boxed;
    impl Row for Boxed {
        fn put<R: Real>(question: &mut impl Question<R>) {
            let grid = TestGrid::random([9, 10, 17], 63, 0.2);
            let map = [
                [1.0, 0.0, 0.0, -3.0],
                [0.0, 1.0, 0.0, -2.5],
                [0.0, 0.0, 1.0, -4.0],
            ];
            let medium = Within::domain(grid.medium(map, 1.5));
            let at = |p: [f64; 3]| {
                let q = [p[0] - 3.0, p[1] - 2.5, p[2] - 4.0];
                let inside = (0..3).all(|a| q[a] >= 0.0 && q[a] <= f64::from(grid.dims[a] - 1));
                if inside { 1.5 * grid.at(q) } else { 0.0 }
            };
            // Through the box, and past it.
            for (through, direction) in [
                ([8.0, 6.0, 11.0], [0.6, 0.48, 0.64]),
                ([8.0, 6.0, 11.0], [-1.0, 1e-7, 1.0]),
                ([8.0, 6.0, 11.0], [0.0, -1.0, 0.0]),
                ([1.0, 1.0, 11.0], [0.0, 0.0, 1.0]),
            ] {
                let chord = chord([18, 18, 26], through, direction);
                question.ask("grid in its box", &medium, &at, &chord);
            }
            let fog = Homogeneous::new(2.0).expect("a valid extinction");
            let medium = Within::aligned(fog, [1.0, 2.0, 3.0], [4.0, 5.0, 9.5]).expect("a box");
            let at = |p: [f64; 3]| {
                let low = [1.0, 2.0, 3.0];
                let high = [4.0, 5.0, 9.5];
                let inside = (0..3).all(|a| p[a] >= low[a] && p[a] <= high[a]);
                if inside { 2.0 } else { 0.0 }
            };
            let chord = chord([10, 10, 10], [2.0, 3.0, 4.0], [0.5, 0.3, 0.8]);
            question.ask("fog in a box", &medium, &at, &chord);
        }
    }

    // The suite's name for each row of the registry.
    pub(super) type exponential = Atmosphere;
    pub(super) type interpolated = InFull;
    pub(super) type linear = Ramp;
    pub(super) type voxels = OfVoxels;
    pub(super) type overlap = Sum;
    pub(super) type placed = Moved;
    pub(super) type within = Boxed;
    pub(super) type homogeneous = Fog;
    pub(super) type grid = OnGrid;
    pub(super) type procedural = Formula;
    pub(super) type procedural_grid = cells::InCells;
}

/// Walks the segments, and looks up at many places of each.
struct Bounds<S> {
    rng: S,
    lookups: u64,
}

impl<R: Real, S: KeyedStream<R>> Question<R> for Bounds<S> {
    fn ask<M: Controlled<R>>(
        &mut self,
        name: &str,
        medium: &M,
        _: &dyn Fn([f64; 3]) -> f64,
        chord: &Chord,
    ) {
        let all = everyone::<R>();
        let along: Ray<R> = ray(chord.origin, chord.direction);
        let mut walk = medium.idle();
        medium.begin(&mut walk, &along, all);
        let end = R::splat(chord.t_max as f32);
        let (mut from, mut tiled) = (R::zero(), 0.0);
        for segment_number in 0.. {
            let segment = medium.segment(&walk);
            let to = segment.t_exit.min(end).max(from);
            tiled += f64::from(to.lane(0)) - f64::from(from.lane(0));
            for i in 0..40 {
                let t = from + (to - from) * R::splat(i as f32 / 39.0);
                let sigma_t = medium.sigma_t(&walk, t, &mut self.rng, all);
                assert!(
                    !segment.majorant.lt(sigma_t).any(),
                    "{name}: {sigma_t:?} above {segment:?}"
                );
                assert!(R::zero().le(sigma_t).all(), "{name}: {sigma_t:?}");
                let low = medium.control(&walk);
                let known = low.minimum.le(sigma_t) & low.minimum.le(segment.majorant);
                assert!(known.all(), "{name}: {sigma_t:?} below {low:?}");
                if M::TIGHT {
                    assert!(
                        sigma_t.eq(segment.majorant).all(),
                        "{name}: a bound that is not tight"
                    );
                }
                self.lookups += R::LANES as u64;
            }
            from = to;
            if end.le(from).all() {
                break;
            }
            assert!(
                !M::ONE_SEGMENT,
                "{name}: the one segment ends before the ray"
            );
            assert!(segment_number < 100, "{name}: no end of segments");
            medium.next_segment(&mut walk, all);
        }
        assert!(
            (tiled - chord.t_max).abs() <= 1e-6 * chord.t_max,
            "{name}: {tiled} of {}",
            chord.t_max
        );
    }
}

/// Compares look-ups, averaged, with the oracle at a few places.
struct Means<S>(std::marker::PhantomData<S>);

impl<R: Real, S: KeyedStream<R>> Question<R> for Means<S> {
    fn ask<M: Controlled<R>>(
        &mut self,
        name: &str,
        medium: &M,
        sigma_t: &dyn Fn([f64; 3]) -> f64,
        chord: &Chord,
    ) {
        let all = everyone::<R>();
        let along: Ray<R> = ray(chord.origin, chord.direction);
        for share in [0.0, 0.11, 0.47, 0.83] {
            let t = share * chord.t_max;
            let exact = sigma_t(std::array::from_fn(|a| {
                chord.origin[a] + t * chord.direction[a]
            }));
            let mut walk = medium.idle();
            medium.begin(&mut walk, &along, all);
            let there = R::splat(t as f32);
            while medium.segment(&walk).t_exit.lt(there).all() {
                medium.next_segment(&mut walk, all);
            }
            let values: Sample = sample::<R, S>(seed(83), 0, samples(1 << 14), |rng| {
                medium.sigma_t(&walk, there, rng, all)
            });
            let m = values.moments();
            let name = format!("{name} {} at {t}", width::<R>());
            if exact < 1e-9 {
                // Zero, but for a corner that a place in `f64` has a share of and one in `f32` has not.
                assert!(m.mean() < 1e-6, "{name}: {} for {exact:e}", m.mean());
            } else if m.max() - m.min() <= 1e-6 * exact {
                // One value: what positions of `f32` allow, across the slopes of the fields.
                assert!(
                    (m.mean() / exact - 1.0).abs() < 1e-4,
                    "{name}: {} for {exact}",
                    m.mean()
                );
            } else if exact > 0.1 {
                assert_agrees(&name, &values, exact, 0.1);
            }
        }
    }
}

fn bounds<T: Row>() {
    each_width!(R, S => {
        let mut question = Bounds { rng: <S as KeyedStream<R>>::idle(), lookups: 0 };
        T::put::<R>(&mut question);
        assert!(question.lookups > 400, "{}", question.lookups);
    });
}

fn means<T: Row>() {
    each_width!(R, S => {
        T::put::<R>(&mut Means(std::marker::PhantomData::<S>));
    });
}

macro_rules! row {
    ($name:ident) => {
        mod $name {
            type Row = super::rows::$name;
            #[test]
            fn segments_tile_and_bound() {
                super::bounds::<Row>();
            }
            #[test]
            fn look_ups_have_the_right_mean() {
                super::means::<Row>();
            }
        }
    };
}
for_each_medium!(row);

/// The eight samples of one cell are told apart by their values, so counts show which was picked.
#[test]
fn one_tap_picks_corners_by_their_weights() {
    let grid = TestGrid::new([2, 2, 2], |[x, y, z]| (1 + x + 2 * y + 4 * z) as f32);
    let n = samples(1 << 18);
    let places = [
        [0.5, 0.5, 0.5],
        [0.25, 0.9, 0.03],
        [0.001, 0.999, 0.5],
        [1.0, 0.3, 0.0],
        [0.0, 0.0, 1.0],
    ];
    for (pixel, place) in (0..).zip(places) {
        let place = place.map(|p: f64| f64::from(p as f32));
        each_width!(R, S => {
            let mut walk = GridWalk::<R>::idle();
            let layout = GridLayout::of(&grid.bounds(), 1.0);
            walk.begin(&layout, &ray(place, [0.0; 3]), &grid.majorants, everyone::<R>());
            let mut counts = [0_u64; 8];
            for value in woodcock_tests::widths::collect::<R, S>(seed(84), pixel, n, |rng| {
                walk.sigma_t(&grid.samples, R::zero(), rng, everyone::<R>())
            }) {
                counts[value as usize - 1] += 1;
            }
            let weight = |corner: usize| -> f64 {
                (0..3).map(|a| if corner >> a & 1 == 1 { place[a] } else { 1.0 - place[a] }).product()
            };
            let weights: [f64; 8] = std::array::from_fn(weight);
            let name = format!("{place:?} {}", width::<R>());
            if weights.contains(&1.0) {
                assert_eq!(counts.iter().filter(|&&c| c > 0).count(), 1, "{name}: {counts:?}");
            } else {
                assert_verdict(&name, ChiSquare::new(&counts, &weights).verdict(0.02));
            }
            // The same counts against a place a few hundredths aside: the check sees such a mistake.
            let aside = |corner: usize| -> f64 {
                let p = [place[0] + if place[0] < 0.5 { 0.03 } else { -0.03 }, place[1], place[2]];
                (0..3).map(|a| if corner >> a & 1 == 1 { p[a] } else { 1.0 - p[a] }).product()
            };
            if pixel < 3 {
                must_kill(&name, ChiSquare::new(&counts, &std::array::from_fn::<f64, 8, _>(aside)).verdict(0.02));
            }
        });
    }
}

#[test]
fn trilinear_is_that_of_the_oracle() {
    let mut rng = SplitMix::new(85);
    for dims in [[2, 2, 2], [3, 9, 17], [33, 8, 25]] {
        let grid = TestGrid::random(dims, 86, 0.2);
        for _ in 0..20_000 {
            let place = dims.map(|n| {
                let p = f64::from(n - 1) * rng.uniform();
                let p = if rng.bits().is_multiple_of(8) {
                    p.round()
                } else {
                    p
                };
                f64::from(p as f32)
            });
            let exact = 3.0 * grid.at(place);
            each_width!(R, S => {
                let _: Option<S> = None;
                let mut walk = GridWalk::<R>::idle();
                walk.begin(&GridLayout::of(&grid.bounds(), 3.0), &ray(place, [0.0; 3]), &grid.majorants, everyone::<R>());
                let value = f64::from(walk.trilinear(&grid.samples, R::zero()).lane(0));
                assert!((value - exact).abs() <= 2e-6, "{value} for {exact} at {place:?}");
            });
        }
    }
}

/// Where a ray meets a turned box, against corners computed in double precision.
#[test]
fn clipping_finds_the_domain() {
    let grid = TestGrid::random([17, 25, 33], 87, 0.0);
    let medium = grid.medium(rows::PLACED, 1.0);
    let mut rng = SplitMix::new(88);
    let (mut hits, mut misses) = (0, 0);
    for _ in 0..100_000 {
        let origin: [f64; 3] = std::array::from_fn(|_| f64::from((6.0 * rng.normal()) as f32));
        let direction =
            unit([rng.normal(), rng.normal(), rng.normal()]).map(|d| f64::from(d as f32));
        let (o, d) = (
            map_point(&rows::PLACED, origin),
            woodcock_tests::grids::map_vector(&rows::PLACED, direction),
        );
        let (mut t0, mut t1) = (0.0_f64, f64::INFINITY);
        for a in 0..3 {
            let (near, far) = (-o[a] / d[a], (f64::from(grid.dims[a] - 1) - o[a]) / d[a]);
            t0 = t0.max(near.min(far));
            t1 = t1.min(near.max(far));
        }
        let interval = medium.clip::<f32>(&ray(origin, direction));
        let (c0, c1) = (f64::from(interval.t0), f64::from(interval.t1));
        if (t1 - t0).abs() < 1e-3 {
            continue; // grazing: rounding decides
        }
        if t0 < t1 {
            hits += 1;
            assert!(
                (c0 - t0).abs() < 1e-4 * (1.0 + t0) && (c1 - t1).abs() < 1e-4 * (1.0 + t1),
                "{interval:?} for {t0}..{t1}"
            );
        } else {
            misses += 1;
            assert!(c0 >= c1, "{interval:?} where there is nothing");
        }
    }
    assert!(hits > 1000 && misses > 1000, "{hits} hits, {misses} misses");
}

#[test]
fn constructors_refuse_what_no_medium_is() {
    for bad in [
        -1.0,
        -f32::MIN_POSITIVE,
        f32::NAN,
        f32::INFINITY,
        f32::NEG_INFINITY,
    ] {
        let error = Homogeneous::new(bad).expect_err("no extinction");
        assert_eq!(error.0.to_bits(), bad.to_bits());
        assert!(error.to_string().contains(&bad.to_string()), "{error}");
    }
    assert_eq!(Homogeneous::new(-0.0).expect("zero").extinction(), 0.0);
    let grid = TestGrid::random([3, 3, 3], 89, 0.0);
    let refused = |map: Affine, scale: f32| assert!(Grid::new(grid.bounds(), map, scale).is_none());
    for bad in [-1.0, f32::NAN, f32::INFINITY] {
        refused(IDENTITY, bad);
    }
    for (row, column) in [(0, 0), (1, 3), (2, 2)] {
        for bad in [f32::NAN, f32::INFINITY] {
            let mut map = IDENTITY;
            map[row][column] = bad;
            refused(map, 1.0);
        }
    }
    // Nothing drawn, nothing found: a look-up for nobody leaves the stream alone.
    let medium = grid.medium(IDENTITY, 1.0);
    let mut rng = <PathStream as KeyedStream<f32>>::idle();
    let before = format!("{rng:?}");
    let mut walk = Medium::<f32>::idle(&medium);
    medium.begin(&mut walk, &ray([0.5; 3], [1.0, 0.0, 0.0]), true);
    let value = medium.sigma_t(&walk, 0.1, &mut rng, false);
    assert!(value.is_finite());
    assert_eq!(before, format!("{rng:?}"));
}
