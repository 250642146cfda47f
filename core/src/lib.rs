//! # woodcock-core
//!
//! The sampling mathematics of unbiased volume rendering: free flights, transmittance, phase functions
//! and whole volume paths, as Monte Carlo estimates that are right in expectation. No ray marching,
//! no heap, no `unsafe`, no standard library.
//!
//! Every formula has one generic body over [`real::Real`]: `f32` runs it for one path, the eight lanes
//! of `woodcock-packet` for eight, with the same bits; `f64` is the oracle of the tests. A path's
//! random numbers are a pure function of its key ([`stream::Key`]), so its value depends neither on
//! lanes nor on threads.
//!
//! ## Notation
//! | name in code | symbol | unit | meaning |
//! |---|---|---|---|
//! | `sigma_a`, `sigma_s` | σ_a, σ_s | 1/length | absorption, scattering coefficient |
//! | `sigma_t` | σ_t = σ_a + σ_s | 1/length | extinction coefficient |
//! | `majorant` | σ̄ ≥ σ_t | 1/length | bound that homogenises |
//! | `minimum`, `control` | c | 1/length | what is known of σ_t from below; what is integrated exactly |
//! | `sigma_n` | σ_n = σ̄ − σ_t | 1/length | null-collision coefficient |
//! | `albedo` | α = σ_s/σ_t | 1 | single-scattering albedo |
//! | `optical_depth` | τ = ∫σ_t dt | 1 | along a ray |
//! | `majorant_depth` | D = ∫σ̄ dt | 1 | mean number of tentative collisions on a ray |
//! | `transmittance` | T = e^−τ | 1 | a single estimate is a `weight` until it is averaged |
//! | `t`, `t_max` | t | length | distance along a unit direction |
//! | `eval`, `pdf` | p(cos θ) | 1/sr | normalised over the sphere |
//! | `u`, `key` | ξ | 1 | uniform in [0, 1); identity of the stream |
//! | `emission` | j = σ_a L_e | W/(m³ sr) | what a medium emits |
//! | `throughput`, `radiance` | β, L | 1, W/(m² sr) | path weight; what the film averages |
//!
//! A *tentative* collision is an event of the majorant process. It becomes *real* or *null*. `cos_theta`
//! lies between the directions of propagation before and after: forward is +1. Lengths are in any unit,
//! as long as coefficients are per the same.
//!
//! ## Where is what
//! | question | answer |
//! |---|---|
//! | how far does light fly? | [`free_flight`], one file a sampler |
//! | how much of it passes? | [`transmittance`], with a table of variances and costs |
//! | what does it collect on its way? | [`line_integral`]: Algorithm 2 of the founding paper |
//! | in which direction does it go on? | [`phase`] |
//! | in colour? | [`spectral`] |
//! | through what? | [`medium`]: closed forms, grids, functions, sums of them |
//! | who proves the bounds? | [`majorant`]: constructors that refuse a bound that is none |
//! | what does a path do? | [`path`]: the whole of it, in stages that packets can interleave |
//! | and among a few surfaces? | [`room`] |
//! | how exact is it in `f32`? | [`stability`], [`elementary`] |
//!
//! ## Example: a pixel of fog
//! ```
//! use woodcock_core::free_flight::analytic;
//! use woodcock_core::medium::Homogeneous;
//! use woodcock_core::phase::henyey_greenstein;
//! use woodcock_core::ray::Ray;
//! use woodcock_core::stream::{Key, PathStream, Stream};
//! use woodcock_core::vec3::Vec3;
//!
//! /// Looks straight down into fog between z = 0 and z = 1 under a white sky, over black ground.
//! fn pixel(fog: &Homogeneous, albedo: f32, g: f32, samples: u32) -> f32 {
//!     let mut sum = 0.0;
//!     for sample in 0..samples {
//!         let mut rng = PathStream::new(Key { seed: 1, pixel: 0, sample });
//!         let uniform = |rng: &mut PathStream| -> f32 { rng.uniform(true) };
//!         let mut ray: Ray<f32> = Ray {
//!             origin: Vec3::splat([0.0, 0.0, 1.0]),
//!             direction: Vec3::splat([0.0, 0.0, -1.0]),
//!         };
//!         let mut throughput = 1.0;
//!         sum += loop {
//!             let down = ray.direction.z < 0.0;
//!             let height = if down { ray.origin.z } else { 1.0 - ray.origin.z };
//!             let t_max = height / ray.direction.z.abs();
//!             let flight = analytic::sample(fog, &ray, t_max, &mut rng, true);
//!             if !flight.collided {
//!                 break if down { 0.0 } else { throughput };
//!             }
//!             throughput *= albedo;
//!             let cos_theta = henyey_greenstein::sample(uniform(&mut rng), g);
//!             ray.origin = ray.at(flight.t);
//!             ray.direction = ray.direction.deflected(cos_theta, uniform(&mut rng));
//!         };
//!     }
//!     sum / samples as f32
//! }
//!
//! // Van de Hulst's tables give 0.267410 for isotropic scattering, albedo 0.9 and optical depth 1.
//! let fog = Homogeneous::new(1.0)?;
//! assert!((pixel(&fog, 0.9, 0.0, 100_000) - 0.26741).abs() < 0.005);
//! # Ok::<(), woodcock_core::medium::ExtinctionError>(())
//! ```
//!
//! ## Features
//! `std`: takes the square root from the standard library, which is faster and gives the same bits.
#![no_std]
#![forbid(unsafe_code)]

pub mod camera;
pub mod collision;
pub mod elementary;
pub mod enclosure;
pub mod free_flight;
pub mod light;
pub mod line_integral;
pub mod majorant;
pub mod medium;
pub mod path;
pub mod phase;
pub mod points;
pub mod ray;
pub mod real;
pub mod room;
pub mod spectral;
pub mod stability;
pub mod stream;
pub mod sum;
pub mod transmittance;
pub mod vec3;
