//! What becomes of a complaint: an error, or in lenient mode a warning.

use super::super::{SceneError, Warning};

/// Most warnings kept: a file may be wrong in a million places.
const KEPT: usize = 200;

/// Collects warnings and decides what is fatal.
#[derive(Debug)]
pub(super) struct Diagnostics {
    lenient: bool,
    warnings: Vec<Warning>,
    dropped: usize,
}

impl Diagnostics {
    pub(super) fn new(lenient: bool) -> Self {
        Self {
            lenient,
            warnings: Vec::new(),
            dropped: 0,
        }
    }

    /// Something that is not understood or not supported: `Err` unless lenient.
    pub(super) fn refuse(&mut self, error: SceneError) -> Result<(), SceneError> {
        if !self.lenient {
            return Err(error);
        }
        self.warn(error.help("ignored, as leniency was asked for"));
        Ok(())
    }

    /// Something that the user should know.
    pub(super) fn warn(&mut self, warning: SceneError) {
        if self.warnings.len() < KEPT {
            self.warnings.push(warning.into_warning());
        } else {
            self.dropped += 1;
        }
    }

    pub(super) fn finish(mut self, file: &str) -> Vec<Warning> {
        if self.dropped > 0 {
            let message = format!("{} further warnings are not shown", self.dropped);
            self.warnings
                .push(SceneError::of_file(file, message).into_warning());
        }
        self.warnings
    }
}
