//! How linear light is shown in 256 levels.
//!
//! ```text
//! f(x) = x                                  x ≤ ½       (below middle tones nothing is touched)
//! f(x) = ½ + ½ t / (1 + t),  t = 2x − 1     x > ½       (continuous slope; x → ∞ tends to white)
//! ```
//!
//! Each channel of the linear radiance passes `f` and then the exact sRGB transfer function (IEC 61966-2-1), rounded to the
//! nearest of 256 levels; no dithering, so the same image gives the same file. Channels are treated apart, so saturated
//! highlights fade to white as film does. The tone curve suits the eye and is no part of the estimate: measure on the EXR.

/// The 8-bit level of a linear value: tone curve, transfer function, rounding. NaN and negative values are black.
pub(crate) fn level(x: f32) -> u8 {
    let v = transfer(tone(f64::from(x)));
    (v * 255.0).round() as u8 // `as` saturates and takes NaN to 0
}

/// The tone curve: [0, ∞) to [0, 1).
fn tone(x: f64) -> f64 {
    if x <= 0.5 {
        return x;
    }
    // t / (1 + t) = 1 − 1 / (2x), which does not overflow.
    0.5 + 0.5 * (1.0 - 0.5 / x)
}

/// The sRGB opto-electronic transfer function.
fn transfer(x: f64) -> f64 {
    if x <= 0.003_130_8 {
        12.92 * x
    } else {
        1.055 * x.powf(1.0 / 2.4) - 0.055
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn levels_at_known_points() {
        assert_eq!(level(0.0), 0);
        assert_eq!(level(-1.0), 0);
        assert_eq!(level(f32::NAN), 0);
        assert_eq!(level(0.18), 118); // grey card: 0.4614 · 255 = 117.6
        assert_eq!(level(0.5), 188); // where the shoulder begins
        assert_eq!(level(f32::INFINITY), 255);
        assert_eq!(level(f32::MAX), 255);
        assert_eq!(level(0.003), 10); // the linear toe: 12.92 · 0.003 · 255 = 9.9
    }

    #[test]
    fn the_tone_curve_is_monotone_smooth_and_bounded() {
        let h = 1.0e-6;
        let slope = (tone(0.5 + h) - tone(0.5)) / h;
        assert!((slope - 1.0).abs() < 1e-5, "{slope}");
        let mut last = -1.0;
        for i in 0..10_000 {
            let y = tone(f64::from(i) * 0.01);
            assert!(y > last && y < 1.0);
            last = y;
        }
    }
}
