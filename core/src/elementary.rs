//! Logarithms, exponentials, sine and cosine from correctly rounded operations and bit patterns.
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
//! | [`ln_1p`] | above −1 | ≤ 0.96 ulp |
//! | [`neg_ln_1m`] | 0 ≤ u < 1 | ≤ 0.89 ulp |
//! | [`exp`] | −87.3 ≤ x ≤ 88.7 | ≤ 0.99 ulp |
//! | [`exp_m1`] | x ≤ 88.7 | ≤ 1.17 ulp |
//! | [`turn_of`] | y ≥ 0 | ≤ 2.9 ulp where x ≥ 0 |
//! | [`sin_cos_turn`] | −4096 ≤ turn ≤ 4096 | ≤ 1.56 ulp, or 4.7e-8 absolute where the value is below ½ |

use crate::real::{Binary32, Real, Word};

/// `2/3` as bits: the lower end of the interval [2/3, 4/3] that a logarithm's argument is scaled to.
const TWO_THIRDS: u32 = 0x3f2a_aaab;
/// ln 2 in two parts; the high one has 9 trailing zero bits, so its multiples by exponents are exact.
const LN2_HIGH: f32 = 0.693_145_75;
const LN2_LOW: f32 = 1.428_606_8e-6;
/// Adding 1.5 · 2²³ rounds to an integer and leaves it in the low bits.
const ROUND: f32 = 12_582_912.0;

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

/// `ln(1 + f) + low` for f in [−1/3, 1/3] and a low part that is small beside it.
#[inline(always)]
fn with_tail<R: Binary32>(f: R, low: R) -> R {
    f + (ln_1p_tail(f) + low)
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
    let exponent = exponent_near_one(scaled);
    let mantissa = R::from_bits(scaled.to_bits() - exponent.shl(23));
    let f = mantissa - R::one();
    let k = R::from_word(exponent) + shift;
    k * R::splat(LN2_HIGH) + with_tail(f, k * R::splat(LN2_LOW))
}

/// `ln(1 + x)`, with all its digits where x is small.
///
/// * `x`: per lane, above −1 and finite; −1 gives a large negative number, smaller numbers and NaN
///   give any number.
///
/// With s = 2⁻ᵏ that brings 1 + x into [2/3, 4/3], f = s (1 + x) − 1 is formed as (s − 1) + s x.
/// That is exact but for 1/3 < x < 1/2, where f = x/2 − 1/2 has 25 bits. The lost one [Dekker 1971]
/// enters through ln′ = 1/(1 + f), which is 4/3 … 3/2 there. From k = 25 on, s − 1 rounds to −1, and
/// x is all that counts. Error at most 0.96 ulp.
#[inline(always)]
pub fn ln_1p<R: Binary32>(x: R) -> R {
    let exponent = exponent_near_one(R::one() + x);
    let k = R::from_word(exponent);
    // Where 2⁻ᵏ has no normal number, it is as good as zero, and s x comes from the bits of x.
    let less_one = inverse_power::<R>(exponent).max(R::zero()) - R::one();
    let scaled = R::from_bits(x.to_bits() - exponent.shl(23));
    let f = less_one + scaled;
    let lost = scaled - (f - less_one);
    let low = k * R::splat(LN2_LOW) + lost * R::splat(17.0 / 12.0);
    k * R::splat(LN2_HIGH) + with_tail(f, low)
}

/// `−ln(1 − u)`: the free flight, in mean free paths, that a uniform number stands for.
///
/// * `u`: per lane, 0 ≤ u < 1.
///
/// The rounding of 1 − u would cost short flights all their digits. So 1 − u is scaled by s = 2ᵏ
/// into [2/3, 4/3], and f = s (1 − u) − 1 is formed as (s − 1) − s u, which is exact for every
/// `f32` u: at s = 1 it is −u, and elsewhere s u lies within a factor of two of s − 1 (Sterbenz).
/// Error at most 0.89 ulp, relative, down to the smallest u.
#[inline(always)]
pub fn neg_ln_1m<R: Binary32>(u: R) -> R {
    let exponent = exponent_near_one(R::one() - u);
    let scale = inverse_power::<R>(exponent);
    let f = (scale - R::one()) - scale * u;
    let k = R::from_word(exponent);
    (R::zero() - k) * R::splat(LN2_HIGH) - with_tail(f, k * R::splat(LN2_LOW))
}

/// The k for which x · 2⁻ᵏ lies in [2/3, 4/3], of a positive x, as a signed word.
#[inline(always)]
fn exponent_near_one<R: Binary32>(x: R) -> R::Word {
    (x.to_bits() - R::Word::splat(TWO_THIRDS)).shr_signed(23)
}

/// `2⁻ᵏ` for −127 ≤ k ≤ 126, zero for k = 127, a negative number beyond, down to k = 254.
#[inline(always)]
fn inverse_power<R: Binary32>(k: R::Word) -> R {
    R::from_bits(R::one().to_bits() - k.shl(23))
}

/// Exponential.
///
/// * `x`: per lane. Above 88.72 the result is infinite, below −103.97 zero, between that and −87.3
///   subnormal; NaN gives any number.
///
/// Error at most 0.99 ulp on −87.3 ≤ x ≤ 88.7.
#[inline(always)]
pub fn exp<R: Binary32>(x: R) -> R {
    // Beyond these the powers of two below are none any more.
    let (high, low, n) = exp_parts(x.max(R::splat(-126.0)).min(R::splat(126.0)));
    let r = high - low;
    times_power(R::one() + (r + exp_tail(r)), n)
}

