//! Numbers by wavelength.

use core::ops::Mul;

use crate::real::{Mask, Real, Word};
use crate::vec3::Vec3;

/// One number for each of N wavelengths, per lane: weights, colours, probabilities.
///
/// Which wavelengths these are is the caller's affair: the three colours of a display, or N samples of
/// the visible range. Operations run from the first wavelength to the last, so that three of them give
/// the bits of a [`Vec3`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spectrum<R, const N: usize>(
    /// By wavelength.
    pub [R; N],
);

impl<R: Real, const N: usize> Spectrum<R, N> {
    /// The same numbers in every lane.
    #[inline(always)]
    pub fn splat(values: [f32; N]) -> Self {
        Self(values.map(R::splat))
    }
    /// The same number at every wavelength of every lane.
    #[inline(always)]
    pub fn uniform(value: f32) -> Self {
        Self([R::splat(value); N])
    }
    /// `f` of every wavelength's number.
    #[inline(always)]
    pub fn map(self, f: impl Fn(R) -> R) -> Self {
        Self(self.0.map(f))
    }
    /// `f` of every pair of numbers at one wavelength.
    #[inline(always)]
    pub fn zip(mut self, other: Self, f: impl Fn(R, R) -> R) -> Self {
        for (a, b) in self.0.iter_mut().zip(other.0) {
            *a = f(*a, b);
        }
        self
    }
    /// Product, wavelength by wavelength.
    #[inline(always)]
    pub fn times(self, other: Self) -> Self {
        self.zip(other, |a, b| a * b)
    }
    /// Sum over the wavelengths; zero of none.
    #[inline(always)]
    pub fn sum(self) -> R {
        let sum = self.0.into_iter().reduce(|a, b| a + b);
        sum.unwrap_or_else(R::zero)
    }
    /// Lanes that are zero at every wavelength.
    #[inline(always)]
    pub fn is_zero(self) -> R::Mask {
        self.0
            .into_iter()
            .fold(R::Mask::splat(true), |zero, value| {
                zero & value.eq(R::zero())
            })
    }
    /// The number of each lane's own wavelength; zero beyond the last.
    #[inline(always)]
    pub fn at(self, wavelength: R::Word) -> R {
        let mut found = R::zero();
        for (number, value) in (0_u32..).zip(self.0) {
            found = R::select(wavelength.eq(R::Word::splat(number)), value, found);
        }
        found
    }
    /// `if_true` where the mask holds, else `if_false`.
    #[inline(always)]
    pub fn select(mask: R::Mask, if_true: Self, if_false: Self) -> Self {
        if_true.zip(if_false, |a, b| R::select(mask, a, b))
    }
    /// The numbers of one lane.
    #[inline(always)]
    pub fn lane(self, lane: usize) -> [f32; N] {
        self.0.map(|value| value.lane(lane))
    }
}

impl<R: Real, const N: usize> Mul<R> for Spectrum<R, N> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, factor: R) -> Self {
        self.map(|value| value * factor)
    }
}

impl<R: Real> From<Vec3<R>> for Spectrum<R, 3> {
    #[inline(always)]
    fn from(colour: Vec3<R>) -> Self {
        Self([colour.x, colour.y, colour.z])
    }
}

impl<R: Real> From<Spectrum<R, 3>> for Vec3<R> {
    #[inline(always)]
    fn from(Spectrum([x, y, z]): Spectrum<R, 3>) -> Self {
        Self::new(x, y, z)
    }
}
