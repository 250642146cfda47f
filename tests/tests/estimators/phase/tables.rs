//! The row of tabulated phase functions: what all lanes share is the table.
#![expect(non_camel_case_types, reason = "the registry names files")]

use super::law::Law;
use super::rows::{Case, Parameters, Row};
use std::fmt;
use woodcock_core::phase::tabulated::{Tabulated, fill_cumulative};
use woodcock_core::real::Real;
use woodcock_tests::refs::phase_functions::{self as reference, Kind};

#[derive(Clone, Copy, PartialEq)]
pub(in super::super) struct tabulated(pub Tabulated<'static>);

impl fmt::Debug for tabulated {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "tabulated of mean cosine {}", self.0.mean_cosine())
    }
}

impl tabulated {
    /// The table of these nodes, which lives as long as the tests.
    pub(super) fn through(nodes: &[[f64; 2]]) -> Case<Self> {
        let [cosines, values] = [0, 1].map(|i| nodes.iter().map(move |n| n[i] as f32));
        let cosines: &'static [f32] = cosines.collect::<Vec<_>>().leak();
        let values: &'static [f32] = values.collect::<Vec<_>>().leak();
        let cumulative = vec![f32::NAN; cosines.len()].leak();
        fill_cumulative(cosines, values, cumulative).expect("a good table");
        let table = Tabulated::new(cosines, values, cumulative).expect("a good table");
        let exact = cosines.iter().zip(values);
        let exact = exact.map(|(&c, &v)| [c, v].map(f64::from)).collect();
        Case {
            row: Self(table),
            p: [0.0; 4],
            law: Law::table(exact),
        }
    }

    /// The table of a formula at as many even steps of the cosine.
    fn of_formula(kind: Kind, steps: usize) -> Case<Self> {
        let cosine = |i: usize| 2.0 * i as f64 / steps as f64 - 1.0;
        let nodes = (0..=steps).map(|i| [cosine(i), kind.eval(cosine(i))]);
        Self::through(&nodes.collect::<Vec<_>>())
    }
}

impl Row for tabulated {
    const TABLES: [f64; 2] = [4e-7, 2e-7];
    const DENSITY: f64 = 5e-7;

    fn cases() -> Vec<Case<Self>> {
        let reference = reference::load().tabulated;
        let mut all: Vec<_> = reference.iter().map(|t| Self::through(&t.nodes)).collect();
        let step = f64::from(0.25_f32.next_up());
        all.extend([
            // A box with jumps: nothing at all but in between, where the steps are one number wide.
            Self::through(&[
                [-1.0, 0.0],
                [-0.75, 0.0],
                [0.25, 0.0],
                [step, 3e30],
                [0.75, 3e30],
                [f64::from(0.75_f32.next_up()), 0.0],
                [1.0, 0.0],
            ]),
            Self::through(&[[-1.0, 2e-30], [1.0, 1e-30]]),
            Self::of_formula(Kind::Hg { g: 0.8 }, 1000),
        ]);
        all
    }
    fn of(kind: Kind) -> Option<Case<Self>> {
        matches!(kind, Kind::Schlick { .. }).then(|| Self::of_formula(kind, 1 << 13))
    }
    fn eval<R: Real>(self, cosine: R, _: Parameters<R>) -> R {
        self.0.eval(cosine)
    }
    fn sample<R: Real>(self, u: R, _: Parameters<R>) -> R {
        self.0.sample(u)
    }
    fn invert<R: Real>(self, cosine: R, _: R, _: Parameters<R>) -> R {
        self.0.invert(cosine)
    }
    fn mean_cosine(self, _: Parameters<f64>) -> f64 {
        f64::from(self.0.mean_cosine())
    }
    fn errors(_: Parameters<f64>) -> [f64; 2] {
        [3e-7, 2e-7]
    }
}
