//! The session's thread, which reads the files and decides what to render next.

use std::path::PathBuf;
use std::sync::Arc;
use std::time::{Duration, Instant, SystemTime};

use super::commands::{Detail, ProbeReply, SessionCommand, ViewChange, WaitMode};
use super::event::Event;
use super::handle::{Handle, SessionSettings};
use super::in_progress::{BackgroundRender, RenderInProgress};
use super::presenter::Presenter;
use super::preview_level::{self, PreviewLevel, Timings};
use super::preview_scene::{LoadedScene, PreviewScene};
use super::state::{Mistakes, State, Times};
use super::watcher::Watcher;
use crate::engine::EngineError;
use crate::scene::{LoadError, Reader};

/// Time for which files must be unchanged before mistakes in them are reported. Slow writers leave files incomplete for a while.
const SETTLE_TIME: Duration = Duration::from_millis(100);
/// Time after which mistakes are reported even if the files keep changing.
const SETTLE_TIMEOUT: Duration = Duration::from_secs(1);
/// Fraction of the frame interval that a coarse picture should take during playback, when it is the only picture of its frame.
const COARSE_IN_A_ROW: f64 = 0.5;
/// Expected render time, in milliseconds, above which a coarse picture comes first.
const COARSE_FIRST_ABOVE_MS: f64 = 40.0;
/// Minimum time without a frame request after which playback counts as over.
const IDLE_TIMEOUT: Duration = Duration::from_millis(500);
/// The same time in frame intervals. The longer one applies.
const IDLE_INTERVALS: f64 = 3.0;

/// The next task of the thread.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum NextTask {
    Nothing,
    /// A coarse picture.
    Step(PreviewLevel, LevelRole),
    Picture(Detail),
    /// Nothing until the given time, since the next frame of playback may be requested. After that time, a better picture.
    Rest(Instant),
    /// A measurement of the cost of the effect with this index.
    Cost(usize),
    /// A measurement of the error at the curve point with this index.
    Curve(usize),
}

/// The role of a coarse picture among the pictures of its frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum LevelRole {
    /// The first picture, which cannot wait.
    First,
    /// A picture between the first and the requested one.
    Between,
    /// The only picture of its frame during playback.
    InARow,
}

/// The state of the session's thread.
pub(super) struct Worker {
    pub(super) settings: SessionSettings,
    pub(super) handle: Handle,
    watcher: Watcher,
    reader: Reader,
    pub(super) scene: Option<PreviewScene>,
    pub(super) presenter: Presenter,
    /// Index of the frame requested last. The current scene may be shorter.
    wanted_frame: u32,
    pub(super) detail: Detail,
    pub(super) next: NextTask,
    /// True if the frame requested last is part of playback.
    pub(super) is_playing: bool,
    /// Number of reloads at the time of the last full picture.
    pub(super) full_of: u64,
    pub(super) timings: Timings,
    /// The last coarse picture of the displayed frame, and its time in milliseconds.
    pub(super) last_step: Option<(PreviewLevel, f64)>,
    /// The requested picture, with the samples traced so far.
    pub(super) in_progress: Option<RenderInProgress>,
    /// The full picture that is due after an edit and is rendered while other pictures are shown.
    pub(super) background: Option<BackgroundRender>,
}

impl Worker {
    pub(super) fn new(settings: SessionSettings, handle: Handle, emit: Box<dyn FnMut(Event) + Send>) -> Self {
        let commands = Arc::clone(&handle.commands);
        let watcher = Watcher::start(settings.watching, move || commands.send(SessionCommand::Reload));
        Self {
            wanted_frame: settings.frame,
            reader: Reader::overriding(settings.overrides.clone()),
            settings,
            presenter: Presenter::new(Arc::clone(&handle.published), emit),
            handle,
            watcher,
            scene: None,
            detail: Detail::Full,
            next: NextTask::Nothing,
            is_playing: false,
            full_of: 0,
            timings: Timings::default(),
            last_step: None,
            in_progress: None,
            background: None,
        }
    }

