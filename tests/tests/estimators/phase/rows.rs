//! The rows of the registry of phase functions behind one signature, with their parameter sets.
#![expect(non_camel_case_types, reason = "the registry names files")]

use super::law::Law;
use std::fmt::Debug;
use woodcock_core::phase::{self, mie_fit::MieFit, two_lobe::TwoLobe};
use woodcock_core::real::Real;
use woodcock_tests::refs::phase_functions::Kind;

/// Parameters per lane; those that a phase function does not have are 0.
pub(super) type Parameters<R> = [R; 4];

/// A phase function over any number: `self` is what all lanes share, `p` what each has of its own.
pub(super) trait Row: Copy + Debug + PartialEq + 'static {
    /// Whether the cosines rise, or fall, all along u; else `invert` needs its second number.
    const MONOTONE: bool = true;
    /// How exactly `f64` reproduces the tables: densities (relative) and distribution functions.
    const TABLES: [f64; 2] = [1e-7, 1e-12];

    /// Largest relative error of densities of `f32`.
    const DENSITY: f64 = 2e-6;

    /// What is under test.
    fn cases() -> Vec<Case<Self>>;
    /// More parameters, where only ranges and the errors of `f32` are.
    fn extremes() -> Vec<Case<Self>> {
        Vec::new()
    }
    /// This function of the tables, if this row can be it.
    fn of(kind: Kind) -> Option<Case<Self>>;

    fn eval<R: Real>(self, cosine: R, p: Parameters<R>) -> R;
    fn sample<R: Real>(self, u: R, p: Parameters<R>) -> R;
    fn invert<R: Real>(self, cosine: R, v: R, p: Parameters<R>) -> R;
    fn mean_cosine(self, p: Parameters<f64>) -> f64;
    /// P(cosine < c).
    fn cumulative<R: Real>(self, cosine: R, p: Parameters<R>) -> R {
        let u = self.invert(cosine, R::zero(), p);
        // A lobe of negative g is turned around: its cosines fall.
        R::select(p[0].lt(R::zero()), R::one() - u, u)
    }
    /// Largest error of sampled cosines of `f32`: of the cosine, and of the u that it belongs to.
    fn errors(p: Parameters<f64>) -> [f64; 2];
}

/// One phase function with its parameters and what it should be.
#[derive(Clone, Debug)]
pub(super) struct Case<T> {
    pub row: T,
    pub p: Parameters<f64>,
    pub law: Law,
}

impl<T: Row> Case<T> {
    fn new(row: T, p: &[f64], law: impl Into<Law>) -> Self {
        let mut all = [0.0; 4];
        all[..p.len()].copy_from_slice(p);
        Self {
            row,
            p: all,
            law: law.into(),
        }
    }
    /// The parameters as `f32`.
    pub(super) fn single(&self) -> Parameters<f32> {
        self.p.map(|p| p as f32)
    }
    /// What messages call it.
    pub(super) fn name(&self) -> String {
        format!("{:?} {:?}", self.row, self.p)
    }
}

