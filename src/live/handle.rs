//! How a session is asked and looked at, and what it is started with.

use std::path::PathBuf;
use std::sync::Arc;

use tokio::sync::watch;

use super::board::{Board, Picture};
use super::mailbox::{Command, Mailbox};
use super::state::State;
use super::watcher::Watching;

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

/// Asks a session and looks at it, from any thread.
#[derive(Clone, Debug)]
pub struct Handle {
    pub(super) mailbox: Arc<Mailbox>,
    pub(super) board: Arc<Board>,
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
