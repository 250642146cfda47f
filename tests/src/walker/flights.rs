//! How far a walk goes: core's samplers of free flight, and its estimators of transmittance beside them.

use woodcock_core::free_flight::{self, Flight};
use woodcock_core::medium::{Homogeneous, Medium, Procedural};
use woodcock_core::ray::Ray;
use woodcock_core::stream::PathStream;
use woodcock_core::transmittance;
use woodcock_core::vec3::Vec3;

/// A medium with a way to fly through it.
pub trait Flights {
    /// A free flight on `[0, t_max)`.
    fn fly(&self, ray: &Ray<f32>, t_max: f32, rng: &mut PathStream) -> Flight<f32>;
    /// The same taking every tentative collision for a real one.
    fn fly_tentative(&self, ray: &Ray<f32>, t_max: f32, rng: &mut PathStream) -> Flight<f32>;
    /// An unbiased estimate of the transmittance of `[0, t_max)`.
    fn transmittance(&self, ray: &Ray<f32>, t_max: f32, rng: &mut PathStream) -> f32;
}

macro_rules! by_reference {
    ($($header:tt)*) => {
        $($header)* {
            fn fly(&self, ray: &Ray<f32>, t_max: f32, rng: &mut PathStream) -> Flight<f32> {
                (**self).fly(ray, t_max, rng)
            }
            fn fly_tentative(&self, ray: &Ray<f32>, t_max: f32, rng: &mut PathStream) -> Flight<f32> {
                (**self).fly_tentative(ray, t_max, rng)
            }
            fn transmittance(&self, ray: &Ray<f32>, t_max: f32, rng: &mut PathStream) -> f32 {
                (**self).transmittance(ray, t_max, rng)
            }
        }
    };
}
by_reference!(impl<F: Flights + ?Sized> Flights for &F);
by_reference!(impl<F: Flights + ?Sized> Flights for Box<F>);

/// A homogeneous medium in closed form: `free_flight/analytic.rs`, `transmittance/analytic.rs`.
#[derive(Clone, Copy, Debug)]
pub struct Closed(Homogeneous);

impl Closed {
    /// From the extinction [1/length].
    ///
    /// # Panics
    /// For a negative or infinite extinction.
    pub fn new(sigma_t: f64) -> Self {
        Self(Homogeneous::new(sigma_t as f32).expect("a valid extinction"))
    }
}

impl Flights for Closed {
    #[inline]
    fn fly(&self, ray: &Ray<f32>, t_max: f32, rng: &mut PathStream) -> Flight<f32> {
        free_flight::analytic::sample(&self.0, ray, t_max, rng, true)
    }
    fn fly_tentative(&self, ray: &Ray<f32>, t_max: f32, rng: &mut PathStream) -> Flight<f32> {
        self.fly(ray, t_max, rng)
    }
    #[inline]
    fn transmittance(&self, ray: &Ray<f32>, t_max: f32, _: &mut PathStream) -> f32 {
        transmittance::analytic::estimate(&self.0, ray, t_max)
    }
}

/// Any medium by tracking: `free_flight/delta.rs`, `transmittance/ratio.rs`.
#[derive(Clone, Copy, Debug)]
pub struct Tracked<M> {
    medium: M,
    bound: Homogeneous,
}

impl<M: Medium<f32>> Tracked<M> {
    /// From a medium and the largest of its bounds [1/length], which only mistakes make use of.
    ///
    /// # Panics
    /// For a bound that is negative or infinite.
    pub fn new(medium: M, bound: f64) -> Self {
        Self {
            medium,
            bound: Homogeneous::new(bound as f32).expect("a valid bound"),
        }
    }
}

/// Extinction by a function of position in `f64`, under one bound [1/length].
pub trait UnderBound: Fn(f64, f64, f64) -> f64 + Sized {
    /// The medium, flown through by tracking.
    fn under(self, bound: f64) -> Tracked<Procedural<impl Fn(Vec3<f32>) -> f32>> {
        let at = move |p: Vec3<f32>| self(p.x.into(), p.y.into(), p.z.into()) as f32;
        Tracked::new(Procedural::new(at, (bound as f32).next_up()), bound)
    }
}

impl<F: Fn(f64, f64, f64) -> f64> UnderBound for F {}

impl<M: Medium<f32>> Flights for Tracked<M> {
    #[inline]
    fn fly(&self, ray: &Ray<f32>, t_max: f32, rng: &mut PathStream) -> Flight<f32> {
        free_flight::delta::sample(&self.medium, ray, t_max, rng, true)
    }
    fn fly_tentative(&self, ray: &Ray<f32>, t_max: f32, rng: &mut PathStream) -> Flight<f32> {
        free_flight::analytic::sample(&self.bound, ray, t_max, rng, true)
    }
    #[inline]
    fn transmittance(&self, ray: &Ray<f32>, t_max: f32, rng: &mut PathStream) -> f32 {
        transmittance::ratio::estimate(&self.medium, ray, t_max, rng, true)
    }
}
