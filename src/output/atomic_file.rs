//! Atomic file writes: files are complete or absent, even if the writing process or the machine fails.
//!
//! ```text
//! create under a temporary name -> lock -> write -> sync -> rename -> sync the folder
//! ```
//!
//! The temporary name is random and must be unused, since process ids can coincide in two containers that share a folder. The lock is
//! held until the file is renamed, and the system releases it when the process ends, however it ends. A partial file that can be locked
//! is therefore a leftover, and a partial file that cannot be locked is in use, in any container. If the file system has no locks, no
//! partial files are removed.

use std::fs::{self, DirEntry, File, OpenOptions, TryLockError};
use std::hash::{BuildHasher, Hasher, RandomState};
use std::io::{self, ErrorKind, Write};
use std::path::{Path, PathBuf};

const PREFIX: &str = ".rayreel-";
const SUFFIX: &str = ".partial";

/// Writes a file, replacing an existing one.
pub(super) fn write(path: &Path, bytes: &[u8]) -> io::Result<()> {
    put(path, &[bytes])?;
    settle(path)
}

/// Writes the parts of a file in sequence like [`write`], but a machine failure may lose the file's name until it is [settled](settle).
pub(super) fn put(path: &Path, parts: &[&[u8]]) -> io::Result<()> {
    PartialFile::filled(folder_of(path), parts)?.replace(path)
}

/// Syncs the folder of a file to the disk, with the names of all files in it, where folders can be synced.
pub(super) fn settle(path: &Path) -> io::Result<()> {
    use ErrorKind::{InvalidInput, PermissionDenied, Unsupported};
    if cfg!(not(unix)) {
        return Ok(());
    }
    match File::open(folder_of(path)).and_then(|folder| folder.sync_all()) {
        Err(error) if [InvalidInput, PermissionDenied, Unsupported].contains(&error.kind()) => Ok(()),
        synced => synced,
    }
}

/// Writes a file that must not exist yet.
pub(super) fn write_new(path: &Path, bytes: &[u8]) -> io::Result<()> {
    PartialFile::filled(folder_of(path), &[bytes])?.link(path)?;
    settle(path)
}

/// Removes partial files left in a folder by processes that were killed while writing. Files of running processes are kept, and so are
/// files that cannot be removed, which do no harm.
pub fn remove_leftovers(folder: &Path) {
    let Ok(entries) = fs::read_dir(named(folder)) else { return };
    for entry in entries.flatten().filter(is_partial) {
        let path = entry.path();
        // Some network file systems lock only files that are open for writing.
        let unlocked = OpenOptions::new().write(true).open(&path).ok().filter(|file| file.try_lock().is_ok());
        // The lock is still held, so that a process that has just created the file notices its removal.
        if unlocked.is_some() {
            let _ = fs::remove_file(&path);
        }
    }
}

/// Returns the folder of a file, which need not exist.
pub fn folder_of(path: &Path) -> &Path {
    named(path.parent().unwrap_or(Path::new("")))
}

/// Returns the path of a folder; `.` if the path is empty.
pub(super) fn named(folder: &Path) -> &Path {
    if folder.as_os_str().is_empty() { Path::new(".") } else { folder }
}

fn is_partial(entry: &DirEntry) -> bool {
    let name = entry.file_name();
    let token = name.to_str().and_then(|name| name.strip_prefix(PREFIX)?.strip_suffix(SUFFIX));
    let is_token = |token: &str| token.len() == 16 && token.bytes().all(|byte| byte.is_ascii_hexdigit());
    token.is_some_and(is_token) && entry.file_type().is_ok_and(|kind| kind.is_file())
}

/// A temporary file, which is removed unless it is renamed to its final path.
#[derive(Debug)]
pub struct PartialFile {
    path: PathBuf,
    file: File,
    placed: bool,
}

impl PartialFile {
    /// Creates a file from `parts` and syncs all bytes to the disk.
    fn filled(folder: &Path, parts: &[&[u8]]) -> io::Result<Self> {
        let mut partial = Self::create(folder)?;
        for part in parts {
            partial.file.write_all(part)?;
        }
        partial.file.sync_all()?;
        Ok(partial)
    }

    /// Creates an empty file in a folder.
    ///
    /// # Errors
    ///
    /// If the file system reports an error.
    pub fn create(folder: &Path) -> io::Result<Self> {
        loop {
            let path = folder.join(format!("{PREFIX}{:016x}{SUFFIX}", random()));
            match File::create_new(&path) {
                Ok(file) => {
                    let partial = Self { path, file, placed: false };
                    if partial.is_kept() {
                        return Ok(partial);
                    }
                }
                Err(error) if error.kind() == ErrorKind::AlreadyExists => {}
                Err(error) => return Err(error),
            }
        }
    }

    /// Locks the file, and returns whether it still exists. Another process may have removed it as a leftover.
    fn is_kept(&self) -> bool {
        match self.file.try_lock() {
            Ok(()) => self.path.exists(),
            Err(TryLockError::WouldBlock) => false,
            // Without locks, no process removes leftovers.
            Err(TryLockError::Error(_)) => true,
        }
    }