/// `eˣ − 1`, with all its digits where x is small.
///
/// * `x`: per lane. Below −17.4 the result is −1, above 88.72 infinite; NaN gives any number.
///
/// ```text
/// eˣ − 1 = 2ⁿ ((1 − 2⁻ⁿ) + (eʳ − 1)),   x = n ln 2 + r
/// ```
///
/// The sum 1 − 2⁻ⁿ + r is rounded to a. What a lacks joins the small terms; it is known exactly, as
/// |r| < ½ ≤ |1 − 2⁻ⁿ| or n = 0 [Dekker 1971]. Error at most 1.17 ulp, just above x = ½ ln 2, where
/// the polynomial, that of [`exp`], has 0.15 ulp of it.
#[inline(always)]
pub fn exp_m1<R: Binary32>(x: R) -> R {
    // Below −17.4 nothing changes any more, and 2⁻ⁿ should not leave the numbers either.
    let (high, low, n) = exp_parts(x.max(R::splat(-26.0)).min(R::splat(126.0)));
    let less_power = R::one() - inverse_power::<R>(n).max(R::zero());
    let a = less_power + high;
    let lost = high - (a - less_power);
    times_power(a + (exp_tail(high - low) + (lost - low)), n)
}

/// `x = n ln 2 + high − low` with |high − low| ≤ ½ ln 2: high, low, and n as a signed word.
#[inline(always)]
fn exp_parts<R: Binary32>(x: R) -> (R, R, R::Word) {
    let rounded = x * R::splat(core::f32::consts::LOG2_E) + R::splat(ROUND);
    let n = rounded - R::splat(ROUND);
    let high = x - n * R::splat(LN2_HIGH);
    let word = rounded.to_bits() - R::splat(ROUND).to_bits();
    (high, n * R::splat(LN2_LOW), word)
}

/// `eʳ − 1 − r` for |r| ≤ ½ ln 2.
#[inline(always)]
fn exp_tail<R: Binary32>(r: R) -> R {
    const P: [f32; 5] = [
        0.499_999_94,
        0.166_665_21,
        0.041_668_266,
        0.008_368_676,
        0.001_382_069,
    ];
    r * r * horner(r, &P)
}

/// `y · 2ⁿ`, in two factors, as n may lie outside the exponents of normal numbers.
#[inline(always)]
fn times_power<R: Binary32>(y: R, n: R::Word) -> R {
    let half = n.shr_signed(1);
    let bias = R::one().to_bits();
    let first = R::from_bits(bias + half.shl(23));
    let second = R::from_bits(bias + (n - half).shl(23));
    y * first * second
}

/// Sine and cosine of 2π · `turn`.
///
/// * `turn`: per lane, −4096 ≤ turn ≤ 4096; quarter turns are exact.
#[inline(always)]
pub fn sin_cos_turn<R: Binary32>(turn: R) -> (R, R) {
    const SIN: [f32; 4] = [6.283_185_5, -41.341_866, 81.625_626, -76.774_956];
    const COS: [f32; 4] = [-19.739_208, 64.939_15, -85.424_52, 58.621_06];
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

/// The angle of the point (x, y), y ≥ 0, as a fraction of a full turn: in [0, ½].
///
/// * `y`, `x`: per lane, not both infinite. Of (0, 0) the angle is 0.
///
/// The smaller coordinate over the larger goes through a series for one eighth of a turn.
#[inline(always)]
pub fn turn_of<R: Real>(y: R, x: R) -> R {
    const ATAN: [f32; 9] = [
        0.159_154_94,
        -0.053_050_697,
        0.031_807_464,
        -0.022_508_092,
        0.016_539_78,
        -0.011_076_763,
        0.005_746_972_7,
        -0.001_899_968_7,
        0.000_286_362_6,
    ];
    let size = x.abs();
    let steep = size.lt(y);
    let (low, high) = (size.min(y), size.max(y));
    let ratio = low / high.max(R::splat(f32::MIN_POSITIVE));
    let eighth = ratio * horner(ratio * ratio, &ATAN);
    let quarter = R::select(steep, R::splat(0.25) - eighth, eighth);
    R::select(x.lt(R::zero()), R::splat(0.5) - quarter, quarter)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exact_points() {
        assert_eq!(ln(1.0_f32), 0.0);
        assert_eq!(exp(0.0_f32), 1.0);
        assert_eq!(neg_ln_1m(0.0_f32), 0.0);
        assert_eq!(ln_1p(0.0_f32), 0.0);
        assert_eq!(ln_1p(1.0_f32), ln(2.0_f32));
        assert_eq!(exp_m1(0.0_f32), 0.0);
        assert_eq!(exp_m1(f32::NEG_INFINITY), -1.0);
        assert_eq!(sin_cos_turn(0.25_f32), (1.0, 0.0));
        assert_eq!(sin_cos_turn(0.5_f32).1, -1.0);
        assert_eq!(sin_cos_turn(0.0_f32), (0.0, 1.0));
        assert!(!ln(0.0_f32).is_nan());
        assert!(ln_1p(-1.0_f32) < -80.0);
    }
}
