//! Planted mistakes, which histogram and mean cosine must reject.

use super::law::Law;
use super::{CELLS, histogram, histogram_of, moment};
use std::f64::consts::PI;
use woodcock_core::phase::mie_fit::MieFit;
use woodcock_core::phase::{draine, henyey_greenstein, two_lobe::TwoLobe};
use woodcock_core::stream::{PathStream, Stream};
use woodcock_tests::refs::phase_functions::Kind;
use woodcock_tests::stats::{Mutants, must_kill, samples, seed};
use woodcock_tests::widths::collect;

type Sampler<'a> = (&'a str, &'a dyn Fn(f32) -> f32);

/// The checks agree with `real` and reject each of `mutants`, from `n` cosines.
fn all_die(suite: &str, n: usize, law: &Law, real: &dyn Fn(f32) -> f32, mutants: &[Sampler<'_>]) {
    let names: Vec<&str> = mutants.iter().map(|(name, _)| *name).collect();
    let mut suite = Mutants::new(suite, &names);
    let even: Vec<f64> = (1..CELLS)
        .map(|i| 2.0 * i as f64 / CELLS as f64 - 1.0)
        .collect();
    let mean = law.moment(1);
    let verdicts = |sampler: &dyn Fn(f32) -> f32| {
        let cosines = collect::<f32, PathStream>(seed(62), 0, samples(n), |rng| {
            sampler(Stream::<f32>::uniform(rng, true))
        });
        (
            histogram_of(&cosines, law, &even),
            moment(&cosines, 1, mean),
        )
    };
    let (law, mean) = verdicts(real);
    suite.check("histogram", law);
    suite.check("mean cosine", mean);
    for (name, sampler) in mutants {
        let (law, mean) = verdicts(sampler);
        suite.trial("histogram", name, law);
        suite.trial("mean cosine", name, mean);
    }
    suite.finish();
}

#[test]
fn of_henyey_greenstein() {
    let law = Law::from(Kind::Hg {
        g: f64::from(0.6_f32),
    });
    let mutants: [Sampler<'_>; 6] = [
        ("sign of g", &|u| henyey_greenstein::sample(u, -0.6)),
        ("g off by one percent", &|u| {
            henyey_greenstein::sample(u, 0.606)
        }),
        ("uniform angle instead of cosine", &|u| {
            (std::f32::consts::PI * u).cos()
        }),
        ("backward half lost", &|u| {
            henyey_greenstein::sample(0.2 + 0.8 * u, 0.6)
        }),
        ("g squared forgotten", &|u| {
            let a = (1.0 - 0.6 * 0.6) / (1.0 - 0.6 + 2.0 * 0.6 * u);
            ((1.0 - a * a) / 1.2).clamp(-1.0, 1.0)
        }),
        ("Schlick's approximation", &|u| {
            let k = 1.55 * 0.6 - 0.55 * 0.216;
            (2.0 * u + k - 1.0) / (2.0 * k * u - k + 1.0)
        }),
    ];
    let real = |u| henyey_greenstein::sample(u, 0.6);
    all_die("henyey_greenstein", 1 << 20, &law, &real, &mutants);
}

const LOBES: TwoLobe<f32> = TwoLobe {
    share: 0.625,
    g1: 0.75,
    g2: -0.5,
};

#[test]
fn of_two_lobes() {
    let law = Law::from(Kind::TwoTermHg {
        w: 0.625,
        g1: 0.75,
        g2: -0.5,
    });
    let lobes = |share, g1, g2| TwoLobe { share, g1, g2 };
    let mutants: [Sampler<'_>; 5] = [
        ("shares swapped", &|u| lobes(0.375, 0.75, -0.5).sample(u)),
        ("u not rescaled", &|u| {
            henyey_greenstein::sample(u, if u < 0.625 { 0.75 } else { -0.5 })
        }),
        ("the second rescaled by the first's share", &|u| {
            if u < 0.625 {
                henyey_greenstein::sample(u / 0.625, 0.75)
            } else {
                henyey_greenstein::sample((u - 0.625) / 0.625, -0.5)
            }
        }),
        ("both lobes forward", &|u| lobes(0.625, 0.75, 0.5).sample(u)),
        ("one lobe of the same mean cosine", &|u| {
            henyey_greenstein::sample(u, 0.281_25)
        }),
    ];
    all_die("two_lobe", 1 << 18, &law, &|u| LOBES.sample(u), &mutants);
}

#[test]
fn of_draine() {
    let (g, alpha) = (0.5, 3.0);
    let law = Law::from(Kind::Draine {
        g: f64::from(g),
        alpha: f64::from(alpha),
    });
    let norm = 1.0 + alpha * (1.0 + 2.0 * g * g) / 3.0;
    let mutants: [Sampler<'_>; 6] = [
        ("u not normalised", &|u| draine::sample(u / norm, g, alpha)),
        ("norm of Rayleigh's law", &|u| {
            draine::sample(u * ((1.0 + alpha / 3.0) / norm), g, alpha)
        }),
        ("squares forgotten", &|u| henyey_greenstein::sample(u, g)),
        ("lobe forgotten", &|u| draine::sample(u, 0.0, alpha)),
        ("g taken for the mean cosine", &|u| {
            draine::sample(u, draine::mean_cosine(g, alpha), alpha)
        }),
        ("the back mirrored into the front", &|u| {
            draine::sample(u.max(1.0 - u), g, alpha)
        }),
    ];
    all_die(
        "draine",
        1 << 18,
        &law,
        &|u| draine::sample(u, g, alpha),
        &mutants,
    );
}

#[test]
fn of_droplets() {
    let fit = MieFit::<f32>::new(10.0).expect("a diameter within the fit");
    let [g, alpha, share] = [fit.g_draine, fit.alpha, fit.share].map(f64::from);
    let law = Law::Blend(vec![
        (share, Kind::Draine { g, alpha }),
        (
            1.0 - share,
            Kind::Hg {
                g: f64::from(fit.g_hg),
            },
        ),
    ]);
    let swapped = MieFit {
        share: 1.0 - fit.share,
        ..fit
    };
    let twice = MieFit::<f32>::new(20.0).expect("a diameter within the fit");
    let mutants: [Sampler<'_>; 4] = [
        ("shares swapped", &|u| swapped.sample(u)),
        ("u not rescaled", &|u| {
            if u < fit.share {
                draine::sample(u, fit.g_draine, fit.alpha)
            } else {
                henyey_greenstein::sample(u, fit.g_hg)
            }
        }),
        ("radius for diameter", &|u| twice.sample(u)),
        ("α lost", &|u| MieFit { alpha: 0.0, ..fit }.sample(u)),
    ];
    all_die("mie_fit", 1 << 18, &law, &|u| fit.sample(u), &mutants);
}

/// The inverse of a table by its definition, from the segment that `choose` names and by the place that `within` does.
fn by_definition(
    nodes: &[[f64; 2]],
    u: f64,
    shift: usize,
    within: impl Fn(f64, f64, f64) -> f64,
) -> f32 {
    let area = |w: &[[f64; 2]]| 0.5 * (w[1][0] - w[0][0]) * (w[0][1] + w[1][1]);
    let whole: f64 = nodes.windows(2).map(area).sum();
    let mut below = 0.0;
    for (i, segment) in nodes.windows(2).enumerate() {
        let share = area(segment) / whole;
        if u < below + share || i + 2 == nodes.len() {
            let at = (i + shift) % (nodes.len() - 1);
            let [[a, low], [b, high]] = [nodes[at], nodes[at + 1]];
            let x = within(((u - below) / share).min(1.0), low, high);
            return (a + x * (b - a)) as f32;
        }
        below += share;
    }
    1.0
}

#[test]
fn of_tables() {
    let nodes = [
        [-1.0, 0.2],
        [-0.5, 0.1],
        [0.0, 0.15],
        [0.5, 0.4],
        [0.875, 2.0],
        [1.0, 8.0],
    ];
    let case = super::rows::tabulated::through(&nodes);
    let root = |part: f64, low: f64, high: f64| {
        let end = ((1.0 - part) * low * low + part * high * high).sqrt();
        (end - low) / (high - low)
    };
    let steps = nodes.map(|[c, _]| [c, 1.0]);
    let mutants: [Sampler<'_>; 4] = [
        ("distribution function off by one node", &|u| {
            by_definition(&nodes, f64::from(u), 1, root)
        }),
        ("even within a segment", &|u| {
            by_definition(&nodes, f64::from(u), 0, |part, _, _| part)
        }),
        ("triangle instead of the rest", &|u| {
            by_definition(&nodes, f64::from(u), 0, |part, _, _| part.sqrt())
        }),
        ("values forgotten", &|u| {
            by_definition(&steps, f64::from(u), 0, |part, _, _| part)
        }),
    ];
    all_die(
        "tabulated",
        1 << 18,
        &case.law,
        &|u| case.row.0.sample(u),
        &mutants,
    );
    // What the mistakes are planted into is right.
    let right = |u: f32| by_definition(&nodes, f64::from(u), 0, root);
    for u in super::uniforms() {
        assert!((case.row.0.sample(u) - right(u)).abs() < 1e-6);
    }
}

/// Mistakes in the inverse of a blend: the trip back, or how often each lobe is named, tells.
#[test]
fn of_inverses() {
    type Inverse<'a> = &'a dyn Fn(f32, f32) -> f32;
    let even: Vec<f64> = (1..CELLS).map(|i| i as f64 / CELLS as f64).collect();
    let law = |inverse: Inverse<'_>| {
        let us = collect::<f32, PathStream>(seed(64), 0, samples(1 << 18), |rng| {
            let [u, v] = [(); 2].map(|()| Stream::<f32>::uniform(rng, true));
            inverse(LOBES.sample(u), v)
        });
        histogram(&us, &even, |from, to| to.min(1.0) - from.max(0.0))
    };
    must_kill("always the first lobe", law(&|c, _| LOBES.invert(c, 0.0)));
    must_kill(
        "by share, not density",
        law(&|c, v| LOBES.invert(c, if v < LOBES.share { 0.0 } else { 1.0 })),
    );
    must_kill(
        "lobe not rescaled",
        law(&|c, v| {
            let u = LOBES.invert(c, v);
            if u < LOBES.share { u / LOBES.share } else { u }
        }),
    );
    // The distribution function is evenly distributed too, but it is no way back.
    let back = LOBES.sample(LOBES.cumulative(0.25));
    assert!((back - 0.25).abs() > 0.1, "{back}");
}

