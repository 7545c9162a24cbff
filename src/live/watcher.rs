//! Detection of changes in the contents of files.
//!
//! Directories are watched instead of files, since an editor that saves by renaming replaces the watched file. Events of the system only
//! trigger a check: files are read, and their contents compared. Every [`HEARTBEAT`], the files are also checked without an event, for
//! changes that the system does not report: a folder that was missing for a while, a link within the path, an overflowing queue.
//!
//! The watcher implements the quiet period itself, without a debouncer. A debouncer that passes an event on when it is 25 ms old, as
//! notify-debouncer-full does, does not wait for quiet, and its ordering of events is irrelevant when contents are compared.

use std::collections::BTreeSet;
use std::ffi::OsString;
use std::path::PathBuf;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant, SystemTime};

use notify::{Event, EventKind, RecommendedWatcher, RecursiveMode};

use super::files::WatchedFiles;

/// Time without events after which a save counts as complete.
pub const QUIET: Duration = Duration::from_millis(25);
/// Time after which files that keep changing are checked nevertheless.
const PATIENCE: Duration = Duration::from_millis(75);
/// Interval between checks of a caller that waits for a change.
const GLANCE: Duration = Duration::from_millis(5);
/// Interval between checks of the files if the system reports changes.
const HEARTBEAT: Duration = Duration::from_millis(500);
/// Interval between checks of the files if the system does not report changes.
const POLL: Duration = Duration::from_millis(100);

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
    Told(notify::Result<Event>),
    /// The set of watched files has changed.
    WatchAgain,
    Stop,
}

impl Watcher {
    /// Starts a watcher without files. It calls `changed` once after every save that changes the content of a watched file.
    #[must_use]
    pub fn start(watching: Watching, changed: impl FnMut() + Send + 'static) -> Self {
        let (messages, inbox) = channel();
        let tell = messages.clone();
        let files = Arc::<Mutex<WatchedFiles>>::default();
        let shared = Arc::clone(&files);
        let thread = thread::spawn(move || {
            // If the system reports nothing, the files are polled.
            let eyes = match watching {
                Watching::Events => notify::recommended_watcher(move |event| {
                    let _ = tell.send(WatcherMessage::Told(event));
                })
                .ok(),
                Watching::Polling => None,
            };
            let heartbeat = if eyes.is_some() { HEARTBEAT } else { POLL };
            let lookout = WatcherThread {
                inbox,
                eyes,
                heartbeat,
                files: shared,
                watched: BTreeSet::new(),
                names: BTreeSet::new(),
                changed: Box::new(changed),
            };
            lookout.run();
        });
        Self { files, messages, thread: Some(thread) }
    }

    /// Checks the files for a caller that is about to read them, so that earlier writes cause no call. Returns whether any content has
    /// changed since the last check.
    pub fn look(&self) -> bool {
        lock(&self.files).look()
    }

    /// Waits for `time`, or until the files are written. Returns whether they were unchanged.
    pub(super) fn stay(&self, time: Duration) -> bool {
        let start = Instant::now();
        // The watcher's thread may update the known contents in the meantime.
        let (stamps, touched) = {
            let files = lock(&self.files);
            (files.stamps(), files.are_touched())
        };
        while start.elapsed() < time {
            thread::sleep(GLANCE);
            if touched || lock(&self.files).stamps() != stamps {
                return false;
            }
        }
        true
    }

    /// Discards the known contents of the files. They could not be read, which may change without any event.
    pub(super) fn doubt(&self) {
        lock(&self.files).forget();
    }

    /// Watches these files from now on, whether they exist or not. They have been read since `since`, and those already known have been
    /// read after a [`look`](Self::look). Writes in the meantime count as changes.
    pub fn follow(&self, files: &[PathBuf], since: SystemTime) {
        lock(&self.files).follow(files, since);
        let _ = self.messages.send(WatcherMessage::WatchAgain);
    }
}

