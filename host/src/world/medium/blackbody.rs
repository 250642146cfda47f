//! The colour of black bodies over temperature, from a table.
//!
//! Colours are tabulated over s = 1/T and interpolated linearly: at one wavelength Planck's law falls like exp(−as), so
//! the relative error is (a h)²/8 for a spacing h, the same at all temperatures. Over 100 K to 100 000 K it stays below
//! 6e-5 at 380 nm, and below 2e-5 where a black body of visible light is brightest.

use crate::scene::blackbody_peak_one;

/// At this temperature and below there is no light \[K\].
pub(super) const DARK: f64 = 100.0;
/// Intervals of the table.
const INTERVALS: usize = 16_384;

/// Colours between two temperatures.
#[derive(Clone, Debug)]
pub(super) struct BlackBodies {
    /// Of the hottest and of the coldest \[1/K\].
    near: f64,
    far: f64,
    colours: Vec<[f64; 3]>,
}

impl BlackBodies {
    /// Colours from `coldest` to `hottest` \[K\]; what is at [`DARK`] or colder is black.
    pub(super) fn new(coldest: f64, hottest: f64) -> Self {
        let coldest = coldest.max(DARK);
        let hottest = hottest.max(coldest);
        let (near, far) = (1.0 / hottest, 1.0 / coldest);
        let colours = (0..=INTERVALS).map(|i| {
            let s = near + (far - near) * (i as f64 / INTERVALS as f64);
            // No light is negative, though a saturated red's blue may be.
            blackbody_peak_one(1.0 / s).map(|c| c.max(0.0))
        });
        Self {
            near,
            far,
            colours: colours.collect(),
        }
    }

    /// The colour at a temperature \[K\], that of the nearer end beyond the table; of a spectrum that is one at its peak.
    pub(super) fn colour(&self, kelvin: f64) -> [f64; 3] {
        // Not `kelvin <= DARK`: a NaN is dark.
        if !(kelvin > DARK) {
            return [0.0; 3];
        }
        let range = self.far - self.near;
        let at = if range > 0.0 {
            (1.0 / kelvin - self.near) / range * INTERVALS as f64
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
        for (coldest, hottest) in [(100.0, 1e5), (600.0, 2800.0), (1500.0, 1500.0)] {
            let table = BlackBodies::new(coldest, hottest);
            for i in 0..=97_u32 {
                let kelvin = coldest + (hottest - coldest) * f64::from(i) / 97.0;
                let exact = blackbody_peak_one(kelvin).map(|c| c.max(0.0));
                let largest = exact.into_iter().fold(0.0, f64::max);
                for (found, exact) in table.colour(kelvin).into_iter().zip(exact) {
                    let near = (found - exact).abs() <= 1e-4 * largest;
                    assert!(near || kelvin <= DARK, "{kelvin}: {found} {exact}");
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
