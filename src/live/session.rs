//! Preview sessions: scenes that stay on display while their files are edited.

use std::env;
use std::path::{self, PathBuf};
use std::sync::Arc;
use std::thread::{self, JoinHandle};
use std::time::{SystemTime, UNIX_EPOCH};

use hecs::World;
use tokio::sync::watch;

use super::cache_folder::CacheFolder;
use super::commands::{CommandQueue, SessionCommand};
use super::controls::{Controls, InvalidControl};
use super::editor::EditorCommand;
use super::export::ExportState;
use super::publish::{Event, Picture, Published, Publisher};
use super::renderer::Renderer;
use super::scene_files::SceneFiles;
use super::state::State;
use super::watcher::{Watcher, Watching};
use super::worker::Worker;
use crate::engine::Engine;
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
    /// Names of warnings that are not given: of [consequences](crate::systems::Consequence::NAMES), or
    /// [`SceneWarning::NAMES`](crate::scene::SceneWarning::NAMES).
    pub allowed: Vec<&'static str>,
    /// Index of the first frame to be shown.
    pub frame: u32,
    /// Method of detecting file changes.
    pub watching: Watching,
    /// True if a full picture follows every edit even while drafts are requested. Pictures from the cache are then shown during playback
    /// only, since they have no [film](super::Shown::film).
    pub finish: bool,
    /// Maximum size in bytes of the finished pictures that are kept for playback and for edits that are undone; 0 keeps none.
    pub cache: usize,
    /// Folder of frames, as `rayreel render --out` writes them. Those that the scene needs are shown without rendering them; full pictures
    /// of the scene in the files are added, in place of frames with another fingerprint.
    pub cache_folder: Option<PathBuf>,
    /// Command that opens a file at a line, for links on the page. Without it, there are none.
    pub editor: Option<EditorCommand>,
}

/// The default of [`SessionSettings::cache`]: 512 MiB. PNG files of 1280x720 pixels have 0.5 to 2 MB.
pub const DEFAULT_CACHE: usize = 512 << 20;

/// A scene that is read again after every edit, or an engine, shown by a separate thread until the session is dropped.
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
        let name = path::absolute(&settings.scene).unwrap_or_else(|_| settings.scene.clone());
        Self::spawn(
            &name.display().to_string(),
            settings.frame,
            settings.cache,
            emit,
            move |commands, published, publisher| {
                let SessionSettings {
                    scene,
                    overrides,
                    without,
                    allowed,
                    frame,
                    watching,
                    finish,
                    editor,
                    cache_folder,
                    ..
                } = settings;
                let queue = Arc::clone(&commands);
                let watcher = Watcher::start(watching, move || queue.send(SessionCommand::Reload));
                let shared = Arc::clone(&published);
                let fail = move |error| shared.update(|state| state.cache_error = Some(error));
                let folder = cache_folder.map(|folder| CacheFolder::open(folder, &scene, fail));
                let files = SceneFiles::new(scene, overrides, watcher, editor);
                let nothing = Engine::new(World::new());
                let mut renderer = Renderer::new(nothing, without, allowed, Arc::clone(&commands), publisher);
                renderer.set_folder(folder);
                Worker::new(Some(files), Controls::default(), renderer, commands, published, frame, finish)
            },
        )
    }

    /// Starts the thread, which shows an engine's timeline under a name, with the engine's settings. There are no files: after a change of
    /// the program, start it again. A page that is open continues with the new session if the [server](super::Server) has the same port.
    /// The page shows the [controls](crate::components::Control) of the world, and renders the frame again when one of them is changed.
    ///
    /// ```no_run
    /// use rayreel::live::{Server, Session};
    /// use rayreel::{Engine, World};
    ///
    /// let session = Session::of_engine("my world", Engine::new(World::new()), |_| {})?;
    /// let server = Server::start(8080, session.handle())?;
    /// println!("http://{}/", server.address());
    /// std::io::stdin().read_line(&mut String::new())?; // runs until Enter is pressed
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    ///
    /// If two controls have the same name, or a control has a value that is not within its range.
    pub fn of_engine(
        name: &str,
        mut engine: Engine,
        emit: impl FnMut(Event) + Send + 'static,
    ) -> Result<Self, InvalidControl> {
        let controls = Controls::of(engine.world_mut())?;
        Ok(Self::spawn(name, 0, DEFAULT_CACHE, emit, move |commands, published, publisher| {
            let without = engine.settings.without;
            let renderer = Renderer::new(engine, without, Vec::new(), Arc::clone(&commands), publisher);
            Worker::new(None, controls, renderer, commands, published, 0, false)
        }))
    }

    /// Starts the thread of a worker, which `worker` creates on that thread.
    fn spawn(
        name: &str,
        frame: u32,
        cache: usize,
        emit: impl FnMut(Event) + Send + 'static,
        worker: impl FnOnce(Arc<CommandQueue>, Arc<Published>, Publisher) -> Worker + Send + 'static,
    ) -> Self {
        let state = State {
            scene: name.to_owned(),
            folder: env::current_dir().map_or_else(|_| String::new(), |folder| folder.display().to_string()),
            session: distinct(),
            frame,
            frames: 1,
            rate: 1.0,
            ..State::default()
        };
        let handle = Handle { commands: Arc::default(), published: Arc::new(Published::new(state, cache)) };
        let Handle { commands, published } = handle.clone();
        let thread = thread::spawn(move || {
            let publisher = Publisher::new(Arc::clone(&published), Box::new(emit));
            worker(commands, published, publisher).run();
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
        self.handle.cancel_export();
        self.handle.send(SessionCommand::Stop);
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
        // One that was requested just before.
        self.handle.cancel_export();
    }
}

impl Handle {
    /// Sends a command to the session.
    #[doc(hidden)]
    pub fn send(&self, command: SessionCommand) {
        self.commands.send(command);
    }

    /// Cancels the export, if there is one, and waits for its end.
    #[doc(hidden)]
    pub fn cancel_export(&self) {
        self.published.export().cancel();
    }

    /// Returns the export that is running, or was the last.
    #[doc(hidden)]
    #[must_use]
    pub fn export(&self) -> Option<ExportState> {
        self.published.export_state()
    }

    /// Returns the reason why no more frames are written into the folder of the cache.
    #[doc(hidden)]
    #[must_use]
    pub fn cache_error(&self) -> Option<String> {
        self.published.cache_error()
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

    /// Returns the finished picture of a frame as a PNG file, if it is kept; see [`State::cached`].
    #[doc(hidden)]
    #[must_use]
    pub fn frame(&self, generation: u64, frame: u32) -> Option<Arc<[u8]>> {
        self.published.frame(generation, frame)
    }
}

/// Returns a number that differs at every start, so that a page can detect a new session.
fn distinct() -> u64 {
    let since = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
    // Milliseconds are exact in JavaScript's numbers.
    u64::try_from(since.as_millis()).unwrap_or(0)
}
