//! A stratum of majorant depth: what it lets through and what its sources bring, from a point or a few.
//!
//! In units of majorant depth x = ∫σ̄ dt a stratum has depth h and N ≥ 1 points x₁ < … < x_N, uniform and independent but for
//! their order. With a = σ_t/σ̄ in [0, 1] and s = a − ½ its transmittance, and what a source e (per depth) within it brings to its near
//! end, are power series whose terms are means over subsets of points:
//!
//! ```text
//! T = e^(−h/2) E Σ_n (−1)ⁿ w_n S_n(all points),   ∫e T dx = E Σ_i e(x_i) e^(−x_i/2) Σ_m (−1)^m w_(m+1) S_m(points before x_i)
//! w_0 = 1,   w_n = hⁿ/n! / P(N ≥ n) / C(N, n)
//! ```
//!
//! S_m is the m-th elementary symmetric polynomial of the s of points: the n points of a subset are n uniform ones in order, and
//! hⁿ/n! is the volume of ordered ones. P(N ≥ n + 1 | N ≥ n) = h/2, so that w_1 = h/N and w_(n+1) = w_n · 2/(N − n): with these all estimates are
//! positive wherever a is in [0, 1], and most strata have one point. The series is that of [Georgiev 2019], with its
//! order by roulette and its points shared by all orders as in [Kettunen 2021].
//!
//! A stratum has at most [`MOST`] points. What orders n beyond would add is at most Σ (h/2)ⁿ/n! of the whole, 1.3e-8: below the rounding of
//! single precision, which is half of 2⁻²³ for each of the strata's products.

use crate::points::LaneStrata;
use crate::real::{Mask, Real, Word};
use crate::stream::Stream;

/// Bits of a random number that say whether a stratum has one more point: the chance for it is 2^(−`BITS`).
const BITS: u32 = 2;
/// Majorant depth of a stratum of a [glow](super::glow()), h: twice the chance of one more point.
pub const STRATUM: f32 = 2.0 / (1_u32 << BITS) as f32;
/// Points of a stratum at most: the next order is 2⁻¹⁴/7! = 1.2e-8 of the whole.
pub(super) const MOST: usize = 6;
/// Bits of a random word that a stratum's number of points takes; the others place a point.
const NUMBER: u32 = BITS * (MOST as u32 - 1);

/// The points of the present stratum, per lane.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stratum<R: Real> {
    /// How many it has, and how many of them are still ahead.
    points: R,
    pub(super) ahead: R,
    /// Depth of the last point.
    pub(super) depth: R,
    /// Which stratum of the ray it is.
    index: R::Word,
    /// Elementary symmetric polynomials of the points so far.
    symmetric: [R; MOST + 1],
}

/// What places the single points of strata, the same in all paths of a replicate but for a word of each path.
pub(super) type Shifts<R> = (LaneStrata<<R as Real>::Word>, <R as Real>::Word);

impl<R: Real> Stratum<R> {
    pub(super) fn idle() -> Self {
        let mut symmetric = [R::zero(); MOST + 1];
        symmetric[0] = R::one();
        Self {
            points: R::one(),
            ahead: R::one(),
            depth: R::zero(),
            index: R::Word::splat(0),
            symmetric,
        }
    }

    /// Begins strata. One draw. Returns the depth of their first points.
    #[inline(always)]
    pub(super) fn open(
        &mut self,
        shifts: Option<&Shifts<R>>,
        rng: &mut impl Stream<R>,
        lanes: R::Mask,
    ) -> R {
        self.index = self.index + R::Word::from_mask(lanes);
        let word = rng.next_word(lanes);
        let number = word & R::Word::splat((1 << NUMBER) - 1);
        let mut points = R::one();
        for further in 1..MOST as u32 {
            let chance = R::Word::splat(1 << (BITS * (MOST as u32 - 1 - further)));
            let more = number.lt(chance);
            if !(more & lanes).any() {
                break;
            }
            points = points + R::one().or_zero(more);
        }
        self.points = R::select(lanes, points, self.points);
        self.ahead = R::select(lanes, points, self.ahead);
        self.depth = R::select(lanes, R::zero(), self.depth);
        for power in self.symmetric.iter_mut().skip(1) {
            *power = R::select(lanes, R::zero(), *power);
        }
        let own = match shifts {
            None => word,
            Some((strata, shift)) => {
                let alone = self.ahead.eq(R::one());
                let shared = strata.rotated(*shift, self.index);
                R::Word::select(alone, shared, word)
            }
        };
        self.step(own, lanes)
    }

