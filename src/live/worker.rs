//! The session's thread, which reads the files and picks the jobs of the renderer.

use std::mem;
use std::path::PathBuf;
use std::slice;
use std::sync::Arc;
use std::time::{Duration, Instant};

use super::camera_view::CameraView;
use super::commands::{CommandQueue, Detail, LookView, Reply, SceneEdit, SessionCommand, ViewChange};
use super::controls::Controls;
use super::editor::Place;
use super::edits::UNSAVED;
use super::export::{self, ExportRequest, ExportScene};
use super::jobs::{JobOutcome, LevelRole, Occasion, PreviewJob, Task};
use super::outline::PartInfo;
use super::path_info::{PathInfo, PathRequest};
use super::pixel_info::PixelInfo;
use super::placement::Placement;
use super::publish::{Event, Published};
use super::ray_info::RayTreeInfo;
use super::renderer::Renderer;
use super::scene_files::{FailureAction, LoadFailure, SceneFiles};
use super::state::{Mistakes, Times};
use crate::engine::EngineError;
use crate::scene::{ScenePart, WrittenTracks};
use crate::systems::Viewpoint;

/// Fraction of the frame interval that a coarse picture should take during playback, when it is the only picture of its frame. Encoding and
/// showing it take the rest.
const PLAYBACK_SHARE: f64 = 0.5;
/// Expected render time, in milliseconds, above which a coarse picture comes first: a picture within 40 ms follows a dragged playhead at 25
/// frames per second.
const COARSE_FIRST_ABOVE_MS: f64 = 40.0;
/// Maximum divisor of the film's width and height during playback: fewer frames are shown rather than pictures that cannot be read.
const PLAYBACK_DIVISOR: u32 = 4;
/// Time without commands after which pictures are rendered for the cache. Until then the world stays at the displayed frame, so that a
/// sequence of edits or a dragged playhead is not slowed down.
const FILL_DELAY: Duration = Duration::from_millis(250);
/// Minimum time without a frame request after which playback counts as over. A busy browser may pause for some frames.
const IDLE_TIMEOUT: Duration = Duration::from_millis(500);
/// The same time in frame intervals, for low frame rates. The longer one applies.
const IDLE_INTERVALS: f64 = 3.0;

/// The state of the session's thread.
pub(super) struct Worker {
    /// The scene's files; `None` for an engine of a program.
    files: Option<SceneFiles>,
    /// The controls of an engine of a program.
    controls: Controls,
    renderer: Renderer,
    commands: Arc<CommandQueue>,
    published: Arc<Published>,
    /// Index of the frame requested last. The current scene may be shorter.
    wanted_frame: u32,
    detail: Detail,
    next: Task,
    /// True if the frame requested last is part of playback.
    is_playing: bool,
    /// True if a full picture follows every edit even while drafts are requested.
    finish: bool,
    /// True until there is a full picture of the scene after an edit.
    lacks_full: bool,
    /// True if the frame is to be measured after its picture.
    measures: bool,
}

impl Worker {
    pub(super) fn new(
        files: Option<SceneFiles>,
        controls: Controls,
        renderer: Renderer,
        commands: Arc<CommandQueue>,
        published: Arc<Published>,
        wanted_frame: u32,
        finish: bool,
    ) -> Self {
        Self {
            files,
            controls,
            renderer,
            commands,
            published,
            wanted_frame,
            detail: Detail::Full,
            next: Task::Idle,
            is_playing: false,
            finish,
            lacks_full: false,
            measures: false,
        }
    }

