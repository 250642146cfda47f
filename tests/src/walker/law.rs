//! Where a collision sends a walk: core's phase functions.

use super::Draws;
use woodcock_core::phase;
use woodcock_core::phase::two_lobe::TwoLobe;
use woodcock_core::vec3::Vec3;

/// A phase function, which may depend on the place.
pub trait Law {
    /// A cosine between the directions of travel before and after.
    fn cosine(&self, at: &Vec3<f32>, draws: &mut Draws) -> f32;
    /// The density of that cosine over the sphere [1/sr].
    fn density(&self, at: &Vec3<f32>, cosine: f32) -> f32;
}

impl<L: Law + ?Sized> Law for &L {
    fn cosine(&self, at: &Vec3<f32>, draws: &mut Draws) -> f32 {
        (*self).cosine(at, draws)
    }
    fn density(&self, at: &Vec3<f32>, cosine: f32) -> f32 {
        (*self).density(at, cosine)
    }
}

impl<L: Law + ?Sized> Law for Box<L> {
    fn cosine(&self, at: &Vec3<f32>, draws: &mut Draws) -> f32 {
        self.as_ref().cosine(at, draws)
    }
    fn density(&self, at: &Vec3<f32>, cosine: f32) -> f32 {
        self.as_ref().density(at, cosine)
    }
}

/// `phase/isotropic.rs`.
#[derive(Clone, Copy, Debug)]
pub struct Isotropic;

/// `phase/henyey_greenstein.rs`, by its mean cosine.
#[derive(Clone, Copy, Debug)]
pub struct HenyeyGreenstein(
    /// g.
    pub f32,
);

/// `phase/rayleigh.rs`.
#[derive(Clone, Copy, Debug)]
pub struct Rayleigh;

impl Law for Isotropic {
    #[inline]
    fn cosine(&self, _: &Vec3<f32>, draws: &mut Draws) -> f32 {
        phase::isotropic::sample(draws.uniform())
    }
    #[inline]
    fn density(&self, _: &Vec3<f32>, cosine: f32) -> f32 {
        phase::isotropic::eval(cosine)
    }
}

impl Law for HenyeyGreenstein {
    #[inline]
    fn cosine(&self, _: &Vec3<f32>, draws: &mut Draws) -> f32 {
        phase::henyey_greenstein::sample(draws.uniform(), self.0)
    }
    #[inline]
    fn density(&self, _: &Vec3<f32>, cosine: f32) -> f32 {
        phase::henyey_greenstein::eval(cosine, self.0)
    }
}

impl Law for Rayleigh {
    #[inline]
    fn cosine(&self, _: &Vec3<f32>, draws: &mut Draws) -> f32 {
        phase::rayleigh::sample(draws.uniform())
    }
    #[inline]
    fn density(&self, _: &Vec3<f32>, cosine: f32) -> f32 {
        phase::rayleigh::eval(cosine)
    }
}

/// `phase/two_lobe.rs`.
#[derive(Clone, Copy, Debug)]
pub struct Lobes(
    /// Both lobes.
    pub TwoLobe<f32>,
);

impl Law for Lobes {
    fn cosine(&self, _: &Vec3<f32>, draws: &mut Draws) -> f32 {
        self.0.sample(draws.uniform())
    }
    fn density(&self, _: &Vec3<f32>, cosine: f32) -> f32 {
        self.0.eval(cosine)
    }
}

/// `phase/draine.rs`.
#[derive(Clone, Copy, Debug)]
pub struct Draine {
    /// Parameter of the lobe; not the mean cosine.
    pub g: f32,
    /// Weight of the squared cosine, not negative.
    pub alpha: f32,
}

impl Law for Draine {
    fn cosine(&self, _: &Vec3<f32>, draws: &mut Draws) -> f32 {
        phase::draine::sample(draws.uniform(), self.g, self.alpha)
    }
    fn density(&self, _: &Vec3<f32>, cosine: f32) -> f32 {
        phase::draine::eval(cosine, self.g, self.alpha)
    }
}
