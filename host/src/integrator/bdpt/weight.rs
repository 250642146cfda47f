//! What share of a path each strategy gets: the balance heuristic over all that could have sampled it.
//!
//! A path has vertices x₀ on a light to x_{k−1} on the camera. Strategy s samples x₀ … x_{s−1} from the light and the rest
//! from the camera. With `light[i]` the density of xᵢ when sampled from the light's side and `camera[i]` from the
//! camera's,
//!
//! ```text
//! p_s = ∏_{i<s} light[i] · ∏_{i≥s} camera[i],   weight of s = p_s / Σ_s' p_s'
//! ```
//!
//! Densities count null collisions as vertices ([Miller 2019]): the tentative collisions on a segment have the same Poisson
//! density from either end, so all that is left of them is the segment's passage w = ∏(1 − σ/σ̄), which an analog flight
//! has and a connection lacks.
//!
//! The weights sum to one for each path whatever the densities are, as long as they are functions of the path alone; that
//! they are the true ones keeps the variance low. Strategy 1 samples its light anew from x₁ (`next_event`), the others by
//! power (`emitted`): x₀ has two densities.

/// A path as weights see it.
#[derive(Clone, Debug, Default)]
pub(super) struct Densities {
    /// Density from the light's side; that of x₀ is `emitted` or `next_event` instead.
    pub(super) light: Vec<f64>,
    /// Density from the camera's side.
    pub(super) camera: Vec<f64>,
    /// Whether connections to the vertex bring light.
    pub(super) connects: Vec<bool>,
    /// 1/r² of the segment from the vertex to the next, for the bound on connections.
    pub(super) closeness: Vec<f64>,
    /// Density of x₀ where light sets out.
    pub(super) emitted: f64,
    /// Density of x₀ where it is sampled from x₁.
    pub(super) next_event: f64,
    /// No camera path can find the light.
    pub(super) delta: bool,
}

impl Densities {
    /// Empties it.
    pub(super) fn clear(&mut self) {
        self.light.clear();
        self.camera.clear();
        self.connects.clear();
        self.closeness.clear();
    }

    /// Whether a strategy can sample the path.
    fn possible(&self, s: usize) -> bool {
        let k = self.camera.len();
        let connects = |i: usize| self.connects.get(i).copied().unwrap_or(false);
        match s {
            0 => !self.delta,
            // A light is not seen by connecting it to the camera.
            1 => k > 2 && connects(1) && self.next_event > 0.0,
            _ => s < k && connects(s - 1) && connects(s),
        }
    }

    /// The ratio of p_{s+1} to p_s.
    fn step(&self, s: usize) -> f64 {
        let light = match s {
            0 => self.next_event,
            1 => self.emitted / self.next_event * self.light[1],
            _ => self.light[s],
        };
        light / self.camera[s]
    }

    /// The shares of all strategies, each relative to that of strategy `s`.
    fn relative(&self, s: usize, shares: &mut Vec<f64>) {
        let k = self.camera.len();
        shares.clear();
        shares.resize(k, 0.0);
        // A strategy that cannot be still lies between others: ratios go on through it.
        let mut ratio = 1.0;
        for i in s..k - 1 {
            if i == 0 && self.next_event == 0.0 {
                // Only setting out finds the light: go from 0 to 2 at once.
                ratio *= self.emitted / self.camera[0];
                continue;
            }
            ratio *= if i == 1 && self.next_event == 0.0 {
                self.light[1] / self.camera[1]
            } else {
                self.step(i)
            };
            shares[i + 1] = bounded(ratio);
        }
        ratio = 1.0;
        for i in (0..s).rev() {
            ratio *= if self.next_event == 0.0 && i == 1 {
                self.camera[1] / self.light[1]
            } else if self.next_event == 0.0 && i == 0 {
                self.camera[0] / self.emitted
            } else {
                1.0 / self.step(i)
            };
            shares[i] = bounded(ratio);
        }
        shares[s] = 1.0;
        for (i, share) in shares.iter_mut().enumerate() {
            if !self.possible(i) {
                *share = 0.0;
            }
        }
    }