/// Numbers of `f32` as `f64`, and their negatives.
fn both_signs(magnitudes: &[f32]) -> impl Iterator<Item = f64> {
    let exact = magnitudes.iter().map(|&g| f64::from(g));
    exact.flat_map(|g| [g, -g])
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct isotropic;
impl Row for isotropic {
    fn cases() -> Vec<Case<Self>> {
        Self::of(Kind::Hg { g: 0.0 }).into_iter().collect()
    }
    fn of(kind: Kind) -> Option<Case<Self>> {
        (kind == Kind::Hg { g: 0.0 }).then(|| Case::new(Self, &[], kind))
    }
    fn eval<R: Real>(self, cosine: R, _: Parameters<R>) -> R {
        phase::isotropic::eval(cosine)
    }
    fn sample<R: Real>(self, u: R, _: Parameters<R>) -> R {
        phase::isotropic::sample(u)
    }
    fn invert<R: Real>(self, cosine: R, _: R, _: Parameters<R>) -> R {
        phase::isotropic::invert(cosine)
    }
    fn mean_cosine(self, _: Parameters<f64>) -> f64 {
        0.0
    }
    fn errors(_: Parameters<f64>) -> [f64; 2] {
        [6e-8, 0.0]
    }
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct henyey_greenstein;
impl Row for henyey_greenstein {
    fn cases() -> Vec<Case<Self>> {
        let all = both_signs(&[
            0.0, 1e-7, 1e-4, 1e-3, 0.1, 0.3, 0.5, 0.85, 0.99, 0.999, 0.9999,
        ]);
        all.filter_map(|g| Self::of(Kind::Hg { g })).collect()
    }
    fn extremes() -> Vec<Case<Self>> {
        let all = both_signs(&[1e-6, 1e-5, 0.99999, 0.999_999, 1.0 - 1e-7]);
        all.filter_map(|g| Self::of(Kind::Hg { g })).collect()
    }
    fn of(kind: Kind) -> Option<Case<Self>> {
        match kind {
            Kind::Hg { g } => Some(Case::new(Self, &[g], kind)),
            _ => None,
        }
    }
    fn eval<R: Real>(self, cosine: R, [g, ..]: Parameters<R>) -> R {
        phase::henyey_greenstein::eval(cosine, g)
    }
    fn sample<R: Real>(self, u: R, [g, ..]: Parameters<R>) -> R {
        phase::henyey_greenstein::sample(u, g)
    }
    fn invert<R: Real>(self, cosine: R, _: R, [g, ..]: Parameters<R>) -> R {
        phase::henyey_greenstein::invert(cosine, g)
    }
    fn mean_cosine(self, [g, ..]: Parameters<f64>) -> f64 {
        g
    }
    fn errors([g, ..]: Parameters<f64>) -> [f64; 2] {
        [if g.abs() <= 0.9999 { 2e-7 } else { 1e-6 }, 0.0]
    }
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct rayleigh;
impl Row for rayleigh {
    fn cases() -> Vec<Case<Self>> {
        Self::of(Kind::Rayleigh {}).into_iter().collect()
    }
    fn of(kind: Kind) -> Option<Case<Self>> {
        (kind == Kind::Rayleigh {}).then(|| Case::new(Self, &[], kind))
    }
    fn eval<R: Real>(self, cosine: R, _: Parameters<R>) -> R {
        phase::rayleigh::eval(cosine)
    }
    fn sample<R: Real>(self, u: R, _: Parameters<R>) -> R {
        phase::rayleigh::sample(u)
    }
    fn invert<R: Real>(self, cosine: R, _: R, _: Parameters<R>) -> R {
        phase::rayleigh::invert(cosine)
    }
    fn mean_cosine(self, _: Parameters<f64>) -> f64 {
        0.0
    }
    fn errors(_: Parameters<f64>) -> [f64; 2] {
        [2e-7, 0.0]
    }
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct two_lobe;
impl two_lobe {
    fn with<R>([share, g1, g2, _]: Parameters<R>) -> TwoLobe<R> {
        TwoLobe { share, g1, g2 }
    }
    fn case([w, g1, g2]: [f32; 3]) -> Option<Case<Self>> {
        let [w, g1, g2] = [w, g1, g2].map(f64::from);
        Self::of(Kind::TwoTermHg { w, g1, g2 })
    }
}
impl Row for two_lobe {
    const MONOTONE: bool = false;

    fn cases() -> Vec<Case<Self>> {
        let sets = [
            [0.8, 0.9, -0.4],
            [0.3, -0.5, 0.7],
            [0.5, 0.2, 0.2],
            [0.0, 0.9, 0.5],
            [1.0, -0.6, 0.99],
            [0.02, 0.0, 0.95],
        ];
        sets.into_iter().filter_map(Self::case).collect()
    }
    fn extremes() -> Vec<Case<Self>> {
        let sets = [
            [1e-7, 0.9, -0.9],
            [1.0 - 1e-7, 0.9999, -0.5],
            [0.5, 0.9999, -0.9999],
            [1e-30, 0.5, 1e-7],
        ];
        sets.into_iter().filter_map(Self::case).collect()
    }
    fn of(kind: Kind) -> Option<Case<Self>> {
        match kind {
            Kind::TwoTermHg { w, g1, g2 } => Some(Case::new(Self, &[w, g1, g2], kind)),
            _ => None,
        }
    }
    fn eval<R: Real>(self, cosine: R, p: Parameters<R>) -> R {
        Self::with(p).eval(cosine)
    }
    fn sample<R: Real>(self, u: R, p: Parameters<R>) -> R {
        Self::with(p).sample(u)
    }
    fn invert<R: Real>(self, cosine: R, v: R, p: Parameters<R>) -> R {
        Self::with(p).invert(cosine, v)
    }
    fn mean_cosine(self, p: Parameters<f64>) -> f64 {
        Self::with(p).mean_cosine()
    }
    fn cumulative<R: Real>(self, cosine: R, p: Parameters<R>) -> R {
        Self::with(p).cumulative(cosine)
    }
    fn errors(_: Parameters<f64>) -> [f64; 2] {
        [4e-7, 0.0]
    }
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct draine;
impl draine {
    fn grid(magnitudes: &[f32], alphas: &[f32]) -> Vec<Case<Self>> {
        let pairs = both_signs(magnitudes).flat_map(|g| {
            let alphas = alphas.iter().map(|&alpha| f64::from(alpha));
            alphas.map(move |alpha| Kind::Draine { g, alpha })
        });
        pairs.filter_map(Self::of).collect()
    }
}
impl Row for draine {
    fn cases() -> Vec<Case<Self>> {
        let mut all = Self::grid(&[0.3, 0.95], &[1.0, 250.0]);
        all.extend(Self::grid(&[0.0, 0.6], &[30.0]));
        all.extend(Self::grid(&[1e-7, 0.9999], &[0.5]));
        all.extend(Self::grid(&[1e-3], &[1e4]));
        all
    }
    fn extremes() -> Vec<Case<Self>> {
        let alphas = [0.0, 1e-13, 1e-6, 0.1, 1.0, 3.0, 10.0, 100.0, 3e3, 1e4, 1e8];
        let magnitudes = [
            0.0,
            1e-7,
            1e-5,
            0.01,
            0.5,
            0.99,
            0.9999,
            0.999_999,
            1.0 - 1e-7,
        ];
        Self::grid(&magnitudes, &alphas)
    }
    fn of(kind: Kind) -> Option<Case<Self>> {
        let p = match kind {
            Kind::Hg { g } => [g, 0.0],
            Kind::Rayleigh {} => [0.0, 1.0],
            Kind::RayleighDepol { rho } => {
                let y = rho / (2.0 - rho);
                [0.0, (1.0 - y) / (1.0 + 3.0 * y)]
            }
            Kind::Draine { g, alpha } => [g, alpha],
            _ => return None,
        };
        Some(Case::new(Self, &p, kind))
    }
    fn eval<R: Real>(self, cosine: R, [g, alpha, ..]: Parameters<R>) -> R {
        phase::draine::eval(cosine, g, alpha)
    }
    fn sample<R: Real>(self, u: R, [g, alpha, ..]: Parameters<R>) -> R {
        phase::draine::sample(u, g, alpha)
    }
    fn invert<R: Real>(self, cosine: R, _: R, [g, alpha, ..]: Parameters<R>) -> R {
        phase::draine::invert(cosine, g, alpha)
    }
    fn mean_cosine(self, [g, alpha, ..]: Parameters<f64>) -> f64 {
        phase::draine::mean_cosine(g, alpha)
    }
    fn errors([_, alpha, ..]: Parameters<f64>) -> [f64; 2] {
        [3e-7, if alpha <= 1.0 { 0.0 } else { 2e-7 }]
    }
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct mie_fit;
impl mie_fit {
    fn with<R>([g_hg, g_draine, alpha, share]: Parameters<R>) -> MieFit<R> {
        MieFit {
            g_hg,
            g_draine,
            alpha,
            share,
        }
    }
    fn case(diameter: f32) -> Case<Self> {
        let fit = MieFit::<f64>::new(diameter).expect("a diameter within the fit");
        let (g, alpha) = (fit.g_draine, fit.alpha);
        let law = Law::Blend(vec![
            (fit.share, Kind::Draine { g, alpha }),
            (1.0 - fit.share, Kind::Hg { g: fit.g_hg }),
        ]);
        Case::new(Self, &[fit.g_hg, g, alpha, fit.share], law)
    }
}
impl Row for mie_fit {
    const MONOTONE: bool = false;

    fn cases() -> Vec<Case<Self>> {
        let diameters = [0.01, 0.15, 1.0, 2.0, 6.0, 20.0];
        diameters.into_iter().map(Self::case).collect()
    }
    fn extremes() -> Vec<Case<Self>> {
        let ends = [f32::MIN_POSITIVE, 1e-4, 0.1, 1.5, 5.0, 50.0];
        let both = ends.into_iter().flat_map(|d| [d, d.next_down()]);
        both.map(Self::case).collect()
    }
    fn of(_: Kind) -> Option<Case<Self>> {
        None
    }
    fn eval<R: Real>(self, cosine: R, p: Parameters<R>) -> R {
        Self::with(p).eval(cosine)
    }
    fn sample<R: Real>(self, u: R, p: Parameters<R>) -> R {
        Self::with(p).sample(u)
    }
    fn invert<R: Real>(self, cosine: R, v: R, p: Parameters<R>) -> R {
        Self::with(p).invert(cosine, v)
    }
    fn mean_cosine(self, p: Parameters<f64>) -> f64 {
        Self::with(p).mean_cosine()
    }
    fn cumulative<R: Real>(self, cosine: R, p: Parameters<R>) -> R {
        Self::with(p).cumulative(cosine)
    }
    fn errors(_: Parameters<f64>) -> [f64; 2] {
        [4e-7, 3e-7]
    }
}

pub(super) use super::tables::tabulated;
