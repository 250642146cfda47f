//! A medium under audit: counts the look-ups, and the ones that a bound failed to bound.
//!
//! A majorant that is too small biases every tracker. Nothing here clamps such a value; it is used as
//! it is, and counted.

use core::cell::Cell;

use crate::majorant::Segment;
use crate::medium::{Control, Controlled, Medium, PiecewiseConstant};
use crate::ray::Ray;
use crate::real::{Mask, Real};
use crate::stream::Stream;

/// Any medium, with counters. For one thread; the counts of several add.
#[derive(Clone, Debug, Default)]
pub struct Audited<M> {
    medium: M,
    lookups: Cell<u64>,
    violations: Cell<u64>,
    segments: Cell<u64>,
}

impl<M> Audited<M> {
    /// With all counters at zero.
    pub fn new(medium: M) -> Self {
        Self {
            medium,
            lookups: Cell::new(0),
            violations: Cell::new(0),
            segments: Cell::new(0),
        }
    }

    /// Look-ups of the extinction by active lanes.
    pub fn lookups(&self) -> u64 {
        self.lookups.get()
    }

    /// Look-ups that exceeded their segment's majorant.
    pub fn violations(&self) -> u64 {
        self.violations.get()
    }

    /// Steps from one majorant segment to the next.
    pub fn segments(&self) -> u64 {
        self.segments.get()
    }
}

fn add(counter: &Cell<u64>, lanes: impl Mask) {
    counter.set(counter.get() + u64::from(lanes.count()));
}

impl<R: Real, M: Medium<R>> Medium<R> for Audited<M> {
    type Walk = M::Walk;
    const ONE_SEGMENT: bool = M::ONE_SEGMENT;
    const TIGHT: bool = M::TIGHT;

    #[inline(always)]
    fn idle(&self) -> M::Walk {
        self.medium.idle()
    }
    #[inline(always)]
    fn begin(&self, walk: &mut M::Walk, ray: &Ray<R>, active: R::Mask) {
        self.medium.begin(walk, ray, active);
    }
    #[inline(always)]
    fn segment(&self, walk: &M::Walk) -> Segment<R> {
        self.medium.segment(walk)
    }
    #[inline(always)]
    fn next_segment(&self, walk: &mut M::Walk, active: R::Mask) {
        add(&self.segments, active);
        self.medium.next_segment(walk, active);
    }
    #[inline(always)]
    fn sigma_t(&self, walk: &M::Walk, t: R, rng: &mut impl Stream<R>, active: R::Mask) -> R {
        let sigma_t = self.medium.sigma_t(walk, t, rng, active);
        let majorant = self.medium.segment(walk).majorant;
        add(&self.lookups, active);
        // Written so that NaN counts.
        add(&self.violations, active.and_not(sigma_t.le(majorant)));
        sigma_t
    }
}

impl<R: Real, M: Controlled<R>> Controlled<R> for Audited<M> {
    #[inline(always)]
    fn control(&self, walk: &M::Walk) -> Control<R> {
        self.medium.control(walk)
    }
}

impl<R: Real, M: PiecewiseConstant<R>> PiecewiseConstant<R> for Audited<M> {}
