//! Rough boundaries and metals: reflection and refraction at the normals of a [`Ggx`] distribution.
//!
//! ```text
//! reflection     m = (v + w) / |v + w|
//!   f   = F D(m) G2 / (4 |vz| |wz|)
//!   pdf = F Dv(m) / (4 v·m)
//! transmission   h = v + η w,  m = ±h / |h|
//!   f   = (1 − F) D(m) G2 |v·m| |w·m| / (|vz| |wz| |h|²)               for radiance; times η² for importance
//!   pdf = (1 − F) Dv(m) η² |w·m| / |h|²
//! ```
//!
//! v is where the path comes from, w where it goes, η the index there over the index here. |h|² is Walter's
//! (v·m + η w·m)². The kind is chosen by F at the normal, a metal always reflects and has F in its weight. What is
//! left in the weight is G2 / G1(v) ≤ 1. Source: [Walter 2007], equations 16, 17, 20 and 21.

use glam::DVec3;

use super::frame::{Frame, Passage};
use super::ggx::Ggx;
use super::smooth::{reflect, refract, relative_index, squeeze};
use super::{BsdfSample, Transport, fresnel};

/// Two directions of a path, as the surface sees them.
struct Pair {
    /// Where it comes from; z is positive.
    v: DVec3,
    /// Where it goes; z is positive for reflection, negative for transmission.
    w: DVec3,
    passage: Passage,
}

impl Pair {
    fn new(frame: &Frame, from: DVec3, to: DVec3) -> Option<Self> {
        let passage = frame.agreed_passage(from, to)?;
        let (normal, _) = frame.facing(from)?;
        Some(Self {
            v: frame.to_local(normal, from),
            w: frame.to_local(normal, to),
            passage,
        })
    }

    /// The normal at which `v` is reflected to `w`, and its cosine with either.
    fn mirror(&self) -> Option<(DVec3, f64)> {
        if self.passage != Passage::Reflection {
            return None;
        }
        // |v + w| is twice the cosine, also where it is small and v·m is noise.
        let h = self.v + self.w;
        let length = h.length();
        Some((h / length, (0.5 * length).min(1.0)))
    }

    /// The normal at which `v` is refracted to `w`, and |h|².
    fn lens(&self, eta: f64) -> Option<(DVec3, f64)> {
        if self.passage != Passage::Transmission {
            return None;
        }
        let h = self.v + self.w * eta;
        let square = h.length_squared();
        let h = if h.z < 0.0 { -h } else { h };
        let m = h / square.sqrt();
        // Normals seen from behind refract nothing.
        (square > 0.0 && self.v.dot(m) > 0.0 && self.w.dot(m) < 0.0).then_some((m, square))
    }
}

/// A rough boundary between transparent matters.
#[derive(Clone, Copy, Debug)]
pub(super) struct Dielectric {
    /// Index behind the normal over that in front of it, not one.
    pub(super) eta: f64,
    pub(super) ggx: Ggx,
}

impl Dielectric {
    pub(super) fn eval(
        &self,
        frame: &Frame,
        from: DVec3,
        to: DVec3,
        transport: Transport,
    ) -> Option<f64> {
        let eta = relative_index(frame, self.eta, from)?;
        let pair = Pair::new(frame, from, to)?;
        let Pair { v, w, .. } = pair;
        let masking = self.ggx.masking_over_cosines(v, w);
        let f = if let Some((m, cosine)) = pair.mirror() {
            0.25 * fresnel::dielectric(cosine, eta) * self.ggx.density(m) * masking
        } else {
            let (m, square) = pair.lens(eta)?;
            let cosine = v.dot(m);
            let passing = 1.0 - fresnel::dielectric(cosine.min(1.0), eta);
            let jacobian = eta * eta * w.dot(m).abs() / square;
            let facets = cosine * self.ggx.density(m) * masking;
            passing * facets * jacobian * squeeze(eta, transport)
        };
        Some(f * frame.cosine(from, to, transport))
    }

    pub(super) fn pdf(&self, frame: &Frame, from: DVec3, to: DVec3) -> Option<f64> {
        let eta = relative_index(frame, self.eta, from)?;
        let pair = Pair::new(frame, from, to)?;
        if let Some((m, cosine)) = pair.mirror() {
            return Some(self.reflected_pdf(pair.v, m, cosine, eta));
        }
        let (m, square) = pair.lens(eta)?;
        Some(self.refracted_pdf(&pair, m, square, eta))
    }

