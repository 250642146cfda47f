//! Volume paths: the state and the steps that scalar code and packets both run.
//!
//! ## The life of a path
//! A path begins on the film and is always in one *stage*:
//!
//! ```text
//!           ┌────────────── null ──────────────┐
//!           ▼                                  │
//! launch → enter → track ⇄ (next segment) → collide → scatter ─┐
//!           ▲ │                                                │
//!           │ └─ nothing left: escape, or the shadow ray is through
//!           └──────────────── shadow ray, then the next flight ┘
//! ```
//!
//! *Enter* finds the next stretch of the ray that lies in a medium; *track* moves through majorant
//! segments to a tentative collision; *collide* decides what it is; *scatter* samples a light and a new
//! direction. The shadow ray of a scattering runs through the same stages, as a flag of the lane, so
//! that lanes on shadow rays and lanes in flight share every step.
//!
//! Where a medium shines, the camera ray may be *combed* instead: [`glow()`] finds what it sees, and launch goes to scatter, once for each of a
//! few branches.
//!
//! Among [`Surfaces`] there are two more stages, which serve lanes one by one. A flight that has come to where surfaces may be *looks* for
//! the nearest, and flies on up to there; one that arrives is *shaded*: a light, a direction by the BSDF. Shadow rays look first.
//!
//! Each step serves all lanes in its stage and no other. Which stage runs when changes no path's value,
//! as a path draws only its own numbers in its own order; packets use that freedom to fill their
//! lanes, and one lane simply follows the arrows.

mod absorption;
mod bricks;
mod counts;
mod geometry;
mod glow;
mod media;
mod one_grid;
mod source;
mod start;
mod state;
mod stratum;
mod surfaces;

pub use absorption::{absorb, sample_of};
pub use bricks::{
    BRICK, BRICK_SAMPLES, Bricks, Exact, brick_counts, code, code_floor, half_to_single,
};
pub use counts::Counts;
pub use geometry::{Convex, Geometry, Stretch};
pub use glow::{BRANCHES, Glow, glow};
pub use media::{
    Atlas, Decided, MediumRecord, OneHomogeneous, Optics, PathMedium, RECORD_WORDS, RecordKind,
    Tapped,
};
pub use one_grid::{OneGrid, Store};
pub use source::{BlackBodies, Field, Radiance, Shining, Source};
pub use start::Start;
pub use state::{Paths, Stage};
pub use stratum::STRATUM;
pub use surfaces::{Arrival, Enclosure, NO_PLANE, NoSurfaces, Onward, Surfaces, clearance};

use crate::camera::Camera;
use crate::light::Lights;

/// Which estimator of transmittance is used where the medium has no closed form.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ShadowEstimator {
    /// [`crate::transmittance::power_series`] for the camera rays of scenes that only absorb, which see little else;
    /// [`crate::transmittance::ratio`] with roulette for shadow rays, most of which are soon blocked, and again for those that
    /// [would bring much](Settings::bright).
    #[default]
    ByNeed,
    /// [`crate::transmittance::ratio`].
    Ratio,
    /// [`crate::transmittance::delta`].
    Delta,
}

/// What does not differ between paths.
#[derive(Clone, Copy, Debug)]
pub struct Settings {
    /// Scatterings after which a path is cut off; `u32::MAX` is no limit. A cut is a bias that the
    /// scene asked for.
    pub max_depth: u32,
    /// Shadow rays.
    pub shadow: ShadowEstimator,
    /// Whether first choices take [points](crate::points) that lie well; else all come from the stream.
    pub points: bool,
    /// Whether flights within a medium of constant extinction collide where their paths still have much to bring, what would have passed
    /// being scored as they go; for scenes whose rays meet one stretch of one medium at most, and no light samples the environment.
    pub forced: bool,
    /// Whether combs of points along camera rays find what they see of a medium that shines, and paths begin with its
    /// scatterings; for a single medium whose stretches of a ray do not overlap.
    pub combed: bool,
    /// The density of scattering towards a light, times throughput [1/sr], below which a shadow ray plays roulette for
    /// being traced at all; positive. Those that are traced bring at least as much but for what is in their way, and play
    /// roulette again where that leaves little of it.
    pub faint: f32,
    /// The density of scattering towards a light, times throughput [1/sr], for each multiple of which the transmittance of a shadow ray
    /// is estimated once more, up to sixteen times, where it has no closed form; the mean counts. Positive; infinite for one
    /// estimate a ray.
    pub bright: f32,
    /// The throughput below which a path plays roulette, and survives with it.
    pub roulette: f32,
}

impl Settings {
    /// Whether flights are [`forced`](Self::forced): what passes meets the environment with its whole weight, which it has only if nothing
    /// else samples that.
    #[inline(always)]
    pub(crate) fn forces(&self, lights: &Lights<'_>) -> bool {
        self.forced && !lights.sample_environment
    }

    /// What [`faint`](Self::faint) is where every shadow ray is to be traced.
    pub const ALL_SHADOW_RAYS: f32 = 1e-9;
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            max_depth: u32::MAX,
            shadow: ShadowEstimator::ByNeed,
            points: false,
            forced: false,
            combed: false,
            faint: 0.06,
            bright: f32::INFINITY,
            roulette: 0.25,
        }
    }
}

/// Everything a path can meet.
#[derive(Debug)]
pub struct Scene<'a, M, G: ?Sized> {
    /// What fills space.
    pub medium: &'a M,
    /// Where each medium lies.
    pub geometry: &'a G,
    /// What shines.
    pub lights: Lights<'a>,
    /// Where paths begin.
    pub camera: &'a Camera,
    /// The rest.
    pub settings: Settings,
}

/// What a finished path brings to its pixel.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PathSample {
    /// Radiance along the camera ray, by colour.
    pub radiance: [f32; 3],
    /// An estimate of how much of what is behind is hidden, by media and surfaces.
    pub alpha: f32,
}
