//! Detection of changes in the contents of files.
//!
//! Directories are watched instead of files, since an editor that saves by renaming replaces the watched file. Events of the system only
//! trigger a check: files are read, and their contents compared. The files are also checked regularly without an event, for changes that
//! the system does not report: a folder that was missing for a while, a link within the path, an overflowing queue.
//!
//! The watcher implements the quiet period itself, without a debouncer. A debouncer that passes an event on when it is 25 ms old, as
//! notify-debouncer-full does, does not wait for quiet, and its ordering of events is irrelevant when contents are compared.

use std::collections::{BTreeMap, BTreeSet};
use std::ffi::OsString;
use std::fs::{self, Metadata};
use std::hash::Hasher;
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant, SystemTime};

use notify::{EventKind, RecommendedWatcher, RecursiveMode};

use crate::scene::input::{self, InputKind, LARGEST_FILE};

/// Time without events after which a save counts as complete. Editors write, rename and back up within a few milliseconds. The time is
/// part of the delay of every picture: 25 of some 57 ms until a coarse one.
pub const QUIET_PERIOD: Duration = Duration::from_millis(25);
/// Time after which files that keep changing are checked nevertheless, for a dozen reloads per second. Of 290 saves in
/// 5 s, 20 were shown with 500 ms, and 118 with 75 ms.
const MAX_BATCH: Duration = Duration::from_millis(75);
/// Interval between checks of the files if the system reports changes. Only rare changes wait for it, and a check costs a system call per
/// file.
const RESCAN_INTERVAL: Duration = Duration::from_millis(500);
/// Interval between checks of the files if the system does not report changes. Every change waits for it.
const POLL_INTERVAL: Duration = Duration::from_millis(100);
/// Maximum lag of file timestamps behind the system clock: one tick of a kernel that runs at 100 Hz.
const CLOCK_TICK: Duration = Duration::from_millis(10);
/// Coarsest resolution of modification times on common file systems: FAT.
const STAMP_TICK: Duration = Duration::from_secs(2);
/// Maximum length of a chain of symbolic links that is followed, as in Linux.
const LONGEST_CHAIN: usize = 40;

/// The method of detecting changes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Watching {
    /// The system reports changes.
    #[default]
    Events,
    /// The files are checked ten times a second, for network mounts, which report no changes.
    Polling,
}

/// A watcher of files, which runs on a separate thread until it is dropped.
#[derive(Debug)]
pub struct Watcher {
    files: Arc<Mutex<WatchedFiles>>,
    messages: Sender<WatcherMessage>,
    thread: Option<JoinHandle<()>>,
}

#[derive(Debug)]
enum WatcherMessage {
    Notified(notify::Result<notify::Event>),
    /// The set of watched files has changed.
    FilesChanged,
    Stop,
}

impl Watcher {
    /// Starts a watcher without files. It calls `changed` once after every save that changes the content of a watched file.
    #[must_use]
    pub fn start(watching: Watching, changed: impl FnMut() + Send + 'static) -> Self {
        let (messages, inbox) = channel();
        let notify = messages.clone();
        let files = Arc::<Mutex<WatchedFiles>>::default();
        let shared = Arc::clone(&files);
        let thread = thread::spawn(move || {
            // If the system reports nothing, the files are polled.
            let notifier = match watching {
                Watching::Events => notify::recommended_watcher(move |event| {
                    let _ = notify.send(WatcherMessage::Notified(event));
                })
                .ok(),
                Watching::Polling => None,
            };
            let thread = WatcherThread {
                inbox,
                notifier,
                files: shared,
                directories: BTreeSet::new(),
                names: BTreeSet::new(),
                changed: Box::new(changed),
            };
            thread.run();
        });
        Self { files, messages, thread: Some(thread) }
    }

    /// Checks the files for a caller that is about to read them, so that earlier writes cause no call. Returns whether any content has
    /// changed since the last check.
    pub fn check(&self) -> bool {
        lock(&self.files).check()
    }

    /// Watches these files from now on, whether they exist or not. They have been read since `since`, and those already known have been
    /// read after a [`check`](Self::check). Writes in the meantime count as changes.
    pub fn follow(&self, files: &[PathBuf], since: SystemTime) {
        lock(&self.files).follow(files, since);
        let _ = self.messages.send(WatcherMessage::FilesChanged);
    }

