//! Controls: minorants that no look-up falls below, means that are the interpolant's.

use super::{SIZES, bound, each_block, grids};
use woodcock_core::majorant::{
    BLOCK, GridLayout, GridWalk, MajorantError, fill_controls, majorant_count,
};
use woodcock_core::real::{Mask, Real};
use woodcock_core::stream::KeyedStream;
use woodcock_tests::each_width;
use woodcock_tests::grids::TestGrid;
use woodcock_tests::stats::independent::SplitMix;
use woodcock_tests::widths::{everyone, ray};

/// Minorants and means of a grid.
fn controls(grid: &TestGrid) -> [Vec<f32>; 2] {
    let mut minorants = vec![f32::NAN; grid.majorants.len()];
    let mut means = minorants.clone();
    fill_controls(&grid.samples, grid.dims, &mut minorants, &mut means).expect("valid samples");
    grid.bounds()
        .with_controls(&minorants, &means)
        .expect("computed controls are proved");
    [minorants, means]
}

/// The entry of a block in a table laid out as the bounds are.
fn entry(grid: &TestGrid, table: &[f32], block: [usize; 3]) -> f64 {
    let like = TestGrid {
        majorants: table.to_vec(),
        ..grid.clone()
    };
    bound(&like, block)
}

/// Cells along each axis of a block, and its first.
fn cells(grid: &TestGrid, block: [usize; 3]) -> [std::ops::Range<usize>; 3] {
    std::array::from_fn(|a| {
        let first = block[a] * BLOCK as usize;
        first..(first + BLOCK as usize).min(grid.dims[a] as usize - 1)
    })
}

#[test]
fn minorants_and_means_are_those_of_the_footprint() {
    for (name, grid) in grids() {
        let [minorants, means] = controls(&grid);
        let mut inner = [0.0; 2];
        each_block(&grid, |block| {
            let [xs, ys, zs] = cells(&grid, block);
            let (mut smallest, mut sum, mut count) = (f64::INFINITY, 0.0, 0.0);
            for z in zs {
                for y in ys.clone() {
                    for x in xs.clone() {
                        // The mean of a trilinear cell is its value in the middle.
                        sum += grid.at([x, y, z].map(|i| i as f64 + 0.5));
                        count += 1.0;
                        for corner in 0..8 {
                            let at = [x + (corner & 1), y + (corner >> 1 & 1), z + (corner >> 2)];
                            smallest = smallest.min(grid.sample(at));
                        }
                    }
                }
            }
            let (minorant, mean) = (entry(&grid, &minorants, block), entry(&grid, &means, block));
            assert!(
                (smallest * (1.0 - 1.2e-6)..=smallest).contains(&minorant),
                "{name}, block {block:?}: {minorant} for {smallest}"
            );
            let exact = sum / count;
            assert!(
                (mean - exact).abs() <= 1e-7 * exact,
                "{name}, block {block:?}: {mean} for {exact}"
            );
            inner[0] += minorant;
            inner[1] += mean;
        });
        // The rim is empty.
        for (table, inner) in [minorants, means].iter().zip(inner) {
            let all: f64 = table.iter().map(|&c| f64::from(c)).sum();
            assert!(
                (all - inner).abs() <= 1e-9 * inner,
                "{name}: {all} with the rim, {inner} without"
            );
        }
    }
}

