//! Rendering pass by pass: how many samples next, and when to stop.
//!
//! A pass adds the same range of samples to every pixel, or to every pixel that is still to get some. Between passes, and only
//! there, the clock and signals are heeded, so the picture always holds whole passes: every pixel has the same samples, or all of its own. Sums are exact, so the same samples give the
//! same bits however they were cut into passes.
//!
//! Stopping on the clock is not strictly unbiased (a dear path delays the stop), which is why such an image says so.

use crate::film::{Allotment, Film, sum};
use std::ops::Range;
use std::time::Duration;

/// Paths a pass may have: seconds of work, so that a signal need not wait long, and enough that passes cost nothing.
const PATHS_PER_PASS: u64 = 1 << 21;

/// What is asked of a render.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Goal {
    /// Samples per pixel at which to stop; without one only the clock or a signal stops.
    pub samples: Option<u32>,
    /// Time after which to stop.
    pub time: Option<Duration>,
    /// Index of the first sample, so that shards may share the work.
    pub first_sample: u32,
    /// Samples that are not to be parted, [`Film::replicate`]: passes end at their multiples, but for the last. Zero is one.
    pub replicate: u32,
}

/// What ended a render.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stopping {
    /// All samples asked for were traced.
    Samples,
    /// All samples were traced that the error asked for takes.
    Target,
    /// The clock ran out.
    Time,
    /// The user or the system asked to stop.
    Signal,
}

impl Stopping {
    /// The word in `woodcock.stopping`.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Samples => "samples",
            Self::Target => "target",
            Self::Time => "time",
            Self::Signal => "signal",
        }
    }
}

/// How a render ended.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Outcome {
    /// What ended it.
    pub stopping: Stopping,
    /// The samples that every pixel has now.
    pub samples: Range<u32>,
    /// Wall-clock time of the passes.
    pub render_time: Duration,
    /// Whether everything asked for was done; otherwise the process exits with 3.
    pub complete: bool,
}

/// Someone who watches a render. Called from any thread.
pub trait Progress: Sync {
    /// A render begins: pixels of the window, what is asked.
    fn begin(&self, _pixels: u64, _goal: &Goal) {}
    /// Camera paths were finished.
    fn advance(&self, _paths: u64) {}
    /// A pass is over: samples per pixel so far, seconds since the beginning, and the relative error, if known.
    fn pass(&self, _samples: u32, _elapsed: Duration, _error: Option<f64>) {}
    /// Whether [`pass`](Self::pass) should be told the error, which takes a few milliseconds to estimate.
    fn wants_error(&self) -> bool {
        false
    }
    /// The render is over, one way or the other.
    fn end(&self) {}
}

/// Watches nothing.
#[derive(Clone, Copy, Debug, Default)]
pub struct Silent;

impl Progress for Silent {}

/// The world outside a render.
#[derive(Clone, Copy)]
pub struct Watch<'a> {
    /// Time since some fixed moment. A closure because targets without a clock exist, and tests.
    pub clock: &'a dyn Fn() -> Duration,
    /// Whether to stop at the next opportunity.
    pub interrupted: &'a dyn Fn() -> bool,
    /// Who is told.
    pub progress: &'a dyn Progress,
}

impl std::fmt::Debug for Watch<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Watch").finish_non_exhaustive()
    }
}

/// Runs passes until the goal is met or something stops them.
///
/// * `pass(film, samples)` adds the samples with these indices to every pixel, and calls [`Progress::advance`] as it goes.
/// * At least one pass is made, even if time or patience is up already, so that there is a picture. A goal without samples and time runs
///   up to the [capacity](sum::CAPACITY) of the film.
///
/// Passes double in size, from one sample per pixel to about two million paths. As a time limit comes near, they shrink to what fits.
/// Errors: those of `pass`, which end the render.
pub fn drive<E>(
    film: &mut Film,
    goal: &Goal,
    watch: Watch<'_>,
    pass: impl FnMut(&mut Film, Range<u32>) -> Result<(), E>,
) -> Result<Outcome, E> {
    let pixels = film.window().pixels();
    watch.progress.begin(pixels, goal);
    passes(film, goal, &|_| pixels, watch, pass)
}

/// The same where pixels get the samples of an allotment, which `pass` is to heed, and none the others. `goal.samples` is
/// not looked at.
pub fn drive_allotted<E>(
    film: &mut Film,
    goal: &Goal,
    allotment: &Allotment,
    watch: Watch<'_>,
    pass: impl FnMut(&mut Film, Range<u32>) -> Result<(), E>,
) -> Result<Outcome, E> {
    let shown = Goal {
        samples: Some((allotment.mean().ceil() as u32).max(1)),
        ..*goal
    };
    watch.progress.begin(film.window().pixels(), &shown);
    let goal = Goal {
        samples: Some(allotment.largest()),
        ..*goal
    };
    passes(
        film,
        &goal,
        &|sample| allotment.pixels_with(sample),
        watch,
        pass,
    )
}

