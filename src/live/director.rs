//! The session's thread, which reads the files and decides what to render next.

use std::path::PathBuf;
use std::sync::Arc;
use std::time::{Duration, Instant, SystemTime};

use super::begun::{Aside, Begun};
use super::easel::Easel;
use super::event::Event;
use super::handle::{Handle, SessionSettings};
use super::ladder::{self, LadderStep, Timings};
use super::mailbox::{Answer, Command, Detail, Patience, View};
use super::stage::{LoadedScene, Stage};
use super::state::{Mistakes, State, Times};
use super::watcher::Watcher;
use crate::engine::EngineError;
use crate::scene::{LoadError, Reader};

/// Time for which files must be unchanged before mistakes in them are reported. Slow writers leave files incomplete for a while.
const RESTED: Duration = Duration::from_millis(100);
/// Time after which mistakes are reported even if the files keep changing.
const DOUBT: Duration = Duration::from_secs(1);
/// Fraction of the frame interval that a coarse picture should take during playback, when it is the only picture of its frame.
const COARSE_IN_A_ROW: f64 = 0.5;
/// Expected render time, in milliseconds, above which a coarse picture comes first.
const SOON: f64 = 40.0;
/// Minimum time without a frame request after which playback counts as over.
const REST: Duration = Duration::from_millis(500);
/// The same time in frame intervals. The longer one applies.
const MISSED: f64 = 3.0;

/// The next task of the thread.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Next {
    Nothing,
    /// A coarse picture.
    Step(LadderStep, StepRole),
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
pub(super) enum StepRole {
    /// The first picture, which cannot wait.
    First,
    /// A picture between the first and the requested one.
    Between,
    /// The only picture of its frame during playback.
    InARow,
}

/// The state of the session's thread.
pub(super) struct Director {
    pub(super) settings: SessionSettings,
    pub(super) handle: Handle,
    watcher: Watcher,
    reader: Reader,
    pub(super) stage: Option<Stage>,
    pub(super) easel: Easel,
    /// Index of the frame requested last. The current scene may be shorter.
    wanted_frame: u32,
    pub(super) detail: Detail,
    pub(super) next: Next,
    /// True if the frame requested last is part of playback.
    pub(super) is_playing: bool,
    /// Number of reloads at the time of the last full picture.
    pub(super) full_of: u64,
    pub(super) timings: Timings,
    /// The last coarse picture of the displayed frame, and its time in milliseconds.
    pub(super) last_step: Option<(LadderStep, f64)>,
    /// The requested picture, with the samples traced so far.
    pub(super) begun: Option<Begun>,
    /// The full picture that is due after an edit and is rendered while other pictures are shown.
    pub(super) aside: Option<Aside>,
}

impl Director {
    pub(super) fn new(settings: SessionSettings, handle: Handle, tell: Box<dyn FnMut(Event) + Send>) -> Self {
        let mailbox = Arc::clone(&handle.mailbox);
        let watcher = Watcher::start(settings.watching, move || mailbox.post(Command::Reload));
        Self {
            wanted_frame: settings.frame,
            reader: Reader::overriding(settings.overrides.clone()),
            settings,
            easel: Easel::new(Arc::clone(&handle.board), tell),
            handle,
            watcher,
            stage: None,
            detail: Detail::Full,
            next: Next::Nothing,
            is_playing: false,
            full_of: 0,
            timings: Timings::default(),
            last_step: None,
            begun: None,
            aside: None,
        }
    }

    pub(super) fn run(mut self) {
        self.watcher.follow(std::slice::from_ref(&self.settings.scene), SystemTime::now());
        self.reload();
        loop {
            let mut reload = false;
            for command in self.handle.mailbox.take(self.patience()) {
                match command {
                    Command::Reload => reload = true,
                    Command::View(view) => self.view(view),
                    Command::Probe(pixel, answer) => self.probe(pixel, answer),
                    Command::Stop => return,
                }
            }
            if reload {
                self.reload();
            }
            self.make_next();
        }
    }

    /// Returns the time to wait for commands, which is zero while there is work.
    fn patience(&self) -> Patience {
        match self.next {
            Next::Nothing => Patience::Endless,
            Next::Rest(until) if !self.owes() => Patience::Until(until),
            _ => Patience::None,
        }
    }

    /// Reads the files. If they contain mistakes, the last good scene stays in place.
    fn reload(&mut self) {
        self.watcher.look();
        match self.read() {
            Ok((read, read_in)) => {
                let start = Instant::now();
                Stage::take_over(&mut self.stage, read, &self.settings.left_out);
                let build = Times::milliseconds(start.elapsed());
                self.welcome(Times { read: read_in, build, ..Times::default() });
            }
            Err(Unread { error, is_passing }) => {
                let mistakes = Mistakes::of_scene(&error);
                let is_known = self.handle.board.state().mistakes.as_ref() == Some(&mistakes);
                // No event is guaranteed when they become readable again.
                if is_passing {
                    self.watcher.doubt();
                }
                if !(is_passing && is_known) {
                    self.handle.board.change(|state| state.mistakes = Some(mistakes));
                    self.easel.tell(Event::Broken(error));
                }
            }
        }
    }

