//! Phase functions of any kind, for scalar code.

use woodcock_core::phase::mie_fit::MieFit;
use woodcock_core::phase::two_lobe::TwoLobe;
use woodcock_core::phase::{draine, henyey_greenstein, isotropic, rayleigh};

use crate::scene::Phase;

/// The largest α that Draine's law is computed for.
const LARGEST_ALPHA: f64 = 1e8;

/// A phase function with its parameters in single precision. Forward is cos θ = +1.
#[derive(Clone, Copy, Debug)]
pub enum PhaseFunction {
    /// 1 / 4π.
    Isotropic,
    /// Henyey–Greenstein.
    HenyeyGreenstein {
        /// Mean cosine, in (−1, 1).
        g: f32,
    },
    /// Rayleigh.
    Rayleigh,
    /// Draine.
    Draine {
        /// In (−1, 1).
        g: f32,
        /// From 0 to 1e8.
        alpha: f32,
    },
    /// Two Henyey–Greenstein lobes.
    TwoLobe(TwoLobe<f32>),
    /// Mie scattering by water droplets, fitted.
    Droplets(MieFit<f32>),
}

impl PhaseFunction {
    /// A scene's phase function in single precision.
    ///
    /// # Errors
    /// A parameter that single precision rounds out of its domain, or that no formula covers.
    pub fn new(phase: &Phase) -> Result<Self, String> {
        let cosine = |g: f64| {
            let g = g as f32;
            // Not `g.abs() >= 1.0`: a NaN is no mean cosine.
            if g.abs() < 1.0 {
                Ok(g)
            } else {
                Err(format!(
                    "mean cosine {g} rounds to one: scattering would be no scattering"
                ))
            }
        };
        Ok(match *phase {
            Phase::Isotropic => Self::Isotropic,
            Phase::HenyeyGreenstein { g } => Self::HenyeyGreenstein { g: cosine(g)? },
            Phase::Rayleigh => Self::Rayleigh,
            Phase::Draine { g, alpha } => {
                if !(0.0..=LARGEST_ALPHA).contains(&alpha) {
                    return Err(format!(
                        "Draine's alpha is {alpha}: it is from 0 to {LARGEST_ALPHA:e}"
                    ));
                }
                let (g, alpha) = (cosine(g)?, alpha as f32);
                Self::Draine { g, alpha }
            }
            Phase::TwoLobe {
                forward,
                backward,
                share,
            } => {
                if !(0.0..=1.0).contains(&share) {
                    return Err(format!("the share of a lobe is {share}: it is from 0 to 1"));
                }
                Self::TwoLobe(TwoLobe {
                    share: share as f32,
                    g1: cosine(forward)?,
                    g2: cosine(backward)?,
                })
            }
            Phase::Droplets { diameter } => {
                Self::Droplets(MieFit::new(diameter as f32).map_err(|error| error.to_string())?)
            }
        })
    }

    /// Whether packets know it: isotropic, Henyey–Greenstein's or Rayleigh's.
    pub fn is_plain(&self) -> bool {
        matches!(
            self,
            Self::Isotropic | Self::HenyeyGreenstein { .. } | Self::Rayleigh
        )
    }

    /// Density of the cosine over the sphere [1/sr], which is also that of [`sample`](Self::sample).
    ///
    /// * `cos_theta`: between the directions of travel before and after, in [−1, 1].
    pub fn eval(&self, cos_theta: f32) -> f32 {
        match self {
            Self::Isotropic => isotropic::eval(cos_theta),
            Self::HenyeyGreenstein { g } => henyey_greenstein::eval(cos_theta, *g),
            Self::Rayleigh => rayleigh::eval(cos_theta),
            Self::Draine { g, alpha } => draine::eval(cos_theta, *g, *alpha),
            Self::TwoLobe(lobes) => lobes.eval(cos_theta),
            Self::Droplets(fit) => fit.eval(cos_theta),
        }
    }