    /// Returns the open file.
    #[must_use]
    pub fn file(&self) -> &File {
        &self.file
    }

    /// Returns the path at which another program may write the file.
    ///
    /// # Errors
    ///
    /// If the file cannot be unlocked on Windows, where locks exclude other programs. There, files that other programs write cannot be
    /// removed.
    pub fn lend(&self) -> io::Result<&Path> {
        if cfg!(windows) {
            self.file.unlock()?;
        }
        Ok(&self.path)
    }

    /// Syncs the file to the disk and renames it to its final path in the same folder.
    ///
    /// # Errors
    ///
    /// If the file system reports an error. No partial file remains.
    pub fn place(self, path: &Path) -> io::Result<()> {
        self.file.sync_all()?;
        self.replace(path)?;
        settle(path)
    }

    fn replace(mut self, path: &Path) -> io::Result<()> {
        fs::rename(&self.path, path)?;
        self.placed = true;
        Ok(())
    }

    /// Links the file to its final path. Unlike a rename, a link fails if a file exists there.
    fn link(self, path: &Path) -> io::Result<()> {
        match fs::hard_link(&self.path, path) {
            Err(error) if error.kind() != ErrorKind::AlreadyExists => self.claim(path),
            linked => linked,
        }
    }

    /// Reserves the final path with an empty file and then renames the file, for file systems without hard links.
    fn claim(self, path: &Path) -> io::Result<()> {
        drop(File::create_new(path)?);
        self.replace(path).inspect_err(|_| {
            let _ = fs::remove_file(path);
        })
    }
}

impl Drop for PartialFile {
    fn drop(&mut self) {
        if !self.placed {
            let _ = fs::remove_file(&self.path);
        }
    }
}

/// Returns a random number from the system's random keys for hash maps.
fn random() -> u64 {
    RandomState::new().build_hasher().finish()
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicBool, Ordering};
    use std::thread;

    use super::*;

    fn names(folder: &Path) -> Vec<String> {
        let entries = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap());
        let mut names: Vec<_> = entries.map(|entry| entry.file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }

    #[test]
    fn partial_files_are_removed_except_locked_ones() {
        let folder = tempfile::tempdir().unwrap();
        let folder = folder.path();
        let others = [
            ".rayreel-0123456789abcdef.png",
            ".rayreel-0123456789abcdeg.partial",
            ".rayreel-012345.partial",
            "rayreel-0123456789abcdef.partial",
        ];
        for name in others {
            fs::write(folder.join(name), "").unwrap();
        }
        fs::create_dir(folder.join(".rayreel-00000000000000aa.partial")).unwrap();
        let before = names(folder);
        let lives = PartialFile::filled(folder, &[b"half"]).unwrap();
        let killed = PartialFile::create(folder).unwrap();
        // Simulates the system after a killed process.
        killed.file.unlock().unwrap();
        std::mem::forget(killed);
        assert_eq!(names(folder).len(), before.len() + 2);

        remove_leftovers(folder);
        assert_eq!(names(folder).len(), before.len() + 1);
        lives.replace(&folder.join("whole")).unwrap();
        assert_eq!(fs::read(folder.join("whole")).unwrap(), b"half");
        remove_leftovers(folder);
        assert_eq!(names(folder).len(), before.len() + 1);
        fs::remove_file(folder.join("whole")).unwrap();
        assert_eq!(names(folder), before);
    }

    #[test]
    fn concurrent_cleanup_does_not_disturb_writers() {
        let folder = tempfile::tempdir().unwrap();
        let (folder, done) = (folder.path(), AtomicBool::new(false));
        thread::scope(|scope| {
            for _ in 0..2 {
                scope.spawn(|| {
                    while !done.load(Ordering::Relaxed) {
                        remove_leftovers(folder);
                    }
                });
            }
            let writers: Vec<_> = (0..2_u8)
                .map(|writer| {
                    scope.spawn(move || {
                        for frame in 0..200 {
                            write(&folder.join(format!("{frame}")), &[writer; 100]).unwrap();
                        }
                    })
                })
                .collect();
            let written: Vec<_> = writers.into_iter().map(thread::ScopedJoinHandle::join).collect();
            done.store(true, Ordering::Relaxed);
            assert!(written.iter().all(Result::is_ok));
        });
        assert_eq!(names(folder).len(), 200);
        for name in names(folder) {
            let bytes = fs::read(folder.join(name)).unwrap();
            assert!([[0; 100], [1; 100]].iter().any(|whole| bytes == whole));
        }
    }

    #[test]
    fn new_files_never_overwrite() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("scene.ron");
        write_new(&path, b"first").unwrap();
        assert_eq!(write_new(&path, b"second").unwrap_err().kind(), ErrorKind::AlreadyExists);
        let claim = |path: &Path| PartialFile::filled(folder_of(path), &[b"third"]).unwrap().claim(path);
        assert_eq!(claim(&path).unwrap_err().kind(), ErrorKind::AlreadyExists);
        assert_eq!(fs::read(&path).unwrap(), b"first");
        claim(&folder.path().join("other.ron")).unwrap();
        assert_eq!(names(folder.path()), ["other.ron", "scene.ron"]);
    }
}