    fn reflected_pdf(&self, v: DVec3, m: DVec3, cosine: f64, eta: f64) -> f64 {
        let reflected = fresnel::dielectric(cosine, eta);
        0.25 * reflected * self.ggx.visible_over_cosine(v, m)
    }

    fn refracted_pdf(&self, pair: &Pair, m: DVec3, square: f64, eta: f64) -> f64 {
        let cosine = pair.v.dot(m);
        let passing = 1.0 - fresnel::dielectric(cosine.min(1.0), eta);
        let jacobian = eta * eta * pair.w.dot(m).abs() / square;
        passing * cosine * self.ggx.visible_over_cosine(pair.v, m) * jacobian
    }

    pub(super) fn sample(
        &self,
        frame: &Frame,
        from: DVec3,
        u: [f64; 3],
        transport: Transport,
    ) -> Option<BsdfSample> {
        let eta = relative_index(frame, self.eta, from)?;
        let (normal, _) = frame.facing(from)?;
        let v = frame.to_local(normal, from);
        let m = self.ggx.sample(v, [u[1], u[2]]);
        let cosine = v.dot(m).clamp(0.0, 1.0);
        let (w, factor) = if u[0] < fresnel::dielectric(cosine, eta) {
            (reflect(v, m), 1.0)
        } else {
            (refract(v, m, cosine, eta)?, squeeze(eta, transport))
        };
        let direction = frame.to_world(normal, w);
        let pair = Pair::new(frame, from, direction)?;
        let pdf = match (pair.passage, w.dot(m) > 0.0) {
            (Passage::Reflection, true) => self.reflected_pdf(v, m, cosine, eta),
            (Passage::Transmission, false) => {
                let square = (v + w * eta).length_squared();
                self.refracted_pdf(&pair, m, square, eta)
            }
            // Reflected into the surface, or refracted out of it.
            _ => return None,
        };
        let weight = factor
            * self.ggx.masking_given(v, pair.w)
            * frame.correction(from, direction, transport);
        (pdf > 0.0).then_some(BsdfSample {
            direction,
            weight: [weight; 3],
            pdf,
            specular: false,
        })
    }
}

/// A rough metal.
#[derive(Clone, Copy, Debug)]
pub(super) struct Conductor {
    pub(super) ggx: Ggx,
}

impl Conductor {
    /// The BSDF times the cosine by colour; `reflected` is F by the cosine at the tiny normal.
    pub(super) fn eval(
        &self,
        frame: &Frame,
        reflected: impl FnOnce(f64) -> [f64; 3],
        from: DVec3,
        to: DVec3,
        transport: Transport,
    ) -> Option<[f64; 3]> {
        let pair = Pair::new(frame, from, to)?;
        let (m, cosine) = pair.mirror()?;
        let facets = self.ggx.density(m) * self.ggx.masking_over_cosines(pair.v, pair.w);
        let factor = 0.25 * facets * frame.cosine(from, to, transport);
        Some(reflected(cosine).map(|f| f * factor))
    }

    pub(super) fn pdf(&self, frame: &Frame, from: DVec3, to: DVec3) -> Option<f64> {
        let pair = Pair::new(frame, from, to)?;
        let (m, _) = pair.mirror()?;
        Some(0.25 * self.ggx.visible_over_cosine(pair.v, m))
    }

    pub(super) fn sample(
        &self,
        frame: &Frame,
        reflected: impl FnOnce(f64) -> [f64; 3],
        from: DVec3,
        u: [f64; 2],
        transport: Transport,
    ) -> Option<BsdfSample> {
        let (normal, _) = frame.facing(from)?;
        let v = frame.to_local(normal, from);
        let m = self.ggx.sample(v, u);
        let direction = frame.to_world(normal, reflect(v, m));
        let pair = Pair::new(frame, from, direction)?;
        pair.mirror()?;
        let weight =
            self.ggx.masking_given(v, pair.w) * frame.correction(from, direction, transport);
        let pdf = 0.25 * self.ggx.visible_over_cosine(v, m);
        (pdf > 0.0).then_some(BsdfSample {
            direction,
            weight: reflected(v.dot(m).clamp(0.0, 1.0)).map(|f| f * weight),
            pdf,
            specular: false,
        })
    }
}
