//! Media without memory: homogeneous ones, and the caller's own functions.

use core::cell::Cell;
use core::ffi::c_void;

use woodcock_core::free_flight::{analytic, delta};
use woodcock_core::medium::{Homogeneous, Procedural};
use woodcock_core::stream::PathStream;
use woodcock_core::transmittance::{self, ratio};
use woodcock_core::vec3::Vec3;
use woodcock_core::{free_flight, ray};

use crate::pointer::{self, Place};
use crate::status::{Status, answer};
use crate::stream::{OpaqueStream, with};
use crate::{Flight, Ray, affordable};

/// `woodcock_extinction`: the extinction at a place [1/length], from the caller's own data.
pub type Extinction = unsafe extern "C" fn(data: *mut c_void, place: *const [f32; 3]) -> f32;

impl Flight {
    pub(crate) fn new(flight: free_flight::Flight<f32>) -> Self {
        Self {
            t: flight.t,
            collided: flight.collided.into(),
        }
    }
}

/// A free flight in a homogeneous medium, in closed form. One exponential draw.
///
/// # Safety
/// Pointers lead to what their types say, or are null.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn woodcock_fog_flight(
    sigma_t: f32,
    t_max: f32,
    stream: *mut OpaqueStream,
    flight: *mut Flight,
) -> Status {
    answer((|| {
        // SAFETY: the caller's word.
        let place = unsafe { Place::new(flight) }?;
        let fog = Homogeneous::new(sigma_t).map_err(|_| Status::Extinction)?;
        let ray = Ray {
            origin: [0.0; 3],
            direction: [0.0, 0.0, 1.0],
            t_max,
        };
        let along = ray.checked()?;
        let fly = |rng: &mut PathStream| Ok(analytic::sample(&fog, &along, t_max, rng, true));
        // SAFETY: the caller's word.
        place.put(Flight::new(unsafe { with(stream, fly) }?));
        Ok(())
    })())
}

/// The transmittance of a homogeneous medium: no draws, no variance.
///
/// # Safety
/// Pointers lead to what their types say, or are null.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn woodcock_fog_transmittance(
    sigma_t: f32,
    t: f32,
    transmittance: *mut f32,
) -> Status {
    answer((|| {
        // SAFETY: the caller's word.
        let place = unsafe { Place::new(transmittance) }?;
        Homogeneous::new(sigma_t).map_err(|_| Status::Extinction)?;
        if t.is_nan() || t < 0.0 {
            return Err(Status::Ray);
        }
        // Vacuum without an end is no 0 · ∞.
        let t = t.min(ray::FAR);
        place.put(transmittance::analytic::through(sigma_t, t));
        Ok(())
    })())
}

/// What an estimator makes of the caller's own medium.
///
/// # Safety
/// As for [`woodcock_field_flight`].
unsafe fn in_field<T>(
    (extinction, data): (Option<Extinction>, *mut c_void),
    majorant: f32,
    (ray, stream, out): (*const Ray, *mut OpaqueStream, *mut T),
    estimate: impl FnOnce(
        &Procedural<&dyn Fn(Vec3<f32>) -> f32>,
        &ray::Ray<f32>,
        f32,
        &mut PathStream,
    ) -> T,
) -> Result<(), Status> {
    // SAFETY: the caller's word, for both.
    let (place, ray) = unsafe { (Place::new(out)?, pointer::read(ray)?) };
    let extinction = extinction.ok_or(Status::Null)?;
    if !(majorant > 0.0 && majorant.is_finite()) {
        return Err(Status::Extinction);
    }
    let along = ray.checked()?;
    affordable(majorant * ray.t_max)?;
    let violated = Cell::new(false);
    let sigma_t = |Vec3 { x, y, z }| {
        // SAFETY: the caller's function, with the caller's data, and a place that is there.
        let sigma_t = unsafe { extinction(data, &[x, y, z]) };
        let within = (0.0..=majorant).contains(&sigma_t);
        violated.set(violated.get() | !within);
        if within { sigma_t } else { majorant }
    };
    let medium = Procedural::new(&sigma_t as &dyn Fn(Vec3<f32>) -> f32, majorant);
    let fly = |rng: &mut PathStream| {
        let found = estimate(&medium, &along, ray.t_max, rng);
        if violated.get() {
            return Err(Status::Extinction);
        }
        Ok(found)
    };
    // SAFETY: the caller's word.
    place.put(unsafe { with(stream, fly) }?);
    Ok(())
}

/// A free flight in a medium of the caller's own, by delta tracking under a bound.
///
/// # Safety
/// Pointers lead to what their types say, or are null; the function may be called with the data.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn woodcock_field_flight(
    extinction: Option<Extinction>,
    data: *mut c_void,
    majorant: f32,
    ray: *const Ray,
    stream: *mut OpaqueStream,
    flight: *mut Flight,
) -> Status {
    // SAFETY: the caller's word.
    answer(unsafe {
        in_field(
            (extinction, data),
            majorant,
            (ray, stream, flight),
            |medium, along, t_max, rng| Flight::new(delta::sample(medium, along, t_max, rng, true)),
        )
    })
}

/// An estimate of transmittance through a medium of the caller's own, by ratio tracking under a bound.
///
/// # Safety
/// As for [`woodcock_field_flight`].
#[unsafe(no_mangle)]
pub unsafe extern "C" fn woodcock_field_transmittance(
    extinction: Option<Extinction>,
    data: *mut c_void,
    majorant: f32,
    ray: *const Ray,
    stream: *mut OpaqueStream,
    weight: *mut f32,
) -> Status {
    // SAFETY: the caller's word.
    answer(unsafe {
        in_field(
            (extinction, data),
            majorant,
            (ray, stream, weight),
            |medium, along, t_max, rng| ratio::estimate(medium, along, t_max, rng, true),
        )
    })
}