/// One tap and interpolated, at corners, on faces and inside, in grids that no zero makes easy.
#[test]
fn no_look_up_falls_below_its_minorant() {
    let mut rng = SplitMix::new(630);
    let (mut lookups, mut positive) = (0, 0);
    for (i, dims) in SIZES.into_iter().enumerate() {
        // A pedestal under noise, and almost nothing but a pedestal, where rounding decides.
        for noise in [1.0, 1e-7, 0.0] {
            let mut values = SplitMix::new(631 + i as u64);
            let grid = TestGrid::new(dims, |_| 0.7 + (noise * values.uniform()) as f32);
            let [minorants, means] = controls(&grid);
            let bounds = grid
                .bounds()
                .with_controls(&minorants, &means)
                .expect("proved");
            each_width!(R, S => {
                let all = everyone::<R>();
                let mut stream = <S as KeyedStream<R>>::idle();
                for scale in [1.0, 0.3] {
                    let layout = GridLayout::<R>::of(&bounds.bounds(), scale);
                    for _ in 0..300 {
                        let place = dims.map(|n| {
                            let p = f64::from(n - 1) * rng.uniform();
                            if rng.bits().is_multiple_of(4) { p.round() } else { f64::from(p as f32) }
                        });
                        // The walk's own index: bounds in, controls out.
                        let under = |table: &[f32]| {
                            let mut walk = GridWalk::<R>::idle();
                            walk.begin(&layout, &ray(place, [0.0; 3]), table, all);
                            walk
                        };
                        let walk = under(&grid.majorants);
                        let minorant = under(bounds.minorants()).segment().majorant;
                        let mean = under(bounds.means()).segment().majorant;
                        for value in [
                            walk.trilinear(&grid.samples, R::zero()),
                            walk.sigma_t(&grid.samples, R::zero(), &mut stream, all),
                        ] {
                            assert!(minorant.le(value).all(), "{value:?} below {minorant:?}");
                            lookups += 1;
                        }
                        assert!(minorant.le(mean).all() && mean.le(walk.segment().majorant).all());
                        positive += u32::from(R::zero().lt(minorant).all());
                    }
                }
            });
        }
    }
    assert!(
        lookups > 50_000 && positive > 25_000,
        "{lookups} look-ups, {positive} of use"
    );
}

#[test]
fn mistakes_are_named() {
    let grid = TestGrid::random([17, 10, 9], 632, 0.0);
    let [minorants, means] = controls(&grid);
    let bounds = grid.bounds();
    let inner: Vec<usize> = (0..means.len()).filter(|&i| means[i] > 0.0).collect();
    assert_eq!(inner.len(), 4, "two by two by one blocks");
    for (number, &index) in inner.iter().enumerate() {
        let block = [number as u32 % 2, number as u32 / 2, 0];
        // The smallest sample itself is no minorant of what is interpolated.
        let smallest = minorants[index] / (1.0 - 1.0 / 1_048_576.0);
        for wrong in [smallest, means[index], -1e-30, f32::NAN, f32::INFINITY] {
            let mut planted = minorants.clone();
            planted[index] = wrong;
            let error = bounds.with_controls(&planted, &means).err();
            assert!(
                matches!(error, Some(MajorantError::Minorant { .. })),
                "{wrong}: {error:?}"
            );
        }
        for wrong in [
            minorants[index].next_down(),
            grid.majorants[index].next_up(),
            f32::NAN,
        ] {
            let mut planted = means.clone();
            planted[index] = wrong;
            let error = bounds.with_controls(&minorants, &planted).err();
            assert_eq!(error, Some(MajorantError::Mean { block }), "{wrong}");
        }
        // Between its bounds any number controls.
        let mut other = means.clone();
        other[index] = grid.majorants[index];
        bounds
            .with_controls(&minorants, &other)
            .expect("a control, if no mean");
    }
    for index in (0..means.len()).filter(|i| !inner.contains(i)) {
        let planted = |table: &[f32]| {
            let mut planted = table.to_vec();
            planted[index] = 0.1;
            planted
        };
        let rim = Some(MajorantError::Rim { index });
        let (low, mean) = (planted(&minorants), planted(&means));
        assert_eq!(bounds.with_controls(&minorants, &mean).err(), rim);
        assert_eq!(bounds.with_controls(&low, &means).err(), rim);
    }
    let count = majorant_count(grid.dims).expect("small");
    for found in [0, count - 1, count + 1] {
        let wrong = vec![0.0; found];
        let length = MajorantError::Length {
            expected: count,
            found,
        };
        assert_eq!(bounds.with_controls(&wrong, &means).err(), Some(length));
        assert_eq!(bounds.with_controls(&minorants, &wrong).err(), Some(length));
        let (mut short, mut right) = (wrong, means.clone());
        let fill =
            |low: &mut [f32], mean: &mut [f32]| fill_controls(&grid.samples, grid.dims, low, mean);
        assert_eq!(fill(&mut short, &mut right), Err(length));
        assert_eq!(fill(&mut right, &mut short), Err(length));
    }
    let mut samples = grid.samples.clone();
    samples[33] = -1.0;
    let (mut low, mut mean) = (minorants.clone(), means.clone());
    let error = fill_controls(&samples, grid.dims, &mut low, &mut mean);
    let at = [33 % 17, 33 / 17, 0];
    assert_eq!(error, Err(MajorantError::Sample { at, value: -1.0 }));
}
