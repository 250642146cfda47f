//! Do intervals from the film's mean and variance cover the truth as often as they say, and does `--target-error` keep its promise?
//!
//! A thousand small pictures with different seeds, each of two blocks of 8 × 8 pixels: thin fog in the sun, where light is rare, and
//! haze. The interval is that of a block's mean: 1.96 standard errors about it. The truth is the mean of as many pictures of
//! other seeds whose counts of samples nobody chose. Coverage is judged by the binomial law at [`ALPHA`](woodcock_tests::stats::ALPHA).
//!
//! The mutants: to stop when the samples themselves look good; and to take samples for independent that are not.

use rayon::prelude::*;
use woodcock_core::path::PathSample;
use woodcock_host::drive::{Silent, Watch};
use woodcock_host::film::{Film, Landing, Place, Window};
use woodcock_host::pilot::{self, Target};
use woodcock_host::render::{Plan, render_allotted, render_pass};
use woodcock_tests::pictures::{
    Studio, ball, grey, homogeneous, orthographic, scene, sky, stage, sun,
};
use woodcock_tests::stats::{Z_CRITICAL, samples, seed};

const RENDERS: usize = 1024;
const ERROR: f64 = 0.3;
const NOMINAL: f64 = 0.95;
/// The two-sided normal quantile of it.
const DEVIATES: f64 = 1.959_964;

/// Two balls side by side, one for each block.
fn studio(replicate: u32) -> Studio {
    let camera = orthographic([0.0, 0.0, -5.0], [0.0, 0.0, 1.0], 1.0);
    let world = sky(0.05)
        + &sun([0.0, 1.0, -1.0], [2.0; 3])
        + &homogeneous("thin", &grey(0.06, 0.9, 0.0))
        + &homogeneous("haze", &grey(0.8, 0.9, 0.3))
        + "AttributeBegin\nTranslate -1 0 0\n"
        + &ball("thin", "", [0.0; 3], 0.95)
        + "AttributeEnd\nAttributeBegin\nTranslate 1 0 0\n"
        + &ball("haze", "", [0.0; 3], 0.95)
        + "AttributeEnd\n";
    let wide = camera.replace("[ -1 1 -1 1 ]", "[ -2 2 -1 1 ]");
    let mut studio = stage(&scene(&wide, [16, 8], &world));
    studio.plan.replicate = replicate;
    studio
}

/// Mean and variance of a block's mean of green, and the mean over its pixels of the error that a target is about, squared.
#[derive(Clone, Copy, Debug, Default)]
struct Block {
    mean: f64,
    variance: f64,
}

fn blocks(film: &Film) -> [Block; 2] {
    let mut blocks = [Block::default(); 2];
    for (x, _, pixel) in film.pixels() {
        let block = &mut blocks[usize::from(x >= 8)];
        block.mean += pixel.mean()[1] / 64.0;
        let variance = pixel.variance_of_mean().map_or(f64::NAN, |v| v[1]);
        block.variance += variance / (64.0 * 64.0);
    }
    blocks
}

fn seeded(studio: &Studio, number: usize, family: u64) -> Plan {
    Plan {
        seed: seed((family << 32) + number as u64),
        ..studio.plan
    }
}

/// A picture of a fixed number of samples.
fn fixed(studio: &Studio, plan: &Plan, n: u32) -> Film {
    let mut film = plan.film(&studio.world);
    render_pass(&studio.world, plan, &mut film, 0..n, &Silent);
    film
}

const STILL: Watch<'static> = Watch {
    clock: &|| std::time::Duration::ZERO,
    interrupted: &|| false,
    progress: &Silent,
};

