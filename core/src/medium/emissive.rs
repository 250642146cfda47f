//! Media that shine: extinction with an emission coefficient.
//!
//! ```text
//! L = ∫ T(t) j(t) dt,   j = σ_a L_e  [W/(m³ sr)]
//! ```
//!
//! The emission enters line integrals as c_V = j (see [`line_integral`](crate::line_integral)).
//! [`tentative`](crate::line_integral::tentative) scores it wherever a tentative point falls, also
//! where the medium shines without absorbing; scoring j/σ_t at real collisions misses that part.

use crate::ray::Ray;
use crate::real::Real;
use crate::vec3::Vec3;

/// An emission coefficient as a function of place.
pub trait Emission<R: Real> {
    /// j at a world-space place, per lane [W/(m³ sr)]; total, not negative.
    fn emission(&self, place: Vec3<R>) -> R;

    /// j along a ray, as line integrals ask for it.
    #[inline(always)]
    fn along<'a>(&'a self, ray: &'a Ray<R>) -> impl Fn(R, R::Mask) -> R + 'a {
        move |t, _| self.emission(ray.at(t))
    }
}

/// A medium together with its emission.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Emissive<M, F> {
    /// What it absorbs and scatters.
    pub medium: M,
    /// Its emission coefficient: a function of the place, per lane [W/(m³ sr)].
    pub emission: F,
}

impl<R: Real, M, F: Fn(Vec3<R>) -> R> Emission<R> for Emissive<M, F> {
    #[inline(always)]
    fn emission(&self, place: Vec3<R>) -> R {
        (self.emission)(place)
    }
}
