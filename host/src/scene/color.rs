//! Spectra to linear Rec. 709.
//!
//! The CIE 1931 colour matching functions at 10 nm, summed by the trapezium rule; what lies outside
//! 380–780 nm is invisible. A projection, not spectral rendering: metamers become equal.

/// Wavelength of the first row \[nm\].
const FIRST: f64 = 380.0;
/// Distance of the rows \[nm\].
const STEP: f64 = 10.0;

/// The CIE 1931 standard observer (x̄, ȳ, z̄), 380 to 780 nm.
#[rustfmt::skip]
const OBSERVER: [[f64; 3]; 41] = [
    [0.0014, 0.0000, 0.0065], [0.0042, 0.0001, 0.0201], [0.0143, 0.0004, 0.0679],
    [0.0435, 0.0012, 0.2074], [0.1344, 0.0040, 0.6456], [0.2839, 0.0116, 1.3856],
    [0.3483, 0.0230, 1.7471], [0.3362, 0.0380, 1.7721], [0.2908, 0.0600, 1.6692],
    [0.1954, 0.0910, 1.2876], [0.0956, 0.1390, 0.8130], [0.0320, 0.2080, 0.4652],
    [0.0049, 0.3230, 0.2720], [0.0093, 0.5030, 0.1582], [0.0633, 0.7100, 0.0782],
    [0.1655, 0.8620, 0.0422], [0.2904, 0.9540, 0.0203], [0.4334, 0.9950, 0.0087],
    [0.5945, 0.9950, 0.0039], [0.7621, 0.9520, 0.0021], [0.9163, 0.8700, 0.0017],
    [1.0263, 0.7570, 0.0011], [1.0622, 0.6310, 0.0008], [1.0026, 0.5030, 0.0003],
    [0.8544, 0.3810, 0.0002], [0.6424, 0.2650, 0.0000], [0.4479, 0.1750, 0.0000],
    [0.2835, 0.1070, 0.0000], [0.1649, 0.0610, 0.0000], [0.0874, 0.0320, 0.0000],
    [0.0468, 0.0170, 0.0000], [0.0227, 0.0082, 0.0000], [0.0114, 0.0041, 0.0000],
    [0.0058, 0.0021, 0.0000], [0.0029, 0.0010, 0.0000], [0.0014, 0.0005, 0.0000],
    [0.0007, 0.0003, 0.0000], [0.0003, 0.0001, 0.0000], [0.0002, 0.0001, 0.0000],
    [0.0001, 0.0000, 0.0000], [0.0000, 0.0000, 0.0000],
];

/// XYZ to linear Rec. 709 (IEC 61966-2-1), white D65.
const XYZ_TO_RGB: [[f64; 3]; 3] = [
    [3.2404542, -1.5371385, -0.4985314],
    [-0.9692660, 1.8760108, 0.0415560],
    [0.0556434, -0.2040259, 1.0572252],
];

/// A piecewise linear spectrum: pairs of wavelength \[nm\] and value, wavelengths increasing, zero
/// beyond the ends as in pbrt.
pub(super) struct Piecewise<'a>(pub(super) &'a [(f64, f64)]);

impl Piecewise<'_> {
    fn value(&self, wavelength: f64) -> f64 {
        let i = self.0.partition_point(|&(at, _)| at <= wavelength);
        match (i.checked_sub(1).and_then(|i| self.0.get(i)), self.0.get(i)) {
            (Some(&(a, v)), Some(&(b, w))) => v + (w - v) * ((wavelength - a) / (b - a)),
            (Some(&(a, v)), None) if a == wavelength => v,
            _ => 0.0,
        }
    }

    /// The one value of a spectrum that is constant over at least 400–700 nm.
    pub(super) fn constant(&self) -> Option<f64> {
        let &(first, value) = self.0.first()?;
        let &(last, _) = self.0.last()?;
        let same = self.0.iter().all(|&(_, v)| v == value);
        (same && first <= 400.0 && last >= 700.0).then_some(value)
    }
}

/// ∫ s(λ) (x̄, ȳ, z̄) dλ.
fn xyz(spectrum: impl Fn(f64) -> f64) -> [f64; 3] {
    let mut sum = [0.0; 3];
    let mut wavelength = FIRST;
    for row in OBSERVER {
        let value = spectrum(wavelength) * STEP;
        for (sum, weight) in sum.iter_mut().zip(row) {
            *sum += weight * value;
        }
        wavelength += STEP;
    }
    sum
}

fn rgb(xyz: [f64; 3]) -> [f64; 3] {
    XYZ_TO_RGB.map(|row| row[0] * xyz[0] + row[1] * xyz[1] + row[2] * xyz[2])
}

/// A coefficient, such as an absorption spectrum: each channel is the mean weighted by the channel's
/// own response, so that constants are grey *exactly*. Saturated spectra may give negative channels.
pub(super) fn coefficient(spectrum: &Piecewise<'_>) -> [f64; 3] {
    if let Some(value) = spectrum.constant() {
        return [value; 3];
    }
    let value = rgb(xyz(|wavelength| spectrum.value(wavelength)));
    let unit = rgb(xyz(|_| 1.0));
    [0, 1, 2].map(|i| value[i] / unit[i])
}

/// The colour of light of this spectrum at luminance 1, as pbrt normalises emission: the level of the
/// values does not count, `scale` does. `None` for darkness. Channels may be negative.
///
/// Rec. 709 white is D65, so light of equal energy at all wavelengths is slightly pink, here as in pbrt.
pub(super) fn light(spectrum: &Piecewise<'_>) -> Option<[f64; 3]> {
    normalised(xyz(|wavelength| spectrum.value(wavelength)))
}

