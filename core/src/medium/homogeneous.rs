//! The same extinction everywhere: its own bound, and every distance in closed form.

use core::fmt;

use crate::majorant::Segment;
use crate::medium::{ClosedForm, Control, Controlled, Medium, PiecewiseConstant};
use crate::ray::{FAR, Ray};
use crate::real::Real;
use crate::stream::Stream;

/// A homogeneous medium that fills space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Homogeneous {
    sigma_t: f32,
}

/// An extinction coefficient that is negative, infinite or NaN.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ExtinctionError(
    /// The coefficient [1/length].
    pub f32,
);

impl fmt::Display for ExtinctionError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "extinction {}: it is finite and not negative", self.0)
    }
}

impl core::error::Error for ExtinctionError {}

impl Homogeneous {
    /// From its extinction coefficient [1/length].
    ///
    /// # Errors
    /// A negative, infinite or NaN coefficient.
    pub fn new(sigma_t: f32) -> Result<Self, ExtinctionError> {
        if sigma_t >= 0.0 && sigma_t.is_finite() {
            Ok(Self { sigma_t })
        } else {
            Err(ExtinctionError(sigma_t))
        }
    }

    /// The extinction coefficient [1/length].
    #[inline(always)]
    pub fn extinction(&self) -> f32 {
        self.sigma_t
    }
}

impl<R: Real> Medium<R> for Homogeneous {
    type Walk = ();
    const ONE_SEGMENT: bool = true;
    const TIGHT: bool = true;

    #[inline(always)]
    fn idle(&self) {}
    #[inline(always)]
    fn begin(&self, _: &mut (), _: &Ray<R>, _: R::Mask) {}
    #[inline(always)]
    fn segment(&self, _: &()) -> Segment<R> {
        Segment {
            majorant: R::splat(self.sigma_t),
            t_exit: R::splat(FAR),
        }
    }
    #[inline(always)]
    fn next_segment(&self, _: &mut (), _: R::Mask) {}
    #[inline(always)]
    fn sigma_t(&self, _: &(), _: R, _: &mut impl Stream<R>, _: R::Mask) -> R {
        R::splat(self.sigma_t)
    }
}

impl<R: Real> PiecewiseConstant<R> for Homogeneous {}

impl<R: Real> Controlled<R> for Homogeneous {
    #[inline(always)]
    fn control(&self, _: &()) -> Control<R> {
        Control {
            minimum: R::splat(self.sigma_t),
            mean: R::splat(self.sigma_t),
        }
    }
}

/// τ = σ_t t: one rounding each way.
impl<R: Real> ClosedForm<R> for Homogeneous {
    #[inline(always)]
    fn optical_depth(&self, _: &Ray<R>, t: R) -> R {
        R::splat(self.sigma_t) * t
    }
    #[inline(always)]
    fn distance(&self, _: &Ray<R>, depth: R) -> R {
        depth / R::splat(self.sigma_t)
    }
}
