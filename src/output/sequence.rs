//! The file names of a sequence's frames.

use std::ffi::OsString;
use std::path::PathBuf;

use super::FrameFormat;
use crate::time::Time;

/// The names of a sequence's frame files: `directory/name.0042.png`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Sequence {
    directory: PathBuf,
    /// As the system has it: two names that differ in bytes that are not text are two names.
    name: OsString,
    digits: usize,
    format: FrameFormat,
}

impl Sequence {
    /// Creates the names of a sequence in a directory. Numbers have four digits, or as many as the `last` frame needs.
    #[must_use]
    pub fn new(directory: PathBuf, name: impl Into<OsString>, last: u32, format: FrameFormat) -> Self {
        Self { directory, name: name.into(), digits: last.to_string().len().max(4), format }
    }

    /// Returns the file of frame `index`.
    #[must_use]
    pub fn frame(&self, index: u32) -> PathBuf {
        self.file(&format!("{index:0digits$}", digits = self.digits))
    }

    /// Returns the file of a moment between frames.
    #[must_use]
    pub fn moment(&self, time: Time) -> PathBuf {
        self.file(&format!("at-{}s", time.seconds()))
    }

    /// Returns the file of a sheet of frames.
    #[must_use]
    pub fn sheet(&self) -> PathBuf {
        self.file("sheet")
    }

    /// Returns the file of the settings that were chosen for frames.
    #[must_use]
    pub fn settings(&self) -> PathBuf {
        self.named("settings.json")
    }

    /// Returns the same for the frames of a sheet.
    #[must_use]
    pub fn sheet_settings(&self) -> PathBuf {
        self.named("sheet.settings.json")
    }

    fn file(&self, which: &str) -> PathBuf {
        self.named(&format!("{which}.{}", self.format.extension()))
    }

    fn named(&self, ending: &str) -> PathBuf {
        let mut name = self.name.clone();
        name.push(format!(".{ending}"));
        self.directory.join(name)
    }

    /// Returns the directory of the files.
    #[must_use]
    pub fn directory(&self) -> &std::path::Path {
        &self.directory
    }

    /// Returns the file format.
    #[must_use]
    pub fn format(&self) -> FrameFormat {
        self.format
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_four_digits_or_as_many_as_the_last_needs() {
        let sequence = |last| Sequence::new(PathBuf::from("out"), "sun", last, FrameFormat::Png);
        assert_eq!(sequence(95).frame(7), PathBuf::from("out/sun.0007.png"));
        assert_eq!(sequence(123_456).frame(7), PathBuf::from("out/sun.000007.png"));
        assert_eq!(sequence(95).moment("1.5s".parse().unwrap()), PathBuf::from("out/sun.at-1.5s.png"));
        assert_eq!(sequence(95).sheet(), PathBuf::from("out/sun.sheet.png"));
        assert_eq!(sequence(95).settings(), PathBuf::from("out/sun.settings.json"));
    }
}
