//! A session's thread: it reads the files, and decides what is made next.

use std::path::PathBuf;
use std::sync::Arc;
use std::time::{Duration, Instant, SystemTime};

use super::begun::{Aside, Begun};
use super::easel::Easel;
use super::event::Event;
use super::handle::{Handle, SessionSettings};
use super::ladder::{self, Pace, Step};
use super::mailbox::{Answer, Command, Detail, Patience, View};
use super::stage::{Read, Stage};
use super::state::{Mistakes, State, Times};
use super::watcher::Watcher;
use crate::engine::EngineError;
use crate::scene::{LoadError, Reader};

/// What is wrong with files is told when they have been at rest for so long: on a busy machine those who write are kept waiting,
const RESTED: Duration = Duration::from_millis(100);
/// or, if they are not, after so much time.
const DOUBT: Duration = Duration::from_secs(1);
/// A coarse picture of many in a row should take this share of the time between them.
const COARSE_IN_A_ROW: f64 = 0.5;
/// Pictures that take longer, in milliseconds, begin with a coarse one.
const SOON: f64 = 40.0;
/// A row of pictures has come to an end if the next one is not asked for in so much time,
const REST: Duration = Duration::from_millis(500);
/// or in the time of so many.
const MISSED: f64 = 3.0;

/// The next thing to make.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Next {
    Nothing,
    /// A coarse picture.
    Step(Step, Place),
    Picture(Detail),
    /// Nothing until then, as another one of many pictures in a row may be asked for; if none is, a better one.
    Rest(Instant),
    /// What the effect with this number costs.
    Cost(usize),
}

/// Which of the coarse pictures it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Place {
    /// The first, which cannot wait.
    First,
    /// One of those between it and the picture that is asked for.
    Between,
    /// The only one of its frame, of many in a row.
    InARow,
}

/// What the session's thread has.
pub(super) struct Director {
    pub(super) settings: SessionSettings,
    pub(super) handle: Handle,
    watcher: Watcher,
    reader: Reader,
    pub(super) stage: Option<Stage>,
    pub(super) easel: Easel,
    /// The frame that was asked for last, though the scene may be shorter now.
    wanted_frame: u32,
    pub(super) detail: Detail,
    pub(super) next: Next,
    /// Was the last frame that was asked for one of many in a row?
    pub(super) is_playing: bool,
    /// After so many reloads the last full picture was made.
    pub(super) full_of: u64,
    pub(super) pace: Pace,
    /// The last coarse picture of the frame on show, and how many milliseconds it took.
    pub(super) last_step: Option<(Step, f64)>,
    /// The picture that is asked for, as far as it has come.
    pub(super) begun: Option<Begun>,
    /// The full picture that is owed to an edit while others are on show.
    pub(super) aside: Option<Aside>,
}

impl Director {
    pub(super) fn new(settings: SessionSettings, handle: Handle, tell: Box<dyn FnMut(Event) + Send>) -> Self {
        let mailbox = Arc::clone(&handle.mailbox);
        let watcher = Watcher::start(settings.watching, move || mailbox.post(Command::Reload));
        Self {
            wanted_frame: settings.frame,
            settings,
            easel: Easel::new(Arc::clone(&handle.board), tell),
            handle,
            watcher,
            reader: Reader::new(),
            stage: None,
            detail: Detail::Full,
            next: Next::Nothing,
            is_playing: false,
            full_of: 0,
            pace: Pace::default(),
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

    /// How long is there nothing to do?
    fn patience(&self) -> Patience {
        match self.next {
            Next::Nothing => Patience::Endless,
            Next::Rest(until) if !self.owes() => Patience::Until(until),
            _ => Patience::None,
        }
    }

    /// Reads the files; what is wrong with them leaves the last good scene in place.
    fn reload(&mut self) {
        self.watcher.look();
        match self.read() {
            Ok((read, read_in)) => {
                let start = Instant::now();
                Stage::take_over(&mut self.stage, read);
                let build = Times::milliseconds(start.elapsed());
                self.welcome(Times { read: read_in, build, ..Times::default() });
            }
            Err(Unread { error, is_passing }) => {
                let mistakes = Mistakes::of_scene(&error);
                let is_known = self.handle.board.state().mistakes.as_ref() == Some(&mistakes);
                // Once they can be read again nothing else may tell of it.
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

    /// What the files hold, and in how many milliseconds it was read. What is wrong gets another look until the files are at rest:
    /// while they are written they are empty or cut short for a moment.
    fn read(&mut self) -> Result<(Read, f64), Unread> {
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

    /// Puts up a scene that was read, and goes on with its picture.
    fn welcome(&mut self, times: Times) {
        let Some(stage) = &self.stage else { return };
        let (timeline, film) = (stage.timeline(), stage.film_settings());
        let before = self.handle.board.keep_for_comparison();
        let frames = timeline.frame_count();
        let frame = self.wanted_frame.min(frames - 1);
        // Whoever looks on is told together with the first picture, and does not keep this machine busy until then.
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

    /// What is there time for?
    fn next_while(&self, playing: bool) -> Next {
        let time = if playing { self.interval() } else { SOON };
        let target = self.stage.as_ref().map(|stage| stage.target(self.detail));
        let expected = target.and_then(|target| self.pace.expected(target));
        match (expected.is_some_and(|expected| expected <= time), playing) {
            (true, _) => Next::Picture(self.detail),
            (false, true) => self.step(COARSE_IN_A_ROW * self.interval(), 1, Place::InARow),
            (false, false) => self.first_step(),
        }
    }

    pub(super) fn first_step(&self) -> Next {
        self.step(ladder::FIRST, 2, Place::First)
    }

    fn step(&self, milliseconds: f64, finest: u32, place: Place) -> Next {
        let film = self.handle.board.state().film;
        Next::Step(self.pace.first(film, milliseconds, finest), place)
    }

    /// Milliseconds between frames.
    fn interval(&self) -> f64 {
        1e3 / self.handle.board.state().rate
    }

    /// When a row of pictures has come to an end.
    pub(super) fn end_of_row(&self) -> Instant {
        let missed = Duration::try_from_secs_f64(1e-3 * MISSED * self.interval()).unwrap_or(REST);
        Instant::now() + missed.max(REST)
    }

    fn probe(&mut self, pixel: (u32, u32), Answer(answer): Answer) {
        let frame = self.handle.board.state().frame;
        let picture = self.easel.latest().filter(|(info, _)| info.full).map(|(_, film)| &**film);
        let spot = self.stage.as_mut().map_or(Ok(None), |stage| stage.spot(frame, pixel, picture));
        answer(spot.unwrap_or_else(|error| {
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

/// Why there is no scene.
struct Unread {
    error: LoadError,
    /// Could a file not be read that is there? Then it may be readable later, as it is.
    is_passing: bool,
}

/// Is there a file that cannot be opened though it is there?
fn is_unreadable(files: &[PathBuf]) -> bool {
    files.iter().any(|path| path.is_file() && std::fs::File::open(path).is_err())
}
