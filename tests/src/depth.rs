//! Optical depth along a ray, in double precision: what sampled flights are compared with.
//!
//! ```text
//! τ(t) = ∫₀ᵗ σ_t(s) ds
//! ```
//!
//! by Gauss–Legendre of three nodes between given edges, which is exact for polynomials of degree five: trilinear
//! media, cubic along a ray, lose nothing where the edges are the cell faces. Elsewhere the edges must lie close and
//! none of the jumps between them.

/// τ as a function of distance.
pub struct Depth<'a> {
    edges: Vec<f64>,
    cumulative: Vec<f64>,
    sigma_t: Box<dyn Fn(f64) -> f64 + 'a>,
}

impl std::fmt::Debug for Depth<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Depth")
            .field("pieces", &(self.edges.len() - 1))
            .field("total", &self.total())
            .finish_non_exhaustive()
    }
}

fn gauss(a: f64, b: f64, f: &dyn Fn(f64) -> f64) -> f64 {
    let (middle, half) = (0.5 * (a + b), 0.5 * (b - a));
    let node = half * 0.6_f64.sqrt();
    half * (5.0 * f(middle - node) + 8.0 * f(middle) + 5.0 * f(middle + node)) / 9.0
}

impl<'a> Depth<'a> {
    /// Over [0, `t_max`], in `pieces` equal ones cut further at `breaks`.
    pub fn new(
        t_max: f64,
        pieces: usize,
        breaks: &[f64],
        sigma_t: impl Fn(f64) -> f64 + 'a,
    ) -> Self {
        let mut edges: Vec<f64> = (0..=pieces)
            .map(|i| t_max * i as f64 / pieces as f64)
            .chain(breaks.iter().copied().filter(|&t| t > 0.0 && t < t_max))
            .collect();
        edges.sort_by(f64::total_cmp);
        edges.dedup();
        let mut cumulative = vec![0.0];
        let mut sum = 0.0;
        for pair in edges.windows(2) {
            sum += gauss(pair[0], pair[1], &sigma_t);
            cumulative.push(sum);
        }
        Self {
            edges,
            cumulative,
            sigma_t: Box::new(sigma_t),
        }
    }

    /// τ(t), for t in [0, t_max].
    pub fn at(&self, t: f64) -> f64 {
        let piece = self
            .edges
            .partition_point(|&e| e <= t)
            .clamp(1, self.edges.len() - 1)
            - 1;
        self.cumulative[piece] + gauss(self.edges[piece], t, &*self.sigma_t)
    }

    /// τ(t_max).
    pub fn total(&self) -> f64 {
        self.cumulative.last().copied().unwrap_or(0.0)
    }

    /// P(collision before t) = 1 − e^−τ(t).
    pub fn collided(&self, t: f64) -> f64 {
        -(-self.at(t)).exp_m1()
    }

    /// ∫σ_t² dt over the whole ray [1/length].
    pub fn squared_integral(&self) -> f64 {
        let square = |t: f64| (self.sigma_t)(t).powi(2);
        // Six further cuts of a piece: the square has twice the degree.
        self.edges
            .windows(2)
            .flat_map(|w| {
                let step = (w[1] - w[0]) / 6.0;
                (0..6).map(move |i| (w[0] + step * f64::from(i), w[0] + step * f64::from(i + 1)))
            })
            .map(|(a, b)| gauss(a, b, &square))
            .sum()
    }

    /// ∫ e^−τ(t) dt = E min(flight, t_max) \[length\].
    pub fn mean_free_flight(&self) -> f64 {
        self.attenuated(|_| 1.0)
    }

    /// ∫ f(t) e^−τ(t) dt over the whole ray, for `f` as smooth between the edges as the extinction.
    pub fn attenuated(&self, f: impl Fn(f64) -> f64) -> f64 {
        let (mut integral, mut passed) = (0.0, 0.0);
        for w in self.edges.windows(2) {
            // One further cut: τ has a degree more than the extinction, and its exponential all of them.
            let step = (w[1] - w[0]) / 2.0;
            for a in [w[0], w[0] + step] {
                let attenuation = |t: f64| (-(passed + gauss(a, t, &*self.sigma_t))).exp();
                integral += gauss(a, a + step, &|t| f(t) * attenuation(t));
                passed += gauss(a, a + step, &*self.sigma_t);
            }
        }
        integral
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixtures;

    #[test]
    fn it_reproduces_the_table_of_fixtures() {
        for fixture in fixtures::all() {
            let ray = &fixture.ray;
            let depth = Depth::new(ray.t_max, 400, &fixture.breaks(), fixture.along());
            let close = |got: f64, expected: f64| {
                assert!(
                    (got - expected).abs() < 1e-9 * (1.0 + expected),
                    "{}: {got:e} for {expected:e}",
                    fixture.name
                );
            };
            close(depth.total(), ray.optical_depth);
            for (i, &expected) in ray.quarter_depths.iter().enumerate() {
                close(depth.at(ray.t_max * (i + 1) as f64 / 4.0), expected);
            }
            close(depth.squared_integral(), ray.squared_integral);
            close(depth.mean_free_flight(), ray.mean_free_flight);
        }
    }
}
