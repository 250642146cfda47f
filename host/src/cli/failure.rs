//! What went wrong, for the person at the terminal or the script at the pipe.

use crate::output::OutputError;
use miette::{Diagnostic, LabeledSpan, Report, SourceCode};
use std::fmt::Write;
use std::io::{self, IsTerminal};
use std::process::ExitCode;

/// Exit code of scene and file errors.
pub const EXIT_FAILURE: u8 = 1;
/// Exit code of usage errors, also clap's.
pub const EXIT_USAGE: u8 = 2;
/// Exit code of a render that stopped before what was asked, with a valid partial image.
pub const EXIT_PARTIAL: u8 = 3;

/// Why a command failed.
#[derive(Debug)]
pub enum Failure {
    /// The arguments make no sense together, or with the scene: exit code 2.
    Usage(String),
    /// The scene, a file or the rendering: exit code 1.
    Error(Report),
}

impl<E: Diagnostic + Send + Sync + 'static> From<E> for Failure {
    fn from(error: E) -> Self {
        Self::Error(Report::new(error))
    }
}

impl Failure {
    /// An error that is only a sentence.
    pub fn message(text: impl std::fmt::Display) -> Self {
        Self::Error(Report::msg(text.to_string()))
    }

    /// A diagnostic behind a pointer.
    pub fn boxed(error: Box<dyn Diagnostic + Send + Sync + 'static>) -> Self {
        Self::Error(Report::new_boxed(error))
    }

    /// An output that cannot be written.
    pub fn output(error: OutputError) -> Self {
        match error {
            OutputError::Extension(_) | OutputError::Duplicate(_) => Self::Usage(error.to_string()),
            _ => Self::message(error),
        }
    }

    /// Prints the failure to standard error and gives the exit code.
    ///
    /// A terminal gets miette's drawing, anything else plain lines that begin with `error:`.
    pub fn exit(&self) -> ExitCode {
        match self {
            Self::Usage(message) => {
                eprintln!("error: {message}");
                ExitCode::from(EXIT_USAGE)
            }
            Self::Error(report) => {
                if io::stderr().is_terminal() {
                    eprintln!("{report:?}");
                } else {
                    eprint!("{}", plain(report.as_ref()));
                }
                ExitCode::from(EXIT_FAILURE)
            }
        }
    }
}

/// Prints a warning that a scene or file gave, in the style of errors.
pub fn warn(warning: &dyn Diagnostic) {
    let mut text = String::new();
    describe(&mut text, "warning", warning);
    eprint!("{text}");
}

/// A diagnostic without colour or drawing:
///
/// ```text
/// error: unknown medium type "foam"
///   --> scene.pbrt:3:31
///  3 | MakeNamedMedium "m" "string type" "foam"
///    |                                   ^^^^^^ here
///   help: supported are …
/// ```
pub fn plain(error: &dyn Diagnostic) -> String {
    let mut text = String::new();
    describe(&mut text, "error", error);
    text
}

fn describe(text: &mut String, severity: &str, error: &dyn Diagnostic) {
    // Writing to a string cannot fail.
    let _ = writeln!(text, "{severity}: {error}");
    if let Some(source) = error.source_code() {
        for label in error.labels().into_iter().flatten() {
            let _ = place(text, source, &label);
        }
    }
    let mut cause = error.source();
    while let Some(inner) = cause {
        let _ = writeln!(text, "  caused by: {inner}");
        cause = inner.source();
    }
    if let Some(help) = error.help() {
        let _ = writeln!(text, "  help: {help}");
    }
    for related in error.related().into_iter().flatten() {
        let source = related.source_code().or(error.source_code());
        let _ = writeln!(text, "{severity}: {related}");
        if let Some(source) = source {
            for label in related.labels().into_iter().flatten() {
                let _ = place(text, source, &label);
            }
        }
    }
}

/// Where a label points: file, line and column from 1, the line, carets. `None` if it points nowhere.
fn place(text: &mut String, source: &dyn SourceCode, label: &LabeledSpan) -> Option<()> {
    let contents = source.read_span(label.inner(), 1, 1).ok()?;
    let data = contents.data();
    let start = label.offset().checked_sub(contents.span().offset())?;
    let before = data.get(..start)?;
    let newline = |byte: &u8| *byte == b'\n';
    let line_start = before.iter().rposition(newline).map_or(0, |at| at + 1);
    let line_end = data[start..].iter().position(newline);
    let line_end = line_end.map_or(data.len(), |length| start + length);
    let number = contents.line() + before.iter().filter(|byte| newline(byte)).count() + 1;
    let lead = String::from_utf8_lossy(&data[line_start..start]);
    let marked = start + label.len().min(line_end - start);
    let width = String::from_utf8_lossy(&data[start..marked])
        .chars()
        .count();
    let line = String::from_utf8_lossy(&data[line_start..line_end]);
    let name = contents.name().unwrap_or("<scene>");
    let column = lead.chars().count() + 1;
    let gutter = number.to_string();
    let blank = " ".repeat(gutter.len());
    // Tabs keep the caret under its word.
    let indent: String = lead
        .chars()
        .map(|c| if c == '\t' { c } else { ' ' })
        .collect();
    let carets = "^".repeat(width.max(1));
    let note = label.label().unwrap_or_default();
    let _ = writeln!(text, "  --> {name}:{number}:{column}");
    let _ = writeln!(text, " {gutter} | {}", line.trim_end());
    let _ = writeln!(
        text,
        " {blank} | {}",
        format!("{indent}{carets} {note}").trim_end()
    );
    Some(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use miette::{NamedSource, miette};

    #[test]
    fn plain_errors_name_the_place() {
        let scene = "# café\nWorldBegin\n\tMakeNamedMedium \"m\" \"string type\" \"foam\"\nmore\n";
        let at = scene.find("\"foam\"").expect("in the scene");
        let report = miette!(
            labels = vec![LabeledSpan::at(at..at + 6, "here")],
            help = "supported: homogeneous, openvdb",
            "unknown medium type"
        )
        .with_source_code(NamedSource::new("a.pbrt", scene));
        let expected = "error: unknown medium type\n  --> a.pbrt:3:36\n \
            3 | \tMakeNamedMedium \"m\" \"string type\" \"foam\"\n   \
            | \t                                  ^^^^^^ here\n  \
            help: supported: homogeneous, openvdb\n";
        assert_eq!(plain(report.as_ref()), expected);
    }

    #[test]
    fn spans_at_the_edges_do_not_panic() {
        for (source, offset, length) in [
            ("", 0, 0),
            ("ab", 2, 0),
            ("a\nb\n", 4, 0),
            ("a\nb", 0, 3),
            ("ab", 9, 4),
        ] {
            let label = LabeledSpan::new(None, offset, length);
            let report = miette!(labels = vec![label], "wrong")
                .with_source_code(NamedSource::new("x", source));
            assert!(plain(report.as_ref()).starts_with("error: wrong\n"));
        }
    }
}
