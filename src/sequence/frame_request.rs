//! Requests for single pictures of a sequence.

use std::path::PathBuf;

use crate::output::Sequence;
use crate::time::{FrameList, Time, Timeline};

/// A picture to be rendered: a frame, or a moment between frames.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrameRequest {
    /// Index of the frame; `None` for a moment that is not a frame.
    pub frame: Option<u32>,
    /// Time of the picture.
    pub time: Time,
}

impl FrameRequest {
    /// Returns the request for a frame of a timeline.
    #[must_use]
    pub fn frame(index: u32, timeline: Timeline) -> Self {
        Self { frame: Some(index), time: timeline.time_of(index) }
    }

    /// Returns the requests for frames of a timeline, in ascending order.
    pub fn frames(frames: &FrameList, timeline: Timeline) -> impl Iterator<Item = Self> {
        frames.frames().map(move |index| Self::frame(index, timeline))
    }

    /// Returns the path of the picture.
    #[must_use]
    pub fn file(&self, sequence: &Sequence) -> PathBuf {
        match self.frame {
            Some(index) => sequence.frame(index),
            None => sequence.moment(self.time),
        }
    }

    /// Describes the moment, as `frame 3` or `1.5 s`.
    #[must_use]
    pub fn moment(&self) -> String {
        match self.frame {
            Some(frame) => format!("frame {frame}"),
            None => format!("{} s", self.time.seconds()),
        }
    }
}
