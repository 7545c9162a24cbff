//! Known contents of a scene's files, for change detection.

use std::collections::BTreeMap;
use std::fs::{self, Metadata};
use std::hash::Hasher;
use std::path::{Path, PathBuf};
use std::time::{Duration, SystemTime};

use crate::scene::input::{self, InputKind, LARGEST_FILE};

/// Maximum lag of file timestamps behind the system clock.
const CLOCK_TICK: Duration = Duration::from_millis(10);
/// Coarsest resolution of modification times on common file systems.
const STAMP_TICK: Duration = Duration::from_secs(2);

/// Maximum length of a chain of symbolic links that is followed.
const LONGEST_CHAIN: usize = 40;

/// Files and their contents at the last check.
#[derive(Debug, Default)]
pub(super) struct WatchedFiles(BTreeMap<PathBuf, KnownFile>);

/// A file at the last check.
#[derive(Clone, Copy, Debug)]
struct KnownFile {
    stamp: Option<Stamp>,
    content: KnownContent,
    /// True if the file may have been written since then with the same stamp.
    fresh: bool,
}

/// The content of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum KnownContent {
    /// Not known to match what the reader of the file got. The next check reports a change.
    Unknown,
    /// No content: the file is unreadable, too large, or not a regular file.
    Nothing,
    /// Hash of the file's bytes.
    Bytes(u64),
}

/// The metadata of a file, which reveals most changes without reading the file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Stamp {
    modified: Option<SystemTime>,
    length: u64,
    identity: (u64, u64, i64, i64),
}

impl WatchedFiles {
    /// Replaces the files by `paths`. All of them have been read since `since`, and those already known have been read after the last
    /// [`look`](Self::look). Files written in the meantime count as changed at the next check, since it is unknown what their readers
    /// got.
    pub(super) fn follow(&mut self, paths: &[PathBuf], since: SystemTime) {
        let before = std::mem::take(&mut self.0);
        for path in paths {
            let (mut seen, written_since) = match before.get(path) {
                Some(seen) => (*seen, seen.stamp != Stamp::now(path)),
                None => {
                    let seen = KnownFile::now(path);
                    (seen, seen.stamp.is_some_and(|stamp| stamp.latest() + CLOCK_TICK > since))
                }
            };
            if written_since {
                seen.content = KnownContent::Unknown;
            }
            self.0.insert(path.clone(), seen);
        }
    }

    /// Discards the known contents. The next check reports all files as changed.
    pub(super) fn forget(&mut self) {
        for seen in self.0.values_mut() {
            seen.content = KnownContent::Unknown;
        }
    }

    /// Returns the current stamps of the files.
    pub(super) fn stamps(&self) -> Vec<Option<Stamp>> {
        self.0.keys().map(|path| Stamp::now(path)).collect()
    }

    /// Returns whether any stamp has changed or any content is unknown. Reads no files.
    pub(super) fn are_touched(&self) -> bool {
        let touched = |(path, seen): (&PathBuf, &KnownFile)| {
            seen.content == KnownContent::Unknown || seen.stamp != Stamp::now(path)
        };
        self.0.iter().any(touched)
    }

    /// Returns whether any content has changed under an unchanged stamp. Reads only files written so recently that their stamps may hide
    /// a change. Skips files whose stamps have changed, since they may still be being written.
    pub(super) fn differ_unstamped(&mut self) -> bool {
        let mut differ = false;
        for (path, seen) in self.0.iter_mut().filter(|(_, seen)| seen.fresh) {
            let now = KnownFile::now(path);
            if now.stamp == seen.stamp {
                let same = now.content == seen.content;
                *seen = if same { now } else { KnownFile { content: KnownContent::Unknown, ..now } };
                differ |= !same;
            }
        }
        differ
    }

    /// Reads all files again. Returns whether any content has changed.
    pub(super) fn look(&mut self) -> bool {
        let mut differ = false;
        for (path, seen) in &mut self.0 {
            let now = KnownFile::now(path);
            differ |= now.content != seen.content;
            *seen = now;
        }
        differ
    }

    /// Returns the directories to watch for changes: the parents of the files, and the parents of all link targets.
    pub(super) fn directories(&self) -> impl Iterator<Item = PathBuf> {
        self.links().filter_map(|link| link.parent().map(Path::to_owned))
    }

