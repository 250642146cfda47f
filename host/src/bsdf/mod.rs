//! How surfaces reflect and transmit light.
//!
//! Directions are unit vectors away from the surface. A side is *outside* where its cosine with the normal is
//! positive.
//!
//! | law | chosen by | weight for one normal, importance |
//! |---|---|---|
//! | Lambert | cosine | ρ |
//! | smooth boundary, pane | Fresnel's law | 1 |
//! | smooth metal | one direction | F |
//! | rough boundary | normals seen, Fresnel's law | G2 / G1 ≤ 1 |
//! | rough metal | normals seen | F G2 / G1 ≤ F |
//!
//! Refraction divides the weight of radiance by η². Nothing gains energy; rough surfaces lose what bounces between
//! their facets (see [`ggx`]).
//!
//! Two normals: the shading normal gives angles, the geometric one says which side is which. Diffuse light takes its
//! sides from the geometric normal alone; mirrors, lenses and their rough kin want both normals to agree on whether a
//! pair of directions is a reflection or a transmission, and absorb otherwise (at the rims of coarse meshes).
//! All rules are symmetric in the two directions, so for every pair
//!
//! ```text
//! eval(a, b, Radiance) / |b·ng| = eval(b, a, Importance) / |a·ng|
//! ```
//!
//! and a path has the same value from either end ([Veach 1997], chapter 5). Directions within 10⁻¹² of the surface's
//! plane see nothing.

mod diffuse;
mod frame;
pub mod fresnel;
pub mod ggx;
mod materials;
mod rough;
mod smooth;

use glam::DVec3;

use frame::Frame;
use ggx::Ggx;
pub use materials::Materials;

/// What is carried along a path. They differ at refraction, where radiance is squeezed into a smaller cone: by the
/// square of the index ([Veach 1997], chapter 5).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Transport {
    /// Paths from the camera.
    Radiance,
    /// Paths from lights.
    Importance,
}

/// A direction chosen at a surface.
#[derive(Clone, Copy, Debug)]
pub struct BsdfSample {
    /// Unit direction away from the surface.
    pub direction: DVec3,
    /// The BSDF times |cos θ| over the density of the choice, by colour.
    pub weight: [f64; 3],
    /// Density of the choice per solid angle [1/sr]; for specular scattering the probability of its kind.
    pub pdf: f64,
    /// A direction that no other strategy finds.
    pub specular: bool,
}

/// How a surface scatters at one place.
#[derive(Clone, Copy, Debug)]
pub struct Bsdf {
    frame: Frame,
    law: Law,
}

/// The laws of reflection. A roughness of `None` is smooth.
#[derive(Clone, Copy, Debug)]
enum Law {
    /// Light passes.
    Nothing,
    /// Light ends.
    Black,
    /// Reflectance by colour.
    Diffuse([f64; 3]),
    /// Index behind the normal over that in front of it.
    Dielectric(f64, Option<Ggx>),
    /// Index of the pane.
    Pane(f64),
    /// Complex index by colour.
    Conductor([f64; 3], [f64; 3], Option<Ggx>),
}

impl Bsdf {
    /// Whether every direction it can choose is one that no other strategy finds.
    pub fn is_specular(&self) -> bool {
        match self.law {
            Law::Nothing | Law::Black | Law::Pane(_) => true,
            Law::Diffuse(_) => false,
            Law::Dielectric(_, roughness) | Law::Conductor(_, _, roughness) => roughness.is_none(),
        }
    }

