//! Files that look like frames of a sequence, and are none.

use std::fmt;
use std::io;
use std::path::PathBuf;

use crate::output::{Sequence, frame_size};

/// A file that looks like a frame of a sequence, and is none.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Surplus {
    /// The file.
    pub path: PathBuf,
    /// Why it is none.
    pub reason: SurplusReason,
}

/// Why a file is no frame of a sequence.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SurplusReason {
    /// The timeline has no frame of this number.
    NotInSequence,
    /// Its number has more or fewer digits than those of the sequence have.
    OtherDigits,
    /// It has so many columns and rows, and the sequence has others.
    OtherSize(u32, u32),
}

impl SurplusReason {
    /// Returns whether the file's name tells, whatever is in it.
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

/// Finds what looks like frames of a sequence of so many frames, of such a size, and is none. Only names and headers are read.
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
