//! Which of several ways to take for which rays, when a picture's variance times its time is to be least.

/// What one way came to on some rays.
#[derive(Clone, Copy, Debug, Default)]
pub struct Found {
    /// How many rays.
    pub rays: f64,
    /// The part of the picture's relative variance per path.
    pub variance: f64,
    /// Sum of the errors.
    pub error: f64,
    /// Sum of their squares.
    pub square: f64,
    /// Sum of the true values.
    pub truth: f64,
    /// CPU time in lanes \[s\].
    pub lanes: f64,
    /// CPU time ray by ray \[s\].
    pub single: f64,
    /// Look-ups of all rays, one by one.
    pub lookups: f64,
}

impl Found {
    /// How far the mean is from the truth if it were `bias` too large \[standard errors\].
    pub fn z(&self, bias: f64) -> f64 {
        (self.error + bias * self.truth) / self.square.sqrt()
    }

    /// Adds what it came to on further rays.
    pub fn add(&mut self, other: &Self) {
        self.rays += other.rays;
        self.variance += other.variance;
        self.error += other.error;
        self.square += other.square;
        self.truth += other.truth;
        self.lanes += other.lanes;
        self.single += other.single;
        self.lookups += other.lookups;
    }
}

/// A class of rays of much the same promise, measured.
#[derive(Clone, Debug)]
pub struct Measured {
    /// Number of the class.
    pub class: usize,
    /// Number of the class of promise.
    pub promise: usize,
    /// By way.
    pub found: Vec<Found>,
    /// CPU time of finding the depths beforehand \[s\].
    pub walks: f64,
}

/// Sums by way over the groups that a filter takes.
pub fn sums(measured: &[Measured], takes: impl Fn(&Measured) -> bool) -> Vec<Found> {
    let ways = measured.first().map_or(0, |m| m.found.len());
    let mut sums = vec![Found::default(); ways];
    for group in measured.iter().filter(|m| takes(m)) {
        for (sum, found) in sums.iter_mut().zip(&group.found) {
            sum.add(found);
        }
    }
    sums
}

/// A picture's variance and time, each per path: in all, and without what its shadow rays add.
#[derive(Clone, Copy, Debug)]
pub struct Whole {
    /// Relative variance of a path.
    pub variance: f64,
    /// CPU time of a path \[s\].
    pub seconds: f64,
    /// Relative variance of a path whose shadow rays are exact.
    pub exact: f64,
    /// CPU time of a path but for its shadow rays \[s\].
    pub rest: f64,
    /// How many paths sent the rays.
    pub paths: f64,
}

impl Whole {
    /// How many times as efficient the picture would be.
    pub fn gain(&self, variance: f64, seconds: f64) -> f64 {
        self.variance * self.seconds / ((self.exact + variance) * (self.rest + seconds))
    }

    /// The best choice of a way and of how often for each kind of rays, given sums by kind and way: its gain, and the choice.
    ///
    /// * `known`: time that it takes to know the kinds of all rays \[s\].
    pub fn best(
        &self,
        kinds: &[Vec<Found>],
        repeated: &[u32],
        known: f64,
    ) -> (f64, Vec<(usize, u32)>) {
        let mut best = (0.0, Vec::new());
        // The product of variance and time is least where their weighted sum is, for some weight.
        for step in 0..200 {
            let price = self.exact / self.rest * 10_f64.powf(f64::from(step) * 0.05 - 5.0);
            let (mut variance, mut seconds) = (0.0, known / self.paths);
            let mut choice = Vec::new();
            for ways in kinds {
                let options = ways.iter().enumerate().flat_map(|(way, found)| {
                    repeated.iter().map(move |n| {
                        let times = f64::from(*n);
                        let seconds = found.lanes * times / self.paths;
                        (found.variance / times, seconds, (way, *n))
                    })
                });
                let cost = |option: &(f64, f64, (usize, u32))| option.0 + price * option.1;
                if let Some(chosen) = options.min_by(|a, b| cost(a).total_cmp(&cost(b))) {
                    variance += chosen.0;
                    seconds += chosen.1;
                    choice.push(chosen.2);
                }
            }
            let gain = self.gain(variance, seconds);
            if gain > best.0 {
                best = (gain, choice);
            }
        }
        best
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Variance and seconds of a way on a million rays of a million paths.
    fn way(variance: f64, seconds: f64) -> Found {
        Found {
            rays: 1e6,
            variance,
            lanes: 1e6 * seconds,
            ..Found::default()
        }
    }

    const WHOLE: Whole = Whole {
        variance: 2.0,
        seconds: 1.1,
        exact: 1.0,
        rest: 1.0,
        paths: 1e6,
    };

    #[test]
    fn repeating_pays_until_time_outweighs_noise() {
        // (1 + 1/n) (1 + n/10) is least at n = √10.
        let repeated: Vec<u32> = (1..9).collect();
        let (gain, choice) = WHOLE.best(&[vec![way(1.0, 0.1)]], &repeated, 0.0);
        assert_eq!(choice, [(0, 3)]);
        assert!((gain - 2.2 / (4.0 / 3.0 * 1.3)).abs() < 1e-12, "{gain}");
    }

    #[test]
    fn each_kind_gets_the_way_that_suits_it() {
        let kinds = [
            vec![way(0.9, 0.01), way(0.01, 0.2)],
            vec![way(0.1, 0.09), way(0.09, 0.9)],
        ];
        let (gain, choice) = WHOLE.best(&kinds, &[1], 0.0);
        assert_eq!(choice, [(1, 1), (0, 1)]);
        assert!((gain - 2.2 / (1.11 * 1.29)).abs() < 1e-12, "{gain}");
        // What it takes to know the kinds counts.
        let (known, _) = WHOLE.best(&kinds, &[1], 1e6);
        assert!((known - 2.2 / (1.11 * 2.29)).abs() < 1e-12, "{known}");
    }
}
