//! A medium that ends at a box: zero extinction outside, whatever the medium says there.
//!
//! The ray is cut into the part before the box, the part within and the part behind, the outer two
//! with a bound of zero; the medium within sees a ray that begins where it enters. So a grid, which is
//! defined in its box only, becomes a medium that fills space and can overlap with others.

use crate::majorant::Segment;
use crate::medium::{Affine, Control, Controlled, Grid, Medium, PiecewiseConstant, transform_ray};
use crate::ray::{FAR, Ray, clip_to_box};
use crate::real::{Mask, Real};
use crate::stream::Stream;
use crate::vec3::Vec3;

/// A medium within a box, anywhere in space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Within<M> {
    medium: M,
    world_to_box: Affine,
    size: [f32; 3],
}

impl<M> Within<M> {
    /// * `world_to_box`: maps to the space in which the box is `[0, size]`; `medium` itself stays in
    ///   world space.
    ///
    /// # Errors
    /// `None` where the map is not finite, or a size is not positive and finite.
    pub fn new(medium: M, world_to_box: Affine, size: [f32; 3]) -> Option<Self> {
        let map = world_to_box.iter().flatten().all(|x| x.is_finite());
        let sizes = size.iter().all(|x| *x > 0.0 && x.is_finite());
        (map && sizes).then_some(Self {
            medium,
            world_to_box,
            size,
        })
    }

    /// Within the box of world space from `low` to `high`.
    ///
    /// # Errors
    /// `None` where the box is empty or not finite.
    pub fn aligned(medium: M, low: [f32; 3], high: [f32; 3]) -> Option<Self> {
        let [x, y, z] = low;
        let move_to_origin = [
            [1.0, 0.0, 0.0, -x],
            [0.0, 1.0, 0.0, -y],
            [0.0, 0.0, 1.0, -z],
        ];
        let size = [high[0] - x, high[1] - y, high[2] - z];
        Self::new(medium, move_to_origin, size)
    }
}

impl<'a> Within<Grid<'a>> {
    /// A grid within its own domain.
    pub fn domain(grid: Grid<'a>) -> Self {
        Self {
            world_to_box: *grid.world_to_grid(),
            size: grid.size(),
            medium: grid,
        }
    }
}

/// Where a lane is on its way through a box.
#[derive(Clone, Debug)]
pub struct WithinWalk<R: Real, W> {
    inner: W,
    /// Where the ray enters, and where it leaves; no earlier than it enters \[length\].
    t0: R,
    t1: R,
    /// Lanes not yet in the box, and lanes in it.
    before: R::Mask,
    inside: R::Mask,
}

impl<R: Real, M: Medium<R>> Medium<R> for Within<M> {
    type Walk = WithinWalk<R, M::Walk>;
    const ONE_SEGMENT: bool = false;
    const TIGHT: bool = M::TIGHT;

    #[inline(always)]
    fn idle(&self) -> Self::Walk {
        let none = R::Mask::splat(false);
        WithinWalk {
            inner: self.medium.idle(),
            t0: R::zero(),
            t1: R::zero(),
            before: none,
            inside: none,
        }
    }
    #[inline(always)]
    fn begin(&self, walk: &mut Self::Walk, ray: &Ray<R>, active: R::Mask) {
        let local = transform_ray(self.world_to_box.map(|row| row.map(R::splat)), ray);
        let part = clip_to_box(local.origin, local.direction, Vec3::splat(self.size));
        let hits = part.t0.lt(part.t1);
        walk.t0 = R::select(active, R::select(hits, part.t0, R::splat(FAR)), walk.t0);
        walk.t1 = R::select(active, R::select(hits, part.t1, R::splat(FAR)), walk.t1);
        let at_once = walk.t0.le(R::zero());
        walk.before = walk.before.and_not(active) | active.and_not(at_once);
        walk.inside = walk.inside.and_not(active) | (active & at_once);
        let entering = active & hits;
        if entering.any() {
            let from = Ray {
                origin: ray.at(R::select(hits, part.t0, R::zero())),
                direction: ray.direction,
            };
            self.medium.begin(&mut walk.inner, &from, entering);
        }
    }
    #[inline(always)]
    fn segment(&self, walk: &Self::Walk) -> Segment<R> {
        let inner = self.medium.segment(&walk.inner);
        let outside = R::select(walk.before, walk.t0, R::splat(FAR));
        Segment {
            majorant: inner.majorant.or_zero(walk.inside),
            t_exit: R::select(walk.inside, (walk.t0 + inner.t_exit).min(walk.t1), outside),
        }
    }
    #[inline(always)]
    fn next_segment(&self, walk: &mut Self::Walk, active: R::Mask) {
        let entering = walk.before & active;
        let crossing = walk.inside & active;
        let exit = walk.t0 + self.medium.segment(&walk.inner).t_exit;
        let leaving = crossing & walk.t1.le(exit);
        walk.before = walk.before.and_not(entering);
        walk.inside = (walk.inside | (entering & walk.t0.lt(R::splat(FAR)))).and_not(leaving);
        let on = crossing.and_not(leaving);
        if on.any() {
            self.medium.next_segment(&mut walk.inner, on);
        }
    }
    #[inline(always)]
    fn sigma_t(&self, walk: &Self::Walk, t: R, rng: &mut impl Stream<R>, active: R::Mask) -> R {
        let within = (t - walk.t0).max(R::zero());
        let sigma_t = self
            .medium
            .sigma_t(&walk.inner, within, rng, active & walk.inside);
        sigma_t.or_zero(walk.inside)
    }
}

impl<R: Real, M: Controlled<R>> Controlled<R> for Within<M> {
    #[inline(always)]
    fn control(&self, walk: &Self::Walk) -> Control<R> {
        let Control { minimum, mean } = self.medium.control(&walk.inner);
        Control {
            minimum: minimum.or_zero(walk.inside),
            mean: mean.or_zero(walk.inside),
        }
    }
}

impl<R: Real, M: PiecewiseConstant<R>> PiecewiseConstant<R> for Within<M> {}
