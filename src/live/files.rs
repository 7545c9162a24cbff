//! The known contents of a scene's files, as far as needed to detect a change.

use std::collections::BTreeMap;
use std::fs::{self, Metadata};
use std::hash::Hasher;
use std::path::{Path, PathBuf};
use std::time::{Duration, SystemTime};

use crate::scene::input::{self, LARGEST_FILE, Offered};

/// The clock that stamps files may lag behind the system clock by this much.
const CLOCK_TICK: Duration = Duration::from_millis(10);
/// The coarsest resolution of modification times on common file systems.
const STAMP_TICK: Duration = Duration::from_secs(2);

/// The longest chain of symbolic links that is followed.
const LONGEST_CHAIN: usize = 40;

/// Files with their contents at the last look.
#[derive(Debug, Default)]
pub(super) struct WatchedFiles(BTreeMap<PathBuf, KnownFile>);

/// A file at the last look.
#[derive(Clone, Copy, Debug)]
struct KnownFile {
    stamp: Option<Stamp>,
    content: KnownContent,
    /// Whether it may have been written again since with the same stamp.
    fresh: bool,
}

/// The content of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum KnownContent {
    /// Not known to be what the reader of the file got: the next look finds it changed.
    Unknown,
    /// None: it cannot be read, is no regular file, or is too large.
    Nothing,
    /// A hash of its bytes.
    Bytes(u64),
}

/// The metadata of a file, which tell of most changes without reading it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Stamp {
    modified: Option<SystemTime>,
    length: u64,
    identity: (u64, u64, i64, i64),
}

impl WatchedFiles {
    /// Keeps to `paths` from now on. All of them were read since `since`, and those already known after the last
    /// [`look`](Self::look). Files written in the meantime are found changed at the next look, as their readers may have read
    /// anything.
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

    /// Forgets the contents: the next look finds all files changed.
    pub(super) fn forget(&mut self) {
        for seen in self.0.values_mut() {
            seen.content = KnownContent::Unknown;
        }
    }

    /// Returns the current stamps of the files.
    pub(super) fn stamps(&self) -> Vec<Option<Stamp>> {
        self.0.keys().map(|path| Stamp::now(path)).collect()
    }

    /// Returns whether any stamp has changed, without reading a file.
    pub(super) fn are_touched(&self) -> bool {
        let touched = |(path, seen): (&PathBuf, &KnownFile)| {
            seen.content == KnownContent::Unknown || seen.stamp != Stamp::now(path)
        };
        self.0.iter().any(touched)
    }

    /// Returns whether any content has changed under an unchanged stamp. Reads only files written so recently that their stamps
    /// may not tell. A file that is being written has another stamp, and is left alone.
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

    /// Reads all files again; returns whether any content has changed.
    pub(super) fn look(&mut self) -> bool {
        let mut differ = false;
        for (path, seen) in &mut self.0 {
            let now = KnownFile::now(path);
            differ |= now.content != seen.content;
            *seen = now;
        }
        differ
    }

    /// Returns the directories in which something must change for one of the files to change: their own, and those of the files
    /// that links lead to.
    pub(super) fn directories(&self) -> impl Iterator<Item = PathBuf> {
        self.links().filter_map(|link| link.parent().map(Path::to_owned))
    }

    /// Returns every file, and every link on the way to one.
    pub(super) fn links(&self) -> impl Iterator<Item = PathBuf> {
        self.0.keys().flat_map(|path| chain(path))
    }
}

impl KnownFile {
    /// Looks at a file. The stamp is taken first, so that a file written in between looks touched.
    fn now(path: &Path) -> Self {
        let stamp = Stamp::now(path);
        let fresh = stamp.is_some_and(|stamp| {
            let now = SystemTime::now();
            let apart = |later: SystemTime, earlier| later.duration_since(earlier).ok();
            apart(now, stamp.latest())
                .or_else(|| apart(stamp.latest(), now))
                .is_some_and(|age| age < STAMP_TICK)
        });
        let content = input::read(path, Offered::Refused, LARGEST_FILE);
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

/// Returns what tells a file apart from another one put in its place, whatever their times and lengths.
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

/// Returns the absolute path of a file and, where it is a link, of each file on the way to its target.
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
            // As if it had held something else a moment ago, and its stamp had been the same.
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
        // What is being written is left to whoever waits until it is.
        assert!(!WatchedFiles(BTreeMap::from([(path, seen)])).differ_unstamped());
    }
}
