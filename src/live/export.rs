//! Export: rendering of frames into files, on a thread of its own, while the scene stays on display.

use std::ops::ControlFlow::Continue;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{self, Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Condvar, Mutex, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

use serde::{Deserialize, Serialize};

use crate::engine::Engine;
use crate::output::{FrameFormat, MovieFormat, Sequence};
use crate::scene::{Override, Reader};
use crate::sequence::{SequenceProgress, SequenceReport, render_movie_until, render_sequence_until};
use crate::systems::{EffectSet, RenderSettings};
use crate::time::FrameList;

/// Maximum time for the end of an export that is cancelled.
const CANCEL_TIMEOUT: Duration = Duration::from_secs(5);

/// A request to render frames into files.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ExportRequest {
    /// Index of the first frame.
    pub first: u32,
    /// Index of the last frame.
    pub last: u32,
    /// The folder for PNG files, or a movie.
    pub target: PathBuf,
}

/// The export that was requested last.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct ExportState {
    /// Absolute path of the folder, or of the movie.
    pub target: String,
    /// True if the target is a movie.
    pub is_movie: bool,
    /// Number of frames that are done.
    pub done: usize,
    /// Number of frames.
    pub total: usize,
    /// Estimated time until the end in seconds, once a frame is rendered.
    pub left: Option<f64>,
    /// The end of the export; `None` while it is running.
    pub end: Option<ExportEnd>,
}

/// The end of an export.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum ExportEnd {
    /// All frames are done.
    Complete,
    /// The export was cancelled. Frames that were done stay; there is no movie.
    Cancelled,
    /// The frames could not be rendered.
    Failed(String),
}

/// The control of the thread of an export.
#[derive(Debug, Default)]
pub(super) struct ExportControl {
    cancelled: AtomicBool,
    is_running: Mutex<bool>,
    ended: Condvar,
}

impl ExportControl {
    pub(super) fn is_running(&self) -> bool {
        *self.is_running.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Begins an export. Returns `false` if there is one already.
    fn begin(&self) -> bool {
        let mut is_running = self.is_running.lock().unwrap_or_else(PoisonError::into_inner);
        if !*is_running {
            self.cancelled.store(false, Ordering::Relaxed);
        }
        !std::mem::replace(&mut *is_running, true)
    }

    /// Ends the export, and publishes that before another one can begin.
    fn end(&self, publish: impl FnOnce()) {
        let mut is_running = self.is_running.lock().unwrap_or_else(PoisonError::into_inner);
        *is_running = false;
        publish();
        drop(is_running);
        self.ended.notify_all();
    }

    /// Cancels the export, and waits until it has ended.
    pub(super) fn cancel(&self) {
        let is_running = self.is_running.lock().unwrap_or_else(PoisonError::into_inner);
        self.cancelled.store(*is_running, Ordering::Relaxed);
        let _ = self.ended.wait_timeout_while(is_running, CANCEL_TIMEOUT, |is_running| *is_running);
    }
}

/// The scene of an export.
pub(super) struct ExportScene {
    pub(super) file: PathBuf,
    pub(super) overrides: Vec<Override>,
    pub(super) without: EffectSet,
}

/// Starts an export, whose state is published after every frame. Returns the reason why that is not possible.
pub(super) fn start(
    scene: ExportScene,
    request: ExportRequest,
    control: &Arc<ExportControl>,
    publish: impl Fn(&ExportState) + Send + 'static,
) -> Result<(), String> {
    let ExportRequest { first, last, target } = request;
    let frames = FrameList::of(first..=last).ok_or("the last frame comes before the first")?;
    let is_movie = MovieFormat::of(&target).is_ok() && !target.is_dir();
    if target.as_os_str().is_empty() || !is_movie && target.is_file() {
        return Err("name a folder for the frames, or a movie, as film.mp4".to_owned());
    }
    if !control.begin() {
        return Err("a film is being rendered: wait for its end, or cancel it".to_owned());
    }
    let absolute = path::absolute(&target).unwrap_or_else(|_| target.clone()).display().to_string();
    let mut export =
        ExportState { target: absolute, is_movie, total: frames.count(), ..ExportState::default() };
    publish(&export);
    let control = Arc::clone(control);
    thread::spawn(move || {
        let rendered = catch_unwind(AssertUnwindSafe(|| {
            render(&scene, &frames, &target, &control.cancelled, &mut export, &publish)
        }));
        let rendered =
            rendered.unwrap_or_else(|_| Err("the renderer has failed; please report it".to_owned()));
        export.end = Some(match rendered {
            Err(message) => ExportEnd::Failed(message),
            Ok(count) if count < export.total => ExportEnd::Cancelled,
            Ok(_) => ExportEnd::Complete,
        });
        control.end(|| publish(&export));
    });
    Ok(())
}

/// Renders the scene as it is in its files now. Returns the number of frames that are done.
fn render(
    scene: &ExportScene,
    frames: &FrameList,
    target: &Path,
    cancelled: &AtomicBool,
    export: &mut ExportState,
    publish: &impl Fn(&ExportState),
) -> Result<usize, String> {
    let ExportScene { file, overrides, without } = scene;
    let read = Reader::overriding(overrides.clone()).load(file);
    let (scene, _) = read.map_err(|error| error.render(false))?;
    let mut engine = Engine::from_scene(scene);
    engine.settings = RenderSettings { without: *without, ..RenderSettings::default() };
    let (start, mut rendered) = (Instant::now(), 0.0);
    let is_movie = export.is_movie;
    let on_progress = |SequenceProgress { kept, done, total, .. }: SequenceProgress| {
        rendered += f64::from(u8::from(!kept));
        export.left =
            (rendered > 0.0).then(|| start.elapsed().as_secs_f64() / rendered * (total - done) as f64);
        // The scene may have become shorter.
        (export.done, export.total) = (done, total);
        publish(export);
        Continue(())
    };
    let report = if is_movie {
        render_movie_until(&mut engine, frames, target, cancelled, on_progress)
    } else {
        let name = file.file_stem().unwrap_or("frame".as_ref());
        let last = engine.timeline.frame_count() - 1;
        let sequence = Sequence::new(target.to_owned(), name, last, FrameFormat::default());
        render_sequence_until(&mut engine, frames, &sequence, cancelled, on_progress)
    };
    match report {
        Ok(SequenceReport { written, kept, .. }) => Ok(written + kept),
        Err(error) => Err(error.to_string()),
    }
}