/// A picture as `--target-error` makes it, and the counts of its two blocks.
fn adaptive(studio: &Studio, plan: &Plan, error: f64) -> (Film, [u32; 2]) {
    let target = Target {
        error,
        most: None,
        uniform: false,
        time: None,
    };
    let pilot_plan = Plan {
        seed: pilot::seed(plan.seed),
        ..*plan
    };
    let world = &studio.world;
    let mut film = plan.film(world);
    let decision = pilot::run(&mut film, &target, STILL, |film, samples| {
        render_pass(world, &pilot_plan, film, samples, &Silent);
        Ok::<_, std::convert::Infallible>(())
    });
    let decision = decision.unwrap_or_else(|never| match never {});
    assert!(decision.enough);
    let allotment = &decision.allotment;
    let mut film = plan.film(world);
    let all = 0..allotment.largest();
    render_allotted(world, plan, &mut film, all, Some(allotment), &Silent);
    (film, [0, 8].map(|x| allotment.samples(x, 0)))
}

/// The planted mistake: samples until they say themselves that the error is reached.
fn until_it_looks_good(studio: &Studio, plan: &Plan, error: f64) -> Film {
    let world = &studio.world;
    let mut film = plan.film(world);
    let step = plan.replicate.max(2);
    for pass in 0.. {
        render_pass(
            world,
            plan,
            &mut film,
            pass * step..(pass + 1) * step,
            &Silent,
        );
        if pass > 0 && film.relative_error().is_some_and(|e| e <= error) {
            break;
        }
    }
    film
}

/// In how many of the pictures the interval of a block covers the truth, and of how many.
fn coverage(truth: [f64; 2], pictures: &[[Block; 2]]) -> (u32, u32) {
    let (mut covered, mut all) = (0, 0);
    for picture in pictures {
        for (block, truth) in picture.iter().zip(truth) {
            all += 1;
            covered += u32::from((block.mean - truth).abs() <= DEVIATES * block.variance.sqrt());
        }
    }
    (covered, all)
}

/// The normal deviate of a count under the nominal coverage.
fn deviate((covered, all): (u32, u32)) -> f64 {
    let all = f64::from(all);
    (f64::from(covered) - NOMINAL * all) / (NOMINAL * (1.0 - NOMINAL) * all).sqrt()
}

#[test]
fn intervals_cover_as_often_as_they_say_and_targets_are_kept() {
    let renders = samples(RENDERS);
    let reference = studio(1);
    // Four times the samples of any picture below, so that the truth's own error is 1/2000 of theirs, squared.
    let long: Vec<_> = (0..renders)
        .into_par_iter()
        .map(|i| fixed(&reference, &seeded(&reference, i, 9), 256))
        .map(|film| {
            let window = film.window();
            let mut pixels = vec![[0.0; 6]; window.pixels() as usize];
            for (x, y, pixel) in film.pixels() {
                let variance = pixel.variance_of_mean().expect("many samples");
                let (m, n) = (pixel.mean(), f64::from(pixel.samples()));
                pixels[window.index(x, y)] = [
                    m[0],
                    m[1],
                    m[2],
                    n * variance[0],
                    n * variance[1],
                    n * variance[2],
                ];
            }
            pixels
        })
        .reduce_with(|mut a, b| {
            for (sum, part) in a.iter_mut().flatten().zip(b.iter().flatten()) {
                *sum += part;
            }
            a
        })
        .expect("pictures")
        .iter()
        .map(|sums| sums.map(|s| s / renders as f64))
        .collect();
    let in_block = |at: usize| usize::from(at % 16 >= 8);
    let mean = long.iter().flat_map(|p| &p[..3]).sum::<f64>() / (3.0 * long.len() as f64);
    let mut truth = [0.0; 2];
    let mut needed = [0.0; 2];
    for (at, p) in long.iter().enumerate() {
        truth[in_block(at)] += p[1] / 64.0;
        for c in 0..3 {
            let relative = p[3 + c] / (p[c] * p[c] + 0.01 * mean * mean);
            needed[in_block(at)] += relative / (192.0 * ERROR * ERROR);
        }
    }
    assert!(
        needed[0] > 2.0 * needed[1],
        "the blocks are to differ: {needed:?}"
    );

    for replicate in [1, 16] {
        let studio = studio(replicate);
        let fixed: Vec<_> = (0..renders)
            .into_par_iter()
            .map(|i| blocks(&fixed(&studio, &seeded(&studio, i, 1), 128)))
            .collect();
        let z = deviate(coverage(truth, &fixed));
        assert!(
            z.abs() < Z_CRITICAL,
            "fixed, replicates of {replicate}: {z}"
        );

        let found: Vec<_> = (0..renders)
            .into_par_iter()
            .map(|i| {
                let (film, counts) = adaptive(&studio, &seeded(&studio, i, 2), ERROR);
                (blocks(&film), counts)
            })
            .collect();
        let pictures: Vec<_> = found.iter().map(|(blocks, _)| *blocks).collect();
        let z = deviate(coverage(truth, &pictures));
        assert!(
            z.abs() < Z_CRITICAL,
            "adaptive, replicates of {replicate}: {z}"
        );
        // The promise: a block's true error exceeds the target in one of twenty pictures at most.
        let broken = |block: usize| {
            let short = |counts: &[u32; 2]| f64::from(counts[block]) < needed[block];
            found.iter().filter(|(_, counts)| short(counts)).count() as u32
        };
        let all = renders as u32;
        for block in 0..2 {
            let kept = (all - broken(block), all);
            let mean = found.iter().map(|(_, c)| f64::from(c[block])).sum::<f64>() / f64::from(all);
            eprintln!(
                "replicates of {replicate}, block {block}: kept {kept:?}, {mean} of {}",
                needed[block]
            );
            assert!(deviate(kept) > -Z_CRITICAL, "block {block}: {kept:?}");
        }
    }

    // What stops on its own samples covers less often, and this test sees it.
    let studio = studio(1);
    let stopped: Vec<_> = (0..renders)
        .into_par_iter()
        .map(|i| blocks(&until_it_looks_good(&studio, &seeded(&studio, i, 3), 0.8)))
        .collect();
    let z = deviate(coverage(truth, &stopped));
    eprintln!("stopping on the same samples: z = {z}");
    assert!(z < -2.0 * Z_CRITICAL, "the planted mistake: {z}");
}

