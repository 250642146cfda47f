//! Light transport in scalar code: for scenes with surfaces, and for what packets do not do.
//!
//! A ladder, each rung a test of the next: [`transmittance`] (light that arrives unscattered), [`single`](path)
//! (scattered at most once), [`path`], and beside it [`bdpt`] and [`mlt`], which make the same image in other ways.

pub(crate) mod bdpt;
pub(crate) mod camera;
mod canvas;
mod draws;
mod equi_angular;
pub(crate) mod glow;
mod mlt;
mod next_event;
mod pass;
mod path;
mod scatter;
mod score;
mod tracer;
mod transmit;
mod transmittance;
mod walk;

pub(crate) use draws::{Draws, Subpath};
pub(crate) use pass::replay;
pub use pass::{Integrator, render_pass};
pub(crate) use score::{Matter, Sample, Score};
pub(crate) use walk::{Stretch, Tentative};

/// What does not differ between paths.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Settings {
    /// Scatterings after which a path is cut off; `u32::MAX` is no limit.
    pub(crate) max_depth: u32,
    /// Bound on 1/r² of connections in bidirectional path tracing [1/length²].
    pub(crate) connection_bound: Option<f64>,
}
