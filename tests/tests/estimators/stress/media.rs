//! A medium of every kind in any unit of length, and everything that tracks, on one stretch of it.

use woodcock_core::enclosure::Enclosure;
use woodcock_core::free_flight::{decomposition, delta, weighted};
use woodcock_core::majorant::{self, majorant_depth};
use woodcock_core::medium::{
    Affine, Controlled, Exponential, Homogeneous, Interpolated, Linear, Overlap, Placed,
    Procedural, ProceduralGrid, Voxels, Within, fill_voxels, voxel_count,
};
use woodcock_core::ray::Ray;
use woodcock_core::real::Real;
use woodcock_core::stream::Stream;
use woodcock_core::transmittance::power_series::{Depth, Distance};
use woodcock_core::transmittance::residual_ratio::{Mean, Minimum};
use woodcock_core::transmittance::{self as t, comb, power_series, ratio, residual_ratio};
use woodcock_core::vec3::Vec3;
use woodcock_tests::grids::TestGrid;
use woodcock_tests::widths::everyone;

/// What came of one call, and what it may be.
#[derive(Clone, Copy, Debug)]
pub(super) struct Outcome<R> {
    pub(super) name: &'static str,
    pub(super) value: R,
    pub(super) is: Is,
}

/// What a number means.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Is {
    /// Infinite, or from zero to the end of the ray.
    Distance,
    /// From zero to one, and a rounding.
    Probability,
    /// Not negative.
    Weight,
    /// Any number, finite.
    Number,
    /// One.
    One,
    /// Not negative, infinite where it overflows.
    Depth,
}

impl<R: Real> Outcome<R> {
    /// Nothing is NaN, and all is in its range.
    #[track_caller]
    pub(super) fn check(&self, name: &str, t_max: f32) {
        for lane in 0..R::LANES {
            let value = self.value.lane(lane);
            let fine = match self.is {
                Is::Distance => value == f32::INFINITY || (0.0..=t_max).contains(&value),
                Is::Probability => (0.0..=1.000_001).contains(&value),
                Is::Weight => value >= 0.0 && value.is_finite(),
                Is::Number => value.is_finite(),
                Is::One => value == 1.0,
                Is::Depth => value >= 0.0,
            };
            assert!(
                fine,
                "{name}, {} gives {value:e}, not {:?}",
                self.name, self.is
            );
        }
    }
}

/// Everything that tracks, each with the same stream.
pub(super) fn outcomes<R: Real, S: Stream<R> + Clone, M: Controlled<R>>(
    medium: &M,
    ray: &Ray<R>,
    t_max: f32,
    stream: &S,
) -> [Outcome<R>; 12] {
    let (all, end) = (everyone::<R>(), R::splat(t_max));
    let rng = || stream.clone();
    let is = |name, value, is| Outcome { name, value, is };
    let weighted = weighted::sample(medium, ray, end, &mut rng(), all);
    [
        is(
            "delta",
            delta::sample(medium, ray, end, &mut rng(), all).or_infinite(),
            Is::Distance,
        ),
        is(
            "decomposition",
            decomposition::sample(medium, ray, end, &mut rng(), all).or_infinite(),
            Is::Distance,
        ),
        is("weighted", weighted.flight.or_infinite(), Is::Distance),
        is("weight of weighted", weighted.weight, Is::One),
        is(
            "T by delta",
            t::delta::estimate(medium, ray, end, &mut rng(), all),
            Is::Probability,
        ),
        is(
            "T by ratio",
            ratio::estimate(medium, ray, end, &mut rng(), all),
            Is::Probability,
        ),
        is(
            "T by residual ratio, mean",
            residual_ratio::estimate::<Mean, R, M>(medium, ray, end, &mut rng(), all),
            Is::Weight,
        ),
        is(
            "T by residual ratio, minimum",
            residual_ratio::estimate::<Minimum, R, M>(medium, ray, end, &mut rng(), all),
            Is::Probability,
        ),
        is(
            "T by a comb",
            comb::estimate(medium, ray, end, 3, &mut rng(), all),
            Is::Probability,
        ),
        is(
            "T by a power series in distance",
            power_series::estimate::<Distance, R, M>(medium, ray, end, &mut rng(), all),
            Is::Number,
        ),
        is(
            "T by a power series in depth",
            power_series::estimate::<Depth, R, M>(medium, ray, end, &mut rng(), all),
            Is::Number,
        ),
        is(
            "majorant depth",
            majorant_depth(medium, ray, end, all),
            Is::Depth,
        ),
    ]
}

