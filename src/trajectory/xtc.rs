//! Frames of a format that is not read yet.
use super::data_file::DataFile;
use super::error::Faults;
use super::reader::{FileEnd, FrameReader};
use super::snapshot::Snapshot;
/// No frames.
#[derive(Debug, Default)]
pub(super) struct XtcFrames;
impl FrameReader for XtcFrames {
    fn index(&mut self, _: &DataFile, _: FileEnd) -> Result<Vec<Faults>, Faults> {
        Err(Faults::one(super::DataPlace::Whole, "this format is not read yet", "convert the file to XYZ"))
    }
    fn frames(&self) -> usize {
        1
    }
    fn extent(&self) -> (usize, u64) {
        (1, 0)
    }
    fn read(&self, _: &DataFile, _: usize) -> Result<Snapshot, Faults> {
        Ok(Snapshot::default())
    }
}
