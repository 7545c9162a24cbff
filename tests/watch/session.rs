//! Tests of the session that shows a scene while its files are edited.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, channel};
use std::thread::sleep;
use std::time::{Duration, Instant};

use rayreel::live::{
    Event, PixelInfo, Reply, Session, SessionCommand, SessionSettings, Shown, ViewChange, Watching,
};
use rayreel::output::encode_quickly;
use rayreel::scene::LoadError;
use rayreel::{EffectSet, Engine};
use tempfile::TempDir;

use crate::{AT_MOST, LONG_ENOUGH};

/// A session with its own folder.
pub(crate) struct Stage {
    folder: TempDir,
    settings: SessionSettings,
    session: Option<Session>,
    events: Receiver<Event>,
}

pub(crate) fn scene(radius: f64, more: &str) -> String {
    format!(
        r#"Scene(
    timeline: (fps: 10, duration: 2),
    film: (width: 64, height: 36),
    camera: (position: (0, 0, -5), target: (0, 0, 0)),
    ambient: (0.4, 0.4, 0.4),
    materials: {{ "clay": (k_a: 1, k_d: 0.5, color: (255, 120, 60)) }},
    entities: [
        (name: "ball", shape: Sphere(radius: {radius:?}), material: "clay"),
        (light: Point(intensity: (1, 1, 1)), transform: (translation: (4, 6, -4))),
        {more}
    ],
    animate: [(target: "ball", channel: Translation, track: Keys([(0, (0, 0, 0)), (2, (0, 1, 0))]))],
)"#
    )
}

fn start(settings: SessionSettings) -> (Session, Receiver<Event>) {
    let (sender, events) = channel();
    let session = Session::start(settings, move |event| {
        let _ = sender.send(event);
    });
    (session, events)
}

impl Stage {
    pub(crate) fn new(text: Option<&str>) -> Self {
        Self::with(text, false)
    }

    /// Starts a session, which renders a full picture after every edit if `finish` is set.
    pub(crate) fn with(text: Option<&str>, finish: bool) -> Self {
        Self::caching(text, finish, 0)
    }

    /// Starts a session that keeps finished frames of up to `cache` bytes.
    pub(crate) fn caching(text: Option<&str>, finish: bool, cache: usize) -> Self {
        Self::storing(text, finish, cache, |_| None)
    }

