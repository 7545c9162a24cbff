//! A scene that is kept on show while its files are edited.

use std::path::{self, PathBuf};
use std::sync::Arc;
use std::thread::{self, JoinHandle};
use std::time::{SystemTime, UNIX_EPOCH};

use tokio::sync::watch;

use super::board::{Board, Picture};
use super::director::Director;
use super::mailbox::{Command, Mailbox};
use super::state::{Mistakes, PictureInfo, State, Times};
use super::watcher::Watching;
use crate::color::Transfer;
use crate::engine::EngineError;
use crate::scene::LoadError;
use crate::trace::Film;

/// What to keep on show.
#[derive(Clone, Debug)]
pub struct SessionSettings {
    /// The scene's file; it need not be there yet.
    pub scene: PathBuf,
    /// The first to be shown.
    pub frame: u32,
    /// How changes of files are noticed.
    pub watching: Watching,
    /// Does a full picture follow every edit, though drafts are asked for?
    pub finish: bool,
}

/// What happens in a session, for whoever wants to tell it.
#[derive(Debug)]
pub enum Event {
    /// The scene was read.
    Reloaded(Times),
    /// The files are wrong; the last good scene stays.
    Broken(LoadError),
    /// The frame cannot be made.
    Failed(EngineError),
    /// A picture was made, but cannot be shown.
    NotShown(Mistakes),
    /// A picture was made.
    Shown(Shown),
}

/// A picture that was made.
#[derive(Debug)]
pub struct Shown {
    /// Which.
    pub info: PictureInfo,
    /// Its pixels.
    pub film: Arc<Film>,
    /// How they become bytes.
    pub transfer: Transfer,
    /// What it took.
    pub times: Times,
    /// How many were traced.
    pub rays: u64,
    /// What is not drawn as it says, a line each; looked for in full pictures alone.
    pub warnings: Vec<String>,
}

/// A scene that is read again after every edit, on a thread of its own, until it is dropped.
///
/// A newer edit, and anything else that is asked for, ends the picture in hand. After an edit there is a coarse picture first, then
/// better ones if the full one takes long, and then that. While the files are wrong, the last good scene stays.
#[derive(Debug)]
pub struct Session {
    handle: Handle,
    thread: Option<JoinHandle<()>>,
}

/// Asks a session and looks at it, from any thread.
#[derive(Clone, Debug)]
pub struct Handle {
    pub(super) mailbox: Arc<Mailbox>,
    pub(super) board: Arc<Board>,
}

impl Session {
    /// Reads the scene and watches its files; `tell` is called on the session's thread.
    #[must_use]
    pub fn start(settings: SessionSettings, tell: impl FnMut(Event) + Send + 'static) -> Self {
        // Another folder's scene of the same name is another one.
        let scene = path::absolute(&settings.scene).unwrap_or_else(|_| settings.scene.clone());
        let state = State {
            scene: scene.display().to_string(),
            session: distinct(),
            frame: settings.frame,
            frames: 1,
            rate: 1.0,
            ..State::default()
        };
        let handle = Handle { mailbox: Arc::default(), board: Arc::new(Board::new(state)) };
        let shared = handle.clone();
        let thread = thread::spawn(move || Director::new(settings, shared, Box::new(tell)).run());
        Self { handle, thread: Some(thread) }
    }

    /// To ask it and to look at it.
    #[must_use]
    pub fn handle(&self) -> Handle {
        self.handle.clone()
    }
}

impl Drop for Session {
    fn drop(&mut self) {
        self.handle.post(Command::Stop);
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

impl Handle {
    /// Asks the session for something.
    pub fn post(&self, command: Command) {
        self.mailbox.post(command);
    }

    /// The session as it is now.
    #[must_use]
    pub fn state(&self) -> State {
        self.board.state()
    }

    /// What becomes of the state.
    #[must_use]
    pub fn subscribe(&self) -> watch::Receiver<State> {
        self.board.subscribe()
    }

    /// A picture; `None` once it is out of date.
    #[must_use]
    pub fn picture(&self, id: u64) -> Option<Picture> {
        self.board.picture(id)
    }
}

/// Another number at every start, so that a page sees that it talks to another session.
fn distinct() -> u64 {
    let since = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
    // Exact in a browser's numbers.
    u64::try_from(since.as_millis()).unwrap_or(0)
}
