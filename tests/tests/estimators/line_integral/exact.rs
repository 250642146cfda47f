//! Where there is nothing to estimate: vacuum, tight bounds, lanes that take no part.

use super::{SCORES, Score};
use woodcock_core::line_integral::{collisions, tentative};
use woodcock_core::medium::{Homogeneous, Medium, Procedural};
use woodcock_core::ray::Ray;
use woodcock_core::real::{Mask, Real};
use woodcock_core::stream::{Key, KeyedStream, PathStream, Stream};
use woodcock_packet::bits::LaneStream;
use woodcock_packet::lanes::{LANES, Lanes};
use woodcock_tests::each_width;
use woodcock_tests::stats::{Sample, assert_agrees, judge, must_kill, seed};
use woodcock_tests::voxels::TestVoxels;
use woodcock_tests::widths::{everyone, no_one, per_lane, ray, sample, width};

/// Estimates with a source function of `source` and light of `boundary` at the end.
fn constant<R: Real, S: KeyedStream<R>, M: Medium<R>>(
    medium: &M,
    sigma_t: f32,
    t_max: f32,
    score: Score,
    (walks, source, boundary): (u32, f32, f32),
) -> Sample {
    let along: Ray<R> = ray([0.0, 0.5, 0.5], [1.0, 0.0, 0.0]);
    sample::<R, S>(seed(121), walks, 2048, |rng| {
        let of = (&|_| R::splat(source) as R, &|_| R::splat(sigma_t) as R);
        score.estimate(
            medium,
            (&along, R::splat(t_max)),
            walks,
            (&of.0, &of.1),
            boundary,
            rng,
        )
    })
}

#[track_caller]
fn assert_all(name: &str, found: &Sample, exact: f64, allowed: f64) {
    let (least, most) = (found.moments().min(), found.moments().max());
    let off = (least / exact - 1.0).abs().max((most / exact - 1.0).abs());
    assert!(
        off <= allowed,
        "{name}: {least:e} to {most:e} for {exact:e}, off by {off:e}"
    );
}

/// Under a tight bound the first tentative point is the collision: a constant source leaves nothing to chance, from
/// depths below the rounding of one to opaque fog.
#[test]
fn a_constant_source_under_a_tight_bound_has_no_variance() {
    for exponent in -40..6 {
        let sigma_t = 1.25 * 2.0_f32.powi(exponent);
        let fog = Homogeneous::new(sigma_t).expect("a valid extinction");
        let depth = 0.8 * f64::from(sigma_t);
        let (opacity, passed) = (-(-depth).exp_m1(), (-depth).exp());
        each_width!(R, S => {
            for score in SCORES {
                for (walks, source, boundary) in [(1, 1.0, 0.0), (5, 2.0, 0.0), (16, 0.5, 3.0)] {
                    let found = constant::<R, S, _>(&fog, sigma_t, 0.8, score, (walks, source, boundary));
                    let exact = f64::from(source) * opacity + f64::from(boundary) * passed;
                    let name = format!("depth {depth:e}, {walks} walks, {score:?}, {}", width::<R>());
                    assert_all(&name, &found, exact, 1e-6);
                }
            }
        });
    }
}

#[test]
fn vacuum_shows_what_is_behind_it() {
    let vacuum = Homogeneous::new(0.0).expect("vacuum is a medium");
    let unknown = |_: f64, _: f64, _: f64| 0.0;
    each_width!(R, S => {
        for score in SCORES {
            for t_max in [0.0, 1.0, 1e30, f32::INFINITY] {
                let found = constant::<R, S, _>(&vacuum, 0.0, t_max, score, (4, 1.0, 0.375));
                assert_all("vacuum", &found, 0.375, 0.0);
            }
            // Vacuum that its bound does not know of.
            let unknown = Procedural::new(per_lane::<R>(unknown), 20.0);
            let found = constant::<R, S, _>(&unknown, 0.0, 1.0, score, (4, 1.0, 0.375));
            assert_all("unknown vacuum", &found, 0.375, 3e-7);
        }
    });
}

