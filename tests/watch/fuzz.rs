//! Random input to a session: seeks, playback, drafts, measurements, values and keys that are tried, kept, discarded and undone, pixels,
//! films, and saves by another program, at random times. Whatever came before, the last state is shown exactly.
//!
//! `RAYREEL_SECONDS=600` sets the duration; the default is 5.

use std::fs;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex};
use std::thread::sleep;
use std::time::{Duration, Instant};

use rayreel::Engine;
use rayreel::live::{
    Detail, ExportRequest, Handle, OutlineRequest, Reply, SceneEdit, SessionCommand, ViewChange,
};
use rayreel::output::encode_quickly;
use rayreel::scene::{KeyChange, ScenePart};

use crate::AT_MOST;
use crate::session::{Stage, scene};
use crate::splitmix::Random;

/// Commands between two checks.
const ROUND: usize = 150;
/// Maximum delay after a command in milliseconds: about the time of a picture.
const LONGEST_DELAY: usize = 8;

/// The answers of a session: the number that are due, and the last refusal because of a value.
#[derive(Clone, Default)]
struct Answers {
    due: Arc<AtomicUsize>,
    refused: Arc<Mutex<Option<String>>>,
}

impl Answers {
    fn reply<T: 'static>(&self) -> Reply<T> {
        self.due.fetch_add(1, Ordering::Relaxed);
        let due = Arc::clone(&self.due);
        Reply(Box::new(move |_| {
            due.fetch_sub(1, Ordering::Relaxed);
        }))
    }

    fn result(&self) -> Reply<Result<(), String>> {
        self.due.fetch_add(1, Ordering::Relaxed);
        let Self { due, refused } = self.clone();
        Reply(Box::new(move |result: Result<(), String>| {
            if let Some(why) = result.err().filter(|why| why.contains("radius")) {
                *refused.lock().unwrap() = Some(why);
            }
            due.fetch_sub(1, Ordering::Relaxed);
        }))
    }
}

fn value(random: &mut Random) -> String {
    let digit = random.index(10);
    [
        format!("entities.ball.shape.radius=0.{digit}"),
        format!("materials.clay.k_d=0.{digit}"),
        format!("materials.clay.color=({digit}, 100, 2)"),
        format!("camera.position=(0, 0.{digit}, -5)"),
        format!("animate.0.track.0.0.0=0.{digit}"),
        format!("animate.0.track.0.1.1=(0, {digit}, 0)"),
        format!("film.width={}", 40 + digit),
        format!("timeline.duration={}", 1 + digit % 3),
        "materials.none.k_d=1".to_owned(),
        "entities.ball.shape.radius=-1".to_owned(),
    ][random.index(10)]
    .clone()
}

fn key_change(random: &mut Random) -> KeyChange {
    let path = "animate.0.track.0".to_owned();
    match random.index(4) {
        0 => KeyChange::Add(path, 0.1 * random.index(25) as f64),
        3 => KeyChange::Set(path, 0.1 * random.index(25) as f64, format!("(0, 0.{}, 0)", random.index(10))),
        1 => KeyChange::Remove(path, random.index(3) as f64),
        _ => KeyChange::Ease(
            path,
            random.index(3) as f64,
            ["EaseIn", "Hold", "nothing"][random.index(3)].to_owned(),
        ),
    }
}