/// A density in a wrong measure, or unnormalised, or with a parameter amiss, fails the integrals.
#[test]
fn of_densities() {
    let hg = |g| Kind::Hg { g };
    let norm = |g: f64, alpha: f64| 1.0 + alpha * (1.0 + 2.0 * g * g) / 3.0;
    type Density<'a> = &'a dyn Fn(f64) -> f64;
    let wrong: [(Density<'_>, f64); 6] = [
        (&|c| hg(0.6).eval(c) * (1.0 - c * c).sqrt(), 0.6),
        (&|c| hg(0.6).eval(c) * 4.0 * PI, 0.6),
        (&|c| hg(0.606).eval(c), 0.6),
        (
            &|c| draine::eval(c, 0.5, 3.0) * norm(0.5, 3.0),
            draine::mean_cosine(0.5, 3.0),
        ),
        (
            &|c| draine::eval(c, 0.5, 3.0) * norm(0.5, 3.0) / norm(0.0, 3.0),
            draine::mean_cosine(0.5, 3.0),
        ),
        (
            &|c| 0.375 * hg(0.75).eval(c) + 0.625 * hg(-0.5).eval(c),
            f64::from(LOBES.mean_cosine()),
        ),
    ];
    let law = Law::from(hg(0.0));
    for (i, (p, expected)) in wrong.into_iter().enumerate() {
        let norm = law.over(-1.0, 1.0, |c| 2.0 * PI * p(c));
        let mean = law.over(-1.0, 1.0, |c| 2.0 * PI * c * p(c));
        assert!(
            (norm - 1.0).abs() > 1e-3 || (mean - expected).abs() > 1e-3,
            "mistake {i} passes"
        );
    }
}
