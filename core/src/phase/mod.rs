//! Phase functions: where a collision sends light.
//!
//! Each file has one as a trio of `eval` (which is also the density of its sampling), `sample` and
//! `invert`, all of the cosine between the directions of travel before and after: forward is +1.
//! Every one is normalised over the sphere [1/sr]. Blends take their lobe from the same u, so a cosine
//! has several; their `invert` asks which, and `cumulative` is the distribution function. The registry
//! [`for_each_phase`](crate::for_each_phase) names all for tests and benches.

pub mod draine;
pub mod henyey_greenstein;
pub mod isotropic;
pub mod mie_fit;
pub mod rayleigh;
pub mod tabulated;
pub mod two_lobe;

/// Calls `$row!(name)` for each file of this folder.
#[macro_export]
macro_rules! for_each_phase {
    ($row:ident) => {
        $row!(isotropic);
        $row!(henyey_greenstein);
        $row!(rayleigh);
        $row!(two_lobe);
        $row!(draine);
        $row!(mie_fit);
        $row!(tabulated);
    };
}

use crate::real::Real;

/// 1/(4π).
pub const INV_4PI: f32 = 0.079_577_47;

/// A phase function of any kind, with its parameters per lane.
#[derive(Clone, Copy, Debug)]
pub struct Phase<R: Real> {
    /// Mean cosine of Henyey–Greenstein, −1 < g < 1; zero is isotropic.
    pub g: R,
    /// Lanes that follow Rayleigh's law instead.
    pub rayleigh: R::Mask,
}

impl<R: Real> Phase<R> {
    /// Density of the cosine over the sphere [1/sr]. `ANY_RAYLEIGH` false drops that law's code.
    #[inline(always)]
    pub fn eval<const ANY_RAYLEIGH: bool>(&self, cos_theta: R) -> R {
        let hg = henyey_greenstein::eval(cos_theta, self.g);
        if ANY_RAYLEIGH {
            R::select(self.rayleigh, rayleigh::eval(cos_theta), hg)
        } else {
            hg
        }
    }

    /// The cosine at a uniform number in [0, 1).
    #[inline(always)]
    pub fn sample<const ANY_RAYLEIGH: bool>(&self, u: R) -> R {
        let hg = henyey_greenstein::sample(u, self.g);
        if ANY_RAYLEIGH {
            R::select(self.rayleigh, rayleigh::sample(u), hg)
        } else {
            hg
        }
    }

    /// `if_true` where the mask holds, else `if_false`.
    #[inline(always)]
    pub fn select(mask: R::Mask, if_true: &Self, if_false: &Self) -> Self {
        Self {
            g: R::select(mask, if_true.g, if_false.g),
            rayleigh: (if_true.rayleigh & mask) | (if_false.rayleigh & !mask),
        }
    }
}
