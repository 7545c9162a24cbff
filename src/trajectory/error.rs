//! Errors of data files, with place, cause and remedy.

use std::fmt;
use std::path::{Path, PathBuf};

/// A data file that cannot be read. Its message has one line for each kind of fault.
#[derive(thiserror::Error)]
#[error("{}", self.message())]
pub struct TrajectoryError {
    path: PathBuf,
    faults: Vec<DataFault>,
}

debug_as_message!(TrajectoryError);

/// A fault of a data file: the first of its kind, and the number of the others.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DataFault {
    /// Position in the file. Positions in compressed files are those of the decompressed text.
    pub place: DataPlace,
    /// The cause, such as `column x: found "abc", expected a number`.
    pub cause: String,
    /// The remedy.
    pub remedy: String,
    /// Number of further faults of the same kind.
    pub more: u64,
    kind: FaultKind,
}

/// A position in a data file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DataPlace {
    /// The whole file.
    Whole,
    /// A line, counted from 1, and the byte in it, counted from 1; byte 0 stands for the whole line.
    Line {
        /// Line.
        line: u64,
        /// Byte in the line.
        byte: u64,
    },
    /// A byte of a binary file, counted from 0.
    Byte(u64),
    /// A frame, counted from 0.
    Frame(usize),
}

/// Faults of one kind are reported together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum FaultKind {
    /// A fault that is reported alone.
    Single,
    ShortRow,
    LongRow,
    NotANumber,
    OpenQuote,
}

impl TrajectoryError {
    pub(super) fn new(path: &Path, faults: Faults) -> Self {
        Self { path: path.to_owned(), faults: faults.list }
    }

    /// Returns the file.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Returns the faults, in file order.
    #[must_use]
    pub fn faults(&self) -> &[DataFault] {
        &self.faults
    }

    fn message(&self) -> String {
        lines(&self.path, &self.faults)
    }
}

impl DataFault {
    /// Returns the fault as text that follows the file's name.
    fn message(&self) -> String {
        let Self { place, cause, remedy, more, .. } = self;
        let cause = printable(cause);
        let more = match more {
            0 => String::new(),
            more => format!(" (and {more} more of this kind)"),
        };
        format!("{place}: {cause}; {remedy}{more}")
    }
}

impl fmt::Display for DataPlace {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Whole => Ok(()),
            Self::Line { line, byte: 0 } => write!(formatter, ":{line}"),
            Self::Line { line, byte } => write!(formatter, ":{line}:{byte}"),
            Self::Byte(byte) => write!(formatter, ": byte {byte}"),
            Self::Frame(frame) => write!(formatter, ": frame {frame}"),
        }
    }
}

/// The faults of a file, or of a part of it, grouped by kind.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct Faults {
    list: Vec<DataFault>,
}

impl Faults {
    /// Returns the one fault of a file.
    pub(super) fn one(place: DataPlace, cause: impl Into<String>, remedy: impl Into<String>) -> Self {
        let fault =
            DataFault { place, cause: cause.into(), remedy: remedy.into(), more: 0, kind: FaultKind::Single };
        Self { list: vec![fault] }
    }

    /// Returns the fault of a line.
    pub(super) fn line(line: u64, cause: impl Into<String>, remedy: impl Into<String>) -> Self {
        Self::one(DataPlace::Line { line, byte: 0 }, cause, remedy)
    }

    /// Returns the fault of a file that the system does not read.
    pub(super) fn io(error: &std::io::Error) -> Self {
        let remedy = match error.kind() {
            std::io::ErrorKind::NotFound => "check the name and the folder",
            std::io::ErrorKind::PermissionDenied => "allow reading it",
            std::io::ErrorKind::OutOfMemory => "close other programs, or write fewer particles into a frame",
            std::io::ErrorKind::UnexpectedEof => "the file became shorter while it was read: read it again",
            _ => "check the disk and the file",
        };
        Self::one(DataPlace::Whole, format!("cannot be read: {error}"), remedy)
    }

    pub(super) fn is_empty(&self) -> bool {
        self.list.is_empty()
    }

    /// Adds a fault, whose texts are made only if it is the first of its kind.
    pub(super) fn add(
        &mut self,
        kind: FaultKind,
        place: DataPlace,
        texts: impl FnOnce() -> (String, String),
    ) {
        if let Some(first) = self.list.iter_mut().find(|fault| fault.kind == kind) {
            first.more += 1;
            return;
        }
        let (cause, remedy) = texts();
        self.list.push(DataFault { place, cause, remedy, more: 0, kind });
    }

    /// Returns the faults with the part of the file in which they are.
    pub(super) fn within(mut self, part: &str) -> Self {
        for fault in &mut self.list {
            fault.cause = format!("{part}: {}", fault.cause);
        }
        self
    }

    /// Adds the faults of a later part of the file.
    pub(super) fn append(&mut self, later: Self) {
        for fault in later.list {
            match self.list.iter_mut().find(|first| first.kind == fault.kind) {
                Some(first) if fault.kind != FaultKind::Single => first.more += 1 + fault.more,
                _ => self.list.push(fault),
            }
        }
    }

    /// Returns the faults as a warning: a line each, with the file's name.
    pub(super) fn warning(&self, path: &Path) -> String {
        lines(path, &self.list)
    }
}

/// Returns a line for each fault of a file, with its name.
fn lines(path: &Path, faults: &[DataFault]) -> String {
    let lines = faults.iter().map(|fault| format!("{}{}", path.display(), fault.message()));
    lines.collect::<Vec<_>>().join("\n")
}

impl From<std::io::Error> for Faults {
    fn from(error: std::io::Error) -> Self {
        Self::io(&error)
    }
}

/// Returns a text without control characters, and of limited length: names in it may come from a damaged file.
fn printable(text: &str) -> String {
    const LONGEST: usize = 400;
    let printable: String = text
        .chars()
        .map(|letter| if letter.is_control() { '\u{fffd}' } else { letter })
        .take(LONGEST)
        .collect();
    if text.chars().nth(LONGEST).is_some() { format!("{printable}…") } else { printable }
}

/// Returns bytes of a file as a quoted text of at most 40 characters.
pub(super) fn quote(bytes: &[u8]) -> String {
    let text = String::from_utf8_lossy(&bytes[..bytes.len().min(160)]);
    let mut short: String = text.chars().take(40).collect();
    if short.len() < text.len() || bytes.len() > 160 {
        short.push('…');
    }
    format!("{short:?}")
}
