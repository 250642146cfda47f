//! Procedural media in cells: the proof holds where look-ups go, and fails for bounds that do not bound.

use super::{AXES, Question, Row};
use woodcock_core::enclosure::Enclosure;
use woodcock_core::majorant::{Cells, Segment};
use woodcock_core::medium::{Medium, ProceduralGrid};
use woodcock_core::ray::Ray;
use woodcock_core::real::{Mask, Real};
use woodcock_core::stream::KeyedStream;
use woodcock_core::transmittance;
use woodcock_core::vec3::Vec3;
use woodcock_tests::depth::Depth;
use woodcock_tests::each_width;
use woodcock_tests::grids::{Chord, unit};
use woodcock_tests::stats::independent::SplitMix;
use woodcock_tests::stats::{assert_agrees, judge, must_kill, samples, seed};
use woodcock_tests::widths::{everyone, ray, sample, width};

mod proof;

/// Extinction written three times: over lanes, over enclosures, and in `f64` for the oracle.
trait Formula {
    const NAME: &'static str;
    fn sigma_t<R: Real>(p: Vec3<R>) -> R;
    fn extension(p: [Enclosure; 3]) -> Enclosure;
    fn oracle(p: [f64; 3]) -> f64;
}

fn squared<R: Real>(p: Vec3<R>, centre: [f32; 3]) -> R {
    let d = p - Vec3::splat(centre);
    d.dot(d)
}

fn squared_in([x, y, z]: [Enclosure; 3], [a, b, c]: [f32; 3]) -> Enclosure {
    (x - a).square() + (y - b).square() + (z - c).square()
}

fn squared_exact(p: [f64; 3], centre: [f32; 3]) -> f64 {
    (0..3).map(|a| (p[a] - f64::from(centre[a])).powi(2)).sum()
}

/// Two Gaussian puffs, neither centred on a cell.
struct Puffs;
impl Puffs {
    const BLOBS: [(f32, [f32; 3], f32); 2] = [
        (2.5, [-1.1, 11.3, 0.4], -1.7),
        (0.8, [0.9, 12.8, 1.9], -0.3),
    ];
}
impl Formula for Puffs {
    const NAME: &'static str = "puffs";
    fn sigma_t<R: Real>(p: Vec3<R>) -> R {
        Self::BLOBS.iter().fold(R::zero(), |sum, &(peak, at, k)| {
            sum + (squared(p, at) * R::splat(k)).exp() * R::splat(peak)
        })
    }
    fn extension(p: [Enclosure; 3]) -> Enclosure {
        Self::BLOBS
            .iter()
            .fold(Enclosure::point(0.0), |sum, &(peak, at, k)| {
                sum + (squared_in(p, at) * k).exp() * peak
            })
    }
    fn oracle(p: [f64; 3]) -> f64 {
        let blob = |&(peak, at, k): &(f32, [f32; 3], f32)| {
            f64::from(peak) * (f64::from(k) * squared_exact(p, at)).exp()
        };
        Self::BLOBS.iter().map(blob).sum()
    }
}

/// A hollow ball of foam that thins out with height: square roots, quotients, logarithms, magnitudes, a kink.
struct Foam;
impl Foam {
    const CENTRE: [f32; 3] = [-0.7, 12.0, 0.9];
}
impl Formula for Foam {
    const NAME: &'static str = "foam";
    fn sigma_t<R: Real>(p: Vec3<R>) -> R {
        let one = R::one();
        let radius = squared(p, Self::CENTRE).sqrt();
        let wall = (R::splat(0.8) - (radius - R::splat(1.5)).abs()).max(R::zero());
        let height = (p.z * p.z + one).ln() + one;
        wall * R::splat(3.0) / height
    }
    fn extension(p: [Enclosure; 3]) -> Enclosure {
        let number = Enclosure::point;
        let radius = squared_in(p, Self::CENTRE).sqrt();
        let wall = (number(0.8) - (radius - 1.5).abs()).max(number(0.0));
        let height = (p[2].square() + 1.0).ln() + 1.0;
        wall * 3.0 / height
    }
    fn oracle(p: [f64; 3]) -> f64 {
        let wall = 0.8 - (squared_exact(p, Self::CENTRE).sqrt() - 1.5).abs();
        wall.max(0.0) * 3.0 / ((p[2] * p[2]).ln_1p() + 1.0)
    }
}

