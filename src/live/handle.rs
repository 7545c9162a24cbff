//! Requests to a session and views of it, and the settings it is started with.

use std::path::PathBuf;
use std::sync::Arc;

use tokio::sync::watch;

use super::board::{Board, Picture};
use super::mailbox::{Command, Mailbox};
use super::state::State;
use super::watcher::Watching;
use crate::scene::Override;
use crate::systems::Effect;

/// The settings of a session.
#[derive(Clone, Debug)]
pub struct SessionSettings {
    /// The scene's file; it need not be there yet.
    pub scene: PathBuf,
    /// Values in the place of the files' own, whatever is edited.
    pub overrides: Vec<Override>,
    /// Effects that are left out, even if a scene calls for them.
    pub left_out: Vec<Effect>,
    /// The first frame to be shown.
    pub frame: u32,
    /// The way in which changes of files are noticed.
    pub watching: Watching,
    /// Whether a full picture follows every edit even while drafts are requested.
    pub finish: bool,
}

/// Sends requests to a session and reads its state, from any thread.
#[derive(Clone, Debug)]
pub struct Handle {
    pub(super) mailbox: Arc<Mailbox>,
    pub(super) board: Arc<Board>,
}

impl Handle {
    /// Sends a command to the session.
    #[doc(hidden)]
    pub fn post(&self, command: Command) {
        self.mailbox.post(command);
    }

    /// Returns the current state of the session.
    #[doc(hidden)]
    #[must_use]
    pub fn state(&self) -> State {
        self.board.state()
    }

    /// Returns a receiver of the states to come.
    pub(super) fn subscribe(&self) -> watch::Receiver<State> {
        self.board.subscribe()
    }

    /// Returns a picture; `None` once it is out of date.
    #[doc(hidden)]
    #[must_use]
    pub fn picture(&self, id: u64) -> Option<Picture> {
        self.board.picture(id)
    }
}
