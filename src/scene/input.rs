//! Safe reading of files named by others, which may be anything: devices, pipes, or files that the system makes up while they are
//! read.

use std::fs::{self, File};
use std::io::{self, Read, Take};
use std::path::Path;

/// The most bytes of a scene file: 1 GiB.
pub(crate) const LARGEST_FILE: u64 = 1 << 30;

/// Whether a file may also be a stream that the program was started with, as `/dev/stdin`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Offered {
    /// It may; the stream can be read only once.
    Accepted,
    /// It must be a file that can be read again.
    Refused,
}

/// The reason why a file cannot be read.
#[derive(Debug, thiserror::Error)]
pub enum InputError {
    /// Reading it might wait for ever, or never end.
    #[error("a device or a pipe is no file")]
    NotAFile,
    /// It has more bytes than this.
    #[error("the file has more than {0} bytes")]
    TooLarge(u64),
    /// The system refuses, as for a directory.
    #[error(transparent)]
    System(#[from] io::Error),
}

/// Opens a file of at most `most` bytes; at most one byte more can be read. Its kind and length are checked before it is opened,
/// since opening a pipe may wait for ever, and opening a device may do anything. Files that the system makes up, as those in
/// `/proc`, are reported to have no bytes, and have none here.
///
/// # Errors
///
/// If it is no file, if it is too large, or if the system refuses.
pub fn open(path: &Path, offered: Offered, most: u64) -> Result<Take<File>, InputError> {
    let limit = most.saturating_add(1);
    let metadata = fs::metadata(path)?;
    if metadata.is_dir() {
        return Err(io::Error::from(io::ErrorKind::IsADirectory).into());
    }
    if !metadata.is_file() {
        let accepted = offered == Offered::Accepted && is_stream(path);
        return if accepted { Ok(File::open(path)?.take(limit)) } else { Err(InputError::NotAFile) };
    }
    if metadata.len() > most {
        return Err(InputError::TooLarge(most));
    }
    let file = File::open(path)?;
    // Another file may have taken its place since.
    if !file.metadata()?.is_file() {
        return Err(InputError::NotAFile);
    }
    Ok(file.take(if metadata.len() == 0 { 0 } else { limit }))
}

/// The name of standard input where a stream is accepted: no file, even if there is one of that name.
const STANDARD_INPUT: &str = "-";

/// Reads the bytes of a file, as opened by [`open`], or of standard input.
///
/// # Errors
///
/// As [`open`], and if it has become too large, or reading fails.
pub fn read(path: &Path, offered: Offered, most: u64) -> Result<Vec<u8>, InputError> {
    let mut bytes = Vec::new();
    if offered == Offered::Accepted && path == Path::new(STANDARD_INPUT) {
        io::stdin().lock().take(most.saturating_add(1)).read_to_end(&mut bytes)?;
    } else {
        open(path, offered, most)?.read_to_end(&mut bytes)?;
    }
    if bytes.len() as u64 > most { Err(InputError::TooLarge(most)) } else { Ok(bytes) }
}

/// Returns whether a path names a stream that the program was started with: `-`, or one of the names that shells give to those. It can
/// be read only once, and by nobody else.
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
    fn files_are_read_up_to_the_most() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("file");
        for length in [0, 1, 9, 10] {
            fs::write(&path, vec![b'a'; length]).unwrap();
            assert_eq!(read(&path, Offered::Refused, 10).unwrap().len(), length);
        }
        fs::write(&path, [b'a'; 11]).unwrap();
        assert!(matches!(read(&path, Offered::Refused, 10), Err(InputError::TooLarge(10))));
        assert!(matches!(read(folder.path(), Offered::Accepted, 10), Err(InputError::System(_))));
        assert!(matches!(
            read(&folder.path().join("none"), Offered::Accepted, 10),
            Err(InputError::System(_))
        ));
    }

    /// Each would be read for ever, or not at all.
    #[cfg(unix)]
    #[test]
    fn what_is_no_file_is_not_opened() {
        let folder = tempfile::tempdir().unwrap();
        let pipe = folder.path().join("pipe");
        assert!(std::process::Command::new("mkfifo").arg(&pipe).status().unwrap().success());
        let link = folder.path().join("link");
        std::os::unix::fs::symlink("/dev/zero", &link).unwrap();
        for path in [pipe.as_path(), &link, Path::new("/dev/zero"), Path::new("/dev/tty")] {
            for offered in [Offered::Accepted, Offered::Refused] {
                let found = read(path, offered, 10);
                assert!(matches!(found, Err(InputError::NotAFile)), "{}: {found:?}", path.display());
            }
        }
        // Its first line would be waited for.
        let made_up = Path::new("/proc/kmsg");
        if made_up.exists() {
            let found = read(made_up, Offered::Refused, 10);
            assert!(found.as_ref().map_or(true, Vec::is_empty), "{found:?}");
        }
    }
}
