//! A small random walk through core's own estimators: what proves them against numbers from outside.
//!
//! Free flights, phase functions, the turning of directions, roulette and keyed streams are core's, in `f32`; this
//! module only puts them in order. A walk is a [`Body`] that ends it, [`Flights`] that say how far it goes and a
//! [`Law`] that says where to; what is scored on the way is the caller's. One lane, one particle at a time:
//! plainness, not speed.
//!
//! ```text
//! fly to a collision or to the boundary → score → scatter → fly …
//! ```
//!
//! Each [`Mistake`] is one that such walks are prone to. A walk can be asked to make it, and every suite that uses
//! this module must notice those it names. [`crate::refs`] has a walk of its own, which shares nothing with core and
//! verifies the tables themselves.

mod body;
mod flights;
mod law;
mod mistake;
mod tally;

pub use body::{Ball, Block, Body, Lit, Slab, Space, Stretch};
pub use flights::{Closed, Flights, Tracked, UnderBound};
pub use law::{Draine, HenyeyGreenstein, Isotropic, Law, Lobes, Rayleigh};
pub use mistake::Mistake;
pub use tally::{Run, tally};

use woodcock_core::collision::roulette;
use woodcock_core::free_flight::Flight;
use woodcock_core::ray::{FAR, Ray};
use woodcock_core::stream::{Key, PathStream, Stream};
use woodcock_core::vec3::Vec3;

/// A point or direction from `f64`.
pub fn vector(v: [f64; 3]) -> Vec3<f32> {
    Vec3::splat(v.map(|c| c as f32))
}

/// A ray from `f64`; its direction is brought to unit length in `f32`.
pub fn ray(origin: [f64; 3], direction: [f64; 3]) -> Ray<f32> {
    Ray {
        origin: vector(origin),
        direction: vector(direction).normalised(),
    }
}

/// The random numbers of one particle.
#[derive(Clone, Debug)]
pub struct Draws {
    stream: PathStream,
    /// The stream at its beginning, for those who forget to draw.
    beginning: PathStream,
}

impl Draws {
    /// Those of a key, from the first.
    pub fn new(key: Key) -> Self {
        let stream = PathStream::new(key);
        Self {
            beginning: stream.clone(),
            stream,
        }
    }

    /// The stream, for what core draws.
    pub fn stream(&mut self) -> &mut PathStream {
        &mut self.stream
    }

    /// A uniform number in [0, 1).
    pub fn uniform(&mut self) -> f32 {
        self.stream.uniform(true)
    }

    /// A direction at `cos_theta` from `axis`, of uniform azimuth.
    pub fn around(&mut self, axis: Vec3<f32>, cos_theta: f32) -> Vec3<f32> {
        let turn = self.uniform();
        axis.deflected(cos_theta, turn)
    }

    /// A direction uniform over the sphere.
    pub fn isotropic(&mut self) -> Vec3<f32> {
        let cosine = 2.0 * self.uniform() - 1.0;
        self.around(Vec3::new(0.0, 0.0, 1.0), cosine)
    }

    /// A direction Lambertian about `normal`: what uniform radiance sends through a surface.
    pub fn lambertian(&mut self, normal: Vec3<f32>) -> Vec3<f32> {
        let cosine = self.uniform().sqrt();
        self.around(normal, cosine)
    }
}

/// A walk, ready to be walked by any number of particles.
#[derive(Clone, Debug)]
pub struct Walk<B, F, L> {
    /// What the walk ends at.
    pub body: B,
    /// How far it goes between collisions.
    pub flights: F,
    /// Where a collision sends it.
    pub law: L,
    /// What it does wrong.
    pub mistake: Option<Mistake>,
}

impl<B: Body, F: Flights, L: Law> Walk<B, F, L> {
    /// A walk that makes no mistake.
    pub fn new(body: B, flights: F, law: L) -> Self {
        Self {
            body,
            flights,
            law,
            mistake: None,
        }
    }