    pub(super) fn run(mut self) {
        self.publish_edits(None);
        if self.files.is_some() {
            self.reload(false);
        } else {
            self.renderer.begin(Times::default(), self.wanted_frame);
            self.begin();
        }
        loop {
            let mut reload = false;
            for command in self.commands.take(self.wait_until()) {
                match command {
                    SessionCommand::Reload => {
                        self.yield_to_files();
                        reload = true;
                    }
                    SessionCommand::ViewChange(view) => self.view(view),
                    SessionCommand::Probe(pixel, reply) => self.probe(pixel, reply),
                    SessionCommand::Rays(pixel, sample, reply) => self.rays(pixel, sample, reply),
                    SessionCommand::Edit(edit, Reply(reply)) => reply(self.edit(&edit)),
                    SessionCommand::Outline(request, Reply(reply)) => reply(self.renderer.outline(&request)),
                    SessionCommand::Part(part, Reply(reply)) => reply(self.part(part.as_ref())),
                    SessionCommand::Tracks(Reply(reply)) => reply(self.tracks()),
                    SessionCommand::Export(request, Reply(reply)) => reply(self.export(request)),
                    SessionCommand::ExportEnded if self.next == Task::Idle => self.next = self.rest(),
                    SessionCommand::ExportEnded => {}
                    SessionCommand::Open(place, Reply(reply)) => reply(self.open(&place)),
                    SessionCommand::Camera(Reply(reply)) => reply(self.camera()),
                    SessionCommand::Placement(part, Reply(reply)) => reply(self.placement(&part)),
                    SessionCommand::Path(request, Reply(reply)) => reply(self.path(&request)),
                    SessionCommand::Stop => return,
                }
            }
            let action = self.files.as_ref().and_then(SceneFiles::failure_action);
            if reload || action == Some(FailureAction::ReadAgain) {
                self.reload(true);
            } else if action == Some(FailureAction::Report) {
                self.report_mistakes();
            }
            if self.failure().is_none() {
                self.run_next();
            }
        }
    }

    /// Returns the time until which to wait for commands: the present if there is work, or `None` to wait without limit.
    fn wait_until(&self) -> Option<Instant> {
        match (self.failure(), self.next) {
            (Some(failure), _) => Some(failure.check_at),
            (None, Task::Idle) => None,
            (None, Task::Wait(until)) if !self.is_full_due() && !self.renderer.can_fill_cache() => {
                Some(until)
            }
            (None, Task::Fill(from)) => Some(from),
            (None, Task::Wait(_) | Task::Run(_)) => Some(Instant::now()),
        }
    }

    /// Returns the mistakes that are not reported yet.
    fn failure(&self) -> Option<&LoadFailure> {
        self.files.as_ref()?.failure.as_ref()
    }

    /// Reads the files, after a change by a program if `is_edited` is set. If they contain mistakes, the last good scene stays in place.
    fn reload(&mut self, is_edited: bool) {
        if let Some((scene, sources, read)) = self.files.as_mut().and_then(SceneFiles::read) {
            self.renderer.load(scene, sources, read, self.wanted_frame, is_edited);
            self.begin();
        }
    }

    /// Begins with the first picture of a new scene.
    fn begin(&mut self) {
        (self.lacks_full, self.measures) = (true, false);
        let is_first = self.published.state().reloads == 1;
        self.next = match is_first && self.renderer.may_be_stored() {
            true => self.cached_or_frame_task(Occasion::Request),
            false => self.first_preview(),
        };
    }

    fn report_mistakes(&mut self) {
        let Some(files) = &mut self.files else { return };
        let Some(LoadFailure { error, .. }) = files.failure.take() else { return };
        if error.is_transient() {
            // No event is guaranteed when the files become readable again.
            files.watcher.mark_unknown();
        }
        let mistakes = Mistakes::of_scene(&error);
        // Files that cannot be read are read again and again.
        let is_known = self.published.state().mistakes.as_ref() == Some(&mistakes);
        if !(error.is_transient() && is_known) {
            self.published.update(|state| state.mistakes = Some(mistakes));
            self.renderer.emit(Event::Broken(error));
        }
    }

