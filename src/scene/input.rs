//! Safe reading of files at arbitrary paths. A path may name a device, a pipe, or a virtual file whose content the system generates on
//! reading.

use std::collections::HashSet;
use std::fs::{self, File};
use std::io::{self, Read, Take};
use std::path::{Path, PathBuf};

/// Maximum size of a scene file: 1 GiB.
pub const LARGEST_FILE: u64 = 1 << 30;

/// Policy for paths that name an input stream of the process, such as `/dev/stdin`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum InputKind {
    /// A stream is accepted. It can be read only once.
    Accepted,
    /// A stream is rejected; only a file that can be read again is accepted.
    Refused,
}

/// An error in opening or reading a file.
#[derive(thiserror::Error)]
pub enum InputError {
    /// The path names a device or a pipe. Reading it could block forever, or never end.
    #[error("a device or a pipe is no file")]
    NotAFile,
    /// The file exceeds this number of bytes.
    #[error("the file has more than {0} bytes")]
    TooLarge(u64),
    /// An error of the operating system, for example for a directory.
    #[error(transparent)]
    System(#[from] io::Error),
}

debug_as_message!(InputError);

/// The files that were looked for while a scene was read.
#[derive(Clone, Debug, Default)]
pub(super) struct InputFiles {
    /// The paths, including those of missing files.
    pub(super) paths: Vec<PathBuf>,
    /// The keys of the scene files among them.
    keys: HashSet<PathBuf>,
    /// True if a file exists but could not be read. It may become readable without being changed.
    pub(super) is_transient: bool,
}

impl InputFiles {
    /// Adds the path of a scene file, and returns the key of the file: its canonical path, or `path` if it has none.
    pub(super) fn add(&mut self, path: &Path) -> PathBuf {
        let key = fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
        if self.keys.insert(key.clone()) {
            self.paths.push(path.to_owned());
        }
        key
    }

    /// Reads a file like [`read`], and records whether a failure is transient.
    pub(super) fn read(&mut self, path: &Path, offered: InputKind, most: u64) -> Result<Vec<u8>, InputError> {
        let content = read(path, offered, most);
        self.is_transient |= matches!(content, Err(InputError::System(_))) && path.is_file();
        content
    }
}

/// Opens a file of at most `most` bytes; at most one byte more can be read. Type and length are checked before the file is opened, because
/// opening a pipe may block forever and opening a device may have side effects. Virtual files, such as those in `/proc`, report a length of
/// 0 and are read as empty.
///
/// # Errors
///
/// Returns an error if the path does not name a file, if the file is too large, or if a system call fails.
pub fn open(path: &Path, offered: InputKind, most: u64) -> Result<Take<File>, InputError> {
    let limit = most.saturating_add(1);
    let metadata = fs::metadata(path)?;
    if metadata.is_dir() {
        return Err(io::Error::from(io::ErrorKind::IsADirectory).into());
    }
    if !metadata.is_file() {
        let accepted = offered == InputKind::Accepted && is_stream(path);
        return if accepted { Ok(File::open(path)?.take(limit)) } else { Err(InputError::NotAFile) };
    }
    if metadata.len() > most {
        return Err(InputError::TooLarge(most));
    }
    let file = File::open(path)?;
    // The file may have been replaced since.
    if !file.metadata()?.is_file() {
        return Err(InputError::NotAFile);
    }
    Ok(file.take(if metadata.len() == 0 { 0 } else { limit }))
}

/// The path that denotes standard input where streams are accepted, even if a file of that name exists.
const STANDARD_INPUT: &str = "-";

/// Reads the bytes of a file, as opened by [`open`], or of standard input.
///
/// # Errors
///
/// As for [`open`]; also if the content exceeds `most` bytes, or if reading fails.
pub fn read(path: &Path, offered: InputKind, most: u64) -> Result<Vec<u8>, InputError> {
    let mut bytes = Vec::new();
    if offered == InputKind::Accepted && path == Path::new(STANDARD_INPUT) {
        io::stdin().lock().take(most.saturating_add(1)).read_to_end(&mut bytes)?;
    } else {
        open(path, offered, most)?.read_to_end(&mut bytes)?;
    }
    if bytes.len() as u64 > most { Err(InputError::TooLarge(most)) } else { Ok(bytes) }
}

/// Returns whether a path names an input stream of the process: `-`, `/dev/stdin`, or a file in `/dev/fd` or `/proc/self/fd`. A stream can
/// be read only once, and only by this process.
#[must_use]
pub fn is_stream(path: &Path) -> bool {
    let streams = [STANDARD_INPUT, "/dev/stdin"];
    let folders = ["/dev/fd", "/proc/self/fd"];
    streams.iter().any(|stream| path == Path::new(stream))
        || folders.iter().any(|folder| path.parent() == Some(Path::new(folder)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_are_read_up_to_the_limit() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("file");
        for length in [0, 1, 9, 10] {
            fs::write(&path, vec![b'a'; length]).unwrap();
            assert_eq!(read(&path, InputKind::Refused, 10).unwrap().len(), length);
        }
        fs::write(&path, [b'a'; 11]).unwrap();
        assert!(matches!(read(&path, InputKind::Refused, 10), Err(InputError::TooLarge(10))));
        assert!(matches!(read(folder.path(), InputKind::Accepted, 10), Err(InputError::System(_))));
        assert!(matches!(
            read(&folder.path().join("none"), InputKind::Accepted, 10),
            Err(InputError::System(_))
        ));
    }

    /// Reading any of these paths would block or never end.
    #[cfg(unix)]
    #[test]
    fn irregular_files_are_not_opened() {
        let folder = tempfile::tempdir().unwrap();
        let pipe = folder.path().join("pipe");
        assert!(std::process::Command::new("mkfifo").arg(&pipe).status().unwrap().success());
        let link = folder.path().join("link");
        std::os::unix::fs::symlink("/dev/zero", &link).unwrap();
        for path in [pipe.as_path(), &link, Path::new("/dev/zero"), Path::new("/dev/tty")] {
            for offered in [InputKind::Accepted, InputKind::Refused] {
                let found = read(path, offered, 10);
                assert!(matches!(found, Err(InputError::NotAFile)), "{}: {found:?}", path.display());
            }
        }
        // Reading it would block until a first line arrives.
        let made_up = Path::new("/proc/kmsg");
        if made_up.exists() {
            let found = read(made_up, InputKind::Refused, 10);
            assert!(found.as_ref().map_or(true, Vec::is_empty), "{found:?}");
        }
    }
}
