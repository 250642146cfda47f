//! `woodcock info` of an OpenEXR image: windows, channels with their ranges, attributes.

use super::args::InfoArgs;
use super::failure::Failure;
use crate::image::exr::{read_image, sample_types};
use crate::image::{AttributeValue, Image};
use serde_json::{Map, Value, json};
use std::collections::BTreeMap;
use std::fmt::Write;
use std::fs::File;
use std::io::BufReader;

/// Version of the JSON that `info --json` prints.
const FORMAT_VERSION: u32 = 1;

/// Memory for an image if no limit is given: 16 channels of 8192 × 8192, twice.
const DEFAULT_MAX_MEMORY: u64 = 8 << 30;

/// What an image file holds.
///
/// Usage error if grids, points or rays are asked of it, which an image does not have.
pub fn image(args: &InfoArgs) -> Result<String, Failure> {
    if args.grid.is_some() || !args.at.is_empty() || !args.ray.is_empty() {
        return Err(Failure::Usage(
            "--grid, --at and --ray ask about volumes, not images".to_owned(),
        ));
    }
    let path = args.file.display();
    let fail = |error: &dyn std::fmt::Display| Failure::message(format!("{path}: {error}"));
    let open = || File::open(&args.file).map_err(|e| fail(&e));
    let types = sample_types(BufReader::new(open()?)).map_err(|e| fail(&e))?;
    let limit = args.max_memory.unwrap_or(DEFAULT_MAX_MEMORY);
    let image = read_image(BufReader::new(open()?), limit).map_err(|e| fail(&e))?;
    Ok(if args.json {
        format!("{:#}\n", as_json(&image, &types))
    } else {
        as_text(&image, &types)
    })
}

/// Least, mean and greatest finite value, and how many values are not finite.
struct Range {
    min: f64,
    mean: f64,
    max: f64,
    nonfinite: usize,
}

impl Range {
    /// NaN throughout if no value is finite.
    fn of(values: &[f32]) -> Self {
        let finite = || {
            values
                .iter()
                .filter(|v| v.is_finite())
                .map(|&v| f64::from(v))
        };
        let count = finite().count();
        Self {
            min: finite().fold(f64::NAN, f64::min),
            mean: finite().sum::<f64>() / count as f64,
            max: finite().fold(f64::NAN, f64::max),
            nonfinite: values.len() - count,
        }
    }
}

fn as_text(image: &Image, types: &BTreeMap<String, &'static str>) -> String {
    let mut text = String::new();
    let [width, height] = image.resolution;
    let w = image.window;
    // Writing to a string cannot fail.
    let _ = writeln!(
        text,
        "picture {width} x {height}, pixels x {}..{}, y {}..{}",
        w.x0, w.x1, w.y0, w.y1
    );
    for channel in &image.channels {
        let range = Range::of(&channel.values);
        let kind = types.get(&channel.name).copied().unwrap_or("?");
        let _ = write!(
            text,
            "channel {:12} {kind:5}  min {:<12.6e} mean {:<12.6e} max {:<12.6e}",
            channel.name, range.min, range.mean, range.max
        );
        if range.nonfinite > 0 {
            let _ = write!(text, "  {} not finite", range.nonfinite);
        }
        text.push('\n');
    }
    for (name, value) in &image.attributes {
        let _ = match value {
            AttributeValue::Int(value) => writeln!(text, "{name} = {value}"),
            AttributeValue::Float(value) => writeln!(text, "{name} = {value}"),
            AttributeValue::Text(value) => writeln!(text, "{name} = {value}"),
        };
    }
    text
}

fn as_json(image: &Image, types: &BTreeMap<String, &'static str>) -> Value {
    let channels = image.channels.iter().map(|channel| {
        let range = Range::of(&channel.values);
        json!({
            "name": channel.name,
            "type": types.get(&channel.name),
            "min": number(range.min),
            "mean": number(range.mean),
            "max": number(range.max),
            "nonfinite": range.nonfinite,
        })
    });
    let attributes = image.attributes.iter().map(|(name, value)| {
        let value = match value {
            AttributeValue::Int(value) => json!(value),
            AttributeValue::Float(value) => number(f64::from(*value)),
            AttributeValue::Text(value) => json!(value),
        };
        (name.clone(), value)
    });
    let w = image.window;
    json!({
        "format_version": FORMAT_VERSION,
        "image": {
            "width": image.resolution[0],
            "height": image.resolution[1],
            "window": [w.x0, w.y0, w.x1, w.y1],
            "channels": channels.collect::<Vec<_>>(),
            "attributes": attributes.collect::<Map<_, _>>(),
        },
    })
}

/// A JSON number, or the strings nan, inf, -inf.
fn number(x: f64) -> Value {
    if x.is_nan() {
        json!("nan")
    } else if x.is_infinite() {
        json!(if x > 0.0 { "inf" } else { "-inf" })
    } else {
        json!(x)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::Window;
    use crate::image::Channel;

    #[test]
    fn an_image_is_described() {
        let mut image = Image::new(
            [4, 2],
            Window {
                x0: 1,
                y0: 0,
                x1: 3,
                y1: 2,
            },
        );
        let values = vec![1.0, f32::NAN, 3.0, f32::INFINITY];
        image.channels.push(Channel {
            name: "R".to_owned(),
            values,
        });
        image.channels.push(Channel {
            name: "Z".to_owned(),
            values: vec![f32::NAN; 4],
        });
        image.set("samplesPerPixel", AttributeValue::Int(7));
        let types = BTreeMap::from([("R".to_owned(), "float")]);
        let json = as_json(&image, &types);
        let channel = &json["image"]["channels"][0];
        assert_eq!(channel["min"], 1.0);
        assert_eq!(channel["mean"], 2.0);
        assert_eq!(channel["max"], 3.0);
        assert_eq!(channel["nonfinite"], 2);
        assert_eq!(json["image"]["channels"][1]["mean"], "nan");
        assert_eq!(json["image"]["window"], json!([1, 0, 3, 2]));
        assert_eq!(json["image"]["attributes"]["samplesPerPixel"], 7);
        let text = as_text(&image, &types);
        assert!(
            text.contains("picture 4 x 2, pixels x 1..3, y 0..2\n"),
            "{text}"
        );
        assert!(
            text.contains("2 not finite") && text.contains("samplesPerPixel = 7"),
            "{text}"
        );
    }
}
