//! OpenEXR files: `f32` channels in one part, ZIP in blocks of 16 scan lines.
//!
//! Layers are dotted channel names in a single part (`Variance.R`), because some viewers show the first part only.
//! The crop window is the data window, the whole picture the display window; the chromaticities are those of Rec. 709.
//! Pixel bits depend on the image alone; the order of attributes in the file may differ between runs.

use super::part::read_part;
use super::{AttributeValue, Image};
use crate::film::Window;
use exr::meta::MetaData;
use exr::meta::attribute::{AttributeValue as ExrValue, Chromaticities, SampleType};
use exr::meta::header::{ImageAttributes, LayerAttributes};
use exr::prelude::{
    AnyChannel, AnyChannels, Blocks, Compression, Encoding, FlatSamples, IntegerBounds, Layer,
    LineOrder, Text, Vec2, WritableImage,
};
use std::collections::BTreeMap;
use std::io::{Read, Seek, Write};

/// Why an image could not be written or read.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ExrError {
    /// Reading or writing failed below.
    #[error(transparent)]
    Io(#[from] std::io::Error),
    /// Not an OpenEXR file, damaged, or of a kind that cannot be read here (deep data).
    #[error("not a readable OpenEXR image: {0}")]
    Invalid(String),
    /// The pixels would not fit the limit.
    #[error("the image needs {needed} bytes of memory, more than the limit of {limit}")]
    TooLarge {
        /// Bytes of all channels as `f32`.
        needed: u64,
        /// The limit given.
        limit: u64,
    },
    /// An image that OpenEXR cannot express.
    #[error("cannot be written as OpenEXR: {0}")]
    Unwritable(String),
}

impl From<exr::error::Error> for ExrError {
    fn from(error: exr::error::Error) -> Self {
        match error {
            exr::error::Error::Io(error) => Self::Io(error),
            other => Self::Invalid(other.to_string()),
        }
    }
}

/// Primaries and white point D65 of Rec. 709 (ITU-R BT.709-6, items 1.3 and 1.4), CIE xy.
pub(super) const REC_709: Chromaticities = Chromaticities {
    red: Vec2(0.640, 0.330),
    green: Vec2(0.300, 0.600),
    blue: Vec2(0.150, 0.060),
    white: Vec2(0.3127, 0.3290),
};

/// Writes an image.
///
/// Errors: [`ExrError::Unwritable`] for an empty window, no or duplicate channels, a channel of the wrong length, a
/// resolution beyond 2³¹, or text outside ISO 8859-1; [`ExrError::Io`] from the file.
pub fn write(image: &Image, to: impl Write + Seek) -> Result<(), ExrError> {
    check(image)?;
    let window = image.window;
    let [width, height] = window.size().map(|size| size as usize);
    let channels = image.channels.iter().map(|channel| {
        let samples = FlatSamples::F32(channel.values.clone());
        Ok(AnyChannel::new(text(&channel.name)?, samples))
    });
    let channels = channels.collect::<Result<_, ExrError>>()?;
    let mut attributes = LayerAttributes {
        layer_position: Vec2(window.x0 as i32, window.y0 as i32),
        ..LayerAttributes::default()
    };
    for (name, value) in &image.attributes {
        let value = match value {
            AttributeValue::Int(value) => ExrValue::I32(*value),
            AttributeValue::Float(value) => ExrValue::F32(*value),
            AttributeValue::Text(value) => ExrValue::Text(text(value)?),
        };
        attributes.other.insert(text(name)?, value);
    }
    attributes.comments = Some(text(
        "linear Rec. 709 radiance; Variance.* is that of the pixel mean",
    )?);
    let encoding = Encoding {
        compression: Compression::ZIP16,
        blocks: Blocks::ScanLines,
        line_order: LineOrder::Increasing,
    };
    let layer = Layer::new(
        Vec2(width, height),
        attributes,
        encoding,
        AnyChannels::sort(channels),
    );
    let mut file = exr::image::Image::from_layer(layer);
    let [width, height] = image.resolution.map(|size| size as usize);
    file.attributes = ImageAttributes::new(IntegerBounds::new((0, 0), (width, height)));
    file.attributes.chromaticities = Some(REC_709);
    file.write().to_buffered(to)?;
    Ok(())
}

/// What the format, or the crate below, would refuse less clearly.
fn check(image: &Image) -> Result<(), ExrError> {
    let refuse = |why: String| Err(ExrError::Unwritable(why));
    if image.window.is_empty() || image.channels.is_empty() {
        return refuse("the image has no pixels".to_owned());
    }
    if image
        .resolution
        .iter()
        .any(|&size| i32::try_from(size).is_err())
    {
        return refuse("the resolution exceeds 2^31 - 1".to_owned());
    }
    let mut names: Vec<&str> = image.channels.iter().map(|c| c.name.as_str()).collect();
    names.sort_unstable();
    if let Some(pair) = names.windows(2).find(|pair| pair[0] == pair[1]) {
        return refuse(format!("two channels are called {}", pair[0]));
    }
    let pixels = image.window.pixels();
    match image
        .channels
        .iter()
        .find(|c| c.values.len() as u64 != pixels)
    {
        Some(c) => refuse(format!("channel {} does not fill the window", c.name)),
        None => Ok(()),
    }
}

fn text(text: &str) -> Result<Text, ExrError> {
    Text::new_or_none(text)
        .ok_or_else(|| ExrError::Unwritable(format!("{text:?} is not ISO 8859-1 text")))
}

