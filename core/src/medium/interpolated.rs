//! A grid whose look-ups are the full trilinear interpolant: eight samples, no draws.
//!
//! One tap serves wherever the extinction enters linearly, and costs an eighth. Where it does not, as in
//! ray marching, or where look-up noise would be all the noise there is, as in power series on smooth
//! media, the whole interpolant pays.

use crate::majorant::{GridWalk, Segment};
use crate::medium::{Control, Controlled, Grid, Medium};
use crate::ray::Ray;
use crate::real::Real;
use crate::stream::Stream;

/// A [`Grid`], looked up in full; everything else is the grid's.
#[derive(Clone, Copy, Debug)]
pub struct Interpolated<'a>(
    /// The grid.
    pub Grid<'a>,
);

impl<R: Real> Medium<R> for Interpolated<'_> {
    type Walk = GridWalk<R>;
    const ONE_SEGMENT: bool = false;
    const TIGHT: bool = false;

    #[inline(always)]
    fn idle(&self) -> GridWalk<R> {
        self.0.idle()
    }
    #[inline(always)]
    fn begin(&self, walk: &mut GridWalk<R>, ray: &Ray<R>, active: R::Mask) {
        self.0.begin(walk, ray, active);
    }
    #[inline(always)]
    fn segment(&self, walk: &GridWalk<R>) -> Segment<R> {
        self.0.segment(walk)
    }
    #[inline(always)]
    fn next_segment(&self, walk: &mut GridWalk<R>, active: R::Mask) {
        self.0.next_segment(walk, active);
    }
    #[inline(always)]
    fn sigma_t(&self, walk: &GridWalk<R>, t: R, _: &mut impl Stream<R>, _: R::Mask) -> R {
        self.0.trilinear(walk, t)
    }
}

impl<R: Real> Controlled<R> for Interpolated<'_> {
    #[inline(always)]
    fn control(&self, walk: &GridWalk<R>) -> Control<R> {
        self.0.control(walk)
    }
}
