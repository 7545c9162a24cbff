//! Stray files, which look like frames of a sequence but are not.

use std::fmt;
use std::io;
use std::path::PathBuf;

use crate::output::{Sequence, frame_size};

/// A file that looks like a frame of a sequence but is not.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Surplus {
    /// Path of the file.
    pub path: PathBuf,
    /// The reason the file is not a frame.
    pub reason: SurplusReason,
}

/// The reason a file is not a frame of a sequence.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SurplusReason {
    /// The timeline has no frame with this number.
    NotInSequence,
    /// The number has more or fewer digits than the numbers of the sequence.
    OtherDigits,
    /// The width and height of the file, which differ from the sequence.
    OtherSize(u32, u32),
}

impl SurplusReason {
    /// Returns whether the reason is in the file's name, regardless of its content.
    #[must_use]
    pub fn is_about_name(self) -> bool {
        !matches!(self, Self::OtherSize(..))
    }
}

impl fmt::Display for SurplusReason {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotInSequence => write!(formatter, "the timeline ends before it"),
            Self::OtherDigits => write!(formatter, "its number is written with other digits"),
            Self::OtherSize(width, height) => write!(formatter, "it is {width}x{height}"),
        }
    }
}

/// Finds files that look like frames of a sequence with `count` frames of this size but are not. Only names and headers are read.
///
/// # Errors
///
/// If the folder cannot be read.
pub fn find_surplus(sequence: &Sequence, count: u32, size: (u32, u32)) -> io::Result<Vec<Surplus>> {
    let reason = |frame: u32, path: &PathBuf| {
        if frame >= count {
            Some(SurplusReason::NotInSequence)
        } else if sequence.frame(frame) != *path {
            Some(SurplusReason::OtherDigits)
        } else {
            let other = frame_size(path, sequence.format()).filter(|found| *found != size);
            other.map(|(width, height)| SurplusReason::OtherSize(width, height))
        }
    };
    let present = sequence.present()?.into_iter();
    Ok(present
        .filter_map(|(frame, path)| reason(frame, &path).map(|reason| Surplus { path, reason }))
        .collect())
}
