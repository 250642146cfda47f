//! Text with a name, and places in it.

use std::fmt;
use std::sync::Arc;

use miette::{MietteError, MietteSpanContents, SourceCode, SourceSpan, SpanContents};

/// Most bytes of a line shown to either side of a place: lines of machine-made scenes can be as long
/// as the file.
const SHOWN: usize = 100;

/// The bytes of a file, with the name that the user knows it by.
#[derive(Debug)]
pub struct Source {
    name: String,
    bytes: Vec<u8>,
    /// Characters of the first line that were cut off, 0 for a whole file.
    cut: usize,
}

impl Source {
    /// A file's content. It need not be UTF-8: comments often are not.
    pub fn new(name: impl Into<String>, bytes: Vec<u8>) -> Arc<Self> {
        Arc::new(Self {
            name: name.into(),
            bytes,
            cut: 0,
        })
    }

    /// The name, usually a path.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The content.
    pub fn bytes(&self) -> &[u8] {
        &self.bytes
    }
}

/// A stretch of bytes in a source. Cheap to clone; keeps its text alive.
#[derive(Clone)]
pub struct Place {
    source: Arc<Source>,
    start: usize,
    end: usize,
    /// From 1, as in the file that the source was cut from.
    line: usize,
    line_start: usize,
}

impl Place {
    /// Bytes `start..end` of `source`; both are clamped to its length. Counts lines from the source's
    /// beginning.
    pub fn new(source: &Arc<Source>, start: usize, end: usize) -> Self {
        let before = &source.bytes[..start.min(source.bytes.len())];
        let line = 1 + before.iter().filter(|&&b| b == b'\n').count();
        let line_start = before.iter().rposition(|&b| b == b'\n');
        Self::on_line(source, start, end, line, line_start.map_or(0, |i| i + 1))
    }

    /// The same when the line's number (from 1) and first byte are known.
    pub(crate) fn on_line(
        source: &Arc<Source>,
        start: usize,
        end: usize,
        line: usize,
        line_start: usize,
    ) -> Self {
        let start = start.min(source.bytes.len());
        Self {
            source: Arc::clone(source),
            start,
            end: end.clamp(start, source.bytes.len()),
            line,
            line_start: line_start.min(start),
        }
    }

    /// Name of the file.
    pub fn file(&self) -> &str {
        &self.source.name
    }

    /// Line and column, both counted from 1; columns count characters.
    pub fn line_column(&self) -> (usize, usize) {
        let cut = if self.line_start == 0 {
            self.source.cut
        } else {
            0
        };
        let before = &self.source.bytes[self.line_start..self.start];
        (self.line, 1 + cut + count_chars(before))
    }

    /// The source that the place is in.
    pub fn source(&self) -> &Arc<Source> {
        &self.source
    }

    /// The bytes it covers, as offsets into the source.
    pub fn span(&self) -> std::ops::Range<usize> {
        self.start..self.end
    }

    /// The line's number, and its first byte in the source.
    pub(crate) fn line_and_start(&self) -> (usize, usize) {
        (self.line, self.line_start)
    }

    /// The same place in a copy of its surroundings, so that a large text can be let go.
    pub(crate) fn detached(&self) -> Self {
        let bytes = &self.source.bytes;
        let from = self.line_start.max(self.start.saturating_sub(2 * SHOWN));
        let to = self.line_end().min(self.start + 2 * SHOWN);
        let cut = if self.line_start == 0 {
            self.source.cut
        } else {
            0
        };
        let source = Arc::new(Source {
            name: self.source.name.clone(),
            bytes: bytes[from..to].to_vec(),
            cut: cut + count_chars(&bytes[self.line_start..from]),
        });
        Self::on_line(&source, self.start - from, self.end - from, self.line, 0)
    }

