//! Preview sessions: scenes that stay on display while their files are edited.

use std::path::{self, PathBuf};
use std::sync::Arc;
use std::thread::{self, JoinHandle};
use std::time::{SystemTime, UNIX_EPOCH};

use tokio::sync::watch;

use super::commands::{CommandQueue, SessionCommand};
use super::publish::{Event, Picture, Published, Publisher};
use super::renderer::Renderer;
use super::state::State;
use super::watcher::{Watcher, Watching};
use super::worker::{SceneFiles, Worker};
use crate::scene::{Override, Reader};
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
    /// Names of warnings that are not given: of [consequences](crate::systems::Consequence::NAMES), or
    /// [`SceneWarning::NAME`](crate::scene::SceneWarning::NAME).
    pub allowed: Vec<&'static str>,
    /// Index of the first frame to be shown.
    pub frame: u32,
    /// Method of detecting file changes.
    pub watching: Watching,
    /// True if a full picture follows every edit even while drafts are requested.
    pub finish: bool,
}

/// A scene that is read again after every edit, on a separate thread, until it is dropped.
///
/// A newer edit or any other request interrupts the current picture. After an edit, a coarse picture comes first, then better ones if the
/// full picture takes long, and then the full picture. While the files contain mistakes, the last good scene stays.
#[derive(Debug)]
pub struct Session {
    handle: Handle,
    thread: Option<JoinHandle<()>>,
}

/// A handle that sends commands to a session and reads its state, from any thread.
#[derive(Clone, Debug)]
pub struct Handle {
    commands: Arc<CommandQueue>,
    published: Arc<Published>,
}

impl Session {
    /// Starts the thread, which reads the scene and watches its files. The thread passes events to `emit`.
    #[must_use]
    pub fn start(settings: SessionSettings, emit: impl FnMut(Event) + Send + 'static) -> Self {
        // The absolute path distinguishes scenes of the same name.
        let scene = path::absolute(&settings.scene).unwrap_or_else(|_| settings.scene.clone());
        let state = State {
            scene: scene.display().to_string(),
            session: distinct(),
            frame: settings.frame,
            frames: 1,
            rate: 1.0,
            ..State::default()
        };
        let handle = Handle { commands: Arc::default(), published: Arc::new(Published::new(state)) };
        let Handle { commands, published } = handle.clone();
        let thread = thread::spawn(move || {
            let SessionSettings { scene, overrides, without, allowed, frame, watching, finish } = settings;
            let queue = Arc::clone(&commands);
            let watcher = Watcher::start(watching, move || queue.send(SessionCommand::Reload));
            let files = SceneFiles::new(scene, Reader::overriding(overrides), watcher);
            let publisher = Publisher::new(Arc::clone(&published), Box::new(emit));
            let renderer = Renderer::new(without, allowed, Arc::clone(&commands), publisher);
            Worker::new(files, renderer, commands, published, frame, finish).run();
        });
        Self { handle, thread: Some(thread) }
    }

    /// Returns a handle that sends commands and reads the state.
    #[must_use]
    pub fn handle(&self) -> Handle {
        self.handle.clone()
    }
}

impl Drop for Session {
    fn drop(&mut self) {
        self.handle.send(SessionCommand::Stop);
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
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

/// Returns a number that differs at every start, so that a page can detect a new session.
fn distinct() -> u64 {
    let since = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
    // Milliseconds are exact in JavaScript's numbers.
    u64::try_from(since.as_millis()).unwrap_or(0)
}
