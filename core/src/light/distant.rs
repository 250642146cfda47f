//! A light at infinity in one direction: the sun without its disc.

use core::fmt;

/// Parallel light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Distant {
    direction: [f32; 3],
    radiance: [f32; 3],
}

/// A direction that is no direction, or a radiance that is none.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DistantError;

impl fmt::Display for DistantError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a distant light needs a direction other than zero and a finite radiance that is not negative")
    }
}

impl core::error::Error for DistantError {}

impl Distant {
    /// * `towards`: direction to the light, of any length but zero.
    /// * `radiance`: the irradiance on a surface that faces the light [W/m²], by colour.
    ///
    /// # Errors
    /// A direction or radiance out of its domain.
    pub fn new(towards: [f32; 3], radiance: [f32; 3]) -> Result<Self, DistantError> {
        let [x, y, z] = towards.map(f64::from);
        let length = libm::sqrt(x * x + y * y + z * z);
        let lit = radiance.iter().all(|r| *r >= 0.0 && r.is_finite());
        if !(length > 0.0 && length.is_finite() && lit) {
            return Err(DistantError);
        }
        let direction = [x, y, z].map(|c| (c / length) as f32);
        Ok(Self {
            direction,
            radiance,
        })
    }

    /// Unit direction towards the light.
    #[inline(always)]
    pub fn direction(&self) -> [f32; 3] {
        self.direction
    }

    /// Irradiance on a surface that faces the light [W/m²].
    #[inline(always)]
    pub fn radiance(&self) -> [f32; 3] {
        self.radiance
    }
}
