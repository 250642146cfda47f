//! Extinction between borrowed samples, interpolated trilinearly, with a certified majorant grid.

use crate::majorant::{ControlledGrid, GridLayout, GridWalk, Segment};
use crate::medium::{Control, Controlled, Medium};
use crate::ray::Ray;
use crate::real::Real;
use crate::stream::Stream;

/// A grid of samples placed in space; domain: the box between its outermost samples.
///
/// σ_t(x) = scale · (trilinear interpolant of the samples at `world_to_grid` x).
#[derive(Clone, Copy, Debug)]
pub struct Grid<'a> {
    bounds: ControlledGrid<'a>,
    world_to_grid: Affine,
    scale: f32,
}

/// An affine map: three rows of a 3×4 matrix, the last column being the translation.
pub type Affine = [[f32; 4]; 3];

/// The map that leaves every point where it is.
pub const IDENTITY: Affine = [
    [1.0, 0.0, 0.0, 0.0],
    [0.0, 1.0, 0.0, 0.0],
    [0.0, 0.0, 1.0, 0.0],
];

/// A ray seen through an affine map; t keeps its meaning, the direction its scaled length.
#[inline(always)]
pub fn transform_ray<R: Real>(rows: [[R; 4]; 3], ray: &Ray<R>) -> Ray<R> {
    let (o, d) = (ray.origin, ray.direction);
    let point = |r: [R; 4]| (r[0] * o.x + r[1] * o.y) + (r[2] * o.z + r[3]);
    let vector = |r: [R; 4]| r[0] * d.x + r[1] * d.y + r[2] * d.z;
    Ray {
        origin: crate::vec3::Vec3::new(point(rows[0]), point(rows[1]), point(rows[2])),
        direction: crate::vec3::Vec3::new(vector(rows[0]), vector(rows[1]), vector(rows[2])),
    }
}

impl<'a> Grid<'a> {
    /// Samples and bounds, where they lie, and what a sample of one means.
    ///
    /// * `bounds`: a [`MajorantGrid`](crate::majorant::MajorantGrid), or one with controls.
    /// * `world_to_grid`: maps to the space where samples lie at the integers.
    /// * `scale`: extinction of a sample of one [1/length], not negative.
    ///
    /// # Errors
    /// `None` where the map or the scale is not finite, the scale negative, or a bound times the scale
    /// beyond the largest number: a tracker could not step under it.
    pub fn new(
        bounds: impl Into<ControlledGrid<'a>>,
        world_to_grid: Affine,
        scale: f32,
    ) -> Option<Self> {
        let bounds = bounds.into();
        let finite = world_to_grid.iter().flatten().all(|x| x.is_finite());
        let scaled = bounds.bounds().majorants.iter().map(|bound| bound * scale);
        let in_range = scale >= 0.0 && scaled.fold(scale, f32::max).is_finite();
        (finite && in_range).then_some(Self {
            bounds,
            world_to_grid,
            scale,
        })
    }

    /// The map to the space where samples lie at the integers.
    pub fn world_to_grid(&self) -> &Affine {
        &self.world_to_grid
    }

    /// The far corner of the domain in grid space; the near one is the origin.
    pub fn size(&self) -> [f32; 3] {
        self.bounds.bounds().size::<f32>().lane(0)
    }

    /// A world-space ray in grid space.
    #[inline(always)]
    pub fn to_grid<R: Real>(&self, ray: &Ray<R>) -> Ray<R> {
        transform_ray(self.world_to_grid.map(|row| row.map(R::splat)), ray)
    }

    /// The part of a world-space ray within the domain.
    #[inline(always)]
    pub fn clip<R: Real>(&self, ray: &Ray<R>) -> crate::ray::Interval<R> {
        let local = self.to_grid(ray);
        crate::ray::clip_to_box(local.origin, local.direction, self.bounds.bounds().size())
    }

    /// The full interpolant on a begun walk at distance `t` [1/length].
    #[inline(always)]
    pub fn trilinear<R: Real>(&self, walk: &GridWalk<R>, t: R) -> R {
        walk.trilinear(self.bounds.bounds().samples, t)
    }
}

impl<R: Real> Medium<R> for Grid<'_> {
    type Walk = GridWalk<R>;
    const ONE_SEGMENT: bool = false;
    const TIGHT: bool = false;

    #[inline(always)]
    fn idle(&self) -> GridWalk<R> {
        GridWalk::idle()
    }
    #[inline(always)]
    fn begin(&self, walk: &mut GridWalk<R>, ray: &Ray<R>, active: R::Mask) {
        let layout = GridLayout::of(&self.bounds.bounds(), self.scale);
        walk.begin(
            &layout,
            &self.to_grid(ray),
            self.bounds.bounds().majorants,
            active,
        );
    }
    #[inline(always)]
    fn segment(&self, walk: &GridWalk<R>) -> Segment<R> {
        walk.segment()
    }
    #[inline(always)]
    fn next_segment(&self, walk: &mut GridWalk<R>, active: R::Mask) {
        walk.next_segment(self.bounds.bounds().majorants, active);
    }
    #[inline(always)]
    fn sigma_t(&self, walk: &GridWalk<R>, t: R, rng: &mut impl Stream<R>, active: R::Mask) -> R {
        walk.sigma_t(self.bounds.bounds().samples, t, rng, active)
    }
}

/// From the tables of controls; zero without, which makes residual ratio tracking ratio tracking.
impl<R: Real> Controlled<R> for Grid<'_> {
    #[inline(always)]
    fn control(&self, walk: &GridWalk<R>) -> Control<R> {
        Control {
            minimum: walk.of_block(self.bounds.minorants()),
            mean: walk.of_block(self.bounds.means()),
        }
    }
}
