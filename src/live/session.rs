//! A scene that is kept on show while its files are edited.

use std::path::PathBuf;
use std::sync::Arc;
use std::thread::{self, JoinHandle};
use std::time::{Instant, SystemTime, UNIX_EPOCH};

use tokio::sync::watch;

use super::board::{Board, Picture};
use super::mailbox::{Answer, Command, Detail, Mailbox, View};
use super::stage::{Render, Stage};
use super::state::{Mistakes, PictureInfo, State, Times};
use super::watcher::{Watcher, Watching};
use crate::color::Transfer;
use crate::engine::EngineError;
use crate::output;
use crate::scene::{LoadError, Reader};
use crate::trace::Film;

/// A coarse picture to begin with should take so many milliseconds,
const COARSE: f64 = 6.0;
/// and one of many in a row this share of the time between them.
const COARSE_IN_A_ROW: f64 = 0.5;
/// It has so much less of the film's width and height, at most,
const COARSEST: u32 = 8;
/// or so much if nothing is known.
const UNKNOWN: u32 = 4;
/// Frames that take longer, in milliseconds, begin with a coarse picture.
const SOON: f64 = 40.0;

/// What to keep on show.
#[derive(Clone, Debug)]
pub struct SessionSettings {
    /// The scene's file; it need not be there yet.
    pub scene: PathBuf,
    /// The first to be shown.
    pub frame: u32,
    /// How changes of files are noticed.
    pub watching: Watching,
    /// Does a full picture follow every edit, though drafts are asked for?
    pub finish: bool,
}

/// What happens in a session, for whoever wants to tell it.
#[derive(Debug)]
pub enum Event {
    /// The scene was read.
    Reloaded(Times),
    /// The files are wrong; the last good scene stays.
    Broken(LoadError),
    /// The frame cannot be made.
    Failed(EngineError),
    /// A picture was made.
    Shown(Shown),
}

/// A picture that was made.
#[derive(Debug)]
pub struct Shown {
    /// Which.
    pub info: PictureInfo,
    /// Its pixels.
    pub film: Film,
    /// How they become bytes.
    pub transfer: Transfer,
    /// What it took.
    pub times: Times,
    /// How many were traced.
    pub rays: u64,
}

/// A scene that is read again after every edit, on a thread of its own, until it is dropped.
///
/// A newer edit, and anything else that is asked for, ends the picture in hand. After an edit there is a coarse picture first,
/// and then the full one. While the files are wrong, the last good scene stays.
#[derive(Debug)]
pub struct Session {
    handle: Handle,
    thread: Option<JoinHandle<()>>,
}

/// Asks a session and looks at it, from any thread.
#[derive(Clone, Debug)]
pub struct Handle {
    mailbox: Arc<Mailbox>,
    board: Arc<Board>,
}

impl Session {
    /// Reads the scene and watches its files; `tell` is called on the session's thread.
    #[must_use]
    pub fn start(settings: SessionSettings, tell: impl FnMut(Event) + Send + 'static) -> Self {
        let state = State {
            scene: settings.scene.display().to_string(),
            session: distinct(),
            frame: settings.frame,
            frames: 1,
            rate: 1.0,
            ..State::default()
        };
        let handle = Handle { mailbox: Arc::default(), board: Arc::new(Board::new(state)) };
        let shared = handle.clone();
        let thread = thread::spawn(move || Director::new(settings, shared, Box::new(tell)).run());
        Self { handle, thread: Some(thread) }
    }

    /// To ask it and to look at it.
    #[must_use]
    pub fn handle(&self) -> Handle {
        self.handle.clone()
    }
}

