//! Majorants: bounds on the extinction, in pieces along a ray, and the one loop that consumes them.
//!
//! A medium proposes [`Segment`]s, each with a constant bound σ̄ on its extinction; the [`Tracker`]
//! owns the stepping and says where tentative collisions fall. What a tentative collision means
//! (absorption, scattering, null) is decided by the caller.

mod cells;
mod controls;
mod dda;
mod footprint;
mod grid;
mod hierarchy;
pub(crate) mod leaps;
mod rounding;
mod stages;
mod tracker;
mod work;

pub use cells::{CellError, Cells};
pub use controls::{ControlledGrid, fill_control_slab, fill_controls};
pub use dda::{GridLayout, GridWalk, Mark};
pub(crate) use footprint::for_each_entry;
pub use footprint::{block_counts, majorant_count, majorant_count_of};
pub use grid::{BLOCK, EDGES, MajorantError, MajorantGrid, fill_majorants, fill_slab};
pub use hierarchy::{WalkCost, coarsen, walk_cost};
pub use leaps::fill_leaps;
pub use stages::{Process, Stages};
pub use tracker::{Advance, Tracker};
pub(crate) use work::for_each_segment;
pub use work::{WORK_LIMIT, WorkError, check_work, majorant_depth};

/// A piece of a ray on which one bound holds.
#[derive(Clone, Copy, Debug)]
pub struct Segment<R> {
    /// σ̄ ≥ σ_t everywhere on the piece [1/length].
    pub majorant: R,
    /// Where the piece ends [length along the ray].
    pub t_exit: R,
}
