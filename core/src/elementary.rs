//! `ln`, `exp` and `sin_cos` from correctly rounded additions, multiplications and bit patterns.
//!
//! Library versions differ in the last bits between platforms, lane widths and target features;
//! these do not, because each is one fixed sequence of IEEE operations over [`Binary32`]. The
//! coefficients are minimax fits (Lawson iteration on Chebyshev nodes, rounded to `f32` one at a
//! time, the rest refitted after each rounding). Bounds in units in the last place, over all `f32`
//! of the stated domain (`tests/tests/estimators/elementary.rs` enumerates them):
//!
//! | function | domain | error |
//! |---|---|---|
//! | [`ln`] | positive, subnormals included | ≤ 0.96 ulp |
//! | [`neg_ln_1m`] | 0 ≤ u < 1 | ≤ 0.9 ulp |
//! | [`exp`] | −87.3 ≤ x ≤ 88.7 | ≤ 1.0 ulp |
//! | [`sin_cos_turn`] | −4096 ≤ turn ≤ 4096 | ≤ 2 ulp, or 6e-8 absolute where the value is small |

use crate::real::{Binary32, Real, Word};

/// `2/3` as bits: the lower end of the interval [2/3, 4/3] that a logarithm's argument is scaled to.
const TWO_THIRDS: u32 = 0x3f2a_aaab;
/// ln 2 in two parts; the high one has 9 trailing zero bits, so its multiples by exponents are exact.
const LN2_HIGH: f32 = 0.693_145_75;
const LN2_LOW: f32 = 1.428_606_8e-6;

/// `ln(1 + f) − f` for f in [−1/3, 1/3], relative to ln(1 + f) within 5e-9.
#[inline(always)]
fn ln_1p_tail<R: Binary32>(f: R) -> R {
    const Q: [f32; 9] = [
        -0.5,
        0.333_332_15,
        -0.249_998_02,
        0.200_104_45,
        -0.166_803_29,
        0.140_053_26,
        -0.121_862_076,
        0.139_868_66,
        -0.128_840_01,
    ];
    f * f * horner(f, &Q)
}

/// `c[0] + x (c[1] + x (c[2] + …))`.
#[inline(always)]
fn horner<R: Real, const N: usize>(x: R, c: &[f32; N]) -> R {
    let mut sum = R::splat(c[N - 1]);
    let mut i = N - 1;
    while i > 0 {
        i -= 1;
        sum = sum * x + R::splat(c[i]);
    }
    sum
}

/// Natural logarithm.
///
/// * `x`: per lane, positive and finite; zero gives a large negative number, negative numbers and
///   NaN give any number.
///
/// Error at most 0.96 ulp; subnormals are scaled first and lose nothing.
#[inline(always)]
pub fn ln<R: Binary32>(x: R) -> R {
    let tiny = x.lt(R::splat(f32::MIN_POSITIVE));
    let scaled = R::select(tiny, x * R::splat(8_388_608.0), x);
    let shift = R::select(tiny, R::splat(-23.0), R::zero());
    let offset = scaled.to_bits() - R::Word::splat(TWO_THIRDS);
    let exponent = offset.shr_signed(23);
    let mantissa = R::from_bits(scaled.to_bits() - exponent.shl(23));
    let f = mantissa - R::one();
    let k = R::from_word(exponent) + shift;
    k * R::splat(LN2_HIGH) + (f + (ln_1p_tail(f) + k * R::splat(LN2_LOW)))
}

/// `−ln(1 − u)`: the free flight, in mean free paths, that a uniform number stands for.
///
/// * `u`: per lane, 0 ≤ u < 1.
///
/// The rounding of 1 − u would cost short flights all their digits. So 1 − u is scaled by s = 2ᵏ
/// into [2/3, 4/3], and f = s (1 − u) − 1 is formed as (s − 1) − s u, which is exact for every
/// `f32` u: at s = 1 it is −u, and elsewhere s u lies within a factor of two of s − 1 (Sterbenz).
/// Error at most 0.9 ulp, relative, down to the smallest u.
#[inline(always)]
pub fn neg_ln_1m<R: Binary32>(u: R) -> R {
    let rest = R::one() - u;
    let exponent = (rest.to_bits() - R::Word::splat(TWO_THIRDS)).shr_signed(23);
    let scale = R::from_bits(R::one().to_bits() - exponent.shl(23));
    let f = (scale - R::one()) - scale * u;
    let k = R::zero() - R::from_word(exponent);
    k * R::splat(LN2_HIGH) - (f + (ln_1p_tail(f) - k * R::splat(LN2_LOW)))
}

