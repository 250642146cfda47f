//! Integrators against each other, against closed forms and tables.
//!
//! Comparisons of pictures are by `woodcock_tests::replicates`: of each pair and colour the whole and the tiles are tested,
//! either with a false alarm in 10⁶ (|z| of 4.892 for one deviate). A comparison that cannot resolve what it states is a
//! failure, too. Seeds are constants; `WOODCOCK_SAMPLES` and `WOODCOCK_SEED` deepen and move a run.
#![forbid(unsafe_code)]

mod bits;
mod closed_forms;
mod equivalence;
mod furnace;
mod mixed;
mod options;
mod pairwise;
mod planted;
mod rooms;
mod surfaces;
mod tables;
