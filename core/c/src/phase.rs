//! Phase functions.

use woodcock_core::phase::{henyey_greenstein, isotropic, rayleigh};
use woodcock_core::stream::Stream;
use woodcock_core::vec3::Vec3;

use crate::pointer::{self, Place};
use crate::status::{Status, answer};
use crate::stream::{OpaqueStream, with};
use crate::unit;

/// `woodcock_scattered`: a new direction.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scattered {
    /// Unit vector.
    pub direction: [f32; 3],
    /// Its density over the sphere [1/sr].
    pub density: f32,
}

/// A phase function with its parameter.
#[derive(Clone, Copy)]
enum Kind {
    Isotropic,
    HenyeyGreenstein(f32),
    Rayleigh,
}

impl Kind {
    fn new(kind: i32, g: f32) -> Result<Self, Status> {
        match kind {
            0 => Ok(Self::Isotropic),
            1 if -1.0 < g && g < 1.0 => Ok(Self::HenyeyGreenstein(g)),
            1 => Err(Status::MeanCosine),
            2 => Ok(Self::Rayleigh),
            _ => Err(Status::Phase),
        }
    }

    fn eval(self, cos_theta: f32) -> f32 {
        match self {
            Self::Isotropic => isotropic::eval(cos_theta),
            Self::HenyeyGreenstein(g) => henyey_greenstein::eval(cos_theta, g),
            Self::Rayleigh => rayleigh::eval(cos_theta),
        }
    }

    fn sample(self, u: f32) -> f32 {
        match self {
            Self::Isotropic => isotropic::sample(u),
            Self::HenyeyGreenstein(g) => henyey_greenstein::sample(u, g),
            Self::Rayleigh => rayleigh::sample(u),
        }
    }
}

/// The density of a phase function at a cosine.
///
/// # Safety
/// Pointers lead to what their types say, or are null.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn woodcock_phase_eval(
    kind: i32,
    g: f32,
    cos_theta: f32,
    density: *mut f32,
) -> Status {
    answer((|| {
        // SAFETY: the caller's word.
        let place = unsafe { Place::new(density) }?;
        let kind = Kind::new(kind, g)?;
        if !(-1.0..=1.0).contains(&cos_theta) {
            return Err(Status::Cosine);
        }
        place.put(kind.eval(cos_theta));
        Ok(())
    })())
}

/// A direction by a phase function, and its density. Two draws: the cosine's, then the turn's.
///
/// # Safety
/// Pointers lead to what their types say, or are null.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn woodcock_phase_sample(
    kind: i32,
    g: f32,
    direction: *const [f32; 3],
    stream: *mut OpaqueStream,
    scattered: *mut Scattered,
) -> Status {
    answer((|| {
        // SAFETY: the caller's word, for both.
        let (place, direction) = unsafe { (Place::new(scattered)?, pointer::read(direction)?) };
        let (kind, direction) = (Kind::new(kind, g)?, unit(direction)?);
        let draw = |rng: &mut woodcock_core::stream::PathStream| {
            let cos_theta = kind.sample(rng.uniform(true));
            let Vec3 { x, y, z } = direction.deflected(cos_theta, rng.uniform(true));
            Ok(Scattered {
                direction: [x, y, z],
                density: kind.eval(cos_theta),
            })
        };
        // SAFETY: the caller's word.
        place.put(unsafe { with(stream, draw) }?);
        Ok(())
    })())
}