    fn view(&mut self, view: ViewChange) {
        match view {
            ViewChange::Seek { frame, playing } => (self.wanted_frame, self.is_playing) = (frame, playing),
            ViewChange::Detail(detail) => self.detail = detail,
            ViewChange::Finish | ViewChange::Measure => {}
        }
        self.measures = matches!(view, ViewChange::Measure);
        let (wanted_frame, detail, before) = (self.wanted_frame, self.detail, self.published.state());
        let shows = before.reloads > 0;
        let frame = wanted_frame.min(before.frames - 1);
        self.published.update(|state| {
            state.detail = detail;
            if shows {
                state.frame = frame;
                state.frame_mistakes = None;
                state.rendering = true;
                state.progress = 0.0;
            }
        });
        if !shows {
            return;
        }
        if frame != before.frame {
            self.renderer.discard_unfinished();
        }
        if detail != before.detail {
            self.renderer.begin_cache();
        }
        self.next = match view {
            ViewChange::Seek { playing: true, .. } => self.cached_or_frame_task(Occasion::Playback),
            ViewChange::Seek { playing: false, .. } | ViewChange::Detail(_) => {
                self.cached_or_frame_task(Occasion::Request)
            }
            ViewChange::Finish => self.picture(Detail::Full),
            ViewChange::Measure if self.next.is_picture() => self.next,
            ViewChange::Measure => self.rest(),
        };
    }

    /// Changes values of the scene. Returns the reason why that is not possible.
    fn edit(&mut self, edit: &SceneEdit) -> Result<(), String> {
        let is_broken = self.failure().is_some() || self.published.state().mistakes.is_some();
        let Some(files) = &mut self.files else {
            return self.edit_controls(edit);
        };
        let transfer = self.renderer.transfer();
        let before = match edit {
            SceneEdit::Try(values, keys) => {
                Some(files.edits.attempt(values, keys, &files.paths, transfer)?)
            }
            // Lists of keys are written whole: values in them that are not in the file yet would be lost.
            SceneEdit::TryKey(_) if files.edits.has_tried() => {
                return Err(UNSAVED.to_owned());
            }
            SceneEdit::TryKey(change) => {
                Some(files.edits.attempt(&[], slice::from_ref(change), &files.paths, transfer)?)
            }
            SceneEdit::Look(view) => return self.look(*view),
            SceneEdit::Drop => {
                files.edits.drop_tried();
                files.edits.set_look(None);
                self.renderer.set_view(None);
                None
            }
            SceneEdit::DropPaths(paths) => {
                files.edits.drop_paths(paths);
                None
            }
            SceneEdit::Keep if is_broken => {
                return Err("the file has mistakes: correct them first".to_owned());
            }
            SceneEdit::Keep => {
                files.edits.keep(&files.paths)?;
                None
            }
            SceneEdit::Undo | SceneEdit::Redo => {
                files.edits.drop_tried();
                let done = if *edit == SceneEdit::Undo { files.edits.undo() } else { files.edits.redo() };
                self.publish_edits(None);
                done?;
                None
            }
        };
        self.publish_edits(None);
        let refused = self.reload_edited();
        if let (Some(before), Some(files), Err(_)) = (before, &mut self.files, &refused) {
            files.edits.restore(before);
            self.publish_edits(None);
            let _ = self.reload_edited();
        }
        refused
    }

    /// Changes values of the controls of an engine. Returns the reason why that is not possible.
    fn edit_controls(&mut self, edit: &SceneEdit) -> Result<(), String> {
        let is_changed = self.controls.edit(edit)?;
        self.publish_edits(None);
        if is_changed {
            self.controls.apply(self.renderer.world_mut());
            self.renderer.begin(Times::default(), self.wanted_frame);
            self.begin();
        }
        Ok(())
    }

    /// Shows the scene from a view that is not written. Returns the reason why that is not possible.
    fn look(&mut self, LookView { position, target, up, is_free }: LookView) -> Result<(), String> {
        let view = Viewpoint { position: position.into(), target: target.into(), up: up.into() };
        if !(view.position.is_finite() && view.target.is_finite() && view.up.is_finite()) {
            return Err("the numbers of a view must be finite".to_owned());
        }
        if !self.files.as_ref().is_some_and(|files| files.edits.is_look()) {
            let reason = match self.camera()?.look {
                Some(reason) => reason,
                None if is_free => "the camera stays, so that its path can be seen from elsewhere".to_owned(),
                None => return Err("this camera can be moved: set its position and its target".to_owned()),
            };
            if let Some(files) = &mut self.files {
                files.edits.set_look(Some(reason));
            }
        }
        self.publish_edits(None);
        self.renderer.set_view(Some(view));
        self.renderer.begin(self.published.state().times, self.wanted_frame);
        self.begin();
        Ok(())
    }

