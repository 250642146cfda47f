//! The statistical test harness of woodcock: verdicts, fixtures with known answers, reference tables.
//!
//! [`stats`] judges, [`refs`] holds tables that no code of this workspace produced, [`fixtures`] turns the densities
//! among them into functions that a tracker can fly through, [`grids`], [`voxels`] and [`depth`] are the oracle of sampled media,
//! [`rows`] and [`widths`] let one suite serve every estimator at every width, [`mutants`] must not survive it,
//! [`walker`] sends particles through core's estimators, [`scenes`] are what whole paths are compared on, and
//! [`pictures`] renders scenes written as text, of which [`gallery`] has a choice; [`replicates`] compares pictures whose
//! pixels depend on each other.
#![forbid(unsafe_code)]

pub mod depth;
pub mod fixtures;
pub mod gallery;
pub mod grids;
pub mod mutants;
pub mod pictures;
pub mod refs;
pub mod replicates;
pub mod rows;
pub mod scenes;
pub mod stats;
pub mod voxels;
pub mod walker;
pub mod widths;
