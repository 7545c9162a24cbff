//! File names of a sequence's frames.

use std::ffi::{OsStr, OsString};
use std::fmt;
use std::fs;
use std::io::{self, ErrorKind};
use std::path::PathBuf;
use std::str::FromStr;

use super::FrameFormat;
use crate::time::Time;

/// Default minimum number of digits of a frame number.
const USUAL_DIGITS: usize = 4;

/// The names of a sequence's files. By default, frames are named `directory/name.0042.png`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Sequence {
    directory: PathBuf,
    /// Name in the system's encoding: names that differ in bytes that are not text are different names.
    name: OsString,
    frames: FrameNames,
    format: FrameFormat,
}

/// The names of frame files without extensions: a prefix, the digits of the frame number, and a suffix.
///
/// ```
/// use rayreel::output::FrameNames;
///
/// let names: FrameNames = "shot_####_left".parse()?;
/// assert_eq!(names, "shot_%04d_left".parse()?);
/// assert!(names.have_numbers() && !"hero".parse::<FrameNames>()?.have_numbers());
/// # Ok::<(), rayreel::output::InvalidPattern>(())
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FrameNames {
    before: OsString,
    /// Minimum number of digits; 0 for the name of a single frame, without a number.
    digits: usize,
    after: String,
}

/// The error for a string that does not specify frame names.
#[derive(Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum InvalidPattern {
    /// The text is empty, or does not have exactly one valid place for the number.
    #[error("it takes one place for the frame's number, as #### or %04d")]
    Number,
    /// The number would have too many digits.
    #[error("a frame's number has 10 digits at most")]
    Digits,
    /// The text contains a path separator.
    #[error("it is the name of a file: folders are for --out")]
    Folder,
}

debug_as_message!(InvalidPattern);

impl FromStr for FrameNames {
    type Err = InvalidPattern;

    fn from_str(text: &str) -> Result<Self, InvalidPattern> {
        const MOST: usize = 10;
        if text.contains(['/', '\\']) {
            return Err(InvalidPattern::Folder);
        }
        let Some(start) = text.find(['#', '%']) else {
            let is_name = !text.is_empty();
            let name = Self { before: text.into(), digits: 0, after: String::new() };
            return is_name.then_some(name).ok_or(InvalidPattern::Number);
        };
        let (before, rest) = text.split_at(start);
        let (digits, after) = if let Some(place) = rest.strip_prefix('%') {
            let (digits, after) = place.split_once('d').ok_or(InvalidPattern::Number)?;
            match (digits, digits.strip_prefix('0')) {
                ("", _) => (1, after),
                (_, Some(digits)) => (digits.parse().map_err(|_| InvalidPattern::Number)?, after),
                _ => return Err(InvalidPattern::Number),
            }
        } else {
            let after = rest.trim_start_matches('#');
            (rest.len() - after.len(), after)
        };
        match (after.contains(['#', '%']), digits) {
            (true, _) | (_, 0) => Err(InvalidPattern::Number),
            (_, digits) if digits > MOST => Err(InvalidPattern::Digits),
            _ => Ok(Self { before: before.into(), digits, after: after.to_owned() }),
        }
    }
}

impl FrameNames {
    /// Returns whether each frame has a name with its number. Otherwise, this is the name of a single frame.
    #[must_use]
    pub fn have_numbers(&self) -> bool {
        self.digits > 0
    }
}

impl fmt::Display for FrameNames {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "{}{}{}", self.before.to_string_lossy(), "#".repeat(self.digits), self.after)
    }
}

impl Sequence {
    /// Creates the names of a sequence in a directory. Numbers have four digits, or as many as the `last` frame needs.
    #[must_use]
    pub fn new(directory: PathBuf, name: impl Into<OsString>, last: u32, format: FrameFormat) -> Self {
        let name: OsString = name.into();
        let mut before = name.clone();
        before.push(".");
        let frames =
            FrameNames { before, digits: last.to_string().len().max(USUAL_DIGITS), after: String::new() };
        Self { directory, name, frames, format }
    }

    /// Returns the sequence with other names for frames.
    #[must_use]
    pub fn with_names(self, frames: FrameNames) -> Self {
        Self { frames, ..self }
    }

    /// Returns the path of frame `index`.
    #[must_use]
    pub fn frame(&self, index: u32) -> PathBuf {
        let FrameNames { before, digits, after } = &self.frames;
        let mut name = before.clone();
        if self.frames.have_numbers() {
            name.push(format!("{index:0digits$}"));
        }
        name.push(format!("{after}.{}", self.format.extension()));
        self.directory.join(name)
    }

