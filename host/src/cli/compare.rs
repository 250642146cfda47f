//! `woodcock compare`: do two images show the same?

use std::fmt::Write;
use std::fs::File;
use std::io::BufReader;
use std::path::Path;

use super::args::CompareArgs;
use super::failure::Failure;
use crate::compare::{Comparison, Estimate, compare};
use crate::image::exr::read_image;
use crate::image::{AttributeValue, Image};

/// Memory for both images if no limit is given.
const DEFAULT_MAX_MEMORY: u64 = 8 << 30;

fn read(path: &Path, max_memory: u64) -> Result<Image, Failure> {
    let fail =
        |error: &dyn std::fmt::Display| Failure::message(format!("{}: {error}", path.display()));
    let file = File::open(path).map_err(|e| fail(&e))?;
    read_image(BufReader::new(file), max_memory).map_err(|e| fail(&e))
}

fn text<'a>(image: &'a Image, name: &str) -> Option<&'a str> {
    match image.attributes.get(name)? {
        AttributeValue::Text(text) => Some(text),
        _ => None,
    }
}

/// Compares; `Ok` holds the report, and whether the images differ.
///
/// # Errors
/// Files that cannot be read or compared.
pub(super) fn run(args: &CompareArgs) -> Result<(String, bool), Failure> {
    let limit = args.max_memory.unwrap_or(DEFAULT_MAX_MEMORY) / 2;
    let paths = [args.first.as_path(), args.second.as_path()];
    let images = [read(paths[0], limit)?, read(paths[1], limit)?];
    let estimate = |i: usize| {
        Estimate::of(&images[i])
            .map_err(|e| Failure::message(format!("{}: {e}", paths[i].display())))
    };
    let estimates = [estimate(0)?, estimate(1)?];
    let [a, b] = &estimates;
    let comparison = compare(a, b, args.false_alarms).map_err(Failure::message)?;
    let report = report(paths, &images, &estimates, &comparison, args.false_alarms);
    Ok((report, comparison.differ()))
}

fn report(
    paths: [&Path; 2],
    images: &[Image; 2],
    estimates: &[Estimate; 2],
    found: &Comparison,
    false_alarms: f64,
) -> String {
    let mut out = String::new();
    // Writing to a string cannot fail.
    for (path, image) in paths.iter().zip(images) {
        let word = |name: &str| text(image, name).unwrap_or("unknown");
        let samples = match image.attributes.get("samplesPerPixel") {
            Some(AttributeValue::Int(n)) => format!("{n} samples per pixel"),
            _ => "unknown samples, so the variance counts as exact".to_owned(),
        };
        let _ = writeln!(
            out,
            "{}: {}, {} kernel, {samples}, seed {}",
            path.display(),
            word("woodcock.integrator"),
            word("woodcock.kernel"),
            word("woodcock.seed"),
        );
    }
    let both = |name: &str| [text(&images[0], name), text(&images[1], name)];
    if let [Some(a), Some(b)] = both("woodcock.sceneHash") {
        if a != b {
            let _ = writeln!(out, "note: the images are of different scenes");
        } else if let [Some(a), Some(b)] = both("woodcock.seed")
            && a == b
        {
            let _ = writeln!(
                out,
                "note: one seed, so samples may be shared, and images more alike than chance makes them"
            );
        }
    }
    let [a, b] = estimates.each_ref().map(Estimate::mean);
    let _ = writeln!(out, "\n         {:>12} {:>12} {:>12}", "R", "G", "B");
    for (name, values) in [("mean 1", a), ("mean 2", b)] {
        let [r, g, b] = values;
        let _ = writeln!(out, "{name:<8} {r:>12.6} {g:>12.6} {b:>12.6}");
    }
    let [r, g, b] = found.whole.map(|d| d.z);
    let _ = writeln!(out, "{:<8} {r:>+12.2} {g:>+12.2} {b:>+12.2}", "z");
    let colour = ["R", "G", "B"][found.worst.colour.min(2)];
    let [x, y] = found.worst.at;
    let part = match found.side {
        1 => "pixel".to_owned(),
        side => format!("block of {side} x {side} pixels"),
    };
    let _ = writeln!(
        out,
        "worst {part}: z {:+.2} in {colour} at ({x}, {y})",
        found.worst.z
    );
    let _ = writeln!(
        out,
        "relMSE {:.4e}; noise explains {:.4e}",
        found.relative_mse, found.relative_noise
    );
    let rate = 100.0 * false_alarms;
    if found.side == 1 {
        let _ = writeln!(
            out,
            "pixels share light paths, so they are judged one by one: |z| above {:.2} is significant",
            found.part_limit
        );
    } else {
        let _ = writeln!(
            out,
            "significant is |z| above {:.2} of a whole or {:.2} of a block; a difference of {:.2} % everywhere would be found",
            found.whole_limit,
            found.part_limit,
            100.0 * found.resolution
        );
    }
    let verdict = if found.differ() { "differ" } else { "agree" };
    let _ = writeln!(
        out,
        "the images {verdict} (false alarms: {rate} % of comparisons at most)"
    );
    out
}