    /// The same walk making a mistake.
    #[must_use]
    pub fn making(mut self, mistake: Mistake) -> Self {
        self.mistake = Some(mistake);
        self
    }

    fn makes(&self, mistake: Mistake) -> bool {
        self.mistake == Some(mistake)
    }

    /// Moves the ray's origin to the next collision, or to the boundary; returns the length flown in the body.
    pub fn fly(&self, ray: &mut Ray<f32>, draws: &mut Draws) -> Flight<f32> {
        let mut flight = self.flight(ray, draws);
        let t = flight.t;
        if self.makes(Mistake::Unclipped) && !flight.collided {
            // As if the medium went on for ever at its bound: by the law of no memory, another flight on top.
            flight.t += self.flights.fly_tentative(ray, FAR, draws.stream()).t;
        }
        ray.origin = ray.at(t);
        flight
    }

    /// The flight alone.
    fn flight(&self, ray: &Ray<f32>, draws: &mut Draws) -> Flight<f32> {
        let t_max = self.body.exit(ray);
        if self.makes(Mistake::StaleFlight) {
            let mut stale = draws.beginning.clone();
            return self.flights.fly(ray, t_max, &mut stale);
        }
        if self.makes(Mistake::NullScatters) {
            return self.flights.fly_tentative(ray, t_max, draws.stream());
        }
        self.flights.fly(ray, t_max, draws.stream())
    }

    /// Turns the ray as the phase function at its origin says.
    pub fn scatter(&self, ray: &mut Ray<f32>, draws: &mut Draws) {
        let cosine = self.law.cosine(&ray.origin, draws);
        let mut turn = draws.uniform();
        match self.mistake {
            Some(Mistake::ShortFrame) => {
                ray.direction = mistake::short_frame(ray.direction, cosine, turn);
                return;
            }
            Some(Mistake::PhaseReversed) => {
                ray.direction = ray.direction.deflected(-cosine, turn);
                return;
            }
            Some(Mistake::OneUniform) => turn = 0.5 * (cosine + 1.0),
            Some(Mistake::HalfTurn) => turn *= 0.5,
            _ => {}
        }
        ray.direction = ray.direction.deflected(cosine, turn);
    }

    /// An unbiased estimate of the transmittance from a place in the body to its boundary, along a direction.
    pub fn way_out(&self, origin: Vec3<f32>, direction: Vec3<f32>, draws: &mut Draws) -> f64 {
        let way = Ray { origin, direction };
        let exit = self.body.exit(&way);
        f64::from(self.flights.transmittance(&way, exit, draws.stream()))
    }

    /// What a collision leaves of a weight.
    pub fn absorb(&self, weight: f64, albedo: f64) -> f64 {
        if self.makes(Mistake::AlbedoTwice) {
            weight * albedo * albedo
        } else {
            weight * albedo
        }
    }

    /// The factor of core's roulette for a weight, 0 for those who die.
    pub fn roulette(&self, weight: f64, threshold: f32, draws: &mut Draws) -> f64 {
        let factor = roulette(weight as f32, threshold, draws.stream(), true);
        if self.makes(Mistake::LossyRoulette) && factor > 0.0 {
            1.0
        } else {
            f64::from(factor)
        }
    }

    /// Follows a ray until it leaves, its origin then on the boundary, or until `collide` ends it.
    ///
    /// `collide` is called at each collision with the ray as it arrives there and says whether it goes on.
    /// Returns whether the ray left.
    pub fn follow(
        &self,
        ray: &mut Ray<f32>,
        draws: &mut Draws,
        mut collide: impl FnMut(&mut Ray<f32>, &mut Draws) -> bool,
    ) -> bool {
        while self.fly(ray, draws).collided {
            if !collide(ray, draws) {
                return false;
            }
            self.scatter(ray, draws);
        }
        true
    }
}