    /// The cosine at a uniform number in [0, 1).
    pub fn sample(&self, u: f32) -> f32 {
        match self {
            Self::Isotropic => isotropic::sample(u),
            Self::HenyeyGreenstein { g } => henyey_greenstein::sample(u, *g),
            Self::Rayleigh => rayleigh::sample(u),
            Self::Draine { g, alpha } => draine::sample(u, *g, *alpha),
            Self::TwoLobe(lobes) => lobes.sample(u),
            Self::Droplets(fit) => fit.sample(u),
        }
    }

    /// The mean cosine.
    pub fn mean_cosine(&self) -> f32 {
        match self {
            Self::Isotropic | Self::Rayleigh => 0.0,
            Self::HenyeyGreenstein { g } => *g,
            Self::Draine { g, alpha } => draine::mean_cosine(*g, *alpha),
            Self::TwoLobe(lobes) => lobes.mean_cosine(),
            Self::Droplets(fit) => fit.mean_cosine(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn all() -> Vec<PhaseFunction> {
        let kinds = [
            Phase::Isotropic,
            Phase::HenyeyGreenstein { g: 0.7 },
            Phase::Rayleigh,
            Phase::Draine {
                g: 0.4,
                alpha: 30.0,
            },
            Phase::TwoLobe {
                forward: 0.8,
                backward: -0.3,
                share: 0.7,
            },
            Phase::Droplets { diameter: 12.0 },
        ];
        kinds
            .iter()
            .map(|kind| PhaseFunction::new(kind).expect("valid"))
            .collect()
    }

    /// ∫ f p dω by Simpson's rule in a variable that is dense where peaks are.
    fn integral(phase: &PhaseFunction, f: impl Fn(f64) -> f64) -> f64 {
        const STEPS: u32 = 20_000;
        let term = |i: u32| {
            let x = f64::from(i) / f64::from(STEPS);
            // cos θ = 1 − 2 x⁴: the peak lies forward.
            let mu = 1.0 - 2.0 * x * x * x * x;
            let weight = match i {
                0 | STEPS => 1.0,
                i if i % 2 == 1 => 4.0,
                _ => 2.0,
            };
            let density = f64::from(phase.eval(mu as f32));
            weight * f(mu) * density * 8.0 * x * x * x
        };
        let sum: f64 = (0..=STEPS).map(term).sum();
        sum / (3.0 * f64::from(STEPS)) * 2.0 * std::f64::consts::PI
    }

    #[test]
    fn every_kind_is_normalised_and_has_its_mean_cosine() {
        for phase in all() {
            let whole = integral(&phase, |_| 1.0);
            let mean = integral(&phase, |mu| mu);
            assert!((whole - 1.0).abs() < 2e-5, "{phase:?}: {whole}");
            let told = f64::from(phase.mean_cosine());
            assert!((mean - told).abs() < 2e-5, "{phase:?}: {mean} {told}");
        }
    }

    #[test]
    fn samples_have_the_mean_that_the_density_has() {
        // The map from u is piecewise smooth: the rectangle rule at midpoints does.
        const STEPS: u32 = 200_000;
        for phase in all() {
            let at = |i: u32| f64::from(phase.sample((f64::from(i) + 0.5) as f32 / STEPS as f32));
            let (first, second) = (0..STEPS)
                .map(at)
                .fold((0.0, 0.0), |(a, b), mu| (a + mu, b + mu * mu));
            let n = f64::from(STEPS);
            let (one, two) = (integral(&phase, |mu| mu), integral(&phase, |mu| mu * mu));
            assert!((first / n - one).abs() < 1e-4, "{phase:?}");
            assert!((second / n - two).abs() < 1e-4, "{phase:?}");
        }
    }

    #[test]
    fn what_rounds_out_of_the_domain_is_refused() {
        let wrong = [
            Phase::HenyeyGreenstein { g: 0.999_999_999_9 },
            Phase::HenyeyGreenstein { g: f64::NAN },
            Phase::Draine { g: 0.5, alpha: 1e9 },
            Phase::TwoLobe {
                forward: 0.5,
                backward: -1.0,
                share: 0.5,
            },
            Phase::Droplets { diameter: 51.0 },
        ];
        for phase in wrong {
            assert!(PhaseFunction::new(&phase).is_err(), "{phase:?}");
        }
    }
}