    /// Reads the files. Returns their scene and the time taken in milliseconds. Files with mistakes are read again until they stop
    /// changing, since they may be empty or truncated while they are being written.
    fn read(&mut self) -> Result<(LoadedScene, f64), Unread> {
        let first = Instant::now();
        loop {
            let (since, start) = (SystemTime::now(), Instant::now());
            let error = match Stage::read(&mut self.reader, &self.settings.scene) {
                Ok(read) => {
                    self.watcher.follow(&read.scene.files, since);
                    return Ok((read, Times::milliseconds(start.elapsed())));
                }
                Err(error) => error,
            };
            let is_passing = is_unreadable(error.files());
            self.watcher.follow(error.files(), since);
            let at_rest = self.watcher.stay(RESTED);
            let is_over = first.elapsed() >= DOUBT;
            if is_over || at_rest && !is_passing && !self.handle.mailbox.take_reload() {
                return Err(Unread { error, is_passing });
            }
            self.handle.mailbox.take_reload();
            self.watcher.look();
        }
    }

    /// Publishes the state of a newly read scene and schedules its first picture.
    fn welcome(&mut self, times: Times) {
        let Some(stage) = &self.stage else { return };
        let (timeline, film) = (stage.timeline(), stage.film_settings());
        let before = self.handle.board.keep_for_comparison();
        let frames = timeline.frame_count();
        let frame = self.wanted_frame.min(frames - 1);
        // Pages are notified together with the first picture, so that they do not keep the machine busy before it.
        self.handle.board.change_silently(|state| {
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
        (self.begun, self.aside, self.last_step) = (None, None, None);
        self.next = self.first_step();
        self.easel.tell(Event::Reloaded(times));
    }

    fn view(&mut self, view: View) {
        match view {
            View::Seek { frame, playing } => (self.wanted_frame, self.is_playing) = (frame, playing),
            View::Detail(detail) => self.detail = detail,
            View::Finish | View::Measure => {}
        }
        let (wanted_frame, detail, shows) = (self.wanted_frame, self.detail, self.stage.is_some());
        let before = self.handle.board.state().frame;
        self.handle.board.change(|state| {
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
        if self.handle.board.state().frame != before {
            (self.begun, self.last_step) = (None, None);
        }
        self.next = match view {
            View::Seek { playing, .. } => self.next_while(playing),
            View::Detail(detail) => Next::Picture(detail),
            View::Finish => Next::Picture(Detail::Full),
            View::Measure => Next::Cost(0),
        };
    }

    /// Returns the best task for the requested frame that fits into the available time.
    fn next_while(&self, playing: bool) -> Next {
        let time = if playing { self.interval() } else { SOON };
        let target = self.stage.as_ref().map(|stage| stage.target(self.detail));
        let expected = target.and_then(|target| self.timings.expected(target));
        match (expected.is_some_and(|expected| expected <= time), playing) {
            (true, _) => Next::Picture(self.detail),
            (false, true) => self.step(COARSE_IN_A_ROW * self.interval(), 1, StepRole::InARow),
            (false, false) => self.first_step(),
        }
    }

    pub(super) fn first_step(&self) -> Next {
        self.step(ladder::FIRST, 2, StepRole::First)
    }

    fn step(&self, milliseconds: f64, finest: u32, role: StepRole) -> Next {
        let film = self.handle.board.state().film;
        Next::Step(self.timings.first(film, milliseconds, finest), role)
    }

    /// Returns the frame interval in milliseconds.
    fn interval(&self) -> f64 {
        1e3 / self.handle.board.state().rate
    }

    /// Returns the time at which playback counts as over unless another frame is requested.
    pub(super) fn end_of_row(&self) -> Instant {
        let missed = Duration::try_from_secs_f64(1e-3 * MISSED * self.interval()).unwrap_or(REST);
        Instant::now() + missed.max(REST)
    }

    fn probe(&mut self, pixel: (u32, u32), Answer(answer): Answer) {
        let frame = self.handle.board.state().frame;
        let picture = self.easel.latest().filter(|(info, _)| info.full).map(|(_, film)| &**film);
        let info = self.stage.as_mut().map_or(Ok(None), |stage| stage.pixel_info(frame, pixel, picture));
        answer(info.unwrap_or_else(|error| {
            self.fail(error);
            None
        }));
    }

    pub(super) fn fail(&mut self, error: EngineError) {
        self.next = Next::Nothing;
        let mistakes = Mistakes::of_frame(&error);
        self.handle.board.change(|state| {
            state.frame_mistakes = Some(mistakes);
            state.rendering = false;
        });
        self.easel.tell(Event::Failed(error));
    }
}

/// The reason there is no new scene.
struct Unread {
    error: LoadError,
    /// True if a file exists but could not be read. It may become readable without being changed.
    is_passing: bool,
}

/// Returns whether one of the files exists but cannot be opened.
fn is_unreadable(files: &[PathBuf]) -> bool {
    files.iter().any(|path| path.is_file() && std::fs::File::open(path).is_err())
}