    /// Moves to the next point, the first of those ahead, with a random word. Returns how far that is.
    #[inline(always)]
    pub(super) fn step(&mut self, word: R::Word, lanes: R::Mask) -> R {
        const SCALE: f32 = 1.0 / (1_u32 << (32 - NUMBER)) as f32;
        let u = (R::from_word(word.shr(NUMBER)) + R::splat(0.5)) * R::splat(SCALE);
        let mut least = u;
        let several = R::one().lt(self.ahead) & lanes;
        if several.any() {
            // The least of m uniform numbers.
            let power = ((R::one() - u).max(R::splat(1e-9)).ln() / self.ahead).exp();
            least = R::select(several, R::one() - power, least);
        }
        let step = (R::splat(STRATUM) - self.depth).max(R::zero()) * least;
        self.depth = R::select(lanes, self.depth + step, self.depth);
        step
    }

    /// Whether any of these lanes has more than one point.
    #[inline(always)]
    pub(super) fn several(&self, lanes: R::Mask) -> bool {
        (R::one().lt(self.points) & lanes).any()
    }

    /// Σ_m (−1)^m w_(m+1) S_m of the points so far.
    #[inline(always)]
    pub(super) fn source(&self, lanes: R::Mask) -> R {
        let mut w = R::splat(STRATUM) / self.points;
        let mut sum = w;
        if self.several(lanes) {
            let mut m = R::one();
            for power in &self.symmetric[1..MOST] {
                let counts = m.lt(self.points);
                w = (w * R::splat(-2.0) / (self.points - m).max(R::one())).or_zero(counts);
                sum = sum + w * *power;
                m = m + R::one();
            }
        }
        // Not negative but by rounding.
        sum.max(R::zero())
    }

    /// Adds a point of the given s.
    #[inline(always)]
    pub(super) fn add(&mut self, s: R, lanes: R::Mask) {
        let s = s.or_zero(lanes);
        self.ahead = self.ahead - R::one().or_zero(lanes);
        let highest = if self.several(lanes) { MOST } else { 1 };
        for m in (1..=highest).rev() {
            self.symmetric[m] = self.symmetric[m] + s * self.symmetric[m - 1];
        }
    }

