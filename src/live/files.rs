//! What the files of a scene hold, as far as is needed to see that they hold something else.

use std::collections::BTreeMap;
use std::fs::{self, Metadata};
use std::hash::Hasher;
use std::path::{Path, PathBuf};
use std::time::{Duration, SystemTime};

use crate::scene::input::{self, LARGEST_FILE, Offered};

/// The clock that stamps files may be behind the one that tells the time.
const CLOCK_TICK: Duration = Duration::from_millis(10);
/// Some file systems stamp to two seconds only.
const STAMP_TICK: Duration = Duration::from_secs(2);

/// Links that lead to links may go so far.
const LONGEST_CHAIN: usize = 40;

/// Some files, and what they held when they were last looked at.
#[derive(Debug, Default)]
pub(super) struct Files(BTreeMap<PathBuf, Seen>);

/// A file as it was seen.
#[derive(Clone, Copy, Debug)]
struct Seen {
    stamp: Option<Stamp>,
    content: Content,
    /// Could it have been written again since with the same stamp?
    fresh: bool,
}

/// What a file held.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Content {
    /// Something else than whoever read it may have read: another look finds it changed.
    Unknown,
    /// It cannot be read, or may not be: it is no file, or too large.
    Nothing,
    /// A hash of its bytes.
    Bytes(u64),
}

/// What the file system tells of a file without reading it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Stamp {
    modified: Option<SystemTime>,
    length: u64,
    identity: (u64, u64, i64, i64),
}

impl Files {
    /// Keeps to these files from now on, all of which were read since `since`, and those that were known after the last
    /// [`look`](Self::look). What has been written in the meantime is found changed at the next one: who reads while others
    /// write may have read anything.
    pub(super) fn follow(&mut self, paths: &[PathBuf], since: SystemTime) {
        let before = std::mem::take(&mut self.0);
        for path in paths {
            let (mut seen, written_since) = match before.get(path) {
                Some(seen) => (*seen, seen.stamp != Stamp::now(path)),
                None => {
                    let seen = Seen::now(path);
                    (seen, seen.stamp.is_some_and(|stamp| stamp.latest() + CLOCK_TICK > since))
                }
            };
            if written_since {
                seen.content = Content::Unknown;
            }
            self.0.insert(path.clone(), seen);
        }
    }

    /// What the files hold is not known any more: another look finds them changed.
    pub(super) fn forget(&mut self) {
        for seen in self.0.values_mut() {
            seen.content = Content::Unknown;
        }
    }

    /// What the file system tells of the files now.
    pub(super) fn stamps(&self) -> Vec<Option<Stamp>> {
        self.0.keys().map(|path| Stamp::now(path)).collect()
    }

    /// Does the file system tell of something else? Reads no file.
    pub(super) fn are_touched(&self) -> bool {
        let touched = |(path, seen): (&PathBuf, &Seen)| {
            seen.content == Content::Unknown || seen.stamp != Stamp::now(path)
        };
        self.0.iter().any(touched)
    }

    /// Does any file hold something else though its stamp is the same? Reads those only that were written so recently that their
    /// stamps may not tell. What is being written has another stamp, and is left alone.
    pub(super) fn differ_unstamped(&mut self) -> bool {
        let mut differ = false;
        for (path, seen) in self.0.iter_mut().filter(|(_, seen)| seen.fresh) {
            let now = Seen::now(path);
            if now.stamp == seen.stamp {
                let same = now.content == seen.content;
                *seen = if same { now } else { Seen { content: Content::Unknown, ..now } };
                differ |= !same;
            }
        }
        differ
    }

    /// Reads all files again, and says whether any holds something else.
    pub(super) fn look(&mut self) -> bool {
        let mut differ = false;
        for (path, seen) in &mut self.0 {
            let now = Seen::now(path);
            differ |= now.content != seen.content;
            *seen = now;
        }
        differ
    }

    /// All directories in which something must change for one of the files to change: their own, and those of what they are
    /// links to.
    pub(super) fn directories(&self) -> impl Iterator<Item = PathBuf> {
        self.links().filter_map(|link| link.parent().map(Path::to_owned))
    }

    /// Every file, and every link on the way to one.
    pub(super) fn links(&self) -> impl Iterator<Item = PathBuf> {
        self.0.keys().flat_map(|path| chain(path))
    }
}

impl Seen {
    /// The stamp is taken first: a file that is written in between looks touched.
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
        let content = content.map_or(Content::Nothing, |bytes| Content::Bytes(hash(&bytes)));
        Self { stamp, content, fresh }
    }
}

impl Stamp {
    /// When anything about the file was changed last.
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

/// A file that takes another's place is another, whatever its time and its length.
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

/// The absolute path of a file and, where it is a link, of each file that leads on.
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
            let seen = Seen { content: Content::Bytes(0), fresh, ..Seen::now(&path) };
            let mut files = Files(BTreeMap::from([(path.clone(), seen)]));
            assert!(!files.are_touched());
            assert_eq!(files.differ_unstamped(), expected);
            assert_eq!(files.are_touched(), expected);
            assert!(files.look() && !files.look() && !files.differ_unstamped());
        }
        assert!(Seen::now(&path).fresh);
        let long_ago = SystemTime::now() - 2 * STAMP_TICK;
        let seen = Seen {
            fresh: true,
            stamp: Some(Stamp { modified: Some(long_ago), ..Stamp::now(&path).unwrap() }),
            ..Seen::now(&path)
        };
        // What is being written is left to whoever waits until it is.
        assert!(!Files(BTreeMap::from([(path, seen)])).differ_unstamped());
    }
}