const LOW: [f32; 3] = [-3.7, 10.0, -1.3];
const HIGH: [f32; 3] = [1.6, 14.1, 4.4];

fn bounds(cells: &Cells, extension: impl Fn([Enclosure; 3]) -> Enclosure) -> Vec<f32> {
    let mut majorants = vec![f32::NAN; cells.majorant_count()];
    cells
        .fill_majorants(extension, &mut majorants)
        .expect("these formulas are bounded");
    majorants
}

fn cut(counts: [u32; 3]) -> Cells {
    Cells::new(LOW, HIGH, counts).expect("a box of some extent")
}

/// From where a line through a point enters the box to where it leaves, drawn in a bit on either side.
fn chord(through: [f64; 3], direction: [f64; 3]) -> Chord {
    let direction = unit(direction).map(|d| f64::from(d as f32));
    let (mut t0, mut t1) = (f64::NEG_INFINITY, f64::INFINITY);
    for a in (0..3).filter(|&a| direction[a] != 0.0) {
        let to = |face: f32| (f64::from(face) - through[a]) / direction[a];
        let (near, far) = (to(LOW[a]), to(HIGH[a]));
        t0 = t0.max(near.min(far));
        t1 = t1.min(near.max(far));
    }
    let t0 = t0 + 2e-6;
    Chord {
        origin: std::array::from_fn(|a| f64::from((through[a] + t0 * direction[a]) as f32)),
        direction,
        t_max: f64::from((t1 - t0 - 2e-6) as f32),
    }
}

pub(super) struct InCells;
impl Row for InCells {
    fn put<R: Real>(question: &mut impl Question<R>) {
        fn ask<R: Real, F: Formula>(question: &mut impl Question<R>, counts: [u32; 3]) {
            let cells = cut(counts);
            let majorants = bounds(&cells, F::extension);
            let medium = ProceduralGrid::new(F::sigma_t::<R>, cells, F::extension, &majorants)
                .expect("computed bounds are proved");
            for direction in AXES {
                let name = format!("{} in {counts:?}", F::NAME);
                let chord = chord([-0.6, 11.9, 0.8], direction);
                question.ask(&name, &medium, &F::oracle, &chord);
            }
        }
        for counts in [[1, 1, 1], [5, 3, 4], [2, 17, 9]] {
            ask::<R, Puffs>(question, counts);
            ask::<R, Foam>(question, counts);
        }
    }
}

/// Look-ups above the bound of their segment, on random lines, at ends of segments and between.
fn violations<R: Real, S: KeyedStream<R>>(medium: &impl Medium<R>, lines: u32) -> (u64, u64) {
    let all = everyone::<R>();
    let mut rng = SplitMix::new(610);
    let mut stream = S::idle();
    let (mut above, mut lookups) = (0, 0);
    for line in 0..lines {
        let through = std::array::from_fn(|a| {
            let share = if line % 3 == 0 {
                f64::from(rng.bits() as u32 % 9) / 8.0
            } else {
                rng.uniform()
            };
            f64::from(LOW[a]) + share.clamp(0.001, 0.999) * f64::from(HIGH[a] - LOW[a])
        });
        let direction = match line % 4 {
            0 => AXES[rng.bits() as usize % AXES.len()],
            _ => [rng.normal(), rng.normal(), rng.normal()],
        };
        let chord = chord(through, direction);
        let along: Ray<R> = ray(chord.origin, chord.direction);
        let mut walk = medium.idle();
        medium.begin(&mut walk, &along, all);
        let (mut from, end) = (R::zero(), R::splat(chord.t_max as f32));
        while from.lt(end).any() {
            let Segment { majorant, t_exit } = medium.segment(&walk);
            let to = t_exit.min(end).max(from);
            for share in [0.0, 1e-6, 0.3, 0.5, 0.999, 1.0] {
                let t = from + (to - from) * R::splat(share);
                let sigma_t = medium.sigma_t(&walk, t, &mut stream, all);
                // In the rim, where only rounding leads, no tentative collision can fall.
                let inside = R::zero().lt(majorant) | R::splat(1e-5).lt(to - from);
                above += u64::from((majorant.lt(sigma_t) & inside).count());
                lookups += R::LANES as u64;
            }
            from = to;
            medium.next_segment(&mut walk, all);
        }
    }
    (above, lookups)
}

