//! Bounds hold with rounding included: interpolation in `f32` errs by up to 7 units of 2⁻²⁴, and bounds know.

use woodcock_core::enclosure::Enclosure;
use woodcock_core::majorant::{GridLayout, GridWalk, MajorantGrid};
use woodcock_core::real::{Mask, Real};
use woodcock_tests::each_width;
use woodcock_tests::grids::TestGrid;
use woodcock_tests::stats::independent::SplitMix;
use woodcock_tests::widths::{everyone, ray, width};

/// 2⁻²⁴, relative rounding of one operation.
const U: f64 = 1.0 / 16_777_216.0;

/// Samples that interpolation may leave: a cell of almost equal ones, of one exponent, of some zeros; at all magnitudes.
fn samples(rng: &mut SplitMix, kind: usize) -> [f32; 8] {
    let bits = rng.bits();
    let largest = match kind % 8 {
        0 => f32::from_bits(1 + (bits % 64) as u32),
        1 => f32::from_bits((bits as u32 % 4 + 1) << 23 | (bits >> 40) as u32 & 0x7f_ffff),
        2 => 3.4e38,
        _ => f32::from_bits(0x3f80_0000 | (bits >> 40) as u32 & 0x7f_ffff),
    };
    std::array::from_fn(|_| match (kind / 8) % 4 {
        0 => largest,
        1 => f32::from_bits(largest.to_bits().saturating_sub((rng.bits() % 3) as u32)),
        2 => largest * rng.uniform() as f32,
        _ => [largest, 0.0][(rng.bits() % 2) as usize],
    })
}

/// A weight as places have them: a fraction with few bits, many, or nearly one.
fn weight(rng: &mut SplitMix) -> f64 {
    let w = match rng.bits() % 4 {
        0 => rng.uniform(),
        1 => 2.0_f64.powi(-((rng.bits() % 24) as i32)) * (0.5 + 0.5 * rng.uniform()),
        2 => 1.0 - 2.0_f64.powi(-((rng.bits() % 24) as i32)),
        _ => (rng.bits() % 9) as f64 / 8.0,
    };
    f64::from((w as f32).clamp(0.0, 1.0))
}

/// Visits look-ups of a one-cell grid, in units of its samples and with their largest and smallest.
fn look_ups<R: Real>(cases: usize, mut visit: impl FnMut(&TestGrid, [f64; 3], R)) {
    let mut rng = SplitMix::new(620);
    for kind in 0..cases {
        let corners = samples(&mut rng, kind);
        let grid = TestGrid::new([2, 2, 2], |[x, y, z]| corners[(x + 2 * y + 4 * z) as usize]);
        let layout = GridLayout::<R>::of(&grid.bounds(), 1.0);
        for _ in 0..10 {
            let place: [f64; 3] = std::array::from_fn(|_| weight(&mut rng));
            let mut walk = GridWalk::<R>::idle();
            walk.begin(
                &layout,
                &ray(place, [0.0; 3]),
                &grid.majorants,
                everyone::<R>(),
            );
            visit(&grid, place, walk.trilinear(&grid.samples, R::zero()));
        }
    }
}

fn extremes(grid: &TestGrid) -> (f64, f64) {
    let all = grid.samples.iter().map(|&s| f64::from(s));
    (
        all.clone().fold(f64::INFINITY, f64::min),
        all.fold(0.0, f64::max),
    )
}

#[test]
fn the_rounded_interpolant_stays_within_what_is_proved() {
    let tiniest = f64::from(f32::from_bits(1));
    each_width!(R, S => {
        let _: Option<S> = None;
        let (mut above, mut below) = (0.0_f64, 0.0_f64);
        let (mut tiny_above, mut tiny_below) = (0.0_f64, 0.0_f64);
        look_ups::<R>(20_000, |grid, place, value| {
            let (smallest, largest) = extremes(grid);
            let value = f64::from(value.lane(0));
            // What `MajorantGrid::new` proves that bounds are beyond.
            let proved = largest * (1.0 + 8.0 * U) + 3.0 * tiniest;
            assert!(value <= proved, "{value:e} of {largest:e} at {place:?}");
            let proved = smallest * (1.0 - 8.0 * U) - 3.0 * tiniest;
            assert!(value >= proved.max(0.0), "{value:e} of {smallest:e} at {place:?}");
            if smallest > 1e-30 {
                above = above.max((value / largest - 1.0) / U);
                below = below.max((1.0 - value / smallest) / U);
            } else if largest < 1e-43 {
                tiny_above = tiny_above.max((value - largest) / tiniest);
                tiny_below = tiny_below.max((smallest - value) / tiniest);
            }
        });
        if R::LANES == 1 && size_of::<R>() == 8 {
            assert!(above <= 0.01 && below <= 0.01, "the oracle rounds in double precision");
        } else {
            // It does happen: without room for rounding these would be violations.
            assert!(above >= 1.9 && below >= 1.9, "{}: {above} and {below} units", width::<R>());
            assert!(tiny_above >= 1.0 && tiny_below >= 1.0, "{}: {tiny_above} and {tiny_below}", width::<R>());
        }
    });
}