impl Drop for Session {
    fn drop(&mut self) {
        self.handle.post(Command::Stop);
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

impl Handle {
    /// Asks the session for something.
    pub fn post(&self, command: Command) {
        self.mailbox.post(command);
    }

    /// The session as it is now.
    #[must_use]
    pub fn state(&self) -> State {
        self.board.state()
    }

    /// What becomes of the state.
    #[must_use]
    pub fn subscribe(&self) -> watch::Receiver<State> {
        self.board.subscribe()
    }

    /// A picture; `None` once it is out of date.
    #[must_use]
    pub fn picture(&self, id: u64) -> Option<Picture> {
        self.board.picture(id)
    }
}

/// Another number at every start, so that a page sees that it talks to another session.
fn distinct() -> u64 {
    let since = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
    // Exact in a browser's numbers.
    u64::try_from(since.as_millis()).unwrap_or(0)
}

/// The next thing to make.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Next {
    Nothing,
    /// A coarse picture, and what follows it.
    Coarse(Option<Detail>),
    Picture(Detail),
    /// What the effect with this number costs.
    Cost(usize),
}

/// What pictures take, by those before, in milliseconds.
#[derive(Clone, Copy, Debug)]
struct Pace {
    /// Bringing the world to a moment.
    moment: f64,
    /// Tracing one sample of every pixel.
    sample: f64,
}

/// What the session's thread has.
struct Director {
    settings: SessionSettings,
    handle: Handle,
    watcher: Watcher,
    reader: Reader,
    stage: Option<Stage>,
    /// The frame that was asked for last, though the scene may be shorter now.
    wanted_frame: u32,
    detail: Detail,
    next: Next,
    /// Is there to be a full picture after the draft?
    due: bool,
    pace: Option<Pace>,
    last_id: u64,
    tell: Box<dyn FnMut(Event) + Send>,
}

impl Director {
    fn new(settings: SessionSettings, handle: Handle, tell: Box<dyn FnMut(Event) + Send>) -> Self {
        let mailbox = Arc::clone(&handle.mailbox);
        let watcher = Watcher::start(settings.watching, move || mailbox.post(Command::Reload));
        Self {
            wanted_frame: settings.frame,
            settings,
            handle,
            watcher,
            reader: Reader::new(),
            stage: None,
            detail: Detail::Full,
            next: Next::Nothing,
            due: false,
            pace: None,
            last_id: 0,
            tell,
        }
    }