#[test]
fn no_look_up_exceeds_its_bound() {
    fn formula<F: Formula>() {
        for counts in [[1, 1, 1], [7, 5, 6], [31, 2, 64]] {
            let cells = cut(counts);
            let majorants = bounds(&cells, F::extension);
            each_width!(R, S => {
                let medium = ProceduralGrid::new(F::sigma_t::<R>, cells, F::extension, &majorants)
                    .expect("computed bounds are proved");
                let (above, lookups) = violations::<R, S>(&medium, 1000);
                assert!(above == 0 && lookups > 6000, "{} {counts:?} {}: {above} of {lookups}", F::NAME, width::<R>());
            });
        }
    }
    formula::<Puffs>();
    formula::<Foam>();
    // An extension of the middle of each cell is a lie that the proof cannot see; the walk does.
    let cells = cut([7, 5, 6]);
    let middle = |p: [Enclosure; 3]| {
        Puffs::extension(p.map(|e| Enclosure::point(0.5 * e.low() + 0.5 * e.high())))
    };
    let majorants = bounds(&cells, middle);
    each_width!(R, S => {
        let medium = ProceduralGrid::new(Puffs::sigma_t::<R>, cells, middle, &majorants).expect("a lie");
        let (above, lookups) = violations::<R, S>(&medium, 1000);
        assert!(above > lookups / 4, "{}: {above} of {lookups}", width::<R>());
    });
}

/// A finer grid bounds more tightly: the bounds are of use.
#[test]
fn bounds_approach_the_extinction() {
    fn excess<F: Formula>(n: u32) -> f64 {
        let cells = cut([n; 3]);
        let majorants = bounds(&cells, F::extension);
        let mut stream = woodcock_core::stream::PathStream::new(Default::default());
        let medium = ProceduralGrid::new(F::sigma_t::<f64>, cells, F::extension, &majorants)
            .expect("proved");
        let mut rng = SplitMix::new(611);
        let (mut bound, mut extinction) = (0.0, 0.0);
        for _ in 0..20_000 {
            let place = std::array::from_fn(|a| {
                f64::from(LOW[a]) + rng.uniform() * f64::from(HIGH[a] - LOW[a])
            });
            let mut walk = Medium::<f64>::idle(&medium);
            medium.begin(&mut walk, &ray(place, [0.0, 0.0, 1.0]), true);
            bound += medium.segment(&walk).majorant;
            extinction += medium.sigma_t(&walk, 0.0, &mut stream, true);
        }
        bound / extinction - 1.0
    }
    let mean = |n| (excess::<Puffs>(n), excess::<Foam>(n));
    let (coarse, fine) = (mean(8), mean(32));
    assert!(coarse.0 < 3.0 && coarse.1 < 5.0, "{coarse:?}");
    assert!(
        fine.0 < 0.3 * coarse.0 && fine.1 < 0.3 * coarse.1,
        "{fine:?} after {coarse:?}"
    );
}