/// The same through bounds and walk, under scales that round once more, and against the bare largest sample.
#[test]
fn no_scaled_look_up_exceeds_its_bound() {
    let mut bare = 0;
    for scale in [1.0, 0.7, 1e-30, 3.0, 1e-44] {
        each_width!(R, S => {
            let _: Option<S> = None;
            let mut rng = SplitMix::new(621);
            for kind in (0..4000).filter(|kind| kind % 8 != 2) {
                let corners = samples(&mut rng, kind);
                let grid = TestGrid::new([2, 2, 2], |[x, y, z]| corners[(x + 2 * y + 4 * z) as usize]);
                let layout = GridLayout::<R>::of(&grid.bounds(), scale);
                let place: [f64; 3] = std::array::from_fn(|_| weight(&mut rng));
                let mut walk = GridWalk::<R>::idle();
                walk.begin(&layout, &ray(place, [0.0; 3]), &grid.majorants, everyone::<R>());
                let (bound, value) = (walk.segment().majorant, walk.trilinear(&grid.samples, R::zero()));
                assert!(value.le(bound).all(), "{value:?} above {bound:?}");
                let largest = corners.into_iter().fold(0.0, f32::max);
                bare += u32::from((R::splat(largest) * R::splat(scale)).lt(value).any());
            }
        });
    }
    assert!(bare > 100, "{bare} look-ups above the largest sample");
}

/// A bound a little above the largest sample is refused up to what rounding needs, and accepted from there.
#[test]
fn what_is_demanded_is_the_factor() {
    for largest in [1.0_f32, 0.7, 1.999_999_9, 3e38, 1e-30] {
        let samples = [largest; 8];
        let accepts = |factor: f64| {
            let mut bounds = [0.0_f32; 27];
            bounds[13] = (f64::from(largest) * factor) as f32;
            MajorantGrid::new(&samples, [2; 3], &bounds).is_ok()
        };
        assert!(!accepts(1.0) && !accepts(1.0 + 6.0 * U), "{largest}");
        assert!(
            accepts(1.0 + 10.0 * U) && accepts(1.5_f64.min(3.402e38 / f64::from(largest))),
            "{largest}"
        );
    }
    // Of the smallest floats, three more.
    for (units, accepted) in [(9, false), (11, false), (13, true), (14, true)] {
        let samples = [f32::from_bits(9); 8];
        let mut bounds = [0.0_f32; 27];
        bounds[13] = f32::from_bits(units);
        let grid = MajorantGrid::new(&samples, [2; 3], &bounds);
        assert_eq!(grid.is_ok(), accepted, "{units} units over samples of nine");
    }
}

/// Interval arithmetic says the same of each look-up: it encloses what is exact and what is rounded, and lies below
/// the bound wherever its own, coarser rounding leaves room.
#[test]
fn enclosures_of_the_interpolant_agree() {
    let lerp = |w: f32, a: Enclosure, b: Enclosure| {
        let w = Enclosure::point(w);
        a * (Enclosure::point(1.0) - w) + b * w
    };
    let mut below = 0;
    look_ups::<f32>(20_000, |grid, place, value| {
        let sample = |i: usize| Enclosure::point(grid.samples[i]);
        let [x, y, z] = place.map(|p| p as f32);
        let row = |i: usize| lerp(x, sample(i), sample(i + 1));
        let slice = |i: usize| lerp(y, row(i), row(i + 2));
        let all = lerp(z, slice(0), slice(4));
        let exact = grid.at(place);
        assert!(all.contains(exact), "{exact:e} not in {all:?} at {place:?}");
        assert!(
            all.contains(f64::from(value)),
            "{value:e} not in {all:?} at {place:?}"
        );
        let (smallest, largest) = extremes(grid);
        let proved = f64::from(all.high())
            <= largest * (1.0 + 32.0 * U) + 16.0 * f64::from(f32::from_bits(1));
        assert!(proved, "{all:?} of {smallest:e} to {largest:e}");
        below += u32::from(all.high() <= grid.majorants[13]);
    });
    assert!(below > 100_000, "{below} of 200000");
}
