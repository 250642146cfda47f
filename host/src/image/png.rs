//! Pictures to look at: tone-mapped 8-bit sRGB.

use super::Image;
use super::tone::level;
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::Window;
    use crate::image::Channel;
    use std::io::Cursor;

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
