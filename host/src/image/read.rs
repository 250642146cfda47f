//! Pictures read back: for textures and environments.
//!
//! The first bytes of a file tell its kind, not its name. Alpha is ignored, and so are a PNG's gAMA, cHRM and iCCP.

use std::io::Cursor;
use std::path::Path;

use png::{BitDepth, ColorType, Transformations};

use super::{Channel, part};
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
    let part = part::read_part(Cursor::new(bytes), limits.max_memory)
        .map_err(|error| error.to_string())?;
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
