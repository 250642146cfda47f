//! The colour of black bodies over temperature, from a table.
//!
//! Colours are tabulated over √(1/T) and interpolated linearly. At one wavelength Planck's law falls like exp(−a/T), and
//! by its peak like T⁻⁴ where it is hot: spaced so, the relative error from 500 K to 100 000 K stays below 6e-5 even if
//! one table covers all of it, and a table of a fire's temperatures errs by less than 1e-6.

use crate::scene::blackbody_peak_one;

/// At this temperature and below there is no light \[K\].
pub(super) const DARK: f64 = 100.0;
/// Intervals of the table.
const INTERVALS: usize = 16_384;

/// Where a temperature \[K\] lies in tables.
fn place(kelvin: f64) -> f64 {
    (1.0 / kelvin).sqrt()
}

/// Colours between two temperatures.
#[derive(Clone, Debug)]
pub(super) struct BlackBodies {
    /// Of the hottest and of the coldest \[K^−½\].
    near: f64,
    far: f64,
    colours: Vec<[f64; 3]>,
}

impl BlackBodies {
    /// Colours from `coldest` to `hottest` \[K\]; what is at [`DARK`] or colder is black.
    pub(super) fn new(coldest: f64, hottest: f64) -> Self {
        let coldest = coldest.max(DARK);
        let hottest = hottest.max(coldest);
        let (near, far) = (place(hottest), place(coldest));
        let colours = (0..=INTERVALS).map(|i| {
            let s = near + (far - near) * (i as f64 / INTERVALS as f64);
            // No light is negative, though a saturated red's blue may be.
            blackbody_peak_one(1.0 / (s * s)).map(|c| c.max(0.0))
        });
        Self {
            near,
            far,
            colours: colours.collect(),
        }
    }

    /// All colours times a factor, √(1/T) of the first, and how many there are per unit of it.
    pub(super) fn table(&self, scale: f64) -> (Vec<f32>, f32, f32) {
        let scaled = self.colours.iter().flatten().map(|c| (c * scale) as f32);
        let range = self.far - self.near;
        let density = if range > 0.0 {
            INTERVALS as f64 / range
        } else {
            0.0
        };
        (scaled.collect(), self.near as f32, density as f32)
    }

    /// The colour at a temperature \[K\], that of the nearer end beyond the table; of a spectrum that is one at its peak.
    pub(super) fn colour(&self, kelvin: f64) -> [f64; 3] {
        if kelvin.is_nan() || kelvin <= DARK {
            return [0.0; 3];
        }
        let range = self.far - self.near;
        let at = if range > 0.0 {
            (place(kelvin) - self.near) / range * INTERVALS as f64
        } else {
            0.0
        };
        let at = at.clamp(0.0, INTERVALS as f64);
        let i = (at as usize).min(INTERVALS - 1);
        let w = at - i as f64;
        match self.colours.get(i..i + 2) {
            Some([a, b]) => std::array::from_fn(|c| a[c] * (1.0 - w) + b[c] * w),
            _ => [0.0; 3],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_has_the_colours() {
        let ranges = [
            (100.0, 1e5, 6e-5),
            (600.0, 2800.0, 1e-6),
            (1500.0, 1500.0, 1e-14),
        ];
        for (coldest, hottest, bound) in ranges {
            let table = BlackBodies::new(coldest, hottest);
            for i in 0..=97_u32 {
                let kelvin = coldest + (hottest - coldest) * f64::from(i) / 97.0;
                let exact = blackbody_peak_one(kelvin).map(|c| c.max(0.0));
                let largest = exact.into_iter().fold(0.0, f64::max);
                for (found, exact) in table.colour(kelvin).into_iter().zip(exact) {
                    let near = (found - exact).abs() <= bound * largest;
                    assert!(near || kelvin < 500.0, "{kelvin}: {found} {exact}");
                }
            }
        }
    }

    #[test]
    fn the_cold_is_dark() {
        let table = BlackBodies::new(0.0, 3000.0);
        for kelvin in [f64::NAN, f64::NEG_INFINITY, -5.0, 0.0, DARK] {
            assert_eq!(table.colour(kelvin), [0.0; 3]);
        }
        let [r, g, b] = table.colour(1900.0);
        assert!(r > g && g > b && b >= 0.0);
    }
}
