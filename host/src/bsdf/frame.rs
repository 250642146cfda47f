//! The two normals of a place, and what they say about two directions.

use glam::DVec3;

use super::Transport;
use crate::surface::Hit;

/// Directions this close to the plane of the surface neither arrive nor leave: their sides are not certain.
const GRAZING: f64 = 1e-12;

/// Geometric and shading normal with the axes of roughness; all unit.
#[derive(Clone, Copy, Debug)]
pub(super) struct Frame {
    pub(super) geometric: DVec3,
    pub(super) shading: DVec3,
    tangent: DVec3,
    bitangent: DVec3,
}

/// Whether light stays on its side.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Passage {
    Reflection,
    Transmission,
}

impl Frame {
    pub(super) fn new(hit: &Hit) -> Self {
        Self {
            geometric: hit.anchor.normal,
            shading: hit.shading_normal,
            tangent: hit.tangent,
            bitangent: hit.shading_normal.cross(hit.tangent),
        }
    }

    /// Whether a direction lies on the side that the geometric normal points to; `None` if it grazes.
    pub(super) fn is_outside(&self, w: DVec3) -> Option<bool> {
        side(w.dot(self.geometric))
    }

    /// What the geometric normal says about two directions.
    pub(super) fn passage(&self, from: DVec3, to: DVec3) -> Option<Passage> {
        Some(passage(self.is_outside(from)?, self.is_outside(to)?))
    }

    /// What both normals say about two directions; `None` where they disagree: such light would leak.
    pub(super) fn agreed_passage(&self, from: DVec3, to: DVec3) -> Option<Passage> {
        let seen = self.passage(from, to)?;
        let shaded = passage(side(from.dot(self.shading))?, side(to.dot(self.shading))?);
        (seen == shaded).then_some(seen)
    }

    /// The shading normal on the side of a direction, and their cosine; `None` if it grazes.
    pub(super) fn facing(&self, w: DVec3) -> Option<(DVec3, f64)> {
        let cosine = w.dot(self.shading);
        let (normal, cosine) = if side(cosine)? {
            (self.shading, cosine)
        } else {
            (-self.shading, -cosine)
        };
        Some((normal, cosine.min(1.0)))
    }

    /// Coordinates along tangent, bitangent and `normal`, which is the shading normal or its opposite.
    pub(super) fn to_local(self, normal: DVec3, w: DVec3) -> DVec3 {
        DVec3::new(w.dot(self.tangent), w.dot(self.bitangent), w.dot(normal))
    }

    /// The inverse of [`to_local`](Self::to_local), of unit length.
    pub(super) fn to_world(self, normal: DVec3, w: DVec3) -> DVec3 {
        (self.tangent * w.x + self.bitangent * w.y + normal * w.z).normalize()
    }

    /// What a BSDF is multiplied by: the cosine of the light's direction with the *shading* normal, with the measure of
    /// the path's direction changed from that to the geometric one where the path comes from a light.
    ///
    /// ```text
    /// radiance: |to·ns|        importance: |from·ns| |to·ng| / |from·ng|
    /// ```
    ///
    /// So the same path has the same value from either end ([Veach 1997], section 5.3.2). Neither direction grazes.
    pub(super) fn cosine(&self, from: DVec3, to: DVec3, transport: Transport) -> f64 {
        match transport {
            Transport::Radiance => to.dot(self.shading).abs(),
            Transport::Importance => self.tilt(from) * to.dot(self.geometric).abs(),
        }
    }

    /// [`cosine`](Self::cosine) over |to·ns|: one for radiance, and where both normals are the same.
    pub(super) fn correction(&self, from: DVec3, to: DVec3, transport: Transport) -> f64 {
        match transport {
            Transport::Radiance => 1.0,
            Transport::Importance => self.tilt(from) / self.tilt(to),
        }
    }

    /// |w·ns| / |w·ng|.
    pub(super) fn tilt(&self, w: DVec3) -> f64 {
        w.dot(self.shading).abs() / w.dot(self.geometric).abs()
    }
}

fn side(cosine: f64) -> Option<bool> {
    (cosine.abs() > GRAZING).then_some(cosine > 0.0)
}

fn passage(from: bool, to: bool) -> Passage {
    if from == to {
        Passage::Reflection
    } else {
        Passage::Transmission
    }
}
