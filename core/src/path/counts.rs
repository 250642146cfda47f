//! What tracing paths came to, in numbers.

/// What the steps did, summed over lanes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Paths launched.
    pub paths: u64,
    /// Tentative collisions, of flights and shadow rays.
    pub tentative_collisions: u64,
    /// Flights ended by a real collision.
    pub real_collisions: u64,
    /// Tentative collisions of flights that were null.
    pub null_collisions: u64,
    /// Look-ups of samples.
    pub lookups: u64,
    /// Look-ups of exact samples, where bounds had not decided.
    pub exact_lookups: u64,
    /// Majorant segments walked.
    pub majorant_cells: u64,
    /// Tentative collisions whose extinction exceeded the bound: always zero unless a bound is wrong.
    pub majorant_violations: u64,
    /// Steps taken, all lanes together counting once.
    pub steps: u64,
    /// Lanes, summed over steps.
    pub lanes: u64,
    /// Lanes that held an unfinished path, summed over steps.
    pub busy_lanes: u64,
}

impl Counts {
    /// Adds a step.
    ///
    /// * `lanes`: all that there are. `busy`: those with an unfinished path.
    #[inline(always)]
    pub fn add_step(&mut self, lanes: usize, busy: u32) {
        self.steps += 1;
        self.lanes += lanes as u64;
        self.busy_lanes += u64::from(busy);
    }

    /// Adds another's.
    pub fn add(&mut self, other: &Self) {
        self.paths += other.paths;
        self.tentative_collisions += other.tentative_collisions;
        self.real_collisions += other.real_collisions;
        self.null_collisions += other.null_collisions;
        self.lookups += other.lookups;
        self.exact_lookups += other.exact_lookups;
        self.majorant_cells += other.majorant_cells;
        self.majorant_violations += other.majorant_violations;
        self.steps += other.steps;
        self.lanes += other.lanes;
        self.busy_lanes += other.busy_lanes;
    }
}