    /// Reads the files with the current overrides. Returns the mistakes.
    fn reload_edited(&mut self) -> Result<(), String> {
        if let Some(files) = &mut self.files {
            files.reader.set_overrides(files.edits.overrides());
        }
        self.reload(false);
        self.failure().map_or(Ok(()), |failure| Err(failure.error.render(false)))
    }

    /// Ends overrides of values that a program has changed in the files.
    fn yield_to_files(&mut self) {
        let Some(files) = &mut self.files else { return };
        if files.edits.yield_to(&files.paths) {
            files.reader.set_overrides(files.edits.overrides());
            let notice = "the file was changed meanwhile: what is written there is shown".to_owned();
            self.publish_edits(Some(notice));
        }
    }

    fn publish_edits(&self, notice: Option<String>) {
        let edits = match &self.files {
            Some(files) => files.edits.state(files.editor.is_some(), notice),
            None => self.controls.state(),
        };
        self.published.update(|state| state.edits = edits);
    }

    /// Describes a part of a scene in files, or the controls of an engine.
    fn part(&self, part: Option<&ScenePart>) -> Option<PartInfo> {
        match &self.files {
            Some(files) => self.renderer.part(part?, &files.paths),
            None => self.controls.info(),
        }
    }

    fn tracks(&self) -> WrittenTracks {
        self.files.as_ref().map_or_else(WrittenTracks::default, |files| WrittenTracks::of(&files.paths))
    }

    /// Starts an export of the scene in the files. Returns the reason why that is not possible.
    fn export(&mut self, request: ExportRequest) -> Result<(), String> {
        let Some(files) = &self.files else {
            return Err("this world is built by a program: `Engine::render_to` renders it".to_owned());
        };
        if self.failure().is_some() || self.published.state().mistakes.is_some() {
            return Err("the file has mistakes: correct them first".to_owned());
        }
        if files.edits.has_tried() {
            return Err(UNSAVED.to_owned());
        }
        let frames = self.published.state().frames;
        if request.last >= frames {
            return Err(format!("the last frame is {}", frames - 1));
        }
        let scene = ExportScene {
            file: files.scene.clone(),
            overrides: files.edits.overrides(),
            without: self.renderer.without(),
        };
        let (published, commands) = (Arc::clone(&self.published), Arc::clone(&self.commands));
        export::start(scene, request, self.published.export(), move |export| {
            published.update(|state| state.export = Some(export.clone()));
            if export.end.is_some() {
                commands.send(SessionCommand::ExportEnded);
            }
        })?;
        // Both would distort the other's times.
        if self.next.is_measurement() {
            self.next = self.rest();
            self.published.update(|state| state.rendering = false);
        }
        Ok(())
    }

    /// Opens an editor at a place. Only files of the scene and the place of a mistake are opened.
    fn open(&self, place: &str) -> Result<(), String> {
        let files = self.files.as_ref().and_then(|files| Some((files, files.editor.as_ref()?)));
        let Some((files, editor)) = files else { return Err("`--editor` names the editor".to_owned()) };
        // The place of a particle has its frame in a data file, too.
        let place = place.split(", ").next().unwrap_or_default();
        let mistake = self.published.state().mistakes.and_then(|mistakes| mistakes.place);
        let is_named = |path: &PathBuf| path.as_os_str() == Place::parse(place).file;
        if mistake.as_deref() != Some(place) && !files.paths.iter().any(is_named) {
            return Err(format!("`{place}` is not in a file of the scene"));
        }
        editor.open(&Place::parse(place))
    }

