//! Media whose extinction differs between wavelengths: a grey medium, and colours.

use core::fmt;

use crate::majorant::Segment;
use crate::medium::Medium;
use crate::ray::Ray;
use crate::real::Real;
use crate::spectral::Spectrum;
use crate::stream::Stream;
use crate::vec3::Vec3;

/// A medium whose [`Medium::sigma_t`] is the extinction of its most opaque wavelength.
///
/// [`Medium::TIGHT`] must be false, as tentative collisions may be null for some wavelengths even where
/// the bound is reached; flights do not compile otherwise.
pub trait SpectralMedium<R: Real, const N: usize>: Medium<R> {
    /// Extinction at distance `t` relative to the most opaque wavelength, each in [0, 1].
    fn colour(&self, walk: &Self::Walk, t: R) -> Spectrum<R, N>;
}

/// The same colour everywhere in a medium: σ_λ(x) = `colour`_λ σ_t(x).
#[derive(Clone, Copy, Debug)]
pub struct Coloured<M, const N: usize> {
    medium: M,
    colour: [f32; N],
}

/// A colour that is not in [0, 1], or NaN.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ColourError {
    /// The number of its wavelength.
    pub wavelength: usize,
    /// The extinction relative to the most opaque wavelength.
    pub value: f32,
}

impl fmt::Display for ColourError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { wavelength, value } = self;
        write!(
            f,
            "relative extinction {value} of wavelength {wavelength}: it lies in [0, 1]"
        )
    }
}

impl core::error::Error for ColourError {}

impl<M, const N: usize> Coloured<M, N> {
    /// * `medium`: with the extinction of the most opaque wavelength.
    /// * `colour`: extinction relative to it, by wavelength.
    ///
    /// # Errors
    /// A colour outside of [0, 1].
    pub fn new(medium: M, colour: [f32; N]) -> Result<Self, ColourError> {
        for (wavelength, value) in colour.into_iter().enumerate() {
            if !(0.0..=1.0).contains(&value) {
                return Err(ColourError { wavelength, value });
            }
        }
        Ok(Self { medium, colour })
    }
}

impl<R: Real, M: Medium<R>, const N: usize> Medium<R> for Coloured<M, N> {
    type Walk = M::Walk;
    const ONE_SEGMENT: bool = M::ONE_SEGMENT;
    const TIGHT: bool = false;

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
        self.medium.next_segment(walk, active);
    }
    #[inline(always)]
    fn sigma_t(&self, walk: &M::Walk, t: R, rng: &mut impl Stream<R>, active: R::Mask) -> R {
        self.medium.sigma_t(walk, t, rng, active)
    }
}

impl<R: Real, M: Medium<R>, const N: usize> SpectralMedium<R, N> for Coloured<M, N> {
    #[inline(always)]
    fn colour(&self, _: &M::Walk, _: R) -> Spectrum<R, N> {
        Spectrum::splat(self.colour)
    }
}

/// A colour by a function of the place: σ_λ(x) = `colour`_λ(x) σ_t(x).
#[derive(Clone, Copy, Debug)]
pub struct ColouredBy<M, F> {
    medium: M,
    colour: F,
}

impl<M, F> ColouredBy<M, F> {
    /// * `medium`: with the extinction of the most opaque wavelength.
    /// * `colour`: extinction relative to it at a world-space point, per lane, each in [0, 1]; total, as
    ///   finished lanes ask too, anywhere. Colours above one may break the medium's bound.
    pub fn new<R: Real, const N: usize>(medium: M, colour: F) -> Self
    where
        M: Medium<R>,
        F: Fn(Vec3<R>) -> Spectrum<R, N>,
    {
        Self { medium, colour }
    }
}

/// A walk, and the world-space ray that it follows.
#[derive(Clone, Debug)]
pub struct Followed<R, W> {
    walk: W,
    ray: Ray<R>,
}

impl<R: Real, M: Medium<R>, F> Medium<R> for ColouredBy<M, F> {
    type Walk = Followed<R, M::Walk>;
    const ONE_SEGMENT: bool = M::ONE_SEGMENT;
    const TIGHT: bool = false;

    #[inline(always)]
    fn idle(&self) -> Self::Walk {
        let zero = Vec3::uniform(0.0);
        Followed {
            walk: self.medium.idle(),
            ray: Ray {
                origin: zero,
                direction: zero,
            },
        }
    }
    #[inline(always)]
    fn begin(&self, walk: &mut Self::Walk, ray: &Ray<R>, active: R::Mask) {
        self.medium.begin(&mut walk.walk, ray, active);
        walk.ray = Ray::select(active, ray, &walk.ray);
    }
    #[inline(always)]
    fn segment(&self, walk: &Self::Walk) -> Segment<R> {
        self.medium.segment(&walk.walk)
    }
    #[inline(always)]
    fn next_segment(&self, walk: &mut Self::Walk, active: R::Mask) {
        self.medium.next_segment(&mut walk.walk, active);
    }
    #[inline(always)]
    fn sigma_t(&self, walk: &Self::Walk, t: R, rng: &mut impl Stream<R>, active: R::Mask) -> R {
        self.medium.sigma_t(&walk.walk, t, rng, active)
    }
}

impl<R, M, F, const N: usize> SpectralMedium<R, N> for ColouredBy<M, F>
where
    R: Real,
    M: Medium<R>,
    F: Fn(Vec3<R>) -> Spectrum<R, N>,
{
    #[inline(always)]
    fn colour(&self, walk: &Self::Walk, t: R) -> Spectrum<R, N> {
        (self.colour)(walk.ray.at(t))
    }
}
