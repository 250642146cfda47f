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
//! | `sigma_t` | σ_t = σ_a + σ_s | 1/length | extinction coefficient |
//! | `majorant` | σ̄ ≥ σ_t | 1/length | bound that homogenises |
//! | `albedo` | α = σ_s/σ_t | 1 | single-scattering albedo |
//! | `optical_depth` | τ = ∫σ_t dt | 1 | along a ray |
//! | `transmittance` | T = e^−τ | 1 | a single estimate is a `weight` until it is averaged |
//! | `t`, `t_max` | t | length | distance along a unit direction |
//! | `eval`, `pdf` | p(cos θ) | 1/sr | normalised over the sphere |
//! | `u`, `key` | ξ | 1 | uniform in [0, 1); identity of the stream |
//! | `throughput`, `radiance` | β, L | 1, W/(m² sr) | path weight; what the film averages |
//!
//! A *tentative* collision is an event of the majorant process. It becomes *real* or *null*. `cos_theta`
//! lies between the directions of propagation before and after: forward is +1.
//!
//! ## Example: fog, estimated
//! ```
//! use woodcock_core::medium::Homogeneous;
//! use woodcock_core::stream::{Key, PathStream};
//! use woodcock_core::free_flight::analytic;
//!
//! let fog = Homogeneous::new(0.5)?;
//! let mut passed = 0;
//! for sample in 0..10_000 {
//!     let mut rng = PathStream::new(Key { seed: 1, pixel: 0, sample });
//!     let flight = analytic::sample(&fog, 2.0_f32, &mut rng, true);
//!     passed += u32::from(!flight.collided);
//! }
//! let transmittance = f64::from(passed) / 10_000.0;
//! assert!((transmittance - (-1.0_f64).exp()).abs() < 0.02);
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
pub mod free_flight;
pub mod light;
pub mod majorant;
pub mod medium;
pub mod path;
pub mod phase;
pub mod ray;
pub mod real;
pub mod spectral;
pub mod stream;
pub mod transmittance;
pub mod vec3;
