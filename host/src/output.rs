//! Files that are either whole or not there: written to a temporary name beside the target, then renamed.
//!
//! ```text
//! OutputFile::new(path)     before rendering: the extension and the folder are checked
//! output.stage(write)       after rendering: all files are written under temporary names
//! commit(staged)            then renamed together; whatever was not committed is removed when dropped
//! ```

use std::fs::{self, File, OpenOptions};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

/// Kinds of files that a render writes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OutputKind {
    /// OpenEXR: radiance, variance, metadata.
    Exr,
    /// Tone-mapped PNG.
    Png,
    /// Statistics as JSON.
    Json,
}

/// Why an output cannot be written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum OutputError {
    /// An image name that ends in neither `.exr` nor `.png`.
    #[error("{}: unknown kind of image; the name must end in .exr or .png", .0.display())]
    Extension(PathBuf),
    /// Two outputs of one kind.
    #[error("{}: one .exr and one .png can be written, not two of a kind", .0.display())]
    Duplicate(PathBuf),
    /// The folder, the temporary file or the renaming failed.
    #[error("{}: cannot write: {source}", path.display())]
    Io {
        /// The target.
        path: PathBuf,
        /// What the system says.
        source: io::Error,
    },
    /// The contents could not be encoded or written.
    #[error("{}: {source}", path.display())]
    Contents {
        /// The target.
        path: PathBuf,
        /// What the writer says.
        source: Box<dyn std::error::Error + Send + Sync>,
    },
}

/// A file to be written, known to be writable when it was checked.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct OutputFile {
    path: PathBuf,
    kind: OutputKind,
}

impl OutputFile {
    /// An image, its kind taken from the extension (in any case of letters). Touches no file.
    pub fn image(path: &Path) -> Result<Self, OutputError> {
        let extension = path.extension().and_then(|e| e.to_str());
        let kind = match extension.map(str::to_ascii_lowercase).as_deref() {
            Some("exr") => OutputKind::Exr,
            Some("png") => OutputKind::Png,
            _ => return Err(OutputError::Extension(path.to_owned())),
        };
        Ok(Self {
            path: path.to_owned(),
            kind,
        })
    }

    /// A file of statistics, of any name. Touches no file.
    pub fn statistics(path: &Path) -> Self {
        Self {
            path: path.to_owned(),
            kind: OutputKind::Json,
        }
    }

    /// Images by their names: at most one of each kind.
    pub fn images(paths: &[PathBuf]) -> Result<Vec<Self>, OutputError> {
        let mut outputs: Vec<Self> = Vec::new();
        for path in paths {
            let output = Self::image(path)?;
            if outputs.iter().any(|other| other.kind == output.kind) {
                return Err(OutputError::Duplicate(output.path));
            }
            outputs.push(output);
        }
        Ok(outputs)
    }

    /// The target.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// What is to be written.
    pub fn kind(&self) -> OutputKind {
        self.kind
    }

    /// Checks that the file could be written now, by making and removing a temporary file. Call it before rendering for an hour.
    pub fn probe(&self) -> Result<(), OutputError> {
        if self.path.is_dir() {
            return Err(self.io(io::Error::from(io::ErrorKind::IsADirectory)));
        }
        if is_device(&self.path) {
            let opened = OpenOptions::new().write(true).open(&self.path);
            return opened.map(drop).map_err(|e| self.io(e));
        }
        self.temporary().map(drop)
    }

    /// Writes the contents under a temporary name. An existing target is untouched until [`commit`].
    ///
    /// Devices and pipes (`/dev/stdout`) are written at once, since they cannot be renamed over.
    pub fn stage<E>(
        &self,
        write: impl FnOnce(&mut BufWriter<File>) -> Result<(), E>,
    ) -> Result<Staged, OutputError>
    where
        E: Into<Box<dyn std::error::Error + Send + Sync>>,
    {
        let (file, staged) = if is_device(&self.path) {
            let file = OpenOptions::new().write(true).open(&self.path);
            let staged = Staged {
                temporary: None,
                target: self.path.clone(),
            };
            (file.map_err(|e| self.io(e))?, staged)
        } else {
            self.temporary()?
        };
        let mut writer = BufWriter::new(file);
        write(&mut writer).map_err(|source| OutputError::Contents {
            path: self.path.clone(),
            source: source.into(),
        })?;
        writer.flush().map_err(|e| self.io(e))?;
        if staged.temporary.is_some() {
            // The name must not outlive the contents in a power cut.
            writer.get_ref().sync_all().map_err(|e| self.io(e))?;
        }
        Ok(staged)
    }

