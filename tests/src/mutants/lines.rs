//! Mistakes in line integrals: a comb of walks, scored at collisions or at all tentative points.

use super::Profile;
use crate::stats::independent::SplitMix;

/// A ray with light on its way and at its end.
#[derive(Clone, Copy)]
pub struct Line<'a> {
    /// Its extinction.
    pub profile: Profile<'a>,
    /// c_V(t).
    pub volume: &'a dyn Fn(f64) -> f64,
    /// c_∂V.
    pub boundary: f64,
}

impl std::fmt::Debug for Line<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{:?}, {} at its end", self.profile, self.boundary)
    }
}

/// A planted mistake in line integrals.
pub type LineMutant = fn(&Line<'_>, &mut SplitMix) -> f64;

/// Mistakes in line integrals, by name.
pub const LINES: &[(&str, LineMutant)] = &[
    ("teeth without the share that collides", |line, rng| {
        let comb = Comb::honest(&line.profile, rng);
        let score = comb.mean(|t, _| collisions(line, t, rng));
        comb.reach * line.boundary + score
    }),
    ("end scored by the first tooth only", |line, rng| {
        let comb = Comb::honest(&line.profile, rng);
        let dark = Line {
            boundary: 0.0,
            ..*line
        };
        comb.estimate(line, |t, tooth| {
            collisions(if tooth == 0 { line } else { &dark }, t, rng)
        })
    }),
    ("source not divided by the extinction", |line, rng| {
        let sigma_t = line.profile.sigma_t;
        let volume = |t: f64| (line.volume)(t) * sigma_t(t);
        let brighter = Line {
            volume: &volume,
            ..*line
        };
        Comb::honest(&line.profile, rng).estimate(line, |t, _| collisions(&brighter, t, rng))
    }),
    ("light lost where nothing collides", |line, rng| {
        Comb::honest(&line.profile, rng).estimate(line, |t, _| collisions(line, t, rng))
    }),
    (
        "tentative points weighted before they score",
        |line, rng| {
            Comb::honest(&line.profile, rng)
                .estimate(line, |t, _| tentative(line, t, rng, true, |w| w))
        },
    ),
    ("end not weighted", |line, rng| {
        Comb::honest(&line.profile, rng)
            .estimate(line, |t, _| tentative(line, t, rng, false, |_| 1.0))
    }),
];

/// The first tentative points of some walks.
#[derive(Clone, Copy)]
pub(super) struct Comb {
    /// e^−D, the share without a tentative point.
    pub(super) reach: f64,
    /// The interval [0, p) that the teeth divide.
    pub(super) collides: f64,
    /// In [0, 1).
    pub(super) offset: f64,
    pub(super) majorant: f64,
}

impl Comb {
    /// How many walks.
    pub(super) const WALKS: u32 = 4;

    pub(super) fn honest(p: &Profile<'_>, rng: &mut SplitMix) -> Self {
        let reach = (-p.majorant * p.t_max).exp();
        Self {
            reach,
            collides: 1.0 - reach,
            offset: rng.uniform(),
            majorant: p.majorant,
        }
    }

    /// The mean of `score`(first tentative point, tooth).
    fn mean(&self, mut score: impl FnMut(f64, u32) -> f64) -> f64 {
        let walks = f64::from(Self::WALKS);
        let scores = (0..Self::WALKS).map(|tooth| {
            let u = self.collides * (f64::from(tooth) + self.offset) / walks;
            score(-(-u).ln_1p() / self.majorant, tooth)
        });
        scores.sum::<f64>() / walks
    }

    pub(super) fn estimate(&self, line: &Line<'_>, score: impl FnMut(f64, u32) -> f64) -> f64 {
        self.reach * line.boundary + self.collides * self.mean(score)
    }
}

/// A walk of delta tracking from its first tentative point on: c_V/σ_t where it ends.
pub(super) fn collisions(line: &Line<'_>, mut t: f64, rng: &mut SplitMix) -> f64 {
    let p = &line.profile;
    loop {
        if t >= p.t_max {
            return line.boundary;
        }
        let sigma_t = (p.sigma_t)(t);
        if rng.uniform() * p.majorant < sigma_t {
            return (line.volume)(t) / sigma_t;
        }
        t += rng.exponential() / p.majorant;
    }
}

/// A walk that scores at every tentative point; `end` weights what it finds at the end.
fn tentative(
    line: &Line<'_>,
    mut t: f64,
    rng: &mut SplitMix,
    too_late: bool,
    end: impl Fn(f64) -> f64,
) -> f64 {
    let p = &line.profile;
    let (mut weight, mut sum) = (1.0, 0.0);
    while t < p.t_max {
        let before = weight;
        weight *= 1.0 - (p.sigma_t)(t) / p.majorant;
        let scored = if too_late { weight } else { before };
        sum += scored * (line.volume)(t) / p.majorant;
        t += rng.exponential() / p.majorant;
    }
    sum + end(weight) * line.boundary
}
