//! Pictures read back: for textures and environments.
//!
//! The first bytes of a file tell its kind, not its name. Alpha is ignored, and so are a PNG's gAMA, cHRM and iCCP.

use std::io::Cursor;
use std::path::Path;

use png::{BitDepth, ColorType, Transformations};

use super::{Channel, exr};
use crate::scene::{Encoding, Files};
use crate::volume::Limits;

/// A picture in memory.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// Pixels from left to right, at least 1.
    pub width: u32,
    /// Pixels from top to bottom, at least 1.
    pub height: u32,
    /// Linear Rec. 709, row by row from the top; finite.
    pub pixels: Vec<[f32; 3]>,
}

/// Reads a picture: .exr (any compression; channels R, G, B, or Y, or a single one) or .png.
///
/// An EXR's picture is its data window. Its channels may stand in a layer (`X.R`), if they stand in one only; beside
/// plain R, G, B or Y, layers are ignored. It is linear Rec. 709: another encoding or other chromaticities are errors.
///
/// * `encoding`: how stored numbers become light; `None` is by kind of file: sRGB for 8-bit PNG, else linear.
///
/// # Errors
/// What is wrong with the file, in a sentence without its name.
pub fn read_picture(
    files: &dyn Files,
    path: &Path,
    encoding: Option<Encoding>,
    limits: &Limits,
) -> Result<Picture, String> {
    let bytes = files
        .read(path)
        .map_err(|error| format!("cannot be read: {error}"))?;
    let picture = if bytes.starts_with(&[0x76, 0x2f, 0x31, 0x01]) {
        read_exr(&bytes, encoding, limits)?
    } else if bytes.starts_with(b"\x89PNG") {
        read_png(&bytes, encoding, limits)?
    } else {
        return Err("is neither OpenEXR nor PNG".into());
    };
    if let Some(at) = picture
        .pixels
        .iter()
        .position(|pixel| pixel.iter().any(|x| !x.is_finite()))
    {
        let [x, y] = [
            at % picture.width as usize,
            at / picture.width as usize, // the width is at least 1 where there are pixels
        ];
        let pixel = picture.pixels[at];
        return Err(format!(
            "has a value that is not finite: pixel ({x}, {y}), counted from the top left, is {pixel:?}"
        ));
    }
    Ok(picture)
}

/// Memory that a picture of this size takes, and what decoding takes beside it, against the limit.
fn check_size(width: u64, height: u64, beside: u64, limits: &Limits) -> Result<(), String> {
    let needed = width
        .saturating_mul(height)
        .saturating_mul(beside.saturating_add(size_of::<[f32; 3]>() as u64));
    if width == 0 || height == 0 {
        return Err("has no pixels".into());
    }
    if needed > limits.max_memory {
        let limit = limits.max_memory;
        return Err(format!(
            "needs {needed} bytes of memory for {width} × {height} pixels, more than the limit of {limit}"
        ));
    }
    Ok(())
}

fn read_exr(bytes: &[u8], encoding: Option<Encoding>, limits: &Limits) -> Result<Picture, String> {
    if !matches!(encoding, None | Some(Encoding::Linear)) {
        return Err("is an OpenEXR picture, which is linear; leave the encoding out".into());
    }
    let part =
        exr::read_part(Cursor::new(bytes), limits.max_memory).map_err(|error| error.to_string())?;
    if !part.is_rec_709() {
        return Err("has other primaries than Rec. 709; convert it first".into());
    }
    let [width, height] = part.size().map(|size| size as u64);
    let held = 4 * part.channels.len() as u64;
    check_size(width, height, held, limits)?;
    let [r, g, b] = colours(&part.channels)?;
    let pixels = r.iter().zip(g).zip(b);
    let pixels: Vec<[f32; 3]> = pixels.map(|((&r, &g), &b)| [r, g, b]).collect();
    if pixels.len() as u64 != width * height {
        return Err("its channels do not fill its data window".into());
    }
    let size = |size: u64| u32::try_from(size).map_err(|_| "is too large".to_owned());
    Ok(Picture {
        width: size(width)?,
        height: size(height)?,
        pixels,
    })
}

