//! Pictures to look at: tone-mapped 8-bit sRGB.
//!
//! ```text
//! f(x) = x                                  x ≤ ½       (below middle tones nothing is touched)
//! f(x) = ½ + ½ t / (1 + t),  t = 2x − 1     x > ½       (continuous slope; x → ∞ tends to white)
//! ```
//!
//! Each channel of the linear radiance passes `f` and then the exact sRGB transfer function (IEC 61966-2-1), rounded to the
//! nearest of 256 levels; no dithering, so the same image gives the same file. Channels are treated apart, so saturated
//! highlights fade to white as film does. The tone curve suits the eye and is no part of the estimate: measure on the EXR.

use super::Image;
use std::io::Write;

/// Why a picture could not be written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PngError {
    /// The encoder or the file below failed.
    #[error(transparent)]
    Encoding(#[from] png::EncodingError),
    /// There is no picture to show.
    #[error("cannot be written as PNG: {0}")]
    Unwritable(&'static str),
}

/// Writes the channels `R G B` of the window, over black, times `exposure` (1 for the radiance as it is).
pub fn write(image: &Image, exposure: f32, to: impl Write) -> Result<(), PngError> {
    let (Some(r), Some(g), Some(b)) = (image.channel("R"), image.channel("G"), image.channel("B"))
    else {
        return Err(PngError::Unwritable("it lacks the channels R, G, B"));
    };
    if image.window.is_empty() {
        return Err(PngError::Unwritable("it has no pixels"));
    }
    let pixels = r.iter().zip(g).zip(b);
    let bytes: Vec<u8> = pixels
        .flat_map(|((r, g), b)| [r, g, b].map(|x| level(x * exposure)))
        .collect();
    let [width, height] = image.window.size();
    let mut encoder = png::Encoder::new(to, width, height);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
    encoder.add_text_chunk(
        "Software".to_owned(),
        concat!("woodcock ", env!("CARGO_PKG_VERSION")).to_owned(),
    )?;
    let mut writer = encoder.write_header()?;
    writer.write_image_data(&bytes)?;
    writer.finish()?;
    Ok(())
}

/// The 8-bit level of a linear value: tone curve, transfer function, rounding. NaN and negative values are black.
pub fn level(x: f32) -> u8 {
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
    use crate::film::Window;
    use crate::image::Channel;
    use std::io::Cursor;

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

    #[test]
    fn a_picture_has_the_size_of_the_window() {
        let window = Window {
            x0: 1,
            y0: 2,
            x1: 4,
            y1: 4,
        };
        let mut image = Image::new([10, 10], window);
        assert!(matches!(
            write(&image, 1.0, Vec::new()),
            Err(PngError::Unwritable(_))
        ));
        for (name, value) in [("R", 0.0), ("G", 0.25), ("B", 1.0e9)] {
            image.channels.push(Channel {
                name: name.to_owned(),
                values: vec![value; 6],
            });
        }
        let mut file = Vec::new();
        write(&image, 2.0, &mut file).expect("written to memory");
        let mut reader = png::Decoder::new(Cursor::new(&file))
            .read_info()
            .expect("a PNG");
        let mut pixels = vec![0; reader.output_buffer_size().expect("small")];
        let info = reader.next_frame(&mut pixels).expect("a frame");
        assert_eq!((info.width, info.height), (3, 2));
        assert_eq!(pixels[..6], [0, 188, 255, 0, 188, 255]);
    }
}
