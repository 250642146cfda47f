//! Line integrals: light collected on the way and at the end of a ray, with the mean of the tables, in every lane.
//!
//! ```text
//! C = c_∂V T + ∫ c_V T dt
//! ```
//!
//! by both ways to score, against the reference table's emission numbers and against quadrature. What is exact is
//! compared exactly; the checks must reject every planted mistake.

use woodcock_core::line_integral::{collisions, tentative};
use woodcock_core::medium::{IDENTITY, Medium};
use woodcock_core::ray::Ray;
use woodcock_core::real::Real;
use woodcock_core::stream::{KeyedStream, PathStream, Stream};
use woodcock_tests::each_width;
use woodcock_tests::fixtures;
use woodcock_tests::grids::{TestGrid, chord};
use woodcock_tests::stats::{Sample, assert_agrees, samples, seed};
use woodcock_tests::widths::{everyone, ray, sample, width};

mod exact;
mod mutants;
mod variance;

/// Where a walk scores.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Score {
    Collisions,
    Tentative,
    /// At tentative points, with roulette below this weight.
    Roulette(f32),
}

const SCORES: [Score; 3] = [Score::Collisions, Score::Tentative, Score::Roulette(0.5)];

impl Score {
    /// One estimate.
    ///
    /// * `source`: c_V/σ_t. `sigma_t`: the extinction, as the volume term is their product.
    fn estimate<R: Real, M: Medium<R>>(
        self,
        medium: &M,
        (along, end): (&Ray<R>, R),
        walks: u32,
        (source, sigma_t): (&dyn Fn(R) -> R, &dyn Fn(R) -> R),
        boundary: f32,
        rng: &mut impl Stream<R>,
    ) -> R {
        let (light, all) = (R::splat(boundary), everyone::<R>());
        let survival = match self {
            Self::Collisions => {
                let source = |t, _| source(t);
                return collisions(medium, along, end, walks, source, light, rng, all);
            }
            Self::Tentative => 0.0,
            Self::Roulette(survival) => survival,
        };
        let volume = |t, _| source(t) * sigma_t(t);
        tentative(medium, along, end, walks, volume, light, survival, rng, all)
    }
}

/// The relative standard error that each mean must reach.
const RESOLUTION: f64 = 0.005;

/// Samples for a resolution, from the relative variance of a few.
fn enough(few: &Sample, resolution: f64) -> usize {
    let m = few.moments();
    let relative = m.variance() / (m.mean() * m.mean());
    samples((1.6 * relative / (resolution * resolution)) as usize).max(1 << 12)
}

/// A function of distance in `f64` as one of lanes.
fn per_distance<R: Real>(f: impl Fn(f64) -> f64) -> impl Fn(R) -> R {
    move |t| {
        let mut value = R::zero();
        for lane in 0..R::LANES {
            value.set_lane(lane, f(f64::from(t.lane(lane))) as f32);
        }
        value
    }
}

/// A field's light: source function 1 + x on the way, `boundary` at the end.
fn light<R: Real, S: KeyedStream<R>>(
    fixture: &fixtures::Fixture,
    score: Score,
    (walks, boundary): (u32, f32),
    (pixel, n): (u32, usize),
) -> Sample {
    let medium = fixture.medium::<R>(1.0);
    let along: Ray<R> = ray(fixture.ray.origin, fixture.ray.dir);
    let end = R::splat(fixture.ray.t_max as f32);
    let source = |t: R| R::one() + along.at(t).x;
    let sigma_t = per_distance::<R>(fixture.along());
    sample::<R, S>(seed(111), pixel, n, |rng| {
        let of = (&source as &dyn Fn(R) -> R, &sigma_t as &dyn Fn(R) -> R);
        score.estimate(&medium, (&along, end), walks, of, boundary, rng)
    })
}