    /// The line with carets under the place, ending in a line break:
    ///
    /// ```text
    ///  --> cloud.pbrt:3:8
    ///   |
    /// 3 | Camera "perspectiv"
    ///   |        ^^^^^^^^^^^^
    /// ```
    pub fn snippet(&self) -> String {
        let bytes = &self.source.bytes;
        let (line, column) = self.line_column();
        let from = self.line_start.max(self.start.saturating_sub(SHOWN));
        let to = self.line_end().min(self.start + SHOWN);
        let end = self.end.min(to);
        let lead = if from > self.line_start { "…" } else { "" };
        let tail = if to < self.line_end() { "…" } else { "" };
        let printable = |b: &[u8]| -> String {
            String::from_utf8_lossy(b)
                .chars()
                .map(|c| {
                    if c.is_control() && c != '\t' {
                        '\u{fffd}'
                    } else {
                        c
                    }
                })
                .collect()
        };
        let text = printable(&bytes[from..to]);
        // Tabs are kept, so that the carets stand below what they mean in any terminal.
        let pad: String = lead
            .chars()
            .chain(printable(&bytes[from..self.start]).chars())
            .map(|c| if c == '\t' { '\t' } else { ' ' })
            .collect();
        let carets = "^".repeat(count_chars(&bytes[self.start..end.max(self.start)]).max(1));
        let number = line.to_string();
        let gutter = " ".repeat(number.len());
        let file = &self.source.name;
        format!(
            "{gutter}--> {file}:{line}:{column}\n{gutter} |\n{number} | {lead}{text}{tail}\n{gutter} | {pad}{carets}\n"
        )
    }

    fn line_end(&self) -> usize {
        let after = &self.source.bytes[self.start..];
        let length = after.iter().position(|&b| b == b'\n' || b == b'\r');
        self.start + length.unwrap_or(after.len())
    }
}

/// `file:line:column`.
impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (line, column) = self.line_column();
        write!(f, "{}:{line}:{column}", self.source.name)
    }
}

impl fmt::Debug for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Place({self})")
    }
}

/// Characters in UTF-8 text; each stray byte of other text counts at most one.
fn count_chars(bytes: &[u8]) -> usize {
    String::from_utf8_lossy(bytes).chars().count()
}

/// Shows a clipped window, as [`Place::snippet`] does.
impl SourceCode for Source {
    fn read_span<'a>(
        &'a self,
        span: &SourceSpan,
        _lines_before: usize,
        _lines_after: usize,
    ) -> Result<Box<dyn SpanContents<'a> + 'a>, MietteError> {
        let start = span.offset();
        let end = start.saturating_add(span.len());
        if end > self.bytes.len() {
            return Err(MietteError::OutOfBounds);
        }
        let before = &self.bytes[..start];
        let line = before.iter().filter(|&&b| b == b'\n').count();
        let line_start = before
            .iter()
            .rposition(|&b| b == b'\n')
            .map_or(0, |i| i + 1);
        let from = line_start.max(start.saturating_sub(SHOWN));
        let rest = &self.bytes[start..];
        let line_end = start + rest.iter().position(|&b| b == b'\n').unwrap_or(rest.len());
        let to = line_end.min(start + SHOWN).max(end.min(start + SHOWN));
        Ok(Box::new(MietteSpanContents::new_named(
            self.name.clone(),
            &self.bytes[from..to],
            (from, to - from).into(),
            line,
            count_chars(&self.bytes[line_start..from]),
            1,
        )))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn carets_stand_below_their_text() {
        let source = Source::new("a.pbrt", b"one\n\ttw\xc3\xb6 three\n".to_vec());
        let place = Place::new(&source, 10, 15);
        assert_eq!(place.line_column(), (2, 6));
        assert_eq!(
            place.snippet(),
            " --> a.pbrt:2:6\n  |\n2 | \ttwö three\n  | \t    ^^^^^\n"
        );
        let detached = place.detached();
        assert_eq!(detached.snippet(), place.snippet());
        assert!(detached.source().bytes().len() < source.bytes().len());
    }

    #[test]
    fn long_lines_are_clipped() {
        let source = Source::new("a", vec![b'x'; 100_000]);
        let place = Place::new(&source, 50_000, 100_000);
        assert!(place.snippet().len() < 1000);
        assert_eq!(place.line_column(), (1, 50_001));
    }

    #[test]
    fn the_end_of_a_file_is_a_place() {
        let source = Source::new("a", b"x".to_vec());
        assert_eq!(Place::new(&source, 5, 9).to_string(), "a:1:2");
        let empty = Source::new("a", Vec::new());
        assert_eq!(Place::new(&empty, 0, 0).to_string(), "a:1:1");
    }
}
