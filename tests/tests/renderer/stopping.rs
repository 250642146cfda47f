//! Do intervals from the film's mean and variance cover the truth as often as they say, and does `--target-error` keep its promise?
//!
//! A thousand small pictures with different seeds, each of two blocks of 8 × 8 pixels: rare light, whose truth is known, and thin fog
//! and haze in the sun, whose truth is the mean of as many pictures of other seeds and fixed numbers of samples. The interval is that
//! of a block's mean: 1.96 standard errors about it. Coverage is judged by the binomial law at [`ALPHA`](woodcock_tests::stats::ALPHA).
//!
//! The mutants: to stop when the samples themselves look good; and to take samples for independent that are not.

use rayon::prelude::*;
use std::ops::Range;
use woodcock_core::path::PathSample;
use woodcock_core::points::REPLICATE;
use woodcock_core::stream::{Key, PathStream, Stream};
use woodcock_host::drive::{Silent, Watch};
use woodcock_host::film::{Allotment, Film, Landing, Place, Places, Window};
use woodcock_host::pilot::{self, Target};
use woodcock_host::render::{Plan, render_allotted};
use woodcock_tests::pictures::{
    Studio, ball, grey, homogeneous, orthographic, scene, sky, stage, sun,
};
use woodcock_tests::stats::{Z_CRITICAL, samples, seed};

const RENDERS: usize = 1024;
const SIZE: [u32; 2] = [16, 8];
const NOMINAL: f64 = 0.95;
/// The two-sided normal quantile of it.
const DEVIATES: f64 = 1.959_964;

/// Two balls side by side, one for each block.
fn studio() -> Studio {
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
    stage(&scene(&wide, SIZE, &world))
}

/// A block's mean of green, and the variance of that.
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

/// Something that adds samples of a seed to a film.
trait Source: Sync {
    fn pass(&self, film: &mut Film, seed: u64, samples: Range<u32>, allotment: Option<&Allotment>);
}

impl Source for Studio {
    fn pass(&self, film: &mut Film, seed: u64, samples: Range<u32>, allotment: Option<&Allotment>) {
        let mut plan = Plan {
            seed,
            replicate: film.replicate(),
            ..self.plan
        };
        // Points that depend on each other come in replicates of their own size only.
        plan.settings.points &= plan.replicate == REPLICATE;
        render_allotted(&self.world, &plan, film, samples, allotment, &Silent);
    }
}

/// Light of mean 1 that is there with a probability for each block, and else black.
struct RareLight([f32; 2]);

impl RareLight {
    fn truth(&self) -> Truth {
        let relative = |p: f32| f64::from((1.0 - p) / p) / 1.01;
        Truth {
            means: [1.0; 2],
            relative: self.0.map(relative),
        }
    }
}

impl Source for RareLight {
    fn pass(&self, film: &mut Film, seed: u64, samples: Range<u32>, allotment: Option<&Allotment>) {
        for tile in film.tiles_mut() {
            let mut landing = Landing::default();
            let places = Places::new(tile.window(), samples.clone(), allotment);
            for place in (0..places.len()).map(|number| places.place(number)) {
                let key = Key {
                    seed,
                    pixel: place.y * SIZE[0] + place.x,
                    sample: place.sample,
                };
                let uniform: f32 = PathStream::new(key).uniform(true);
                let chance = self.0[usize::from(place.x >= 8)];
                let value = if uniform < chance { 1.0 / chance } else { 0.0 };
                let path = PathSample {
                    radiance: [value; 3],
                    alpha: 1.0,
                };
                landing.land(tile, place, path);
            }
        }
    }
}

fn seed_of(number: usize, family: u64) -> u64 {
    seed((family << 32) + number as u64)
}

fn empty(replicate: u32) -> Film {
    Film::of_replicates(SIZE, Window::full(SIZE), replicate)
}

/// A picture of a fixed number of samples.
fn fixed(source: &dyn Source, replicate: u32, seed: u64, n: u32) -> Film {
    let mut film = empty(replicate);
    source.pass(&mut film, seed, 0..n, None);
    film
}

