//! A medium moved, turned, stretched or sheared by an affine map.
//!
//! ```text
//! σ_t(x) = σ_local(A x)
//! ```
//!
//! The ray is seen through the map, its direction with the scaled length, so that t stays a length of
//! the world; coefficients are per length of the world, too: a stretched cloud has longer optical
//! depths, as one that were blown up.

use crate::majorant::Segment;
use crate::medium::{
    Affine, ClosedForm, Control, Controlled, Medium, PiecewiseConstant, transform_ray,
};
use crate::ray::Ray;
use crate::real::Real;
use crate::stream::Stream;

/// A medium in a space of its own.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placed<M> {
    medium: M,
    world_to_local: Affine,
}

impl<M> Placed<M> {
    /// * `world_to_local`: maps places of the world to the medium's own space.
    ///
    /// # Errors
    /// `None` where the map is not finite.
    pub fn new(medium: M, world_to_local: Affine) -> Option<Self> {
        let finite = world_to_local.iter().flatten().all(|x| x.is_finite());
        finite.then_some(Self {
            medium,
            world_to_local,
        })
    }

    /// A world-space ray in the medium's space.
    #[inline(always)]
    pub fn to_local<R: Real>(&self, ray: &Ray<R>) -> Ray<R> {
        transform_ray(self.world_to_local.map(|row| row.map(R::splat)), ray)
    }
}

impl<R: Real, M: Medium<R>> Medium<R> for Placed<M> {
    type Walk = M::Walk;
    const ONE_SEGMENT: bool = M::ONE_SEGMENT;
    const TIGHT: bool = M::TIGHT;

    #[inline(always)]
    fn idle(&self) -> M::Walk {
        self.medium.idle()
    }
    #[inline(always)]
    fn begin(&self, walk: &mut M::Walk, ray: &Ray<R>, active: R::Mask) {
        self.medium.begin(walk, &self.to_local(ray), active);
    }
    #[inline(always)]
    fn segment(&self, walk: &M::Walk) -> Segment<R> {
        self.medium.segment(walk)
    }
    #[inline(always)]
    fn next_segment(&self, walk: &mut M::Walk, active: R::Mask) {
        self.medium.next_segment(walk, active);
    }
    #[inline(always)]
    fn sigma_t(&self, walk: &M::Walk, t: R, rng: &mut impl Stream<R>, active: R::Mask) -> R {
        self.medium.sigma_t(walk, t, rng, active)
    }
}

impl<R: Real, M: Controlled<R>> Controlled<R> for Placed<M> {
    #[inline(always)]
    fn control(&self, walk: &M::Walk) -> Control<R> {
        self.medium.control(walk)
    }
}

impl<R: Real, M: PiecewiseConstant<R>> PiecewiseConstant<R> for Placed<M> {}

impl<R: Real, M: ClosedForm<R>> ClosedForm<R> for Placed<M> {
    #[inline(always)]
    fn optical_depth(&self, ray: &Ray<R>, t: R) -> R {
        self.medium.optical_depth(&self.to_local(ray), t)
    }
    #[inline(always)]
    fn distance(&self, ray: &Ray<R>, depth: R) -> R {
        self.medium.distance(&self.to_local(ray), depth)
    }
}
