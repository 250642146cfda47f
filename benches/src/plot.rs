//! Error against time, as a drawing.

use std::path::Path;

use plotters::prelude::*;

/// A method's errors at growing budgets.
#[derive(Clone, Debug)]
pub struct Curve {
    /// Its name.
    pub name: String,
    /// Seconds and relative error.
    pub points: Vec<(f64, f64)>,
    /// Drawn dashed, as what it is: biased.
    pub biased: bool,
}

/// A panel of curves.
#[derive(Clone, Debug)]
pub struct Panel {
    /// Its title.
    pub title: String,
    /// What is in it.
    pub curves: Vec<Curve>,
}

const WIDTH: u32 = 1200;
const HEIGHT: u32 = 520;
const LEGEND: u32 = 90;

/// Colours that stay apart in print and for most colour-blind eyes.
const COLOURS: [RGBColor; 9] = [
    RGBColor(0, 0, 0),
    RGBColor(230, 159, 0),
    RGBColor(86, 180, 233),
    RGBColor(0, 158, 115),
    RGBColor(213, 94, 0),
    RGBColor(0, 114, 178),
    RGBColor(204, 121, 167),
    RGBColor(148, 103, 40),
    RGBColor(128, 128, 128),
];

fn colour(index: usize) -> RGBColor {
    COLOURS[index % COLOURS.len()]
}

/// The range of some positive numbers, widened to whole decades.
fn decades(values: impl Iterator<Item = f64>) -> std::ops::Range<f64> {
    let (low, high) = values
        .filter(|v| *v > 0.0 && v.is_finite())
        .fold((f64::INFINITY, 0.0_f64), |(a, b), v| (a.min(v), b.max(v)));
    10.0_f64.powf(low.log10().floor())..10.0_f64.powf(high.log10().ceil())
}

/// Draws panels side by side, with one legend below, as SVG.
///
/// # Errors
/// Whatever keeps the file from being written.
pub fn draw(panels: &[Panel], path: &Path) -> Result<(), Box<dyn std::error::Error>> {
    let root = SVGBackend::new(path, (WIDTH, HEIGHT)).into_drawing_area();
    root.fill(&WHITE)?;
    let (upper, lower) = root.split_vertically(HEIGHT - LEGEND);
    let points = || {
        panels
            .iter()
            .flat_map(|p| &p.curves)
            .flat_map(|c| &c.points)
    };
    let times = decades(points().map(|p| p.0));
    let errors = decades(points().map(|p| p.1));
    let areas = upper.split_evenly((1, panels.len().max(1)));
    for (panel, area) in panels.iter().zip(&areas) {
        let mut chart = ChartBuilder::on(area)
            .caption(&panel.title, ("sans-serif", 18))
            .margin(8)
            .x_label_area_size(38)
            .y_label_area_size(60)
            .build_cartesian_2d(times.clone().log_scale(), errors.clone().log_scale())?;
        chart
            .configure_mesh()
            .light_line_style(WHITE)
            .x_desc("seconds")
            .y_desc("relative root mean square error")
            .x_labels(5)
            .label_style(("sans-serif", 12))
            .x_label_formatter(&|x| format!("{x:.0e}"))
            .y_label_formatter(&|y| format!("{y:.0e}"))
            .draw()?;
        for (index, curve) in panel.curves.iter().enumerate() {
            let line = curve.points.iter().copied();
            let style = colour(index).stroke_width(2);
            if curve.biased {
                chart.draw_series(DashedLineSeries::new(line, 5, 4, style))?;
            } else {
                chart.draw_series(LineSeries::new(line, style))?;
            }
        }
    }
    let Some(first) = panels.first() else {
        return Ok(root.present()?);
    };
    let columns = first.curves.len().div_ceil(2).max(1);
    for (index, curve) in first.curves.iter().enumerate() {
        let step = (WIDTH as usize - 40) / columns;
        let (x, y) = (20 + (index % columns) * step, 20 + (index / columns) * 30);
        let (x, y) = (i32::try_from(x)?, i32::try_from(y)?);
        let swatch = [(x, y + 7), (x + 24, y + 7)];
        lower.draw(&PathElement::new(swatch, colour(index).stroke_width(3)))?;
        let text = if curve.biased {
            format!("{}, BIASED", curve.name)
        } else {
            curve.name.clone()
        };
        lower.draw(&Text::new(text, (x + 32, y), ("sans-serif", 14)))?;
    }
    root.present()?;
    Ok(())
}
