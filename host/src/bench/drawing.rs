//! Error against time as SVG: a panel for each scene, a line for each method.

use plotters::prelude::*;

use super::{Interval, Stage, Summary};
use crate::bench::summary::Verdict;

const WIDTH: u32 = 860;
const PANEL: u32 = 440;
/// Of the legend below a panel: one line of it.
const LINE: u32 = 24;

/// Colours that stay apart in print and for most colour-blind eyes.
const COLOURS: [RGBColor; 8] = [
    RGBColor(0, 0, 0),
    RGBColor(230, 159, 0),
    RGBColor(86, 180, 233),
    RGBColor(0, 158, 115),
    RGBColor(213, 94, 0),
    RGBColor(0, 114, 178),
    RGBColor(204, 121, 167),
    RGBColor(128, 128, 128),
];

type Failure = Box<dyn std::error::Error>;

/// The range of positive numbers, with some air.
fn range(values: impl Iterator<Item = f64>) -> std::ops::Range<f64> {
    let (low, high) = values
        .filter(|v| *v > 0.0 && v.is_finite())
        .fold((f64::INFINITY, 0.0_f64), |(a, b), v| (a.min(v), b.max(v)));
    if low <= high {
        low / 1.5..high * 1.5
    } else {
        0.1..1.0
    }
}

/// The points of a method's line: mean seconds, mean relMSE and its interval.
fn line(method: &super::Method) -> Vec<(f64, Interval)> {
    let mut points = Vec::new();
    for budget in method.budgets() {
        let errors: Vec<f64> = method
            .at(budget)
            .map(|run| run.judgement.relative)
            .collect();
        let seconds: Vec<f64> = method.at(budget).map(|run| run.seconds).collect();
        let seconds = seconds.iter().sum::<f64>() / seconds.len().max(1) as f64;
        if let Some(error) = Interval::of_mean(&errors).filter(|e| e.value > 0.0) {
            points.push((seconds, error));
        }
    }
    points
}

/// Draws the panels, one above the other.
///
/// # Errors
/// Whatever the drawing library says.
pub fn draw(stages: &[Stage]) -> Result<String, Failure> {
    let heights: Vec<u32> = stages
        .iter()
        .map(|stage| PANEL + 12 + LINE * (stage.methods.len() as u32 + 1))
        .collect();
    let mut svg = String::new();
    {
        let height = heights.iter().sum::<u32>().max(1);
        let root = SVGBackend::with_string(&mut svg, (WIDTH, height)).into_drawing_area();
        root.fill(&WHITE)?;
        let mut rest = root.clone();
        for (stage, height) in stages.iter().zip(&heights) {
            let (panel, below) = rest.split_vertically(*height);
            draw_stage(stage, &panel)?;
            rest = below;
        }
        root.present()?;
    }
    Ok(svg)
}

fn draw_stage<B: DrawingBackend>(
    stage: &Stage,
    area: &DrawingArea<B, plotters::coord::Shift>,
) -> Result<(), Failure>
where
    B::ErrorType: 'static,
{
    let (upper, lower) = area.split_vertically(PANEL);
    let lines: Vec<_> = stage.methods.iter().map(line).collect();
    let runs = || stage.methods.iter().flat_map(|method| &method.runs);
    let times = range(runs().map(|run| run.seconds));
    let errors = range(runs().map(|run| run.judgement.relative));
    let mut chart = ChartBuilder::on(&upper)
        .caption(&stage.name, ("sans-serif", 18))
        .margin(8)
        .x_label_area_size(40)
        .y_label_area_size(70)
        .build_cartesian_2d(times.clone().log_scale(), errors.clone().log_scale())?;
    chart
        .configure_mesh()
        .light_line_style(WHITE)
        .x_labels(6)
        .x_desc("CPU seconds")
        .y_desc("relMSE")
        .label_style(("sans-serif", 12))
        .x_label_formatter(&|x| format!("{x:.3}"))
        .y_label_formatter(&|y| format!("{y:.0e}"))
        .draw()?;
    // The slope of no bias, through the middle.
    let (t, e) = (
        (times.start * times.end).sqrt(),
        (errors.start * errors.end).sqrt(),
    );
    let reach = (times.end / t).min(errors.end / e);
    let guide = [(t / reach, e * reach), (t * reach, e / reach)];
    let grey = RGBColor(200, 200, 200);
    chart.draw_series(LineSeries::new(guide, grey.stroke_width(1)))?;
    for (index, (method, points)) in stage.methods.iter().zip(&lines).enumerate() {
        let colour = COLOURS[index % COLOURS.len()];
        for run in &method.runs {
            let at = (run.seconds, run.judgement.relative);
            if at.0 > 0.0 && at.1 > 0.0 {
                chart
                    .plotting_area()
                    .draw(&Circle::new(at, 1, colour.filled()))?;
            }
        }
        for (seconds, error) in points.iter().filter(|p| p.1.radius.is_finite()) {
            let low = (error.value - error.radius).max(errors.start);
            let high = (error.value + error.radius).min(errors.end);
            let bar = [(*seconds, low), (*seconds, high)];
            chart.draw_series(LineSeries::new(bar, colour.stroke_width(1)))?;
        }
        let line = points
            .iter()
            .map(|(seconds, error)| (*seconds, error.value));
        chart.draw_series(LineSeries::new(line, colour.stroke_width(2)))?;
    }
    for (index, method) in stage.methods.iter().enumerate() {
        let colour = COLOURS[index % COLOURS.len()];
        let y = 6 + LINE as i32 * index as i32;
        let swatch = [(24, y + 7), (48, y + 7)];
        lower.draw(&PathElement::new(swatch, colour.stroke_width(3)))?;
        let words = legend(&method.name, method.summary());
        lower.draw(&Text::new(words, (56, y), ("sans-serif", 14)))?;
    }
    let y = 6 + LINE as i32 * stage.methods.len() as i32;
    let words = "grey: slope -1, error falls as one over time; bars: 95 % intervals of the means; dots: single runs";
    lower.draw(&Text::new(words, (24, y), ("sans-serif", 12)))?;
    Ok(())
}

fn legend(name: &str, summary: Option<Summary>) -> String {
    match summary {
        Some(s) if s.verdict == Verdict::Floor => {
            format!("{name}: slope {:.2}, a FLOOR: biased?", s.slope.value)
        }
        Some(s) => format!("{name}: {:.3e} s to relMSE 1", s.efficiency.value),
        None => name.to_owned(),
    }
}
