//! The results as one HTML page that needs nothing else, and as a table for the terminal.

use std::fmt::Write;

use super::{Interval, Stage, Summary};

/// What a page says of the run as a whole.
#[derive(Clone, Debug, PartialEq)]
pub struct About {
    /// The command line that made it.
    pub command: String,
    /// Threads that rendered.
    pub threads: usize,
    /// Seeds of each budget.
    pub seeds: u32,
    /// What did not fit the time, and other words of warning.
    pub notes: Vec<String>,
}

const HEAD: [&str; 6] = [
    "method",
    "CPU s × relMSE",
    "of the median block",
    "slope",
    "error",
    "CPU s per spp",
];

/// `0.0123 ± 0.0004`
fn plus_minus(interval: Interval) -> String {
    if interval.radius.is_finite() {
        format!("{:.3e} ± {:.0e}", interval.value, interval.radius)
    } else {
        format!("{:.3e}", interval.value)
    }
}

fn cells(name: &str, summary: Option<Summary>) -> [String; 6] {
    let Some(s) = summary else {
        let none = || "–".to_owned();
        return [name.to_owned(), none(), none(), none(), none(), none()];
    };
    let slope = if s.slope.radius.is_finite() {
        format!("{:.2} ± {:.2}", s.slope.value, s.slope.radius)
    } else {
        "–".to_owned()
    };
    [
        name.to_owned(),
        plus_minus(s.efficiency),
        plus_minus(s.median),
        slope,
        match s.floor {
            Some(floor) => format!("{} at {}", s.verdict.name(), plus_minus(floor)),
            None => s.verdict.name().to_owned(),
        },
        format!("{:.3e}", s.pace),
    ]
}

fn caption(stage: &Stage) -> String {
    let [width, height] = stage.size;
    format!(
        "{}, {width} x {height} pixels; reference: {}, relMSE {:.1e}",
        stage.name, stage.reference, stage.reference_error
    )
}

/// A table of each scene in plain text.
pub fn table(stages: &[Stage], about: &About) -> String {
    let mut text = String::new();
    for stage in stages {
        let mut rows = vec![HEAD.map(str::to_owned)];
        rows.extend(stage.methods.iter().map(|m| cells(&m.name, m.summary())));
        let width = |column: usize| rows.iter().map(|row| row[column].chars().count()).max();
        let widths = [0, 1, 2, 3, 4, 5].map(|column| width(column).unwrap_or(0));
        // Writing to a string cannot fail.
        let _ = writeln!(text, "{}", caption(stage));
        for row in rows {
            let mut line = String::from(" ");
            for (cell, width) in row.iter().zip(widths) {
                let _ = write!(line, " {cell:<width$} ");
            }
            let _ = writeln!(text, "{}", line.trim_end());
        }
        text.push('\n');
    }
    for note in &about.notes {
        let _ = writeln!(text, "note: {note}");
    }
    text
}

fn escape(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
}

const STYLE: &str = "body{font:15px/1.5 sans-serif;max-width:62em;margin:2em auto;padding:0 1em;color:#222;background:#fff}\
table{border-collapse:collapse;margin:.5em 0 1.5em}td,th{padding:.2em .8em;text-align:left;border-bottom:1px solid #ddd}\
td{font-variant-numeric:tabular-nums}svg{max-width:100%;height:auto}code{background:#f3f3f3;padding:.1em .3em}";

const EXPLANATION: &str = "Each point is the mean of several runs with different seeds; methods took turns, so that a busy machine slows all \
alike. relMSE is the mean over pixels and channels of squared error over (reference² + 0.01 · mean²), without the reference's own error. CPU seconds \
are user and system time of all threads without loading. CPU s × relMSE is the time to reach relMSE 1: lower is better; ± are 95 % \
intervals. Without bias the error falls as one over time (slope −1; its root with −½); a bias shows as a floor, which is named where \
it is significant (false alarms: 0.1 %).";

/// The page: table, drawing and all runs, with no reference to anything outside of it.
pub fn html(stages: &[Stage], about: &About, svg: &str, csv: &str) -> String {
    let mut page =
        String::from("<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">");
    page += "<title>woodcock bench: run time against error</title><style>";
    page += STYLE;
    page += "</style></head><body>\n<h1>Run time against error</h1>\n";
    // Writing to a string cannot fail.
    let _ = writeln!(
        page,
        "<p><code>{}</code>: woodcock {}, {} threads, {} seeds.</p>\n<p>{EXPLANATION}</p>",
        escape(&about.command),
        env!("CARGO_PKG_VERSION"),
        about.threads,
        about.seeds,
    );
    for stage in stages {
        let _ = writeln!(page, "<h2>{}</h2>\n<table><tr>", escape(&caption(stage)));
        for head in HEAD {
            let _ = write!(page, "<th>{head}</th>");
        }
        page += "</tr>\n";
        for method in &stage.methods {
            page += "<tr>";
            for cell in cells(&method.name, method.summary()) {
                let _ = write!(page, "<td>{}</td>", escape(&cell));
            }
            page += "</tr>\n";
        }
        page += "</table>\n";
    }
    for note in &about.notes {
        let _ = writeln!(page, "<p>Note: {}</p>", escape(note));
    }
    page += svg;
    let _ = write!(
        page,
        "\n<details><summary>All runs</summary><pre>{}</pre></details>\n</body></html>\n",
        escape(csv)
    );
    page
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bench::{Judgement, Method, Run, csv, drawing};

    fn stages() -> Vec<Stage> {
        let run = |budget: u32, seed: u64| {
            let relative = 0.1 / f64::from(1 << budget) * (1.0 + 0.01 * seed as f64);
            Run {
                budget,
                seed,
                samples: 1 << budget,
                seconds: 0.05 * f64::from(1 << budget),
                judgement: Judgement {
                    mse: relative,
                    relative,
                    median: relative,
                },
            }
        };
        let method = |name: &str| Method {
            name: name.to_owned(),
            runs: (0..18).map(|i| run(i % 6, u64::from(i / 6))).collect(),
        };
        let stage = |name: &str| Stage {
            name: name.to_owned(),
            size: [64, 36],
            reference: "path, 4096 spp".to_owned(),
            reference_error: 1e-6,
            methods: vec![method("path"), method("path,kernel=scalar")],
        };
        vec![stage("cloud <1>"), stage("fog")]
    }

    #[test]
    fn the_page_stands_alone() {
        let stages = stages();
        let about = About {
            command: "woodcock bench a.pbrt".to_owned(),
            threads: 2,
            seeds: 3,
            notes: vec!["a & b".to_owned()],
        };
        let svg = drawing::draw(&stages).expect("a drawing");
        assert!(svg.starts_with("<svg") && svg.trim_end().ends_with("</svg>"));
        let page = html(&stages, &about, &svg, &csv(&stages));
        for word in [
            "cloud &lt;1&gt;",
            "path,kernel=scalar",
            "a &amp; b",
            "5.0",
            "<svg",
        ] {
            assert!(page.contains(word), "no {word}");
        }
        // Nothing is fetched: the only addresses are names of XML's vocabulary.
        let named = page.replace("http://www.w3.org/2000/svg", "");
        for outside in [
            "http:", "https:", "src=", "href=", "@import", "<script", "url(",
        ] {
            assert!(!named.contains(outside), "{outside}");
        }
        let text = table(&stages, &about);
        assert!(
            text.contains("-1.00 ±") && text.contains("as 1/t"),
            "{text}"
        );
        assert_eq!(csv(&stages).lines().count(), 1 + 2 * 2 * 18);
    }
}