    /// Creates a new file beside the target.
    fn temporary(&self) -> Result<(File, Staged), OutputError> {
        let Some(name) = self.path.file_name() else {
            return Err(self.io(io::Error::from(io::ErrorKind::InvalidFilename)));
        };
        let process = std::process::id();
        for attempt in 0..100 {
            let mut temporary = std::ffi::OsString::from(".");
            temporary.push(name);
            temporary.push(format!(".{process}-{attempt}.tmp"));
            let path = self.path.with_file_name(temporary);
            match OpenOptions::new().write(true).create_new(true).open(&path) {
                Ok(file) => {
                    let staged = Staged {
                        temporary: Some(path),
                        target: self.path.clone(),
                    };
                    return Ok((file, staged));
                }
                Err(e) if e.kind() == io::ErrorKind::AlreadyExists => {}
                Err(e) => return Err(self.io(e)),
            }
        }
        Err(self.io(io::Error::from(io::ErrorKind::AlreadyExists)))
    }

    fn io(&self, source: io::Error) -> OutputError {
        OutputError::Io {
            path: self.path.clone(),
            source,
        }
    }
}

/// Something that exists and is neither file nor folder.
fn is_device(path: &Path) -> bool {
    fs::metadata(path).is_ok_and(|meta| !meta.is_file() && !meta.is_dir())
}

/// A file written under its temporary name; removed when dropped.
#[derive(Debug)]
#[must_use = "a staged file vanishes unless it is committed"]
pub struct Staged {
    temporary: Option<PathBuf>,
    target: PathBuf,
}

impl Drop for Staged {
    fn drop(&mut self) {
        if let Some(temporary) = &self.temporary {
            // Nothing better can be done about a file that will not go.
            let _ = fs::remove_file(temporary);
        }
    }
}

/// Gives all staged files their names, replacing what was there.
///
/// Each file appears whole. If one renaming fails, those before it stay and the rest are removed.
pub fn commit(staged: impl IntoIterator<Item = Staged>) -> Result<(), OutputError> {
    for mut file in staged {
        if let Some(temporary) = &file.temporary {
            fs::rename(temporary, &file.target).map_err(|source| OutputError::Io {
                path: file.target.clone(),
                source,
            })?;
            file.temporary = None;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A folder that is removed afterwards.
    struct Folder(PathBuf);

    impl Folder {
        fn new(name: &str) -> Self {
            let path = std::env::temp_dir().join(format!("woodcock-{name}-{}", std::process::id()));
            fs::create_dir_all(&path).expect("a temporary folder");
            Self(path)
        }

        fn names(&self) -> Vec<String> {
            let entries = fs::read_dir(&self.0).expect("listable");
            let name = |e: io::Result<fs::DirEntry>| e.expect("an entry").file_name();
            let mut names: Vec<_> = entries
                .map(|e| name(e).to_string_lossy().into_owned())
                .collect();
            names.sort();
            names
        }
    }

    impl Drop for Folder {
        fn drop(&mut self) {
            let _ = fs::remove_dir_all(&self.0);
        }
    }

    #[test]
    fn files_appear_whole_or_not_at_all() {
        let folder = Folder::new("output");
        let output = OutputFile::image(&folder.0.join("a.exr")).expect("an image name");
        output.probe().expect("writable");
        assert!(folder.names().is_empty(), "the probe leaves nothing");

        fs::write(output.path(), "old").expect("written");
        let staged = output.stage(|w| w.write_all(b"new")).expect("staged");
        assert_eq!(fs::read(output.path()).expect("there"), b"old");
        drop(staged);
        assert_eq!(
            folder.names(),
            ["a.exr"],
            "what is not committed is removed"
        );

        let failed = output.stage(|w| {
            w.write_all(b"half")?;
            Err(io::Error::other("no more"))
        });
        let message = failed.expect_err("the writer failed").to_string();
        assert!(message.ends_with("a.exr: no more"), "{message}");
        assert_eq!(folder.names(), ["a.exr"]);

        commit([output.stage(|w| w.write_all(b"new")).expect("staged")]).expect("committed");
        assert_eq!(fs::read(output.path()).expect("there"), b"new");
        assert_eq!(folder.names(), ["a.exr"]);
    }

    #[test]
    fn names_are_checked_before_rendering() {
        let folder = Folder::new("names");
        let at = |name: &str| folder.0.join(name);
        assert_eq!(
            OutputFile::image(&at("x.EXR")).map(|o| o.kind()).ok(),
            Some(OutputKind::Exr)
        );
        for bad in ["x", "x.jpg", "x.exr.gz", ".exr"] {
            assert!(
                matches!(OutputFile::image(&at(bad)), Err(OutputError::Extension(_))),
                "{bad}"
            );
        }
        let two = [at("a.exr"), at("b.exr")];
        assert!(matches!(
            OutputFile::images(&two),
            Err(OutputError::Duplicate(_))
        ));
        assert_eq!(
            OutputFile::images(&[at("a.png"), at("a.exr")])
                .map(|o| o.len())
                .ok(),
            Some(2)
        );

        let nowhere = OutputFile::image(&at("none/x.exr")).expect("a name");
        let message = nowhere.probe().expect_err("no such folder").to_string();
        assert!(message.contains("x.exr: cannot write"), "{message}");
        fs::create_dir(at("folder.exr")).expect("a folder");
        let occupied = OutputFile::image(&at("folder.exr")).expect("a name");
        assert!(occupied.probe().is_err());
    }
}
