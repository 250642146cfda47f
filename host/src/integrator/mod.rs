//! Light transport in scalar code: for scenes with surfaces, and for what packets do not do.
//!
//! ## One path integral for surfaces and volumes
//! Equations (5) to (9) of [Raab, Seibert, Keller 2006] put light on surfaces and in media into one integral equation over
//! all of space:
//!
//! ```text
//! L(y→z) = L_e(y→z) + ∫ L(x→y) f(x→y→z) G(x↔y) V(x↔y) dλ(x)
//! ```
//!
//! | term | on a surface | in a medium | code |
//! |---|---|---|---|
//! | dλ(x) | area | volume | `Vertex::across` turns densities of one into the other |
//! | L_e | radiance of the surface | σ_a L_e per length | `Lights::hit_radiance`; `Local::emission`, scored at tentative collisions |
//! | f | the BSDF | σ_s times the phase function | `Site::eval`; σ_s/σ_t is `Local::albedo`, σ_t the flight's density |
//! | G | cosines at both ends over r² | no cosine at an end in a medium | `eval` holds that of the direction it leads to, `across` that of arrival |
//! | V | 1 if nothing is in the way | times e^−τ of the media between | `Tracer::between`: `Surfaces::occluded`, then `transmit` |
//!
//! e^−τ is nowhere computed for media on grids: flights end at real collisions (Algorithm 1, `Tracer::fly`), connections
//! multiply chances of null collisions (`transmit`). Boundaries between media and null collisions are no vertices, and
//! count as no scattering.
//!
//! ## The ladder
//! Each rung is a test of the next.
//!
//! | integrator | what it does | for |
//! |---|---|---|
//! | `transmittance` | light that is not scattered: no decisions, no randomness but where grids are passed | fire without smoke, X-rays |
//! | `single` | light that is scattered at most once (path tracing, cut off) | thin smoke |
//! | `path` | path tracing: next event, phase function or BSDF, and nearness to lamps share by the balance heuristic | nearly everything |
//! | `bdpt` | paths from camera and lights, joined in every way | lamps behind glass or in niches, caustics |
//! | `mlt` | Markov chains over what `bdpt` samples | light through a keyhole |
//!
//! All run in double precision but for the walks through media, which are core's in `f32`; so does the same scene on
//! packets where it has nothing but plain media. A path is a pure function of its key here too.

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
pub(crate) mod room;
mod scatter;
mod score;
pub(crate) mod surface_queue;
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
    /// Into how many paths a camera ray splits.
    pub(crate) split: u32,
    /// Bound on 1/r² of connections in bidirectional path tracing [1/length²].
    pub(crate) connection_bound: Option<f64>,
}
