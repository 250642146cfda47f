//! Densities, cumulative laws, their inverses and moments of phase functions.
//!
//! Uncertainty: 10⁻¹⁴ relative, Mie 10⁻⁸ to 10⁻¹².

use serde::Deserialize;
use std::f64::consts::PI;

/// Which phase function, as a density over cos θ [1/sr].
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(tag = "kind", content = "params", rename_all = "snake_case")]
pub enum Kind {
    /// Henyey–Greenstein of mean cosine g.
    Hg {
        /// Mean cosine, in (−1, 1).
        g: f64,
    },
    /// 3(1 + c²)/16π.
    Rayleigh {},
    /// Rayleigh of molecules that are not spheres.
    RayleighDepol {
        /// Depolarisation factor.
        rho: f64,
    },
    /// Draine's blend of both; α = 1 is Cornette–Shanks.
    Draine {
        /// Parameter g (not the mean cosine).
        g: f64,
        /// Weight of the squared cosine.
        alpha: f64,
    },
    /// (1 − k²)/(4π(1 − kc)²).
    Schlick {
        /// Parameter, forward where positive.
        k: f64,
    },
    /// w · HG(g₁) + (1 − w) · HG(g₂).
    TwoTermHg {
        /// Share of the first.
        w: f64,
        /// Mean cosine of the first.
        g1: f64,
        /// Mean cosine of the second.
        g2: f64,
    },
}

impl Kind {
    /// The density at cos θ = `c`, by its formula [1/sr].
    pub fn eval(&self, c: f64) -> f64 {
        // 1 + g² − 2gc without cancellation near the peak of a narrow lobe.
        let lobe = |g: f64| (1.0 - g * g) / ((1.0 - g).powi(2) + 2.0 * g * (1.0 - c)).powf(1.5);
        match *self {
            Self::Hg { g } => lobe(g) / (4.0 * PI),
            Self::Rayleigh {} => 3.0 * (1.0 + c * c) / (16.0 * PI),
            Self::RayleighDepol { rho } => {
                let y = rho / (2.0 - rho);
                3.0 * ((1.0 + 3.0 * y) + (1.0 - y) * c * c) / (16.0 * PI * (1.0 + 2.0 * y))
            }
            Self::Draine { g, alpha } => {
                let norm = 1.0 + alpha * (1.0 + 2.0 * g * g) / 3.0;
                lobe(g) * (1.0 + alpha * c * c) / (4.0 * PI * norm)
            }
            Self::Schlick { k } => (1.0 - k * k) / (4.0 * PI * (1.0 - k * c).powi(2)),
            Self::TwoTermHg { w, g1, g2 } => (w * lobe(g1) + (1.0 - w) * lobe(g2)) / (4.0 * PI),
        }
    }
}

/// A phase function by formula; `p` and `cdf` stand at [`Table::cos`], `inv_cdf` at [`Table::xi`].
#[derive(Clone, Debug, PartialEq, Deserialize)]
pub struct Function {
    /// Which.
    #[serde(flatten)]
    pub kind: Kind,
    /// Densities [1/sr].
    pub p: Vec<f64>,
    /// P(cos ≤ c).
    pub cdf: Vec<f64>,
    /// The c with P(cos ≤ c) = ξ.
    pub inv_cdf: Vec<f64>,
    /// ⟨c⟩, ⟨c²⟩, ⟨c³⟩.
    pub moments: [f64; 3],
    /// ⟨P_l(c)⟩ for l = 1 … 6.
    pub legendre: [f64; 6],
}

/// A phase function that is piecewise linear in the cosine.
#[derive(Clone, Debug, PartialEq, Deserialize)]
pub struct Tabulated {
    /// Cosine and value before normalisation, ascending.
    pub nodes: Vec<[f64; 2]>,
    /// 2π ∫ of the values, which p, cdf and moments are divided by.
    pub norm: f64,
    /// Densities at [`Table::cos`] [1/sr].
    pub p: Vec<f64>,
    /// P(cos ≤ c) at [`Table::cos`].
    pub cdf: Vec<f64>,
    /// The c with P(cos ≤ c) = ξ at [`Table::xi`].
    pub inv_cdf: Vec<f64>,
    /// ⟨c⟩, ⟨c²⟩, ⟨c³⟩.
    pub moments: [f64; 3],
}

