//! Where paths begin: camera rays, and their first stretches within media.

use crate::majorant::Mark;
use crate::path::{Geometry, PathMedium, Scene, Stretch};
use crate::points::{Choice, LaneStrata, Stratified};
use crate::ray::Ray;
use crate::real::Real;
use crate::stream::Stream;

/// Paths about to begin, per lane.
#[derive(Clone, Copy, Debug)]
pub struct Start<R: Real> {
    /// Camera rays.
    pub ray: Ray<R>,
    /// Their first stretches; rays without one meet the environment alone.
    pub first: Stretch<R>,
    /// The strata of the paths' first choices.
    pub strata: LaneStrata<R::Word>,
    /// Where the stretches begin, in a medium that is alone.
    pub mark: Mark<R>,
}

impl<R: Real> Start<R> {
    /// Begins paths in the active lanes of streams that stand at the beginning of theirs.
    ///
    /// * `x`, `y`: column and row of each path's pixel. `strata`: read where the scene asks for points.
    #[inline(always)]
    pub fn new<M: PathMedium<R>, G: Geometry<R> + ?Sized>(
        scene: &Scene<'_, M, G>,
        place: [R; 2],
        strata: LaneStrata<R::Word>,
        rng: &mut impl Stream<R>,
        lanes: R::Mask,
    ) -> Self {
        use crate::real::Word;
        let ray = camera_ray(scene, place, &strata, rng, lanes);
        let mut first = scene.geometry.stretch(&ray, R::Word::splat(0), lanes);
        first.found = first.found & lanes;
        let mut mark = Mark::none();
        if scene.medium.is_alone() {
            let entry = Ray {
                origin: ray.at(first.interval.t0),
                direction: ray.direction,
            };
            mark = scene.medium.mark_origin(&entry, first.found);
        }
        Self {
            ray,
            first,
            strata,
            mark,
        }
    }
}

/// The camera rays of new paths.
#[inline(always)]
pub(super) fn camera_ray<R: Real, M, G: ?Sized>(
    scene: &Scene<'_, M, G>,
    [x, y]: [R; 2],
    strata: &LaneStrata<R::Word>,
    rng: &mut impl Stream<R>,
    lanes: R::Mask,
) -> Ray<R> {
    if !scene.settings.points {
        return scene.camera.ray(x, y, rng, lanes);
    }
    let choices = [
        Choice::PixelX,
        Choice::PixelY,
        Choice::LensRadius,
        Choice::LensTurn,
    ];
    let leading = choices.map(|choice| strata.leading(choice));
    let mut stream = Stratified::new(rng, leading, lanes);
    scene.camera.ray(x, y, &mut stream, lanes)
}