    /// Describes the camera of the current frame, with its place in the files. Returns the reason why it cannot be moved.
    fn camera(&mut self) -> Result<CameraView, String> {
        let files =
            self.files.as_ref().ok_or("this world is built by a program: its camera is moved there")?;
        self.renderer.camera(&files.paths)
    }

    /// Describes the place of a part at the current frame.
    fn placement(&mut self, part: &ScenePart) -> Option<Placement> {
        self.renderer.placement(part, self.files.as_ref().map(|files| &files.paths[..]))
    }

    fn probe(&mut self, pixel: (u32, u32), Reply(reply): Reply<Option<PixelInfo>>) {
        reply(self.renderer.probe(pixel).unwrap_or_else(|error| {
            self.fail(error);
            None
        }));
        // The colour of a pixel is that of the film, which a picture from the cache lacks.
        if !self.next.is_picture() && self.renderer.shows_cached_picture() {
            self.measures |= self.next.is_measurement();
            self.next = self.picture(self.detail);
        }
    }

    fn rays(&mut self, pixel: (u32, u32), sample: u32, Reply(reply): Reply<Option<RayTreeInfo>>) {
        reply(self.renderer.rays(pixel, sample).unwrap_or_else(|error| {
            self.fail(error);
            None
        }));
    }

    /// Describes the path of the camera. A frame that fails shows its mistakes when it is displayed.
    fn path(&mut self, request: &PathRequest) -> Option<PathInfo> {
        self.renderer.path(request).unwrap_or_default()
    }

    fn fail(&mut self, error: EngineError) {
        (self.next, self.measures) = (Task::Idle, false);
        self.renderer.fail(error);
    }

    fn run_next(&mut self) {
        match self.next {
            Task::Idle => {}
            Task::Run(job) => match self.renderer.run(job) {
                Ok(outcome) => self.next = self.following(job, outcome),
                Err(error) => self.fail(error),
            },
            Task::Wait(until) => self.wait(until),
            Task::Fill(from) if Instant::now() < from => {}
            Task::Fill(_) if self.renderer.can_fill_cache() => self.renderer.fill_cache(false, None),
            Task::Fill(_) => self.next = Task::Idle,
        }
    }

    /// Returns the task after a job.
    fn following(&mut self, job: PreviewJob, outcome: JobOutcome) -> Task {
        let is_over = matches!(outcome, JobOutcome::Done | JobOutcome::Ended);
        let is_full = match job {
            PreviewJob::Picture { detail, .. } => detail == Detail::Full,
            PreviewJob::Cached(occasion) => self.detail == Detail::Full && occasion != Occasion::Playback,
            PreviewJob::Preview(..) | PreviewJob::Measurement(_) => false,
        };
        if is_over && is_full {
            self.lacks_full = false;
        }
        match (outcome, job) {
            (JobOutcome::Ended, _) => self.rest(),
            (JobOutcome::NotCached(occasion), _) => self.frame_task(occasion),
            (JobOutcome::Needs(level, role), _) => Task::Run(PreviewJob::Preview(level, role)),
            (JobOutcome::Interrupted | JobOutcome::Done, PreviewJob::Preview(_, LevelRole::Between)) => {
                self.after_preview()
            }
            (JobOutcome::Done, PreviewJob::Preview(_, LevelRole::First)) => {
                self.cached_or_frame_task(Occasion::AfterCoarse)
            }
            (JobOutcome::Interrupted, _) => Task::Run(job),
            (
                JobOutcome::Done,
                PreviewJob::Preview(_, LevelRole::Playback) | PreviewJob::Cached(Occasion::Playback),
            ) => self.wait_for_next_frame(),
            (JobOutcome::Done, PreviewJob::Picture { .. } | PreviewJob::Cached(_)) => self.after_picture(),
            (JobOutcome::Done, PreviewJob::Measurement(index)) => {
                Task::Run(PreviewJob::Measurement(index + 1))
            }
        }
    }

