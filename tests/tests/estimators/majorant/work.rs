//! How much work a ray will be, known beforehand, and refused where it is too much.

use super::{blocks, bound};
use woodcock_core::majorant::{BLOCK, Segment, WORK_LIMIT, check_work, majorant_depth};
use woodcock_core::medium::{Homogeneous, IDENTITY, Linear, Medium, Overlap, Procedural, Within};
use woodcock_core::ray::{FAR, Ray};
use woodcock_core::real::Real;
use woodcock_core::stream::Stream;
use woodcock_packet::lanes::{LANES, Lanes};
use woodcock_tests::each_width;
use woodcock_tests::grids::TestGrid;
use woodcock_tests::widths::{everyone, no_one, ray, width};

fn fog(sigma_t: f32) -> Homogeneous {
    Homogeneous::new(sigma_t).expect("a valid extinction")
}

fn depth_of<R: Real>(medium: &impl Medium<R>, origin: [f64; 3], t_max: f32) -> f64 {
    let along: Ray<R> = ray(origin, [1.0, 0.0, 0.0]);
    let depth = majorant_depth(medium, &along, R::splat(t_max), everyone::<R>());
    f64::from(depth.lane(0))
}

#[test]
fn the_depth_is_that_of_the_bounds() {
    let grid = TestGrid::random([41, 18, 17], 161, 0.5);
    // Along x through the second row of blocks, from the middle of the first block to the middle of the last.
    let rows = blocks(grid.dims[0]);
    assert_eq!(rows, 5);
    let row = |i: usize| bound(&grid, [i, 1, 0]);
    let whole: f64 = (0..rows).map(row).sum::<f64>() * f64::from(BLOCK);
    let inner = whole - 4.0 * (row(0) + row(4));
    each_width!(R, S => {
        let _: Option<S> = None;
        let close = |found: f64, exact: f64| {
            assert!((found / exact - 1.0).abs() < 1e-6, "{}: {found} for {exact}", width::<R>());
        };
        close(depth_of::<R>(&fog(0.75), [0.0; 3], 6.0), 4.5);
        assert_eq!(depth_of::<R>(&fog(0.75), [0.0; 3], 0.0), 0.0);
        let medium = grid.medium(IDENTITY, 0.5);
        close(depth_of::<R>(&medium, [0.0, 9.5, 3.0], 40.0), 0.5 * whole);
        close(depth_of::<R>(&medium, [4.0, 9.5, 3.0], 32.0), 0.5 * inner);
        let sum = Overlap(fog(0.25), Within::domain(medium));
        close(depth_of::<R>(&sum, [-2.0, 9.5, 3.0], 50.0), 0.25 * 50.0 + 0.5 * whole);
        // A ramp's pieces are bounded by twice what they hold, or by one mean free path more.
        let ramp = Linear::new(0.0, [2.0, 0.0, 0.0]).expect("a finite ramp");
        let found = depth_of::<R>(&ramp, [0.0; 3], 5.0);
        assert!((25.0..=51.0).contains(&found), "{found}");
        let along: Ray<R> = ray([0.0; 3], [1.0, 0.0, 0.0]);
        let none = majorant_depth(&fog(1.0), &along, R::one(), no_one::<R>());
        assert_eq!(none.lane(0), 0.0);
        // However long the ray, it ends.
        assert_eq!(depth_of::<R>(&fog(0.0), [0.0; 3], f32::INFINITY), 0.0);
        let endless = depth_of::<R>(&fog(2.0), [0.0; 3], f32::INFINITY);
        assert_eq!(endless, 2.0 * f64::from(FAR));
    });
}

/// A bound of any value, by lane.
struct Bound([f32; LANES]);

impl Medium<Lanes> for Bound {
    type Walk = ();
    const ONE_SEGMENT: bool = true;
    const TIGHT: bool = false;
    fn idle(&self) {}
    fn begin(&self, (): &mut (), _: &Ray<Lanes>, _: <Lanes as Real>::Mask) {}
    fn segment(&self, (): &()) -> Segment<Lanes> {
        Segment {
            majorant: Lanes::new(self.0),
            t_exit: Lanes::splat(FAR),
        }
    }
    fn next_segment(&self, (): &mut (), _: <Lanes as Real>::Mask) {}
    fn sigma_t(
        &self,
        (): &(),
        _: Lanes,
        _: &mut impl Stream<Lanes>,
        _: <Lanes as Real>::Mask,
    ) -> Lanes {
        Lanes::zero()
    }
}

#[test]
fn too_much_work_is_refused_with_its_numbers() {
    let along: Ray<f32> = ray([0.0; 3], [1.0, 0.0, 0.0]);
    let loose = Procedural::new(|_| 1.0_f32, 1e9);
    let depth = 2.0_f32.powi(-10) * 1e9;
    assert_eq!(
        check_work(&loose, &along, 2.0_f32.powi(-10), WORK_LIMIT),
        Ok(depth)
    );
    assert_eq!(
        check_work(&loose, &along, 2.0_f32.powi(-10), depth),
        Ok(depth)
    );
    let error = check_work(&loose, &along, 1e3, WORK_LIMIT).expect_err("an astronomical ray");
    assert_eq!((error.expected, error.limit), (1e12, WORK_LIMIT));
    let text = error.to_string();
    assert!(text.contains("1e12") && text.contains("1e7"), "{text}");
    // A limit of one's own; rays without an end, or of no length that is a number.
    assert!(check_work(&loose, &along, 1e3, 2e12).is_ok());
    assert!(check_work(&loose, &along, 1e-3, 0.5e6).is_err());
    for endless in [f32::INFINITY, f32::NAN] {
        assert!(
            check_work(&loose, &along, endless, WORK_LIMIT).is_err(),
            "{endless}"
        );
    }
    let huge = Procedural::new(|_| 1.0_f32, f32::MAX);
    let error = check_work(&huge, &along, 1e9, WORK_LIMIT).expect_err("more than any number");
    assert_eq!(error.expected, f32::INFINITY);
}

/// One lane too many is too much for all, and a bound that is no number is not lost among the others.
#[test]
fn the_worst_lane_counts() {
    let along: Ray<Lanes> = ray([0.0; 3], [1.0, 0.0, 0.0]);
    let work = |bounds: [f32; LANES]| check_work(&Bound(bounds), &along, Lanes::one(), 100.0);
    let fine = work([1.0, 99.0, 0.0, 3.0, 100.0, 2.0, 0.5, 7.0]).expect("affordable lanes");
    assert_eq!((fine.lane(1), fine.lane(4)), (99.0, 100.0));
    let error = work([1.0, 99.0, 0.0, 300.0, 100.0, 200.0, 0.5, 7.0]).expect_err("two lanes");
    assert_eq!(error.expected, 300.0);
    for lane in [0, 3, 7] {
        let mut bounds = [5.0; LANES];
        bounds[lane] = f32::NAN;
        let error = work(bounds).expect_err("no number");
        assert!(
            error.expected.is_nan() && error.to_string().contains("NaN"),
            "{error}"
        );
    }
}
