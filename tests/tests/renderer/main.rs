//! The suites of `host`, in one program.
#![forbid(unsafe_code)]

mod cli;
mod nvdb;
mod pbrt;
mod pbrt_errors;
mod pbrt_mutations;
mod render;
mod stopping;
mod vdb;
mod vol;