/// Passes in which so many pixels get the sample of an index.
fn passes<E>(
    film: &mut Film,
    goal: &Goal,
    pixels: &dyn Fn(u32) -> u64,
    watch: Watch<'_>,
    mut pass: impl FnMut(&mut Film, Range<u32>) -> Result<(), E>,
) -> Result<Outcome, E> {
    let room = sum::CAPACITY.min(u32::MAX - goal.first_sample);
    let wanted = goal.samples.unwrap_or(room).min(room);
    let start = (watch.clock)();
    let elapsed = || (watch.clock)().saturating_sub(start);
    let mut done = 0;
    let mut paths = 0_u64;
    let stopping = loop {
        if done >= wanted {
            break Stopping::Samples;
        }
        if done > 0 && (watch.interrupted)() {
            break Stopping::Signal;
        }
        let first = goal.first_sample + done;
        let active = pixels(first).max(1);
        let largest = (PATHS_PER_PASS / active).max(1);
        let mut count = u64::from(done.max(1)).min(largest) as u32;
        if let Some(limit) = goal.time.filter(|_| done > 0) {
            let left = limit.saturating_sub(elapsed());
            if left.is_zero() {
                break Stopping::Time;
            }
            let pace = paths as f64 / active as f64;
            let fitting = fitting(left, elapsed(), pace);
            if fitting < goal.replicate / 2 {
                break Stopping::Time; // a replicate is nearer to the limit without than with it
            }
            count = count.min(fitting);
        }
        count = whole(first, count, goal.replicate).min(wanted - done);
        let result = pass(film, first..first + count);
        if result.is_err() {
            watch.progress.end();
        }
        result?;
        done += count;
        paths += active * u64::from(count);
        let error = watch
            .progress
            .wants_error()
            .then(|| film.relative_error_quick())
            .flatten();
        watch.progress.pass(done, elapsed(), error);
    };
    watch.progress.end();
    Ok(Outcome {
        stopping,
        samples: goal.first_sample..goal.first_sample + done,
        render_time: elapsed(),
        complete: match stopping {
            Stopping::Samples | Stopping::Target => {
                goal.samples.is_none_or(|samples| done == samples)
            }
            Stopping::Time => goal.samples.is_none(),
            Stopping::Signal => false,
        },
    })
}

/// As many samples from `first` as `count`, or fewer, so that the next begins a replicate; at least to the end of the first.
fn whole(first: u32, count: u32, replicate: u32) -> u32 {
    let replicate = replicate.max(1);
    let end = first.saturating_add(count);
    let end = (end - end % replicate).max((first - first % replicate).saturating_add(replicate));
    end - first
}

