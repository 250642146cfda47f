//! The statistical test harness.
#![forbid(unsafe_code)]
