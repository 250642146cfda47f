//! Pictures written by the crates below, read back, and damaged.

use super::{Picture, read_picture};
use crate::scene::{Encoding, MemoryFiles};
use crate::volume::Limits;
use exr::prelude::{
    AnyChannel, AnyChannels, Blocks, Compression, Encoding as ExrEncoding, FlatSamples, Image,
    Layer, LayerAttributes, LineOrder, Vec2, WritableImage, f16,
};
use png::{BitDepth, ColorType};
use std::io::Cursor;
use std::path::Path;

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

fn exr_of(channels: Vec<(&str, FlatSamples)>, compression: Compression, blocks: Blocks) -> Vec<u8> {
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
    // IEC 61966-2-1 at 10 (the linear toe: 10 / 255 / 12.92) and at 128.
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
