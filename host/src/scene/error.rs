//! What is wrong with a scene, and where.

use std::fmt;

use miette::{Diagnostic, LabeledSpan, Severity};

use super::Place;

#[derive(Clone, Debug)]
struct Detail {
    message: String,
    help: Option<String>,
    place: Option<Place>,
    /// Shown when there is no place, as for a main file that does not exist.
    file: String,
    notes: Vec<(Place, String)>,
}

/// Why a scene cannot be read.
///
/// [`Display`](fmt::Display) is one line, `file:line:column: message`; [`report`](Self::report) adds the
/// text with carets; as a [`Diagnostic`] it can be handed to miette.
#[derive(Clone, Debug)]
pub struct SceneError(Box<Detail>);

impl SceneError {
    /// An error at a place. Later stages use it too: every part of a scene carries its place.
    pub fn at(place: &Place, message: impl Into<String>) -> Self {
        Self(Box::new(Detail {
            message: message.into(),
            help: None,
            file: String::new(),
            place: Some(place.clone()),
            notes: Vec::new(),
        }))
    }

    /// An error about a file as a whole.
    pub fn of_file(file: impl Into<String>, message: impl Into<String>) -> Self {
        Self(Box::new(Detail {
            message: message.into(),
            help: None,
            file: file.into(),
            place: None,
            notes: Vec::new(),
        }))
    }

    /// Adds what the user can do about it; a second call adds a further sentence.
    #[must_use]
    pub fn help(mut self, help: impl Into<String>) -> Self {
        let help = help.into();
        self.0.help = Some(match self.0.help.take() {
            Some(first) => format!("{first}; {help}"),
            None => help,
        });
        self
    }

    /// Adds a second place with a remark.
    #[must_use]
    pub fn note(mut self, place: &Place, remark: impl Into<String>) -> Self {
        self.0.notes.push((place.clone(), remark.into()));
        self
    }

    /// What is wrong, without the place.
    pub fn message(&self) -> &str {
        &self.0.message
    }

    /// What can be done about it.
    pub fn help_text(&self) -> Option<&str> {
        self.0.help.as_deref()
    }

    /// Where it is wrong; `None` when it is about a file as a whole.
    pub fn place(&self) -> Option<&Place> {
        self.0.place.as_ref()
    }

    /// Message, text with carets, notes and help over several lines, ending in a line break.
    pub fn report(&self) -> String {
        self.0.report("error")
    }

    pub(crate) fn into_warning(mut self) -> Warning {
        // A warning outlives the reading and must not keep a large file in memory.
        let places = self.0.notes.iter_mut().map(|(place, _)| place);
        for place in self.0.place.iter_mut().chain(places) {
            *place = place.detached();
        }
        Warning(self.0)
    }
}

/// Something in a scene that was ignored or approximated. Prints like [`SceneError`].
#[derive(Clone, Debug)]
pub struct Warning(Box<Detail>);

impl Warning {
    /// What was done, without the place.
    pub fn message(&self) -> &str {
        &self.0.message
    }

    /// Where; `None` when it is about a file as a whole.
    pub fn place(&self) -> Option<&Place> {
        self.0.place.as_ref()
    }

    /// Message, text with carets, notes and help over several lines, ending in a line break.
    pub fn report(&self) -> String {
        self.0.report("warning")
    }
}

impl Detail {
    fn report(&self, severity: &str) -> String {
        let mut out = format!("{severity}: {}\n", self.message);
        match &self.place {
            Some(place) => out += &place.snippet(),
            None => out += &format!(" --> {}\n", self.file),
        }
        for (place, remark) in &self.notes {
            out += &format!("note: {remark}\n{}", place.snippet());
        }
        if let Some(help) = &self.help {
            out += &format!("help: {help}\n");
        }
        out
    }

    fn labels(&self) -> Option<Box<dyn Iterator<Item = LabeledSpan> + '_>> {
        let place = self.place.as_ref()?;
        let span = place.span();
        let label = LabeledSpan::new(Some("here".into()), span.start, span.len());
        Some(Box::new(std::iter::once(label)))
    }
}

impl fmt::Display for Detail {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.place {
            Some(place) => write!(f, "{place}: {}", self.message),
            None => write!(f, "{}: {}", self.file, self.message),
        }
    }
}

macro_rules! diagnostic {
    ($type:ty, $severity:expr) => {
        impl fmt::Display for $type {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                self.0.fmt(f)
            }
        }

        impl std::error::Error for $type {}

        impl Diagnostic for $type {
            fn severity(&self) -> Option<Severity> {
                Some($severity)
            }

            fn help<'a>(&'a self) -> Option<Box<dyn fmt::Display + 'a>> {
                let help = self.0.help.as_ref()?;
                Some(Box::new(help))
            }

            fn source_code(&self) -> Option<&dyn miette::SourceCode> {
                let place = self.0.place.as_ref()?;
                Some(&**place.source())
            }

            fn labels(&self) -> Option<Box<dyn Iterator<Item = LabeledSpan> + '_>> {
                self.0.labels()
            }
        }
    };
}

diagnostic!(SceneError, Severity::Error);
diagnostic!(Warning, Severity::Warning);

#[cfg(test)]
mod tests {
    use super::super::Source;
    use super::*;

    fn error() -> SceneError {
        let source = Source::new("a.pbrt", b"one\ntwo three\n".to_vec());
        SceneError::at(&Place::new(&source, 8, 13), "no")
            .help("do")
            .help("try")
    }

    #[test]
    fn prints_with_and_without_a_place() {
        assert_eq!(error().to_string(), "a.pbrt:2:5: no");
        assert_eq!(error().help_text(), Some("do; try"));
        let whole = SceneError::of_file("a.pbrt", "gone");
        assert_eq!(whole.to_string(), "a.pbrt: gone");
        assert_eq!(whole.report(), "error: gone\n --> a.pbrt\n");
    }

    #[cfg(feature = "cli")]
    #[test]
    fn miette_draws_it() {
        use miette::{GraphicalReportHandler, GraphicalTheme};
        let mut out = String::new();
        GraphicalReportHandler::new_themed(GraphicalTheme::none())
            .render_report(&mut out, &error())
            .expect("renders");
        assert!(
            out.contains("a.pbrt:2:5") && out.contains("two three"),
            "{out}"
        );
        assert!(out.contains("help: do; try"), "{out}");
    }
}
