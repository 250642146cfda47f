//! Planted mistakes: chromatic tracking that goes wrong the way it does. The checks must reject every one.
//!
//! Each mistake is written on its own, in plain `f64`, as what a decision does to three weights. Some wavelengths do
//! not extinguish at all, and in one of the profiles the bound lies too low: whoever clamps is found out there.

use super::{Flown, moments};
use woodcock_core::medium::Procedural;
use woodcock_core::real::Real;
use woodcock_core::spectral::{Coloured, SpectralMedium, Spectrum, Tentative, weighted};
use woodcock_core::stream::PathStream;
use woodcock_tests::rows::spectral::{Way, hero, history_aware};
use woodcock_tests::stats::independent::SplitMix;
use woodcock_tests::stats::{Moments, Mutants, Verdict, judge, samples, seed};
use woodcock_tests::widths::{per_lane, ray};

/// Extinction relative to the most opaque of three wavelengths.
const COLOUR: [f64; 3] = [1.0, 0.4, 0.0];

/// A ray of length one.
#[derive(Clone, Copy)]
struct Profile {
    /// σ of the most opaque wavelength is `slope` · t, τ half of it.
    slope: f64,
    majorant: f64,
}

/// Two whose bound holds, the second loosely; one whose bound is a fifth too low.
const TIGHT: Profile = Profile {
    slope: 4.0,
    majorant: 4.0,
};
const LOOSE: Profile = Profile {
    slope: 4.0,
    majorant: 8.0,
};
const LOW: Profile = Profile {
    slope: 2.0,
    majorant: 1.6,
};

/// A path's weights and its hero.
#[derive(Clone, Copy)]
struct State {
    w: [f64; 3],
    hero: usize,
}

/// What happens at a tentative collision of extinctions σ_λ under σ̄: whether it is real, and to the weights.
type Decide = fn(&mut State, [f64; 3], f64, &mut SplitMix) -> bool;
/// What a path brings in the end.
type Finish = fn(State) -> [f64; 3];
/// Which wavelength leads.
type Lead = fn(&mut SplitMix) -> usize;

pub(crate) struct Mutant {
    name: &'static str,
    lead: Lead,
    decide: Decide,
    finish: Finish,
}

fn any(rng: &mut SplitMix) -> usize {
    (rng.uniform() * 3.0) as usize
}

fn as_it_is(state: State) -> [f64; 3] {
    state.w
}

fn over_mean(state: State) -> [f64; 3] {
    let mean = state.w.iter().sum::<f64>() / 3.0;
    state.w.map(|w| w / mean)
}

fn history(w: [f64; 3], sigma: [f64; 3], majorant: f64) -> f64 {
    let share: f64 = (0..3).map(|i| w[i] * sigma[i]).sum();
    share / (majorant * w.iter().sum::<f64>())
}

fn mean_share(sigma: [f64; 3], majorant: f64) -> f64 {
    sigma.iter().sum::<f64>() / (3.0 * majorant)
}

/// Multiplies each weight by what its wavelength gives the outcome over the probability that is claimed.
fn weigh(state: &mut State, sigma: [f64; 3], majorant: f64, real: bool, claimed: f64) {
    for (w, s) in state.w.iter_mut().zip(sigma) {
        *w *= if real {
            s / (majorant * claimed)
        } else {
            (majorant - s) / (majorant * (1.0 - claimed))
        };
    }
}

/// Delta tracking by the hero; every wavelength's density of what happened, not divided by the hero's.
fn by_hero(state: &mut State, sigma: [f64; 3], majorant: f64, rng: &mut SplitMix) -> bool {
    let real = rng.uniform() * majorant < sigma[state.hero];
    weigh(state, sigma, majorant, real, 0.5);
    real
}

pub(crate) const MUTANTS: [Mutant; 10] = [
    Mutant {
        name: "null collisions leave the weights",
        lead: any,
        decide: |state, sigma, majorant, rng| {
            let p = history(state.w, sigma, majorant);
            let real = rng.uniform() < p;
            if real {
                weigh(state, sigma, majorant, real, p);
            }
            real
        },
        finish: as_it_is,
    },
    Mutant {
        name: "decided by the mean, weighted by the history",
        lead: any,
        decide: |state, sigma, majorant, rng| {
            let real = rng.uniform() < mean_share(sigma, majorant);
            let claimed = history(state.w, sigma, majorant);
            weigh(state, sigma, majorant, real, claimed);
            real
        },
        finish: as_it_is,
    },
    Mutant {
        name: "decided by the most opaque, weighted by the mean",
        lead: any,
        decide: |state, sigma, majorant, rng| {
            let real = rng.uniform() * majorant < sigma[0];
            weigh(state, sigma, majorant, real, mean_share(sigma, majorant));
            real
        },
        finish: as_it_is,
    },
    Mutant {
        name: "negative null weights clamped at zero",
        lead: any,
        decide: |state, sigma, majorant, rng| {
            let p = 0.5 * sigma[0] / majorant;
            let real = rng.uniform() < p;
            weigh(state, sigma, majorant, real, p);
            state.w = state.w.map(|w| w.max(0.0));
            real
        },
        finish: as_it_is,
    },
    Mutant {
        name: "the extinction of the most opaque in every null weight",
        lead: any,
        decide: |state, sigma, majorant, rng| {
            let p = mean_share(sigma, majorant);
            let real = rng.uniform() < p;
            let of = if real { sigma } else { [sigma[0]; 3] };
            weigh(state, of, majorant, real, p);
            real
        },
        finish: as_it_is,
    },
    Mutant {
        name: "a hero whose path serves all alike",
        lead: any,
        decide: by_hero,
        finish: |_| [1.0; 3],
    },
    Mutant {
        name: "divided by the hero's density, not by the mean",
        lead: any,
        decide: by_hero,
        finish: |state| state.w.map(|w| w / state.w[state.hero]),
    },
    Mutant {
        name: "divided by the sum, not by the mean",
        lead: any,
        decide: by_hero,
        finish: |state| over_mean(state).map(|w| w / 3.0),
    },
    Mutant {
        name: "always the first for a hero, weighted as one of three",
        lead: |_| 0,
        decide: by_hero,
        finish: over_mean,
    },
    Mutant {
        name: "another hero at every collision",
        lead: any,
        decide: |state, sigma, majorant, rng| {
            state.hero = any(rng);
            by_hero(state, sigma, majorant, rng)
        },
        finish: over_mean,
    },
];

