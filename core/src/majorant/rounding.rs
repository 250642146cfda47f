//! How far rounding carries an interpolant beyond the samples that it is made of.
//!
//! Interpolation is a mean of samples, so without rounding it stays between the smallest, m, and the
//! largest, M. In `f32`, with u = 2⁻²⁴ and the smallest positive number δ = 2⁻¹⁴⁹, one step
//!
//! ```text
//! lerp(w, a, b) = a ⊗ (1 ⊖ w) ⊕ b ⊗ w,   0 ≤ w < 1 exact,   0 ≤ a, b ≤ M
//! ```
//!
//! errs like this. The subtraction is exact for w ≥ ½ (Sterbenz); below, its result lies in (½, 1] and
//! errs by at most u/2, so that the two weights add up to at most 1 + u/2. A product errs by a factor
//! of at most 1 + u, or where it underflows by at most δ/2. The sum errs by at most 1 + u, and not at
//! all where it is subnormal. Three steps, one an axis, give
//!
//! ```text
//! lerp   ≤ (1 + u) ((1 + u) (1 + u/2) M + δ)
//! lerp³  ≤ (1 + u)⁶ (1 + u/2)³ M + 3δ (1 + 6u)  ≤  M (1 + 8u) + 3δ
//! ```
//!
//! for (1 + u)⁶ (1 + u/2)³ < 1 + 7.6u, and 18uδ fits in what is left, 0.4uM, from M = 45δ on; below
//! that the result is a multiple of δ and 18uδ cannot add one. The same steps downwards end at
//! M (1 − 8u) − 3δ. Zero everywhere stays zero. A look-up is then multiplied by the grid's scale, and so
//! is its bound; rounding is monotone, so their order stays. One-tap look-ups are samples: within.
//!
//! Bounds are made with 16u and 4δ, twice what they must prove, which leaves room for their own rounding.

/// 8u: what is proved.
const PROVED: f64 = 1.0 / 2_097_152.0;
/// 16u: what bounds are made with.
const MADE: f32 = 1.0 / 1_048_576.0;
/// δ.
const TINIEST: f32 = f32::from_bits(1);

/// The largest sample: the bound on it is still finite.
pub(super) const LARGEST: f32 = 3.4e38;

/// No interpolant of samples up to `largest` exceeds this.
///
/// Exact but for a rounding of 2⁻⁵³: the product has 46 significant bits.
#[inline(always)]
pub(super) fn highest(largest: f32) -> f64 {
    let largest = f64::from(largest);
    if largest > 0.0 {
        largest * (1.0 + PROVED) + 3.0 * f64::from(TINIEST)
    } else {
        0.0
    }
}

/// No interpolant of samples from `smallest` on falls below this, nor below zero.
#[inline(always)]
pub(super) fn lowest(smallest: f32) -> f64 {
    let smallest = f64::from(smallest);
    (smallest * (1.0 - PROVED) - 3.0 * f64::from(TINIEST)).max(0.0)
}

/// A bound from above: at least [`highest`], finite for samples up to [`LARGEST`].
#[inline(always)]
pub(super) fn majorant(largest: f32) -> f32 {
    if largest > 0.0 {
        largest * (1.0 + MADE) + 4.0 * TINIEST
    } else {
        0.0
    }
}

/// A bound from below: at most [`lowest`], not negative.
#[inline(always)]
pub(super) fn minorant(smallest: f32) -> f32 {
    (smallest * (1.0 - MADE) - 4.0 * TINIEST).max(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every exponent, with mantissas at both ends, in the middle and anywhere.
    fn magnitudes() -> impl Iterator<Item = f32> {
        let mut noise = 0x9e37_79b9_u32;
        (0..255_u32).flat_map(move |exponent| {
            core::array::from_fn::<u32, 300, _>(|i| {
                noise = noise.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                let mantissa = match i {
                    0..100 => i as u32,
                    100..200 => 0x7f_ffff - (i as u32 - 100),
                    _ => noise >> 9,
                };
                exponent << 23 | mantissa
            })
            .map(f32::from_bits)
        })
    }

    #[test]
    fn what_is_made_can_be_proved() {
        let mut tested = 0;
        for sample in magnitudes().filter(|&s| s <= LARGEST) {
            let (above, below) = (majorant(sample), minorant(sample));
            let proved = above.is_finite() && f64::from(above) >= highest(sample);
            assert!(proved, "{sample:e}: {above:e}");
            let proved = below >= 0.0 && f64::from(below) <= lowest(sample);
            assert!(proved, "{sample:e}: {below:e}");
            // And not much wider than that.
            let close = f64::from(sample) * 1.2e-6 + 8.0 * f64::from(TINIEST);
            assert!(
                f64::from(above) - f64::from(sample) <= close,
                "{sample:e}: {above:e}"
            );
            assert!(
                f64::from(sample) - f64::from(below) <= close,
                "{sample:e}: {below:e}"
            );
            tested += 1;
        }
        assert!(tested > 70_000, "{tested}");
        assert_eq!((majorant(0.0), majorant(-0.0)), (0.0, 0.0));
        assert_eq!(minorant(0.0), 0.0);
    }
}
