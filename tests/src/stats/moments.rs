//! Count, mean and spread of a stream of numbers, in one pass and in `f64`.
//!
//! ```text
//! mean ← mean + (x − mean)/n,   M₂ ← M₂ + (x − mean_old)(x − mean_new)
//! ```
//!
//! A running `f32` sum of 10⁵ weights is already wrong in the third digit, and a difference of sums of squares
//! cancels; this recurrence does neither. Partial results merge exactly in the algebra of real numbers, so that
//! threads may share the work. Sources: [Welford 1962], [Chan, Golub, LeVeque 1983].

/// Count, mean, second central moment and range of what was pushed.
///
/// A NaN or an infinity makes mean or variance non-finite and keeps them so: no check accepts that.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moments {
    count: u64,
    mean: f64,
    m2: f64,
    min: f64,
    max: f64,
}

impl Default for Moments {
    fn default() -> Self {
        Self::new()
    }
}

impl Moments {
    /// No numbers yet: mean 0, variance NaN, an empty range.
    pub const fn new() -> Self {
        Self {
            count: 0,
            mean: 0.0,
            m2: 0.0,
            min: f64::INFINITY,
            max: f64::NEG_INFINITY,
        }
    }

    /// Adds one number, in its own unit.
    #[inline]
    pub fn push(&mut self, x: f64) {
        self.count += 1;
        let from_old_mean = x - self.mean;
        self.mean += from_old_mean / self.count as f64;
        self.m2 += from_old_mean * (x - self.mean);
        self.min = self.min.min(x);
        self.max = self.max.max(x);
    }

    /// Adds all numbers of `other`, as if they had been pushed here.
    pub fn merge(&mut self, other: &Self) {
        if other.count == 0 {
            return;
        }
        if self.count == 0 {
            *self = *other;
            return;
        }
        let count = self.count + other.count;
        let between = other.mean - self.mean;
        let share = other.count as f64 / count as f64;
        self.m2 += other.m2 + between * between * share * self.count as f64;
        self.mean += between * share;
        self.count = count;
        self.min = self.min.min(other.min);
        self.max = self.max.max(other.max);
    }

    /// How many numbers were pushed.
    pub const fn count(&self) -> u64 {
        self.count
    }

    /// Arithmetic mean; 0 while empty.
    pub const fn mean(&self) -> f64 {
        self.mean
    }

    /// Smallest number pushed (NaN is skipped); +∞ while empty.
    pub const fn min(&self) -> f64 {
        self.min
    }

    /// Largest number pushed (NaN is skipped); −∞ while empty.
    pub const fn max(&self) -> f64 {
        self.max
    }

    /// Unbiased sample variance M₂/(n − 1), in the square of the unit; NaN below two numbers.
    pub fn variance(&self) -> f64 {
        if self.count < 2 {
            f64::NAN
        } else {
            self.m2 / (self.count - 1) as f64
        }
    }

    /// Estimated standard deviation of the mean, √(variance / n), if the numbers were independent.
    pub fn standard_error(&self) -> f64 {
        (self.variance() / self.count as f64).sqrt()
    }
}

impl Extend<f64> for Moments {
    fn extend<I: IntoIterator<Item = f64>>(&mut self, numbers: I) {
        for x in numbers {
            self.push(x);
        }
    }
}

impl FromIterator<f64> for Moments {
    fn from_iter<I: IntoIterator<Item = f64>>(numbers: I) -> Self {
        let mut moments = Self::new();
        moments.extend(numbers);
        moments
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stats::independent::SplitMix;

    #[test]
    fn a_small_set_by_hand() {
        let m: Moments = [2.0, 4.0, 4.0, 4.0, 5.0, 5.0, 7.0, 9.0]
            .into_iter()
            .collect();
        assert_eq!(m.count(), 8);
        assert_eq!(m.mean(), 5.0);
        assert!((m.variance() - 32.0 / 7.0).abs() < 1e-15);
        assert!((m.standard_error() - (4.0_f64 / 7.0).sqrt()).abs() < 1e-15);
        assert_eq!((m.min(), m.max()), (2.0, 9.0));
    }

    #[test]
    fn too_few_numbers_have_no_variance() {
        assert!(Moments::new().variance().is_nan());
        assert!(Moments::from_iter([3.0]).standard_error().is_nan());
    }

    #[test]
    fn a_large_offset_does_not_cancel() {
        let m: Moments = (0..1000)
            .map(|i| 1e9 + if i % 2 == 0 { 0.5 } else { -0.5 })
            .collect();
        assert!((m.variance() - 0.25 * 1000.0 / 999.0).abs() < 1e-9);
    }

    #[test]
    fn merged_parts_equal_the_whole() {
        let mut rng = SplitMix::new(1);
        let numbers: Vec<f64> = (0..1001).map(|_| rng.exponential()).collect();
        let whole: Moments = numbers.iter().copied().collect();
        let mut merged = Moments::new();
        for part in numbers.chunks(77) {
            merged.merge(&part.iter().copied().collect());
        }
        merged.merge(&Moments::new());
        assert_eq!(merged.count(), whole.count());
        assert!((merged.mean() - whole.mean()).abs() < 1e-14);
        assert!((merged.variance() - whole.variance()).abs() < 1e-13);
        assert_eq!((merged.min(), merged.max()), (whole.min(), whole.max()));
    }

    #[test]
    fn one_nan_spoils_everything_after_it() {
        let m: Moments = [1.0, f64::NAN, 1.0, 1.0].into_iter().collect();
        assert!(m.mean().is_nan() && m.standard_error().is_nan());
    }
}