    /// Waits for the next frame of playback, and meanwhile renders the full picture that is due. If no further frame is requested, improves
    /// the last picture.
    fn wait(&mut self, until: Instant) {
        if Instant::now() < until {
            if !self.is_full_due() {
                self.renderer.fill_cache(true, Some(until));
            } else if self.renderer.render_in_background(until) {
                self.lacks_full = false;
            }
            return;
        }
        self.is_playing = false;
        self.next =
            if self.renderer.shows_coarse_picture() { self.after_preview() } else { self.after_picture() };
        let is_over = matches!(self.next, Task::Idle | Task::Fill(_));
        self.published.update(|state| state.rendering = !is_over);
    }

    /// Returns the task that begins with a look into the cache. With `finish`, the film of every frame is needed, except during playback.
    fn cached_or_frame_task(&mut self, occasion: Occasion) -> Task {
        match occasion {
            Occasion::Request | Occasion::AfterCoarse if self.finish => self.frame_task(occasion),
            _ => Task::Run(PreviewJob::Cached(occasion)),
        }
    }

    /// Returns the best task that fits into the available time, for a frame whose picture is not taken from the cache.
    fn frame_task(&mut self, occasion: Occasion) -> Task {
        let fits = |time| self.renderer.is_expected_within(time, self.detail);
        match occasion {
            Occasion::Playback if fits(self.interval()) => self.picture(self.detail),
            Occasion::Playback => {
                let level = self.renderer.level_within(PLAYBACK_SHARE * self.interval());
                let level = level.at_least(PLAYBACK_DIVISOR);
                Task::Run(PreviewJob::Preview(level, LevelRole::Playback))
            }
            Occasion::Request if fits(COARSE_FIRST_ABOVE_MS) => self.picture(self.detail),
            Occasion::Request => self.first_preview(),
            Occasion::AfterCoarse => self.after_preview(),
        }
    }

    fn first_preview(&self) -> Task {
        Task::Run(PreviewJob::Preview(self.renderer.first_level(), LevelRole::First))
    }

    /// Returns the task after a coarse picture: a finer one, or the requested picture if no finer one is worthwhile.
    fn after_preview(&mut self) -> Task {
        let finer = self.renderer.finer_level(self.detail);
        let preview = |level| Task::Run(PreviewJob::Preview(level, LevelRole::Between));
        finer.map_or_else(|| self.picture(self.detail), preview)
    }

    fn picture(&self, detail: Detail) -> Task {
        Task::Run(PreviewJob::Picture { detail, precedes_full: detail != Detail::Full && self.is_full_due() })
    }

    /// Returns the task after the requested picture: the full picture if it is due.
    fn after_picture(&mut self) -> Task {
        match (self.is_full_due(), self.is_playing) {
            (false, _) => self.rest(),
            (true, false) => self.picture(Detail::Full),
            (true, true) => self.wait_for_next_frame(),
        }
    }

    /// Returns the task when no picture is requested: the measurements, if they are.
    fn rest(&mut self) -> Task {
        if !mem::take(&mut self.measures) {
            return Task::Fill(Instant::now() + FILL_DELAY);
        }
        self.published.update(|state| (state.rendering, state.progress) = (true, 0.0));
        Task::Run(PreviewJob::Measurement(0))
    }

    /// Returns whether the full picture due after the last edit is still missing.
    fn is_full_due(&self) -> bool {
        self.lacks_full && (self.finish || self.detail == Detail::Full)
    }

    /// Returns the frame interval in milliseconds.
    fn interval(&self) -> f64 {
        1e3 / self.published.state().rate
    }

    /// Returns the task after the only picture of a frame of playback: to wait until playback counts as over.
    fn wait_for_next_frame(&self) -> Task {
        let missed =
            Duration::try_from_secs_f64(1e-3 * IDLE_INTERVALS * self.interval()).unwrap_or(IDLE_TIMEOUT);
        Task::Wait(Instant::now() + missed.max(IDLE_TIMEOUT))
    }
}
