//! The rows of the registry of phase functions behind one signature, with their parameter sets.
#![expect(non_camel_case_types, reason = "the registry names files")]

use woodcock_core::phase;
use woodcock_core::real::Real;
use woodcock_tests::refs::phase_functions::Kind;

/// The trio of a phase function with its parameters, over any number.
pub(super) trait Trio {
    /// Each parameter set as a mean cosine and what the tables call it.
    fn parameters() -> Vec<(f32, Kind)>;
    fn eval<R: Real>(cosine: R, g: R) -> R;
    fn sample<R: Real>(u: R, g: R) -> R;
    fn invert<R: Real>(cosine: R, g: R) -> R;
}

pub(super) struct Isotropic;
impl Trio for Isotropic {
    fn parameters() -> Vec<(f32, Kind)> {
        vec![(0.0, Kind::Hg { g: 0.0 })]
    }
    fn eval<R: Real>(cosine: R, _: R) -> R {
        phase::isotropic::eval(cosine)
    }
    fn sample<R: Real>(u: R, _: R) -> R {
        phase::isotropic::sample(u)
    }
    fn invert<R: Real>(cosine: R, _: R) -> R {
        phase::isotropic::invert(cosine)
    }
}

pub(super) struct HenyeyGreenstein;
impl Trio for HenyeyGreenstein {
    fn parameters() -> Vec<(f32, Kind)> {
        let magnitudes = [
            0.0_f32, 1e-7, 1e-4, 1e-3, 0.1, 0.3, 0.5, 0.85, 0.99, 0.999, 0.9999,
        ];
        let both = magnitudes.into_iter().flat_map(|g| [g, -g]);
        both.map(|g| (g, Kind::Hg { g: f64::from(g) })).collect()
    }
    fn eval<R: Real>(cosine: R, g: R) -> R {
        phase::henyey_greenstein::eval(cosine, g)
    }
    fn sample<R: Real>(u: R, g: R) -> R {
        phase::henyey_greenstein::sample(u, g)
    }
    fn invert<R: Real>(cosine: R, g: R) -> R {
        phase::henyey_greenstein::invert(cosine, g)
    }
}

pub(super) struct Rayleigh;
impl Trio for Rayleigh {
    fn parameters() -> Vec<(f32, Kind)> {
        vec![(0.0, Kind::Rayleigh {})]
    }
    fn eval<R: Real>(cosine: R, _: R) -> R {
        phase::rayleigh::eval(cosine)
    }
    fn sample<R: Real>(u: R, _: R) -> R {
        phase::rayleigh::sample(u)
    }
    fn invert<R: Real>(cosine: R, _: R) -> R {
        phase::rayleigh::invert(cosine)
    }
}

// The suite's name for each row of the registry.
pub(super) type isotropic = Isotropic;
pub(super) type henyey_greenstein = HenyeyGreenstein;
pub(super) type rayleigh = Rayleigh;
