//! What a phase function should be: densities in double precision by formulas that are not core's, and quadrature.

use std::f64::consts::PI;
use woodcock_tests::refs::phase_functions::Kind;
use woodcock_tests::refs::quadrature::integrate;

/// A density over the sphere [1/sr].
#[derive(Clone, Debug)]
pub(super) enum Law {
    /// Shares and what they are shares of.
    Blend(Vec<(f64, Kind)>),
    /// Linear between nodes of cosine and value; values are divided by `norm`.
    Table { nodes: Vec<[f64; 2]>, norm: f64 },
}

impl From<Kind> for Law {
    fn from(kind: Kind) -> Self {
        Self::Blend(vec![(1.0, kind)])
    }
}

impl Law {
    /// Of these nodes, normalised.
    pub(super) fn table(nodes: Vec<[f64; 2]>) -> Self {
        let area = |w: &[[f64; 2]]| (w[1][0] - w[0][0]) * (w[1][1] + w[0][1]);
        let norm = PI * nodes.windows(2).map(area).sum::<f64>();
        Self::Table { nodes, norm }
    }

    /// The density at a cosine.
    pub(super) fn eval(&self, c: f64) -> f64 {
        match self {
            Self::Blend(parts) => parts.iter().map(|(w, kind)| w * kind.eval(c)).sum(),
            Self::Table { nodes, norm } => {
                let at = nodes.partition_point(|node| node[0] <= c);
                let at = at.clamp(1, nodes.len() - 1);
                let ([a, low], [b, high]) = (nodes[at - 1], nodes[at]);
                (low * (b - c) + high * (c - a)) / (b - a) / norm
            }
        }
    }

    /// The density at a cosine of the part that u is drawn from.
    pub(super) fn drawn_at(&self, u: f64, c: f64) -> f64 {
        match self {
            Self::Blend(parts) if parts.len() > 1 => {
                let [(share, first), (_, second)] = parts[..] else {
                    panic!("a blend has two parts")
                };
                if u < share { first } else { second }.eval(c)
            }
            _ => self.eval(c),
        }
    }

    /// ∫ f over [from, to], on panels that shrink towards both ends, where narrow lobes sit, and end at nodes.
    pub(super) fn over(&self, from: f64, to: f64, mut f: impl FnMut(f64) -> f64) -> f64 {
        let mut edges: Vec<f64> = (1..48).map(|k| 1.0 - 0.5_f64.powi(k)).collect();
        edges.extend((1..48).map(|k| 0.5_f64.powi(k) - 1.0));
        edges.push(0.0);
        if let Self::Table { nodes, .. } = self {
            edges.extend(nodes.iter().map(|node| node[0]));
        }
        edges.retain(|&e| from < e && e < to);
        edges.extend([from, to]);
        edges.sort_by(f64::total_cmp);
        edges
            .windows(2)
            .map(|w| integrate(w[0], w[1], 1, &mut f))
            .sum()
    }

    /// The share of cosines in [from, to].
    pub(super) fn share(&self, from: f64, to: f64) -> f64 {
        self.over(from, to, |c| 2.0 * PI * self.eval(c))
    }

    /// ⟨c^power⟩.
    pub(super) fn moment(&self, power: i32) -> f64 {
        self.over(-1.0, 1.0, |c| 2.0 * PI * c.powi(power) * self.eval(c))
    }

    /// Whether the sharpest peak is too narrow for the cells of a histogram over numbers of `f32`.
    pub(super) fn too_sharp(&self) -> bool {
        let peak = self.eval(1.0).max(self.eval(-1.0));
        2.0 * PI * peak * f64::from(f32::EPSILON) > 2e-3
    }
}
