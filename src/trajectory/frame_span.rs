//! Frames of text files, which follow one another.

use super::data_file::DataFile;
use super::error::Faults;
use super::frame_reader::FileEnd;
use super::text::LineCursor;

/// The bytes of a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct FrameSpan {
    /// Position of the first byte.
    pub start: u64,
    /// Position after the last byte.
    pub end: u64,
    /// Number of the first line, counted from 1.
    pub line: u64,
}

/// The frames of a file.
#[derive(Clone, Debug, Default)]
pub(super) struct FrameSpans {
    pub list: Vec<FrameSpan>,
}

/// The result of a search for the next frame.
pub(super) enum NextFrame {
    Found(FrameSpan),
    /// The file ends.
    End,
    /// The file ends within the frame.
    Truncated(Faults),
}

impl FrameSpans {
    /// Finds frames from the last known one on, which may have been incomplete. Returns warnings. A search is given the cursor and the frame
    /// before; without any whole frame, the result is the error of the first one, or that of an empty file.
    pub(super) fn extend<'a>(
        &mut self,
        file: &'a DataFile,
        end: FileEnd,
        empty: impl FnOnce() -> Faults,
        next: impl Fn(&mut LineCursor<'a>, FileEnd, Option<&FrameSpan>) -> Result<NextFrame, Faults>,
    ) -> Result<Vec<Faults>, Faults> {
        let kept = self.list.len().saturating_sub(1);
        let (start, line) = self.list.last().map_or((0, 1), |last| (last.start, last.line));
        let mut cursor = LineCursor::new(file, start, line - 1);
        let mut found = Vec::new();
        let mut warnings = Vec::new();
        loop {
            match next(&mut cursor, end, found.last())? {
                NextFrame::Found(span) => found.push(span),
                NextFrame::End => break,
                NextFrame::Truncated(faults) if found.is_empty() && kept == 0 => return Err(faults),
                NextFrame::Truncated(faults) => {
                    warnings.push(faults);
                    break;
                }
            }
        }
        if found.is_empty() && kept == 0 {
            return Err(empty());
        }
        self.list.truncate(kept);
        self.list.append(&mut found);
        Ok(warnings)
    }

    /// Returns the number of frames, and the position after the last one.
    pub(super) fn extent(&self) -> (usize, u64) {
        (self.list.len(), self.list.last().map_or(0, |span| span.end))
    }
}