    /// The transmittance of whole strata.
    #[inline(always)]
    pub(super) fn passes(&self, lanes: R::Mask) -> R {
        let mut w = R::splat(-STRATUM) / self.points;
        let mut sum = R::one() + w * self.symmetric[1];
        if self.several(lanes) {
            let mut m = R::one();
            for power in &self.symmetric[2..] {
                let counts = m.lt(self.points);
                w = (w * R::splat(-2.0) / (self.points - m).max(R::one())).or_zero(counts);
                sum = sum + w * *power;
                m = m + R::one();
            }
        }
        sum * R::splat(-0.5 * STRATUM).exp()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    extern crate std;
    use std::vec::Vec;

    fn of(s: &[f32]) -> Stratum<f32> {
        let mut stratum = Stratum::idle();
        stratum.points = s.len() as f32;
        stratum.ahead = stratum.points;
        for s in s {
            stratum.add(*s, true);
        }
        stratum
    }

    /// P(N = n), n from one on.
    fn chance(n: usize) -> f64 {
        let more = f64::from(STRATUM) / 2.0;
        let reaches = more.powi(n as i32 - 1);
        if n == MOST {
            reaches
        } else {
            reaches * (1.0 - more)
        }
    }

    /// Of constant extinction an estimate depends on the number of points alone: its mean is a finite sum.
    #[test]
    fn what_passes_has_the_mean_of_the_exponential() {
        let mean = |a: f32, orders: usize| -> f64 {
            let of_n = |n: usize| {
                let mut stratum = of(&[a - 0.5].repeat(n));
                for power in stratum.symmetric.iter_mut().skip(orders + 1) {
                    *power = 0.0;
                }
                chance(n) * f64::from(stratum.passes(true))
            };
            (1..=MOST).map(of_n).sum()
        };
        for a in [0.0, 0.1, 0.5, 0.8, 1.0] {
            let exact = (-f64::from(a * STRATUM)).exp();
            assert!((mean(a, MOST) / exact - 1.0).abs() < 2e-7, "{a}");
            // Without its higher orders it would be another number.
            let forgotten = (mean(a, 1) / exact - 1.0).abs();
            assert!(
                forgotten > 1e-2 || (a - 0.5).abs() < 0.45,
                "{a}: {forgotten}"
            );
        }
    }

    /// e^(−x/2) times the polynomial, over all x and points before it, integrates to (1 − e^(−h a))/a.
    #[test]
    fn sources_have_the_mean_of_their_integral() {
        let h = f64::from(STRATUM);
        for a in [0.1_f32, 0.5, 0.9, 1.0] {
            let steps = 1000;
            let mut mean = 0.0;
            for step in 0..steps {
                let u = (f64::from(step) + 0.5) / f64::from(steps);
                for n in 1..=MOST {
                    // The point that has `before` others before it lies at u with the density of an order statistic.
                    let mut binomial = 1.0;
                    for before in 0..n {
                        let rest = n - 1 - before;
                        let density = n as f64
                            * binomial
                            * u.powi(before as i32)
                            * (1.0 - u).powi(rest as i32);
                        binomial *= rest as f64 / (before + 1) as f64;
                        let mut stratum = of(&[a - 0.5].repeat(before));
                        stratum.points = n as f32;
                        let source = f64::from(stratum.source(true)) * (-0.5 * h * u).exp();
                        mean += chance(n) * density * source / f64::from(steps);
                    }
                }
            }
            let a = f64::from(a);
            let exact = (1.0 - (-h * a).exp()) / a;
            assert!((mean / exact - 1.0).abs() < 1e-6, "{a}: {mean} {exact}");
        }
    }

    /// Estimates are linear in each s, so they are least where all s are ±½.
    #[test]
    fn nothing_is_negative() {
        for n in 1..=MOST {
            for signs in 0_u32..1 << n {
                let s: Vec<f32> = (0..n)
                    .map(|i| if signs >> i & 1 == 1 { 0.5 } else { -0.5 })
                    .collect();
                assert!(of(&s).passes(true) > 0.0, "{s:?}");
                let mut before = of(&s[..n - 1]);
                before.points = n as f32;
                let (mut w, mut sum) = (STRATUM / n as f32, 0.0);
                for (m, power) in before.symmetric[..n].iter().enumerate() {
                    sum += w * power;
                    w *= -2.0 / (n - 1 - m).max(1) as f32;
                }
                assert!(sum > -1e-6, "{s:?}: {sum}");
                assert!((before.source(true) - sum.max(0.0)).abs() < 1e-6, "{s:?}");
            }
        }
    }

    #[test]
    fn points_come_in_order_and_fill_the_stratum() {
        use crate::stream::{Key, PathStream};
        let mut rng = PathStream::new(Key::default());
        let mut stratum = Stratum::<f32>::idle();
        let (mut sums, mut counts) = ([0.0_f64; MOST], [0_u32; MOST]);
        let n = 200_000;
        for _ in 0..n {
            let mut depth = stratum.open(None, &mut rng, true);
            let points = stratum.points as usize;
            counts[points - 1] += 1;
            loop {
                sums[points - 1] += f64::from(depth / STRATUM);
                stratum.add(0.0, true);
                if stratum.ahead == 0.0 {
                    break;
                }
                let word = Stream::<f32>::next_word(&mut rng, true);
                depth += stratum.step(word, true);
                assert!(depth <= STRATUM && depth == stratum.depth);
            }
        }
        for (i, (sum, count)) in sums.iter().zip(counts).enumerate() {
            let points = i + 1;
            let expected = f64::from(n) * chance(points);
            assert!(
                (f64::from(count) - expected).abs() < 6.0 * expected.sqrt(),
                "{points}: {count}"
            );
            // Uniform numbers have mean ½ and variance 1/12.
            let number = f64::from(count) * points as f64;
            let off = (sum / number - 0.5) * (12.0 * number).sqrt();
            assert!(off.abs() < 6.0, "{points}: {off}");
        }
    }
}