fn lock(files: &Mutex<WatchedFiles>) -> MutexGuard<'_, WatchedFiles> {
    files.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Drop for Watcher {
    fn drop(&mut self) {
        let _ = self.messages.send(WatcherMessage::Stop);
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

/// The state of the watcher's thread.
struct WatcherThread {
    inbox: Receiver<WatcherMessage>,
    eyes: Option<RecommendedWatcher>,
    heartbeat: Duration,
    files: Arc<Mutex<WatchedFiles>>,
    /// The watched directories.
    watched: BTreeSet<PathBuf>,
    /// Names of the watched files and of the links to them.
    names: BTreeSet<OsString>,
    changed: Box<dyn FnMut() + Send>,
}

/// The action after a message.
enum Hint {
    Nothing,
    Look,
    Stop,
}

impl WatcherThread {
    fn run(mut self) {
        let mut next_beat = Instant::now() + self.heartbeat;
        loop {
            let hint = match self.inbox.recv_timeout(next_beat.saturating_duration_since(Instant::now())) {
                Ok(message) => self.read(message),
                Err(RecvTimeoutError::Timeout) => {
                    next_beat = Instant::now() + self.heartbeat;
                    match self.look_after() {
                        Hint::Nothing if lock(&self.files).differ_unstamped() => Hint::Look,
                        hint => hint,
                    }
                }
                Err(RecvTimeoutError::Disconnected) => Hint::Stop,
            };
            let hint = match hint {
                Hint::Look => self.wait_for_quiet(),
                hint => hint,
            };
            match hint {
                Hint::Nothing => {}
                Hint::Look => {
                    let differ = lock(&self.files).look();
                    if differ {
                        (self.changed)();
                    }
                }
                Hint::Stop => return,
            }
        }
    }

    fn read(&mut self, message: WatcherMessage) -> Hint {
        match message {
            WatcherMessage::Told(Ok(event)) => self.weigh(&event),
            // Some events were lost.
            WatcherMessage::Told(Err(_)) => Hint::Look,
            WatcherMessage::WatchAgain => {
                self.watch_again();
                // The files may have been written before they were watched.
                self.look_after()
            }
            WatcherMessage::Stop => Hint::Stop,
        }
    }

    /// Returns the action for an event, which is a check if the event concerns the files.
    fn weigh(&mut self, event: &Event) -> Hint {
        if matches!(event.kind, EventKind::Access(_)) {
            return Hint::Nothing;
        }
        if event.need_rescan() || event.paths.iter().any(|path| self.watched.contains(path)) {
            self.watch_again();
            return Hint::Look;
        }
        let concerns = |path: &PathBuf| path.file_name().is_some_and(|name| self.names.contains(name));
        if event.paths.iter().any(concerns) { Hint::Look } else { Hint::Nothing }
    }

    /// Checks for changes that were not reported. After a change, the directories may differ and are watched again.
    fn look_after(&mut self) -> Hint {
        if !lock(&self.files).are_touched() {
            return Hint::Nothing;
        }
        self.watch_again();
        Hint::Look
    }

    /// Watches the current directories of the files.
    fn watch_again(&mut self) {
        use notify::Watcher;
        let files = lock(&self.files);
        self.names = files.links().filter_map(|link| Some(link.file_name()?.to_owned())).collect();
        let Some(eyes) = &mut self.eyes else { return };
        for directory in std::mem::take(&mut self.watched) {
            let _ = eyes.unwatch(&directory);
        }
        for directory in files.directories() {
            if !self.watched.contains(&directory)
                && eyes.watch(&directory, RecursiveMode::NonRecursive).is_ok()
            {
                self.watched.insert(directory);
            }
        }
    }

    fn wait_for_quiet(&mut self) -> Hint {
        let start = Instant::now();
        let mut last = start;
        while start.elapsed() < PATIENCE {
            let rest = (last + QUIET).saturating_duration_since(Instant::now());
            let hint = match self.inbox.recv_timeout(rest) {
                Ok(message) => self.read(message),
                Err(RecvTimeoutError::Timeout) => return Hint::Look,
                Err(RecvTimeoutError::Disconnected) => Hint::Stop,
            };
            match hint {
                Hint::Nothing => {}
                Hint::Look => last = Instant::now(),
                Hint::Stop => return Hint::Stop,
            }
        }
        Hint::Look
    }
}