    /// Returns the paths of all files, including each link on the way to its target.
    pub(super) fn links(&self) -> impl Iterator<Item = PathBuf> {
        self.0.keys().flat_map(|path| chain(path))
    }
}

impl KnownFile {
    /// Reads the current state of a file. The stamp is taken first, so that a write in between is detected as a change of the stamp.
    fn now(path: &Path) -> Self {
        let stamp = Stamp::now(path);
        let fresh = stamp.is_some_and(|stamp| {
            let now = SystemTime::now();
            let apart = |later: SystemTime, earlier| later.duration_since(earlier).ok();
            apart(now, stamp.latest())
                .or_else(|| apart(stamp.latest(), now))
                .is_some_and(|age| age < STAMP_TICK)
        });
        let content = input::read(path, InputKind::Refused, LARGEST_FILE);
        let content = content.map_or(KnownContent::Nothing, |bytes| KnownContent::Bytes(hash(&bytes)));
        Self { stamp, content, fresh }
    }
}

impl Stamp {
    /// Returns the time of the last change to the file or its metadata.
    fn latest(&self) -> SystemTime {
        let (.., seconds, nanoseconds) = self.identity;
        let changed = u64::try_from(seconds).unwrap_or(0);
        let changed = Duration::new(changed, u32::try_from(nanoseconds).unwrap_or(0));
        (SystemTime::UNIX_EPOCH + changed).max(self.modified.unwrap_or(SystemTime::UNIX_EPOCH))
    }

    fn now(path: &Path) -> Option<Self> {
        let metadata = fs::metadata(path).ok()?;
        Some(Self {
            modified: metadata.modified().ok(),
            length: metadata.len(),
            identity: identity(&metadata),
        })
    }
}

/// Returns values that distinguish a file from a replacement with the same times and length.
#[cfg(unix)]
fn identity(metadata: &Metadata) -> (u64, u64, i64, i64) {
    use std::os::unix::fs::MetadataExt;
    (metadata.dev(), metadata.ino(), metadata.ctime(), metadata.ctime_nsec())
}

#[cfg(not(unix))]
fn identity(_: &Metadata) -> (u64, u64, i64, i64) {
    (0, 0, 0, 0)
}

fn hash(bytes: &[u8]) -> u64 {
    let mut hasher = std::hash::DefaultHasher::new();
    hasher.write(bytes);
    hasher.finish()
}

/// Returns the absolute path of a file and, if it is a link, the path of each file on the way to its target.
fn chain(path: &Path) -> Vec<PathBuf> {
    let mut chain: Vec<PathBuf> = std::path::absolute(path).into_iter().collect();
    while chain.len() < LONGEST_CHAIN
        && let Some(last) = chain.last()
        && let Ok(target) = fs::read_link(last)
    {
        let next = last.parent().unwrap_or(Path::new("")).join(target);
        chain.push(next);
    }
    // The folder itself may be a link.
    chain.extend(fs::canonicalize(path));
    chain
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_stamps_do_not_tell_is_found_while_it_may_be_so() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("ball.ron");
        fs::write(&path, "first").unwrap();
        for (fresh, expected) in [(false, false), (true, true)] {
            // Simulates a file whose content has just changed under the same stamp.
            let seen = KnownFile { content: KnownContent::Bytes(0), fresh, ..KnownFile::now(&path) };
            let mut files = WatchedFiles(BTreeMap::from([(path.clone(), seen)]));
            assert!(!files.are_touched());
            assert_eq!(files.differ_unstamped(), expected);
            assert_eq!(files.are_touched(), expected);
            assert!(files.look() && !files.look() && !files.differ_unstamped());
        }
        assert!(KnownFile::now(&path).fresh);
        let long_ago = SystemTime::now() - 2 * STAMP_TICK;
        let seen = KnownFile {
            fresh: true,
            stamp: Some(Stamp { modified: Some(long_ago), ..Stamp::now(&path).unwrap() }),
            ..KnownFile::now(&path)
        };
        // Files that are being written are skipped.
        assert!(!WatchedFiles(BTreeMap::from([(path, seen)])).differ_unstamped());
    }
}