    /// Returns the stamps of the files, or `None` if the files have been written since the last check.
    pub(super) fn stamps(&self) -> Option<Vec<Option<Stamp>>> {
        let files = lock(&self.files);
        (!files.are_touched()).then(|| files.0.values().map(|known| known.stamp).collect())
    }

    /// Discards the known contents of the files. They could not be read, which may change without any event.
    pub(super) fn mark_unknown(&self) {
        lock(&self.files).mark_unknown();
    }
}

impl Drop for Watcher {
    fn drop(&mut self) {
        let _ = self.messages.send(WatcherMessage::Stop);
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

fn lock(files: &Mutex<WatchedFiles>) -> MutexGuard<'_, WatchedFiles> {
    files.lock().unwrap_or_else(PoisonError::into_inner)
}

/// The state of the watcher's thread.
struct WatcherThread {
    inbox: Receiver<WatcherMessage>,
    notifier: Option<RecommendedWatcher>,
    files: Arc<Mutex<WatchedFiles>>,
    /// The watched directories.
    directories: BTreeSet<PathBuf>,
    /// Names of the watched files and of the links to them.
    names: BTreeSet<OsString>,
    changed: Box<dyn FnMut() + Send>,
}

/// The meaning of a message.
enum Notice {
    /// The files may have changed.
    Relevant,
    Irrelevant,
    /// There was no message in time.
    Timeout,
    Stop,
}

impl WatcherThread {
    fn run(mut self) {
        let interval = if self.notifier.is_some() { RESCAN_INTERVAL } else { POLL_INTERVAL };
        let mut next_rescan = Instant::now() + interval;
        loop {
            let is_due = match self.receive(next_rescan) {
                Notice::Relevant => true,
                Notice::Irrelevant => false,
                Notice::Timeout => {
                    next_rescan = Instant::now() + interval;
                    self.are_touched() || lock(&self.files).differ_unstamped()
                }
                Notice::Stop => return,
            };
            if !is_due {
                continue;
            }
            if !self.wait_for_quiet() {
                return;
            }
            let differ = lock(&self.files).check();
            if differ {
                (self.changed)();
            }
        }
    }

    /// Waits for a message.
    fn receive(&mut self, until: Instant) -> Notice {
        let is_relevant = match self.inbox.recv_timeout(until.saturating_duration_since(Instant::now())) {
            Ok(WatcherMessage::Notified(Ok(event))) => self.is_relevant_event(&event),
            // Some events were lost.
            Ok(WatcherMessage::Notified(Err(_))) => true,
            Ok(WatcherMessage::FilesChanged) => {
                self.watch_directories();
                // The files may have been written before they were watched.
                self.are_touched()
            }
            Err(RecvTimeoutError::Timeout) => return Notice::Timeout,
            Ok(WatcherMessage::Stop) | Err(RecvTimeoutError::Disconnected) => return Notice::Stop,
        };
        if is_relevant { Notice::Relevant } else { Notice::Irrelevant }
    }

    /// Waits until no more messages arrive, but at most [`MAX_BATCH`]. Returns `false` if the thread should end.
    fn wait_for_quiet(&mut self) -> bool {
        let start = Instant::now();
        let mut last = start;
        while start.elapsed() < MAX_BATCH {
            match self.receive(last + QUIET_PERIOD) {
                Notice::Relevant => last = Instant::now(),
                Notice::Irrelevant => {}
                Notice::Timeout => return true,
                Notice::Stop => return false,
            }
        }
        true
    }

    /// Returns whether an event concerns the files.
    fn is_relevant_event(&mut self, event: &notify::Event) -> bool {
        if matches!(event.kind, EventKind::Access(_)) {
            return false;
        }
        if event.need_rescan() || event.paths.iter().any(|path| self.directories.contains(path)) {
            self.watch_directories();
            return true;
        }
        event.paths.iter().any(|path| path.file_name().is_some_and(|name| self.names.contains(name)))
    }

    /// Returns whether the files have been written. If so, their directories may differ and are watched again.
    fn are_touched(&mut self) -> bool {
        let are_touched = lock(&self.files).are_touched();
        if are_touched {
            self.watch_directories();
        }
        are_touched
    }

