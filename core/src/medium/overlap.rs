//! Two media in the same place: coefficients add, and so do their bounds.
//!
//! ```text
//! σ_t = σ_A + σ_B,   σ̄ = σ̄_A + σ̄_B on every piece that lies in one segment of each
//! ```
//!
//! Nested overlaps hold any number of media. A sum of bounds may be loose: the maxima of the parts need
//! not coincide. Rounding is monotone, so a sum of values never exceeds the sum of their bounds.

use crate::majorant::Segment;
use crate::medium::{ClosedForm, Control, Controlled, Medium, PiecewiseConstant};
use crate::ray::Ray;
use crate::real::{Mask, Real};
use crate::stream::Stream;

/// The sum of two media; both must be defined wherever rays go (see [`Within`](super::Within)).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Overlap<A, B>(
    /// The one.
    pub A,
    /// The other.
    pub B,
);

impl<R: Real, A: Medium<R>, B: Medium<R>> Medium<R> for Overlap<A, B> {
    type Walk = (A::Walk, B::Walk);
    const ONE_SEGMENT: bool = A::ONE_SEGMENT && B::ONE_SEGMENT;
    const TIGHT: bool = A::TIGHT && B::TIGHT;

    #[inline(always)]
    fn idle(&self) -> Self::Walk {
        (self.0.idle(), self.1.idle())
    }
    #[inline(always)]
    fn begin(&self, walk: &mut Self::Walk, ray: &Ray<R>, active: R::Mask) {
        self.0.begin(&mut walk.0, ray, active);
        self.1.begin(&mut walk.1, ray, active);
    }
    #[inline(always)]
    fn segment(&self, walk: &Self::Walk) -> Segment<R> {
        let (a, b) = (self.0.segment(&walk.0), self.1.segment(&walk.1));
        Segment {
            majorant: a.majorant + b.majorant,
            t_exit: a.t_exit.min(b.t_exit),
        }
    }
    #[inline(always)]
    fn next_segment(&self, walk: &mut Self::Walk, active: R::Mask) {
        let (a, b) = (
            self.0.segment(&walk.0).t_exit,
            self.1.segment(&walk.1).t_exit,
        );
        let (first, second) = (a.le(b) & active, b.le(a) & active);
        if first.any() {
            self.0.next_segment(&mut walk.0, first);
        }
        if second.any() {
            self.1.next_segment(&mut walk.1, second);
        }
    }
    #[inline(always)]
    fn sigma_t(&self, walk: &Self::Walk, t: R, rng: &mut impl Stream<R>, active: R::Mask) -> R {
        let a = self.0.sigma_t(&walk.0, t, rng, active);
        a + self.1.sigma_t(&walk.1, t, rng, active)
    }
}

impl<R: Real, A: Controlled<R>, B: Controlled<R>> Controlled<R> for Overlap<A, B> {
    #[inline(always)]
    fn control(&self, walk: &Self::Walk) -> Control<R> {
        let (a, b) = (self.0.control(&walk.0), self.1.control(&walk.1));
        Control {
            minimum: a.minimum + b.minimum,
            mean: a.mean + b.mean,
        }
    }
}

impl<R: Real, A: PiecewiseConstant<R>, B: PiecewiseConstant<R>> PiecewiseConstant<R>
    for Overlap<A, B>
{
}

impl<A, B> Overlap<A, B> {
    /// The optical depth of both on `[0, t)`, which adds; a distance to a given one has no closed form
    /// in general.
    #[inline(always)]
    pub fn optical_depth<R: Real>(&self, ray: &Ray<R>, t: R) -> R
    where
        A: ClosedForm<R>,
        B: ClosedForm<R>,
    {
        self.0.optical_depth(ray, t) + self.1.optical_depth(ray, t)
    }
}
