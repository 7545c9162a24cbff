//! The interface of formats.

use std::fmt;

use super::data_file::DataFile;
use super::error::Faults;
use super::snapshot::Snapshot;

/// The frames of a format.
pub(super) trait FrameReader: CloneReader + fmt::Debug + Send + Sync {
    /// Finds the frames of a file that has grown, or of one that was not read before. Returns warnings. After an error, the frames are as
    /// before.
    fn index(&mut self, file: &DataFile, end: FileEnd) -> Result<Vec<Faults>, Faults>;

    /// Returns the number of frames.
    fn frames(&self) -> usize;

    /// Returns the number of frames and the number of bytes that are used, which change when frames are added or grow.
    fn extent(&self) -> (usize, u64);

    /// Reads a frame, which exists.
    fn read(&self, file: &DataFile, frame: usize) -> Result<Snapshot, Faults>;
}

/// A reader that can be copied without its type being known.
pub(super) trait CloneReader {
    /// Returns a copy.
    fn boxed(&self) -> Box<dyn FrameReader>;
}

impl<T: FrameReader + Clone + 'static> CloneReader for T {
    fn boxed(&self) -> Box<dyn FrameReader> {
        Box::new(self.clone())
    }
}

impl Clone for Box<dyn FrameReader> {
    fn clone(&self) -> Self {
        self.boxed()
    }
}

/// The meaning of a last line without a line end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum FileEnd {
    /// It is whole.
    Final,
    /// It may still be written.
    Growing,
}