/// Unpolarised light scattered by one homogeneous sphere.
#[derive(Clone, Debug, PartialEq, Deserialize)]
pub struct Mie {
    /// Size parameter 2π radius / wavelength.
    pub x: f64,
    /// Relative index, real and imaginary part (absorption is a negative imaginary part).
    pub m: [f64; 2],
    /// Mean cosine.
    pub g: f64,
    /// Extinction efficiency.
    #[serde(rename = "Qext")]
    pub q_ext: f64,
    /// Scattering efficiency.
    #[serde(rename = "Qsca")]
    pub q_sca: f64,
    /// Cosines of this sphere's table.
    pub cos: Vec<f64>,
    /// Densities there [1/sr].
    pub p: Vec<f64>,
}

/// The whole file.
#[derive(Clone, Debug, PartialEq, Deserialize)]
pub struct Table {
    /// Cosines of `p` and `cdf`.
    pub cos: Vec<f64>,
    /// Probabilities of `inv_cdf`.
    pub xi: Vec<f64>,
    /// By formula.
    pub functions: Vec<Function>,
    /// By table.
    pub tabulated: Vec<Tabulated>,
    /// By Mie theory.
    pub mie: Vec<Mie>,
}

/// Reads the table.
///
/// # Panics
/// When the file does not match these types.
pub fn load() -> Table {
    super::parse(
        "phase_functions",
        include_str!("../../refs/phase_functions.json"),
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::refs::quadrature::{close, integrate};

    /// 2π ∫ f(c) p(c) dc over [−1, upper], on panels that shrink towards both ends, where narrow lobes sit.
    fn moment(kind: Kind, upper: f64, f: impl Fn(f64) -> f64) -> f64 {
        let mut edges: Vec<f64> = vec![0.0];
        for k in 1..30 {
            let edge = 1.0 - 0.5_f64.powi(k);
            edges.extend([edge, -edge]);
        }
        edges.extend([-1.0, upper]);
        edges.retain(|&e| e <= upper);
        edges.sort_by(f64::total_cmp);
        let over = |w: &[f64]| integrate(w[0], w[1], 1, |c| 2.0 * PI * f(c) * kind.eval(c));
        edges.windows(2).map(over).sum()
    }

    #[test]
    fn formulas_reproduce_every_column() {
        let table = load();
        assert_eq!(table.functions.len(), 13);
        for function in &table.functions {
            let kind = function.kind;
            let name = format!("{kind:?}");
            close(&name, moment(kind, 1.0, |_| 1.0), 1.0, 1e-12);
            for (i, &c) in table.cos.iter().enumerate() {
                close(&name, kind.eval(c), function.p[i], 1e-12);
                close(&name, moment(kind, c, |_| 1.0), function.cdf[i], 1e-12);
            }
            for (i, &xi) in table.xi.iter().enumerate() {
                close(&name, moment(kind, function.inv_cdf[i], |_| 1.0), xi, 1e-11);
            }
            for (power, &expected) in (1..).zip(&function.moments) {
                close(&name, moment(kind, 1.0, |c| c.powi(power)), expected, 1e-12);
            }
            let second = moment(kind, 1.0, |c| 1.5 * c * c - 0.5);
            close(&name, second, function.legendre[1], 1e-12);
        }
    }

    #[test]
    fn tabulated_functions_are_linear_between_nodes() {
        for (t, table) in load().tabulated.iter().map(|t| (t, load())) {
            let value = |c: f64| {
                let cell = t.nodes.windows(2).find(|w| c <= w[1][0]);
                let [[c0, v0], [c1, v1]] = *cell.expect("nodes reach 1") else {
                    unreachable!("windows of two")
                };
                (v0 + (v1 - v0) * (c - c0) / (c1 - c0)) / t.norm
            };
            let cumulative = |upper: f64| -> f64 {
                t.nodes
                    .windows(2)
                    .filter(|w| w[0][0] < upper)
                    .map(|w| integrate(w[0][0], w[1][0].min(upper), 1, |c| 2.0 * PI * value(c)))
                    .sum()
            };
            for (i, &c) in table.cos.iter().enumerate() {
                close("table p", value(c), t.p[i], 1e-13);
                close("table cdf", cumulative(c), t.cdf[i], 1e-13);
            }
            for (i, &xi) in table.xi.iter().enumerate() {
                close("table inverse", cumulative(t.inv_cdf[i]), xi, 1e-12);
            }
        }
    }

    #[test]
    fn spheres_scatter_no_more_than_they_remove() {
        for sphere in load().mie {
            assert!(sphere.q_sca <= sphere.q_ext * (1.0 + 1e-12));
            assert_eq!(sphere.cos.len(), sphere.p.len());
            assert!(sphere.g > 0.0 && sphere.g < 1.0);
        }
    }
}
