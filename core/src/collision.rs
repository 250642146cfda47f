//! Roulette: what ends paths that have little left to bring.

use crate::real::{Mask, Real};
use crate::stream::Stream;

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