    /// Starts a session that also keeps finished frames in a folder, which `cache_folder` makes of the scene's folder.
    pub(crate) fn storing(
        text: Option<&str>,
        finish: bool,
        cache: usize,
        cache_folder: impl Fn(&Path) -> Option<PathBuf>,
    ) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("ball.ron");
        if let Some(text) = text {
            fs::write(&path, text).unwrap();
        }
        let settings = SessionSettings {
            scene: path,
            overrides: Vec::new(),
            without: EffectSet::default(),
            allowed: Vec::new(),
            frame: 0,
            watching: Watching::Events,
            finish,
            cache,
            cache_folder: cache_folder(folder.path()),
            editor: None,
        };
        let (session, events) = start(settings.clone());
        Self { folder, settings, session: Some(session), events }
    }

    /// Ends the session, which writes what is to be written, and starts another one.
    pub(crate) fn restart(&mut self) {
        self.session = None;
        let (session, events) = start(self.settings.clone());
        (self.session, self.events) = (Some(session), events);
    }

    /// Ends the session.
    pub(crate) fn end(&mut self) {
        self.session = None;
    }

    pub(crate) fn path(&self, file: &str) -> PathBuf {
        self.folder.path().join(file)
    }

    /// Replaces the scene file atomically, however busy the machine is.
    pub(crate) fn save(&self, text: &str) {
        self.save_as("ball.ron", text);
    }

    fn save_as(&self, file: &str, text: &str) {
        fs::write(self.path("new"), text).unwrap();
        fs::rename(self.path("new"), self.path(file)).unwrap();
    }

    pub(crate) fn next(&self) -> Event {
        self.events.recv_timeout(AT_MOST).unwrap()
    }

    pub(crate) fn folder(&self) -> &Path {
        self.folder.path()
    }

    pub(crate) fn session(&self) -> &Session {
        self.session.as_ref().unwrap()
    }

    /// Returns all events within a time.
    pub(crate) fn events_within(&self, time: Duration) -> Vec<Event> {
        let end = Instant::now() + time;
        std::iter::from_fn(|| self.events.recv_timeout(end.saturating_duration_since(Instant::now())).ok())
            .collect()
    }

    /// Returns the next full picture, which must have the bits of a cold start.
    pub(crate) fn matches_a_cold_start(&self) -> Shown {
        self.shows(|error| panic!("{error}"))
    }

    /// Works as [`matches_a_cold_start`](Self::matches_a_cold_start), with any errors in the meantime.
    pub(crate) fn converges_to_a_cold_start(&self) -> Shown {
        self.shows(|_| ())
    }

    fn shows(&self, broken: impl Fn(LoadError)) -> Shown {
        loop {
            match self.next() {
                Event::Shown(shown) if shown.info.full => {
                    let mut cold = Engine::load(self.path("ball.ron")).unwrap();
                    assert!(cold.render_frame(shown.info.frame).unwrap() == *shown.film);
                    return shown;
                }
                Event::Broken(error) => broken(error),
                Event::Failed(error) => panic!("{error}"),
                Event::NotShown(mistakes) => panic!("{mistakes:?}"),
                Event::Reloaded(_) | Event::Shown(_) => {}
            }
        }
    }

    fn next_mistakes(&self) -> String {
        loop {
            if let Event::Broken(error) = self.next() {
                return error.to_string();
            }
        }
    }

    pub(crate) fn probe(&self, pixel: (u32, u32)) -> Option<PixelInfo> {
        let (sender, answer) = channel();
        let send = move |spot| sender.send(spot).unwrap();
        self.session().handle().send(SessionCommand::Probe(pixel, Reply(Box::new(send))));
        answer.recv_timeout(AT_MOST).unwrap()
    }

    pub(crate) fn seek(&self, frame: u32) {
        self.session().handle().send(SessionCommand::ViewChange(ViewChange::Seek { frame, playing: false }));
    }

    pub(crate) fn play(&self, frame: u32) {
        self.session().handle().send(SessionCommand::ViewChange(ViewChange::Seek { frame, playing: true }));
    }

    /// Waits until the state meets a condition. Panics after `AT_MOST`.
    pub(crate) fn wait_for(
        &self,
        what: &str,
        is: impl Fn(&rayreel::live::State) -> bool,
    ) -> rayreel::live::State {
        let start = Instant::now();
        loop {
            let state = self.session().handle().state();
            if is(&state) {
                return state;
            }
            assert!(start.elapsed() < AT_MOST, "{what}: {state:?}");
            sleep(Duration::from_millis(5));
        }
    }
}

#[test]
fn edits_show_a_coarse_and_then_the_cold_start_picture() {
    let stage = Stage::new(Some(&scene(1.0, "")));
    let first = stage.matches_a_cold_start();
    stage.save(&scene(1.5, ""));
    assert!(matches!(stage.next(), Event::Reloaded(_)));
    let Event::Shown(coarse) = stage.next() else { panic!("no coarse picture") };
    assert!((8..=32).contains(&coarse.info.width) && !coarse.info.full, "{:?}", coarse.info);
    let second = stage.matches_a_cold_start();
    assert!(first.film != second.film && second.info.reloads == 2);

    let state = stage.wait_for("rest", |state| !state.rendering);
    assert_eq!((state.picture, state.before), (Some(second.info), Some(first.info)));
    assert!(state.plan.iter().any(|planned| planned.effect == "diffuse light" && planned.needed));
    for shown in [first, second] {
        let picture = stage.session().handle().picture(shown.info.id).unwrap();
        let png = encode_quickly(&shown.film, shown.transfer).unwrap();
        assert!(picture.info == shown.info && *picture.png == *png);
    }
}

