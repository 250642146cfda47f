//! Polished surfaces: light goes on in one or two directions.
//!
//! Normals agree on what is reflected and what is transmitted, or the light is absorbed; which side is outside, the
//! geometric one says alone.

use glam::DVec3;

use super::frame::{Frame, Passage};
use super::{BsdfSample, Transport, fresnel};

/// A boundary between transparent matters: the kind is chosen by Fresnel's law.
///
/// * `eta`: index behind the normal over that in front of it.
pub(super) fn dielectric(
    frame: &Frame,
    eta: f64,
    from: DVec3,
    u: f64,
    transport: Transport,
) -> Option<BsdfSample> {
    let eta = relative_index(frame, eta, from)?;
    let (normal, cosine) = frame.facing(from)?;
    let reflected = fresnel::dielectric(cosine, eta);
    if u < reflected {
        return mirror(frame, from, [1.0; 3], reflected, transport);
    }
    let towards = refract(from, normal, cosine, eta)?;
    let weight = squeeze(eta, transport);
    delta(
        frame,
        Passage::Transmission,
        from,
        towards,
        [weight; 3],
        1.0 - reflected,
        transport,
    )
}

/// A pane without an inside.
pub(super) fn pane(
    frame: &Frame,
    eta: f64,
    from: DVec3,
    u: f64,
    transport: Transport,
) -> Option<BsdfSample> {
    let (_, cosine) = frame.facing(from)?;
    let reflected = fresnel::pane(cosine, eta);
    if u < reflected {
        mirror(frame, from, [1.0; 3], reflected, transport)
    } else {
        Some(straight(from, 1.0 - reflected))
    }
}

/// A metal.
pub(super) fn conductor(
    frame: &Frame,
    reflected: impl FnOnce(f64) -> [f64; 3],
    from: DVec3,
    transport: Transport,
) -> Option<BsdfSample> {
    let (_, cosine) = frame.facing(from)?;
    mirror(frame, from, reflected(cosine), 1.0, transport)
}

/// Light that passes as if nothing were there.
pub(super) fn straight(from: DVec3, probability: f64) -> BsdfSample {
    BsdfSample {
        direction: -from,
        weight: [1.0; 3],
        pdf: probability,
        specular: true,
    }
}

fn mirror(
    frame: &Frame,
    from: DVec3,
    weight: [f64; 3],
    probability: f64,
    transport: Transport,
) -> Option<BsdfSample> {
    let towards = reflect(from, frame.shading);
    delta(
        frame,
        Passage::Reflection,
        from,
        towards,
        weight,
        probability,
        transport,
    )
}

fn delta(
    frame: &Frame,
    passage: Passage,
    from: DVec3,
    to: DVec3,
    weight: [f64; 3],
    probability: f64,
    transport: Transport,
) -> Option<BsdfSample> {
    let direction = to.normalize();
    if frame.agreed_passage(from, direction) != Some(passage) {
        return None;
    }
    let correction = frame.correction(from, direction, transport);
    Some(BsdfSample {
        direction,
        weight: weight.map(|w| w * correction),
        pdf: probability,
        specular: true,
    })
}

/// The index of the side that is not that of `from` over that of its own.
pub(super) fn relative_index(frame: &Frame, eta: f64, from: DVec3) -> Option<f64> {
    let outside = frame.is_outside(from)?;
    Some(if outside { eta } else { 1.0 / eta })
}

/// What refraction does to the weight of a path beside Fresnel's law: radiance is spread over a cone that is
/// wider by η² before it, importance is not ([Veach 1997], section 5.2).
///
/// * `eta`: index where the path goes over that where it comes from.
pub(super) fn squeeze(eta: f64, transport: Transport) -> f64 {
    match transport {
        Transport::Radiance => 1.0 / (eta * eta),
        Transport::Importance => 1.0,
    }
}

/// The mirror image of `w` about a unit vector.
pub(super) fn reflect(w: DVec3, about: DVec3) -> DVec3 {
    about * (2.0 * w.dot(about)) - w
}

/// Snell's law: the direction that light of `w` takes behind a surface; `None` where all is reflected.
///
/// * `normal`: unit, on the side of `w`; `cosine`: between them.
pub(super) fn refract(w: DVec3, normal: DVec3, cosine: f64, eta: f64) -> Option<DVec3> {
    let refracted = fresnel::refracted_cosine(cosine, eta)?;
    Some(normal * (cosine / eta - refracted) - w / eta)
}
