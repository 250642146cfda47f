//! What a pixel keeps of its samples: their number, sum and sum of squares.
//!
//! ```text
//! mean = S / n,    variance of the mean = (Q − S² / n) / (n (n − 1)),    S = Σ xᵢ,  Q = Σ xᵢ²
//! ```
//!
//! The textbook formula is notorious for cancellation; with exact `S` and `Q` it is the best there is: the
//! difference n Q − S² is formed as a 256-bit integer and rounded once. A pixel whose samples are all equal has
//! variance exactly zero.

use super::sum::{BinnedSum, CAPACITY, power_of_two};

/// Moments of one pixel's samples; the same bits whatever the order in which they came.
///
/// Radiance in the scene's unit [W/(m² sr)], linear Rec. 709; alpha dimensionless.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct PixelMoments {
    samples: u32,
    alpha: BinnedSum,
    radiance: [BinnedSum; 3],
    squares: [BinnedSum; 3],
}

impl PixelMoments {
    /// Adds one camera path: its radiance and its alpha.
    ///
    /// Returns `false`, and leaves the pixel as it was, if a value is not finite: the caller counts it. At most
    /// [`CAPACITY`] samples.
    #[inline]
    #[must_use = "a dropped path is counted, never silent"]
    pub fn add(&mut self, radiance: [f32; 3], alpha: f32) -> bool {
        let finite = self.add_to_mean(radiance, alpha);
        if finite {
            self.add_squares(radiance);
        }
        finite
    }

    /// As [`add`](Self::add), without the squares.
    #[inline]
    #[must_use = "a dropped path is counted, never silent"]
    pub(super) fn add_to_mean(&mut self, radiance: [f32; 3], alpha: f32) -> bool {
        if !(radiance.iter().all(|x| x.is_finite()) && alpha.is_finite()) {
            return false;
        }
        debug_assert!(self.samples < CAPACITY, "a pixel is full");
        self.samples += 1;
        self.alpha.add(alpha);
        for (sum, x) in self.radiance.iter_mut().zip(radiance) {
            sum.add(x);
        }
        true
    }

    /// Adds paths to the mean by sums that were found without rounding: their number, radiance and alpha.
    #[inline]
    pub(super) fn add_sums(&mut self, samples: u32, radiance: [f64; 3], alpha: f64) {
        self.samples += samples;
        self.alpha.add_exact(alpha);
        for (sum, x) in self.radiance.iter_mut().zip(radiance) {
            sum.add_exact(x);
        }
    }

    /// Adds the squares of finite numbers.
    #[inline]
    pub(super) fn add_squares(&mut self, values: [f32; 3]) {
        for (square, x) in self.squares.iter_mut().zip(values) {
            square.add_square(x);
        }
    }

    /// The sums of squares.
    pub(super) fn squares(&self) -> &[BinnedSum; 3] {
        &self.squares
    }

    /// Number of finite samples.
    pub fn samples(&self) -> u32 {
        self.samples
    }

    /// Mean radiance; zero without samples.
    pub fn mean(&self) -> [f64; 3] {
        self.radiance.each_ref().map(|sum| self.average(sum))
    }

    /// Mean alpha: the fraction of camera paths that met the scene; zero without samples.
    pub fn alpha(&self) -> f64 {
        self.average(&self.alpha)
    }

    fn average(&self, sum: &BinnedSum) -> f64 {
        sum.value() / f64::from(self.samples.max(1))
    }

    /// Unbiased estimate of the variance of [`mean`](Self::mean), per channel; `None` below two samples.
    pub fn variance_of_mean(&self) -> Option<[f64; 3]> {
        let n = self.samples;
        if n < 2 {
            return None;
        }
        let norm = f64::from(n) * f64::from(n) * f64::from(n - 1);
        let mut variance = [0.0; 3];
        for ((v, sum), square) in variance.iter_mut().zip(&self.radiance).zip(&self.squares) {
            *v = scatter(n, sum, square) / norm;
        }
        Some(variance)
    }

    /// Adds the samples of another pixel, exactly. `false`, without change, beyond [`CAPACITY`] samples.
    #[must_use = "a full pixel takes nothing"]
    pub fn merge(&mut self, other: &Self) -> bool {
        let Some(samples) = self.samples.checked_add(other.samples) else {
            return false;
        };
        if samples > CAPACITY {
            return false;
        }
        self.samples = samples;
        self.alpha.merge(&other.alpha);
        for (sum, part) in self.radiance.iter_mut().zip(&other.radiance) {
            sum.merge(part);
        }
        for (sum, part) in self.squares.iter_mut().zip(&other.squares) {
            sum.merge(part);
        }
        true
    }
}

