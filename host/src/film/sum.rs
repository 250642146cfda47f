//! A sum that no order changes: three 32-bit digits, each with its own 64-bit accumulator.
//!
//! ```text
//! S = Σᵢ xᵢ ≈ D₂·2^(32 e) + D₁·2^(32 (e−1)) + D₀·2^(32 (e−2)),   e = ⌊log₂(max |xᵢ|) / 32⌋
//! ```
//!
//! Every sample is cut at fixed positions of the binary point (multiples of 32 bits), so a digit of the sum is
//! an integer sum of digits of samples: exact, commutative, associative. Only three digits are kept, those at
//! and below the leading digit of the *largest* sample. Which digits survive depends on the set of samples and not
//! on their order, because carries are not propagated until the sum is read; hence threads, tiles, passes and
//! shards give the same bits.
//!
//! * Range: every finite `f32` and the square of every finite `f32`; nothing overflows or underflows.
//! * Error: at least 64 bits below the leading bit of the largest term are kept, so of `n` terms of one sign at most
//!   n · 2⁻⁶⁴ of the sum is lost. Samples within a factor 2⁴⁰ of each other (zeros aside) lose nothing, squares
//!   of samples within a factor 2⁸ neither.
//! * Capacity: [`CAPACITY`] samples.
//! * Cost: 28 bytes; adding is a shift and three integer additions.
//!
//! The idea of fixed cuts anchored at the maximum is that of reproducible floating-point summation
//! [Demmel, Nguyen 2015]; integers replace their floating-point bins.

/// The most samples one sum may hold: each adds less than 2³² to an accumulator of 63 bits.
pub const CAPACITY: u32 = i32::MAX as u32;

/// No sample yet that is not zero. Below every digit of a squared `f32`, whose lowest is −10.
const EMPTY: i8 = i8::MIN;

/// An `i64` that needs no alignment to 8 bytes: low and high half.
type Halves = [u32; 2];

const fn join([low, high]: Halves) -> i64 {
    (low as u64 | (high as u64) << 32) as i64
}

const fn halve(x: i64) -> Halves {
    [x as u32, (x >> 32) as u32]
}

/// Sums of numbers side by side, if `f64` holds each and every sum of the first of them; those of samples of like size
/// nearly always.
#[inline]
pub(super) fn exact_sums<const N: usize>(
    numbers: impl Iterator<Item = [f32; N]>,
) -> Option<[f64; N]> {
    let (mut sums, mut lost) = ([0.0_f64; N], [0.0_f64; N]);
    for number in numbers {
        for ((sum, lost), number) in sums.iter_mut().zip(&mut lost).zip(number) {
            // What an addition loses is itself a number, found without error [Knuth 1997].
            let x = f64::from(number);
            let next = *sum + x;
            let of_x = next - *sum;
            *lost += ((*sum - (next - of_x)) + (x - of_x)).abs();
            *sum = next;
        }
    }
    // Not finite: lost is NaN.
    lost.iter().all(|lost| *lost == 0.0).then_some(sums)
}

/// An order-independent sum of `f32` samples or of their squares (module documentation).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BinnedSum {
    /// Accumulators of the digits `top − 2`, `top − 1`, `top`; halves, because an `i64` would pad this to 32 bytes.
    digits: [Halves; 3],
    /// Position of the leading digit, in units of 32 bits.
    top: i8,
}

impl Default for BinnedSum {
    fn default() -> Self {
        Self::new()
    }
}

impl BinnedSum {
    /// The empty sum.
    pub const fn new() -> Self {
        Self {
            digits: [[0; 2]; 3],
            top: EMPTY,
        }
    }

    /// Adds a finite sample.
    #[inline]
    pub fn add(&mut self, x: f32) {
        let (mantissa, exponent) = split(x);
        self.add_scaled(u64::from(mantissa), exponent, x.is_sign_negative());
    }