    /// The weight of strategy `s`, which sampled the path.
    ///
    /// * `bound`: if given, connections of closeness 1/r² beyond it keep the share bound · r² of their weight, and
    ///   the rest goes to the strategy whose camera path is longer by one vertex ([Kollig, Keller 2004]); so no connection of
    ///   subpaths brings more than the bound, and nothing is lost.
    pub(super) fn weight(&self, s: usize, bound: Option<f64>, shares: &mut Vec<f64>) -> f64 {
        self.relative(s, shares);
        let sum: f64 = shares.iter().sum();
        let Some(bound) = bound else {
            return 1.0 / sum;
        };
        let k = shares.len();
        let lowest = (0..k).find(|i| shares[*i] > 0.0).unwrap_or(s);
        let mut passed_on = 0.0;
        for i in (s..k).rev() {
            if shares[i] == 0.0 {
                continue;
            }
            let all = shares[i] + passed_on;
            let kept = match self.closeness.get(i.wrapping_sub(1)) {
                Some(closeness) if i >= 2 && i + 1 < k && i > lowest && *closeness > bound => {
                    bound / closeness
                }
                _ => 1.0,
            };
            if i == s {
                return all * kept / sum;
            }
            passed_on = all * (1.0 - kept);
        }
        0.0
    }
}

/// A ratio that stays a number.
fn bounded(ratio: f64) -> f64 {
    if ratio.is_nan() {
        0.0
    } else {
        ratio.min(1e200)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn path() -> Densities {
        Densities {
            light: vec![0.0, 0.7, 1.3, 0.2, 2.0],
            camera: vec![0.4, 0.9, 3.0, 0.6, 1.0],
            connects: vec![true; 5],
            closeness: vec![0.5, 40.0, 900.0, 0.1, 0.0],
            emitted: 0.3,
            next_event: 1.7,
            delta: false,
        }
    }

    /// p_s by its definition.
    fn density(path: &Densities, s: usize) -> f64 {
        let first = match s {
            0 => path.camera[0],
            1 => path.next_event,
            _ => path.emitted,
        };
        (1..5).fold(first, |p, i| {
            p * if i < s { path.light[i] } else { path.camera[i] }
        })
    }

    #[test]
    fn weights_are_the_balance_heuristic() {
        let path = path();
        let all: f64 = (0..5).map(|s| density(&path, s)).sum();
        for s in 0..5 {
            let weight = path.weight(s, None, &mut Vec::new());
            assert!((weight - density(&path, s) / all).abs() < 1e-14, "{s}");
        }
    }

    #[test]
    fn weights_sum_to_one_whatever_connects() {
        for pattern in 0..16_u32 {
            for (delta, unseen) in [(false, false), (true, false), (false, true)] {
                let mut path = path();
                for i in 0..3 {
                    path.connects[i + 1] = pattern >> i & 1 == 1;
                }
                path.delta = delta;
                if unseen {
                    path.next_event = 0.0;
                }
                for bound in [None, Some(100.0), Some(1.0)] {
                    let possible: Vec<_> = (0..5).filter(|s| path.possible(*s)).collect();
                    let sum: f64 = possible
                        .iter()
                        .map(|s| path.weight(*s, bound, &mut Vec::new()))
                        .sum();
                    let expected = if possible.is_empty() { 0.0 } else { 1.0 };
                    assert!((sum - expected).abs() < 1e-13, "{pattern} {bound:?} {sum}");
                }
            }
        }
    }

    #[test]
    fn the_bound_tames_what_is_close() {
        let path = path();
        let free = path.weight(3, None, &mut Vec::new());
        let tamed = path.weight(3, Some(90.0), &mut Vec::new());
        assert!((tamed / free - 0.1).abs() < 1e-12);
        let rest = path.weight(2, Some(90.0), &mut Vec::new());
        let before = path.weight(2, None, &mut Vec::new());
        assert!((rest - before - 0.9 * free).abs() < 1e-12);
    }
}