    fn run(mut self) {
        self.watcher.follow(std::slice::from_ref(&self.settings.scene), SystemTime::now());
        self.reload();
        loop {
            let mut reload = false;
            for command in self.handle.mailbox.take(self.next == Next::Nothing) {
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

    /// Reads the files; what is wrong with them leaves the last good scene in place.
    fn reload(&mut self) {
        self.watcher.look();
        let since = SystemTime::now();
        let start = Instant::now();
        match Stage::read(&mut self.reader, &self.settings.scene) {
            Ok(read) => {
                self.watcher.follow(&read.scene.files, since);
                let read_in = Times::milliseconds(start.elapsed());
                let start = Instant::now();
                Stage::take_over(&mut self.stage, read);
                let times =
                    Times { read: read_in, build: Times::milliseconds(start.elapsed()), ..Times::default() };
                self.welcome(times);
            }
            Err(error) => {
                self.watcher.follow(error.files(), since);
                let mistakes = Mistakes::of_scene(&error);
                self.handle.board.change(|state| state.mistakes = Some(mistakes));
                (self.tell)(Event::Broken(error));
            }
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
                mistakes: None,
                frame_mistakes: None,
                times,
                ..std::mem::take(state)
            };
        });
        self.due = self.settings.finish;
        self.next = Next::Coarse(Some(self.detail));
        (self.tell)(Event::Reloaded(times));
    }

    fn view(&mut self, view: View) {
        match view {
            View::Seek { frame, .. } => self.wanted_frame = frame,
            View::Detail(detail) => self.detail = detail,
            View::Finish | View::Measure => {}
        }
        let (wanted_frame, detail, shows) = (self.wanted_frame, self.detail, self.stage.is_some());
        self.handle.board.change(|state| {
            state.detail = detail;
            if shows {
                state.frame = wanted_frame.min(state.frames - 1);
                state.frame_mistakes = None;
                state.rendering = true;
            }
        });
        if shows {
            self.next = match view {
                View::Seek { playing, .. } => self.next_while(playing),
                View::Detail(detail) => Next::Picture(detail),
                View::Finish => Next::Picture(Detail::Full),
                View::Measure => Next::Cost(0),
            };
        }
    }

    /// What is there time for?
    fn next_while(&self, playing: bool) -> Next {
        match (self.expected() <= if playing { self.interval() } else { SOON }, playing) {
            (true, _) => Next::Picture(self.detail),
            (false, true) => Next::Coarse(None),
            (false, false) => Next::Coarse(Some(self.detail)),
        }
    }

    /// Milliseconds that a picture as it is asked for may take.
    fn expected(&self) -> f64 {
        let (Some(pace), Some(stage)) = (self.pace, &self.stage) else { return f64::INFINITY };
        let samples = match self.detail {
            Detail::Full => f64::from(stage.samples()),
            Detail::Draft => 1.0,
            Detail::Half => 0.25,
        };
        pace.moment + pace.sample * samples
    }

    fn probe(&mut self, pixel: (u32, u32), Answer(answer): Answer) {
        let frame = self.handle.board.state().frame;
        let spot = self.stage.as_mut().map_or(Ok(None), |stage| stage.spot(frame, pixel));
        answer(spot.unwrap_or_else(|error| {
            self.fail(error);
            None
        }));
    }

    /// How much less of the film's width and height a coarse picture has, to be ready in time.
    fn divisor(&self, then: Option<Detail>) -> u32 {
        let Some(pace) = self.pace else { return UNKNOWN };
        let (time, finest) = match then {
            Some(_) => (COARSE, 2),
            None => (COARSE_IN_A_ROW * self.interval(), 1),
        };
        (finest..COARSEST)
            .find(|divisor| pace.sample <= time * f64::from(divisor * divisor))
            .unwrap_or(COARSEST)
    }

    /// Milliseconds between frames.
    fn interval(&self) -> f64 {
        1e3 / self.handle.board.state().rate
    }

    fn make_next(&mut self) {
        match self.next {
            Next::Nothing => {}
            Next::Coarse(then) => {
                self.show(Render::Coarse(self.divisor(then)), then.map_or(Next::Nothing, Next::Picture));
            }
            Next::Picture(detail) => {
                let due = if self.due { Next::Picture(Detail::Full) } else { Next::Nothing };
                match detail {
                    Detail::Full => self.show(Render::Full, Next::Nothing),
                    Detail::Draft => self.show(Render::Draft(1), due),
                    Detail::Half => self.show(Render::Draft(2), due),
                }
            }
            Next::Cost(index) => self.measure(index),
        }
    }

    /// Makes a picture and puts it up, unless a command comes in between: then it is still the next thing to do.
    fn show(&mut self, render: Render, then: Next) {
        let state = self.handle.board.state();
        let Some(stage) = &mut self.stage else {
            self.next = Next::Nothing;
            return;
        };
        match stage.render(state.frame, render, self.handle.mailbox.waiting()) {
            Ok(None) => {}
            Ok(Some(film)) => {
                self.next = then;
                self.put_up(&state, render, film);
            }
            Err(error) => self.fail(error),
        }
    }

    fn fail(&mut self, error: EngineError) {
        self.next = Next::Nothing;
        let mistakes = Mistakes::of_frame(&error);
        self.handle.board.change(|state| {
            state.frame_mistakes = Some(mistakes);
            state.rendering = false;
        });
        (self.tell)(Event::Failed(error));
    }

    fn put_up(&mut self, state: &State, render: Render, film: Film) {
        let Some(stage) = &mut self.stage else { return };
        let (report, transfer) = (*stage.report(), stage.film_settings().transfer);
        let start = Instant::now();
        // A film of a scene without mistakes is never too large for the encoder.
        let Ok(png) = output::encode_quickly(&film, transfer) else { return };
        let mut times = Times { encode: Times::milliseconds(start.elapsed()), ..state.times };
        times.set_frame(&report);
        self.last_id += 1;
        let (full, coarse) = (render == Render::Full, matches!(render, Render::Coarse(_)));
        let info = PictureInfo {
            id: self.last_id,
            frame: state.frame,
            reloads: state.reloads,
            width: film.width(),
            height: film.height(),
            full,
            coarse,
        };
        self.due &= !full;
        if !coarse || self.pace.is_none() {
            let samples = match render {
                Render::Full => report.rays.camera as f64 / film.pixels().len() as f64,
                Render::Draft(divisor) | Render::Coarse(divisor) => 1.0 / f64::from(divisor * divisor),
            };
            self.pace = Some(Pace { moment: times.animate + times.prepare, sample: times.trace / samples });
        }
        let plan = if coarse { None } else { stage.planned(state.frame, full).ok() };
        let (rays, rendering) = (report.rays.total(), self.next != Next::Nothing);
        self.handle.board.hang(Picture { info, png: png.into() });
        self.handle.board.change(|state| {
            state.picture = Some(info);
            state.times = times;
            state.rays = rays;
            state.rendering = rendering;
            state.frame_mistakes = None;
            if let Some(plan) = plan {
                state.plan = plan;
            }
        });
        (self.tell)(Event::Shown(Shown { info, film, transfer, times, rays }));
    }

    /// Measures what an effect costs, and goes on with the next one. Any command ends it.
    fn measure(&mut self, index: usize) {
        let state = self.handle.board.state();
        let Some(stage) = &mut self.stage else { return };
        self.next = Next::Nothing;
        let plan = if index == 0 { stage.planned(state.frame, false) } else { Ok(state.plan) };
        let cost = stage.cost(state.frame, index, self.handle.mailbox.waiting());
        match plan.and_then(|plan| Ok((plan, cost?))) {
            Ok((mut plan, Some(cost))) => {
                self.next = Next::Cost(index + 1);
                if let Some(planned) = plan.get_mut(index) {
                    planned.cost = cost;
                }
                self.handle.board.change(|state| state.plan = plan);
            }
            Ok((_, None)) => self.handle.board.change(|state| state.rendering = false),
            Err(error) => self.fail(error),
        }
    }
}