    /// Adds the sum of several finite samples, if it has been found without rounding.
    #[inline]
    pub fn add_exact(&mut self, sum: f64) {
        let bits = sum.to_bits();
        let exponent = ((bits >> 52) & 0x7ff) as i32;
        if exponent == 0 {
            return; // zero: sums of f32 are never as small as the subnormal f64
        }
        let mantissa = (bits & ((1 << 52) - 1)) | (1 << 52);
        self.add_scaled(mantissa, exponent - 1075, sum.is_sign_negative());
    }

    /// Adds the exact square of a finite sample.
    #[inline]
    pub fn add_square(&mut self, x: f32) {
        let (mantissa, exponent) = split(x);
        let mantissa = u64::from(mantissa);
        self.add_scaled(mantissa * mantissa, 2 * exponent, false);
    }

    /// Adds `mantissa · 2^exponent`, negated if asked; `mantissa` below 2⁵³.
    #[inline]
    fn add_scaled(&mut self, mantissa: u64, exponent: i32, negative: bool) {
        if mantissa == 0 {
            return;
        }
        // At most 255 / 32 = 7 and at least −298 / 32 → −10: an `i8` holds it.
        let top = ((exponent + mantissa.ilog2() as i32) >> 5) as i8;
        if top > self.top {
            self.raise(top);
        }
        let shift = exponent - 32 * (i32::from(self.top) - 2);
        let aligned = if shift >= 0 {
            u128::from(mantissa) << shift // below 2^96: the leading bit lies in digit `top` or lower
        } else {
            // Whole digits below the window are dropped, and only those: the window starts at a cut.
            u128::from(mantissa.checked_shr(shift.unsigned_abs()).unwrap_or(0))
        };
        let sign = if negative { -1 } else { 1 };
        for (digit, part) in self.digits.iter_mut().zip([0, 32, 64]) {
            *digit = halve(join(*digit) + sign * i64::from((aligned >> part) as u32));
        }
    }

    /// Moves the window up so that its leading digit is `top`.
    fn raise(&mut self, top: i8) {
        let [_, d1, d2] = self.digits;
        self.digits = match top.saturating_sub(self.top) {
            0 => self.digits,
            1 => [d1, d2, [0; 2]],
            2 => [d2, [0; 2], [0; 2]],
            _ => [[0; 2]; 3],
        };
        self.top = top;
    }

    /// Adds another sum. Exact: merging parts in any grouping gives the bits of adding every sample to one sum.
    ///
    /// Both together may hold [`CAPACITY`] samples; the caller counts.
    pub fn merge(&mut self, other: &Self) {
        let mut other = *other;
        if other.top > self.top {
            self.raise(other.top);
        } else {
            other.raise(self.top);
        }
        for (digit, part) in self.digits.iter_mut().zip(other.digits) {
            *digit = halve(join(*digit) + join(part));
        }
    }

    /// The sum as `(integer, exponent)`, meaning `integer · 2^exponent`, without rounding.
    pub(super) fn exact(&self) -> (i128, i32) {
        if self.top == EMPTY {
            return (0, 0);
        }
        // |D₂| · 2^64 < 2^127 − 2^95 leaves room for the other two.
        let [d0, d1, d2] = self.digits.map(|digit| i128::from(join(digit)));
        let integer = (d2 << 64) + (d1 << 32) + d0;
        (integer, 32 * (i32::from(self.top) - 2))
    }

    /// The sum, rounded once to the nearest `f64`.
    pub fn value(&self) -> f64 {
        let (integer, exponent) = self.exact();
        integer as f64 * power_of_two(exponent)
    }
}

/// A finite `x` as `(mantissa, exponent)`: |x| = mantissa · 2^exponent, mantissa below 2²⁴.
#[inline]
fn split(x: f32) -> (u32, i32) {
    debug_assert!(x.is_finite(), "a film sum takes finite samples");
    let bits = x.to_bits();
    let fraction = bits & 0x007f_ffff;
    match ((bits >> 23) & 0xff) as i32 {
        0 => (fraction, -149),
        biased => (fraction | 0x0080_0000, biased - 150),
    }
}