#[test]
fn broken_files_keep_the_last_good_scene_until_fixed() {
    let stage = Stage::new(Some(&scene(1.0, "")));
    let good = stage.matches_a_cold_start();
    let text = scene(0.7, "");
    for (radius, broken) in [(0.7, &text[..text.len() / 2]), (0.8, ""), (0.9, "Scene(")] {
        stage.save(broken);
        let mistakes = stage.next_mistakes();
        let state = stage.session().handle().state();
        assert_eq!(state.mistakes.as_ref().map(|mistakes| &mistakes.text), Some(&mistakes));
        assert!(state.picture.unwrap().id >= good.info.id);
        // The last good scene can still be viewed.
        stage.seek(7);
        assert!(matches!(stage.next(), Event::Shown(shown) if shown.info.frame == 7));
        assert_eq!(stage.probe((32, 18)).unwrap().surface.unwrap().entity, "ball");
        stage.save(&scene(radius, ""));
        while !matches!(stage.next(), Event::Reloaded(_)) {}
        assert_eq!(stage.matches_a_cold_start().info.frame, 7);
        assert_eq!(stage.session().handle().state().mistakes, None);
    }
    fs::remove_file(stage.path("ball.ron")).unwrap();
    assert!(stage.next_mistakes().contains("there is no file"));
    stage.save(&scene(0.5, ""));
    stage.matches_a_cold_start();
}

#[test]
fn missing_scene_is_loaded_when_created() {
    let stage = Stage::new(None);
    assert!(stage.next_mistakes().contains("there is no file"));
    stage.seek(3);
    stage.save(&scene(1.0, ""));
    assert_eq!(stage.matches_a_cold_start().info.frame, 3);
}

#[test]
fn included_files_are_watched_while_they_are_included() {
    let include = |file: &str| {
        let text = scene(1.0, "");
        text.replacen("Scene(", &format!("Scene(include: [(file: \"{file}\", name: \"part\")],"), 1)
    };
    let part = |radius: f64| {
        format!(
            "Scene(materials: {{ \"m\": (k_a: 1, color: (9, 200, 9)) }}, entities: [(name: \"knob\", \
             shape: Sphere(radius: {radius:?}), material: \"m\", transform: (translation: (1, 0, -2)))])"
        )
    };
    let stage = Stage::new(Some(&scene(1.0, "")));
    stage.matches_a_cold_start();
    stage.save(&include("parts/knob.ron"));
    assert!(stage.next_mistakes().contains("knob.ron"));
    fs::create_dir(stage.path("parts")).unwrap();
    stage.save_as("parts/knob.ron", &part(0.3));
    stage.matches_a_cold_start();
    stage.save_as("parts/knob.ron", &part(0.6));
    let shown = stage.matches_a_cold_start();
    stage.save_as("parts/knob.ron", "Scene(");
    assert!(stage.next_mistakes().contains("knob.ron:1"));
    stage.save(&scene(1.2, ""));
    assert!(stage.matches_a_cold_start().info.reloads > shown.info.reloads);
    stage.save_as("parts/knob.ron", &part(0.1));
    assert!(stage.events.recv_timeout(LONG_ENOUGH).is_err(), "the file had left");
}

#[test]
fn playhead_is_kept_for_shorter_scenes() {
    let stage = Stage::new(Some(&scene(1.0, "")));
    stage.seek(15);
    stage.wait_for("frame 15", |state| state.picture.is_some_and(|picture| picture.frame == 15));
    stage.save(&scene(1.0, "").replace("duration: 2", "duration: 1"));
    let state = stage.wait_for("a shorter scene", |state| state.frames == 10 && !state.rendering);
    assert_eq!((state.frame, state.picture.unwrap().frame), (9, 9));
    stage.save(&scene(1.0, ""));
    let state = stage.wait_for("the longer scene", |state| state.frames == 20 && !state.rendering);
    assert_eq!((state.frame, state.picture.unwrap().frame), (15, 15));
}

#[test]
fn newer_edit_interrupts_the_current_picture() {
    // Far too slow for the test to wait for.
    let slow = scene(1.0, "").replace("width: 64, height: 36", "width: 4096, height: 4096");
    let slow = slow.replacen("Scene(", "Scene(sampling: (samples: 4096),", 1);
    let stage = Stage::new(Some(&slow));
    let Event::Reloaded(_) = stage.next() else { panic!("not read") };
    assert!(matches!(stage.next(), Event::Shown(shown) if !shown.info.full));
    assert_eq!(stage.probe((2048, 2048)).unwrap().surface.unwrap().entity, "ball");
    stage.save(&scene(1.0, ""));
    assert_eq!(stage.matches_a_cold_start().info.reloads, 2);
}

