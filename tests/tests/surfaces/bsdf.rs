//! Materials against closed forms, quadrature and published Fresnel values.
//!
//! Pointwise identities and quadrature prove the values; chi-square ties samples to densities. Each family of checks
//! has a planted [`Mistake`](subject::Mistake) that it must reject.

mod energy;
mod fresnel;
mod identities;
mod robustness;
mod samples;
mod subject;
mod textbook;
