//! Materials at a place made by hand, and the same with mistakes.

use glam::{DVec2, DVec3};
use woodcock_host::bsdf::{Bsdf, Materials, Transport};
use woodcock_host::ray::Anchor;
use woodcock_host::scene::{
    Material, MaterialId, MaterialKind, MemoryFiles, Place, Source, Texture,
};
use woodcock_host::surface::Hit;
use woodcock_host::volume::Limits;
use woodcock_tests::stats::independent::SplitMix;

pub(super) const TRANSPORTS: [Transport; 2] = [Transport::Radiance, Transport::Importance];

/// The unit vector at a height over the plane.
pub(super) fn direction(z: f64, phi: f64) -> DVec3 {
    let r = (1.0 - z * z).max(0.0).sqrt();
    DVec3::new(r * phi.cos(), r * phi.sin(), z)
}

pub(super) fn any_direction(rng: &mut SplitMix) -> DVec3 {
    direction(
        2.0 * rng.uniform() - 1.0,
        std::f64::consts::TAU * rng.uniform(),
    )
}

pub(super) fn uniforms(rng: &mut SplitMix) -> [f64; 3] {
    [rng.uniform(), rng.uniform(), rng.uniform()]
}

pub(super) fn diffuse(reflectance: f64) -> MaterialKind {
    MaterialKind::Diffuse {
        reflectance: Texture::Constant([reflectance; 3]),
    }
}

pub(super) fn dielectric(eta: f64, alpha: [f64; 2]) -> MaterialKind {
    MaterialKind::Dielectric { eta, alpha }
}

/// A metal that reflects everything.
pub(super) fn white_metal(alpha: [f64; 2]) -> MaterialKind {
    metal(0.0, 1.0, alpha)
}

pub(super) fn metal(eta: f64, k: f64, alpha: [f64; 2]) -> MaterialKind {
    MaterialKind::Conductor {
        eta: [eta; 3],
        k: [k; 3],
        alpha,
    }
}

/// The material at a place whose geometric normal is +z and whose shading normal leans by `tilt` radians.
pub(super) fn at(kind: MaterialKind, tilt: f64) -> Bsdf {
    let source = Source::new("surface", b"material".to_vec());
    let material = Material {
        kind,
        place: Place::new(&source, 0, 8),
    };
    let files = MemoryFiles::new();
    let materials =
        Materials::new(&[material], &files, &Limits::default()).expect("valid materials");
    let shading_normal = direction(tilt.cos(), 0.7);
    let tangent = DVec3::new(0.2, 0.9, -0.1);
    let tangent = (tangent - shading_normal * tangent.dot(shading_normal)).normalize();
    let tangent = if tilt == 0.0 { DVec3::X } else { tangent };
    materials.at(&Hit {
        t: 1.0,
        anchor: Anchor {
            point: DVec3::ZERO,
            normal: DVec3::Z,
            error: 0.0,
        },
        shading_normal,
        tangent,
        uv: DVec2::ZERO,
        material: Some(MaterialId(0)),
        emitter: None,
    })
}

/// What a mistake makes of one direction.
#[derive(Clone, Copy, Debug)]
pub(super) struct Choice {
    pub(super) direction: DVec3,
    pub(super) weight: f64,
    pub(super) pdf: f64,
}

/// Something that scatters green light.
pub(super) trait Scatter {
    fn eval(&self, from: DVec3, to: DVec3, transport: Transport) -> f64;
    fn pdf(&self, from: DVec3, to: DVec3, transport: Transport) -> f64;
    fn sample(&self, from: DVec3, u: [f64; 3], transport: Transport) -> Option<Choice>;
}

impl Scatter for Bsdf {
    fn eval(&self, from: DVec3, to: DVec3, transport: Transport) -> f64 {
        Self::eval(self, from, to, transport)[1]
    }

    fn pdf(&self, from: DVec3, to: DVec3, transport: Transport) -> f64 {
        Self::pdf(self, from, to, transport)
    }

    fn sample(&self, from: DVec3, u: [f64; 3], transport: Transport) -> Option<Choice> {
        let sample = Self::sample(self, from, u, transport)?;
        Some(Choice {
            direction: sample.direction,
            weight: sample.weight[1],
            pdf: sample.pdf,
        })
    }
}

/// How a material goes wrong.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Mistake {
    /// Radiance is not divided by η² where it is refracted.
    EtaSquaredForgotten,
    /// Paths from lights do not know of shading normals.
    NormalsUncorrected,
    /// The density of a reflected direction is that of its half vector: 1 / (4 v·m) is missing.
    NormalsForDirections,
    /// The Jacobian of refraction without its η².
    LensWithoutEta,
    /// Every facet is seen, from everywhere; widths along x and y.
    NothingMasked([f64; 2]),
}

/// A material with a mistake. Normals are flat but for [`Mistake::NormalsUncorrected`].
#[derive(Clone, Copy, Debug)]
pub(super) struct Mistaken {
    pub(super) bsdf: Bsdf,
    pub(super) eta: f64,
    pub(super) tilt: f64,
    pub(super) mistake: Mistake,
}

impl Mistaken {
    /// By what a value and a density are wrong.
    fn factors(&self, from: DVec3, to: DVec3, transport: Transport) -> (f64, f64) {
        let passes = from.z * to.z < 0.0;
        let eta = if from.z > 0.0 {
            self.eta
        } else {
            1.0 / self.eta
        };
        match self.mistake {
            Mistake::EtaSquaredForgotten if passes && transport == Transport::Radiance => {
                (eta * eta, 1.0)
            }
            Mistake::NormalsUncorrected if transport == Transport::Importance => {
                let normal = direction(self.tilt.cos(), 0.7);
                let tilt = |w: DVec3| w.dot(normal).abs() / w.z.abs();
                (tilt(to) / tilt(from), 1.0)
            }
            Mistake::NormalsForDirections if !passes => {
                (1.0, 4.0 * from.dot((from + to).normalize()))
            }
            Mistake::LensWithoutEta if passes => (1.0, 1.0 / (eta * eta)),
            Mistake::NothingMasked(alpha) => (1.0 / super::textbook::masking(alpha, from, to), 1.0),
            _ => (1.0, 1.0),
        }
    }
}

impl Scatter for Mistaken {
    fn eval(&self, from: DVec3, to: DVec3, transport: Transport) -> f64 {
        self.factors(from, to, transport).0 * Scatter::eval(&self.bsdf, from, to, transport)
    }

    fn pdf(&self, from: DVec3, to: DVec3, transport: Transport) -> f64 {
        self.factors(from, to, transport).1 * Scatter::pdf(&self.bsdf, from, to, transport)
    }

    fn sample(&self, from: DVec3, u: [f64; 3], transport: Transport) -> Option<Choice> {
        let choice = Scatter::sample(&self.bsdf, from, u, transport)?;
        let (value, density) = self.factors(from, choice.direction, transport);
        Some(Choice {
            weight: choice.weight * value / density,
            pdf: choice.pdf * density,
            ..choice
        })
    }
}
