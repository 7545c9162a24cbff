//! Verification of sequences in folders: every file is read completely and compared with the scene.

use std::fmt;
use std::io;
use std::ops::ControlFlow;

use rayon::prelude::*;

use super::FrameRequest;
use super::surplus::{Surplus, find_surplus};
use crate::engine::{Engine, EngineError};
use crate::output::{FoundFrame, Sequence};
use crate::time::FrameList;

/// The state of a frame's file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum FrameVerdict {
    /// The file is complete and up to date.
    UpToDate,
    /// There is no file.
    Missing,
    /// The file is corrupt, with the reason.
    Corrupt(String),
    /// The file is complete but out of date: from another scene, with other settings, or from before an edit.
    Stale,
    /// The file is a picture of another size, this width and height.
    OtherSize(u32, u32),
    /// The file is complete but its provenance is unknown.
    Unknown,
}

/// The state of a sequence's files.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct SequenceVerdict {
    /// Verdicts by frame, ascending.
    pub frames: Vec<(u32, FrameVerdict)>,
    /// Files that look like frames but are not.
    pub surplus: Vec<Surplus>,
}

impl SequenceVerdict {
    /// Returns whether every frame is up to date and no other file looks like a frame.
    #[must_use]
    pub fn is_complete(&self) -> bool {
        self.surplus.is_empty() && self.to_render().is_none()
    }

    /// Returns the frames that have to be rendered, or `None` if there are none.
    #[must_use]
    pub fn to_render(&self) -> Option<FrameList> {
        self.frames_with(|verdict| *verdict != FrameVerdict::UpToDate)
    }

    /// Returns the frames whose verdicts satisfy a condition, or `None` if there are none.
    #[must_use]
    pub fn frames_with(&self, is_wanted: impl Fn(&FrameVerdict) -> bool) -> Option<FrameList> {
        let wanted = self.frames.iter().filter(|(_, verdict)| is_wanted(verdict));
        FrameList::of(wanted.map(|(frame, _)| *frame))
    }
}

/// An error that stops the verification of a sequence.
#[derive(thiserror::Error)]
pub enum VerifyError {
    /// The world could not be evaluated at a frame.
    #[error(transparent)]
    Engine(#[from] EngineError),
    /// The folder could not be read.
    #[error("cannot read the folder")]
    Folder(#[from] io::Error),
}

debug_as_message!(VerifyError);

/// Verifies the frames of a sequence and the other files in its folder. Before each frame, `begin` may configure the engine, and
/// decides whether to continue.
///
/// # Errors
///
/// As [`Engine::render_frame`], and if the folder cannot be read.
pub fn verify_sequence(
    engine: &mut Engine,
    frames: &FrameList,
    sequence: &Sequence,
    mut begin: impl FnMut(&mut Engine, &FrameRequest) -> ControlFlow<()>,
) -> Result<SequenceVerdict, VerifyError> {
    /// Number of files that are read at once.
    const TOGETHER: usize = 64;
    let timeline = engine.timeline;
    let count = timeline.frame_count();
    let requests: Vec<FrameRequest> = FrameRequest::frames(&frames.within(count), timeline).collect();
    let film = engine.effective_settings().film;
    let size = (film.width, film.height);
    let mut verdict = SequenceVerdict::default();
    'all: for requests in requests.chunks(TOGETHER) {
        let look = |request: &FrameRequest| {
            FoundFrame::expected_at(&request.file(sequence), sequence.format(), size)
        };
        let found = requests.par_iter().map(look);
        for (request, found) in requests.iter().zip(found.collect::<Vec<_>>()) {
            if begin(engine, request).is_break() {
                break 'all;
            }
            let of_frame = verdict_of(engine, request, found)?;
            verdict.frames.extend(request.frame.map(|frame| (frame, of_frame)));
        }
    }
    let is_verified = |frame: u32| verdict.frames.binary_search_by_key(&frame, |(own, _)| *own).is_ok();
    let surplus = find_surplus(sequence, count, size)?;
    // Files of another size are already reported as stale if their frames were verified.
    verdict.surplus = surplus
        .into_iter()
        .filter(|surplus| {
            let frame = surplus.path.file_name().and_then(|name| sequence.frame_of(name));
            surplus.reason.is_about_name() || !frame.is_some_and(is_verified)
        })
        .collect();
    Ok(verdict)
}

/// Compares the file found for a frame with the frame that would be rendered now.
pub(super) fn verdict_of(
    engine: &mut Engine,
    request: &FrameRequest,
    found: FoundFrame,
) -> Result<FrameVerdict, EngineError> {
    Ok(match found {
        FoundFrame::Missing => FrameVerdict::Missing,
        FoundFrame::Corrupt(reason) => FrameVerdict::Corrupt(reason),
        FoundFrame::Unknown { .. } => FrameVerdict::Unknown,
        FoundFrame::OtherSize { size: (width, height) } => FrameVerdict::OtherSize(width, height),
        FoundFrame::Complete { fingerprint, .. } => {
            match engine.plan(request.time)?.fingerprint == Some(fingerprint) {
                true => FrameVerdict::UpToDate,
                false => FrameVerdict::Stale,
            }
        }
    })
}

/// Describes the state of a file.
impl fmt::Display for FrameVerdict {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(match self {
            Self::UpToDate => "it is complete and up to date",
            Self::Missing => "there is no file",
            Self::Corrupt(reason) => reason,
            Self::Stale => "the scene or the settings have changed",
            Self::OtherSize(width, height) => return write!(formatter, "its size was {width}x{height}"),
            Self::Unknown => "its provenance is unknown",
        })
    }
}