/// The values of R, G and B: one channel three times where there is no colour.
fn colours(channels: &[Channel]) -> Result<[&[f32]; 3], String> {
    if let [only] = channels {
        return Ok([&only.values; 3]);
    }
    let within = |layer: &str| {
        let find = |name: &str| {
            let mut all = channels.iter();
            let found = all.find(|c| c.name.strip_prefix(layer) == Some(name))?;
            Some(found.values.as_slice())
        };
        if let (Some(r), Some(g), Some(b)) = (find("R"), find("G"), find("B")) {
            return Some([r, g, b]);
        }
        // Luminance beside RY and BY is half of a colour, not a grey picture.
        if find("RY").is_some() || find("BY").is_some() {
            return None;
        }
        find("Y").map(|y| [y; 3])
    };
    if let Some(plain) = within("") {
        return Ok(plain);
    }
    let mut layers: Vec<&str> = channels
        .iter()
        .filter_map(|c| Some(&c.name[..=c.name.rfind('.')?]))
        .collect();
    layers.sort_unstable();
    layers.dedup();
    if let [layer] = layers.as_slice()
        && let Some(layered) = within(layer)
    {
        return Ok(layered);
    }
    let names: Vec<&str> = channels.iter().map(|c| c.name.as_str()).collect();
    Err(format!(
        "has no channels R, G, B, nor Y, nor a single one, but {}",
        names.join(", ")
    ))
}

fn read_png(bytes: &[u8], encoding: Option<Encoding>, limits: &Limits) -> Result<Picture, String> {
    let damaged = |error: png::DecodingError| format!("not a readable PNG: {error}");
    let memory = usize::try_from(limits.max_memory).unwrap_or(usize::MAX);
    let mut decoder =
        png::Decoder::new_with_limits(Cursor::new(bytes), png::Limits { bytes: memory });
    // Palettes and fewer than eight bits become eight bits.
    decoder.set_transformations(Transformations::EXPAND);
    decoder.set_ignore_text_chunk(true);
    decoder.set_ignore_iccp_chunk(true);
    let header = decoder.read_header_info().map_err(damaged)?;
    let (width, height) = (header.width, header.height);
    // The decoded samples are at most four of two bytes.
    check_size(u64::from(width), u64::from(height), 8, limits)?;
    let mut reader = decoder.read_info().map_err(damaged)?;
    let (color, depth) = reader.output_color_type();
    let length = reader.output_buffer_size().ok_or("is too large")?;
    let mut samples = vec![0; length];
    reader.next_frame(&mut samples).map_err(damaged)?;

    let (bytes_per_sample, levels) = match depth {
        BitDepth::Eight => (1, 1 << 8),
        BitDepth::Sixteen => (2, 1 << 16),
        _ => return Err(format!("has samples of {depth:?} bits")),
    };
    let encoding = encoding.unwrap_or(if bytes_per_sample == 1 {
        Encoding::Srgb
    } else {
        Encoding::Linear
    });
    let last = f64::from(levels - 1);
    let light: Vec<f32> = (0..levels)
        .map(|level| decode(encoding, f64::from(level) / last) as f32)
        .collect();
    let value = |sample: &[u8]| {
        let level = sample.iter().fold(0, |sum, &b| sum << 8 | usize::from(b));
        light[level]
    };
    let channels = color.samples();
    let is_grey = matches!(color, ColorType::Grayscale | ColorType::GrayscaleAlpha);
    let pixels: Vec<[f32; 3]> = samples
        .chunks_exact(channels * bytes_per_sample)
        .map(|pixel| {
            let channel = |i: usize| value(&pixel[i * bytes_per_sample..][..bytes_per_sample]);
            if is_grey {
                [channel(0); 3]
            } else {
                [channel(0), channel(1), channel(2)]
            }
        })
        .collect();
    if pixels.len() as u64 != u64::from(width) * u64::from(height) {
        return Err("its pixels do not fill it".into());
    }
    Ok(Picture {
        width,
        height,
        pixels,
    })
}

