//! The file names of a sequence's frames.

use std::ffi::{OsStr, OsString};
use std::fs;
use std::io::{self, ErrorKind};
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

    /// Returns the number of the frame whose file has this name. `None` if no frame's has.
    #[must_use]
    pub fn frame_of(&self, file_name: &OsStr) -> Option<u32> {
        let name = file_name.as_encoded_bytes().strip_prefix(self.name.as_encoded_bytes())?;
        let digits =
            std::str::from_utf8(name).ok()?.strip_prefix('.')?.strip_suffix(self.format.extension())?;
        let digits = digits.strip_suffix('.')?;
        let is_number = digits.len() >= 4 && digits.bytes().all(|byte| byte.is_ascii_digit());
        digits.parse().ok().filter(|_| is_number)
    }

    /// Returns the frames of this name that are in the folder, in any number of digits, by their numbers.
    ///
    /// # Errors
    ///
    /// If the folder cannot be read. One that is not there has no frames.
    pub fn present(&self) -> io::Result<Vec<(u32, PathBuf)>> {
        let entries = match fs::read_dir(super::whole_file::named(&self.directory)) {
            Err(error) if error.kind() == ErrorKind::NotFound => return Ok(Vec::new()),
            entries => entries?,
        };
        let mut present = Vec::new();
        for entry in entries {
            let name = entry?.file_name();
            if let Some(frame) = self.frame_of(&name) {
                present.push((frame, self.directory.join(name)));
            }
        }
        present.sort();
        Ok(present)
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

    /// Returns the file that says what frames are rendered from.
    #[must_use]
    pub fn manifest(&self) -> PathBuf {
        self.named("sequence.json")
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
    fn frames_are_known_by_their_names() {
        let folder = tempfile::tempdir().unwrap();
        let sequence = Sequence::new(folder.path().to_owned(), "a.b", 95, FrameFormat::Png);
        assert_eq!(sequence.present().unwrap(), []);
        for name in
            ["a.b.0003.png", "a.b.00012.png", "a.b.003.png", "a.b.0004.ppm", "a.0001.png", "a.b.at-1s.png"]
        {
            fs::write(folder.path().join(name), "").unwrap();
        }
        let present = sequence.present().unwrap();
        assert_eq!(
            present,
            [3, 12].map(|frame| match frame {
                3 => (3, folder.path().join("a.b.0003.png")),
                _ => (12, folder.path().join("a.b.00012.png")),
            })
        );
        let gone = Sequence::new(folder.path().join("none"), "a", 9, FrameFormat::Png);
        assert_eq!(gone.present().unwrap(), []);
    }

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