/// Planck's law without its constant factor, of a wavelength \[nm\] and a temperature \[kelvin\].
fn planck(wavelength: f64, temperature: f64) -> f64 {
    // h c / k in nm K.
    const SECOND_RADIATION: f64 = 1.438_776_877e7;
    let micrometres = wavelength * 1e-3;
    let exponent = SECOND_RADIATION / (wavelength * temperature);
    1.0 / (micrometres * micrometres * micrometres * micrometres * micrometres)
        / libm::expm1(exponent)
}

/// The colour of a black body at luminance 1. `None` when it is too cold to be seen.
///
/// `temperature`: \[kelvin\], positive.
pub(super) fn blackbody(temperature: f64) -> Option<[f64; 3]> {
    normalised(xyz(|wavelength| planck(wavelength, temperature)))
}

/// The colour of a black body whose spectrum is one at its peak, as pbrt has it in media: linear Rec. 709, channels
/// that would be negative being zero. The level is that of pbrt's sensor, which shows a spectrum of one everywhere at luminance 1.
///
/// `kelvin`: the temperature; what is not positive and finite, or too cold to be seen, is black.
pub fn blackbody_peak_one(kelvin: f64) -> [f64; 3] {
    // Wien's displacement, in nm K.
    const DISPLACEMENT: f64 = 2.897_771_955e6;
    if !(kelvin > 0.0 && kelvin.is_finite()) {
        return [0.0; 3];
    }
    let peak = planck(DISPLACEMENT / kelvin, kelvin);
    let sums = xyz(|wavelength| planck(wavelength, kelvin) / peak);
    let [_, white, _] = xyz(|_| 1.0);
    let colour = rgb(sums.map(|c| c / white));
    if colour.iter().all(|c| c.is_finite()) {
        colour.map(|c| c.max(0.0))
    } else {
        [0.0; 3]
    }
}

fn normalised(xyz: [f64; 3]) -> Option<[f64; 3]> {
    let colour = rgb(xyz.map(|c| c / xyz[1]));
    colour.iter().all(|c| c.is_finite()).then_some(colour)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_has_the_published_sums() {
        let sums = xyz(|_| 1.0);
        for sum in sums {
            assert!((sum - 106.86).abs() < 0.1, "{sums:?}");
        }
    }

    #[test]
    fn constant_coefficients_are_exactly_grey() {
        let pairs = [(200.0, 0.3), (900.0, 0.3)];
        assert_eq!(coefficient(&Piecewise(&pairs)), [0.3; 3]);
        let split = [
            (300.0, 0.3),
            (500.0, 0.3),
            (500.0001, 0.3),
            (800.0, 0.300_001),
        ];
        for channel in coefficient(&Piecewise(&split)) {
            assert!((channel - 0.3).abs() < 1e-5);
        }
    }

    #[test]
    fn a_black_body_of_6504_kelvin_is_nearly_white() {
        // CIE xy (0.3135, 0.3237) against D65's (0.3127, 0.3290).
        let [r, g, b] = blackbody(6504.0).expect("visible");
        assert!((r - 1.03).abs() < 0.03 && (g - 0.98).abs() < 0.03 && (b - 1.04).abs() < 0.06);
        let [r, g, b] = blackbody(2700.0).expect("visible");
        assert!(r > g && g > b);
        assert!(blackbody(1.0).is_none());
    }

    #[test]
    fn black_bodies_at_their_peak() {
        for kelvin in [800.0, 1500.0, 3000.0, 6504.0, 20_000.0] {
            let colour = blackbody_peak_one(kelvin);
            let peak = 2.897_771_955e6 / kelvin;
            // The same law in another form: B(x) / B(x_peak), with x = h c / (wavelength k T).
            let [x, y, z] = xyz(|wavelength| {
                let ratio = peak / wavelength;
                ratio.powi(5) * 4.965_114_231_744_276_f64.exp_m1()
                    / (4.965_114_231_744_276 * ratio).exp_m1()
            });
            let white = xyz(|_| 1.0)[1];
            for (c, row) in colour.iter().zip(XYZ_TO_RGB) {
                let expected = (row[0] * x + row[1] * y + row[2] * z) / white;
                let error = (c - expected.max(0.0)).abs();
                assert!(error <= 1e-7 * y / white, "{kelvin}: {c} {expected}");
            }
            // Both scalings have the same hue.
            let hue = blackbody(kelvin).expect("visible");
            let luminance = y / white;
            for (c, h) in colour.iter().zip(hue) {
                assert!((c - h.max(0.0) * luminance).abs() <= 1e-7 * luminance);
            }
        }
        for black in [0.0, -5.0, f64::NAN, f64::INFINITY, 1e-70, 1e300, 1.0] {
            assert_eq!(blackbody_peak_one(black), [0.0; 3], "{black}");
        }
    }

    #[test]
    fn red_light_is_red() {
        let pairs = [(600.0, 0.0), (620.0, 2.0), (640.0, 0.0)];
        let [r, g, b] = light(&Piecewise(&pairs)).expect("visible");
        assert!(r > 1.0 && g < 0.1 && b < 0.1);
        assert!(light(&Piecewise(&[(900.0, 1.0), (950.0, 1.0)])).is_none());
        assert_eq!(Piecewise(&pairs).value(610.0), 1.0);
        assert_eq!(Piecewise(&pairs).value(599.0), 0.0);
        assert_eq!(Piecewise(&pairs).value(641.0), 0.0);
    }
}
