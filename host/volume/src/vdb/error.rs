//! What can be wrong with an OpenVDB or NanoVDB file, and what to do about it.

/// Why an OpenVDB or NanoVDB file, or one of its grids, cannot be read or used.
///
/// Offsets are bytes from the start of the file; inside a compressed chunk they name the chunk's first byte.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum VdbError {
    /// The first eight bytes are not OpenVDB's.
    #[error(
        "not an OpenVDB file: the magic number is missing at byte 0; check that this is the file you meant"
    )]
    NotVdb,
    /// A format version whose layout this reader does not know.
    #[error(
        "OpenVDB format version {0} is not supported (222 to 225 are); load and save the file with a current OpenVDB"
    )]
    Version(u32),
    /// The first eight bytes are not NanoVDB's.
    #[error(
        "not a NanoVDB file: the magic number is missing at byte 0; check that this is the file you meant"
    )]
    NotNanoVdb,
    /// A version of NanoVDB whose layout this reader does not know: major and minor number.
    #[error(
        "NanoVDB version {0}.{1} is not supported (32.3 to 32.7 are); convert the volume again with a current NanoVDB"
    )]
    NanoVersion(u32, u32),
    /// Something is promised that lies beyond the end of the file (or of its grid).
    #[error(
        "{what} at byte {offset} needs {needed} bytes, only {available} are left: the file is truncated or damaged; \
         fetch or export it again"
    )]
    Truncated {
        /// What was being read.
        what: &'static str,
        /// Where it starts \[bytes\].
        offset: u64,
        /// How much it needs \[bytes\].
        needed: u64,
        /// How much is there \[bytes\].
        available: u64,
    },
    /// The bytes contradict the format.
    #[error("damaged at byte {offset}: {what}; fetch or export the file again")]
    Damaged {
        /// Where \[bytes\].
        offset: u64,
        /// The contradiction.
        what: String,
    },
    /// Valid perhaps, but beyond this reader.
    #[error("not supported at byte {offset}: {what}")]
    Unsupported {
        /// Where \[bytes\].
        offset: u64,
        /// What is beyond it, and a way around.
        what: String,
    },
    /// More memory than [`Limits`](crate::Limits) allows.
    #[error(
        "{what} needs {needed} bytes of memory, the limit is {limit}; raise --max-memory or use a smaller volume"
    )]
    Memory {
        /// What would need it.
        what: &'static str,
        /// The total that would be needed \[bytes\].
        needed: u64,
        /// The limit \[bytes\].
        limit: u64,
    },
    /// More memory than the machine gives, although the limit would allow it.
    #[error("{what} needs {needed} bytes of memory, which this machine does not give")]
    NoMemory {
        /// What would need it.
        what: &'static str,
        /// How much it needs \[bytes\].
        needed: u64,
    },
    /// A question about values was put to a grid that was listed without them.
    #[error("its values cannot be used: {0}")]
    Unreadable(String),
    /// Any of the above, inside a grid.
    #[error("grid `{grid}`: {source}")]
    InGrid {
        /// Name of the grid.
        grid: String,
        /// What is wrong in it.
        source: Box<VdbError>,
    },
}

impl VdbError {
    /// The same error with the name of the grid in front.
    #[must_use]
    pub fn in_grid(self, grid: &str) -> Self {
        match self {
            Self::InGrid { .. } => self,
            source => Self::InGrid {
                grid: grid.to_owned(),
                source: Box::new(source),
            },
        }
    }
}
