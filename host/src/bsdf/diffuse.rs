//! Lambert's law, on both sides: a surface equally bright from everywhere.
//!
//! ```text
//! f = ρ / π      where the geometric normal sees both directions on one side
//! ```
//!
//! The cosines of the shading normal are taken absolutely, so nothing turns black where it leans away. Paths from the
//! camera choose with density |to·ns| / π over the *geometric* hemisphere: a cosine-weighted direction around ns
//! that lies beyond the surface is turned around, and the lune it came from goes exactly onto the one that the
//! hemisphere around ns lacks. Paths from lights choose with |to·ng| / π, the cosine that their value has. Either way
//! the weight does not depend on the direction chosen.

use core::f64::consts::{FRAC_1_PI, TAU};

use glam::DVec3;

use super::frame::{Frame, Passage};
use super::{BsdfSample, Transport};

pub(super) fn eval(
    frame: &Frame,
    reflectance: [f64; 3],
    from: DVec3,
    to: DVec3,
    transport: Transport,
) -> [f64; 3] {
    match frame.passage(from, to) {
        Some(Passage::Reflection) => {
            let cosine = frame.cosine(from, to, transport);
            reflectance.map(|rho| rho * FRAC_1_PI * cosine)
        }
        _ => [0.0; 3],
    }
}

pub(super) fn pdf(frame: &Frame, from: DVec3, to: DVec3, transport: Transport) -> f64 {
    match frame.passage(from, to) {
        Some(Passage::Reflection) => to.dot(axis(frame, transport)).abs() * FRAC_1_PI,
        _ => 0.0,
    }
}

pub(super) fn sample(
    frame: &Frame,
    reflectance: [f64; 3],
    from: DVec3,
    u: [f64; 2],
    transport: Transport,
) -> Option<BsdfSample> {
    let outside = frame.is_outside(from)?;
    let axis = axis(frame, transport);
    let (x, y) = axis.any_orthonormal_pair();
    let (sin, cos) = libm::sincos(TAU * u[1]);
    let r = u[0].sqrt();
    let drawn = (x * (r * cos) + y * (r * sin) + axis * (1.0 - u[0]).sqrt()).normalize();
    let direction = if frame.is_outside(drawn)? == outside {
        drawn
    } else {
        -drawn
    };
    let factor = match transport {
        Transport::Radiance => 1.0,
        Transport::Importance => frame.tilt(from),
    };
    Some(BsdfSample {
        direction,
        weight: reflectance.map(|rho| rho * factor),
        pdf: direction.dot(axis).abs() * FRAC_1_PI,
        specular: false,
    })
}

/// The normal whose cosine the density follows.
fn axis(frame: &Frame, transport: Transport) -> DVec3 {
    match transport {
        Transport::Radiance => frame.shading,
        Transport::Importance => frame.geometric,
    }
}
