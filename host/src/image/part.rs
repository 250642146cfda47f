//! OpenEXR files read: whatever the bytes are, an error is the worst they can do.

use super::exr::{ExrError, REC_709};
use super::{AttributeValue, Channel};
use exr::block::reader::ChunksReader;
use exr::block::{self, UncompressedBlock};
use exr::meta::attribute::{AttributeValue as ExrValue, Chromaticities, SampleType};
use exr::meta::header::Header;
use exr::prelude::{IntegerBounds, Vec2, f16};
use std::collections::{BTreeMap, BTreeSet};
use std::io::{Read, Seek};
use std::panic::{self, AssertUnwindSafe};

/// The only part of a file, wherever its windows lie.
pub(super) struct Part {
    /// The whole picture.
    pub(super) display_window: IntegerBounds,
    /// What the channels fill.
    pub(super) data_window: IntegerBounds,
    /// CIE xy of what R, G and B mean, if the file says so.
    chromaticities: Option<Chromaticities>,
    /// Sorted by name.
    pub(super) channels: Vec<Channel>,
    pub(super) attributes: BTreeMap<String, AttributeValue>,
}

impl Part {
    /// Width and height of the data window.
    pub(super) fn size(&self) -> [usize; 2] {
        let Vec2(width, height) = self.data_window.size;
        [width, height]
    }

    /// Whether R, G and B are those of Rec. 709, as they are where a file is silent; to 0.005, which lets rounded
    /// coordinates pass and no other standard.
    pub(super) fn is_rec_709(&self) -> bool {
        let near = |a: Vec2<f32>, b: Vec2<f32>| {
            (a.x() - b.x()).abs() <= 0.005 && (a.y() - b.y()).abs() <= 0.005
        };
        self.chromaticities.is_none_or(|c| {
            near(c.red, REC_709.red)
                && near(c.green, REC_709.green)
                && near(c.blue, REC_709.blue)
                && near(c.white, REC_709.white)
        })
    }
}

/// Reads a flat file of one part; memory is checked against `max_memory` bytes before pixels are read.
pub(super) fn read_part(from: impl Read + Seek, max_memory: u64) -> Result<Part, ExrError> {
    // The decoder below checks most of what a damaged file may say, but asserts some of it.
    let decoded = panic::catch_unwind(AssertUnwindSafe(|| decode_part(from, max_memory)));
    decoded.unwrap_or_else(|_| Err(ExrError::Invalid("it is damaged".to_owned())))
}

fn decode_part(from: impl Read + Seek, max_memory: u64) -> Result<Part, ExrError> {
    let reader = block::read(from, false)?;
    let [header] = reader.headers() else {
        let parts = reader.headers().len();
        return Err(ExrError::Invalid(format!("it has {parts} parts, not one")));
    };
    if header.deep {
        return Err(ExrError::Invalid("it has deep data".to_owned()));
    }
    let size = header.layer_size;
    let pixels = (size.width() as u64).saturating_mul(size.height() as u64);
    let needed = pixels.saturating_mul(4 * header.channels.list.len() as u64);
    // What calls this may hold a copy beside ours.
    if needed.saturating_mul(2) > max_memory {
        return Err(ExrError::TooLarge {
            needed: needed.saturating_mul(2),
            limit: max_memory,
        });
    }
    if let Some(channel) = header
        .channels
        .list
        .iter()
        .find(|c| c.sampling != Vec2(1, 1))
    {
        return Err(ExrError::Invalid(format!(
            "channel {} is subsampled",
            channel.name
        )));
    }
    let header = header.clone();
    let mut channels: Vec<Channel> = header
        .channels
        .list
        .iter()
        .map(|channel| Channel {
            name: channel.name.to_string(),
            values: vec![0.0; size.area()],
        })
        .collect();
    // Of several resolutions the largest. Blocks lie on a lattice: those of different corners do not overlap.
    let mut corners = BTreeSet::new();
    let mut left = size.area();
    let mut chunks = reader.filter_chunks(false, |_, tile, _| tile.level_index == Vec2(0, 0))?;
    while let Some(chunk) = chunks.read_next_chunk() {
        let block = UncompressedBlock::decompress_chunk(chunk?, chunks.meta_data(), false)?;
        let Vec2(x, y) = block.index.pixel_position;
        if !corners.insert((y, x)) {
            return Err(ExrError::Invalid("it has a block twice".to_owned()));
        }
        left = left.saturating_sub(place_block(&block, &header, &mut channels)?);
    }
    if left > 0 {
        return Err(ExrError::Invalid(format!("{left} pixels are missing")));
    }
    let others = header.own_attributes.other.iter();
    let mut attributes = BTreeMap::new();
    for (name, value) in others.chain(&header.shared_attributes.other) {
        let value = match value {
            ExrValue::I32(value) => AttributeValue::Int(*value),
            ExrValue::F32(value) => AttributeValue::Float(*value),
            ExrValue::Text(value) => AttributeValue::Text(value.to_string()),
            _ => continue,
        };
        attributes.insert(name.to_string(), value);
    }
    Ok(Part {
        display_window: header.shared_attributes.display_window,
        data_window: header.data_window(),
        chromaticities: header.shared_attributes.chromaticities,
        channels,
        attributes,
    })
}

/// Copies a block to where it belongs; returns how many pixels it has.
fn place_block(
    block: &UncompressedBlock,
    header: &Header,
    channels: &mut [Channel],
) -> Result<usize, ExrError> {
    let Vec2(width, height) = header.layer_size;
    let Vec2(x, y) = block.index.pixel_position;
    let Vec2(columns, rows) = block.index.pixel_size;
    let ends = |start: usize, length: usize, end: usize| {
        start.checked_add(length).is_some_and(|last| last <= end)
    };
    if block.index.level != Vec2(0, 0) || !ends(x, columns, width) || !ends(y, rows, height) {
        return Err(ExrError::Invalid("a block is out of place".to_owned()));
    }
    let mut bytes = block.data.as_slice();
    for row in y..y + rows {
        for (channel, description) in channels.iter_mut().zip(&header.channels.list) {
            let kind = description.sample_type;
            let line = bytes
                .split_off(..columns * kind.bytes_per_sample())
                .ok_or_else(|| ExrError::Invalid("a block is too short".to_owned()))?;
            let start = row * width + x;
            let values = &mut channel.values[start..start + columns];
            for (value, sample) in values
                .iter_mut()
                .zip(line.chunks_exact(kind.bytes_per_sample()))
            {
                *value = match (kind, sample) {
                    (SampleType::F16, &[a, b]) => f16::from_ne_bytes([a, b]).to_f32(),
                    (SampleType::F32, &[a, b, c, d]) => f32::from_ne_bytes([a, b, c, d]),
                    (SampleType::U32, &[a, b, c, d]) => u32::from_ne_bytes([a, b, c, d]) as f32,
                    _ => return Err(ExrError::Invalid("a sample is cut".to_owned())),
                };
            }
        }
    }
    Ok(columns * rows)
}