/// Exponential.
///
/// * `x`: per lane. Above 88.72 the result is infinite, below −103.97 zero, between that and −87.3
///   subnormal; NaN gives any number.
///
/// Error at most 1.0 ulp on −87.3 ≤ x ≤ 88.7.
#[inline(always)]
pub fn exp<R: Binary32>(x: R) -> R {
    const P: [f32; 5] = [
        0.499_999_94,
        0.166_665_21,
        0.041_668_266,
        0.008_368_676,
        0.001_382_069,
    ];
    // Adding 1.5 · 2²³ rounds to an integer and leaves it in the low bits.
    const ROUND: f32 = 12_582_912.0;
    // Beyond these the scale below is no power of two any more.
    let x = x.max(R::splat(-126.0)).min(R::splat(126.0));
    let rounded = x * R::splat(core::f32::consts::LOG2_E) + R::splat(ROUND);
    let n = rounded - R::splat(ROUND);
    let r = (x - n * R::splat(LN2_HIGH)) - n * R::splat(LN2_LOW);
    let y = R::one() + (r + r * r * horner(r, &P));
    // 2ⁿ in two factors, as n may lie outside the exponents of normal numbers.
    let n_bits = rounded.to_bits() - R::splat(ROUND).to_bits();
    let half = n_bits.shr_signed(1);
    let bias = R::one().to_bits();
    let first = R::from_bits(bias + half.shl(23));
    let second = R::from_bits(bias + (n_bits - half).shl(23));
    y * first * second
}

/// Sine and cosine of 2π · `turn`.
///
/// * `turn`: per lane, −4096 ≤ turn ≤ 4096; quarter turns are exact.
#[inline(always)]
pub fn sin_cos_turn<R: Binary32>(turn: R) -> (R, R) {
    const SIN: [f32; 4] = [6.283_185_5, -41.341_866, 81.625_626, -76.774_956];
    const COS: [f32; 4] = [-19.739_208, 64.939_15, -85.424_52, 58.621_06];
    const ROUND: f32 = 12_582_912.0;
    let rounded = turn * R::splat(4.0) + R::splat(ROUND);
    let quarter = rounded.to_bits();
    let r = turn - (rounded - R::splat(ROUND)) * R::splat(0.25);
    let rr = r * r;
    let s = r * horner(rr, &SIN);
    let c = R::one() + rr * horner(rr, &COS);
    let word = |bits: u32| R::Word::splat(bits);
    let swap = !(quarter & word(1)).eq(word(0));
    // The sine turns negative in the third and fourth quarter, the cosine in the second and third.
    let sin_sign = (quarter & word(2)).shl(30);
    let cos_sign = ((quarter + word(1)) & word(2)).shl(30);
    let sin = R::select(swap, c, s);
    let cos = R::select(swap, s, c);
    (
        R::from_bits(sin.to_bits() ^ sin_sign),
        R::from_bits(cos.to_bits() ^ cos_sign),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exact_points() {
        assert_eq!(ln(1.0_f32), 0.0);
        assert_eq!(exp(0.0_f32), 1.0);
        assert_eq!(neg_ln_1m(0.0_f32), 0.0);
        assert_eq!(sin_cos_turn(0.25_f32), (1.0, 0.0));
        assert_eq!(sin_cos_turn(0.5_f32).1, -1.0);
        assert_eq!(sin_cos_turn(0.0_f32), (0.0, 1.0));
        assert!(!ln(0.0_f32).is_nan());
    }
}