    /// Watches the current directories of the files.
    fn watch_directories(&mut self) {
        use notify::Watcher;
        let files = lock(&self.files);
        self.names = files.links().filter_map(|link| Some(link.file_name()?.to_owned())).collect();
        let Some(notifier) = &mut self.notifier else { return };
        for directory in std::mem::take(&mut self.directories) {
            let _ = notifier.unwatch(&directory);
        }
        for directory in files.links().filter_map(|link| link.parent().map(Path::to_owned)) {
            if !self.directories.contains(&directory)
                && notifier.watch(&directory, RecursiveMode::NonRecursive).is_ok()
            {
                self.directories.insert(directory);
            }
        }
    }
}

/// Files and their contents at the last check.
#[derive(Debug, Default)]
struct WatchedFiles(BTreeMap<PathBuf, KnownFile>);

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
    /// Unknown: the reader of the file may have read other content. The next check reports a change.
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
    /// [`check`](Self::check). Files written in the meantime count as changed at the next check, since their readers may have read
    /// the old content.
    fn follow(&mut self, paths: &[PathBuf], since: SystemTime) {
        let before = std::mem::take(&mut self.0);
        for path in paths {
            let (mut known, written_since) = match before.get(path) {
                Some(known) => (*known, known.stamp != Stamp::now(path)),
                None => {
                    let known = KnownFile::now(path);
                    (known, known.stamp.is_some_and(|stamp| stamp.latest() + CLOCK_TICK > since))
                }
            };
            if written_since {
                known.content = KnownContent::Unknown;
            }
            self.0.insert(path.clone(), known);
        }
    }

    /// Discards the known contents. The next check reports all files as changed.
    fn mark_unknown(&mut self) {
        for known in self.0.values_mut() {
            known.content = KnownContent::Unknown;
        }
    }

    /// Returns whether any stamp has changed or any content is unknown. Reads no files.
    fn are_touched(&self) -> bool {
        let touched = |(path, known): (&PathBuf, &KnownFile)| {
            known.content == KnownContent::Unknown || known.stamp != Stamp::now(path)
        };
        self.0.iter().any(touched)
    }

    /// Returns whether any content has changed under an unchanged stamp. Reads only files written so recently that their stamps may hide
    /// a change. Skips files whose stamps have changed, since they may still be being written.
    fn differ_unstamped(&mut self) -> bool {
        let mut differ = false;
        for (path, known) in self.0.iter_mut().filter(|(_, known)| known.fresh) {
            let now = KnownFile::now(path);
            if now.stamp == known.stamp {
                let same = now.content == known.content;
                *known = if same { now } else { KnownFile { content: KnownContent::Unknown, ..now } };
                differ |= !same;
            }
        }
        differ
    }

    /// Reads all files again. Returns whether any content has changed.
    fn check(&mut self) -> bool {
        let mut differ = false;
        for (path, known) in &mut self.0 {
            let now = KnownFile::now(path);
            differ |= now.content != known.content;
            *known = now;
        }
        differ
    }

    /// Returns the paths of all files, including each link on the way to its target.
    fn links(&self) -> impl Iterator<Item = PathBuf> {
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
    fn changes_under_an_equal_stamp_are_found_while_fresh() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("ball.ron");
        fs::write(&path, "first").unwrap();
        for (fresh, expected) in [(false, false), (true, true)] {
            // Simulates a file whose content has just changed under the same stamp.
            let known = KnownFile { content: KnownContent::Bytes(0), fresh, ..KnownFile::now(&path) };
            let mut files = WatchedFiles(BTreeMap::from([(path.clone(), known)]));
            assert!(!files.are_touched());
            assert_eq!(files.differ_unstamped(), expected);
            assert_eq!(files.are_touched(), expected);
            assert!(files.check() && !files.check() && !files.differ_unstamped());
        }
        assert!(KnownFile::now(&path).fresh);
        let long_ago = SystemTime::now() - 2 * STAMP_TICK;
        let known = KnownFile {
            fresh: true,
            stamp: Some(Stamp { modified: Some(long_ago), ..Stamp::now(&path).unwrap() }),
            ..KnownFile::now(&path)
        };
        // Files that are being written are skipped.
        assert!(!WatchedFiles(BTreeMap::from([(path, known)])).differ_unstamped());
    }
}
