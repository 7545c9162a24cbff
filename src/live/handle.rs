//! Handles to sessions, and the settings of sessions.

use std::path::PathBuf;
use std::sync::Arc;

use tokio::sync::watch;

use super::commands::{CommandQueue, SessionCommand};
use super::published::{Picture, Published};
use super::state::State;
use super::watcher::Watching;
use crate::scene::Override;
use crate::systems::EffectSet;

/// The settings of a session.
#[derive(Clone, Debug)]
pub struct SessionSettings {
    /// Path of the scene's file, which need not exist yet.
    pub scene: PathBuf,
    /// Values that override the values in the files, also after edits.
    pub overrides: Vec<Override>,
    /// Effects that are disabled even if the scene needs them.
    pub without: EffectSet,
    /// Index of the first frame to be shown.
    pub frame: u32,
    /// Method of detecting file changes.
    pub watching: Watching,
    /// True if a full picture follows every edit even while drafts are requested.
    pub finish: bool,
}

/// A handle that sends commands to a session and reads its state, from any thread.
#[derive(Clone, Debug)]
pub struct Handle {
    pub(super) commands: Arc<CommandQueue>,
    pub(super) published: Arc<Published>,
}

impl Handle {
    /// Sends a command to the session.
    #[doc(hidden)]
    pub fn send(&self, command: SessionCommand) {
        self.commands.send(command);
    }

    /// Returns the current state of the session.
    #[doc(hidden)]
    #[must_use]
    pub fn state(&self) -> State {
        self.published.state()
    }

    /// Returns a receiver of subsequent states.
    pub(super) fn subscribe(&self) -> watch::Receiver<State> {
        self.published.subscribe()
    }

    /// Returns a picture, or `None` once it is out of date.
    #[doc(hidden)]
    #[must_use]
    pub fn picture(&self, id: u64) -> Option<Picture> {
        self.published.picture(id)
    }
}