    pub(super) fn run(mut self) {
        self.watcher.follow(std::slice::from_ref(&self.settings.scene), SystemTime::now());
        self.reload();
        loop {
            let mut reload = false;
            for command in self.handle.commands.take(self.wait_mode()) {
                match command {
                    SessionCommand::Reload => reload = true,
                    SessionCommand::ViewChange(view) => self.view(view),
                    SessionCommand::Probe(pixel, answer) => self.probe(pixel, answer),
                    SessionCommand::Stop => return,
                }
            }
            if reload {
                self.reload();
            }
            self.make_next();
        }
    }

    /// Returns the time to wait for commands, which is zero while there is work.
    fn wait_mode(&self) -> WaitMode {
        match self.next {
            NextTask::Nothing => WaitMode::Endless,
            NextTask::Rest(until) if !self.full_render_pending() => WaitMode::Until(until),
            _ => WaitMode::None,
        }
    }

    /// Reads the files. If they contain mistakes, the last good scene stays in place.
    fn reload(&mut self) {
        self.watcher.look();
        match self.read() {
            Ok((read, read_in)) => {
                let start = Instant::now();
                PreviewScene::replace(&mut self.scene, read, self.settings.without);
                let build = Times::milliseconds(start.elapsed());
                self.on_loaded(Times { read: read_in, build, ..Times::default() });
            }
            Err(LoadFailure { error, is_transient }) => {
                let mistakes = Mistakes::of_scene(&error);
                let is_known = self.handle.published.state().mistakes.as_ref() == Some(&mistakes);
                // No event is guaranteed when they become readable again.
                if is_transient {
                    self.watcher.doubt();
                }
                if !(is_transient && is_known) {
                    self.handle.published.update(|state| state.mistakes = Some(mistakes));
                    self.presenter.emit(Event::Broken(error));
                }
            }
        }
    }

    /// Reads the files. Returns their scene and the time taken in milliseconds. Files with mistakes are read again until they stop
    /// changing, since they may be empty or truncated while they are being written.
    fn read(&mut self) -> Result<(LoadedScene, f64), LoadFailure> {
        let first = Instant::now();
        let mut files = vec![self.settings.scene.clone()];
        loop {
            // A file that can be opened after the read may not have been readable during the read.
            let was_unreadable = is_unreadable(&files);
            let (since, start) = (SystemTime::now(), Instant::now());
            let error = match PreviewScene::read(&mut self.reader, &self.settings.scene) {
                Ok(read) => {
                    self.watcher.follow(&read.scene.files, since);
                    return Ok((read, Times::milliseconds(start.elapsed())));
                }
                Err(error) => error,
            };
            files = error.files().to_vec();
            let is_transient = was_unreadable || is_unreadable(&files);
            self.watcher.follow(&files, since);
            let at_rest = self.watcher.stay(SETTLE_TIME);
            let is_over = first.elapsed() >= SETTLE_TIMEOUT;
            if is_over || at_rest && !is_transient && !self.handle.commands.take_reload() {
                return Err(LoadFailure { error, is_transient });
            }
            self.handle.commands.take_reload();
            self.watcher.look();
        }
    }

    /// Publishes the state of a newly read scene and schedules its first picture.
    fn on_loaded(&mut self, times: Times) {
        let Some(scene) = &self.scene else { return };
        let (timeline, film) = (scene.timeline(), scene.film_settings());
        let before = self.handle.published.keep_for_comparison();
        let frames = timeline.frame_count();
        let frame = self.wanted_frame.min(frames - 1);
        // Pages are notified together with the first picture, so that they do not keep the machine busy before it.
        self.handle.published.update_without_notify(|state| {
            *state = State {
                reloads: state.reloads + 1,
                frame,
                frames,
                rate: timeline.rate.per_second(),
                film: (film.width, film.height),
                before,
                rendering: true,
                progress: 0.0,
                mistakes: None,
                frame_mistakes: None,
                times,
                ..std::mem::take(state)
            };
        });
        (self.in_progress, self.background, self.last_step) = (None, None, None);
        self.next = self.first_step();
        self.presenter.emit(Event::Reloaded(times));
    }