#[test]
fn optical_depth_is_that_of_quadrature() {
    fn formula<F: Formula>() {
        let mut rng = SplitMix::new(612);
        let cells = cut([6, 5, 7]);
        let majorants = bounds(&cells, F::extension);
        for _ in 0..100 {
            let through = std::array::from_fn(|a| {
                f64::from(LOW[a]) + (0.1 + 0.8 * rng.uniform()) * f64::from(HIGH[a] - LOW[a])
            });
            let chord = chord(through, [rng.normal(), rng.normal(), rng.normal()]);
            let along = |t: f64| std::array::from_fn(|a| chord.origin[a] + t * chord.direction[a]);
            let exact = Depth::new(chord.t_max, 2000, &[], |t| F::oracle(along(t))).total();
            each_width!(R, S => {
                let all = everyone::<R>();
                let medium = ProceduralGrid::new(F::sigma_t::<R>, cells, F::extension, &majorants).expect("proved");
                let mut walk = medium.idle();
                medium.begin(&mut walk, &ray(chord.origin, chord.direction), all);
                let (mut from, mut depth) = (0.0, 0.0);
                while from < chord.t_max {
                    let to = f64::from(medium.segment(&walk).t_exit.lane(0)).min(chord.t_max).max(from);
                    let look_up = |t: f64| {
                        f64::from(medium.sigma_t(&walk, R::splat(t as f32), &mut <S as KeyedStream<R>>::idle(), all).lane(0))
                    };
                    depth += Depth::new(to - from, 40, &[], |t| look_up(from + t)).total();
                    from = to;
                    medium.next_segment(&mut walk, all);
                }
                let name = format!("{} {}: {depth} for {exact}", F::NAME, width::<R>());
                assert!((depth - exact).abs() < 2e-5 * (1.0 + exact), "{name}");
            });
        }
    }
    formula::<Puffs>();
    formula::<Foam>();
}

/// Tracking through cells agrees with the depth; under bounds half as high it does not.
#[test]
fn tracking_is_unbiased() {
    let chord = chord([-0.9, 11.6, 0.6], [0.5, 0.6, 0.3]);
    let t_max = f64::from(0.3 * chord.t_max as f32);
    let along = |t: f64| std::array::from_fn(|a| chord.origin[a] + t * chord.direction[a]);
    let truth = (-Depth::new(t_max, 2000, &[], |t| Puffs::oracle(along(t))).total()).exp();
    let cells = cut([5, 6, 7]);
    let low = |p: [Enclosure; 3]| Puffs::extension(p) * 0.5;
    let majorants = bounds(&cells, Puffs::extension);
    let too_low = bounds(&cells, low);
    each_width!(R, S => {
        let medium = ProceduralGrid::new(Puffs::sigma_t::<R>, cells, Puffs::extension, &majorants).expect("proved");
        let mutant = ProceduralGrid::new(Puffs::sigma_t::<R>, cells, low, &too_low).expect("a lie");
        let along: Ray<R> = ray(chord.origin, chord.direction);
        let end = R::splat(t_max as f32);
        let n = samples(1 << 16);
        let all = everyone::<R>();
        let name = |what: &str| format!("{what} {}", width::<R>());
        let ratio = sample::<R, S>(seed(613), 0, n, |rng| transmittance::ratio::estimate(&medium, &along, end, rng, all));
        assert_agrees(&name("ratio"), &ratio, truth, 0.01);
        let delta = sample::<R, S>(seed(613), 1, n, |rng| transmittance::delta::estimate(&medium, &along, end, rng, all));
        assert_agrees(&name("delta"), &delta, truth, 0.02);
        let biased = sample::<R, S>(seed(613), 2, n, |rng| transmittance::delta::estimate(&mutant, &along, end, rng, all));
        must_kill(&name("bounds too low"), judge(biased.moments(), truth, 0.02));
    });
}
