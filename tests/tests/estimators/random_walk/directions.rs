//! What turning directions at random makes of them, for every phase function that core has.
//!
//! Where each turn has the same law about the direction it turns, of any azimuth alike, Legendre moments multiply:
//!
//! ```text
//! E P_l(d₀ · dₙ) = f_lⁿ,   f_l = E P_l(cos) of the phase function
//! ```
//!
//! One turn tests the sampling of the cosine; several test that frames are orthonormal wherever a direction points,
//! at the poles above all, and that azimuths are uniform and independent. Left out: phase functions that core lacks
//! (depolarised Rayleigh, Schlick, tabulated, Mie).

use super::{Ledger, honest_and, names, record};
use woodcock_core::phase::two_lobe::TwoLobe;
use woodcock_tests::refs::phase_functions::{Kind, load};
use woodcock_tests::stats::{Mutants, Sample, judge_within};
use woodcock_tests::walker::{
    Closed, Draine, HenyeyGreenstein, Law, Lobes, Mistake, Rayleigh, Run, Space, Walk, ray, tally,
};

/// Core's law of a kind, if it has one.
fn law(kind: Kind) -> Option<Box<dyn Law>> {
    Some(match kind {
        Kind::Hg { g } => Box::new(HenyeyGreenstein(g as f32)),
        Kind::Rayleigh {} => Box::new(Rayleigh),
        Kind::Draine { g, alpha } => Box::new(Draine {
            g: g as f32,
            alpha: alpha as f32,
        }),
        Kind::TwoTermHg { w, g1, g2 } => Box::new(Lobes(TwoLobe {
            share: w as f32,
            g1: g1 as f32,
            g2: g2 as f32,
        })),
        Kind::RayleighDepol { .. } | Kind::Schlick { .. } => return None,
    })
}

/// P_1 to P_6.
fn legendre(x: f64) -> [f64; 6] {
    let mut p = [1.0, x, 0.0, 0.0, 0.0, 0.0, 0.0];
    for l in 1..6 {
        let k = l as f64;
        p[l + 1] = ((2.0 * k + 1.0) * x * p[l] - k * p[l - 1]) / (k + 1.0);
    }
    std::array::from_fn(|l| p[l + 1])
}

/// Where walks start: the poles of the frame, close to one, on the equator, and askew.
const STARTS: [[f64; 3]; 5] = [
    [0.0, 0.0, 1.0],
    [0.0, 0.0, -1.0],
    [1e-4, -1e-4, -1.0],
    [1.0, 0.0, 0.0],
    [-0.48, 0.6, -0.64],
];

/// After how many turns moments are taken.
const TURNS: [u32; 2] = [1, 3];

/// Six moments after each number of turns.
fn moments<L: Law>(walk: &Walk<Space, Closed, L>, start: [f64; 3], run: Run) -> Vec<Sample> {
    tally(run, 6 * TURNS.len(), |draws, scores| {
        let mut ray = ray([0.0; 3], start);
        let from = ray.direction;
        let mut turned = 0;
        for (stop, scores) in TURNS.iter().zip(scores.chunks_mut(6)) {
            while turned < *stop {
                walk.scatter(&mut ray, draws);
                turned += 1;
            }
            let p = legendre(ray.direction.dot(from).into());
            for (score, p) in scores.iter_mut().zip(p) {
                *score += p;
            }
        }
    })
}

#[test]
fn legendre_moments_multiply() {
    let mut ledger = Ledger::new("phase_functions");
    let mut left_out = 0;
    for (i, function) in load().functions.iter().enumerate() {
        let Some(law) = law(function.kind) else {
            left_out += 1;
            continue;
        };
        let walk = Walk::new(Space, Closed::new(1.0), law);
        let start = STARTS[i % STARTS.len()];
        let samples = moments(&walk, start, Run::new(125, i as u32, 1 << 18));
        for (turns, samples) in TURNS.iter().zip(samples.chunks(6)) {
            for (l, (sample, f)) in (1..).zip(samples.iter().zip(&function.legendre)) {
                let known = f.powi(*turns as i32);
                let name = format_args!("{:?}, P{l} after {turns}", function.kind);
                ledger.within(name, sample, known, 0.0, 0.0015);
            }
        }
    }
    assert_eq!(left_out, 2);
    ledger.finish(11 * 2 * 6);
}

/// Every start of a walk, for one phase function.
#[test]
fn no_start_is_special() {
    let mut ledger = Ledger::new("phase_functions");
    let walk = Walk::new(Space, Closed::new(1.0), HenyeyGreenstein(0.85));
    for (i, start) in STARTS.into_iter().enumerate() {
        let samples = moments(&walk, start, Run::new(126, i as u32, 1 << 18));
        // Three turns, P₂.
        let known = 0.85_f64.powi(2 * 3);
        ledger.within(format_args!("{start:?}"), &samples[7], known, 0.0, 0.0015);
    }
    ledger.finish(STARTS.len());
}

/// The mistakes that these comparisons must reject.
pub(super) const MISTAKES: [Mistake; 4] = [
    Mistake::PhaseReversed,
    Mistake::ShortFrame,
    Mistake::HalfTurn,
    Mistake::OneUniform,
];

#[test]
fn mutants_die() {
    let mut suite = Mutants::new("phase_functions", &names(&MISTAKES));
    for mistake in honest_and(&MISTAKES) {
        let mut walk = Walk::new(Space, Closed::new(1.0), HenyeyGreenstein(0.3));
        walk.mistake = mistake;
        let samples = moments(&walk, STARTS[4], Run::new(127, 0, 1 << 19));
        let mut check = |name, i: usize, known: f64| {
            let verdict = judge_within(samples[i].moments(), known, 0.005);
            record(&mut suite, name, mistake, verdict);
        };
        check("mean cosine of a turn", 0, 0.3);
        check("mean cosine of three", 6, 0.3_f64.powi(3));
        check("second moment of three", 7, 0.3_f64.powi(6));
    }
    suite.finish();
}