    fn view(&mut self, view: ViewChange) {
        match view {
            ViewChange::Seek { frame, playing } => (self.wanted_frame, self.is_playing) = (frame, playing),
            ViewChange::Detail(detail) => self.detail = detail,
            ViewChange::Finish | ViewChange::Measure => {}
        }
        let (wanted_frame, detail, shows) = (self.wanted_frame, self.detail, self.scene.is_some());
        let before = self.handle.published.state().frame;
        self.handle.published.update(|state| {
            state.detail = detail;
            if shows {
                state.frame = wanted_frame.min(state.frames - 1);
                state.frame_mistakes = None;
                state.rendering = true;
                state.progress = 0.0;
            }
        });
        if !shows {
            return;
        }
        if self.handle.published.state().frame != before {
            (self.in_progress, self.last_step) = (None, None);
        }
        self.next = match view {
            ViewChange::Seek { playing, .. } => self.next_while(playing),
            ViewChange::Detail(detail) => NextTask::Picture(detail),
            ViewChange::Finish => NextTask::Picture(Detail::Full),
            ViewChange::Measure => NextTask::Cost(0),
        };
    }

    /// Returns the best task for the requested frame that fits into the available time.
    fn next_while(&self, playing: bool) -> NextTask {
        let time = if playing { self.interval() } else { COARSE_FIRST_ABOVE_MS };
        let target = self.scene.as_ref().map(|scene| scene.target(self.detail));
        let expected = target.and_then(|target| self.timings.expected(target));
        match (expected.is_some_and(|expected| expected <= time), playing) {
            (true, _) => NextTask::Picture(self.detail),
            (false, true) => self.step(COARSE_IN_A_ROW * self.interval(), 1, LevelRole::InARow),
            (false, false) => self.first_step(),
        }
    }

    pub(super) fn first_step(&self) -> NextTask {
        self.step(preview_level::FIRST, 2, LevelRole::First)
    }

    fn step(&self, milliseconds: f64, finest: u32, role: LevelRole) -> NextTask {
        let film = self.handle.published.state().film;
        NextTask::Step(self.timings.first(film, milliseconds, finest), role)
    }

    /// Returns the frame interval in milliseconds.
    fn interval(&self) -> f64 {
        1e3 / self.handle.published.state().rate
    }

    /// Returns the time at which playback counts as over unless another frame is requested.
    pub(super) fn end_of_row(&self) -> Instant {
        let missed =
            Duration::try_from_secs_f64(1e-3 * IDLE_INTERVALS * self.interval()).unwrap_or(IDLE_TIMEOUT);
        Instant::now() + missed.max(IDLE_TIMEOUT)
    }

    fn probe(&mut self, pixel: (u32, u32), ProbeReply(answer): ProbeReply) {
        let frame = self.handle.published.state().frame;
        let picture = self.presenter.latest().filter(|(info, _)| info.full).map(|(_, film)| &**film);
        let info = self.scene.as_mut().map_or(Ok(None), |scene| scene.pixel_info(frame, pixel, picture));
        answer(info.unwrap_or_else(|error| {
            self.fail(error);
            None
        }));
    }

    pub(super) fn fail(&mut self, error: EngineError) {
        self.next = NextTask::Nothing;
        let mistakes = Mistakes::of_frame(&error);
        self.handle.published.update(|state| {
            state.frame_mistakes = Some(mistakes);
            state.rendering = false;
        });
        self.presenter.emit(Event::Failed(error));
    }
}

/// The reason there is no new scene.
struct LoadFailure {
    error: LoadError,
    /// True if a file exists but could not be read. It may become readable without being changed.
    is_transient: bool,
}

/// Returns whether one of the files exists but cannot be opened.
fn is_unreadable(files: &[PathBuf]) -> bool {
    files.iter().any(|path| path.is_file() && std::fs::File::open(path).is_err())
}