/// 2^exponent for exponents of a normal `f64`, −1022 to 1023.
pub(super) fn power_of_two(exponent: i32) -> f64 {
    debug_assert!((-1022..=1023).contains(&exponent));
    f64::from_bits(((exponent + 1023) as u64) << 52)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sum(samples: &[f32]) -> BinnedSum {
        let mut s = BinnedSum::new();
        samples.iter().for_each(|&x| s.add(x));
        s
    }

    fn squares(samples: &[f32]) -> BinnedSum {
        let mut s = BinnedSum::new();
        samples.iter().for_each(|&x| s.add_square(x));
        s
    }

    #[test]
    fn a_single_sample_is_exact_over_the_whole_range_of_f32() {
        let mut bits = 1_u32;
        while bits < f32::INFINITY.to_bits() {
            for x in [f32::from_bits(bits), -f32::from_bits(bits)] {
                assert_eq!(sum(&[x]).value(), f64::from(x));
                let square = f64::from(x) * f64::from(x); // 48 bits: exact in f64
                assert_eq!(squares(&[x]).value(), square);
            }
            bits = bits.wrapping_mul(3) / 2 + 1;
        }
        assert_eq!(sum(&[f32::MAX]).value(), f64::from(f32::MAX));
        assert_eq!(sum(&[]).value(), 0.0);
        assert_eq!(sum(&[0.0, -0.0]), BinnedSum::new());
    }

    #[test]
    fn every_order_and_grouping_gives_the_same_bits() {
        // Six digits apart, both signs, subnormals: the window moves, and must drop the same digits always.
        let samples = [
            1.5e-42, 3.0e30, -7.0e-9, 1.0, 2.5e12, -2.5e12, 1.0e-30, 4.0e9,
        ];
        let forward = sum(&samples);
        let forward_squares = squares(&samples);
        // Heap's algorithm, all 40320 orders.
        let mut order = samples;
        let mut counters = [0; 8];
        let mut i = 0;
        while i < 8 {
            if counters[i] < i {
                order.swap(if i % 2 == 0 { 0 } else { counters[i] }, i);
                assert_eq!(sum(&order), forward);
                assert_eq!(squares(&order), forward_squares);
                counters[i] += 1;
                i = 0;
            } else {
                counters[i] = 0;
                i += 1;
            }
        }
        for cut in 0..=8 {
            let (a, b) = samples.split_at(cut);
            for (first, second) in [(a, b), (b, a)] {
                let mut merged = sum(first);
                merged.merge(&sum(second));
                assert_eq!(merged, forward);
            }
        }
    }

    #[test]
    fn cancellation_is_exact_within_the_window() {
        assert_eq!(sum(&[1.0e12, 1.0, -1.0e12]).value(), 1.0);
        // Beyond 64 bits below the largest sample digits go, whatever the order.
        assert_eq!(sum(&[1.0e38, 1.0e-20, -1.0e38]).value(), 0.0);
        assert_eq!(sum(&[1.0e-20, 1.0e38, -1.0e38]).value(), 0.0);
    }

    #[test]
    fn four_million_samples_do_not_drift() {
        // 0.1 in f32 loses percents when summed in f32; here the sum is n · f64(0.1f32), exactly.
        let n = 1_u32 << 22;
        let mut s = BinnedSum::new();
        for _ in 0..n {
            s.add(0.1);
        }
        assert_eq!(s.value(), f64::from(n) * f64::from(0.1_f32));
    }

    #[test]
    fn the_capacity_holds_the_largest_digits() {
        // One digit full of ones, CAPACITY times, by doubling.
        let x = f32::from_bits(0x4f7f_ffff); // 2^32 − 2^8
        let mut s = BinnedSum::new();
        let mut part = sum(&[x]);
        for bit in 0..31 {
            if (CAPACITY >> bit) & 1 == 1 {
                s.merge(&part);
            }
            if bit < 30 {
                let twin = part;
                part.merge(&twin);
            }
        }
        assert_eq!(s.value(), f64::from(CAPACITY) * f64::from(x));
    }
}