fn walk(profile: Profile, mutant: &Mutant, rng: &mut SplitMix) -> Flown<3> {
    let hero = (mutant.lead)(rng);
    let mut state = State { w: [1.0; 3], hero };
    let mut t = 0.0;
    loop {
        t += rng.exponential() / profile.majorant;
        let collided = t < 1.0 && {
            let sigma = COLOUR.map(|c| c * profile.slope * t);
            (mutant.decide)(&mut state, sigma, profile.majorant, rng)
        };
        if collided || t >= 1.0 {
            let t = if collided { t } else { f64::INFINITY };
            return Flown {
                t,
                weight: (mutant.finish)(state),
            };
        }
    }
}

/// The two questions: do the weights of paths that leave add up to each transmittance, and those of paths that
/// collide within the first 0.7 to what each wavelength loses there?
fn verdicts(profile: Profile, flown: &[Flown<3>]) -> Vec<(&'static str, Verdict)> {
    let leaving = moments(flown, f64::is_infinite);
    let colliding = moments(flown, |t| t < 0.7);
    let mut verdicts = Vec::new();
    for (i, c) in COLOUR.into_iter().enumerate() {
        let depth = |t: f64| 0.5 * c * profile.slope * t * t;
        verdicts.push(("leaving", judge(&leaving[i], (-depth(1.0)).exp(), 0.005)));
        if c > 0.0 {
            let truth = -(-depth(0.7)).exp_m1();
            verdicts.push(("colliding", judge(&colliding[i], truth, 0.005)));
        }
    }
    // The mean over the wavelengths of all that leaves or collides.
    let sums = flown
        .iter()
        .map(|path| path.weight.iter().sum::<f64>() / 3.0);
    let mut all = Moments::new();
    sums.for_each(|sum| all.push(sum));
    verdicts.push(("sum of the weights", judge(&all, 1.0, 0.002)));
    verdicts
}

fn medium(profile: Profile) -> impl SpectralMedium<f32, 3> {
    let ramp = per_lane::<f32>(move |x, _, _| profile.slope * x);
    let ramp = Procedural::new(ramp, profile.majorant as f32);
    Coloured::new(ramp, COLOUR.map(|c| c as f32)).expect("valid colours")
}

fn fly<T: Way>(profile: Profile, pixel: u32, n: usize) -> Vec<Flown<3>> {
    let along = ray([0.0; 3], [1.0, 0.0, 0.0]);
    let mut flown = Vec::new();
    super::fly::<T, f32, PathStream, _, 3>(
        &medium(profile),
        &along,
        1.0,
        (seed(419), pixel),
        n,
        |path| flown.push(path),
    );
    flown
}

/// `weighted` by a probability that a low bound cannot spoil.
struct Half;
impl Way for Half {
    const BOUNDED: bool = false;
    const LEADS: bool = false;
    fn decision<R: Real, const N: usize>() -> impl woodcock_core::spectral::Decision<R, N> + Clone {
        weighted::Weighted::new(half::<R, N>)
    }
    fn sample<R: Real, const N: usize, M: SpectralMedium<R, N>>(
        medium: &M,
        ray: &woodcock_core::ray::Ray<R>,
        t_max: R,
        rng: &mut impl woodcock_core::stream::Stream<R>,
        active: R::Mask,
    ) -> woodcock_core::spectral::SpectralFlight<R, N> {
        weighted::sample(medium, ray, t_max, half::<R, N>, rng, active)
    }
    fn probability<const N: usize>(_: [f64; N], share: f64, nulls: i32, then_real: bool) -> f64 {
        woodcock_tests::rows::spectral::own_probability(0.5, share, nulls, then_real)
    }
}

fn half<R: Real, const N: usize>(event: &Tentative<R, N>, _: Spectrum<R, N>) -> R {
    R::splat(0.5) * event.sigma_t / event.majorant
}

#[test]
fn mutants_die() {
    let names = MUTANTS.map(|mutant| mutant.name);
    let mut suite = Mutants::new("spectral", &names);
    let n = samples(1 << 18);
    for (pixel, profile) in (0..).zip([TIGHT, LOOSE, LOW]) {
        let mut real = vec![fly::<Half>(profile, 3 * pixel, n)];
        // The bound that the other two promise to need.
        if profile.majorant >= profile.slope {
            real.push(fly::<history_aware::Row>(profile, 3 * pixel + 1, n));
            real.push(fly::<hero::Row>(profile, 3 * pixel + 2, n));
        }
        for flown in real {
            for (check, verdict) in verdicts(profile, &flown) {
                suite.check(check, verdict);
            }
        }
        for mutant in &MUTANTS {
            let mut rng = SplitMix::new(seed(420));
            let flown: Vec<_> = (0..n).map(|_| walk(profile, mutant, &mut rng)).collect();
            for (check, verdict) in verdicts(profile, &flown) {
                suite.trial(check, mutant.name, verdict);
            }
        }
    }
    println!("{}", suite.report());
    suite.finish();
}