fn fields(score: Score) {
    for (pixel, fixture) in (0..).zip(fixtures::all()) {
        for (i, walks) in [(0, 4), (1, [1, 16][pixel as usize % 2])] {
            // Every other comb ends in the dark.
            let boundary = if (pixel + i) % 2 == 0 { 0.0 } else { 0.75 };
            let truth = fixture.ray.emission + f64::from(boundary) * fixture.ray.transmittance;
            let comb = (walks, boundary);
            let pixel = 8 * pixel + i;
            let few = light::<f32, PathStream>(&fixture, score, comb, (1000 + pixel, 1 << 10));
            each_width!(R, S => {
                // Lanes repeat what f32 drew: one ray of a field will do, and one comb.
                let sharp = width::<R>() == "f32";
                if sharp || (pixel / 8 % 4 == 1 && walks == 4) {
                    let resolution = if sharp { RESOLUTION } else { 2.0 * RESOLUTION };
                    let n = enough(&few, resolution);
                    let name = format!("{} by {walks} walks, {score:?}, {}", fixture.name, width::<R>());
                    let found = light::<R, S>(&fixture, score, comb, (pixel, n));
                    assert_agrees(&name, &found, truth, resolution);
                }
            });
        }
    }
}

#[test]
fn fields_shine_as_the_table_says_at_collisions() {
    fields(Score::Collisions);
}

#[test]
fn fields_shine_as_the_table_says_at_tentative_points() {
    fields(Score::Tentative);
}

/// Walks across majorant blocks, empty ones among them.
#[test]
fn grids_shine_as_quadrature_says() {
    let grids = [
        ("cloud", TestGrid::cloud([33, 26, 25], 112)),
        ("random", TestGrid::random([18, 17, 19], 113, 0.4)),
    ];
    for (kind, grid) in &grids {
        let middle = grid.dims.map(|n| 0.5 * f64::from(n - 1));
        for (pixel, direction) in (0..).zip([[1.0, 1.0, -1.0], [0.3, 0.8, 0.2], [0.0, -1.0, 0.0]]) {
            let chord = chord(grid.dims, middle, direction);
            let once = grid.depth(chord.origin, chord.direction, chord.t_max, 1.0);
            let scale = (2.0 / once.total()) as f32;
            let depth = grid.depth(chord.origin, chord.direction, chord.t_max, f64::from(scale));
            let at = |t: f64| {
                let place = std::array::from_fn(|a| chord.origin[a] + t * chord.direction[a]);
                f64::from(scale) * grid.at(place)
            };
            let source = |t: f64| 1.0 + 0.25 * (t / chord.t_max);
            let boundary = 0.5;
            let truth = depth.attenuated(|t| at(t) * source(t)) + boundary * (-depth.total()).exp();
            let medium = grid.medium(IDENTITY, scale);
            for score in SCORES {
                let run = |n: usize, pixel: u32| {
                    let along: Ray<f32> = ray(chord.origin, chord.direction);
                    let of = (per_distance::<f32>(source), per_distance::<f32>(at));
                    sample::<f32, PathStream>(seed(114), pixel, n, |rng| {
                        score.estimate(
                            &medium,
                            (&along, chord.t_max as f32),
                            4,
                            (&of.0, &of.1),
                            boundary as f32,
                            rng,
                        )
                    })
                };
                let n = enough(&run(1 << 10, 1000 + pixel), RESOLUTION);
                let name = format!("{kind} along {direction:?}, {score:?}");
                assert_agrees(&name, &run(n, pixel), truth, RESOLUTION);
            }
        }
    }
}

/// Roulette keeps the mean, on rays that most walks would only cross with little weight.
#[test]
fn roulette_keeps_the_mean() {
    for fixture in [
        &fixtures::of_field("cone")[0],
        &fixtures::of_field("exponential_z")[2],
    ] {
        for (pixel, survival) in (0..).zip([0.1, 1.0]) {
            let score = Score::Roulette(survival);
            let truth = fixture.ray.emission + 0.75 * fixture.ray.transmittance;
            let few = light::<f32, PathStream>(fixture, score, (4, 0.75), (1000, 1 << 10));
            let n = enough(&few, 0.003);
            let found = light::<f32, PathStream>(fixture, score, (4, 0.75), (pixel, n));
            assert_agrees(&format!("{} {score:?}", fixture.name), &found, truth, 0.003);
        }
    }
}
