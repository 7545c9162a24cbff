//! Preview sessions: scenes that stay on display while their files are edited.

use std::path;
use std::sync::Arc;
use std::thread::{self, JoinHandle};
use std::time::{SystemTime, UNIX_EPOCH};

use super::commands::SessionCommand;
use super::event::Event;
use super::handle::{Handle, SessionSettings};
use super::published::Published;
use super::state::State;
use super::worker::Worker;

/// A scene that is read again after every edit, on a separate thread, until it is dropped.
///
/// A newer edit or any other request interrupts the current picture. After an edit, a coarse picture comes first, then better ones if the
/// full picture takes long, and then the full picture. While the files contain mistakes, the last good scene stays.
#[derive(Debug)]
pub struct Session {
    handle: Handle,
    thread: Option<JoinHandle<()>>,
}

impl Session {
    /// Starts the thread, which reads the scene and watches its files. The thread passes events to `tell`.
    #[must_use]
    pub fn start(settings: SessionSettings, tell: impl FnMut(Event) + Send + 'static) -> Self {
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
        let shared = handle.clone();
        let thread = thread::spawn(move || Worker::new(settings, shared, Box::new(tell)).run());
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

/// Returns a number that differs at every start, so that a page can detect a new session.
fn distinct() -> u64 {
    let since = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
    // Milliseconds are exact in JavaScript's numbers.
    u64::try_from(since.as_millis()).unwrap_or(0)
}
