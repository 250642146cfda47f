//! Where a collision sends a walk: core's phase functions, and what can be composed of them.

use super::Draws;
use woodcock_core::phase;
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

/// One of two laws at random, with one draw of its own.
#[derive(Clone, Copy, Debug)]
pub struct Mixture<A, B> {
    /// Probability of the first.
    pub share: f32,
    /// The first.
    pub first: A,
    /// The second.
    pub second: B,
}

impl<A: Law, B: Law> Law for Mixture<A, B> {
    fn cosine(&self, at: &Vec3<f32>, draws: &mut Draws) -> f32 {
        if draws.uniform() < self.share {
            self.first.cosine(at, draws)
        } else {
            self.second.cosine(at, draws)
        }
    }
    fn density(&self, at: &Vec3<f32>, cosine: f32) -> f32 {
        let (first, second) = (
            self.first.density(at, cosine),
            self.second.density(at, cosine),
        );
        self.share * first + (1.0 - self.share) * second
    }
}

/// Draine's phase function, by rejection from Henyey–Greenstein: a cosine c of that lobe is kept with probability
/// (1 + αc²)/(1 + α).
#[derive(Clone, Copy, Debug)]
pub struct Draine {
    /// Parameter of the lobe; not the mean cosine.
    pub g: f32,
    /// Weight of the squared cosine, not negative.
    pub alpha: f32,
}

impl Law for Draine {
    fn cosine(&self, at: &Vec3<f32>, draws: &mut Draws) -> f32 {
        loop {
            let cosine = HenyeyGreenstein(self.g).cosine(at, draws);
            if draws.uniform() * (1.0 + self.alpha) < 1.0 + self.alpha * cosine * cosine {
                return cosine;
            }
        }
    }
    fn density(&self, at: &Vec3<f32>, cosine: f32) -> f32 {
        let norm = 1.0 + self.alpha * (1.0 + 2.0 * self.g * self.g) / 3.0;
        let lobe = HenyeyGreenstein(self.g).density(at, cosine);
        lobe * (1.0 + self.alpha * cosine * cosine) / norm
    }
}
