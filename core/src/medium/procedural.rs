//! Extinction by a function of the place, under one bound for all of it.

use crate::majorant::Segment;
use crate::medium::{Control, Controlled, Medium};
use crate::ray::{FAR, Ray};
use crate::real::Real;
use crate::stream::Stream;
use crate::vec3::Vec3;

/// A procedural medium that fills space.
#[derive(Clone, Copy, Debug)]
pub struct Procedural<F> {
    sigma_t: F,
    majorant: f32,
    minimum: f32,
    mean: f32,
}

impl<F> Procedural<F> {
    /// * `sigma_t`: extinction at a world-space point, per lane [1/length]; total, as finished lanes
    ///   ask too, anywhere.
    /// * `majorant`: a bound on it wherever rays go [1/length], positive and finite. One that fails
    ///   to bound biases delta tracking; ratio tracking then only grows noisier.
    pub fn new(sigma_t: F, majorant: f32) -> Self {
        debug_assert!(
            majorant >= 0.0 && majorant.is_finite(),
            "majorant {majorant}"
        );
        Self {
            sigma_t,
            majorant,
            minimum: 0.0,
            mean: 0.0,
        }
    }

    /// Adds what control variates want to know.
    ///
    /// * `minimum`: below the extinction wherever rays go [1/length]; one that is not biases
    ///   decomposition tracking, which takes it for granted.
    /// * `mean`: about the extinction's mean there [1/length]; any number from the minimum to the
    ///   majorant is valid, a good one saves variance.
    pub fn with_control(self, minimum: f32, mean: f32) -> Self {
        debug_assert!(
            0.0 <= minimum && minimum <= mean && mean <= self.majorant,
            "controls {minimum}, {mean} under {}",
            self.majorant
        );
        Self {
            minimum,
            mean,
            ..self
        }
    }
}

impl<R: Real, F: Fn(Vec3<R>) -> R> Medium<R> for Procedural<F> {
    type Walk = Ray<R>;
    const ONE_SEGMENT: bool = true;
    const TIGHT: bool = false;

    #[inline(always)]
    fn idle(&self) -> Ray<R> {
        Ray {
            origin: Vec3::uniform(0.0),
            direction: Vec3::uniform(0.0),
        }
    }
    #[inline(always)]
    fn begin(&self, walk: &mut Ray<R>, ray: &Ray<R>, active: R::Mask) {
        *walk = Ray::select(active, ray, walk);
    }
    #[inline(always)]
    fn segment(&self, _: &Ray<R>) -> Segment<R> {
        Segment {
            majorant: R::splat(self.majorant),
            t_exit: R::splat(FAR),
        }
    }
    #[inline(always)]
    fn next_segment(&self, _: &mut Ray<R>, _: R::Mask) {}
    #[inline(always)]
    fn sigma_t(&self, walk: &Ray<R>, t: R, _: &mut impl Stream<R>, _: R::Mask) -> R {
        (self.sigma_t)(walk.at(t))
    }
}

impl<R: Real, F: Fn(Vec3<R>) -> R> Controlled<R> for Procedural<F> {
    #[inline(always)]
    fn control(&self, _: &Ray<R>) -> Control<R> {
        Control {
            minimum: R::splat(self.minimum),
            mean: R::splat(self.mean),
        }
    }
}