/// n Q − S², never negative, rounded once.
///
/// With the leading digit of max |x| at `e`, that of max x² is at 2e or 2e + 1. Hence the unit of `Q`,
/// 2^(32 (2e−2)) or 2^(32 (2e−1)), is 2⁶⁴ or 2⁹⁶ times the unit of `S²`, 2^(64 (e−2)), and both terms fit 256 bits
/// in the latter: n Q < 2³¹ · 2¹²⁷ · 2⁹⁶ and S² < 2²⁵⁴.
pub(super) fn scatter(n: u32, sum: &BinnedSum, square: &BinnedSum) -> f64 {
    let (s, s_exponent) = sum.exact();
    let (q, q_exponent) = square.exact();
    if q == 0 {
        return 0.0; // all samples are zero
    }
    let unit = 2 * s_exponent;
    debug_assert!(matches!(q_exponent - unit, 64 | 96));
    let q = q.unsigned_abs();
    let wide_q = shift_left(
        multiply(q, u128::from(n)),
        (q_exponent - unit).unsigned_abs(),
    );
    let s = s.unsigned_abs();
    // Digits dropped below the window can only make Q too small by n · 2⁻⁶⁴ of its largest sample.
    match subtract(wide_q, multiply(s, s)) {
        Some((high, low)) => {
            // Round once: fold what lies below into a sticky bit of the leading 128.
            let zeros = if high == 0 {
                128 + low.leading_zeros().min(127)
            } else {
                high.leading_zeros()
            };
            let (leading, rest) = shift_left((high, low), zeros);
            let leading = leading | u128::from(rest != 0);
            leading as f64 * power_of_two(unit + 128 - zeros as i32)
        }
        None => 0.0,
    }
}

/// A 256-bit integer: high and low half.
type Wide = (u128, u128);

/// The full product.
fn multiply(a: u128, b: u128) -> Wide {
    let half = |x: u128| (x >> 64, x & u128::from(u64::MAX));
    let ((a1, a0), (b1, b0)) = (half(a), half(b));
    // The cross terms may carry out of 128 bits; that carry is worth 2^192.
    let (cross, carry) = (a1 * b0).overflowing_add(a0 * b1);
    let (low, carry_low) = (a0 * b0).overflowing_add(cross << 64);
    let high = a1 * b1 + (cross >> 64) + (u128::from(carry) << 64) + u128::from(carry_low);
    (high, low)
}

/// The low 256 bits of the shifted integer; `bits` below 256.
fn shift_left((high, low): Wide, bits: u32) -> Wide {
    match bits {
        0 => (high, low),
        1..=127 => (high << bits | low >> (128 - bits), low << bits),
        _ => (low << (bits - 128), 0),
    }
}

