//! The statistical test harness of woodcock: verdicts, fixtures with known answers, reference tables.
//!
//! [`stats`] judges, [`refs`] holds tables that no code of this workspace produced, [`fixtures`] turns the densities
//! among them into functions that a tracker can fly through.
#![forbid(unsafe_code)]

pub mod fixtures;
pub mod refs;
pub mod scenes;
pub mod stats;
