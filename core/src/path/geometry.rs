//! Where media lie: stretches of a ray, found from outside the walk.
//!
//! A medium's region is a set of intervals on a ray, and not a pair of surface hits with offsets; so no
//! particle is lost or found twice at a boundary.

use crate::medium::{Affine, transform_ray};
use crate::ray::{FAR, Interval, Ray, clip_to_box, clip_to_unit_sphere};
use crate::real::{Mask, Real, Word};
use crate::vec3::Vec3;

/// A stretch of a ray within one medium, per lane.
#[derive(Clone, Copy, Debug)]
pub struct Stretch<R: Real> {
    /// Where it lies on the ray; may be empty.
    pub interval: Interval<R>,
    /// Which medium.
    pub medium: R::Word,
    /// Lanes that have such a stretch; others have no further one.
    pub found: R::Mask,
}

impl<R: Real> Stretch<R> {
    /// Found in no lane.
    #[inline(always)]
    pub fn none() -> Self {
        Self {
            interval: Interval {
                t0: R::zero(),
                t1: R::zero(),
            },
            medium: R::Word::splat(0),
            found: R::Mask::splat(false),
        }
    }

    /// `if_true` where the mask holds, else `if_false`.
    #[inline(always)]
    pub fn select(mask: R::Mask, if_true: &Self, if_false: &Self) -> Self {
        let real = |a, b| R::select(mask, a, b);
        Self {
            interval: Interval {
                t0: real(if_true.interval.t0, if_false.interval.t0),
                t1: real(if_true.interval.t1, if_false.interval.t1),
            },
            medium: R::Word::select(mask, if_true.medium, if_false.medium),
            found: (if_true.found & mask) | if_false.found.and_not(mask),
        }
    }
}

/// Which stretches of a ray lie in media.
pub trait Geometry<R: Real>: core::fmt::Debug {
    /// Stretches may overlap or come out of order, so that the nearest collision of all must be
    /// found; otherwise the first collision ends the flight.
    fn overlaps(&self) -> bool;

    /// No ray has more than one stretch: once it has passed that one, nobody needs to ask for another.
    fn is_single(&self) -> bool {
        false
    }

    /// The stretch number `cursor` (from zero) of each active lane's ray. Other lanes: anything.
    fn stretch(&self, ray: &Ray<R>, cursor: R::Word, active: R::Mask) -> Stretch<R>;
}

/// One medium in one convex shape: at most one stretch a ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Convex {
    /// All of space.
    Everywhere,
    /// The box [0, `size`] in the space that `to_local` maps the world to.
    Box {
        /// World to the box's space.
        to_local: Affine,
        /// The far corner; the near one is the origin.
        size: [f32; 3],
    },
    /// The unit sphere about the origin of the space that `to_local` maps the world to.
    Sphere {
        /// World to the sphere's space.
        to_local: Affine,
    },
}

impl Convex {
    /// The part of a ray inside.
    #[inline(always)]
    pub fn clip<R: Real>(&self, ray: &Ray<R>) -> Interval<R> {
        let local = |rows: &Affine| transform_ray(rows.map(|row| row.map(R::splat)), ray);
        match self {
            Self::Everywhere => Interval {
                t0: R::zero(),
                t1: R::splat(FAR),
            },
            Self::Box { to_local, size } => {
                let ray = local(to_local);
                clip_to_box(ray.origin, ray.direction, Vec3::splat(*size))
            }
            Self::Sphere { to_local } => {
                let ray = local(to_local);
                clip_to_unit_sphere(ray.origin, ray.direction)
            }
        }
    }
}

impl<R: Real> Geometry<R> for Convex {
    #[inline(always)]
    fn overlaps(&self) -> bool {
        false
    }

    #[inline(always)]
    fn is_single(&self) -> bool {
        true
    }

    #[inline(always)]
    fn stretch(&self, ray: &Ray<R>, cursor: R::Word, active: R::Mask) -> Stretch<R> {
        let first = cursor.eq(R::Word::splat(0)) & active;
        let interval = if first.any() {
            self.clip(ray)
        } else {
            Interval {
                t0: R::zero(),
                t1: R::zero(),
            }
        };
        let found = interval.t0.lt(interval.t1) & first;
        Stretch {
            interval,
            medium: R::Word::splat(0),
            found,
        }
    }
}
