//! Files that are whole or absent, even if the process that writes them or the machine fails.
//!
//! ```text
//! create under a name of its own -> lock -> write -> sync -> rename -> sync the folder
//! ```
//!
//! The name is random and must not be taken: process ids would be the same in two containers that share a folder. The lock is
//! held until the file has its place, and the system releases it however the process ends. So a partial file that can be locked
//! is a leftover, and one that cannot is in use, in whatever container; where a file system has no locks, none is touched.

use std::fs::{self, DirEntry, File, OpenOptions, TryLockError};
use std::hash::{BuildHasher, Hasher, RandomState};
use std::io::{self, ErrorKind, Write};
use std::path::{Path, PathBuf};

const PREFIX: &str = ".rayreel-";
const SUFFIX: &str = ".partial";

/// Writes a file, replacing one that is there.
pub(super) fn write(path: &Path, bytes: &[u8]) -> io::Result<()> {
    put(path, &[bytes])?;
    settle(path)
}

/// Writes parts of a file, one after the other, as [`write`] does, but if the machine fails, the name may be lost as long as it is
/// not [settled](settle).
pub(super) fn put(path: &Path, parts: &[&[u8]]) -> io::Result<()> {
    PartialFile::filled(folder_of(path), parts)?.replace(path)
}

/// Ensures that the name of a file is on the disk, with all others in its folder, where folders can be synced.
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

/// Writes a file where there is none.
pub(super) fn write_new(path: &Path, bytes: &[u8]) -> io::Result<()> {
    PartialFile::filled(folder_of(path), &[bytes])?.link(path)?;
    settle(path)
}

/// Removes partial files left in a folder by processes that were killed while they wrote. Those of running processes stay, and so
/// does whatever cannot be removed: it does no harm.
pub fn remove_leftovers(folder: &Path) {
    let Ok(entries) = fs::read_dir(named(folder)) else { return };
    for entry in entries.flatten().filter(is_partial) {
        let path = entry.path();
        // Some network file systems lock only what is open for writing.
        let unlocked = OpenOptions::new().write(true).open(&path).ok().filter(|file| file.try_lock().is_ok());
        // The lock is held on: whoever has just created the file sees that it is being removed.
        if unlocked.is_some() {
            let _ = fs::remove_file(&path);
        }
    }
}

/// Returns the folder that a file is in, or would be.
pub fn folder_of(path: &Path) -> &Path {
    named(path.parent().unwrap_or(Path::new("")))
}

/// Returns a folder by name, for the working directory too.
pub(super) fn named(folder: &Path) -> &Path {
    if folder.as_os_str().is_empty() { Path::new(".") } else { folder }
}

fn is_partial(entry: &DirEntry) -> bool {
    let name = entry.file_name();
    let token = name.to_str().and_then(|name| name.strip_prefix(PREFIX)?.strip_suffix(SUFFIX));
    let is_token = |token: &str| token.len() == 16 && token.bytes().all(|byte| byte.is_ascii_hexdigit());
    token.is_some_and(is_token) && entry.file_type().is_ok_and(|kind| kind.is_file())
}

/// A file without a place yet; removed unless it gets one.
#[derive(Debug)]
pub struct PartialFile {
    path: PathBuf,
    file: File,
    placed: bool,
}

impl PartialFile {
    /// Creates one with these bytes, all of them on the disk.
    fn filled(folder: &Path, parts: &[&[u8]]) -> io::Result<Self> {
        let mut partial = Self::create(folder)?;
        for part in parts {
            partial.file.write_all(part)?;
        }
        partial.file.sync_all()?;
        Ok(partial)
    }

    /// Creates an empty one in a folder.
    ///
    /// # Errors
    ///
    /// If the file system refuses.
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

    /// Locks the file, and returns whether it is still there: another process that removes leftovers may have been quicker.
    fn is_kept(&self) -> bool {
        match self.file.try_lock() {
            Ok(()) => self.path.exists(),
            Err(TryLockError::WouldBlock) => false,
            // There are no locks here, and so nobody removes anything.
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
    /// If the file cannot be unlocked on Windows, where locks keep other programs out. There, files that others write cannot be
    /// removed.
    pub fn lend(&self) -> io::Result<&Path> {
        if cfg!(windows) {
            self.file.unlock()?;
        }
        Ok(&self.path)
    }

    /// Gives the file its place, in the same folder, once all of it is on the disk.
    ///
    /// # Errors
    ///
    /// If the file system refuses; nothing is left behind.
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

    /// Links the file into place, as a second name, unlike a new name, can only be given where there is no file.
    fn link(self, path: &Path) -> io::Result<()> {
        match fs::hard_link(&self.path, path) {
            Err(error) if error.kind() != ErrorKind::AlreadyExists => self.claim(path),
            linked => linked,
        }
    }

    /// Takes the place with an empty file first, where files have one name only.
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

/// Returns a number from the system's own randomness, by which hash maps are keyed.
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
    fn leftovers_go_and_what_is_being_written_stays() {
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
        // As the system does, and nothing else.
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
    fn who_writes_while_others_clear_up_writes_all_the_same() {
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
    fn a_new_file_takes_the_place_of_none() {
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