/// Reads a flat image of one part: all channels as `f32` (half is exact, 32-bit integers are rounded), and the attributes of
/// a type that [`AttributeValue`] has.
///
/// Memory is checked against `max_memory` bytes before pixels are read. Errors: [`ExrError`]; the bytes may be anything.
/// A data window that does not start at or after the display window's corner cannot be placed and is an error.
pub fn read_image(from: impl Read + Seek, max_memory: u64) -> Result<Image, ExrError> {
    let part = read_part(from, max_memory)?;
    let (resolution, window) = windows(part.display_window, part.data_window)?;
    Ok(Image {
        resolution,
        window,
        channels: part.channels,
        attributes: part.attributes,
    })
}

/// Display and data window as the resolution and the window within it.
fn windows(display: IntegerBounds, data: IntegerBounds) -> Result<([u32; 2], Window), ExrError> {
    let outside = || ExrError::Invalid("its data window leaves its display window".to_owned());
    let size = |size: usize| u32::try_from(size).map_err(|_| outside());
    let resolution = [size(display.size.width())?, size(display.size.height())?];
    let edge = |a: i32, b: i32| u32::try_from(i64::from(a) - i64::from(b)).map_err(|_| outside());
    let x0 = edge(data.position.x(), display.position.x())?;
    let y0 = edge(data.position.y(), display.position.y())?;
    let far = |near: u32, extent: usize, limit: u32| {
        let end = size(extent)?.checked_add(near).ok_or_else(outside)?;
        if end <= limit {
            Ok(end)
        } else {
            Err(outside())
        }
    };
    let x1 = far(x0, data.size.width(), resolution[0])?;
    let y1 = far(y0, data.size.height(), resolution[1])?;
    Ok((resolution, Window { x0, y0, x1, y1 }))
}

/// How a channel is stored, for reports.
pub fn sample_types(from: impl Read) -> Result<BTreeMap<String, &'static str>, ExrError> {
    let meta = MetaData::read_from_buffered(from, false)?;
    let channels = meta.headers.iter().flat_map(|header| &header.channels.list);
    let named = channels.map(|channel| {
        let kind = match channel.sample_type {
            SampleType::F16 => "half",
            SampleType::F32 => "float",
            SampleType::U32 => "uint",
        };
        (channel.name.to_string(), kind)
    });
    Ok(named.collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::Channel;
    use std::io::Cursor;

    fn image() -> Image {
        let window = Window {
            x0: 3,
            y0: 5,
            x1: 40,
            y1: 38,
        };
        let mut image = Image::new([64, 48], window);
        for (k, name) in ["R", "G", "B", "A", "Variance.R", "Albedo.G", "N.X", "Z"]
            .iter()
            .enumerate()
        {
            let values =
                (0..window.pixels()).map(|i| (i as f32 + 0.1) * 10.0_f32.powi(3 * k as i32 - 12));
            image.channels.push(Channel {
                name: (*name).to_owned(),
                values: values.collect(),
            });
        }
        image.channels[0].values[0] = f32::from_bits(1); // subnormals survive
        image.set("samplesPerPixel", AttributeValue::Int(64));
        image.set("renderTimeSeconds", AttributeValue::Float(1.5));
        image.set("woodcock.seed", AttributeValue::Text(u64::MAX.to_string()));
        image
    }

    fn bytes(image: &Image) -> Vec<u8> {
        let mut file = Cursor::new(Vec::new());
        write(image, &mut file).expect("written to memory");
        file.into_inner()
    }

    #[test]
    fn a_round_trip_keeps_every_bit() {
        let mut image = image();
        let back = read_image(Cursor::new(bytes(&image)), 1 << 20).expect("readable");
        image.channels.sort_by(|a, b| a.name.cmp(&b.name));
        assert_eq!(back.channels, image.channels);
        assert_eq!(
            (back.window, back.resolution),
            (image.window, image.resolution)
        );
        for (name, value) in &image.attributes {
            assert_eq!(back.attributes.get(name), Some(value), "{name}");
        }
        let types = sample_types(Cursor::new(bytes(&image))).expect("readable");
        assert!(types.values().all(|&kind| kind == "float"), "{types:?}");
    }

    #[test]
    fn images_that_cannot_be_written_are_refused() {
        let breakages: [fn(&mut Image); 5] = [
            |image| image.channels.clear(),
            |image| image.channels[1].name = "R".to_owned(),
            |image| image.channels[1].values.truncate(7),
            |image| {
                image.window = Window {
                    x0: 3,
                    y0: 5,
                    x1: 3,
                    y1: 5,
                }
            },
            |image| image.set("woodcock.note", AttributeValue::Text("Ж".to_owned())),
        ];
        for (i, breakage) in breakages.iter().enumerate() {
            let mut image = image();
            breakage(&mut image);
            let result = write(&image, Cursor::new(Vec::new()));
            assert!(
                matches!(result, Err(ExrError::Unwritable(_))),
                "{i}: {result:?}"
            );
        }
    }

    #[test]
    fn damaged_and_huge_files_are_errors() {
        let file = bytes(&image());
        let limited = read_image(Cursor::new(&file), 1000);
        assert!(
            matches!(limited, Err(ExrError::TooLarge { .. })),
            "{limited:?}"
        );
        for length in (0..file.len()).step_by(101) {
            let cut = read_image(Cursor::new(&file[..length]), 1 << 20);
            assert!(cut.is_err(), "cut to {length} bytes");
        }
        // Any answer but a panic or an endless allocation will do here.
        for at in (0..file.len()).step_by(37) {
            let mut damaged = file.clone();
            damaged[at] ^= 0x5a;
            let _ = read_image(Cursor::new(damaged), 1 << 20);
        }
    }
}