    /// The BSDF times |cos θ| of `to`, by colour [1/sr]; zero for specular parts. `from` is where the path came from
    /// (away from the surface), `to` where it goes.
    ///
    /// Exactly: with f(o, i) the ratio of the radiance that leaves to `o` to the irradiance, with the *shading*
    /// normal's cosine, that comes from `i`,
    ///
    /// ```text
    /// Radiance:    f(from, to) |to·ns|
    /// Importance:  f(to, from) |from·ns| |to·ng| / |from·ng|
    /// ```
    ///
    /// The second is f(to, from) |to·ns| with Veach's correction for shading normals folded in. Whoever connects two
    /// paths uses these values as they are and no further cosine at this surface.
    pub fn eval(&self, from: DVec3, to: DVec3, transport: Transport) -> [f64; 3] {
        let frame = &self.frame;
        match self.law {
            Law::Diffuse(reflectance) => diffuse::eval(frame, reflectance, from, to, transport),
            Law::Dielectric(eta, Some(ggx)) => {
                let value = rough::Dielectric { eta, ggx }.eval(frame, from, to, transport);
                [value.unwrap_or(0.0); 3]
            }
            Law::Conductor(eta, k, Some(ggx)) => {
                let reflected = |cosine| metal(cosine, eta, k);
                let value = rough::Conductor { ggx }.eval(frame, reflected, from, to, transport);
                value.unwrap_or([0.0; 3])
            }
            _ => [0.0; 3],
        }
    }

    /// The density with which [`sample`](Self::sample) chooses `to` [1/sr]; zero for specular parts. It integrates to
    /// the probability that `sample` chooses any direction.
    ///
    /// Lambert's law has a density for each transport; where normals are bent they differ.
    pub fn pdf(&self, from: DVec3, to: DVec3, transport: Transport) -> f64 {
        let frame = &self.frame;
        match self.law {
            Law::Diffuse(_) => diffuse::pdf(frame, from, to, transport),
            Law::Dielectric(eta, Some(ggx)) => {
                let pdf = rough::Dielectric { eta, ggx }.pdf(frame, from, to);
                pdf.unwrap_or(0.0)
            }
            Law::Conductor(_, _, Some(ggx)) => {
                let pdf = rough::Conductor { ggx }.pdf(frame, from, to);
                pdf.unwrap_or(0.0)
            }
            _ => 0.0,
        }
    }

    /// Chooses a direction by uniforms in [0, 1): the kind by `u[0]`, the direction by the rest; `None` where the light
    /// is absorbed. The weight is [`eval`](Self::eval) over [`pdf`](Self::pdf), and its like for specular parts.
    pub fn sample(&self, from: DVec3, u: [f64; 3], transport: Transport) -> Option<BsdfSample> {
        let frame = &self.frame;
        match self.law {
            Law::Nothing => Some(smooth::straight(from, 1.0)),
            Law::Black => None,
            Law::Diffuse(reflectance) => {
                diffuse::sample(frame, reflectance, from, [u[1], u[2]], transport)
            }
            Law::Dielectric(eta, None) => smooth::dielectric(frame, eta, from, u[0], transport),
            Law::Dielectric(eta, Some(ggx)) => {
                rough::Dielectric { eta, ggx }.sample(frame, from, u, transport)
            }
            Law::Pane(eta) => smooth::pane(frame, eta, from, u[0], transport),
            Law::Conductor(eta, k, roughness) => {
                let reflected = |cosine| metal(cosine, eta, k);
                match roughness {
                    None => smooth::conductor(frame, reflected, from, transport),
                    Some(ggx) => rough::Conductor { ggx }.sample(
                        frame,
                        reflected,
                        from,
                        [u[1], u[2]],
                        transport,
                    ),
                }
            }
        }
    }

    /// Bound on the part of light that goes on, by colour, for roulette: over all directions that it may come from.
    /// Power counts, so the η² of refraction does not; nor does the tilt of shading normals.
    pub fn albedo(&self) -> [f64; 3] {
        match self.law {
            Law::Black => [0.0; 3],
            Law::Diffuse(reflectance) => reflectance,
            // At grazing angles everything reflects everything.
            _ => [1.0; 3],
        }
    }
}

/// The part of light that a metal reflects, by colour.
fn metal(cosine: f64, eta: [f64; 3], k: [f64; 3]) -> [f64; 3] {
    [0, 1, 2].map(|c| fresnel::conductor(cosine, eta[c], k[c]))
}