const STILL: Watch<'static> = Watch {
    clock: &|| std::time::Duration::ZERO,
    interrupted: &|| false,
    progress: &Silent,
};

/// A picture as `--target-error` makes it, and the counts of its two blocks.
fn adaptive(source: &dyn Source, replicate: u32, seed: u64, error: f64) -> (Film, [u32; 2]) {
    let target = Target {
        error,
        most: None,
        uniform: false,
        time: None,
    };
    let mut film = empty(replicate);
    let decision = pilot::run(&mut film, &target, STILL, |film, samples| {
        source.pass(film, pilot::seed(seed), samples, None);
        Ok::<_, std::convert::Infallible>(())
    });
    let decision = decision.unwrap_or_else(|never| match never {});
    assert!(decision.enough);
    let allotment = &decision.allotment;
    let mut film = empty(replicate);
    source.pass(&mut film, seed, 0..allotment.largest(), Some(allotment));
    (film, [0, 8].map(|x| allotment.samples(x, 0)))
}

/// The planted mistake: samples until they say themselves that the error of a block is reached.
fn until_it_looks_good(source: &dyn Source, seed: u64, error: f64) -> [Block; 2] {
    let mut film = empty(1);
    let mut stopped = [None; 2];
    for pass in 0.. {
        source.pass(&mut film, seed, 2 * pass..2 * pass + 2, None);
        for (done, block) in stopped.iter_mut().zip(blocks(&film)) {
            // Of the mean pixel; its variance is 64 times that of the block's mean.
            if done.is_none() && 64.0 * block.variance <= (error * block.mean).powi(2) {
                *done = Some(block);
            }
        }
        if let [Some(left), Some(right)] = stopped {
            return [left, right];
        }
    }
    [Block::default(); 2]
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

/// What is known of a source: the means of the blocks, and the relative variance of a sample as the target's error has it: samples
/// times the variance of their mean.
#[derive(Clone, Copy, Debug)]
struct Truth {
    means: [f64; 2],
    relative: [f64; 2],
}

/// The truth of a scene by long renders: so many samples that its own error is nothing beside that of the pictures.
fn measured(source: &dyn Source, replicate: u32, renders: usize) -> Truth {
    let sums: Vec<[f64; 6]> = (0..renders)
        .into_par_iter()
        .map(|i| {
            let film = fixed(source, replicate, seed_of(i, 9), 256);
            let mut pixels = vec![[0.0; 6]; film.window().pixels() as usize];
            for (x, y, pixel) in film.pixels() {
                let [vr, vg, vb] = pixel.variance_of_mean().expect("many samples");
                let ([r, g, b], n) = (pixel.mean(), f64::from(pixel.samples()));
                pixels[film.window().index(x, y)] = [r, g, b, n * vr, n * vg, n * vb];
            }
            pixels
        })
        .reduce_with(|mut a, b| {
            for (sum, part) in a.iter_mut().flatten().zip(b.iter().flatten()) {
                *sum += part;
            }
            a
        })
        .expect("pictures");
    let pixels: Vec<_> = sums.iter().map(|p| p.map(|s| s / renders as f64)).collect();
    let all = pixels.iter().flat_map(|p| &p[..3]).sum::<f64>();
    let mean = all / (3.0 * pixels.len() as f64);
    let mut truth = Truth {
        means: [0.0; 2],
        relative: [0.0; 2],
    };
    for (at, p) in pixels.iter().enumerate() {
        let block = usize::from(at % SIZE[0] as usize >= 8);
        truth.means[block] += p[1] / 64.0;
        for c in 0..3 {
            truth.relative[block] += p[3 + c] / (p[c] * p[c] + 0.01 * mean * mean) / 192.0;
        }
    }
    truth
}

/// Asserts that intervals cover and that targets are kept, with samples one by one and in replicates.
fn assert_honest(name: &str, source: &dyn Source, truths: [Truth; 2], error: f64) {
    let renders = samples(RENDERS);
    for (replicate, truth) in [1, REPLICATE].into_iter().zip(truths) {
        let plain: Vec<_> = (0..renders)
            .into_par_iter()
            .map(|i| blocks(&fixed(source, replicate, seed_of(i, 1), 128)))
            .collect();
        let z = deviate(coverage(truth.means, &plain));
        eprintln!("{name}, replicates of {replicate}: fixed z = {z:.2}");
        assert!(
            z.abs() < Z_CRITICAL,
            "{name}, fixed, replicates of {replicate}: {z}"
        );

        let found: Vec<_> = (0..renders)
            .into_par_iter()
            .map(|i| {
                let (film, counts) = adaptive(source, replicate, seed_of(i, 2), error);
                (blocks(&film), counts)
            })
            .collect();
        let pictures: Vec<_> = found.iter().map(|(blocks, _)| *blocks).collect();
        let z = deviate(coverage(truth.means, &pictures));
        eprintln!("{name}, replicates of {replicate}: adaptive z = {z:.2}");
        assert!(
            z.abs() < Z_CRITICAL,
            "{name}, adaptive, replicates of {replicate}: {z}"
        );
        // The promise: a block's true error exceeds the target in one of twenty pictures at most.
        for block in 0..2 {
            let needed = truth.relative[block] / (error * error);
            let counts = || found.iter().map(|(_, counts)| f64::from(counts[block]));
            let kept = (
                counts().filter(|&n| n >= needed).count() as u32,
                renders as u32,
            );
            let mean = counts().sum::<f64>() / renders as f64;
            eprintln!("  block {block}: kept {kept:?}, {mean:.1} samples of {needed:.1}");
            assert!(
                deviate(kept) > -Z_CRITICAL,
                "{name}, block {block}: {kept:?}"
            );
        }
    }
}

#[test]
fn intervals_of_rare_light_cover_and_targets_are_kept() {
    let light = RareLight([0.02, 0.3]);
    assert_honest("rare light", &light, [light.truth(); 2], 0.5);
}

#[test]
fn dark_blocks_do_not_stop_early_and_the_planted_mistake_is_seen() {
    let light = RareLight([0.002, 0.3]);
    let truth = light.truth();
    // Stopping when the samples look good: where no light was seen there is no error, it seems.
    let stopped: Vec<_> = (0..samples(RENDERS))
        .into_par_iter()
        .map(|i| until_it_looks_good(&light, seed_of(i, 3), 1.0))
        .collect();
    let z = deviate(coverage(truth.means, &stopped));
    eprintln!("stopping on the same samples: z = {z:.1}");
    assert!(z < -2.0 * Z_CRITICAL, "the planted mistake: {z}");

    // The pilot has four events in that block, more or less.
    let found: Vec<_> = (0..samples(RENDERS / 4))
        .into_par_iter()
        .map(|i| {
            let (film, counts) = adaptive(&light, 1, seed_of(i, 4), 1.0);
            (blocks(&film), counts)
        })
        .collect();
    let pictures: Vec<_> = found.iter().map(|(blocks, _)| *blocks).collect();
    let z = deviate(coverage(truth.means, &pictures));
    let kept = |(_, counts): &&([Block; 2], [u32; 2])| f64::from(counts[0]) >= truth.relative[0];
    let kept = (found.iter().filter(kept).count() as u32, found.len() as u32);
    eprintln!("by a pilot: z = {z:.2}, kept {kept:?}");
    assert!(z.abs() < Z_CRITICAL, "{z}");
    assert!(deviate(kept) > -Z_CRITICAL, "{kept:?}");
}

#[test]
fn intervals_of_paths_cover_and_targets_are_kept() {
    let studio = studio();
    let truths = [1, REPLICATE].map(|replicate| measured(&studio, replicate, samples(RENDERS / 4)));
    // An error that takes about 150 independent samples in the noisier block.
    let [thin, haze] = truths[0].relative;
    assert!(thin.max(haze) > 1.3 * thin.min(haze), "{truths:?}");
    let error = (thin.max(haze) / 150.0).sqrt();
    assert_honest("paths", &studio, truths, error);
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
