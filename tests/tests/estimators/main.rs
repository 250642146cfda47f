//! The suites of `core` and `packet`, in one program: linking one is quicker than linking ten.
#![forbid(unsafe_code)]

mod coverage;
mod elementary;
mod enclosure;
mod free_flight;
mod glow;
mod line_integral;
mod majorant;
mod medium;
mod phase;
mod random_walk;
mod spectral;
mod stream;
mod stress;
mod transmittance;