/// The light of a stored number in [0, 1].
fn decode(encoding: Encoding, x: f64) -> f64 {
    match encoding {
        Encoding::Linear => x,
        // IEC 61966-2-1, the inverse of what `png` writes.
        Encoding::Srgb if x <= 0.040_45 => x / 12.92,
        Encoding::Srgb => libm::pow((x + 0.055) / 1.055, 2.4),
        Encoding::Gamma(gamma) => libm::pow(x, gamma),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::MemoryFiles;
    use ::exr::prelude::{
        AnyChannel, AnyChannels, Blocks, Compression, Encoding as ExrEncoding, FlatSamples, Image,
        Layer, LayerAttributes, LineOrder, Vec2, WritableImage, f16,
    };

    fn read(bytes: &[u8], encoding: Option<Encoding>, memory: u64) -> Result<Picture, String> {
        let files = MemoryFiles::new().with("x", bytes);
        let limits = Limits { max_memory: memory };
        read_picture(&files, Path::new("x"), encoding, &limits)
    }

    fn readable(bytes: &[u8], encoding: Option<Encoding>) -> Picture {
        read(bytes, encoding, 1 << 20).expect("readable")
    }

    fn png(color: ColorType, depth: BitDepth, data: &[u8], size: [u32; 2]) -> Vec<u8> {
        let mut out = Vec::new();
        let mut encoder = png::Encoder::new(&mut out, size[0], size[1]);
        encoder.set_color(color);
        encoder.set_depth(depth);
        if color == ColorType::Indexed {
            encoder.set_palette(vec![0, 0, 0, 255, 0, 0, 0, 255, 255, 255, 255, 255]);
            encoder.set_trns(vec![0, 128]);
        }
        let mut writer = encoder.write_header().expect("a header");
        writer.write_image_data(data).expect("pixels");
        writer.finish().expect("written to memory");
        out
    }

    const WIDTH: usize = 13;
    const HEIGHT: usize = 37;

    fn exr_of(
        channels: Vec<(&str, FlatSamples)>,
        compression: Compression,
        blocks: Blocks,
    ) -> Vec<u8> {
        let channels = channels
            .into_iter()
            .map(|(name, samples)| AnyChannel::new(name, samples));
        let attributes = LayerAttributes {
            layer_position: Vec2(-5, 7),
            ..LayerAttributes::default()
        };
        let encoding = ExrEncoding {
            compression,
            blocks,
            line_order: LineOrder::Increasing,
        };
        let layer = Layer::new(
            (WIDTH, HEIGHT),
            attributes,
            encoding,
            AnyChannels::sort(channels.collect()),
        );
        let mut out = Cursor::new(Vec::new());
        Image::from_layer(layer)
            .write()
            .non_parallel()
            .to_buffered(&mut out)
            .expect("written to memory");
        out.into_inner()
    }

    fn ramp(offset: usize) -> FlatSamples {
        let values = (0..WIDTH * HEIGHT).map(|i| (i + offset) as f32 * 0.25);
        FlatSamples::F32(values.collect())
    }

    fn halves(offset: usize) -> FlatSamples {
        let values = (0..WIDTH * HEIGHT).map(|i| f16::from_f32((i + offset) as f32 * 0.25));
        FlatSamples::F16(values.collect())
    }

    fn expected() -> Vec<[f32; 3]> {
        (0..WIDTH * HEIGHT)
            .map(|i| [0, 1, 2].map(|k| (i + k) as f32 * 0.25))
            .collect()
    }

    #[test]
    fn an_exr_is_read_under_every_lossless_compression_and_sample_type() {
        use Compression::{PIZ, RLE, Uncompressed, ZIP1, ZIP16};
        let tiles = Blocks::Tiles(Vec2(8, 8));
        for compression in [Uncompressed, RLE, ZIP1, ZIP16, PIZ] {
            for blocks in [Blocks::ScanLines, tiles] {
                let channels = vec![
                    ("R", ramp(0)),
                    ("G", halves(1)),
                    ("B", ramp(2)),
                    ("A", halves(9)),
                ];
                let picture = readable(&exr_of(channels, compression, blocks), None);
                assert_eq!(
                    (picture.width, picture.height),
                    (WIDTH as u32, HEIGHT as u32)
                );
                assert_eq!(picture.pixels, expected(), "{compression:?} {blocks:?}");
            }
        }
        let counts = FlatSamples::U32((0..(WIDTH * HEIGHT) as u32).collect());
        let picture = readable(&exr_of(vec![("Z", counts)], ZIP16, Blocks::ScanLines), None);
        assert_eq!(picture.pixels[40], [40.0; 3]);
    }

    #[test]
    fn channels_are_found_plain_in_one_layer_or_alone() {
        let file = |names: &[&'static str]| {
            let channels = names.iter().enumerate().map(|(i, &name)| (name, ramp(i)));
            exr_of(channels.collect(), Compression::ZIP16, Blocks::ScanLines)
        };
        let first = |names: &[&'static str]| read(&file(names), None, 1 << 20).map(|p| p.pixels[0]);
        let rgb = Ok([0.0, 0.25, 0.5]);
        assert_eq!(first(&["R", "G", "B"]), rgb);
        assert_eq!(first(&["R", "G", "B", "Variance.R", "N.X"]), rgb);
        assert_eq!(first(&["X.R", "X.G", "X.B", "X.A"]), rgb);
        assert_eq!(first(&["a.b.R", "a.b.G", "a.b.B"]), rgb);
        assert_eq!(first(&["Y", "A"]), Ok([0.0; 3]));
        assert_eq!(first(&["A", "Y"]), Ok([0.25; 3]));
        assert_eq!(first(&["depth"]), Ok([0.0; 3]));
        for names in [
            &["X.R", "X.G", "X.B", "Z.R"][..],
            &["Y", "RY", "BY"],
            &["R", "G"],
            &["r", "g", "b"],
        ] {
            let error = first(names).expect_err("refused");
            assert!(error.contains("has no channels"), "{names:?}: {error}");
        }
    }

    #[test]
    fn what_an_exr_cannot_mean_is_refused() {
        let file = exr_of(
            vec![("R", ramp(0)), ("G", ramp(1)), ("B", ramp(2))],
            Compression::ZIP16,
            Blocks::ScanLines,
        );
        assert!(read(&file, Some(Encoding::Linear), 1 << 20).is_ok());
        assert!(read(&file, Some(Encoding::Srgb), 1 << 20).is_err());
        assert!(read(&file, None, 10_000).is_err_and(|e| e.contains("10000")));
        let mut values = vec![1.0; WIDTH * HEIGHT];
        values[3 * WIDTH + 2] = f32::NAN;
        let file = exr_of(
            vec![("Y", FlatSamples::F32(values))],
            Compression::ZIP16,
            Blocks::ScanLines,
        );
        assert!(read(&file, None, 1 << 20).is_err_and(|e| e.contains("(2, 3)")));
        assert!(read(b"P6 1 1 255 ...", None, 1 << 20).is_err());
        assert!(read(b"", None, 1 << 20).is_err());
    }

    #[test]
    fn a_png_is_read_in_every_color_type() {
        // The sRGB transfer function at 0, 10, 128, 255, computed with exact rationals and a 30-digit power.
        let close = |a: [f32; 3], b: [f64; 3]| {
            let near = |i: usize| (f64::from(a[i]) - b[i]).abs() < 1e-7;
            assert!((0..3).all(near), "{a:?} is not {b:?}");
        };
        let (ten, half) = (0.003_035_269_8, 0.215_860_500_1);
        let eight = BitDepth::Eight;
        let grey = readable(
            &png(ColorType::Grayscale, eight, &[0, 10, 128, 255], [2, 2]),
            None,
        );
        close(grey.pixels[1], [ten; 3]);
        close(grey.pixels[2], [half; 3]);
        close(grey.pixels[3], [1.0; 3]);
        let rgb = png(ColorType::Rgb, eight, &[10, 128, 255, 0, 0, 0], [1, 2]);
        close(readable(&rgb, None).pixels[0], [ten, half, 1.0]);
        let alpha = png(ColorType::Rgba, eight, &[10, 128, 255, 0], [1, 1]);
        close(readable(&alpha, None).pixels[0], [ten, half, 1.0]);
        let alpha = png(ColorType::GrayscaleAlpha, eight, &[128, 0], [1, 1]);
        close(readable(&alpha, None).pixels[0], [half; 3]);
        // Four entries of two bits; transparency does not blacken.
        let indexed = png(
            ColorType::Indexed,
            BitDepth::Two,
            &[0b0001_1011, 0b1000_0000],
            [4, 2],
        );
        let picture = readable(&indexed, None);
        close(picture.pixels[1], [1.0, 0.0, 0.0]);
        close(picture.pixels[4], [0.0, 1.0, 1.0]);
        let bits = png(
            ColorType::Grayscale,
            BitDepth::One,
            &[0b0100_0000, 0],
            [2, 2],
        );
        close(readable(&bits, None).pixels[1], [1.0; 3]);
        let deep = png(
            ColorType::Grayscale,
            BitDepth::Sixteen,
            &[0x80, 0x01],
            [1, 1],
        );
        close(readable(&deep, None).pixels[0], [32769.0 / 65535.0; 3]);
        let gamma = readable(&deep, Some(Encoding::Gamma(2.0))).pixels[0];
        close(gamma, [(32769.0_f64 / 65535.0).powi(2); 3]);
        close(
            readable(&rgb, Some(Encoding::Linear)).pixels[0],
            [10.0 / 255.0, 128.0 / 255.0, 1.0],
        );
    }

    #[test]
    fn damaged_files_are_errors_or_pictures_but_never_panics() {
        use Compression::{B44, PIZ, PXR24, RLE, Uncompressed, ZIP16};
        let blocks = [Blocks::ScanLines, Blocks::Tiles(Vec2(8, 8))];
        let mut files = vec![
            png(
                ColorType::Rgb,
                BitDepth::Eight,
                &[77; 3 * 16 * 16],
                [16, 16],
            ),
            png(
                ColorType::Indexed,
                BitDepth::Two,
                &[0b0001_1011; 4 * 16],
                [16, 16],
            ),
        ];
        for compression in [Uncompressed, RLE, ZIP16, PIZ, PXR24, B44] {
            for blocks in blocks {
                let channels = vec![("R", halves(0)), ("G", ramp(1)), ("B", halves(2))];
                files.push(exr_of(channels, compression, blocks));
            }
        }
        for file in files {
            assert!(read(&file, None, 1 << 20).is_ok());
            for length in (0..file.len()).step_by(29) {
                assert!(
                    read(&file[..length], None, 1 << 20).is_err(),
                    "cut to {length} bytes"
                );
            }
            for at in 0..file.len().min(1500) {
                for flip in [0x01, 0x80, 0x5a, 0xff] {
                    let mut damaged = file.clone();
                    damaged[at] ^= flip;
                    if let Ok(picture) = read(&damaged, None, 1 << 20) {
                        let pixels = u64::from(picture.width) * u64::from(picture.height);
                        assert_eq!(picture.pixels.len() as u64, pixels);
                    }
                }
            }
        }
    }
}
