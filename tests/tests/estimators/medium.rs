//! Media: extinction where it should be, below its bound, in segments that tile the ray; for every row.

use woodcock_core::for_each_medium;
use woodcock_core::majorant::GridLayout;
use woodcock_core::majorant::GridWalk;
use woodcock_core::medium::{Affine, Controlled, Grid, Homogeneous, IDENTITY, Medium};
use woodcock_core::ray::Ray;
use woodcock_core::real::{Mask, Real};
use woodcock_core::stream::{KeyedStream, PathStream};
use woodcock_tests::each_width;
use woodcock_tests::grids::{Chord, TestGrid, map_point, unit};
use woodcock_tests::stats::independent::SplitMix;
use woodcock_tests::stats::{
    ChiSquare, Sample, assert_agrees, assert_verdict, must_kill, samples, seed,
};
use woodcock_tests::widths::{everyone, ray, sample, width};

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

mod compose;
#[expect(non_camel_case_types, reason = "the registry names files")]
mod rows;

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