#[test]
fn probe_describes_the_visible_surface() {
    let stage = Stage::new(Some(&scene(1.0, "")));
    stage.matches_a_cold_start();
    let spot = stage.probe((32, 18)).unwrap();
    let surface = spot.surface.unwrap();
    assert_eq!((surface.entity.as_str(), surface.material.as_deref()), ("ball", Some("clay")));
    let place = format!("{}:8", stage.path("ball.ron").display());
    assert_eq!(surface.place.as_deref(), Some(place.as_str()));
    assert!((surface.point[2] + 1.0).abs() < 0.1 && surface.normal[2] < -0.9);
    assert_eq!(stage.probe((0, 0)).unwrap().surface, None);
    assert_eq!(stage.probe((64, 0)), None);
}

/// Checks pixels across edges, where samples differ.
#[test]
fn probe_has_the_colour_of_the_picture() {
    for (sampling, samples) in
        [("1", Some(1)), ("4", Some(4)), ("16", Some(16)), ("64, max_error: 0.5", None)]
    {
        let text = scene(1.0, "").replacen("Scene(", &format!("Scene(sampling: (samples: {sampling}),"), 1);
        let stage = Stage::new(Some(&text));
        let shown = stage.matches_a_cold_start();
        for i in 0..64 {
            let spot = stage.probe((i, 18)).unwrap();
            assert_eq!(spot.linear, shown.film.pixel(i, 18).to_array(), "{i} of {sampling}");
            assert_eq!(spot.bytes, shown.transfer.encode(shown.film.pixel(i, 18)));
            assert_eq!((spot.samples, spot.all), (samples, samples));
        }
    }
}

#[test]
fn only_needed_effects_are_measured() {
    let stage = Stage::new(Some(&scene(1.0, "")));
    stage.matches_a_cold_start();
    stage.session().handle().send(SessionCommand::ViewChange(ViewChange::Measure));
    let is_measured = |state: &rayreel::live::State| {
        !state.rendering && state.plan.iter().any(|planned| planned.cost.is_some())
    };
    stage.wait_for("progress", |state| state.rendering && 0.5 < state.progress && state.progress < 1.0);
    let state = stage.wait_for("costs", is_measured);
    for planned in state.plan {
        assert_eq!(planned.cost.is_some(), planned.needed, "{}", planned.effect);
    }
    // Then the error by the number of samples is measured, for the scene's own number first.
    let samples: Vec<Option<u32>> = state.curve.iter().map(|place| place.samples).collect();
    assert_eq!(samples[..5], [Some(1), Some(2), Some(4), Some(8), Some(16)]);
    assert!(state.curve.iter().all(|place| place.milliseconds > 0.0));
    let [single, .., many] = &state.curve[..] else { unreachable!() };
    assert!(single.error > 0.5 && many.error < 0.25 * single.error, "{:?}", state.curve);
    stage.save(&scene(1.1, ""));
    stage.matches_a_cold_start();
    assert!(stage.session().handle().state().curve.is_empty());
}

#[test]
fn measurements_wait_for_the_picture_and_go_on_after_questions() {
    let stage = Stage::new(Some(&scene(1.0, "")));
    stage.matches_a_cold_start();
    stage.seek(3);
    stage.session().handle().send(SessionCommand::ViewChange(ViewChange::Measure));
    stage.matches_a_cold_start();
    for i in 0..8 {
        stage.probe((i, 18)).unwrap();
        sleep(Duration::from_millis(20));
    }
    let state = stage.wait_for("costs and errors", |state| !state.rendering && state.curve.len() > 4);
    assert!(state.plan.iter().all(|planned| planned.cost.is_some() == planned.needed), "{:?}", state.plan);
}

#[test]
fn ended_sessions_emit_no_events() {
    let stage = Stage::new(Some(&scene(1.0, "")));
    let folder: &Path = stage.folder.path();
    assert!(folder.exists());
    let Stage { session, events, folder, .. } = stage;
    drop(session);
    fs::write(folder.path().join("ball.ron"), scene(2.0, "")).unwrap();
    // Only earlier events remain, and then the channel closes.
    while events.recv().is_ok() {}
}