/// Samples per pixel that fit the time left at the pace so far, `done` per pixel; at least one, so the limit is passed by less
/// than a sample per pixel.
fn fitting(left: Duration, elapsed: Duration, done: f64) -> u32 {
    let pace = elapsed.as_secs_f64() / done;
    (left.as_secs_f64() / pace).max(1.0) as u32 // a pace of zero gives infinity, which saturates
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::Window;
    use std::cell::{Cell, RefCell};
    use std::convert::Infallible;

    /// Drives a film of `side²` pixels; each sample per pixel takes `cost` on a made-up clock. Returns the passes.
    fn run(side: u32, goal: Goal, cost: Duration, stop_after: u32) -> (Outcome, Vec<Range<u32>>) {
        let now = Cell::new(Duration::from_secs(100));
        let passes = RefCell::new(Vec::new());
        let mut film = Film::new([side; 2], Window::full([side; 2]));
        let outcome = drive(
            &mut film,
            &goal,
            Watch {
                clock: &|| now.get(),
                interrupted: &|| passes.borrow().len() as u32 >= stop_after,
                progress: &Silent,
            },
            |_, samples| {
                now.set(now.get() + cost * samples.len() as u32);
                passes.borrow_mut().push(samples);
                Ok::<_, Infallible>(())
            },
        );
        let outcome = outcome.unwrap_or_else(|never| match never {});
        (outcome, passes.into_inner())
    }

    fn contiguous(passes: &[Range<u32>], first: u32, end: u32) {
        let mut next = first;
        for pass in passes {
            assert_eq!(pass.start, next);
            assert!(pass.end > pass.start);
            next = pass.end;
        }
        assert_eq!(next, end);
    }

    const MS: Duration = Duration::from_millis(1);

    #[test]
    fn samples_are_traced_once_each_in_growing_passes() {
        let goal = Goal {
            samples: Some(100),
            first_sample: 40,
            ..Goal::default()
        };
        let (outcome, passes) = run(16, goal, MS, u32::MAX);
        let sizes: Vec<_> = passes.iter().map(|pass| pass.len()).collect();
        assert_eq!(sizes, [1, 1, 2, 4, 8, 16, 32, 36]);
        contiguous(&passes, 40, 140);
        assert_eq!(
            (outcome.stopping, outcome.complete),
            (Stopping::Samples, true)
        );
        assert_eq!(outcome.samples, 40..140);
        assert_eq!(outcome.render_time, 100 * MS);
    }

    #[test]
    fn passes_of_large_pictures_stay_small() {
        let goal = Goal {
            samples: Some(20),
            ..Goal::default()
        };
        let (_, passes) = run(724, goal, MS, u32::MAX); // 2^19 pixels: 4 samples are 2^21 paths
        assert!(passes.iter().all(|pass| pass.len() <= 4));
        contiguous(&passes, 0, 20);
    }

    #[test]
    fn the_clock_stops_near_its_limit() {
        let limit = |samples, ms| Goal {
            samples,
            time: Some(ms * MS),
            first_sample: 0,
            replicate: 1,
        };
        let (outcome, passes) = run(16, limit(None, 1000), 3 * MS, u32::MAX);
        assert_eq!((outcome.stopping, outcome.complete), (Stopping::Time, true));
        assert!(outcome.render_time >= 1000 * MS && outcome.render_time <= 1003 * MS);
        contiguous(&passes, 0, 334);
        // Samples asked for but not reached: incomplete. Reached in time: as if there were no limit.
        let (outcome, _) = run(16, limit(Some(500), 1000), 3 * MS, u32::MAX);
        assert_eq!(
            (outcome.stopping, outcome.complete),
            (Stopping::Time, false)
        );
        let (outcome, _) = run(16, limit(Some(300), 1000), 3 * MS, u32::MAX);
        assert_eq!(
            (outcome.stopping, outcome.complete),
            (Stopping::Samples, true)
        );
        // A limit shorter than one sample still gives a picture.
        let (outcome, _) = run(16, limit(None, 1), 3 * MS, u32::MAX);
        assert_eq!(outcome.samples, 0..1);
        assert!(outcome.complete);
    }

    #[test]
    fn a_signal_ends_after_the_pass_in_flight() {
        let goal = Goal {
            samples: Some(100),
            ..Goal::default()
        };
        let (outcome, passes) = run(16, goal, MS, 3);
        assert_eq!(
            (outcome.stopping, outcome.complete),
            (Stopping::Signal, false)
        );
        contiguous(&passes, 0, 4);
        let (outcome, _) = run(16, goal, MS, 0);
        assert_eq!(outcome.samples, 0..1, "there is always a picture");
    }

    #[test]
    fn allotted_passes_grow_as_pixels_are_done() {
        // One pixel of 2^20 wants a million samples, the others two.
        let window = Window::full([1024; 2]);
        let allotment = Allotment::new(window, |x, y| if (x, y) == (3, 4) { 1_000_000 } else { 2 });
        let passes = RefCell::new(Vec::new());
        let mut film = Film::new([1, 1], Window::full([1, 1]));
        let watch = Watch {
            clock: &|| Duration::ZERO,
            interrupted: &|| false,
            progress: &Silent,
        };
        let goal = Goal::default();
        let outcome = drive_allotted(&mut film, &goal, &allotment, watch, |_, samples| {
            passes.borrow_mut().push(samples);
            Ok::<_, Infallible>(())
        });
        let outcome = outcome.unwrap_or_else(|never| match never {});
        let passes = passes.into_inner();
        contiguous(&passes, 0, 1_000_000);
        assert!(outcome.complete && passes.len() < 25, "{}", passes.len());
    }

    #[test]
    fn replicates_are_not_parted() {
        for (first, samples, side) in [(0, 200, 16), (8, 200, 16), (32, 100, 724), (5, 7, 4)] {
            let goal = Goal {
                samples: Some(samples),
                first_sample: first,
                replicate: 16,
                ..Goal::default()
            };
            let (outcome, passes) = run(side, goal, MS, u32::MAX);
            contiguous(&passes, first, first + samples);
            assert!(outcome.complete);
            let cuts = passes.iter().skip(1).map(|pass| pass.start);
            assert!(cuts.into_iter().all(|cut| cut % 16 == 0), "{passes:?}");
        }
        let goal = Goal {
            time: Some(1000 * MS),
            replicate: 16,
            ..Goal::default()
        };
        let (outcome, passes) = run(16, goal, 3 * MS, u32::MAX);
        assert!(passes.iter().all(|pass| pass.end % 16 == 0));
        let off = outcome.render_time.abs_diff(1000 * MS);
        assert!(off <= 8 * 3 * MS, "{off:?}");
    }

    #[test]
    fn errors_of_a_pass_end_the_render() {
        let mut film = Film::new([1, 1], Window::full([1, 1]));
        let watch = Watch {
            clock: &|| Duration::ZERO,
            interrupted: &|| false,
            progress: &Silent,
        };
        let result = drive(&mut film, &Goal::default(), watch, |_, _| Err("no"));
        assert_eq!(result, Err("no"));
    }
}