/// Does something that a page or another program might do.
fn act(stage: &Stage, handle: &Handle, answers: &Answers, random: &mut Random) {
    let view = |change| handle.send(SessionCommand::ViewChange(change));
    let edit = |edit| handle.send(SessionCommand::Edit(edit, answers.result()));
    match random.index(20) {
        0..=2 => view(ViewChange::Seek { frame: u32::try_from(random.index(40)).unwrap(), playing: false }),
        3 => (0..10).for_each(|frame| {
            view(ViewChange::Seek { frame, playing: true });
            sleep(Duration::from_millis(2));
        }),
        4 => view(ViewChange::Detail([Detail::Full, Detail::Draft, Detail::Half][random.index(3)])),
        5 => view(ViewChange::Finish),
        6 => view(ViewChange::Measure),
        7..=9 => edit(SceneEdit::Try((0..=random.index(2)).map(|_| value(random)).collect(), Vec::new())),
        10 if random.once_in(2) => edit(SceneEdit::TryKey(key_change(random))),
        10 => edit(SceneEdit::Try(vec![value(random)], vec![key_change(random)])),
        11 | 12 => edit(SceneEdit::Keep),
        13 => edit(SceneEdit::Drop),
        14 if random.once_in(2) => edit(SceneEdit::Redo),
        14 => edit(SceneEdit::Undo),
        15 => handle.send(SessionCommand::Probe((9, 9), answers.reply())),
        16 => {
            handle.send(SessionCommand::Camera(answers.reply()));
            handle.send(SessionCommand::Tracks(answers.reply()));
            handle.send(SessionCommand::Part(Some(ScenePart::Entity("ball".to_owned())), answers.reply()));
            handle.send(SessionCommand::Outline(OutlineRequest::default(), answers.reply()));
        }
        17 => {
            let target = stage.path(["film", "film.gif"][random.index(2)]);
            handle
                .send(SessionCommand::Export(ExportRequest { first: 0, last: 9, target }, answers.result()));
        }
        18 if random.once_in(2) => handle.cancel_export(),
        _ => {
            let text = scene(0.5 + 0.1 * random.index(9) as f64, &format!("// {}", random.bits()));
            stage.save(if random.once_in(4) { &text[..text.len() / 2] } else { &text });
        }
    }
}

/// Waits until the page shows a frame of the scene in the file, and compares the picture with that of a cold start.
fn comes_to_rest(stage: &Stage, handle: &Handle, answers: &Answers, frame: u32) {
    handle.send(SessionCommand::Edit(SceneEdit::Drop, answers.result()));
    handle.send(SessionCommand::ViewChange(ViewChange::Detail(Detail::Full)));
    handle.send(SessionCommand::ViewChange(ViewChange::Seek { frame, playing: false }));
    let start = Instant::now();
    loop {
        let state = handle.state();
        let rests = state.mistakes.is_none() && state.edits.tried.is_empty() && !state.rendering;
        let shown = state
            .picture
            .filter(|info| rests && info.full && info.frame == state.frame && info.reloads == state.reloads);
        let png = shown.and_then(|info| handle.picture(info.id)).map(|picture| picture.png);
        if let Some(png) = png
            && let Ok(mut cold) = Engine::load(stage.path("ball.ron"))
        {
            let shown = frame.min(cold.timeline.frame_count() - 1);
            let film = cold.render_frame(shown).unwrap();
            let expected = encode_quickly(&film, cold.effective_settings().film.transfer).unwrap();
            if state.frame == shown && *png == *expected && answers.due.load(Ordering::Relaxed) == 0 {
                return;
            }
        }
        assert!(start.elapsed() < AT_MOST, "{state:?} {:?}", fs::read_to_string(stage.path("ball.ron")));
        sleep(Duration::from_millis(5));
    }
}

/// Returns the resident memory in kB, where the system reports it.
fn memory() -> Option<u64> {
    let status = fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:"))?;
    line.split_whitespace().next()?.parse().ok()
}

#[test]
fn random_input_leaves_no_trace() {
    let seconds = std::env::var("RAYREEL_SECONDS").ok().and_then(|seconds| seconds.parse().ok());
    let (duration, start) = (Duration::from_secs(seconds.unwrap_or(5)), Instant::now());
    let mut random = Random(40);
    let stage = Stage::caching(Some(&scene(1.0, "")), false, 1 << 20);
    let (handle, answers) = (stage.session().handle(), Answers::default());
    let (mut used, mut rounds) = (Vec::new(), 0);
    while start.elapsed() < duration {
        for _ in 0..ROUND {
            act(&stage, &handle, &answers, &mut random);
            sleep(Duration::from_millis(random.index(LONGEST_DELAY) as u64));
        }
        // A broken file stays broken until somebody saves it.
        if handle.state().mistakes.is_some() || Engine::load(stage.path("ball.ron")).is_err() {
            stage.save(&scene(1.0, ""));
        }
        let frame = u32::try_from(random.index(25)).unwrap();
        comes_to_rest(&stage, &handle, &answers, frame);
        stage.events_within(Duration::ZERO);
        used.extend(memory());
        rounds += 1;
    }
    println!("{rounds} rounds, memory in kB: {used:?}");
    assert!(rounds > 0 && answers.refused.lock().unwrap().is_some());
    // By the middle of a long run, everything has been needed once.
    if let (Some(last), true) = (used.last(), used.len() > 20) {
        assert!(*last <= used[used.len() / 2] * 21 / 20, "{used:?}");
    }
}
