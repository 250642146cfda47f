//! How a render looks while it runs: a bar on a terminal, plain lines in a log, or nothing.

use crate::drive::{Goal, Progress, Silent};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::{self, IsTerminal};
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};
use std::sync::{Mutex, OnceLock, PoisonError};
use std::time::{Duration, Instant};

/// Time between lines of a log.
const LINE_INTERVAL: Duration = Duration::from_secs(5);

/// The display that suits standard error.
pub fn display(quiet: bool) -> Box<dyn Progress> {
    if quiet {
        Box::new(Silent)
    } else if io::stderr().is_terminal() {
        Box::new(Bar::new())
    } else {
        Box::new(Lines::default())
    }
}

/// What is known of a running render.
#[derive(Debug)]
struct State {
    start: Instant,
    pixels: u64,
    goal: Goal,
    paths: AtomicU64,
    error: Mutex<Option<f64>>,
}

impl State {
    fn new(pixels: u64, goal: &Goal) -> Self {
        Self {
            start: Instant::now(),
            pixels: pixels.max(1),
            goal: *goal,
            paths: AtomicU64::new(0),
            error: Mutex::new(None),
        }
    }

    /// Part of the goal reached, in [0, 1]; `None` for a goal without end.
    fn fraction(&self) -> Option<f64> {
        let samples = self.goal.samples.map(|samples| {
            self.paths.load(Relaxed) as f64 / (self.pixels as f64 * f64::from(samples.max(1)))
        });
        let time = self
            .goal
            .time
            .map(|limit| self.start.elapsed().as_secs_f64() / limit.as_secs_f64());
        let fractions = samples.into_iter().chain(time);
        fractions.reduce(f64::max).map(|f| f.clamp(0.0, 1.0))
    }

    fn set_error(&self, error: Option<f64>) {
        *self.error.lock().unwrap_or_else(PoisonError::into_inner) = error;
    }

    /// `12.0 spp, 1.23 Mpaths/s, error 3.4 %`
    fn describe(&self) -> String {
        let paths = self.paths.load(Relaxed) as f64;
        let rate = paths / self.start.elapsed().as_secs_f64().max(1e-9);
        let spp = paths / self.pixels as f64;
        let error = *self.error.lock().unwrap_or_else(PoisonError::into_inner);
        let error = error.map_or_else(String::new, |e| format!(", error {}", percent(e)));
        format!("{spp:.1} spp, {}paths/s{error}", metric(rate))
    }
}

/// A number with three digits and a metric prefix.
fn metric(x: f64) -> String {
    match x {
        x if x >= 1e9 => format!("{:.2} G", x / 1e9),
        x if x >= 1e6 => format!("{:.2} M", x / 1e6),
        x if x >= 1e3 => format!("{:.1} k", x / 1e3),
        x => format!("{x:.0} "),
    }
}

/// A fraction in per cent with two significant digits or more.
pub(super) fn percent(x: f64) -> String {
    if x >= 0.1 {
        format!("{:.0} %", 100.0 * x)
    } else if x >= 0.01 {
        format!("{:.1} %", 100.0 * x)
    } else {
        format!("{:.2} %", 100.0 * x)
    }
}

/// A bar that is redrawn in place.
#[derive(Debug)]
struct Bar {
    bar: ProgressBar,
    state: OnceLock<State>,
}

impl Bar {
    /// Steps of the bar: finer than any terminal is wide.
    const STEPS: u64 = 10_000;

    fn new() -> Self {
        let bar = ProgressBar::with_draw_target(None, ProgressDrawTarget::stderr());
        Self {
            bar,
            state: OnceLock::new(),
        }
    }
}

impl Progress for Bar {
    fn begin(&self, pixels: u64, goal: &Goal) {
        let state = self.state.get_or_init(|| State::new(pixels, goal));
        let template = if state.fraction().is_some() {
            self.bar.set_length(Self::STEPS);
            "{elapsed_precise} {wide_bar} {percent:>3} %, {msg}, {eta} left"
        } else {
            "{elapsed_precise} {spinner} {msg}"
        };
        // The templates are constants; if one were wrong, the plain bar would do.
        if let Ok(style) = ProgressStyle::with_template(template) {
            self.bar.set_style(style);
        }
        self.bar.enable_steady_tick(Duration::from_millis(250));
    }

    fn advance(&self, paths: u64) {
        let Some(state) = self.state.get() else {
            return;
        };
        state.paths.fetch_add(paths, Relaxed);
        if let Some(fraction) = state.fraction() {
            self.bar
                .set_position((fraction * Self::STEPS as f64) as u64);
        }
    }

    fn pass(&self, _samples: u32, _elapsed: Duration, error: Option<f64>) {
        if let Some(state) = self.state.get() {
            state.set_error(error);
            self.bar.set_message(state.describe());
        }
    }

    fn wants_error(&self) -> bool {
        true
    }

    fn end(&self) {
        self.bar.finish_and_clear();
    }
}

/// A line every few seconds.
#[derive(Debug, Default)]
struct Lines {
    state: OnceLock<State>,
    /// Milliseconds since the beginning at which the next line is due.
    due: AtomicU64,
}

impl Lines {
    fn print(state: &State) {
        let done = state.fraction();
        let done = done.map_or_else(String::new, |f| format!("{:3.0} %, ", 100.0 * f));
        let seconds = state.start.elapsed().as_secs_f64();
        eprintln!("{seconds:7.1} s: {done}{}", state.describe());
    }
}

impl Progress for Lines {
    fn begin(&self, pixels: u64, goal: &Goal) {
        self.state.get_or_init(|| State::new(pixels, goal));
        self.due.store(LINE_INTERVAL.as_millis() as u64, Relaxed);
    }

    fn advance(&self, paths: u64) {
        let Some(state) = self.state.get() else {
            return;
        };
        state.paths.fetch_add(paths, Relaxed);
        let now = state.start.elapsed().as_millis() as u64;
        let due = self.due.load(Relaxed);
        let next = now + LINE_INTERVAL.as_millis() as u64;
        // The thread that moves the due time prints; the others go on.
        if now >= due
            && self
                .due
                .compare_exchange(due, next, Relaxed, Relaxed)
                .is_ok()
        {
            Self::print(state);
        }
    }

    fn pass(&self, _samples: u32, _elapsed: Duration, error: Option<f64>) {
        if let Some(state) = self.state.get() {
            state.set_error(error);
        }
    }

    fn wants_error(&self) -> bool {
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_read_well() {
        assert_eq!(metric(1_234_567.0), "1.23 M");
        assert_eq!(metric(999.0), "999 ");
        assert_eq!(percent(0.5), "50 %");
        assert_eq!(percent(0.0321), "3.2 %");
        assert_eq!(percent(0.00321), "0.32 %");
    }

    #[test]
    fn the_fraction_is_that_of_the_nearer_limit() {
        let goal = Goal {
            samples: Some(10),
            time: Some(Duration::from_secs(1_000_000)),
            ..Goal::default()
        };
        let state = State::new(100, &goal);
        state.paths.store(250, Relaxed);
        assert_eq!(state.fraction(), Some(0.25));
        assert!(state.describe().starts_with("2.5 spp"));
        assert_eq!(State::new(100, &Goal::default()).fraction(), None);
    }
}
