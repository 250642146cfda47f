//! A choice among numbered things in proportion to weights: inversion of running sums.

/// The largest number below one.
pub(crate) const BELOW_ONE: f64 = 1.0 - f64::EPSILON / 2.0;

/// Running sums of weights, 8 bytes each. Inversion keeps the order of the random numbers, and so their
/// stratification, which an alias table does not.
#[derive(Debug, Default)]
pub(crate) struct Discrete {
    sums: Box<[f64]>,
}

impl Discrete {
    /// * `weights`: not negative; their sum finite.
    pub(crate) fn new(weights: impl Iterator<Item = f64>) -> Self {
        let mut sum = 0.0;
        let sums = weights.map(|weight| {
            sum += weight;
            sum
        });
        Self {
            sums: sums.collect(),
        }
    }

    /// The sum of all weights.
    pub(crate) fn total(&self) -> f64 {
        self.sums.last().copied().unwrap_or(0.0)
    }

    fn before(&self, index: usize) -> f64 {
        let previous = index.checked_sub(1).and_then(|i| self.sums.get(i));
        previous.copied().unwrap_or(0.0)
    }

    /// The probability of a thing: exactly that of [`choose`](Self::choose), rounding of the sums included. Zero if
    /// there is no such thing.
    pub(crate) fn probability(&self, index: usize) -> f64 {
        let total = self.total();
        match self.sums.get(index) {
            Some(sum) if total > 0.0 => (sum - self.before(index)) / total,
            _ => 0.0,
        }
    }

    /// A thing at u in [0, 1), and what is left of u, again uniform in [0, 1). Never one of weight zero; `None` if all
    /// are.
    pub(crate) fn choose(&self, u: f64) -> Option<(usize, f64)> {
        let total = self.total();
        if total <= 0.0 {
            return None;
        }
        let at = u * total;
        let mut index = self.sums.partition_point(|sum| *sum <= at);
        if index == self.sums.len() {
            // The product was rounded up to the total.
            index = self.sums.partition_point(|sum| *sum < total);
        }
        let before = self.before(index);
        let width = self.sums.get(index)? - before;
        Some((index, ((at - before) / width).clamp(0.0, BELOW_ONE)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn intervals_tile_the_unit_and_things_without_weight_are_never_met() {
        let weights = [0.0, 3.0, 0.0, 0.0, 1.0, 4.0, 0.0];
        let table = Discrete::new(weights.into_iter());
        let mut sum = 0.0;
        for (i, weight) in weights.into_iter().enumerate() {
            assert_eq!(table.probability(i), weight / 8.0);
            sum += table.probability(i);
        }
        assert_eq!(sum, 1.0);
        assert_eq!(table.probability(7), 0.0);
        assert_eq!(table.choose(0.0), Some((1, 0.0)));
        assert_eq!(table.choose(0.375), Some((4, 0.0)));
        assert_eq!(table.choose(0.75), Some((5, 0.5)));
        let (last, rest) = table.choose(BELOW_ONE).expect("weights");
        assert!(last == 5 && rest < 1.0);
    }

    #[test]
    fn without_weight_there_is_no_choice() {
        assert_eq!(Discrete::default().choose(0.5), None);
        assert_eq!(Discrete::new([0.0, 0.0].into_iter()).choose(0.5), None);
        assert_eq!(Discrete::new([0.0].into_iter()).probability(0), 0.0);
    }

    #[test]
    fn rounding_up_to_the_total_stays_within() {
        // A sum whose product with the largest number below one rounds to the sum itself.
        let table = Discrete::new([1.0, 0.9, 0.0].into_iter());
        let (index, rest) = table.choose(BELOW_ONE).expect("weights");
        assert!(index == 1 && rest < 1.0);
        // What is added to a large sum without changing it has no probability, and is not met.
        let table = Discrete::new([1.0, 1e-20].into_iter());
        assert_eq!(table.probability(1), 0.0);
        assert_eq!(table.choose(BELOW_ONE).map(|c| c.0), Some(0));
    }
}