/// Tight bounds cell by cell: a source that differs between cells, and a comb that has to find them.
#[test]
fn light_of_cells_is_that_of_the_sum() {
    let values = [0.5_f32, 0.0, 3.0, 1.5, 0.0, 0.25];
    let cells = TestVoxels::new([6, 1, 1], |[x, _, _]| values[x as usize]);
    let medium = cells.medium(woodcock_core::medium::IDENTITY, 0.5);
    let glow = |t: f64| 1.0 + (t.floor() - 2.0).abs();
    let (mut exact, mut passed) = (0.0, 1.0);
    for (i, value) in (0..).zip(values) {
        let through = (-0.5 * f64::from(value)).exp();
        exact += passed * (1.0 - through) * glow(f64::from(i));
        passed *= through;
    }
    let exact = exact + 0.25 * passed;
    for walks in [1, 16] {
        let along: Ray<f32> = ray([0.0, 0.5, 0.5], [1.0, 0.0, 0.0]);
        let found = sample::<f32, PathStream>(seed(122), walks, 1 << 16, |rng| {
            let source = super::per_distance::<f32>(glow);
            collisions(
                &medium,
                &along,
                6.0,
                walks,
                |t, _| source(t),
                0.25,
                rng,
                true,
            )
        });
        assert_agrees(&format!("{walks} walks"), &found, exact, 0.003);
    }
}

/// Light from where nothing absorbs is found at tentative points, and only there.
#[test]
fn light_of_what_does_not_absorb_is_found_at_tentative_points() {
    let sigma_t = |t: f64| if t < 0.5 { 1.0 } else { 0.0 };
    let medium = Procedural::new(per_lane::<f32>(|x, _, _| sigma_t(x)), 2.0);
    let along: Ray<f32> = ray([0.0; 3], [1.0, 0.0, 0.0]);
    // j = 1 everywhere: ∫ T dt, the first half of it where σ_t = 1.
    let truth = (1.0 - (-0.5_f64).exp()) + 0.5 * (-0.5_f64).exp();
    let run = |scored: &dyn Fn(&mut PathStream) -> f32| {
        sample::<f32, PathStream>(seed(123), 0, 1 << 17, scored)
    };
    let found = run(&|rng| tentative(&medium, &along, 1.0, 4, |_, _| 1.0, 0.0, 0.0, rng, true));
    assert_agrees("tentative points", &found, truth, 0.003);
    let source = super::per_distance::<f32>(|t| 1.0 / sigma_t(t).max(1e-6));
    let lost = run(&|rng| collisions(&medium, &along, 1.0, 4, |t, _| source(t), 0.0, rng, true));
    must_kill("collisions", judge(lost.moments(), truth, 0.003));
}

/// Lanes without a ray give zero and draw nothing; the others do not notice.
#[test]
fn inactive_lanes_stay_out_of_it() {
    let field = |x: f64, _: f64, _: f64| 1.0 + 2.0 * x;
    let (one, eight) = (
        Procedural::new(per_lane::<f32>(field), 4.0),
        Procedural::new(per_lane::<Lanes>(field), 4.0),
    );
    let key = |lane: usize| Key {
        sample: lane as u32,
        ..Key::default()
    };
    let mut compared = 0;
    for bits in [0_u32, 0b1, 0b1010_0110, 0xff] {
        let mut active = no_one::<Lanes>();
        for lane in (0..LANES).filter(|lane| bits >> lane & 1 == 1) {
            let mut spot = Lanes::zero();
            spot.set_lane(lane, 1.0);
            active = active | spot.eq(Lanes::one());
        }
        for score in [Score::Collisions, Score::Roulette(0.5)] {
            let mut rng = LaneStream::default();
            (0..LANES).for_each(|lane| KeyedStream::<Lanes>::set_key(&mut rng, lane, key(lane)));
            let fresh = rng.clone();
            let found = one_of::<Lanes, _>(score, &eight, &mut rng, active);
            for lane in 0..LANES {
                let in_it = active.lane(lane);
                let mut alone = PathStream::new(key(lane));
                let value = one_of::<f32, _>(score, &one, &mut alone, in_it);
                assert_eq!(
                    found.lane(lane).to_bits(),
                    value.to_bits(),
                    "lane {lane} of {bits:b}"
                );
                assert!(in_it || value == 0.0);
                let (mut next, mut first) = (rng.clone(), fresh.clone());
                let all = everyone::<Lanes>();
                let same = next.uniform(all).lane(lane) == first.uniform(all).lane(lane);
                assert_eq!(same, !in_it, "lane {lane} of {bits:b}");
                compared += 1;
            }
        }
    }
    assert_eq!(compared, 64);
}

fn one_of<R: Real, M: Medium<R>>(
    score: Score,
    medium: &M,
    rng: &mut impl Stream<R>,
    active: R::Mask,
) -> R {
    let along: Ray<R> = ray([0.0; 3], [1.0, 0.0, 0.0]);
    let light = |t: R, _| R::one() + t;
    let half = R::splat(0.5);
    match score {
        Score::Roulette(survival) => tentative(
            medium,
            &along,
            R::one(),
            5,
            light,
            half,
            survival,
            rng,
            active,
        ),
        _ => collisions(medium, &along, R::one(), 5, light, half, rng, active),
    }
}