/// Uniform numbers in [0, 1) of a stream.
fn uniforms(stream: u32) -> impl Iterator<Item = f32> {
    let mut state = u64::from(stream).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    std::iter::repeat_with(move || {
        state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let word = (state ^ (state >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let word = (word ^ (word >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((word ^ (word >> 31)) >> 40) as f32 / 16_777_216.0
    })
}

/// A pixel of 64 samples x², with x of four equal strata in random order by fours: the mean of a replicate has 1/11 of the variance
/// that independent samples would give it.
fn stratified(stream: u32, replicate: u32) -> Film {
    let one = [1, 1];
    let mut film = Film::of_replicates(one, Window::full(one), replicate);
    let mut landing = Landing::default();
    for (index, u) in (0..64).zip(uniforms(stream)) {
        let x = ((index % 4) as f32 + u) / 4.0;
        let path = PathSample {
            radiance: [x * x; 3],
            alpha: 1.0,
        };
        let place = Place {
            x: 0,
            y: 0,
            sample: index,
            samples: 0..64,
        };
        landing.land(&mut film.tiles_mut()[0], place, path);
    }
    film
}

#[test]
fn intervals_of_dependent_samples_cover_by_replicates_only() {
    // Sixteen replicates: Student's t of 15 degrees, and means that are nearly normal.
    const QUANTILE: f64 = 2.131_450;
    let covered = |replicate: u32| {
        let truth = 1.0 / 3.0;
        let count = (0..4000)
            .filter(|&stream| {
                let film = stratified(stream, replicate);
                let (.., pixel) = film.pixels().next().expect("a pixel");
                let error = pixel.variance_of_mean().map_or(f64::NAN, |v| v[0].sqrt());
                (pixel.mean()[0] - truth).abs() <= QUANTILE * error
            })
            .count();
        deviate((count as u32, 4000))
    };
    let [right, mutant] = [4, 1].map(covered);
    assert!(right.abs() < Z_CRITICAL, "{right}");
    assert!(mutant > 2.0 * Z_CRITICAL, "the planted mistake: {mutant}");
}