/// The difference, or `None` if it is negative.
fn subtract((a1, a0): Wide, (b1, b0): Wide) -> Option<Wide> {
    let (low, borrow) = a0.overflowing_sub(b0);
    let high = a1.checked_sub(b1)?.checked_sub(u128::from(borrow))?;
    Some((high, low))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pixel(samples: impl IntoIterator<Item = f32>) -> PixelMoments {
        let mut p = PixelMoments::default();
        for x in samples {
            assert!(p.add([x, 2.0 * x, -x], 1.0));
        }
        p
    }

    /// Deterministic test values over `decades` decades.
    fn scrambled(n: u32, decades: f32) -> Vec<f32> {
        let mut state = 1_u32;
        (0..n)
            .map(|_| {
                state = state.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
                let u = (state >> 8) as f32 / 16_777_216.0;
                10.0_f32.powf(decades * (u - 0.5))
            })
            .collect()
    }

    #[test]
    fn agrees_with_two_pass_f64() {
        for decades in [0.1, 3.0, 20.0] {
            let x = scrambled(10_000, decades);
            let n = x.len() as f64;
            let mean = x.iter().map(|&x| f64::from(x)).sum::<f64>() / n;
            let scatter: f64 = x.iter().map(|&x| (f64::from(x) - mean).powi(2)).sum();
            let p = pixel(x.iter().copied());
            let v = p.variance_of_mean().expect("10 000 samples");
            let close = |a: f64, b: f64| ((a - b) / b).abs() < 1e-12;
            assert!(close(p.mean()[0], mean));
            assert!(close(p.mean()[2], -mean));
            assert!(close(v[0], scatter / (n * (n - 1.0))));
            assert!(close(v[1], 4.0 * v[0]));
            assert_eq!(v[2], v[0]);
        }
    }

    #[test]
    fn small_integers_are_exact() {
        let p = pixel([1.0, 2.0, 3.0, 6.0]);
        assert_eq!(p.mean(), [3.0, 6.0, -3.0]);
        // Σ (x − 3)² = 4 + 1 + 0 + 9 = 14, over n (n − 1) = 12
        assert_eq!(
            p.variance_of_mean(),
            Some([14.0 / 12.0, 56.0 / 12.0, 14.0 / 12.0])
        );
        assert_eq!(p.alpha(), 1.0);
    }

    #[test]
    fn equal_samples_have_no_variance_at_any_scale() {
        for x in [0.1_f32, 1.0e-44, 1.0e-20, 3.0e37, f32::MAX / 2.0, -0.7] {
            for n in [2, 3, 7, 1000] {
                let p = pixel(std::iter::repeat_n(x, n));
                assert_eq!(p.variance_of_mean(), Some([0.0; 3]), "{n} times {x:e}");
                assert_eq!(p.mean()[0], f64::from(x), "{n} times {x:e}");
            }
        }
    }

    #[test]
    fn a_hair_of_variance_on_a_large_mean_survives() {
        // 2^20 ± 2^-3: the naive f64 sum of squares keeps 53 − 40 − 12 bits of this at 2^12 samples.
        let (a, b) = (1_048_576.0_f32, 1_048_576.0 + 0.125);
        let p = pixel((0..4096).map(|i| if i % 2 == 0 { a } else { b }));
        let n = 4096.0_f64;
        let expected = 0.0625_f64.powi(2) / (n - 1.0);
        let v = p.variance_of_mean().expect("two samples")[0];
        assert!((v / expected - 1.0).abs() < 1e-15, "{v:e} {expected:e}");
    }

    #[test]
    fn extremes_do_not_overflow_or_vanish() {
        let p = pixel([1.0e-44, 3.0e-44]);
        let d = f64::from(3.0e-44_f32) - f64::from(1.0e-44_f32);
        assert_eq!(p.variance_of_mean().map(|v| v[0]), Some(d * d / 4.0));
        let mut p = PixelMoments::default();
        assert!(p.add([f32::MAX; 3], 1.0) && p.add([-f32::MAX; 3], 1.0));
        let m = f64::from(f32::MAX);
        assert_eq!(p.variance_of_mean(), Some([m * m; 3]));
        assert_eq!(p.mean(), [0.0; 3]);
    }

    #[test]
    fn merging_is_adding() {
        let x = scrambled(1000, 40.0);
        let whole = pixel(x.iter().copied());
        for parts in [2, 3, 10] {
            let mut merged = PixelMoments::default();
            for part in (0..parts).rev() {
                assert!(merged.merge(&pixel(x.iter().copied().skip(part).step_by(parts))));
            }
            assert_eq!(merged, whole);
        }
        let mut full = PixelMoments {
            samples: CAPACITY - 1,
            ..PixelMoments::default()
        };
        assert!(!full.merge(&pixel([1.0, 1.0])));
        assert!(full.merge(&pixel([1.0])));
    }

    #[test]
    fn values_that_are_not_finite_are_refused_whole() {
        let mut p = pixel([1.0, 2.0]);
        let before = p.clone();
        for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
            for channel in 0..3 {
                let mut rgb = [1.0; 3];
                rgb[channel] = bad;
                assert!(!p.add(rgb, 1.0));
            }
            assert!(!p.add([1.0; 3], bad));
        }
        assert_eq!(p, before);
        assert_eq!(pixel([1.0]).variance_of_mean(), None);
    }

    #[test]
    fn wide_products_agree_with_smaller_ones() {
        let m = u128::MAX;
        assert_eq!(multiply(m, m), (m - 1, 1));
        assert_eq!(multiply(1 << 100, 1 << 100), (1 << 72, 0));
        assert_eq!(multiply(m, 1 << 64), (m >> 64, m << 64));
        assert_eq!(subtract((1, 0), (0, 1)), Some((0, m)));
        assert_eq!(subtract((0, 0), (0, 1)), None);
        assert_eq!(shift_left((0, 3), 127), (1, 1 << 127));
        assert_eq!(shift_left((0, 3), 130), (12, 0));
    }
}