/// What is done with every medium.
pub(super) trait Visit<R: Real> {
    fn visit<M: Controlled<R>>(&mut self, name: &'static str, medium: &M, ray: &Ray<R>, t_max: f32);
}

/// Borrowed tables of the media: made once.
#[derive(Clone, Debug)]
pub(super) struct Tables {
    grid: TestGrid,
    voxels: Vec<f32>,
}

impl Tables {
    pub(super) fn new() -> Self {
        let dims = [3, 2, 2];
        let values: Vec<f32> = (0..12).map(|i| f32::from(i as u8 % 5) * 0.25).collect();
        let mut voxels = vec![0.0; voxel_count(dims).expect("few cells")];
        fill_voxels(&values, dims, &mut voxels).expect("the table fits");
        let grid = TestGrid::random([9, 10, 11], 5, 0.4);
        Self { grid, voxels }
    }
}

fn scaling(by: f32) -> Affine {
    [
        [by, 0.0, 0.0, 0.0],
        [0.0, by, 0.0, 0.0],
        [0.0, 0.0, by, 0.0],
    ]
}

/// Media of every kind, of about the given depth in a `unit` of length, with rays that stay in their domains.
///
/// All lengths are multiples of the unit by numbers that do not depend on it, and extinctions of its inverse: units
/// that differ by a power of two differ in exponents only.
pub(super) fn each<R: Real>(tables: &Tables, unit: f32, depth: f32, to: &mut impl Visit<R>) {
    let sigma = depth / unit;
    let gradient = sigma / unit;
    let t_max = 0.75 * unit;
    let from = [0.125, 0.25, 0.1875].map(|x| x * unit);
    let oblique = Ray::<R> {
        origin: Vec3::splat(from),
        direction: Vec3::splat([0.6, 0.48, 0.64]),
    };
    let fog = Homogeneous::new(sigma).expect("a valid extinction");
    to.visit("fog", &fog, &oblique, t_max);
    let even = Procedural::new(move |_: Vec3<R>| R::splat(0.5 * sigma), sigma)
        .with_control(0.25 * sigma, 0.5 * sigma);
    to.visit("an even formula", &even, &oblique, t_max);
    if gradient.is_normal() && (16.0 * gradient).is_finite() {
        let rising = move |p: Vec3<R>| p.x * R::splat(gradient);
        to.visit(
            "a formula",
            &Procedural::new(rising, sigma),
            &oblique,
            t_max,
        );
        let steep = [0.5, 0.25, 0.125].map(|b| b * gradient);
        let ramps = [
            ("a rising ramp", Linear::new(0.125 * sigma, steep)),
            (
                "a falling ramp",
                Linear::new(0.5 * sigma, steep.map(|b| -b)),
            ),
            (
                "a ramp from below",
                Linear::new(-0.375 * sigma, steep.map(|b| 2.0 * b)),
            ),
        ];
        for (name, ramp) in ramps {
            to.visit(name, &ramp.expect("finite"), &oblique, t_max);
        }
        let cells = majorant::Cells::new([0.0; 3], [unit; 3], [2, 2, 2]).expect("a box");
        let extension = |[x, _, _]: [Enclosure; 3]| x * gradient;
        let mut bounds = vec![0.0; cells.majorant_count()];
        cells
            .fill_majorants(extension, &mut bounds)
            .expect("finite bounds");
        let proved = ProceduralGrid::new(rising, cells, extension, &bounds).expect("proved");
        to.visit("a proved formula", &proved, &oblique, t_max);
        let ramp = Linear::new(0.125 * sigma, steep).expect("finite");
        to.visit("fog and a ramp", &Overlap(fog, ramp), &oblique, t_max);
    }
    let falloff = [1.0, 0.5, 0.25].map(|k| k / unit);
    for (name, falloff) in [
        ("thinning air", falloff),
        ("thickening air", falloff.map(|k| -k)),
    ] {
        let air = Exponential::new(sigma, falloff).expect("finite");
        to.visit(name, &air, &oblique, t_max);
    }
    let grid = tables.grid.medium(scaling(8.0 / unit), sigma);
    to.visit("a grid", &grid, &oblique, t_max);
    to.visit("a grid in full", &Interpolated(grid), &oblique, t_max);
    let voxels =
        Voxels::new(&tables.voxels, [3, 2, 2], scaling(2.0 / unit), sigma).expect("voxels");
    to.visit("voxels", &voxels, &oblique, t_max);
    let placed = Placed::new(voxels, scaling(0.75)).expect("finite");
    to.visit("voxels, stretched", &placed, &oblique, t_max);
    let [low, high] = [0.25, 0.5].map(|x| [x * unit; 3]);
    let within = Within::aligned(even, low, high).expect("a box");
    to.visit("a formula in a box", &within, &oblique, t_max);
}
