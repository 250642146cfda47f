//! What `woodcock info` says about a grid in Mitsuba's format.

use super::{InfoOptions, line, number};
use crate::volume::vol::{Encoding, VolGrid};
use serde_json::{Value, json};

/// One number a channel, or the only one.
fn by_channel(grid: &VolGrid, of: impl Fn(usize) -> f64) -> Value {
    match grid.channels {
        1 => number(of(0)),
        channels => (0..channels).map(|n| number(of(n))).collect(),
    }
}

fn at(grid: &VolGrid, point: [f64; 3]) -> Value {
    by_channel(grid, |n| grid.trilinear(n, point))
}

fn ray(grid: &VolGrid, [x0, y0, z0, x1, y1, z1]: [f64; 6]) -> Value {
    by_channel(grid, |n| grid.line_integral(n, [x0, y0, z0], [x1, y1, z1]))
}

/// Least, greatest and sum by channel.
fn statistics(grid: &VolGrid) -> [Value; 3] {
    let statistics: Vec<_> = (0..grid.channels).map(|n| grid.statistics(n)).collect();
    let of = |pick: fn(&(f32, f32, f64)) -> f64| {
        by_channel(grid, |n| statistics.get(n).map_or(f64::NAN, pick))
    };
    [of(|s| f64::from(s.0)), of(|s| f64::from(s.1)), of(|s| s.2)]
}

pub(super) fn json(grid: &VolGrid, options: &InfoOptions) -> Value {
    let [min, max, sum] = statistics(grid);
    let voxels: u64 = grid.size.iter().map(|n| *n as u64).product();
    // A voxel's centre lies half a cell from its index.
    let row = |axis: usize| {
        let scale = 1.0 / grid.size[axis] as f64;
        let mut row = [0.0; 4];
        (row[axis], row[3]) = (scale, 0.5 * scale);
        row
    };
    json!({
        "format": "Mitsuba",
        "format_version": 3,
        "metadata": {},
        "grids": [{
            "name": "",
            "type": grid.encoding.name(),
            "class": "unknown",
            "half": grid.encoding == Encoding::Float16,
            "readable": true,
            "size": grid.size,
            "channels": grid.channels,
            "file_bounds": grid.bounds,
            "transform_type": "unit cube",
            "index_to_world": [row(0), row(1), row(2), [0.0, 0.0, 0.0, 1.0]],
            "metadata": {},
            "background": by_channel(grid, |_| 0.0),
            "active_voxels": voxels,
            "active_tiles": 0,
            "leaf_nodes": 0,
            "active_bbox": [[0, 0, 0], grid.size.map(|n| n - 1)],
            "min_active": min,
            "max_active": max,
            "sum_active": sum,
            "at": options.at.iter().map(|p| at(grid, *p)).collect::<Value>(),
            "ray": options.rays.iter().map(|r| ray(grid, *r)).collect::<Value>(),
        }],
    })
}

pub(super) fn text(grid: &VolGrid, options: &InfoOptions) -> String {
    let mut text = "Mitsuba volume, format version 3\n\n".to_owned();
    let [min, max, sum] = statistics(grid);
    let [x, y, z] = grid.size;
    let [low, high] = grid.bounds;
    line(&mut text, "type", grid.encoding.name());
    line(
        &mut text,
        "size",
        format!("{x}x{y}x{z}, {} channel(s)", grid.channels),
    );
    line(&mut text, "box in the file", format!("{low:?} to {high:?}"));
    line(&mut text, "world", "the unit cube");
    line(&mut text, "range", format!("{min} to {max}"));
    line(&mut text, "sum", sum);
    for point in &options.at {
        line(&mut text, "at", format!("{point:?}: {}", at(grid, *point)));
    }
    for segment in &options.rays {
        line(
            &mut text,
            "ray",
            format!("{segment:?}: {}", ray(grid, *segment)),
        );
    }
    text
}