    /// Returns the number of the frame with this file name, or `None` if it is not the name of a frame.
    #[must_use]
    pub fn frame_of(&self, file_name: &OsStr) -> Option<u32> {
        let FrameNames { before, digits: fewest, after } = &self.frames;
        let name = file_name.as_encoded_bytes().strip_prefix(before.as_encoded_bytes())?;
        let name = std::str::from_utf8(name).ok()?.strip_suffix(self.format.extension())?;
        let digits = name.strip_suffix('.')?.strip_suffix(after.as_str())?;
        let is_long = digits.len() >= USUAL_DIGITS.min(*fewest);
        let is_number = is_long && digits.bytes().all(|byte| byte.is_ascii_digit());
        digits.parse().ok().filter(|_| is_number)
    }

    /// Returns the numbers and paths of the frames in the folder, with any number of digits, sorted by number.
    ///
    /// # Errors
    ///
    /// If the folder cannot be read. A missing folder has no frames.
    pub fn present(&self) -> io::Result<Vec<(u32, PathBuf)>> {
        let entries = match fs::read_dir(super::atomic_file::named(&self.directory)) {
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

    /// Returns the path of a picture at a moment between frames.
    #[must_use]
    pub fn moment(&self, time: Time) -> PathBuf {
        self.file(&format!("at-{}s", time.seconds()))
    }

    /// Returns the path of a sheet of frames.
    #[must_use]
    pub fn sheet(&self) -> PathBuf {
        self.file("sheet")
    }

    /// Returns the path of a sheet of variants of a frame.
    #[must_use]
    pub fn variants(&self) -> PathBuf {
        self.file("variants")
    }

    /// Returns the path of the settings that were chosen for frames.
    #[must_use]
    pub fn settings(&self) -> PathBuf {
        self.named("settings.json")
    }

    /// Returns the path of the settings that were chosen for the frames of a sheet.
    #[must_use]
    pub fn sheet_settings(&self) -> PathBuf {
        self.named("sheet.settings.json")
    }

    /// Returns the path of the manifest, which describes the sources of the frames.
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
    fn frame_numbers_are_parsed_from_names() {
        let folder = tempfile::tempdir().unwrap();
        let sequence = Sequence::new(folder.path().to_owned(), "a.b", 95, FrameFormat::default());
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
        let missing = Sequence::new(folder.path().join("none"), "a", 9, FrameFormat::default());
        assert_eq!(missing.present().unwrap(), []);
    }

    #[test]
    fn frame_name_patterns_are_supported() {
        let named = |names: &str| {
            let sequence = Sequence::new(PathBuf::from("out"), "sun", 95, FrameFormat::default());
            sequence.with_names(names.parse().unwrap())
        };
        for (names, file) in [
            ("a_##_b", "out/a_07_b.png"),
            ("a%03d", "out/a007.png"),
            ("%d", "out/7.png"),
            ("#", "out/7.png"),
            ("a.######", "out/a.000007.png"),
        ] {
            let sequence = named(names);
            assert_eq!(sequence.frame(7), PathBuf::from(file));
            for index in [0, 7, 123, 4_000_000_000] {
                let file = sequence.frame(index);
                assert_eq!(sequence.frame_of(file.file_name().unwrap()), Some(index), "{names}");
            }
            assert_eq!(sequence.sheet(), PathBuf::from("out/sun.sheet.png"));
            let names: FrameNames = names.parse().unwrap();
            assert_eq!(names.to_string().parse(), Ok(names));
        }
        let single = named("hero");
        assert_eq!(single.frame(7), PathBuf::from("out/hero.png"));
        assert_eq!(single.frame_of(OsStr::new("hero.png")), None);
        for (wrong, why) in [
            ("", InvalidPattern::Number),
            ("##_##", InvalidPattern::Number),
            ("%04d%d", InvalidPattern::Number),
            ("%4d", InvalidPattern::Number),
            ("%00d", InvalidPattern::Number),
            ("%04x", InvalidPattern::Number),
            ("%011d", InvalidPattern::Digits),
            ("../####", InvalidPattern::Folder),
            ("a\\####", InvalidPattern::Folder),
        ] {
            assert_eq!(wrong.parse::<FrameNames>(), Err(why), "{wrong}");
        }
    }

    #[test]
    fn numbers_have_four_digits_or_as_many_as_the_last_needs() {
        let sequence = |last| Sequence::new(PathBuf::from("out"), "sun", last, FrameFormat::default());
        assert_eq!(sequence(95).frame(7), PathBuf::from("out/sun.0007.png"));
        assert_eq!(sequence(123_456).frame(7), PathBuf::from("out/sun.000007.png"));
        assert_eq!(sequence(95).moment("1.5s".parse().unwrap()), PathBuf::from("out/sun.at-1.5s.png"));
        assert_eq!(sequence(95).sheet(), PathBuf::from("out/sun.sheet.png"));
        assert_eq!(sequence(95).settings(), PathBuf::from("out/sun.settings.json"));
    }
}
