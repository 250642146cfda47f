//! A point that shines into a cone with a soft edge.
//!
//! ```text
//! I(θ) = I₀ s((cos θ − c₁) / (c₀ − c₁)),   s(x) = 3x² − 2x³ on [0, 1], 0 below, 1 above
//! ∫ I dω = 2π I₀ ((1 − c₀) + (c₀ − c₁) / 2)
//! ```
//!
//! c₀ the cosine where the full cone ends, c₁ ≤ c₀ where it is dark. pbrt's profile; directions are sampled in exact
//! proportion to it, in the edge by solving 2x³ − x⁴ = u.

use std::f64::consts::{PI, TAU};

use glam::DVec3;

use super::direction::about;
use super::discrete::BELOW_ONE;

/// The profile of a spot light.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cone {
    /// Unit, away from the light.
    pub(super) axis: DVec3,
    /// Where the full cone ends.
    pub(super) cos_full: f64,
    /// Where it is dark; at most `cos_full`.
    pub(super) cos_dark: f64,
}

impl Cone {
    /// The intensity in a unit direction over that on the axis.
    pub(super) fn profile(&self, direction: DVec3) -> f64 {
        let cos = self.axis.dot(direction);
        if cos >= self.cos_full {
            return 1.0;
        }
        if cos <= self.cos_dark {
            return 0.0;
        }
        let x = (cos - self.cos_dark) / (self.cos_full - self.cos_dark);
        x * x * (3.0 - 2.0 * x)
    }

    /// Solid angle of the full cone, and of its edge times the mean profile there \[sr\].
    fn shares(&self) -> [f64; 2] {
        [
            TAU * (1.0 - self.cos_full),
            PI * (self.cos_full - self.cos_dark),
        ]
    }

    /// ∫ of the profile over all directions \[sr\].
    pub(super) fn total(&self) -> f64 {
        let [full, edge] = self.shares();
        full + edge
    }

    /// A direction in proportion to the profile. The total is positive.
    pub(super) fn sample(&self, u: [f64; 2]) -> DVec3 {
        let [full, edge] = self.shares();
        let at = u[0] * (full + edge);
        let cos = if at < full {
            1.0 - at / TAU
        } else {
            let rest = ((at - full) / edge).min(BELOW_ONE);
            self.cos_dark + (self.cos_full - self.cos_dark) * smooth_quantile(rest)
        };
        about(self.axis, cos, u[1])
    }

    /// The density of [`sample`](Self::sample) [1/sr].
    pub(super) fn pdf(&self, direction: DVec3) -> f64 {
        let total = self.total();
        if total > 0.0 {
            self.profile(direction) / total
        } else {
            0.0
        }
    }
}

/// x in [0, 1] with 2x³ − x⁴ = u: Newton's method, kept within a shrinking bracket.
fn smooth_quantile(u: f64) -> f64 {
    let (mut low, mut high) = (0.0, 1.0);
    let mut x = libm::cbrt(0.5 * u);
    for _ in 0..64 {
        let excess = x * x * x * (2.0 - x) - u;
        if excess > 0.0 {
            high = x;
        } else {
            low = x;
        }
        let mut next = x - excess / (x * x * (6.0 - 4.0 * x));
        if !(next > low && next < high) {
            next = 0.5 * (low + high);
        }
        if (next - x).abs() <= f64::EPSILON * x {
            return next;
        }
        x = next;
    }
    x
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cone(full: f64, dark: f64) -> Cone {
        Cone {
            axis: DVec3::new(0.3, -0.4, 0.5).normalize(),
            cos_full: full,
            cos_dark: dark,
        }
    }

    #[test]
    fn the_quantile_inverts_its_law() {
        for i in 0..=1000 {
            let u = f64::from(i) / 1000.0;
            let x = smooth_quantile(u);
            assert!((0.0..=1.0).contains(&x));
            assert!((x * x * x * (2.0 - x) - u).abs() < 1e-14, "{u} {x}");
        }
    }

    #[test]
    fn the_total_is_the_integral_of_the_profile() {
        for (full, dark) in [
            (0.9, 0.5),
            (0.2, -0.7),
            (1.0, 0.6),
            (0.5, 0.5),
            (-0.2, -1.0),
        ] {
            let cone = cone(full, dark);
            let n = 20_000;
            let mut sum = 0.0;
            for i in 0..n {
                let cos = 2.0 * (f64::from(i) + 0.5) / f64::from(n) - 1.0;
                sum += cone.profile(about(cone.axis, cos, 0.3));
            }
            let integral = sum * 2.0 / f64::from(n) * TAU;
            assert!(
                (integral / cone.total() - 1.0).abs() < 1e-3,
                "{full} {dark}"
            );
        }
    }

    #[test]
    fn samples_follow_the_profile() {
        // Evenly spaced numbers fill the law's own distribution function evenly, so means are integrals.
        for (full, dark) in [(0.9, 0.5), (0.2, -0.7), (1.0, 0.6), (0.5, 0.5)] {
            let cone = cone(full, dark);
            let n = 20_000;
            let (mut mean, mut truth, mut weight) = (0.0, 0.0, 0.0);
            for i in 0..n {
                let u = (f64::from(i) + 0.5) / f64::from(n);
                mean += cone.axis.dot(cone.sample([u, 0.7])) / f64::from(n);
                let cos = 2.0 * u - 1.0;
                let profile = cone.profile(about(cone.axis, cos, 0.1));
                truth += profile * cos;
                weight += profile;
            }
            assert!(
                (mean - truth / weight).abs() < 1e-3,
                "{mean} {}",
                truth / weight
            );
        }
    }
}
