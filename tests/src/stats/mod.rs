//! Hypothesis tests whose error rate is written down, and which say when they see nothing.
//!
//! Three rules make a statistical suite worth running:
//!
//! 1. *The rate is stated.* A suite may raise a false alarm once in 1000 changes of stream and makes at most
//!    1000 comparisons, so each comparison is held to [`ALPHA`] = 10⁻⁶. Every threshold follows from it.
//! 2. *A verdict has three values.* [`Verdict::Blind`] is the answer when the error bar is wider than what the
//!    check set out to see; only [`Verdict::Agrees`] passes.
//! 3. *A check must have killed.* [`Mutants`] collects planted mistakes; each must be rejected with
//!    |z| ≥ [`KILL_Z`], and a check that rejects none fails its suite.
//!
//! | question | use |
//! |---|---|
//! | does this mean equal a known value? | [`assert_agrees`] on a [`Sample`], [`judge`] on [`Moments`] |
//! | weights in [0, 1] with rare events | [`judge_bounded`] |
//! | a probability | [`judge_proportion`] |
//! | do these draws follow this continuous law? | [`KolmogorovSmirnov`], also for censored flights |
//! | do these counts follow these expectations? | [`ChiSquare`] |
//! | do two estimates agree, neither being exact? | [`welch`] |
//! | do two images agree? | [`ImageTest`] |
//! | are the draws independent? | [`Sample::judge_blocks`] |
//!
//! What each is blind to stands in its own file. All statistics are kept in `f64`.

mod chi_square;
mod image;
pub mod independent;
mod judge;
mod kolmogorov_smirnov;
mod moments;
mod mutants;
mod normal;
mod sample;
mod settings;
mod welch;

pub use chi_square::ChiSquare;
pub use image::{ImageComparison, ImageMoments, ImageTest};
pub use judge::{
    Verdict, assert_agrees, assert_mean_agrees, assert_verdict, judge, judge_bounded,
    judge_proportion, judge_within,
};
pub use kolmogorov_smirnov::KolmogorovSmirnov;
pub use moments::Moments;
pub use mutants::{KILL_Z, Mutants, must_kill};
pub use normal::{deviate_of_ln_p, deviate_of_scaled_chi_square, ln_p_of_deviate};
pub use sample::{BLOCK_SIZE, Sample};
pub use settings::{samples, seed};
pub use welch::{Welch, welch};

/// Probability that one comparison raises a false alarm, two-sided.
pub const ALPHA: f64 = 1e-6;

/// |z| that a normal deviate exceeds with probability [`ALPHA`].
pub const Z_CRITICAL: f64 = 4.892;

/// √n · D that a Kolmogorov–Smirnov distance exceeds with probability at most [`ALPHA`]: √(½ ln(2/α)).
pub const KS_CRITICAL: f64 = 2.694;

/// Relative rounding that a mean of `f32` weights can always show: 2⁻²².
pub const ROUNDING: f64 = 1.0 / 4_194_304.0;
