//! Tests of exports: frames that a session renders into files.

use std::fs;
use std::thread::sleep;
use std::time::{Duration, Instant};

use rayreel::Engine;
use rayreel::live::{ExportEnd, ExportRequest, ExportState, SceneEdit, SessionCommand};

use crate::AT_MOST;
use crate::edits::ask;
use crate::session::{Stage, scene};

fn export(stage: &Stage, first: u32, last: u32, target: &str) -> Result<(), String> {
    let request = ExportRequest { first, last, target: stage.path(target) };
    ask(stage, |reply| SessionCommand::Export(request, reply))
}

/// Waits for the end of the export.
fn ended(stage: &Stage) -> ExportState {
    let start = Instant::now();
    loop {
        if let Some(export) = stage.session().handle().export().filter(|export| export.end.is_some()) {
            return export;
        }
        assert!(start.elapsed() < AT_MOST);
        sleep(Duration::from_millis(5));
    }
}

#[test]
fn frames_are_those_of_render_and_stay() {
    let stage = Stage::new(Some(&scene(1.0, "")));
    stage.matches_a_cold_start();
    let mut engine = Engine::load(stage.path("ball.ron")).unwrap();
    let last = engine.timeline.frame_count() - 1;
    engine.render_to(stage.path("ball")).unwrap();
    export(&stage, 1, 3, "made").unwrap();
    let ExportState { done, total, end, is_movie, .. } = ended(&stage);
    assert_eq!((done, total, end, is_movie), (3, 3, Some(ExportEnd::Complete), false));
    for frame in 0..=last {
        let name = format!("ball.{frame:04}.png");
        let made = fs::read(stage.path("made").join(&name)).ok();
        let expected = (1..=3).contains(&frame).then(|| fs::read(stage.path("ball").join(&name)).unwrap());
        assert!(made == expected, "{name}");
    }
    // Frames that are done are kept.
    let written = || fs::metadata(stage.path("made").join("ball.0002.png")).unwrap().modified().unwrap();
    let before = written();
    export(&stage, 0, last, "made").unwrap();
    assert_eq!(ended(&stage).done, last as usize + 1);
    assert_eq!(written(), before);
    export(&stage, 0, last, "ball.gif").unwrap();
    assert!(ended(&stage).is_movie && stage.path("ball.gif").is_file());
}

#[test]
fn impossible_exports_are_refused() {
    let stage = Stage::new(Some(&scene(1.0, "")));
    stage.matches_a_cold_start();
    let frames = stage.session().handle().state().frames;
    let why = |first, last, target| export(&stage, first, last, target).unwrap_err();
    assert_eq!(why(0, frames, "made"), format!("the last frame is {}", frames - 1));
    assert_eq!(why(2, 1, "made"), "the last frame comes before the first");
    assert_eq!(why(0, 1, "ball.ron"), "name a folder for the frames, or a movie, as film.mp4");
    let attempt = SceneEdit::Try(vec!["entities.ball.shape.radius=1.5".to_owned()], Vec::new());
    ask(&stage, |reply| SessionCommand::Edit(attempt, reply)).unwrap();
    assert_eq!(why(0, 1, "made"), "some values are not in the file yet: keep or discard them first");
    ask(&stage, |reply| SessionCommand::Edit(SceneEdit::Drop, reply)).unwrap();
    stage.save("(camera: (");
    let start = Instant::now();
    while stage.session().handle().state().mistakes.is_none() {
        assert!(start.elapsed() < AT_MOST);
        sleep(Duration::from_millis(5));
    }
    assert_eq!(why(0, 1, "made"), "the file has mistakes: correct them first");
    assert!(!stage.path("made").exists());
}

#[test]
fn exports_are_cancelled_in_the_middle_of_a_frame() {
    let slow = scene(1.0, "").replacen("film: (", "sampling: (samples: 20000), film: (", 1);
    let stage = Stage::new(Some(&slow));
    for target in ["made", "made.gif"] {
        export_when_read(&stage, target);
        let again: Result<(), String> = export(&stage, 0, 3, "other");
        assert_eq!(again.unwrap_err(), "a film is being rendered: wait for its end, or cancel it");
        let start = Instant::now();
        stage.session().handle().cancel_export();
        assert!(start.elapsed() < Duration::from_secs(5));
        assert_eq!(ended(&stage).end, Some(ExportEnd::Cancelled));
    }
    let left = fs::read_dir(stage.path("made")).unwrap().count();
    assert!(left < 4 && !stage.path("made.gif").exists() && !stage.path("other").exists());
}

/// Starts an export once the scene is read.
fn export_when_read(stage: &Stage, target: &str) {
    let start = Instant::now();
    while let Err(why) = export(stage, 0, 3, target) {
        assert!(start.elapsed() < AT_MOST, "{why}");
        sleep(Duration::from_millis(5));
    }
}
