//! Two Henyey–Greenstein lobes, as a rule one forward and one backward.
//!
//! ```text
//! p(μ) = w HG(μ; g₁) + (1 − w) HG(μ; g₂),   ⟨μ⟩ = w g₁ + (1 − w) g₂
//! ```
//!
//! One uniform number serves both decisions: u < w takes the first lobe at u/w, else the second at
//! (u − w)/(1 − w). So each lobe is sampled by its own map, to that map's precision, but the cosine is
//! no monotone function of u, and up to two u give the same cosine. Two inverses answer two questions:
//!
//! * [`TwoLobe::cumulative`] is the distribution function P(cosine < μ), for tables and stratification.
//!   Its inverse is *not* the sampling map.
//! * [`TwoLobe::invert`] undoes the sampling: one of the u that give μ, and if its second number is
//!   uniform, then each of them as often as [`TwoLobe::sample`] gets there by it. Cosine and number
//!   together carry as much as u, which is what paths mutated in primary sample space need.
//!
//! A lobe of share w sees the u below w only: its own uniform number is as much coarser than u.
//! Source: [Henyey, Greenstein 1941].

use crate::phase::henyey_greenstein;
use crate::real::Real;

/// Shares and mean cosines, per lane.
#[derive(Clone, Copy, Debug)]
pub struct TwoLobe<R> {
    /// w, the share of the first lobe, in [0, 1].
    pub share: R,
    /// Mean cosine of the first lobe, in (−1, 1).
    pub g1: R,
    /// Mean cosine of the second lobe, in (−1, 1).
    pub g2: R,
}

/// Whether u in [0, 1) falls to the part that has this share, and the uniform number that is left.
#[inline(always)]
pub(super) fn choose<R: Real>(u: R, share: R) -> (R::Mask, R) {
    let first = u.lt(share);
    let below = R::select(first, R::zero(), share);
    let width = R::select(first, share, R::one() - share);
    (first, (u - below) / width)
}

/// A u that [`choose`] sends to part `first` with `rest` left.
#[inline(always)]
pub(super) fn unchoose<R: Real>(first: R::Mask, rest: R, share: R) -> R {
    // A rest of 1 would be the other part's first u.
    let rest = rest.min(R::splat(1.0_f32.next_down()));
    R::select(first, share * rest, share + (R::one() - share) * rest)
}

/// P(cosine < μ) of one lobe.
#[inline(always)]
fn cumulative<R: Real>(cos_theta: R, g: R) -> R {
    let u = henyey_greenstein::invert(cos_theta, g);
    R::select(g.lt(R::zero()), R::one() - u, u)
}

impl<R: Real> TwoLobe<R> {
    #[inline(always)]
    fn blend(&self, first: R, second: R) -> R {
        self.share * first + (R::one() - self.share) * second
    }

    /// Density of a cosine in [−1, 1] over the sphere [1/sr].
    #[inline(always)]
    pub fn eval(&self, cos_theta: R) -> R {
        self.blend(
            henyey_greenstein::eval(cos_theta, self.g1),
            henyey_greenstein::eval(cos_theta, self.g2),
        )
    }

    /// The cosine at u in [0, 1); error of the lobe's own map at the u that is left.
    #[inline(always)]
    pub fn sample(&self, u: R) -> R {
        let (first, rest) = choose(u, self.share);
        henyey_greenstein::sample(rest, R::select(first, self.g1, self.g2))
    }

    /// P(cosine < μ) for μ in [−1, 1]; error at most 8e-7 in `f32`.
    #[inline(always)]
    pub fn cumulative(&self, cos_theta: R) -> R {
        self.blend(
            cumulative(cos_theta, self.g1),
            cumulative(cos_theta, self.g2),
        )
    }

    /// A u of a cosine in [−1, 1]: of the first lobe where `v` in [0, 1) is below that lobe's share of
    /// the density there.
    #[inline(always)]
    pub fn invert(&self, cos_theta: R, v: R) -> R {
        let of_first = self.share * henyey_greenstein::eval(cos_theta, self.g1);
        let first = (v * self.eval(cos_theta)).lt(of_first);
        let g = R::select(first, self.g1, self.g2);
        unchoose(first, henyey_greenstein::invert(cos_theta, g), self.share)
    }

    /// The mean cosine.
    #[inline(always)]
    pub fn mean_cosine(&self) -> R {
        self.blend(self.g1, self.g2)
    }
}
