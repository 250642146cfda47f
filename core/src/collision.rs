//! What becomes of a tentative collision in colour, and roulette.

use crate::real::{Mask, Real};
use crate::stream::Stream;
use crate::vec3::Vec3;

/// A tentative collision whose extinction differs between colours.
///
/// All colours share the tentative points of one process of rate σ̄ ≥ max σ_λ, so only the decision
/// needs weights. With the *history-aware* probability
///
/// ```text
/// P = Σ w_λ σ_λ / (σ̄ Σ w_λ),   real: w_λ ← w_λ σ_λ/(σ̄ P),   null: w_λ ← w_λ (σ̄ − σ_λ)/(σ̄ (1 − P))
/// ```
///
/// the sum of the weights stays what it was: each is bounded by the number of colours times their
/// mean, which is what the balance heuristic over hero wavelengths achieves as well. Sources:
/// [Kutz 2017], [Miller 2019].
#[derive(Clone, Copy, Debug)]
pub struct Chromatic<R> {
    /// Extinction of the most opaque colour [1/length].
    pub sigma_t: R,
    /// Its bound [1/length].
    pub majorant: R,
    /// Extinction by colour relative to the most opaque, in [0, 1].
    pub colour: Vec3<R>,
}

impl<R: Real> Chromatic<R> {
    /// Whether active lanes collide, and their new weights. One draw.
    ///
    /// * `weight`: per colour and lane, not negative, not all zero.
    #[inline(always)]
    pub fn decide(
        &self,
        weight: Vec3<R>,
        rng: &mut impl Stream<R>,
        active: R::Mask,
    ) -> (R::Mask, Vec3<R>) {
        let coloured = weight.times(self.colour);
        let total = weight.sum();
        let all = self.majorant * total;
        let colliding = self.sigma_t * coloured.sum();
        let real = (rng.uniform_fine(active) * all).lt(colliding) & active;
        let if_real = coloured * (total / coloured.sum());
        let remaining = weight.zip(coloured, |w, c| self.majorant * w - self.sigma_t * c);
        let if_null = remaining * (total / (all - colliding));
        let new = Vec3::select(real, if_real, if_null);
        (real, Vec3::select(active, new, weight))
    }
}

/// Russian roulette: the factor for a weight, 1 at or above the `threshold`, else threshold/weight
/// with probability weight/threshold, or 0. One draw for the active lanes below.
#[inline(always)]
pub fn roulette<R: Real>(weight: R, threshold: R, rng: &mut impl Stream<R>, active: R::Mask) -> R {
    let low = weight.lt(threshold) & R::zero().lt(weight) & active;
    if !low.any() {
        return R::one();
    }
    let survives = (rng.uniform_fine(low) * threshold).lt(weight);
    let factor = R::select(survives, threshold / weight, R::zero());
    R::select(low, factor, R::one())
}
